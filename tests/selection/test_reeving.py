"""What share of a breaking load counts: end fittings, bending, safety factor.

A duty class in place of a safety factor, and the sheave that goes with the class of the rope.
"""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import pytest
from ropes import rope

from designer.errors import InputError
from designer.grades.registry import load_catalogue
from designer.io.config import read_study
from designer.model.load_case import LoadCase
from designer.model.region import Prism
from designer.model.winches import Winches
from designer.model.workspace import Workspace
from designer.selection.reeving import (
    Allowance,
    bending_efficiency,
    least_sheave_ratio,
    sheave_ratio_of,
)
from designer.selection.select import select
from designer.study import Selection


@pytest.mark.parametrize(
    ("ratio", "factor"),
    [(1.0, 2.00), (1.5, 1.69), (2.0, 1.55), (3.0, 1.41), (4.0, 1.33), (5.0, 1.29), (7.0, 1.23)],
)
def test_bending_of_wire_rope_is_that_of_the_rule(ratio: float, factor: float) -> None:
    """Bending factors of 0027/ND rev. 11, table 7-1: the inverse of the efficiency."""
    assert 1.0 / bending_efficiency(ratio) == pytest.approx(factor, abs=0.005)


def test_rule_ends_where_the_body_is_thinner_than_the_rope() -> None:
    assert math.isnan(bending_efficiency(0.999))
    grade = rope("a", [20.0])
    assert math.isnan(Allowance(5.0, 1.0, 0.019).efficiency(grade, 0.020))


@pytest.mark.parametrize(("ending", "expected"), [(0.95, 0.9), (0.8, 0.8)])
def test_smaller_of_ending_and_bending_counts(ending: float, expected: float) -> None:
    grade = rope("a", [20.0])
    allowance = Allowance(4.0, ending, 25.0 * 0.020)  # D/d = 25 leaves 0.9
    assert allowance.efficiency(grade, 0.020) == pytest.approx(expected)
    cable = allowance.cable(grade, grade.sizes[0])
    load = grade.sizes[0].minimum_breaking_load_N
    assert cable.allowable_tension_N == pytest.approx(load * expected / 4.0)


def test_without_sheave_and_ending_the_safety_factor_is_all() -> None:
    grade = rope("a", [20.0])
    assert Allowance(5.0).cable(grade, grade.sizes[0]) == grade.cable(grade.sizes[0], 5.0)
    assert Allowance(5.0).family(grade, 0.02) == grade.family(5.0)


def test_fibre_rope_loses_nothing_down_to_its_makers_least_diameter() -> None:
    grade = rope("a", [20.0], material="HMPE", sheave_ratio=10.0)  # at least 6
    assert Allowance(5.0, 1.0, 0.120).efficiency(grade, 0.020) == 1.0
    assert Allowance(5.0, 1.0, 0.120, 0.9).efficiency(grade, 0.020) == 0.9  # kept by its sheaves
    assert math.isnan(Allowance(5.0, 1.0, 0.119).efficiency(grade, 0.020))
    unknown = rope("b", [20.0], material="HMPE")
    assert Allowance(5.0, 1.0, 0.120).efficiency(unknown, 0.020) == bending_efficiency(6.0)


def test_family_is_as_strong_as_its_member() -> None:
    grade = rope("a", [20.0])
    allowance = Allowance(4.0, 1.0, 0.5)
    member = allowance.family(grade, 0.020).cable(0.020)
    same = allowance.cable(grade, grade.sizes[0])
    assert member.allowable_tension_N == pytest.approx(same.allowable_tension_N, rel=1e-12)


@pytest.fixture(scope="module")
def workspace() -> Workspace:
    triangle = [[0, 0, 0], [500, 0, 0], [250, 433.01, 0]]
    return Workspace(Prism.over(triangle, 40.0, (-200.0, -60.0)), samples=500)


@pytest.mark.slow
def test_optimum_over_a_sheave_is_as_strong_as_itself(fast_robot, workspace) -> None:
    selection = Selection(None, 2.0, sheave_diameter_m=0.2)
    grade = rope("a", [10.0, 20.0, 30.0, 40.0])
    (outcome,) = select(fast_robot, workspace, selection, [grade]).outcomes
    optimum = outcome.continuous_diameter_m
    expected = Allowance.of(selection, Winches()).family(grade, optimum)
    assert outcome.family.allowable_stress_Pa == pytest.approx(expected.allowable_stress_Pa)
    at_optimum = rope("b", [1e3 * optimum * 0.9999, 1e3 * optimum * 1.0001])
    below, above = select(fast_robot, workspace, selection, [at_optimum]).candidates
    assert below.efficiency > above.efficiency
    assert [c.verification.holds for c in (below, above)] == [False, True]
    (unbent,) = select(fast_robot, workspace, Selection(None, 2.0), [grade]).outcomes
    assert unbent.continuous_diameter_m < optimum


