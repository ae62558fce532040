"""Gravity in any direction, a wrench beside it, and robots that lie in a vertical plane."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from designer.arrays import FloatArray, frozen_array
from designer.model.cable import STANDARD_GRAVITY_M_PER_S2 as G
from designer.model.cable import Material
from designer.model.region import Rectangle
from designer.model.robot import Platform, Poses, Robot, vertical_frame
from designer.model.verdict import Verdict
from designer.sizing.newton import size_poses
from designer.statics.inverse import Statics, solve_massless, solve_sagging

STEEL = Material(7800.0, 200e9, 180e6)


def left_over(statics: Statics, robot: Robot) -> tuple[FloatArray, FloatArray]:
    """Force and moment left on the platform of one pose, summed in the base frame by vectors."""
    back = robot.upright.T
    outward = statics.geometry().outward
    force = np.zeros(3)
    moment = np.zeros(3)
    for i in range(robot.n_cables):
        on_cable = np.array(
            [*(statics.force_x_N[i] * outward[i]), statics.force_z_N[i]], dtype=np.float64
        )
        pull = -(back @ on_cable)
        lever = statics.poses.rotation @ robot.attachments_m[i]
        force += pull
        moment += np.cross(lever, pull)
    down = robot.gravity_direction / np.linalg.norm(robot.gravity_direction)
    weight = robot.platform.mass_kg * G * down
    arm = statics.poses.rotation @ robot.platform.centre_of_mass_m
    applied = robot.platform.wrench_N
    return force + weight + applied[:3], moment + np.cross(arm, weight) + applied[3:]


def test_a_wrench_is_balanced(six_cable_robot: Robot) -> None:
    wrench = frozen_array([300.0, -200.0, -5000.0, 900.0, -700.0, 400.0])
    robot = replace(six_cable_robot, platform=replace(six_cable_robot.platform, wrench_N=wrench))
    pose = Poses.at([3.0, -4.0, -80.0], [0.01, -0.02, 0.03])
    statics = size_poses(robot, pose, STEEL).statics
    assert statics.is_solved
    force, moment = left_over(statics, robot)
    np.testing.assert_allclose(force, 0.0, atol=1e-6)
    np.testing.assert_allclose(moment, 0.0, atol=1e-5)
    # The platform's own residual has it too: without the wrench it shows.
    without = replace(statics, robot=six_cable_robot)
    np.testing.assert_allclose(np.abs(without.equilibrium_residual_N()), np.abs(wrench), atol=1e-5)


def test_a_downward_force_is_as_good_as_mass(six_cable_robot: Robot) -> None:
    body = replace(six_cable_robot.platform, centre_of_mass_m=frozen_array(np.zeros(3)))
    heavy = replace(six_cable_robot, platform=replace(body, mass_kg=body.mass_kg + 100.0))
    pushed = replace(
        six_cable_robot,
        platform=replace(body, wrench_N=frozen_array([0, 0, -100.0 * G, 0, 0, 0])),
    )
    pose = Poses.at([3.0, -4.0, -80.0])
    for solve in (solve_massless, lambda r, p: solve_sagging(r, p, STEEL.cable(0.03))):
        one, other = (solve(robot, pose).largest_tension_N for robot in (heavy, pushed))
        assert one == pytest.approx(float(other), rel=1e-12)


@pytest.mark.parametrize("axis", [[0.0, 1.0, 0.0], [1.0, 2.0, 3.0], [0.0, 0.0, 1.0]])
def test_a_robot_drawn_in_another_frame_is_the_same_robot(
    six_cable_robot: Robot, axis: list[float]
) -> None:
    turn = Rotation.from_rotvec(1.2 * np.array(axis) / np.linalg.norm(axis)).as_matrix()
    wrench = np.array([300.0, -200.0, -5000.0, 900.0, -700.0, 400.0])
    body = six_cable_robot.platform
    upright = replace(six_cable_robot, platform=replace(body, wrench_N=frozen_array(wrench)))
    drawn = Robot(
        frozen_array(upright.exit_points_m @ turn.T),
        replace(body, wrench_N=frozen_array((wrench.reshape(2, 3) @ turn.T).ravel())),
        gravity_direction=frozen_array(turn @ [0.0, 0.0, -2.0]),
    )
    pose = Poses.at([3.0, -4.0, -80.0], [0.01, -0.02, 0.03])
    moved = Poses(pose.position_m @ turn.T, turn @ pose.rotation)
    one = size_poses(upright, pose, STEEL)
    other = size_poses(drawn, moved, STEEL)
    assert float(other.diameter_m) == pytest.approx(float(one.diameter_m), rel=1e-10)
    np.testing.assert_allclose(other.statics.length_m, one.statics.length_m, rtol=1e-10)
    force, moment = left_over(other.statics, drawn)
    np.testing.assert_allclose(force, 0.0, atol=1e-6)
    np.testing.assert_allclose(moment, 0.0, atol=1e-5)


@pytest.mark.parametrize("down", [[0, 0, -1], [0, 0, 1], [1, 0, 0], [0.3, -0.2, 0.5]])
def test_vertical_frame(down: list[float]) -> None:
    frame = vertical_frame(np.array(down, dtype=np.float64))
    np.testing.assert_allclose(frame @ down / np.linalg.norm(down), [0, 0, -1], atol=1e-15)
    np.testing.assert_allclose(frame @ frame.T, np.eye(3), atol=1e-15)
    assert np.linalg.det(frame) == pytest.approx(1.0)


def in_plane(points: list[list[float]], heading_rad: float, offset_m: float) -> FloatArray:
    """Points (across, up) in a vertical plane of any heading, which need not hold the origin."""
    across, up = np.array(points, dtype=np.float64).T
    along = np.array([np.cos(heading_rad), np.sin(heading_rad)])
    normal = np.array([-along[1], along[0]])
    plan = across[:, None] * along + offset_m * normal
    return np.column_stack([plan, up])


@pytest.mark.parametrize("heading", [0.0, 0.7, np.pi / 2, 2.5])
def test_two_cables_on_a_point(heading: float) -> None:
    exits = in_plane([[0, 30], [40, 30]], heading, 7.0)
    robot = Robot(frozen_array(exits), Platform(500.0), is_planar=True)
    assert robot.is_square
    assert robot.degrees_of_freedom == 2
    middle = Poses.at(in_plane([[20, 10]], heading, 7.0))
    by_hand = 0.5 * 500.0 * G / np.sin(np.pi / 4)
    np.testing.assert_allclose(solve_massless(robot, middle).tension_N[0], by_hand, rtol=1e-12)
    sizing = size_poses(robot, middle, STEEL)
    assert sizing.statics.is_solved[0]
    assert float(sizing.statics.largest_tension_N[0]) > by_hand
    tension = sizing.statics.platform_tension_N[0]
    assert tension[0] == pytest.approx(tension[1], rel=1e-10)


BODY_OF_THREE = ([[0, 30], [40, 30], [30, 30]], [[-2, 1], [2, 1], [2, 1]])
BODY_OF_FOUR = ([[0, 30], [40, 30], [40, 0], [0, 0]], [[-2, -1], [2, -1], [2, 1], [-2, 1]])


@pytest.mark.parametrize("heading", [0.0, 0.7, np.pi / 2])
@pytest.mark.parametrize(("exits", "attachments"), [BODY_OF_THREE, BODY_OF_FOUR])
def test_three_and_four_cables_on_a_body(
    heading: float, exits: list[list[float]], attachments: list[list[float]]
) -> None:
    axis = np.array([np.sin(heading), -np.cos(heading), 0.0])
    body = Platform(
        500.0,
        frozen_array(in_plane(attachments, heading, 0.0)),
        frozen_array(in_plane([[0.1, -0.2]], heading, 0.0)[0]),
        wrench_N=frozen_array([*in_plane([[50.0, -300.0]], heading, 0.0)[0], *(40.0 * axis)]),
    )
    robot = Robot(frozen_array(in_plane(exits, heading, 0.0)), body, is_planar=True)
    pose = Poses.at(in_plane([[20, 10]], heading, 0.0)[0], 0.02 * axis)
    statics = size_poses(robot, pose, STEEL).statics
    assert statics.is_solved
    force, moment = left_over(statics, robot)
    np.testing.assert_allclose(force, 0.0, atol=1e-7)
    np.testing.assert_allclose(moment, 0.0, atol=1e-6)
    assert statics.equilibrium_residual_N().shape == (3,)


def test_a_planar_robot_is_its_spatial_self_where_that_has_a_third_cable() -> None:
    """Two cables in a plane carry what they carry when a third, across it, has nothing to do."""
    exits = [[0.0, 0, 30], [40, 0, 30]]
    planar = Robot(frozen_array(exits), Platform(500.0), is_planar=True)
    spatial = Robot(frozen_array([*exits, [20, 300, 30]]), Platform(500.0))
    position = [14.0, 0.0, 10.0]
    tension = solve_massless(spatial, Poses.at(position)).tension_N
    assert tension[2] == pytest.approx(0.0, abs=1e-9)
    np.testing.assert_allclose(
        solve_massless(planar, Poses.at(position)).tension_N, tension[:2], rtol=1e-12
    )


def test_singular_pose_of_a_square_robot() -> None:
    robot = Robot(frozen_array([[0, 0, 0], [500, 0, 0], [250, 433, 0]]), Platform(4000.0))
    sizing = size_poses(robot, Poses.at([250.0, 200.0, 0.0]), STEEL)
    assert sizing.statics.verdict == Verdict.RANK_DEFICIENT
    assert np.isnan(sizing.massless_tension_N)


def test_rectangle() -> None:
    rectangle = Rectangle.over([[0, 0, 5], [8, 6, 9], [4, 3, 1]], 1.0, (2.0, 6.0))
    np.testing.assert_allclose(rectangle.size_m, [8.0, 4.0])
    np.testing.assert_allclose(rectangle.at(np.array([0.5, 0.25])), [4.0, 3.0, 3.0])
    inside = rectangle.at(np.random.default_rng(0).random((50, 2)))
    assert rectangle.contains(inside).all()
    off = inside + 0.3 * np.array([-0.6, 0.8, 0.0])
    assert not rectangle.contains(off).any()
    np.testing.assert_allclose(rectangle.nearest(off), inside, atol=1e-12)
    far = np.array([[-100.0, -75.0, 100.0], [100.0, 75.0, -100.0]])
    corners = rectangle.shares(rectangle.nearest(far))
    np.testing.assert_allclose(corners, [[0.0, 1.0], [1.0, 0.0]], atol=1e-12)
    with pytest.raises(ValueError, match="one line"):
        Rectangle.over([[0, 0], [1, 0], [0, 1]], 0.0, (0.0, 1.0))
    with pytest.raises(ValueError, match="nothing is left"):
        Rectangle.over([[0, 0], [1, 0]], 0.5, (0.0, 1.0))


def test_a_least_tension_that_the_cable_cannot_carry() -> None:
    exits = [[-85.0, -60, 40], [85, -60, 40], [85, 60, 40], [-85, 60, 40]]
    cable = STEEL.cable(0.002)
    robot = Robot(
        frozen_array(exits), Platform(14.0), tension_min_N=2.0 * cable.allowable_tension_N
    )
    pose = Poses.at([[0.0, 0.0, 8.0]])
    statics = solve_sagging(robot, pose, cable)
    # Four cables above a light load cannot all be so tight.
    assert statics.verdict[0] == Verdict.OUTSIDE_HULL
    light = replace(robot, tension_min_N=0.0)
    assert solve_sagging(light, pose, cable).is_solved[0]
    heavy = replace(robot, platform=Platform(4000.0))
    used = solve_sagging(heavy, pose, cable)
    assert used.is_solved[0]
    assert used.largest_tension_N[0] > cable.allowable_tension_N


@pytest.mark.parametrize("far_m", [0.0, 30.0, 1e4])
def test_the_plane_of_a_planar_robot_is_found_wherever_it_stands(far_m: float) -> None:
    """Across the plane the exit points do not differ, however far from the origin they are."""
    for heading in np.radians([0.0, 25.0, 90.0, 160.0]):
        along = np.array([np.cos(heading), np.sin(heading), 0.0])
        across = np.array([-np.sin(heading), np.cos(heading), 0.0])
        exits = [far_m * across + x * along + [0.0, 0.0, 5.0] for x in (0.0, 4.0, 9.0)]
        robot = Robot(frozen_array(exits), Platform(500.0), is_planar=True)
        assert np.ptp(robot.level @ robot.exit_points_m.T, axis=1)[1] < 1e-9 * max(far_m, 1.0)
