r"""Which share of the spread each input has: Sobol's indices of first and of total order.

.. math::

    S_i = \frac{\operatorname{Var}(\operatorname{E}(u \mid x_i))}{\operatorname{Var} u}, \qquad
    S_{T i} = 1 - \frac{\operatorname{Var}(\operatorname{E}(u \mid x_{\sim i}))}
    {\operatorname{Var} u}

A. Saltelli et al., Computer Physics Communications 181 (2010), doi:10.1016/j.cpc.2009.09.018, as
SciPy has it. All coordinates of all exit points are one input.

The points are quasi-random. A bootstrap takes them for random ones, and its interval is several
times too wide; so the indices are computed for a few scrambles that are independent of each other,
whose means have the interval of Student's t.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from designer.arrays import FloatArray

SCRAMBLES = 8
_NO_SPREAD = 1e-12


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
    first_order_95: tuple[float, float]
    total_order: float
    total_order_95: tuple[float, float]


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

    children = np.random.default_rng(seed).spawn(SCRAMBLES)
    indices = np.array([_indices(used_at, columns, points, child) for child in children])
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


def _indices(
    used_at: Callable[[FloatArray], FloatArray],
    columns: dict[str, slice],
    points: int,
    rng: np.random.Generator,
) -> FloatArray:
    """Return first and total order (2, n_inputs) by one scramble."""
    from scipy.stats import qmc, sobol_indices

    width = max(at.stop for at in columns.values())
    unit = qmc.Sobol(2 * width, rng=rng).random(points)
    first, second = unit[:, ::2], unit[:, 1::2]  # the first coordinates are the most even
    mixed = []
    for at in columns.values():
        one = first.copy()
        one[:, at] = second[:, at]
        mixed.append(one)
    used = used_at(np.concatenate([first, second, *mixed])).reshape(-1, 1, points)
    if not np.isfinite(used).all():
        share = float((~np.isfinite(used)).mean())
        raise ValueError(
            f"in {100.0 * share:.3g} % of the draws a pose is not held, so that the utilisation "
            "has no variance"
        )
    if np.ptp(used) <= _NO_SPREAD * float(np.abs(used).max()):
        raise ValueError("the utilisation does not vary")
    found = sobol_indices(func={"f_A": used[0], "f_B": used[1], "f_AB": used[2:]}, n=points)
    return np.stack([found.first_order.reshape(-1), found.total_order.reshape(-1)])