@pytest.mark.slow
def test_sheave_thinner_than_every_rope_leaves_nothing_to_try(fast_robot, workspace) -> None:
    selection = Selection(None, 2.0, sheave_diameter_m=0.005)
    found = select(fast_robot, workspace, selection, [rope("a", [10.0, 20.0])])
    assert found.chosen is None
    assert found.candidates == ()
    assert [one.size.id for one in found.not_tried if one.size] == ["10 mm", "20 mm"]
    assert "sheave" in (found.reason or "")
    some = select(
        fast_robot, workspace, Selection(None, 2.0, sheave_diameter_m=0.015),
        [rope("a", [10.0, 20.0])],
    )  # fmt: skip
    assert [c.size.id for c in some.candidates] == ["10 mm"]


GRADES = {grade.id: grade for grade in load_catalogue(with_plugins=False).grades}
STUDY = """\
robot: {anchors: [[0, 0, 9], [9, 0, 9], [4, 9, 9]], platform: {mass: 100}}
cable: {grade: unirope-6x36-iwrc-1960}
workspace: {region: {box: [[3, 4], [3, 4], [1, 2]]}}
selection:
  sheave_diameter: 200 mm
  %s
load_cases: [{name: static}, {name: rare, safety_factor: 3}]
"""


def read(folder: Path, selection: str):
    path = folder / "study.yaml"
    path.write_text(STUDY % selection, encoding="utf-8")
    return read_study(path)


@pytest.mark.parametrize(("duty", "factor"), [("M1", 3.15), ("M5", 4.5), ("M8", 9.0)])
def test_the_class_gives_the_factor(tmp_path: Path, duty: str, factor: float) -> None:
    study = read(tmp_path, f"duty_class: {duty}")
    assert study.selection is not None and study.family is not None
    assert study.selection.safety_factor == factor == study.family.safety_factor
    assert f"duty class {duty}" in study.selection.factor_source
    entries = {entry.field: entry.value_SI for entry in study.source.entries}
    assert float(entries["selection.safety_factor"]) == factor
    rare = study.selection.under(study.load_cases[1])
    assert (rare.safety_factor, rare.duty_class) == (3.0, "none")
    assert rare.factor_source == "S as the study gives it"
    assert study.selection.under(study.load_cases[0]).duty_class == duty


@pytest.mark.parametrize(
    ("given", "field", "words"),
    [
        ("{duty_class: M5, safety_factor: 5}", "selection", "has safety_factor and duty_class"),
        ("{duty_class: M9}", "selection.duty_class", "'M9' is not known"),
        ("{duty_class: 5}", "selection.duty_class", "5 is not known"),
    ],
)
def test_contradictions_and_slips_are_one_line(
    tmp_path: Path, given: str, field: str, words: str
) -> None:
    with pytest.raises(InputError) as caught:
        read(tmp_path, "\n  ".join(given.strip("{}").split(", ")))
    (fault,) = caught.value.faults
    assert fault.field == field
    assert words in fault.problem
    assert fault.line is not None


def test_in_python_as_in_files() -> None:
    assert Selection(duty_class="M6").safety_factor == 5.6
    with pytest.raises(ValueError, match="contradicts duty_class M6"):
        Selection(duty_class="M6", safety_factor=4.0)
    assert Selection(duty_class="M6").under(LoadCase("a")).safety_factor == 5.6


@pytest.mark.parametrize(
    ("grade_id", "ratio"),
    [
        ("unirope-6x36-iwrc-1960", 16.0),
        ("gost-6x19s-iwrc-1960", 16.0),
        ("unirope-19x7-eips", 20.0),
        ("unirope-7x19-galvanised", 20.0),
        ("forestali-6x19m-fc-galvanised-1770", 20.0),
        ("unirope-7x7-galvanised", 25.0),
        ("unirope-1x19-galvanised", 25.0),
        ("superline-hmpe", None),
    ],
)
def test_class_of_a_rope(grade_id: str, ratio: float | None) -> None:
    found = least_sheave_ratio(GRADES[grade_id])
    assert (None if found is None else found[0]) == ratio


def test_stainless_in_parallel_lay_takes_a_larger_sheave() -> None:
    stainless = replace(GRADES["unirope-6x36-iwrc-1960"], material="stainless steel")
    assert least_sheave_ratio(stainless) == (20.0, "stainless, parallel lay")


def test_the_larger_of_both_ratios_counts_and_is_named() -> None:
    grade = GRADES["unirope-7x7-galvanised"]
    assert grade.sheave_ratio is not None
    maker, size = grade.sheave_ratio.minimum, grade.sizes[0]
    plain = Selection(sheave_diameter_m=0.1)
    (given,) = sheave_ratio_of(grade, size, plain)
    assert (given.demand, given.source) == (maker, f"table of {grade.id}")
    bent = replace(grade, sheave_ratio=replace(grade.sheave_ratio, minimum=18.0))
    (asked,) = sheave_ratio_of(bent, size, replace(plain, duty_class="M3"))
    assert asked.demand == 25.0
    assert "crane ordinance" in asked.source
    (kept,) = sheave_ratio_of(grade, size, replace(plain, duty_class="M3"))
    assert kept.demand == max(maker, 25.0)
    unknown = replace(grade, sheave_ratio=None)
    assert not [*sheave_ratio_of(unknown, size, plain)]
    (told,) = sheave_ratio_of(unknown, size, replace(plain, duty_class="M3"))
    assert told.demand == 25.0
