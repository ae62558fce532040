"""The platform's stiffness against differences of its balance, closed forms and symmetry."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sample_robots import COGIRO, COGIRO_CABLE, ROPE, poses_under
from scipy.spatial.transform import Rotation

from designer.arrays import frozen_array
from designer.model.cable import Cable
from designer.model.robot import Platform, Poses, Robot
from designer.statics.fixed_length import cables_of_length
from designer.statics.forward import solve_forward
from designer.statics.inverse import Statics, solve_sagging
from designer.statics.stiffness import (
    cable_tangent_stiffness_N_per_m,
    compliance,
    is_stable,
    largest_displacement_m_per_N,
    platform_stiffness,
    reach_m,
)


def held(robot: Robot, cable: Cable, count: int, seed: int) -> Statics:
    """Balanced poses; for more cables than degrees of freedom by forward statics."""
    poses = poses_under(robot, 2 * count, seed)
    if robot.is_square:
        good = solve_sagging(robot, poses, cable).is_solved
        assert good.sum() >= count
        rotation = poses.rotation if robot.is_point_mass else poses.rotation[good][:count]
        return solve_sagging(robot, Poses(poses.position_m[good][:count], rotation), cable)
    ends = poses.attachment_points_m(robot) - robot.exit_points_m
    lengths = np.linalg.norm(ends, axis=-1) * 0.999
    return solve_forward(robot, cable, lengths, poses).statics


def residual(statics: Statics, twist: np.ndarray) -> np.ndarray:
    """What the platform resists with after a small motion, cables fixed; base frame."""
    robot = statics.robot
    turn = Rotation.from_rotvec(twist[3:]).as_matrix() if len(twist) == 6 else np.eye(3)
    moved = Poses(statics.poses.position_m + twist[:3], turn @ statics.poses.rotation)
    at = cables_of_length(
        robot,
        moved,
        statics.length_m,
        statics.axial_stiffness_N,
        statics.weight_N_per_m,
        statics.force_N,
    )
    left = at.equilibrium_residual_N().reshape(*moved.shape, -1, 3)
    return (left @ robot.upright).reshape(*moved.shape, -1)


ROBOTS = ["fast", "fast on pulleys, tilted", "six", "six on pulleys, tilted", "cogiro"]


@pytest.fixture
def robots(fast_robot, six_cable_robot) -> dict[str, tuple[Robot, Cable]]:
    as_built = {"pulley_radius_m": 0.8, "tilt_rad": frozen_array([0.02, -0.03])}
    return {
        "fast": (fast_robot, ROPE),
        "fast on pulleys, tilted": (replace(fast_robot, **as_built), ROPE),
        "six": (six_cable_robot, ROPE),
        "six on pulleys, tilted": (replace(six_cable_robot, **as_built), ROPE),
        "cogiro": (COGIRO, COGIRO_CABLE),
    }


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize("name", ROBOTS)
def test_against_differences_of_the_balance(robots, name: str) -> None:
    robot, cable = robots[name]
    statics = held(robot, cable, 20, 1)
    assert statics.is_solved.all()
    K = platform_stiffness(statics)
    size = np.abs(K).max(axis=(-2, -1), keepdims=True)
    h = 1e-5
    for k, direction in enumerate(np.eye(robot.degrees_of_freedom)):
        by = (residual(statics, h * direction) - residual(statics, -h * direction)) / (2.0 * h)
        assert np.abs(by - K[..., k]).max() < 1e-6 * size.max()


@pytest.mark.parametrize("name", ["fast", "six", "cogiro"])
def test_symmetric_in_balance_and_unchanged_by_a_turn_about_the_vertical(robots, name) -> None:
    robot, cable = robots[name]
    statics = held(robot, cable, 10, 2)
    K = platform_stiffness(statics)
    assert np.allclose(K, np.swapaxes(K, -1, -2), rtol=1e-7, atol=1e-7 * np.abs(K).max())
    Q = Rotation.from_rotvec([0.0, 0.0, 0.7]).as_matrix()
    turned_robot = replace(robot, exit_points_m=frozen_array(robot.exit_points_m @ Q.T))
    poses = statics.poses
    turned = Poses(poses.position_m @ Q.T, Q @ poses.rotation)
    after = platform_stiffness(
        replace(
            statics,
            robot=turned_robot,
            poses=turned,
            run=replace(statics.run, exit_points_m=turned_robot.exit_points_m),
        )
    )
    both = np.kron(np.eye(robot.degrees_of_freedom // 3), Q)
    assert np.allclose(after, both @ K @ both.T, rtol=1e-9, atol=1e-9 * np.abs(K).max())


def test_a_pendulum() -> None:
    """A weight on one light, stiff cable swings with m g / l and stretches with EA / l."""
    robot = Robot(frozen_array([[0.0, 0.0, 10.0]]), Platform(100.0))
    cable = Cable(0.01, 1e-9, 1e8, 1e6)
    statics = solve_forward(robot, cable, np.array([8.0]), Poses.at([1.0, 0.5, 3.0])).statics
    K = platform_stiffness(statics)
    pull = 100.0 * 9.81
    stretched = 8.0 * (1.0 + pull / 1e8)
    assert np.allclose(np.diag(K), [pull / stretched, pull / stretched, 1e8 / 8.0], rtol=1e-7)
    assert largest_displacement_m_per_N(statics) == pytest.approx(stretched / pull, rel=1e-7)


def test_a_compound_pendulum_turns_against_its_weight() -> None:
    """Held at one point by one cable, its centre of mass h below: K about a level axis is m g h."""
    point = frozen_array(np.zeros((1, 3)))
    body = Platform(100.0, point, frozen_array([0.0, 0.0, -0.7]))
    robot = Robot(frozen_array([[0.0, 0.0, 10.0]]), body)
    found = solve_forward(
        robot, Cable(0.01, 1e-6, 1e8, 1e6), np.array([8.0]), Poses.at([0, 0, 2.0], [0.1, 0, 0])
    )
    K = platform_stiffness(found.statics)
    assert np.allclose(np.diag(K)[3:], [100 * 9.81 * 0.7, 100 * 9.81 * 0.7, 0.0], atol=1e-6)
    assert not found.is_stable  # nothing keeps it from spinning about the vertical
    assert np.isnan(compliance(found.statics)).all()


def test_displacement_is_what_forward_statics_finds_under_a_small_force(robots) -> None:
    robot, cable = robots["six"]
    statics = held(robot, cable, 1, 3)
    force = np.array([[3.0, -2.0, 1.0]])
    moved = solve_forward(robot, cable, statics.length_m, statics.poses, force)
    displacement = moved.poses.position_m - statics.poses.position_m
    predicted = np.einsum("...ij,...j->...i", compliance(statics)[..., :3, :3], force)
    assert np.allclose(displacement, predicted, rtol=2e-3)
    assert (
        np.linalg.norm(displacement)
        <= 1.002 * np.linalg.norm(force) * (largest_displacement_m_per_N(statics)[0])
    )


def test_unsolved_poses_carry_no_stiffness(fast_robot) -> None:
    statics = solve_sagging(fast_robot, Poses.at([[250.0, 200, -50], [-50, 0, -50]]), ROPE)
    displacement = largest_displacement_m_per_N(statics)
    assert np.isfinite(displacement[0])
    assert np.isnan(displacement[1])
    assert list(is_stable(fast_robot, platform_stiffness(statics))) == [True, False]


def test_cables_of_different_make(six_cable_robot) -> None:
    """Weight and stiffness may differ from cable to cable; equal ones give the same either way."""
    poses = poses_under(six_cable_robot, 5, 4)
    alike = solve_sagging(six_cable_robot, poses, ROPE)
    each = replace(
        alike,
        weight_N_per_m=alike.weight_N_per_m * np.ones(6),
        axial_stiffness_N=alike.axial_stiffness_N * np.ones(6),
    )
    assert np.array_equal(platform_stiffness(each), platform_stiffness(alike))
    softer = replace(each, axial_stiffness_N=each.axial_stiffness_N * [1, 1, 1, 1, 1, 0.5])
    K, before = cable_tangent_stiffness_N_per_m(softer), cable_tangent_stiffness_N_per_m(alike)
    assert np.array_equal(K[:, :5], before[:, :5])
    assert (
        np.trace(K[:, 5], axis1=-2, axis2=-1) < np.trace(before[:, 5], axis1=-2, axis2=-1)
    ).all()
    assert reach_m(six_cable_robot) == pytest.approx(5.0)


@pytest.fixture
def planar() -> Robot:
    """Two cables from a gantry to a body in the plane y = x, with gravity along -z."""
    exits = [[0.0, 0, 12], [20.0, 20, 12], [0.0, 0, 11]]
    body = Platform(200.0, frozen_array([[-1.0, -1, 0], [1.0, 1, 0], [-1.0, -1, -1]]))
    return Robot(frozen_array(exits), body, is_planar=True)


def test_a_planar_robot_against_differences_of_its_balance(planar: Robot) -> None:
    start = Poses.at([[9.0, 9.0, 4.0]], [[0.0, 0, 0]])
    ends = start.attachment_points_m(planar) - planar.exit_points_m
    lengths = np.linalg.norm(ends, axis=-1)
    found = solve_forward(planar, ROPE, lengths, start)
    statics = found.statics
    assert statics.is_solved.all()
    assert found.is_stable.all()
    x, y, _ = statics.poses.position_m[0]
    assert x == pytest.approx(y, abs=1e-9)
    K = platform_stiffness(statics)[0]
    assert K.shape == (3, 3)
    axes = np.array([planar.upright.T @ e for e in np.eye(3)])
    h = 1e-5
    motions = [(h * axes[0], 0.0), (h * axes[2], 0.0), (np.zeros(3), h)]
    for k, (shift, turn) in enumerate(motions):
        sides = []
        for sign in (1.0, -1.0):
            Q = Rotation.from_rotvec(sign * turn * axes[1]).as_matrix()
            moved = Poses(statics.poses.position_m + sign * shift, Q @ statics.poses.rotation)
            at = cables_of_length(
                planar,
                moved,
                statics.length_m,
                statics.axial_stiffness_N,
                statics.weight_N_per_m,
            )
            sides.append(at.equilibrium_residual_N()[0])
        by = (sides[0] - sides[1]) / (2.0 * h)
        assert np.abs(by - K[:, k]).max() < 1e-6 * np.abs(K).max()
    displacement = largest_displacement_m_per_N(statics)[0]
    C = np.linalg.inv(K)[:2, :2]
    assert displacement == pytest.approx(np.linalg.norm(C, 2), rel=1e-9)


def test_gravity_along_another_axis_is_only_another_frame(six_cable_robot) -> None:
    """The same robot, with its base frame turned so that things fall along +x."""
    poses = poses_under(six_cable_robot, 4, 8)
    statics = solve_sagging(six_cable_robot, poses, ROPE)
    Q = Rotation.from_euler("y", 90.0, degrees=True).as_matrix()
    turned = replace(
        six_cable_robot,
        exit_points_m=frozen_array(six_cable_robot.exit_points_m @ Q.T),
        gravity_direction=frozen_array(Q @ [0.0, 0.0, -1.0]),
    )
    seen = Poses(poses.position_m @ Q.T, Q @ poses.rotation)
    found = solve_forward(
        turned, ROPE, statics.length_m[:1], Poses(seen.position_m[:1] + 0.3, seen.rotation[:1])
    )
    assert np.allclose(found.poses.position_m, seen.position_m[:1], atol=1e-8)
    both = np.kron(np.eye(2), Q)
    K = platform_stiffness(statics)[0]
    assert np.allclose(
        platform_stiffness(found.statics)[0],
        both @ K @ both.T,
        rtol=1e-6,
        atol=1e-6 * np.abs(K).max(),
    )
