"""Equilibrium of poses: residuals, symmetries, verdicts, cables below, and straight cables."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from convex_tensions import distribute
from redundant_robots import FOUR, SEVEN, anywhere, cogiro_poses, four_poses, seven_poses
from sample_robots import COGIRO
from scipy.linalg import null_space
from scipy.optimize import LinearConstraint, linprog, minimize
from scipy.spatial.transform import Rotation

from designer.arrays import frozen_array
from designer.kernel import answer as kernel
from designer.kernel.batch import solve_massless_batch
from designer.model.cable import Cable
from designer.model.robot import Platform, Poses, Robot
from designer.model.verdict import Verdict
from designer.statics.geometry import cable_geometry, load_wrench_N, upright_situation
from designer.statics.inverse import (
    distribute_evenly,
    solve_massless,
    solve_sagging,
    tension_over_least,
)


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


SLACK = Cable(0.02, 2.0, 1e8, 1e9)
"""Heavy enough for the far cable to sag below a light load."""


def test_a_slack_cable_from_above_hangs_below() -> None:
    robot = Robot(
        np.array([[0.0, 0.0, 20.0], [60.0, 0.0, 20.0], [30.0, 50.0, 20.0]]), Platform(100.0)
    )
    poses = Poses.at([[30.0, 15.0, 0.0], [30.0, 3.0, 15.0]])
    statics = solve_sagging(robot, poses, SLACK)
    assert statics.is_solved.all()
    assert (statics.force_z_N > 0.0).any(axis=1).tolist() == [False, True]
    assert statics.hangs_below.tolist() == [False, True]


def test_a_cable_that_comes_from_below_does_not_count() -> None:
    robot = Robot(
        np.array([[-10.0, 0.0, 20.0], [10.0, 0.0, 20.0], [0.0, 12.0, 20.0], [0.0, 0.0, -5.0]]),
        Platform(100.0),
        tension_min_N=200.0,
    )
    statics = solve_sagging(robot, Poses.at([[0.0, 4.0, 2.0]]), Cable(0.005, 0.05, 1e6, 1e5))
    assert statics.is_solved.all()
    assert (statics.force_z_N[0] > 0.0).tolist() == [False, False, False, True]
    assert not statics.hangs_below.any()


CASES = {
    "cogiro": (COGIRO, anywhere(150), 600.0),
    "cogiro, taut": (replace(COGIRO, tension_min_N=100.0), anywhere(150), 600.0),
    "four": (FOUR, four_poses(60), 8000.0),
    "seven": (SEVEN, seven_poses(60), 40.0),
}


@pytest.fixture(params=CASES)
def case(request) -> tuple[Robot, Poses, float]:
    return CASES[request.param]


def unit_wrenches(robot: Robot, poses: Poses) -> np.ndarray:
    """Wrench on the platform per tension, written down once more: (poses, dof, cables)."""
    geometry = cable_geometry(robot, poses)
    ends = poses.attachment_points_m(robot)
    pull = robot.exit_points_m - ends
    pull /= np.linalg.norm(pull, axis=-1, keepdims=True)
    assert np.linalg.norm(robot.exit_points_m - ends, axis=-1) == pytest.approx(geometry.chord_m)
    if robot.is_point_mass:
        return np.swapaxes(pull, 1, 2)
    lever = ends - poses.position_m[:, None]
    return np.swapaxes(np.concatenate([pull, np.cross(lever, pull)], axis=-1), 1, 2)


def smallest_largest_N(matrix, load, low, high) -> float:
    """SciPy's answer; infinite for none."""
    dof, n = matrix.shape
    answer = linprog(
        np.eye(n + 1)[n],
        A_ub=np.hstack([np.eye(n), -np.ones((n, 1))]),
        b_ub=np.zeros(n),
        A_eq=np.hstack([matrix, np.zeros((dof, 1))]),
        b_eq=-load,
        bounds=[(low, high)] * n + [(0, None)],
    )
    return answer.fun if answer.status == 0 else np.inf


