"""Platforms on kept lengths that warmth changes: by a calculation that shares no code with ours."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from redundant_robots import FOUR
from twins.loaded import Twin, acting, held, rest, tensions_N

from designer.model.cable import STEEL_EXPANSION_PER_K, Cable
from designer.model.load_case import LoadCase, Wind
from designer.model.robot import Platform, Poses, Robot
from designer.statics.cable_loss import Fate, settle
from designer.statics.inverse import solve_sagging
from designer.statics.stiffness import upright_stiffness
from designer.workspace.demand import tension_demand

EXITS = np.array([[0, 0, 11.5], [30, 1, 12.5], [14, 26, 11.0]])
CABLE = Cable(0.006, 0.13, 1.5e6, 2e4)


def twin_of(robot: Robot, cable: Cable = CABLE) -> Twin:
    return Twin(
        robot.exit_points_m, robot.platform.mass_kg, cable.axial_stiffness_N,
        cable.linear_density_kg_per_m, cable.diameter_m, drag_area_m2=0.5, cable_drag=1.2,
    )  # fmt: skip


@pytest.mark.parametrize("change_K", [60.0, -45.0])
@pytest.mark.parametrize("wind", [None, np.array([0.0, 12.0, 0.0])])
def test_platform_settles_where_the_twin_does(change_K: float, wind: np.ndarray | None) -> None:
    robot = Robot(EXITS, Platform(180.0, drag_area_m2=0.5))
    twin = twin_of(robot)
    load, place = acting(twin, wind=wind), np.array([13.0, 8.0, 8.5])
    _, length = held(twin, load, place, np.eye(3))
    longer = (1.0 + 12e-6 * change_K) * length
    at, _, pull = rest(twin, load, place, np.eye(3), longer, np.arange(3))

    blows = None if wind is None else Wind(12.0, 1.2, direction=wind)
    (one,) = LoadCase("c", wind=blows, temperature_change_K=change_K).on(robot, CABLE)
    assert one.growth == pytest.approx(12e-6 * change_K, rel=1e-15)
    assert one.keeps_lengths
    found = settle(one.robot, Poses.at(place[None]), one.cable, growth=one.growth)
    assert found.fate[0] == Fate.HOLDS
    np.testing.assert_allclose(found.rest.position_m[0], at, atol=1e-8)
    assert found.moved_m[0] > 1e-3
    np.testing.assert_allclose(found.tension_N[0], tensions_N(pull, longer, load.q), rtol=1e-7)
    asked = tension_demand(one, "include", place[None])
    assert asked[0] == pytest.approx(float(found.tension_N.max()), rel=1e-12)


@pytest.mark.parametrize("centre_m", [None, np.array([0.4, -0.3, 1.1])])
def test_body_settles_in_wind_where_the_twin_does(six_cable_robot: Robot, centre_m) -> None:
    """The moment of the wind turns with the body, on lengths that are kept."""
    body = replace(
        six_cable_robot.platform,
        centre_of_mass_m=np.array([0.2, -0.1, -0.3]), drag_area_m2=4.0, drag_centre_m=centre_m,
    )  # fmt: skip
    robot = replace(six_cable_robot, platform=body)
    cable, place = Cable(0.03, 4.0, 1e7, 4e5), np.array([4.0, -6.0, -80.0])
    wind = np.array([9.0, 12.0, 0.0])
    twin = Twin(
        robot.exit_points_m, body.mass_kg, 1e7, 4.0, 0.03, body.attachments_m,
        body.centre_of_mass_m, body.wrench_N, 4.0, centre_m, 1.2,
    )  # fmt: skip
    load = acting(twin, wind=wind)
    _, length = held(twin, load, place, np.eye(3))
    longer = (1.0 + 12e-6 * 70.0) * length
    at, turn, pull = rest(twin, load, place, np.eye(3), longer, np.arange(6))
    blows = Wind(15.0, 1.2, direction=wind)
    (one,) = LoadCase("c", wind=blows, temperature_change_K=70.0).on(robot, cable)
    found = settle(one.robot, Poses.at(place[None]), one.cable, growth=one.growth)
    np.testing.assert_allclose(found.rest.position_m[0], at, atol=1e-7)
    np.testing.assert_allclose(found.rest.rotation[0], turn, atol=1e-8)
    np.testing.assert_allclose(found.tension_N[0], tensions_N(pull, longer, load.q), rtol=1e-7)
    # As the forces turn with the body, so does the stiffness; else Newton would not end so soon.
    K = upright_stiffness(found.statics)[0]
    assert pytest.approx(K.T, abs=1e-6 * np.abs(K).max()) == K


def test_spare_cables_get_slack_or_tight() -> None:
    """The lengths are ours, since internal forces leave a choice; what follows is the twin's."""
    thick, place = Cable(0.016, 1.0, 1e7, 1e5), np.array([45.0, 38.0, -30.0])
    twin, before = twin_of(FOUR, thick), solve_sagging(FOUR, Poses.at(place[None]), thick)
    for change_K in (80.0, -80.0):
        growth = STEEL_EXPANSION_PER_K * change_K
        found = settle(FOUR, Poses.at(place[None]), thick, growth=growth)
        longer = (1.0 + growth) * before.length_m[0]
        load = acting(twin)
        at, _, pull = rest(twin, load, place, np.eye(3), longer, np.arange(4))
        np.testing.assert_allclose(found.rest.position_m[0], at, atol=1e-6)
        theirs = tensions_N(pull, longer, load.q)
        np.testing.assert_allclose(found.tension_N[0], theirs, rtol=1e-5)


def test_a_case_says_whose_coefficient_counts() -> None:
    robot = Robot(EXITS, Platform(180.0))
    fibre = Cable(0.006, 0.03, 1e6, 2e4, expansion_per_K=-1e-5)
    for given, counts in ((None, -1e-5), (2e-5, 2e-5)):
        (one,) = LoadCase("c", temperature_change_K=10.0, expansion_per_K=given).on(robot, fibre)
        assert one.growth == pytest.approx(10.0 * counts)
    (still,) = LoadCase("c").on(robot, fibre)
    assert not still.keeps_lengths
