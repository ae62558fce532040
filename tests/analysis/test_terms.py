"""Whom an answer trusts: which ropes are tried, what a yes covers, and what it is subject to."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import cast

import numpy as np
import pytest
from typer.testing import CliRunner

from designer.analysis.analyse import Analysis
from designer.analysis.result_json import result_dict
from designer.cli.commands import app
from designer.cli.tables import _summary_of_requirements
from designer.explore.answers import Ropes
from designer.grades.grade import Grade, Modulus, Reference, RopeMaterial, Size
from designer.grades.registry import Catalogue, load_catalogue
from designer.io.config import read_study
from designer.model.cable import Trust
from designer.model.verdict import Answer
from designer.report.design.drawings import Drawings
from designer.report.design.report import section
from designer.report.render import rendered

Solve = Callable[..., Analysis]

CRANE = """
name: Crane
robot:
  anchors: [[0, 0, 11.5], [30, 0, 11.5], [15, 26, 11.5]]
  platform: {mass: 60 kg, drag: {area: 1 m^2, coefficient: 1}}
cable: {density: 5290 kg/m^3, youngs_modulus: 62.7 GPa, allowable_stress: 198 MPa,
        drag_coefficient: 1.2}
workspace: {region: {box: [[12, 18], [6, 10], [2, 6]]}, samples: 30, proof: 0 s}
"""


def grade(
    name: str,
    trust: Trust = "B",
    *,
    weight: float = 1.0,
    material: RopeMaterial = "steel",
    maker: str = "Acme",
    doubt: str | None = None,
    doubtful: Sequence[float] = (4.0,),
    flattery: float = 1.0,
) -> Grade:
    """A wire rope after one law, of which some sizes may be doubted, and stronger than the law."""
    sizes = tuple(
        Size(
            f"{d:g} mm",
            d / 1e3,
            780.0 * d**2 * (flattery if d in doubtful else 1.0),
            4.15e-3 * d**2 * weight,
            doubt=doubt if d in doubtful else None,
        )
        for d in (2.0, 3.0, 4.0, 5.0, 6.0)
    )
    return Grade(
        id=name, manufacturer=maker, product="rope", construction="7x19", core="WSC",
        finish="galvanised", sizes=sizes, trust=trust, source=Reference("a shop", "a page"),
        material=material,
        modulus=Modulus(62.7e9, "nominal", "borrowed", "a like rope", 0.15),
    )  # fmt: skip


@pytest.fixture
def solve(tmp_path: Path) -> Solve:
    shipped = load_catalogue(with_plugins=False)

    def solved(text: str, *grades: Grade) -> Analysis:
        config = tmp_path / "study.yaml"
        config.write_text(CRANE + text, encoding="utf-8")
        return Analysis.begin(read_study(config), replace(shipped, grades=grades))

    return solved


def chosen(analysis: Analysis) -> str:
    assert analysis.selection is not None
    assert analysis.selection.chosen is not None
    return analysis.selection.chosen.grade.id


LIGHT, HEAVY = grade("light", "C", weight=0.5), grade("heavy", "B")


@pytest.mark.parametrize(
    ("selection", "name", "left_out"),
    [
        ("{}", "heavy", "light"),
        ("{trust: B}", "heavy", "light"),
        ("{trust: C}", "light", None),
        ("{grades: [light, heavy]}", "light", None),
        ("{grades: [light]}", "light", None),
    ],
)
def test_third_hand_figures_are_tried_where_asked(
    selection: str, name: str, left_out: str | None, solve: Solve
) -> None:
    analysis = solve(f"selection: {selection}", LIGHT, HEAVY)
    assert chosen(analysis) == name
    assert analysis.selection is not None
    untrusted = analysis.selection.untrusted
    assert (untrusted and untrusted.grade.id) == left_out


@pytest.mark.slow
def test_what_is_lighter_and_left_out_is_a_sentence(solve: Solve) -> None:
    words = page(solve("selection: {}", LIGHT, HEAVY))
    assert "of light would have less mass" in words
    assert "but is left out: its figures are of trust C" in " ".join(words.split())
    assert "is left out" not in page(solve("selection: {trust: C}", LIGHT, HEAVY))


def test_a_price_names_what_it_offers(solve: Solve, tmp_path: Path) -> None:
    rows = "grade,size,price_per_m,currency,date\nlight,4 mm,1,EUR,2026-01-01\n"
    (tmp_path / "prices.csv").write_text(rows, encoding="utf-8")
    analysis = solve("selection: {prices: prices.csv}", LIGHT, HEAVY)
    assert analysis.selection is not None
    tried = {c.name for c in analysis.selection.candidates if c.grade.id == "light"}
    assert tried == {"light, 4 mm"}


def test_a_doubted_size_counts_as_third_hand(solve: Solve) -> None:
    doubted = grade("a", doubt="misprint")
    for selection, is_tried in (("{}", False), ("{trust: C}", True), ("{grades: [a]}", True)):
        analysis = solve(f"selection: {selection}", doubted)
        assert analysis.selection is not None
        sizes = {candidate.size.id for candidate in analysis.selection.candidates}
        assert ("4 mm" in sizes) is is_tried
        assert len(sizes) == 4 + is_tried
        told = {(left.size and left.size.id) for left in analysis.selection.not_tried}
        assert told == (set() if is_tried else {"4 mm"})


@pytest.mark.slow
def test_materials_are_a_filter(solve: Solve) -> None:
    ropes = (
        HEAVY,
        grade("braid", material="HMPE", weight=0.2),
        grade("inox", material="stainless steel"),
    )
    assert chosen(solve("selection: {}", *ropes)) == "braid"
    assert chosen(solve("selection: {materials: [steel]}", *ropes)) == "heavy"
    assert chosen(solve("selection: {materials: [stainless]}", *ropes)) == "inox"
    best = result_dict(solve("selection: {}", *ropes))["selection"]["best_of_materials"]
    assert [row["material"] for row in best] == ["steel", "HMPE", "stainless steel"]


@pytest.mark.parametrize(
    ("selection", "fault"),
    [
        ("materials: [stel]", "selection.materials[0]: 'stel' is not known"),
        ("materials: steel", "selection.materials: 'steel' is not known (expected 'all' or a list"),
        ("trust: D", "selection.trust: 'D' is not known"),
        (
            "{materials: [hmpe], grades: [unirope-7x19-galvanised]}",
            "selection.grades[0]: unirope-7x19-galvanised is of steel",
        ),
    ],
)
def test_faults_have_a_line(selection: str, fault: str, tmp_path: Path) -> None:
    study = tmp_path / "study.yaml"
    text = selection if selection.startswith("{") else f"{{{selection}}}"
    study.write_text(f"{CRANE}selection: {text}\n", encoding="utf-8")
    told = CliRunner().invoke(app, ["report", str(study), "-o", str(tmp_path / "out")])
    assert fault in str(told.exception)
    assert not (tmp_path / "out").exists()


def page(analysis: Analysis) -> str:
    shown = section(Drawings(analysis), "answer")
    assert shown is not None
    return rendered(shown).body


@pytest.mark.parametrize(
    ("rope", "reason"),
    [
        (grade("a", "C"), "its figures are of trust C, third hand or scattered text"),
        (grade("a", doubt="misprint"), "the catalogue doubts this size: misprint"),
        (grade("a", maker="not named (shop)"), "no maker is named, its table is of a shop"),
        (HEAVY, None),
    ],
)  # fmt: skip
@pytest.mark.slow
def test_a_yes_is_subject_to_what_is_not_certain(
    rope: Grade, reason: str | None, solve: Solve
) -> None:
    """In page, terminal, window and JSON alike."""
    pytest.importorskip("PySide6")
    from designer.explore.desktop.panels_below import answer_words

    analysis = solve(f"selection: {{grades: [{rope.id}]}}", rope)
    assert analysis.selection is not None
    assert analysis.selection.chosen is not None
    analysis = solve(
        f"selection: {{grades: [{rope.id}], safety_factor: {factor_for(analysis, 4.0)}}}", rope
    )
    assert analysis.answer is Answer.YES
    words = json.loads(json.dumps(result_dict(analysis)["answer"], default=list))
    assert words["covers"] == "one static case"
    assert words["not_asked"] == list(analysis.terms.not_asked)
    head = (
        "Yes, subject to a certificate of breaking load and mass of 4 mm of a, for one static case"
    )
    if reason is None:
        head = "Yes, for one static case"
        assert words["subject_to"] == []
    else:
        (condition,) = words["subject_to"]
        assert condition["why"] == reason
        assert condition["neighbours"] == ["3 mm", "5 mm"]
    text = page(analysis)
    assert f"<strong>{head}.</strong>" in text
    assert ('class="verdict doubt"' in text) == (reason is not None)
    assert "Ask the maker" not in text
    terminal = dict(_summary_of_requirements(analysis))
    assert head in terminal["[bold]answer[/]"]
    assert ("yellow" in terminal["[bold]answer[/]"]) == (reason is not None)
    window = Ropes(
        (), None, "", is_final=True, requirements=analysis.requirements,
        answer=analysis.answer, terms=analysis.terms,
    )  # fmt: skip
    assert answer_words(window).startswith(head)


def factor_for(analysis: Analysis, diameter_mm: float) -> float:
    """A safety factor at which this size is the thinnest that holds."""
    assert analysis.study.selection is not None
    assert analysis.selection is not None
    (size,) = (c for c in analysis.selection.candidates if c.size.diameter_m == diameter_mm / 1e3)
    tension_N = size.cable.allowable_tension_N * size.verification.utilisation
    return 0.9 * size.size.minimum_breaking_load_N / tension_N


def test_neighbours_tell_what_an_honest_size_would_give(solve: Solve) -> None:
    """A size flattered by a third is used to what it is without, where it is as its neighbours."""
    flattered = solve("selection: {grades: [a]}", grade("a", doubt="misprint", flattery=1.0))
    factor = factor_for(flattered, 4.0)
    text = f"selection: {{grades: [a], safety_factor: {factor}}}"
    honest = solve(text, grade("a", "C"))
    false = solve(text, grade("a", doubt="misprint", flattery=1.33))
    assert honest.selection is not None
    assert honest.selection.chosen is not None
    (condition,) = false.terms.subject_to
    assert false.selection is not None
    assert false.selection.chosen is not None
    assert false.selection.chosen.size.id == "4 mm"
    expected = honest.selection.chosen.verification.utilisation
    assert false.selection.chosen.verification.utilisation == pytest.approx(
        expected / 1.33, rel=1e-3
    )
    assert condition.by_neighbours == pytest.approx(expected, rel=1e-3)


def test_a_modulus_that_decides_is_to_be_certified(solve: Solve) -> None:
    """Stiffness is asked for between what the modulus may be at least and what it is."""
    base = solve("selection: {grades: [heavy]}", HEAVY)
    assert base.terms.subject_to == ()
    (stiffness,) = (r for r in solve(
        "selection: {grades: [heavy], limits: {stiffness: 1 N/m}}", HEAVY
    ).requirements if r.id == "stiffness")  # fmt: skip
    assert np.isfinite(stiffness.demand)
    at_N_per_m = max(stiffness.demand, stiffness.capacity)
    decided = {}
    for share in (0.5, 0.99):
        limit = f"{share * at_N_per_m} N/m"
        analysis = solve(f"selection: {{grades: [heavy], limits: {{stiffness: {limit}}}}}", HEAVY)
        assert analysis.answer is Answer.YES
        decided[share] = analysis.terms.subject_to
    assert decided[0.5] == ()
    (condition,) = decided[0.99]
    assert condition.what.startswith("a certificate of modulus of ")
    assert "borrowed, known to ±15%" in condition.why


@pytest.mark.parametrize(
    ("more", "covers", "is_asked"),
    [
        ("selection: {}", "one static case", set()),
        ("selection: {termination_efficiency: 0.9}", "one static case", {"end fittings"}),
        ("selection: {sheave_diameter: 1 m}", "one static case", {"sheaves"}),
        (
            "selection: {}\nload_cases: [{name: a, wind: {speed: 5 m/s}}, {name: b, "
            "dynamic_factor: 1.1}]",
            "2 load cases",
            {"wind", "dynamics"},
        ),
        (
            "selection: {}\nload_cases: [{name: a, ice: {thickness: 1 mm, density: 900 kg/m^3}, "
            "temperature_change: 5 K}]",
            "one load case",
            {"ice", "change of temperature"},
        ),
    ],
)
def test_the_first_sentence_tells_what_is_covered(
    more: str, covers: str, is_asked: set[str], solve: Solve
) -> None:
    analysis = solve(more, HEAVY)
    everything = {
        "wind", "dynamics", "ice", "loss of a cable", "change of temperature", "end fittings",
        "sheaves",
    }  # fmt: skip
    assert analysis.terms.covers == covers
    assert set(analysis.terms.not_asked) == everything - is_asked
    assert analysis.terms.head(Answer.YES) == f"Yes, for {covers}"


@pytest.mark.slow
def test_the_shipped_crane_gets_a_rope_that_can_be_ordered() -> None:
    from designer.resources import example_file

    study = read_study(example_file("fast"))
    assert study.workspace is not None
    few = replace(study, workspace=replace(study.workspace, samples=300, proof_s=0.0))
    analysis = Analysis.begin(few, cast(Catalogue, load_catalogue(with_plugins=False)))
    assert analysis.assignment.rope is not None
    grade, size = analysis.assignment.rope.grade, analysis.assignment.rope.size
    assert grade.trust in ("A", "B")
    assert grade.maker
    assert not size.doubt
    assert analysis.terms.subject_to == ()
