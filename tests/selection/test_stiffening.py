"""Ropes whose stiffness depends on their tension: it is that at the tension met in each case."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import pytest
from grade_samples import family_grade
from scipy.optimize import brentq

from designer.effects.design import AsBuilt
from designer.grades.grade import Grade, RelativeStiffness
from designer.model.cable import Cable, Stiffening
from designer.model.load_case import LoadCase, Wind
from designer.model.region import PointList, Prism
from designer.model.robot import Platform, Poses, Robot
from designer.model.workspace import Workspace
from designer.progress import Advance
from designer.selection.candidate import candidates_of, undominated
from designer.selection.cases import converge_stiffness
from designer.selection.groups import MOST_PROPOSALS, choose_groups_of
from designer.selection.result import SelectionResult
from designer.selection.select import select
from designer.statics.cable_loss import settle
from designer.statics.inverse import solve_sagging
from designer.study import CableGroup, Selection

ROBOT = Robot(
    np.array([[0, 0, 11.5], [30, 1, 12.5], [14, 26, 11.0]]), Platform(180.0, drag_area_m2=0.6)
)
PLACES = np.random.default_rng(3).uniform([8, 5, 1], [19, 13, 8], (25, 3))
POINTS = Workspace(PointList(PLACES))
CASES = (
    LoadCase("rest"),
    LoadCase("strict", safety_factor=6.0),
    LoadCase("heavy", mass_kg=240.0),
    LoadCase("storm", wind=Wind(12.0, 1.2, count=3)),
    LoadCase("cold", temperature_change_K=-50.0),
    LoadCase("lost", cable_lost=2, safety_factor=2.0),
)
LAW = RelativeStiffness((4.0, 30.0, 40.0), (0.02, 0.3, 0.6), "printed", "made up for a test", 0.1)


def fibre(law: RelativeStiffness = LAW, diameters_mm: tuple[float, ...] = (6.0, 8.0)) -> Grade:
    grade = family_grade(700.0, breaking_stress_Pa=9e8, diameters_mm=diameters_mm)
    return replace(grade, modulus=None, stiffness=law, material="HMPE")


def chosen_in(
    workspace: Workspace,
    cases: tuple[LoadCase, ...],
    safety_factor: float = 3.0,
    proof_s: float = 0.0,
) -> SelectionResult:
    selection = Selection(safety_factor=safety_factor, objectives=("mass",))
    built = AsBuilt(ROBOT)
    return select(
        ROBOT, workspace, selection, [fibre()], built=built, load_cases=cases, proof_s=proof_s
    )


def largest_N(case: LoadCase, cable: Cable, words: str) -> float:
    """Return the largest tension at all points in one direction, by the solvers alone."""
    (one,) = (loaded for loaded in case.on(ROBOT, cable) if loaded.words == words)
    places = Poses.at(PLACES)
    if one.keeps_lengths:
        found = settle(one.robot, places, one.cable, one.lost_cable, one.growth)
        return float(found.largest_tension_N.max())
    return float(solve_sagging(one.robot, places, one.cable).largest_tension_N.max())


@pytest.mark.slow
def test_each_case_has_the_stiffness_at_its_own_tension() -> None:
    chosen = chosen_in(POINTS, CASES).chosen
    assert chosen is not None
    breaking_N = chosen.size.minimum_breaking_load_N
    for found in chosen.cases:
        bare = found.loaded.bare[1]

        def off(stiffness_N: float, case=found.case, words=found.loaded.words, bare=bare) -> float:
            cable = replace(bare, axial_stiffness_N=stiffness_N)
            fraction = largest_N(case, cable, words) / breaking_N
            return float(np.interp(fraction, LAW.load_fraction, LAW.ea_over_breaking_load)) - (
                stiffness_N / breaking_N
            )

        expected_N = brentq(off, 4.0 * breaking_N, 40.0 * breaking_N, rtol=1e-9)
        assert found.loaded.cable.axial_stiffness_N == pytest.approx(expected_N, rel=3e-6)
    stiffness = {one.case.name: one.loaded.cable.axial_stiffness_N for one in chosen.cases}
    assert stiffness["strict"] == stiffness["rest"]
    assert stiffness["heavy"] > 1.05 * stiffness["rest"]
    assert chosen.cable.axial_stiffness_N == chosen.governing.loaded.cable.axial_stiffness_N


def test_the_safety_factor_is_not_in_it() -> None:
    few, many = (chosen_in(POINTS, (), factor).candidates for factor in (1.5, 4.0))
    for one, other in zip(few, many, strict=True):
        stiffness_N = pytest.approx(other.cable.axial_stiffness_N, rel=1e-12)
        assert one.cable.axial_stiffness_N == stiffness_N
        assert one.cable.allowable_tension_N > other.cable.allowable_tension_N


@pytest.mark.slow
def test_the_tension_is_that_between_the_samples() -> None:
    workspace = Workspace(Prism.box((8, 19), (5, 13), (1, 8)), samples=20)
    found = chosen_in(workspace, CASES[:3], proof_s=2.0)
    assert found.chosen is not None
    for one in found.chosen.cases:
        cable = one.loaded.cable
        assert cable.stiffening is not None
        met_N = one.verification.max_tension_N
        assert cable.axial_stiffness_N == pytest.approx(cable.stiffening.at(met_N), rel=1e-6)
    governing = found.chosen.governing
    statics = solve_sagging(governing.loaded.robot, governing.pose, governing.loaded.cable)
    assert float(statics.largest_tension_N[0]) == pytest.approx(
        governing.verification.max_tension_N, rel=1e-9
    )
    assert found.proof is not None
    assert found.proof.found == pytest.approx(governing.utilisation, rel=1e-9)


@pytest.mark.parametrize("exponent", [0.3, 0.9, -0.9])
def test_a_stiffness_that_moves_its_own_tension_is_found(exponent: float) -> None:
    """Where the tension grows with the stiffness, plain turns would come near it too slowly."""
    rising = np.geomspace(0.01, 1.0, 40)
    law = Stiffening(tuple(1e4 * rising), tuple(2e5 * rising**exponent))
    start = Cable(0.01, 0.1, 1e4, 1e4, stiffening=law)

    def max_tension_N(cable: Cable) -> float:
        return 1e3 * (cable.axial_stiffness_N / 1e5)

    found = converge_stiffness(start, max_tension_N)
    at_N = law.at(max_tension_N(found))
    assert found.axial_stiffness_N == pytest.approx(at_N, rel=2e-6)


def test_one_stiffness_for_all_tensions_is_left_alone() -> None:
    grade = family_grade()
    cable = grade.cable(grade.sizes[0], 5.0)
    assert cable.stiffening is None
    assert cable.at_tension(1e3) is cable
    one_figure = fibre(replace(LAW, ea_over_breaking_load=(56.0,), load_fraction=(0.2,)))
    assert one_figure.cable(one_figure.sizes[0], 5.0).stiffening is None


def test_an_effect_changes_all_of_the_stiffness() -> None:
    grade = fibre()
    cable = grade.cable(grade.sizes[0], 5.0)
    built = AsBuilt(ROBOT, lambda one: replace(one, axial_stiffness_N=0.5 * one.axial_stiffness_N))
    changed = built.cable(cable)
    for tension_N in (100.0, 3e3, 2e4):
        there = changed.at_tension(tension_N).axial_stiffness_N
        assert there == pytest.approx(0.5 * cable.at_tension(tension_N).axial_stiffness_N)


def test_groups_have_the_stiffness_at_their_largest_tension() -> None:
    groups = (CableGroup("a", (1,)), CableGroup("b", (2, 3)))
    selection = Selection(safety_factor=5.0, groups=groups)
    choice = choose_groups_of(
        POINTS, selection, [fibre(diameters_mm=(4.0, 5.0, 6.0))], AsBuilt(ROBOT), None
    )
    assert choice.chosen.is_found
    tension_N = choice.chosen.max_tension_N
    assert math.isfinite(tension_N)
    for product in choice.chosen.ropes:
        expected = product.cable.at_tension(tension_N).axial_stiffness_N
        assert product.cable.axial_stiffness_N == pytest.approx(expected, rel=1e-3)


def test_a_bar_advances_by_one_with_each_proposal_for_groups() -> None:
    steps: list[int] = []

    class Counter:
        @contextmanager
        def task(self, name: str, total: int) -> Iterator[Advance]:
            assert total == MOST_PROPOSALS
            yield steps.append

    selection = Selection(
        safety_factor=5.0, groups=(CableGroup("a", (1,)), CableGroup("b", (2, 3)))
    )
    steel = family_grade(700.0, diameters_mm=(3.0, 4.0, 5.0, 6.0))  # chosen in a single round
    choice = choose_groups_of(POINTS, selection, [steel], AsBuilt(ROBOT), None, Counter())
    assert sum(steps) == len(choice.proposals) > 0


def test_no_rope_is_beaten_by_one_that_may_be_the_stiffer() -> None:
    """A weaker rope that is softer where both may be: it is what is met that tells."""
    (strong,) = candidates_of(Selection(), [fibre(diameters_mm=(6.0,))], AsBuilt(ROBOT))
    breaking_N = 0.9 * strong.cable.allowable_tension_N
    weak = replace(strong, cable=replace(strong.cable, allowable_tension_N=breaking_N))
    assert undominated([strong, weak]) == (strong,)
    assert undominated([strong, weak], at_any_tension=True) == (strong, weak)
    assert weak.cable.stiffening is not None
    stiffest_N = max(weak.cable.stiffening.axial_stiffness_N)
    steel = replace(weak.cable, axial_stiffness_N=stiffest_N, stiffening=None)
    stiff = replace(weak, cable=steel)
    assert undominated([strong, stiff], at_any_tension=True) == (strong,)
