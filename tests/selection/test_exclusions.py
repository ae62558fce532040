"""Every size is counted once among what was not chosen, and all pages and files agree on why."""

from __future__ import annotations

import csv
import io
import re
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml
from report_parts import said
from rich.text import Text

from designer.analysis.analyse import Analysis
from designer.analysis.result_json import candidates_csv, result_dict
from designer.cli.tables import summary_rows
from designer.explore.answers import ropes_of
from designer.io.config.reader import read_study
from designer.report.design.drawings import Drawings
from designer.report.design.report import section
from designer.report.design.sections import selection as context
from designer.report.figures.charts_selection import candidates_chart
from designer.resources import example_file
from designer.selection.result import SelectionResult

Solve = Callable[[str], Analysis]
GRADES = (
    *("unirope-6x36-iwrc-1960", "unirope-python-hoist-1960", "unirope-7x19-galvanised"),
    *("gost-6x19s-iwrc-1960", "yale-maxibraid-hmpe", "lg-7x19-wsc-galvanised-2070"),
)
SHIPPED = ("fast", "cogiro", "facade", "falcon", "ipanema", "robocrane", "stadium", "yard")


def random_study(seed: int) -> str:
    """A small crane with a choice of three to six options."""
    rng = np.random.default_rng(seed)
    size, height = rng.uniform(20.0, 200.0), rng.uniform(10.0, 40.0)
    is_square = bool(rng.random() < 0.9)  # cables to spare take a hundred times as long
    corners = np.array(
        [[0, 0], [1, 0], [0.5, 0.9]] if is_square else [[0, 0], [1, 0], [1, 1], [0, 1]]
    )
    grades = rng.choice(
        GRADES, size=int(rng.integers(1, 4 if is_square else 2)), replace=False
    ).tolist()
    middle = (size * corners.mean(axis=0)).tolist()
    half = size * rng.uniform(0.05, 0.4)
    options = {
        "sheave_diameter": float(rng.uniform(0.05, 0.6)),
        "termination_efficiency": 0.9,
        "objectives": ["mass", "max_tension"],
        "limits": {
            "drum_capacity": float(rng.uniform(0.1, 1.0) * size),
            "stiffness": float(10 ** rng.uniform(1.0, 5.0)),
        },
    }
    chosen = rng.choice(list(options), size=int(rng.integers(1, 5)), replace=False).tolist()
    factor = {"duty_class": "M5"} if rng.random() < 0.3 else {"safety_factor": 5}
    text = {
        "name": f"random {seed}",
        "robot": {
            "anchors": [[*map(float, size * xy), float(height)] for xy in corners],
            "platform": {"mass": float(10 ** rng.uniform(1.5, 4.0))},
        },
        "cable": {"grade": grades[0], "safety_factor": 5},
        "workspace": {
            "region": {"box": [[x - half, x + half] for x in middle] + [[1.0, 0.8 * height]]},
            "samples": 24,
            "proof": "0 s",
            "sag": float(rng.choice([0.02, 0.2])),
        },
        "selection": {"grades": grades} | factor | {name: options[name] for name in chosen},
    }
    if rng.random() < 0.4:
        text["load_cases"] = [{"name": "lifting", "dynamic_factor": 1.3}]
    return str(yaml.safe_dump(text))


@pytest.fixture
def solve(tmp_path: Path) -> Callable[[str], Analysis]:
    """Return the analysis of a text; nothing is computed yet."""

    def begun(text: str) -> Analysis:
        (tmp_path / "study.yaml").write_text(text, encoding="utf-8")
        return Analysis.begin(read_study(tmp_path / "study.yaml"))

    return begun


