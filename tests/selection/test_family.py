"""What load cases need of the configured family: put back in, it serves, and thinner fails."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from designer.effects.design import AsBuilt
from designer.model.cable import Material
from designer.model.load_case import Ice, LoadCase, Wind
from designer.model.region import PointList, Prism
from designer.model.robot import Platform, Poses, Robot
from designer.model.workspace import Workspace
from designer.selection.family import family_need, governing_need
from designer.statics.cable_loss import settle
from designer.statics.inverse import solve_sagging
from designer.workspace.sweep import map_workspace

ROBOT = Robot(
    np.array([[0, 0, 11.5], [30, 1, 12.5], [14, 26, 11.0]]), Platform(180.0, drag_area_m2=0.6)
)
FAMILY = Material(5290.0, 62.7e9, 198e6)
PLACES = np.random.default_rng(3).uniform([8, 5, 1], [19, 13, 8], (25, 3))
POINTS = Workspace(PointList(PLACES))
CASES = [
    LoadCase("hoisting", mass_kg=240.0, dynamic_factor=1.2),
    LoadCase("storm", wind=Wind(16.0, 1.2, count=3), ice=Ice(0.008)),
    LoadCase("cold", temperature_change_K=-50.0),
    LoadCase("lost", cable_lost=2),
]


def largest_N(case: LoadCase, diameter_m: float) -> float:
    """Return the largest tension at all points in all directions, by the solvers alone."""
    cable, places = FAMILY.cable(diameter_m), Poses.at(PLACES)
    largest = []
    for one in case.on(ROBOT, cable):
        if one.keeps_lengths:
            found = settle(one.robot, places, one.cable, one.lost_cable, one.growth)
            largest.append(float(found.largest_tension_N.max()))
        else:
            largest.append(
                float(solve_sagging(one.robot, places, one.cable).largest_tension_N.max())
            )
    return max(largest)


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize("case", CASES, ids=[case.name for case in CASES])
def test_the_diameter_serves_and_a_thinner_one_does_not(case: LoadCase) -> None:
    need = family_need(AsBuilt(ROBOT), POINTS, FAMILY, case)
    allowable = FAMILY.cable(need.diameter_m).allowable_tension_N
    assert largest_N(case, need.diameter_m) == pytest.approx(allowable, rel=1e-6)
    thinner = 0.999 * need.diameter_m
    assert largest_N(case, thinner) > FAMILY.cable(thinner).allowable_tension_N
    met = need.governing.verification.max_tension_N
    assert met == pytest.approx(allowable, rel=1e-6)


def test_the_static_case_needs_what_the_map_says() -> None:
    workspace = Workspace(Prism.box((8, 20), (4, 14), (1, 8)), samples=100)
    need = family_need(AsBuilt(ROBOT), workspace, FAMILY, LoadCase("static"))
    found = map_workspace(ROBOT, workspace, FAMILY).sagging
    assert found is not None
    assert need.diameter_m == pytest.approx(found.diameter_m, rel=1e-5)


def test_a_case_that_nothing_holds_governs() -> None:
    above = replace(POINTS, region=PointList(np.array([[14.0, 9.0, 14.0]])))
    none = family_need(AsBuilt(ROBOT), above, FAMILY, LoadCase("above"))
    some = family_need(AsBuilt(ROBOT), POINTS, FAMILY, LoadCase("static"))
    assert not none.is_held
    assert governing_need([some, none]) is none
    assert governing_need([]) is None
