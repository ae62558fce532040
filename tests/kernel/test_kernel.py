"""The compiled parts on their own."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pytest

from designer.kernel.compiling import kernel
from designer.kernel.linear import solve_lanes
from designer.kernel.square import solve_range
from designer.kernel.table import LANES
from designer.kernel.unit_cable import PULL_FLOOR, sag_series, unit_cable
from designer.physics import catenary


@kernel
def sag_series_of(theta: np.ndarray) -> np.ndarray:
    out = np.empty_like(theta)
    for k in range(theta.size):
        out[k] = sag_series(theta[k] * theta[k])
    return out


@kernel
def unit_cables(p, length, X2, D, kappa):
    out = np.empty((9, p.size))
    for k in range(p.size):
        row = unit_cable(p[k], length[k], X2[k], D[k], kappa)
        for m in range(9):
            out[m, k] = row[m]
    return out


@kernel
def solve_in_place(A, n, columns):
    solve_lanes(A, n, columns)


def test_sag_series_is_the_hyperbolic_function() -> None:
    theta = np.concatenate([np.linspace(0.3, 32.0, 200), np.linspace(0.01, 0.3, 50)])
    exact = ((np.sinh(theta) / theta) ** 2 - 1) / theta**2
    cancelled = 1e-15 / theta**4  # of the right-hand side, not of the series
    assert np.all(np.abs(sag_series_of(theta) / exact - 1) < 1e-13 + cancelled)
    assert sag_series_of(np.zeros(1))[0] == pytest.approx(1 / 3, rel=1e-15)


def cables(count: int) -> tuple[np.ndarray, ...]:
    rng = np.random.default_rng(1)
    p = 10 ** rng.uniform(-1, 3, count)
    X, D = rng.uniform(0, 300, count), rng.uniform(-200, 200, count)
    X[:20] = 0.0
    return p, X, D


def test_unit_cable_closes_at_the_length_of_the_catenary() -> None:
    p, X, D = cables(500)
    kappa, w = 4e-7, 3.0
    length, force_z = catenary.length_and_force_z(w * p, X, D, w / kappa, w)
    F, _, F_l, v, _, _, t, _, _ = unit_cables(p, length, X * X, D, kappa)
    assert np.all(np.abs(F / F_l) < 1e-10 * length)
    assert -w * v == pytest.approx(force_z, rel=1e-9, abs=1e-9 * w * np.max(length))
    upper = np.maximum(*catenary.end_tensions_N(length, w * p * X, force_z, w))
    inclined = X > 0
    assert w * t[inclined] == pytest.approx(upper[inclined], rel=1e-9)


def test_unit_cable_slopes_are_those_of_differences() -> None:
    p, X, D = cables(500)
    kappa = 1e-5
    length = np.hypot(X, D) * 1.01
    here = unit_cables(p, length, X * X, D, kappa)
    for column, vary_p in ((1, True), (2, False)):
        step = 1e-6 * (p if vary_p else length)
        ahead = unit_cables(p + step * vary_p, length + step * (not vary_p), X * X, D, kappa)
        behind = unit_cables(p - step * vary_p, length - step * (not vary_p), X * X, D, kappa)
        for value in (0, 3, 6):
            slope = (ahead[value] - behind[value]) / (2 * step)
            scale = np.abs(slope) + np.abs(here[value]) / (p if vary_p else length)
            assert np.all(np.abs(here[value + column] - slope) < 1e-6 * scale + 1e-6)


def test_pull_is_not_evaluated_below_its_floor() -> None:
    at = unit_cables(np.array([PULL_FLOOR, 0.0]), np.full(2, 1e5), np.ones(2), np.ones(2), 1e-7)
    assert np.array_equal(at[:, 0], at[:, 1])


@pytest.mark.parametrize("n", [3, 6])
def test_lanes_solve_like_lapack(n) -> None:
    rng = np.random.default_rng(n)
    matrix = rng.normal(size=(LANES, n, n))
    matrix[::7, 0, 0] = 0.0  # asks for pivoting
    right = rng.normal(size=(LANES, n, 2))
    A = np.zeros((n + 1, n + 2, LANES))
    A[:n] = np.concatenate([matrix, right], axis=2).transpose(1, 2, 0)
    solve_in_place(A, n, n + 2)
    solved = A[:n, n:].transpose(2, 0, 1)
    left = np.einsum("lij,ljk->lik", matrix, solved)
    assert np.abs(left - right).max() < 1e-9
    assert solved == pytest.approx(np.linalg.solve(matrix, right), rel=1e-7, abs=1e-9)


def test_a_singular_lane_does_not_disturb_its_neighbours() -> None:
    A = np.zeros((4, 5, LANES))
    A[:3, :3] = np.eye(3)[:, :, None]
    A[:3, 3:] = 2.0
    A[:3, :3, 5] = 1.0
    solve_in_place(A, 3, 5)
    good = np.arange(LANES) != 5
    assert np.all(A[:3, 3:, good] == 2.0)
    assert not np.isfinite(A[:3, 3:, 5]).all()


def test_kernels_are_cached_on_disk(fast_robot, steel) -> None:
    """A second process finds the machine code of the first."""
    from designer.model.robot import Poses
    from designer.sizing.newton import size_poses

    size_poses(fast_robot, Poses.at([250.0, 200, -50]), steel)
    assert solve_range._cache._cache_file._files._load_index()
    code = (
        "from designer.kernel.square import solve_range as f;"
        "assert f._cache._cache_file._files._load_index()"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
