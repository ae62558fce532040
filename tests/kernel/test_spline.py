"""The compiled spline against SciPy's."""

from __future__ import annotations

import numpy as np
import pytest

from designer.kernel.spline import at_earlier_times


@pytest.mark.parametrize("offset", [0.0, 0.03, -0.03, 1.7, -2.2, 1e3, -1e3])
@pytest.mark.parametrize("n_rows", [4, 5, 200])
def test_it_is_scipys_not_a_knot_spline(n_rows: int, offset: float) -> None:
    from scipy.interpolate import CubicSpline

    rng = np.random.default_rng(n_rows)
    time = np.cumsum(rng.uniform(0.1, 0.4, n_rows))
    values = np.cumsum(rng.normal(size=(n_rows, 3)), axis=0)
    shifted = np.empty_like(values)
    at_earlier_times(time, values, offset, shifted)
    then = np.clip(time - offset, time[0], time[-1])
    scale = np.abs(values).max()
    np.testing.assert_allclose(shifted, CubicSpline(time, values)(then), atol=1e-12 * scale, rtol=0)


def test_a_cubic_is_kept() -> None:
    time = np.array([0.0, 0.3, 0.7, 1.9, 2.0, 3.5])
    shifted = np.empty((6, 1))
    at_earlier_times(time, (time**3 - 2.0 * time)[:, None], 0.25, shifted)
    then = np.maximum(time - 0.25, 0.0)
    np.testing.assert_allclose(shifted[:, 0], then**3 - 2.0 * then, atol=1e-13)