def agrees(analysis: Analysis) -> SelectionResult:
    """Check that table, figure, CSV, JSON, terminal and window say the same of each size."""
    selection = analysis.selection
    assert selection is not None
    tried = [c.grade for c in selection.candidates] + [n.grade for n in selection.not_tried]
    sizes = Counter({grade.id: len(grade.sizes) for grade in tried})
    exclusions = selection.exclusions
    chosen = 0 if selection.chosen is None else 1
    assert sum(e.sizes for e in exclusions) + chosen == sizes.total()
    rows = list(csv.DictReader(io.StringIO(candidates_csv(selection))))
    assert Counter(row["grade"] for row in rows) == sizes
    counts = Counter(row["standing"] for row in rows) - Counter(chosen=chosen)
    by_standing: Counter[str] = Counter()
    for exclusion in exclusions:
        by_standing[exclusion.standing] += exclusion.sizes
    assert by_standing == counts
    whys = {(row["grade"], row["size_id"]): row["why"].removeprefix("'") for row in rows}
    for exclusion in exclusions:  # the reason of the example is its own
        name, _, reason = exclusion.example.partition(": ")
        assert whys[tuple(name.split(", ", 1))] == reason or exclusion.standing == "not_tried"
    window = {(r.grade.id, r.size.id): (r.standing, r.reason) for r in ropes_of(selection).rows}
    assert {key: why for key, (_, why) in window.items()} == whys
    assert {standing for standing, _ in window.values()} == {row["standing"] for row in rows}
    plain = result_dict(analysis)["selection"]
    assert [e["sizes"] for e in plain["exclusions"]] == [e.sizes for e in exclusions]
    assert {(c["grade"], c["size_id"]): c["why"] for c in plain["candidates"]} == {
        (c.grade.id, c.size.id): c.reason for c in selection.candidates
    }
    page = re.sub(r"\s+", " ", said(section(Drawings(analysis), "selection")))
    terminal = [Text.from_markup(part).plain for row in summary_rows(analysis) for part in row]
    for exclusion in exclusions:
        assert exclusion.why in page
        assert f"{exclusion.why}; {exclusion.example}" in terminal
    for outcome in context(analysis)["thin"]:  # type: ignore[index, attr-defined]
        insufficient = "insufficient" in outcome.brief or "insufficient" in outcome.sentence
        assert not (insufficient and any(c.verification.holds for c in outcome.candidates))
    assert candidates_chart(selection)
    return selection


@pytest.mark.cases_by_default(3)
@pytest.mark.parametrize("seed", range(50))
def test_random_study_gives_each_size_one_reason(solve: Solve, seed: int) -> None:
    agrees(solve(random_study(seed)))


@pytest.mark.slow
@pytest.mark.parametrize("name", SHIPPED)
def test_shipped_study_gives_each_size_one_reason(solve: Solve, name: str) -> None:
    text = example_file(name).read_text(encoding="utf-8")
    study = solve(text).study
    assert study.workspace is not None
    few = replace(study.workspace, samples=40, proof_s=0.0)
    if study.selection is not None:
        agrees(Analysis.begin(replace(study, workspace=few)))


def test_sheave_that_rejects_a_size_is_named_with_one_that_would_do(solve: Solve) -> None:
    study = solve(
        """
name: Quarry crane
robot: {anchors: [[0, 0, 30], [80, 0, 30], [40, 60, 30]], platform: {mass: 900 kg}}
cable: {grade: unirope-6x36-iwrc-1960, safety_factor: 5}
workspace: {region: {prism: anchors, inset: 5, z: [2, 20]}, samples: 60, proof: 0 s}
selection: {grades: [unirope-6x36-iwrc-1960], safety_factor: 5, sheave_diameter: 180 mm}
"""
    ).study
    selection = agrees(Analysis.begin(study))
    (outcome,) = selection.outcomes
    assert outcome.outcome == "rejected"
    assert outcome.brief == "sheave not met"
    needed = re.search(r"it would hold on sheaves of (\d+) mm and more", outcome.sentence)
    assert needed
    assert study.selection is not None
    nearest = outcome.nearest_rejected.size.id
    for larger_mm, holds in ((int(needed[1]), True), (int(needed[1]) - 1, False)):
        larger = replace(study.selection, sheave_diameter_m=1e-3 * larger_mm)
        again = Analysis.begin(replace(study, selection=larger)).selection
        assert again is not None
        of_size = next(c for c in again.candidates if c.size.id == nearest)
        assert (of_size.rejected_by is None) == holds
        assert (again.outcomes[0].outcome == "fits") == holds