def test_smallest_largest_tension_is_that_of_linprog(case) -> None:
    robot, poses, high = case
    load, matrices = load_wrench_N(robot, poses), unit_wrenches(robot, poses)
    expected = np.array(
        [
            smallest_largest_N(m, w, robot.tension_min_N, high)
            for m, w in zip(matrices, load, strict=True)
        ]
    )
    held = np.isfinite(expected)
    assert held.any()
    found, largest_N = distribute(robot, poses, high), distribute_evenly(robot, poses).max(axis=-1)
    assert np.array_equal(found.is_feasible, held)
    assert found.largest_tension_N[held] == pytest.approx(expected[held], rel=1e-9)
    assert set(found.verdict[~held]) <= {Verdict.OUTSIDE_HULL}
    assert np.array_equal(largest_N <= high, held)
    assert largest_N[held] == pytest.approx(expected[held], rel=1e-9)


def test_a_cable_at_its_least_tension_tells_what_more_of_it_would_cost() -> None:
    robot, poses = replace(COGIRO, tension_min_N=100.0), anywhere(40)
    over = tension_over_least(robot, poses)
    tension_N = distribute_evenly(robot, poses)
    above = over > 0.0
    assert np.array_equal(np.isnan(over), np.isnan(tension_N))
    assert 0.1 < above.mean() < 0.8
    assert over[above] == pytest.approx((tension_N - 100.0)[above], rel=1e-9)
    load, matrices = load_wrench_N(robot, poses), unit_wrenches(robot, poses)
    for pose, cable in np.argwhere(over < -1e-6)[::7]:
        more_N = 0.01
        before, after = (
            linprog(
                np.append(np.zeros(robot.n_cables), 1.0),
                A_ub=np.column_stack([np.eye(robot.n_cables), -np.ones(robot.n_cables)]),
                b_ub=np.zeros(robot.n_cables),
                A_eq=np.column_stack([matrices[pose], np.zeros(6)]),
                b_eq=-load[pose],
                bounds=[(100.0 + extra_N * (k == cable), None) for k in range(robot.n_cables)]
                + [(0.0, None)],
            ).fun
            for extra_N in (0.0, more_N)
        )
        assert (after - before) / more_N == pytest.approx(-over[pose, cable], rel=1e-3, abs=1e-5)


@pytest.mark.parametrize("objective", ["smallest_largest", "least_squares", "centred"])
def test_every_answer_balances_within_bounds_and_proves_itself(case, objective) -> None:
    robot, poses, high = case
    found = distribute(robot, poses, high, objective)
    t = found.tension_N[found.is_feasible]
    rest = np.einsum("pij,pj->pi", unit_wrenches(robot, poses)[found.is_feasible], t)
    load = load_wrench_N(robot, poses)
    assert np.abs(rest + load[found.is_feasible]).max() < 1e-7 * np.abs(load).max()
    assert t.min() >= robot.tension_min_N - 1e-6
    assert t.max() <= high + 1e-6
    assert found.optimality_residual[found.is_feasible].max() < 1e-6
    assert np.isnan(found.tension_N[~found.is_feasible]).all()
    assert Verdict.NOT_CONVERGED not in found.verdict


@pytest.mark.parametrize("objective", ["least_squares", "centred"])
def test_least_squares_are_those_of_slsqp(objective) -> None:
    poses = cogiro_poses(4, 3)
    high = 800.0
    middle = high / 2 if objective == "centred" else 0.0
    found = distribute(COGIRO, poses, high, objective)
    load = load_wrench_N(COGIRO, poses)
    for k, matrix in enumerate(unit_wrenches(COGIRO, poses)):
        # In the two internal forces alone. With all eight tensions and the balance as a
        # constraint, SLSQP gives up after any number of turns, some 0.001 N off.
        one, free = np.linalg.lstsq(matrix, -load[k])[0], null_space(matrix)
        answer = minimize(
            lambda z, one=one, free=free: np.sum(((one + free @ z - middle) / high) ** 2),
            np.zeros(2),
            jac=lambda z, one=one, free=free: 2.0 * free.T @ (one + free @ z - middle) / high**2,
            constraints=LinearConstraint(free / high, -one / high, 1.0 - one / high),
            method="SLSQP",
            options={"ftol": 1e-16},
        )
        assert answer.success
        assert found.tension_N[k] == pytest.approx(one + free @ answer.x, abs=1e-6)


def test_the_separating_wrench_separates(case) -> None:
    robot, poses, high = case
    found = distribute(robot, poses, high)
    outside = found.verdict == Verdict.OUTSIDE_HULL
    wrench = found.separating_wrench[outside]
    # Of what the cables give, on the cables themselves; the load acts with the other sign.
    gain = -np.einsum("pi,pij->pj", wrench, unit_wrenches(robot, poses)[outside])
    most = np.maximum(gain * robot.tension_min_N, gain * high).sum(axis=1)
    assert np.all(np.einsum("pi,pi->p", wrench, load_wrench_N(robot, poses)[outside]) > most)
    assert np.all(found.separation[outside] > 0.0)


