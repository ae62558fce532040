"""The largest sag as a limit on internal forces: least pulls, the optimum, what misses it."""

from __future__ import annotations

from dataclasses import replace

import numba
import numpy as np
import pytest
from redundant_robots import FOUR, cogiro_poses, four_poses, one, steel
from sample_robots import COGIRO
from scipy.optimize import linprog, minimize

from designer.arrays import BoolArray, frozen_array
from designer.kernel.least_pull import least_pull, least_pulls
from designer.kernel.table import CHORD, LANE_ROWS, X2, D
from designer.model.cable import Cable
from designer.model.robot import Platform, Poses, Robot
from designer.model.verdict import Verdict
from designer.physics import catenary
from designer.sizing.newton import size_poses
from designer.sizing.scp import size_by_scp
from designer.statics.geometry import cable_geometry, load_wrench_N, structure_matrix
from designer.statics.inverse import sag_ratio, solve_sagging
from designer.statics.sizes import evaluate_sizes


@numba.njit
def _least_pull(pulls, table, kappa):
    return least_pull(pulls, table, 0, kappa)


def _ratio(p: float, X: float, drop: float, kappa: float) -> float:
    length, force_z = catenary.length_and_force_z(p, X, drop, 1.0 / kappa, 1.0)
    sag = catenary.sag_m(length, p * X, force_z, 1.0 / kappa, 1.0, X, drop)
    return float(sag / np.hypot(X, drop))


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize("limit", [1e-3, 0.01, 0.05, 0.2, 1.0, 10.0])
def test_least_pull_is_that_of_the_catenary_and_on_the_safe_side(limit: float) -> None:
    rng = np.random.default_rng(1)
    for drop, size, kappa in zip(
        np.sinh(rng.uniform(-7.0, 7.0, 100)),
        10.0 ** rng.uniform(-1.0, 2.5, 100),
        10.0 ** rng.uniform(-8.0, -6.0, 100),
        strict=True,
    ):
        table = np.zeros((LANE_ROWS, 1))
        table[[X2, D, CHORD], 0] = size**2, size * drop, size * np.hypot(1.0, drop)
        p = _least_pull(least_pulls(limit), table, kappa)
        ratio = _ratio(p, size, size * drop, kappa)
        assert ratio <= limit * (1.0 + 1e-12)
        if p > 1.0 / 64.0:
            # What stretch leaves out is below the strain where the cable is parallel to its chord.
            left_out = (1.0 + limit) * kappa * table[CHORD, 0]
            assert _ratio(p * (1.0 - 4e-7), size, size * drop, kappa) > limit * (1.0 - left_out)


def test_a_steep_slack_cable_hangs_below_its_lower_end() -> None:
    size, drop = 1.0, 100.0
    length, force_z = catenary.length_and_force_z(0.05, size, drop, 1e9, 1.0)
    below = -drop - catenary.lowest_z_m(length, 0.05 * size, force_z, 1e9, 1.0)
    assert below > 40.0
    assert catenary.sag_m(length, 0.05 * size, force_z, 1e9, 1.0, size, drop) == below


def _by_slsqp(robot: Robot, pose: Poses, cable: Cable, limit: float, start_N) -> float:
    """Return the smallest largest tension over the allowable one, from a start of tensions."""
    geometry = cable_geometry(robot, pose)
    X, drop, chord = geometry.horizontal_distance_m, geometry.drop_m, geometry.chord_m
    matrix, load = structure_matrix(robot, geometry), load_wrench_N(robot, pose)
    EA, weight, allowable = cable.axial_stiffness_N, cable.weight_N_per_m, cable.allowable_tension_N

    def shape(u):
        density = np.exp(u[:-1])
        length, force_z = catenary.length_and_force_z(density, X, drop, EA, weight)
        return length, density * X, force_z

    def balance(u):
        _, force_x, force_z = shape(u)
        return (matrix @ np.stack([force_x, force_z], axis=1).ravel() - load) / robot.weight_N

    def room(u):
        length, force_x, force_z = shape(u)
        ends = catenary.end_tensions_N(length, force_x, force_z, weight)
        sag = catenary.sag_m(length, force_x, force_z, EA, weight, X, drop)
        used = np.maximum(*ends) / allowable
        return np.concatenate([u[-1] - used, 1.0 - sag / chord / limit])

    with np.errstate(over="ignore", invalid="ignore"):  # its line search tries any step
        found = minimize(
            lambda u: u[-1],
            np.append(np.log(start_N / chord), 1.0),
            jac=lambda u: np.eye(len(u))[-1],
            constraints=[{"type": "eq", "fun": balance}, {"type": "ineq", "fun": room}],
            method="SLSQP",
            options={"maxiter": 500, "ftol": 1e-12},
        )
        holds = np.abs(balance(found.x)).max() < 1e-8 and room(found.x).min() > -1e-8
    return float(found.fun) if holds else np.inf


