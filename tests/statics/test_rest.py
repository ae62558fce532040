"""Where a platform rests on the lengths of a pose, and where else it could."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from sample_robots import COGIRO, COGIRO_CABLE

from designer.arrays import frozen_array
from designer.model.cable import Cable
from designer.model.robot import Platform, Poses, Robot
from designer.statics.inverse import solve_sagging
from designer.statics.rest import RestingPlaces, resting_places, spread_poses

ROPE = Cable(float("nan"), 0.1, 3e6, float("inf"))


def rest_of(robot: Robot, pose: Poses, cable: Cable = ROPE) -> RestingPlaces:
    statics = solve_sagging(robot, pose, cable)
    assert statics.is_solved
    return resting_places(robot, pose, cable, statics.length_m)


def test_a_point_mass_under_three_masts_rests_in_one_place() -> None:
    crane = Robot(frozen_array([[0, 0, 12], [30, 0, 12], [15, 26, 12]]), Platform(180.0))
    found = rest_of(crane, Poses.at([15.0, 9.0, 4.0]))
    assert (found.is_stable, found.others, found.starts) == (True, 0, 25)
    assert math.isnan(found.nearest_m)
    assert "nowhere else" in found.sentence


def test_a_platform_in_crossed_cables_could_also_rest_twisted() -> None:
    pose = Poses.at([1.0, 0.5, 1.5])
    found = rest_of(COGIRO, pose, COGIRO_CABLE)
    assert found.is_stable
    assert found.others >= 1
    assert found.nearest_m > 0.1
    assert found.nearest_turn_rad > 0.5
    assert "could also rest" in found.sentence


def test_a_load_high_above_its_cables_does_not_stay() -> None:
    platform = replace(COGIRO.platform, centre_of_mass_m=frozen_array([0.0, 0.0, 1e4]))
    found = rest_of(replace(COGIRO, platform=platform), Poses.at([0.0, 0.0, 1.5]), COGIRO_CABLE)
    assert not found.is_stable
    assert "would not stay" in found.sentence


def test_the_nearest_other_place_is_told() -> None:
    told = RestingPlaces(25, True, 2, 0.312, math.radians(84.0)).sentence
    assert "2 other places, the nearest 0.31 m away, turned by 84°" in told
    assert "not stable" in RestingPlaces(25, False, 0, math.nan, math.nan).sentence


def test_starts_of_a_planar_robot_lie_in_its_plane() -> None:
    facade = Robot(
        frozen_array([[0, 3, 0], [0, 13, 0], [0, 3, 20], [0, 13, 20]]),
        Platform(100.0, frozen_array([[0, -1, -1], [0, 1, -1], [0, -1, 1], [0, 1, 1]])),
        is_planar=True,
    )
    starts = spread_poses(facade, 20)
    assert np.abs(starts.position_m[:, 0]).max() < 1e-12
    normal = starts.rotation @ [1.0, 0.0, 0.0]
    np.testing.assert_allclose(normal, np.broadcast_to([1.0, 0.0, 0.0], (20, 3)), atol=1e-12)
    assert np.ptp(starts.rotation[:, 1, 1]) > 0.01
