r"""The least pull at which a cable sags no more than a given share of its chord.

An inextensible cable of pull p = H / (w X) is a catenary with θ = 1 / (2 p) and the parameter
X / (2 θ). With m the slope of its chord, :math:`c = \sqrt{1 + m^2}` the chord over X, and
u = asinh(m θ / sinh θ) where its middle is,

.. math::

    \frac{sag}{chord} = \frac{1}{2 θ c^2} \left[ \cosh u \cosh θ + m\,(\operatorname{asinh} m - u)
        - c \right]

is its distance from the chord where it is parallel to it. Where u < θ, its lowest point is
(cosh(θ - u) - 1) / (2 θ c) chords below its lower end: of steep cables that is more. Both fall as
the pull grows, so a largest sag is a least pull, which depends on the slope of the chord alone. For
shallow cables it is X / (8 s chord), which is H = w chord / (8 s) of a level one.

A cable that stretches is lighter per length, hence straighter: with the strain p κ chord where it
is parallel to its chord, p (1 + p κ chord) takes the place of p. What this leaves out is on the
safe side, and below 4e-6 of the sag for κ chord of 1e-4 (250 m of steel) and a sag of 20 %.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np

from designer.arrays import FloatArray
from designer.kernel.calling import ANY_SAG, plain
from designer.kernel.compiling import element
from designer.kernel.table import CHORD, X2, D
from designer.kernel.unit_cable import PULL_FLOOR

_NODES, _STEEPEST = 4096, 36.0
"""Nodes of a table, evenly spaced in asinh of the slope, and the last; steeper cables are at
`PULL_FLOOR`."""
_A_STEP = _NODES / _STEEPEST
_HALVINGS = 60
_MARGIN = 1e-7
"""Relative, beyond what interpolation leaves, so that what is at the limit keeps it."""


def least_pulls(sag_max: float | None) -> FloatArray:
    """Return the table of least pulls for a largest sag over chord; of no rows for None.

    Returns
    -------
    array (n_nodes, 2)
        Pull times chord over X for the sag across the chord, and pull for what hangs below the
        lower end; two nodes stand before a level chord, and two behind the steepest.
    """
    return ANY_SAG if sag_max is None else _table(sag_max)


@lru_cache(maxsize=64)
def _table(sag_max: float) -> FloatArray:
    slope = np.sinh(np.arange(-2, _NODES + 3) / _A_STEP)
    chord = np.hypot(1.0, slope)
    theta = [_largest_theta(of, slope, chord, sag_max) for of in (_across, _below)]
    return plain((1.0 + _MARGIN) * 0.5 * np.column_stack([chord / theta[0], 1.0 / theta[1]]))


def largest_theta(sag_max: float, slope: FloatArray) -> FloatArray:
    """Return the largest θ (n,) of inextensible cables with chords of slopes (n,), none below 0."""
    chord = np.hypot(1.0, slope)
    of_each = [_largest_theta(of, slope, chord, sag_max) for of in (_across, _below)]
    return np.minimum(*of_each)


def _largest_theta(
    of: Callable[..., FloatArray], slope: FloatArray, chord: FloatArray, sag_max: float
) -> FloatArray:
    """Return θ at which a sag over chord, which grows with it, is reached; by halving."""
    low, high = np.full_like(slope, 1e-9), np.full_like(slope, 0.5 / PULL_FLOOR)
    for _ in range(_HALVINGS):
        theta = 0.5 * (low + high)
        is_below = of(theta, slope, chord) < sag_max
        low, high = np.where(is_below, theta, low), np.where(is_below, high, theta)
    return high


def _middle(theta: FloatArray, slope: FloatArray) -> FloatArray:
    return np.asarray(np.arcsinh(slope * theta / np.sinh(theta)))


def _across(theta: FloatArray, slope: FloatArray, chord: FloatArray) -> FloatArray:
    u = _middle(theta, slope)
    high = np.cosh(u) * np.cosh(theta) + slope * (np.arcsinh(slope) - u) - chord
    return np.asarray(high / (2.0 * theta * chord**2))


def _below(theta: FloatArray, slope: FloatArray, chord: FloatArray) -> FloatArray:
    beyond = np.maximum(theta - _middle(theta, slope), 0.0)
    return np.asarray(np.sinh(0.5 * beyond) ** 2 / (theta * chord))


@element
def least_pull(pulls: FloatArray, table: FloatArray, j: int, kappa: float) -> float:
    """Return the least pull of the cable in a column of the table that every solver keeps."""
    chord, X = table[CHORD, j], np.sqrt(table[X2, j])
    if pulls.shape[0] == 0 or not X > 0.0:
        return PULL_FLOOR
    at = np.log((abs(table[D, j]) + chord) / X) * _A_STEP
    if not at < _NODES:
        return PULL_FLOOR
    k = int(at)
    across, below = _between(pulls, k, at - k, 0) * X / chord, _between(pulls, k, at - k, 1)
    across *= 2.0 / (1.0 + np.sqrt(1.0 + 4.0 * kappa * chord * across))
    return float(max(across, below, PULL_FLOOR))


@element
def _between(pulls: FloatArray, k: int, t: float, column: int) -> float:
    """Return the cubic through four nodes, two on either side."""
    outer = (2.0 - t) * pulls[k + 1, column] + (1.0 + t) * pulls[k + 4, column]
    inner = (1.0 - t) * pulls[k + 2, column] + t * pulls[k + 3, column]
    return float(inner + t * (1.0 - t) * (3.0 * inner - outer) / 6.0)
