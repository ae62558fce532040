r"""Which share of the spread each input has: Sobol's indices of first and of total order.

.. math::

    S_i = \frac{\operatorname{Var}(\operatorname{E}(u \mid x_i))}{\operatorname{Var} u}, \qquad
    S_{T i} = 1 - \frac{\operatorname{Var}(\operatorname{E}(u \mid x_{\sim i}))}
    {\operatorname{Var} u}

A. Saltelli et al., Computer Physics Communications 181 (2010), doi:10.1016/j.cpc.2009.09.018. All
coordinates of all exit points are one input.

The points are quasi-random. A bootstrap takes them for random ones, and its interval is several
times too wide; so the indices are computed for a few scrambles that are independent of each other,
whose means have the interval of Student's t.

A product of two utilisations scatters, the more so the less of the variance an input has. So a sum
:math:`g = \sum_i g_i(x_i)` of polynomials is fitted to all draws, whose parts' variances are known,
and only what is left, r = u - g, is sampled: with A, B two draws and :math:`A_i` the first with
input i of the second,

.. math::

    \operatorname{Var}(\operatorname{E}(u \mid x_i)) = \operatorname{Var} g_i
        + \overline{r_B g_i(B)} + \overline{r_{A_i} g_i(B)} + \overline{r_B\,(r_{A_i} - r_A)}.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass, field

import numpy as np

from designer.arrays import FloatArray

SCRAMBLES = 8
_NO_SPREAD = 1e-12
_DEGREE = 3


@dataclass(frozen=True, slots=True)
class Share:
    """Share of one input in the variance of the utilisation.

    Parameters
    ----------
    input : str
        Its name in result files.
    first_order : float
        By how much the variance would fall, on average, if this input alone were certain.
    first_order_95 : tuple of float
        Between which that lies with 95 % confidence.
    total_order, total_order_95
        The same with all that the input does together with others.
    """

    input: str
    first_order: float
    first_order_95: tuple[float, float] = field(metadata={"json": "first_order_confidence"})
    total_order: float
    total_order_95: tuple[float, float] = field(metadata={"json": "total_order_confidence"})


def shares_of(
    used_at: Callable[[FloatArray], FloatArray],
    columns: dict[str, slice],
    points: int,
    seed: int,
) -> tuple[Share, ...]:
    """Return the shares of inputs in the variance of a function on the unit cube.

    Parameters
    ----------
    used_at : callable
        From shares of distributions (n, n_columns) to the utilisation (n,).
    columns : dict
        Coordinates of each input.
    points : int
        Of each scramble, a power of two; the function is computed at
        ``SCRAMBLES · points · (n_inputs + 2)``.
    seed : int
        Of the scrambling.

    Raises
    ------
    ValueError
        If the function is not finite everywhere, or does not vary: then there are no shares.
    """
    from scipy.special import stdtrit

    width = max(at.stop for at in columns.values())
    children = np.random.default_rng(seed).spawn(SCRAMBLES)
    unit = np.array([_points(columns.values(), width, points, child) for child in children])
    used = used_at(unit.reshape(-1, width)).reshape(unit.shape[:-1])
    if not np.isfinite(used).all():
        share = float((~np.isfinite(used)).mean())
        raise ValueError(
            f"in {100.0 * share:.3g} % of the draws a pose is not held, so that the utilisation "
            "has no variance"
        )
    if np.ptp(used) <= _NO_SPREAD * float(np.abs(used).max()):
        raise ValueError("the utilisation does not vary")
    powers = _polynomials(unit)
    indices = np.array([_indices(used, powers, columns.values(), k) for k in range(SCRAMBLES)])
    mean = indices.mean(axis=0)
    off = stdtrit(SCRAMBLES - 1, 0.975) * indices.std(axis=0, ddof=1) / np.sqrt(SCRAMBLES)
    low, high = mean - off, mean + off
    return tuple(
        Share(
            name, float(mean[0, k]), (float(low[0, k]), float(high[0, k])),
            float(mean[1, k]), (float(low[1, k]), float(high[1, k])),
        )
        for k, name in enumerate(columns)
    )  # fmt: skip


def _points(
    columns: Collection[slice], width: int, points: int, rng: np.random.Generator
) -> FloatArray:
    """Return two draws A and B, then A with each input of B: (n_inputs + 2, n_points, width)."""
    from scipy.stats import qmc

    unit = qmc.Sobol(2 * width, rng=rng).random(points)
    base, second = unit[:, ::2], unit[:, 1::2]  # the first coordinates are the most even
    mixed = [base.copy() for _ in columns]
    for draw, at in zip(mixed, columns, strict=True):
        draw[:, at] = second[:, at]
    return np.stack([base, second, *mixed])


def _polynomials(unit: FloatArray) -> FloatArray:
    """Return Legendre's polynomials (..., width, degree), of mean zero and variance one."""
    from scipy.special import eval_legendre

    degree = np.arange(1, _DEGREE + 1)
    return np.asarray(np.sqrt(2 * degree + 1) * eval_legendre(degree, 2.0 * unit[..., None] - 1.0))


def _indices(
    used: FloatArray, powers: FloatArray, columns: Collection[slice], k: int
) -> FloatArray:
    """Return first and total order (2, n_inputs) by scramble ``k``, of a sum fitted to the others.

    Of the function (n_scrambles, n_inputs + 2, n_points) and polynomials (..., width, degree).
    """
    remaining = np.arange(len(used)) != k
    fitted = powers[remaining].reshape(used[remaining].size, -1)
    design = np.column_stack([np.ones(len(fitted)), fitted])
    constant, *factors = np.linalg.lstsq(design, used[remaining].ravel(), rcond=None)[0]
    factor = np.reshape(factors, powers.shape[-2:])
    parts = (powers[k] * factor).sum(axis=-1)  # (n_inputs + 2, n_points, width)
    rest = used[k] - constant - parts.sum(axis=-1)
    sums, residuals = parts[:2].sum(axis=-1), rest[:2]
    variance = (factor**2).sum() + 2.0 * np.mean(sums * residuals) + residuals.var()
    shares = []
    for i, at in enumerate(columns):
        own_variance = (factor[at] ** 2).sum()
        sum_base, sum_second = parts[:2, :, at].sum(axis=-1)
        change = rest[2 + i] - rest[0]
        first_order = own_variance + np.mean(
            sum_second * (rest[1] + rest[2 + i]) + rest[1] * change
        )
        total = own_variance + np.mean((sum_second - sum_base) * change + 0.5 * change**2)
        shares.append((first_order, total))
    return np.asarray(np.array(shares).T / variance)