@pytest.mark.slow
@pytest.mark.parametrize("limit", [0.05, 0.1])
@pytest.mark.parametrize("case", ["four", "cogiro", "five"])
def test_smallest_largest_tension_within_the_sag_is_that_of_slsqp(case: str, limit: float) -> None:
    five = Robot(
        frozen_array([[0, 0, 9], [40, 0, 14], [44, 30, 8], [20, 45, 12], [-6, 28, 10]]),
        Platform(60.0),
    )
    rng = np.random.default_rng(7)
    inside = Poses.at(rng.uniform([8.0, 8.0, 1.0], [30.0, 24.0, 7.0], (2, 3)))
    robot, poses, cable = {
        "four": (FOUR, four_poses(4, 3), steel(3.0).cable(0.01)),
        "cogiro": (COGIRO, cogiro_poses(6, 3), steel(8.0).cable(0.008)),
        "five": (five, inside, steel(4.0).cable(0.008)),
    }[case]
    found = solve_sagging(replace(robot, sag_max=limit), poses, cable)
    free = solve_sagging(replace(robot, sag_max=0.5), poses, cable)
    solved, sag = found.is_solved, sag_ratio(found).max(axis=-1)
    assert solved.any() and free.is_solved.all()
    assert (sag[solved] <= limit).all()
    for k in range(len(solved)):
        starts = [each.cable_tension_N[k] for each in (found, free) if each.is_solved[k]]
        theirs = min(_by_slsqp(robot, one(poses, k), cable, limit, s) for s in starts)
        assert np.isfinite(theirs) == solved[k]
        if solved[k]:
            ours = found.largest_tension_N[k] / cable.allowable_tension_N
            close = 1e-6 if sag[k] > 0.9999 * limit else 1e-8
            assert ours == pytest.approx(theirs, rel=close)


@pytest.mark.parametrize("limit", [0.05, 0.2])
def test_thinnest_cable_within_the_sag_is_that_of_convex_programmes(limit: float) -> None:
    robot = replace(FOUR, sag_max=limit)
    poses, material = four_poses(6, 4), steel(2.0)
    sizing = size_poses(robot, poses, material)
    held = np.flatnonzero(sizing.statics.is_solved)
    assert len(held) >= 3
    assert sag_ratio(sizing.statics)[held].max() <= limit
    for k in held:
        theirs = size_by_scp(robot, one(poses, k), material)
        assert theirs.has_converged
        assert sizing.diameter_m[k] == pytest.approx(theirs.diameter_m, rel=1e-5)


def can_keep(poses: Poses, cable: Cable, limit: float) -> BoolArray:
    """Tell where cables as parabolas can all be pulled to a sag and hold the platform (n_poses,).

    With H ≥ w X² / (8 s c) for a sag of s over the chord c, by a linear programme in H.
    """
    w, weight_N = cable.weight_N_per_m, FOUR.platform.mass_kg * 9.81

    def feasible(position_m: np.ndarray) -> bool:
        chord = position_m - FOUR.exit_points_m
        X, c = np.hypot(chord[:, 0], chord[:, 1]), np.linalg.norm(chord, axis=1)
        balance = np.vstack([(chord[:, :2] / X[:, None]).T, -chord[:, 2] / X])
        held = np.array([0.0, 0.0, weight_N + 0.5 * w * c.sum()])
        least = [(h, None) for h in w * X**2 / (8.0 * limit * c)]
        return bool(linprog(np.zeros(4), A_eq=balance, b_eq=held, bounds=least).status == 0)

    return np.array([feasible(position_m) for position_m in poses.position_m])


@pytest.mark.slow
def test_a_pose_is_held_where_all_cables_can_be_taut() -> None:
    poses, cable = four_poses(300, 1), steel(2.0).cable(0.01)
    slack = solve_sagging(replace(FOUR, sag_max=0.5), poses, cable)
    tight = solve_sagging(replace(FOUR, sag_max=0.05), poses, cable)
    held = tight.is_solved
    assert sag_ratio(tight)[held].max() <= 0.05
    assert held[can_keep(poses, cable, 0.048)].all()
    assert not held[~can_keep(poses, cable, 0.052)].any()
    assert 100 < held.sum() < 300
    assert (tight.verdict[~held] == Verdict.OUTSIDE_HULL).all()
    least = slack.largest_tension_N[held] * (1.0 - 1e-9)
    assert (tight.largest_tension_N[held] >= least).all()


def test_a_light_platform_does_not_tighten_heavy_cables_from_above() -> None:
    light = Robot(FOUR.exit_points_m, Platform(1.0), sag_max=0.02)
    statics = solve_sagging(light, four_poses(20, 2), steel().cable(0.01))
    assert (statics.verdict == Verdict.OUTSIDE_HULL).all()


@pytest.mark.parametrize("diameter_m", [0.004, 0.01, 0.04])
def test_what_a_size_meets_is_what_its_poses_meet(diameter_m: float) -> None:
    """A thin, a fitting and a hopelessly heavy cable."""
    robot = replace(FOUR, sag_max=0.05)
    poses, cable = four_poses(200, 5), steel(2.0).cable(diameter_m)
    statics = solve_sagging(robot, poses, cable)
    cells = np.zeros(200, dtype=int)
    meets = evaluate_sizes(robot, poses, [cable], cells, 1, leaves_out_hanging=False)
    assert meets.counted[0] == statics.is_solved.sum()
    assert np.array_equal(meets.failed[0], ~statics.is_solved)
    if statics.is_solved.any():
        used = statics.largest_tension_N / cable.allowable_tension_N
        assert meets.utilisation[0, 0] == pytest.approx(np.nanmax(used), rel=1e-9)
        assert meets.overloaded[0] == (used > 1.0).sum()
