"""What share of a breaking load counts: end fittings, bending, safety factor."""

from __future__ import annotations

import math

import pytest
from ropes import rope

from designer.model.region import Prism
from designer.model.winches import Winches
from designer.model.workspace import Workspace
from designer.selection.reeving import Allowance, bending_efficiency
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
