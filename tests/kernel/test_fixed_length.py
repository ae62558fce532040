"""Cables of given lengths in compiled code, against the arrays of `designer.physics`."""

from __future__ import annotations

import numpy as np
import pytest

from designer.kernel.fixed_length import solve_thetas
from designer.physics import catenary


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize("seed", range(4))
def test_roots_are_those_of_the_arrays(seed: int) -> None:
    rng = np.random.default_rng(seed)
    count = 3000
    X = rng.uniform(0.0, 40.0, count) * (np.arange(count) % 50 > 0)  # some vertical
    D = rng.uniform(-8.0, 8.0, count)
    length = np.hypot(X, D) * (1.0 + rng.uniform(-1, 1, count) * 10 ** rng.uniform(-6, 1, count))
    length = np.abs(length) + 1e-3
    w, EA = 10 ** rng.uniform(-2, 2, count), 10 ** rng.uniform(3, 8, count)
    EA[::7] = np.inf  # where too short a cable does not reach
    expected = np.stack(catenary.forces_from_length(length, X, D, EA, w))
    theta = np.empty(count)
    solve_thetas(length, X, D, w / EA, theta)
    found = np.stack(catenary.forces_from_theta(theta, length, X, D, w / EA, w))
    assert np.isnan(expected).any()
    assert np.isinf(theta).any()
    size = np.nan_to_num(np.linalg.norm(expected, axis=0))
    np.testing.assert_array_equal(np.isnan(found), np.isnan(expected))
    assert np.all(np.abs(np.nan_to_num(found - expected)) <= 1e-11 * size)
