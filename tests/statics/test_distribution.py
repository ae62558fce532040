"""Straight cables of redundant robots: best tensions with their proofs, infeasibility with its."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from convex_tensions import distribute
from redundant_robots import FOUR, SEVEN, anywhere, cogiro_poses, four_poses, seven_poses
from sample_robots import COGIRO
from scipy.linalg import null_space
from scipy.optimize import LinearConstraint, linprog, minimize

from designer.arrays import frozen_array
from designer.kernel.batch import solve_massless_batch
from designer.model.robot import Platform, Poses, Robot
from designer.model.verdict import Verdict
from designer.statics.geometry import cable_geometry, load_wrench_N, upright_situation
from designer.statics.inverse import distribute_evenly, solve_massless, tension_over_least

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
