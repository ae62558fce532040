"""Equilibrium of poses: residuals by the paper's own equations, symmetries, verdicts."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from designer.arrays import frozen_array
from designer.kernel import answer as kernel
from designer.model.cable import Cable
from designer.model.robot import Platform, Poses, Robot
from designer.model.verdict import Verdict
from designer.statics.inverse import solve_massless, solve_sagging


def poses_below(robot: Robot, count: int, seed: int) -> Poses:
    rng = np.random.default_rng(seed)
    weights = rng.dirichlet(np.ones(robot.n_cables), count)
    position = weights @ robot.exit_points_m
    position[:, 2] = rng.uniform(-150, -20, count)
    if robot.is_point_mass:
        return Poses.at(position)
    return Poses.at(position, rng.normal(0, 0.05, (count, 3)))


@pytest.fixture(params=["fast_robot", "six_cable_robot"])
def robot(request) -> Robot:
    return request.getfixturevalue(request.param)


@pytest.mark.cases_by_default(1)
def test_solved_poses_close_by_the_papers_equations(robot, steel) -> None:
    statics = solve_sagging(robot, poses_below(robot, 1000, 1), steel.cable(0.03))
    solved = statics.is_solved
    assert solved.mean() > 0.9
    closure = statics.closure_residual_m()[solved] / statics.length_m[solved]
    force = np.abs(statics.equilibrium_residual_N()[solved]).max(axis=1)
    assert closure.max() < 1e-8
    assert (force / statics.largest_tension_N[solved]).max() < 1e-8


def test_unsolved_poses_carry_no_number(robot, steel) -> None:
    poses = poses_below(robot, 200, 2)
    high = Poses.at(poses.position_m + np.array([0, 0, 300.0]))
    statics = solve_sagging(robot, high, steel.cable(0.03))
    failed = ~statics.is_solved
    assert failed.any()
    assert np.isnan(statics.length_m[failed]).all()
    assert np.isnan(statics.exit_tension_N[failed]).all()


def test_batch_equals_loop(robot, steel) -> None:
    poses = poses_below(robot, 40, 3)
    cable = steel.cable(0.03)
    batch = solve_sagging(robot, poses, cable)
    for k in range(40):
        rotation = poses.rotation if robot.is_point_mass else poses.rotation[k]
        one = solve_sagging(robot, Poses(poses.position_m[k], rotation), cable)
        assert one.verdict == batch.verdict[k]
        assert np.allclose(one.length_m, batch.length_m[k], rtol=1e-10, equal_nan=True)


def test_any_leading_axes(fast_robot, steel) -> None:
    grid = poses_below(fast_robot, 12, 4).position_m.reshape(3, 4, 3)
    statics = solve_sagging(fast_robot, Poses.at(grid), steel.cable(0.03))
    assert statics.verdict.shape == (3, 4)
    assert statics.length_m.shape == (3, 4, 3)
    flat = solve_sagging(fast_robot, Poses.at(grid.reshape(-1, 3)), steel.cable(0.03))
    assert np.array_equal(statics.length_m.reshape(-1, 3), flat.length_m)


def test_turning_everything_about_the_vertical_changes_nothing(robot, steel) -> None:
    poses = poses_below(robot, 50, 5)
    turn = Rotation.from_rotvec([0, 0, 0.7]).as_matrix()
    turned_robot = Robot(frozen_array(robot.exit_points_m @ turn.T), robot.platform)
    turned = Poses(poses.position_m @ turn.T, turn @ np.broadcast_to(poses.rotation, (50, 3, 3)))
    if robot.is_point_mass:
        turned = Poses.at(turned.position_m)
    cable = steel.cable(0.03)
    before = solve_sagging(robot, poses, cable)
    after = solve_sagging(turned_robot, turned, cable)
    both = before.is_solved & after.is_solved
    assert both.mean() > 0.9
    assert np.allclose(after.length_m[both], before.length_m[both], rtol=1e-8)


def test_massless_balances_and_is_the_limit_of_light_cables(robot, steel) -> None:
    poses = poses_below(robot, 300, 6)
    massless = solve_massless(robot, poses)
    held = np.all(massless.tension_N > 0, axis=1)
    light = [solve_sagging(robot, poses, steel.cable(d)) for d in (1e-3, 0.5e-3)]
    gap = [np.abs(s.platform_tension_N - massless.tension_N)[held].max() for s in light]
    assert gap[1] < 0.26 * gap[0] + 1e-3  # proportional to the weight, hence to d²
    stretch = steel.elastic_compliance_per_m  # the length differs by elasticity as well
    assert stretch > 0


def test_pose_outside_the_hull(fast_robot, steel) -> None:
    statics = solve_sagging(
        fast_robot, Poses.at([[-50.0, 100, -50], [250, 200, 20]]), steel.cable(0.03)
    )
    assert list(statics.verdict) == [Verdict.OUTSIDE_HULL] * 2


def test_cable_straight_above_the_load(steel) -> None:
    """A vertical cable has no horizontal distance; the others still share the load."""
    exits = [[0, 0, 0], [100, 0, 0], [-50, 80, 0], [-50, -80, 0]]
    robot = Robot(frozen_array(exits[1:]), Platform(500.0))
    above = solve_massless(robot, Poses.at([100.0, 0.0, -30.0]))
    assert above.tension_N[0] == pytest.approx(500 * 9.81)
    near = solve_sagging(robot, Poses.at([99.0, 0.0, -30.0]), steel.cable(0.005))
    assert near.is_solved


def test_hangs_below_is_flagged(fast_robot, steel) -> None:
    statics = solve_sagging(
        fast_robot, Poses.at([[250.0, 200, -50], [250, 20, -40]]), steel.cable(0.04)
    )
    assert list(statics.hangs_below) == [False, True]


@pytest.mark.parametrize("verdict", list(Verdict))
def test_each_verdict_has_a_label_and_a_sentence(verdict) -> None:
    assert verdict.label == verdict.name.lower()
    assert verdict.reason
    assert verdict.sentence.endswith(".")
    if verdict is not Verdict.NO_LENGTH:  # found before the kernel is called
        assert getattr(kernel, verdict.name) == int(verdict)


def test_cables_lighter_than_asked_for_are_no_answer() -> None:
    """The way down from light cables may end early: what balances then has another weight."""
    exits = [[94.54, -64.46, -4.53], [-50.78, 102.54, 0.29], [-102.48, -50.91, 0.53]]
    robot = Robot(frozen_array(exits), Platform(2.26))
    cable = Cable(0.01, 0.0943, 4.8e7, 1e9)
    near = np.random.default_rng(0).normal([93.5, -64.04, -236.8], 1.0, (500, 3))
    statics = solve_sagging(robot, Poses.at(near), cable)
    solved = statics.is_solved
    assert solved.sum() > 50
    assert statics.weight_N_per_m[solved] == pytest.approx(cable.weight_N_per_m, rel=1e-15)
    closure = statics.closure_residual_m()[solved] / statics.length_m[solved]
    assert closure.max() < 1e-9