def test_the_compiled_separating_wrench_separates_for_any_tension() -> None:
    poses = anywhere(300, 2)
    situation = upright_situation(COGIRO, poses, COGIRO.exit_points_m)
    _, dual, verdict = solve_massless_batch(COGIRO, situation)
    outside = verdict == Verdict.OUTSIDE_HULL
    assert outside.sum() > 50
    assert np.isnan(distribute_evenly(COGIRO, poses)[outside]).all()
    wrench = -dual[outside]
    gain = -np.einsum("pi,pij->pj", wrench, unit_wrenches(COGIRO, poses)[outside])
    work = np.einsum("pi,pi->p", wrench, load_wrench_N(COGIRO, poses)[outside])
    assert np.all(work > 0.0)
    assert np.all(gain.max(axis=1) < 1e-9 * np.abs(gain).max(axis=1))


def test_dependent_cables_are_told() -> None:
    """All cables in one plane: no tension takes up a force across it."""
    exits = frozen_array([[0, 0, 0], [10, 0, 0], [4, 0, 0], [7, 0, 0]])
    robot = Robot(exits, Platform(100.0))
    poses = Poses.at([[5.0, 0.0, -3.0], [5.0, 1.0, -3.0]])
    found = distribute(robot, poses, 1e5)
    assert list(found.verdict) == [Verdict.RANK_DEFICIENT] * 2
    assert np.isnan(found.tension_N).all()
    assert np.isnan(distribute_evenly(robot, poses)).all()


def test_any_leading_axes_and_an_extra_force() -> None:
    position = cogiro_poses(6).position_m.reshape(2, 3, 3)
    poses, alone = Poses.at(position), Poses.at(position[1, 2])
    force = np.array([20.0, -10.0, -300.0])
    many, single = (distribute(COGIRO, p, 2000.0, force_N=force) for p in (poses, alone))
    assert many.tension_N.shape == (2, 3, 8)
    assert many.tension_N[1, 2] == pytest.approx(single.tension_N, rel=1e-9, abs=1e-6)
    even_N = distribute_evenly(COGIRO, poses)
    assert even_N.shape == (2, 3, 8)
    assert even_N[1, 2] == pytest.approx(distribute_evenly(COGIRO, alone), rel=1e-9, abs=1e-6)
    flat = Poses.at(position.reshape(-1, 3))
    rest = np.einsum("pij,pj->pi", unit_wrenches(COGIRO, flat), many.tension_N.reshape(-1, 8))
    load = load_wrench_N(COGIRO, flat) + np.array([*force, 0.0, 0.0, 0.0])
    assert np.abs(rest + load).max() < 1e-9


def test_a_tilted_base_and_pulleys() -> None:
    robot = replace(COGIRO, tilt_rad=frozen_array([0.02, -0.01]), pulley_radius_m=0.1)
    poses = cogiro_poses(20)
    found, compiled_N = distribute(robot, poses, 5000.0), distribute_evenly(robot, poses)
    assert compiled_N.max(axis=-1) == pytest.approx(found.largest_tension_N, rel=1e-9)
    assert compiled_N != pytest.approx(distribute_evenly(COGIRO, poses), rel=1e-4)


def test_massless_statics_are_the_even_distribution() -> None:
    poses = anywhere(100)
    massless, even_N = solve_massless(COGIRO, poses), distribute_evenly(COGIRO, poses)
    assert np.array_equal(massless.tension_N, even_N, equal_nan=True)


def test_senseless_ranges_are_refused() -> None:
    with pytest.raises(ValueError, match="above the allowable"):
        distribute(SEVEN, seven_poses(1), 5.0)
    with pytest.raises(ValueError, match="no middle"):
        distribute(SEVEN, seven_poses(1), np.inf, "centred")


def test_a_pose_at_an_exit_point_is_told_without_a_warning() -> None:
    exits = np.array([[0.0, 0, 30], [40, 0, 32], [18, 35, 29], [30, 30, 33]])
    with np.errstate(invalid="raise"):
        tension_N = distribute_evenly(Robot(exits, Platform(300.0)), Poses.at(exits[:1]))
    assert np.isnan(tension_N).all()
