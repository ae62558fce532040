"""Every size is counted once among what was not chosen, and all pages and files agree on why.

How much of the workspace a size serves.
"""

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
from ropes import rope

from designer.analysis.analyse import Analysis
from designer.analysis.result_json import candidates_csv, result_dict
from designer.arrays import frozen_array
from designer.cli.tables import summary_rows
from designer.explore.answers import ropes_of
from designer.io.config import read_study
from designer.model.region import PointList, Prism
from designer.model.robot import Poses
from designer.model.space import Orientations
from designer.model.workspace import Workspace
from designer.report.design.drawings import Drawings
from designer.report.design.report import section
from designer.report.design.sections import selection as context
from designer.report.figures.charts_selection import candidates_chart
from designer.resources import example_file
from designer.selection.result import SelectionResult, usable
from designer.selection.select import select
from designer.sizing.newton import size_poses
from designer.statics.inverse import solve_sagging
from designer.study import Selection

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


TRIANGLE = [[0, 0, 0], [500, 0, 0], [250, 433.01, 0]]
SIZES = [8.0, 14.0, 16.0, 18.0, 20.0, 24.0, 32.0]


@pytest.mark.slow
def test_share_is_that_of_the_poses_that_need_no_more(fast_robot) -> None:
    """In a grade after the law a size serves the poses whose needed diameter is not above it."""
    workspace = Workspace(Prism.over(TRIANGLE, 30.0, (-200.0, -50.0)), samples=3000)
    grade = rope("a", SIZES)
    found = select(fast_robot, workspace, Selection(None, 2.0), [grade]).usable
    assert found is not None
    positions = np.concatenate(list(workspace.positions_m()))
    needed = size_poses(fast_robot, Poses.at(positions), grade.family(2.0)).diameter_m
    for one in found.sizes:
        share = np.mean(needed <= one.size.diameter_m)
        assert one.fraction == pytest.approx(share, abs=1e-12)
        assert one.volume_m3 == pytest.approx(share * workspace.region.volume_m3)
    shares = [one.fraction for one in found.sizes]
    assert shares == sorted(shares)
    assert shares[0] < 0.5
    assert shares[-1] == 1.0


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize("pulley_radius_m", [0.0, 0.4])
def test_where_nothing_holds_it_is_shown_for_what_serves_most(fast_robot, pulley_radius_m) -> None:
    fast_robot = replace(fast_robot, pulley_radius_m=pulley_radius_m)
    workspace = Workspace(Prism.over(TRIANGLE, 30.0, (-200.0, -50.0)), samples=500)
    grades = [rope("thin", [4.0, 6.0]), rope("nearly", [12.0, 14.0])]
    found = select(fast_robot, workspace, Selection(None, 2.0), grades)
    assert found.chosen is None
    assert found.usable is not None
    assert found.usable.grade.id == "nearly"
    assert 0.0 < found.usable.sizes[-1].fraction < 1.0


def test_of_a_slow_robot_a_part_of_the_samples_is_asked_and_counted(fast_robot) -> None:
    pulleys = replace(fast_robot, pulley_radius_m=0.4)
    workspace = Workspace(Prism.over(TRIANGLE, 30.0, (-200.0, -50.0)), samples=4000)
    grade = rope("a", [10.0, 12.0])
    cables = [(size, grade.cable(size, 2.0)) for size in grade.sizes]
    every, some = (usable(robot, workspace, grade, cables) for robot in (fast_robot, pulleys))
    assert (every.samples, some.samples) == (4000, 1000)
    for whole, part in zip(every.sizes, some.sizes, strict=True):
        assert 0.1 < whole.fraction < 0.9
        assert part.fraction == pytest.approx(whole.fraction, abs=0.06)  # 4 deviations


def test_points_have_no_volume(fast_robot) -> None:
    points = PointList(frozen_array([[250, 144, -190], [250, 40, -45], [250, -60, -50]]))
    found = select(fast_robot, Workspace(points), Selection(None, 2.0), [rope("a", [14.0, 40.0])])
    assert found.usable is not None
    assert [one.fraction for one in found.usable.sizes] == pytest.approx([1 / 3, 2 / 3])
    assert {one.volume_m3 for one in found.usable.sizes} == {None}


def test_a_weak_thicker_size_does_not_serve_what_a_thinner_one_does(fast_robot) -> None:
    """Each size counts on its own samples, and what it loses against thinner ones is told."""
    workspace = Workspace(Prism.over(TRIANGLE, 30.0, (-200.0, -50.0)), samples=1000)
    grade = rope("a", [14.0, 18.0, 20.0, 32.0], weaker={20.0: 0.6})
    found = select(fast_robot, workspace, Selection(None, 2.0), [grade]).usable
    assert found is not None and not found.is_nested
    positions = np.concatenate(list(workspace.positions_m()))
    holds = []
    for size in grade.sizes:
        statics = solve_sagging(fast_robot, Poses.at(positions), grade.cable(size, 2.0))
        allowable = size.minimum_breaking_load_N / 2.0
        holds.append(statics.is_solved & (np.nan_to_num(statics.largest_tension_N) <= allowable))
    assert [one.fraction for one in found.sizes] == pytest.approx([h.mean() for h in holds])
    assert found.sizes[2].fraction < found.sizes[1].fraction
    lost = ((holds[0] | holds[1]) & ~holds[2]).mean()
    assert 0.0 < lost == pytest.approx(found.sizes[2].lost_fraction)
    assert [one.lost_fraction for one in found.sizes[:2]] == [0.0, 0.0]
    assert found.first_for_good == 3


def test_a_position_is_served_only_in_all_its_orientations() -> None:
    study = read_study(example_file("robocrane"))
    turns = frozen_array(np.radians([[0.0, 0.0, 0.0], [12.0, 0.0, 0.0]]))
    few = replace(study.workspace, samples=200, orientations=Orientations(turns))
    grade = rope("a", [1.0, 2.0, 3.0, 4.0])
    cables = [(size, grade.cable(size, 5.0)) for size in grade.sizes]
    both = usable(study.robot, few, grade, cables)
    each = [
        usable(
            study.robot, replace(few, orientations=Orientations(turns[k : k + 1])), grade, cables
        )
        for k in range(2)
    ]
    for k, one in enumerate(both.sizes):
        assert one.fraction <= min(found.sizes[k].fraction for found in each)
    assert any(0.0 < one.fraction < 1.0 for one in both.sizes)
