"""Cables that are best left to hang: not at any limit, but where their own weight harms least."""

from __future__ import annotations

import numpy as np

from designer.arrays import FloatArray
from designer.kernel.compiling import kernel
from designer.kernel.linear import solve_small
from designer.kernel.redundant_layout import (
    CHORD,
    FORCE,
    KAPPA,
    SHARE,
    UNIT,
    V_P,
    WRENCH,
    X2,
    D,
    L,
    P,
    Pose,
)  # fmt: skip
from designer.kernel.redundant_lp import AT_TOP, Programme
from designer.kernel.redundant_pose import lift, settled_length
from designer.kernel.unit_cable import PULL_FLOOR, unit_cable

_MOST_TURNS = 12
_SETTLED = 1e-4
_ALONG = 1e-5
_LARGEST_TURN = 1.5  # of the logarithm of the pull


@kernel
def value_wrenches(pose: Pose, lp: Programme, value: FloatArray, A: FloatArray) -> bool:
    """Fill by how much s rises per unit of each component of the scaled wrench; False if undefined.

    Cables in the basis are free, so what they can give is worth nothing: value · Aⱼ = 0 for them,
    and value · h = 1 with h the column of s, but for what s itself changes through the bounds.

    Parameters
    ----------
    value : array (m,)
        The result.
    A : array (m, m + 1)
        Scratch.
    """
    c = pose.cables
    m, n = lp.basis.size, lp.dual.size
    for k in range(m):
        j = lp.basis[k]
        for q in range(m):
            A[k, q] = c[WRENCH + pose.rows[q], j] if j < n else lp.slope[q]
        A[k, m] = 0.0 if j < n else 1.0
    if not solve_small(A, value):
        return False
    coupling = 1.0
    for j in range(n):
        if lp.rests[j] == AT_TOP:
            for q in range(m):
                coupling += value[q] * c[WRENCH + pose.rows[q], j] * lp.room_slope[j]
    for q in range(m):
        value[q] /= coupling
    return True


@kernel
def settle_hanging(pose: Pose, value: FloatArray, i: int) -> float:
    """Move a hanging cable to the pull at which s cannot rise; return the relative step.

    There value · W'(p) = 0. W' is its horizontal part plus the slope v' of the upward pull, so the
    condition asks for one v'. What that is above the drop falls about as X² / (24 L p³), L being
    the chord: Newton in logarithms.
    An infinite step tells that there is no such pull.
    """
    c = pose.cables
    sideways, upward = 0.0, 0.0
    for k in range(value.size):
        upward += value[k] * lift(pose, pose.rows[k], i)
        sideways += value[k] * c[WRENCH + pose.rows[k], i]
    upward *= c[SHARE, i] * c[UNIT, i] / pose.scale[FORCE]
    sideways -= upward * c[V_P, i]
    wanted = -sideways / upward - c[D, i]
    if not (upward > 0.0 and wanted > 0.0):
        return np.inf
    before = c[P, i]
    p = (c[X2, i] / (24.0 * c[CHORD, i] * wanted)) ** (1.0 / 3.0)
    for _ in range(_MOST_TURNS):
        _, slope = _hang(c, i, p)
        ahead = p * (1.0 + _ALONG)
        _, slope_ahead = _hang(c, i, ahead)
        excess, excess_ahead = slope - c[D, i], slope_ahead - c[D, i]
        if not (excess_ahead > 0.0 and excess > excess_ahead):
            return np.inf
        turn = np.log(excess / wanted) / np.log(excess / excess_ahead) * np.log(1.0 + _ALONG)
        p *= np.exp(min(max(turn, -_LARGEST_TURN), _LARGEST_TURN))
        if abs(turn) < _SETTLED:  # the error left is about its square
            break
    if not (PULL_FLOOR < p < np.inf):
        return np.inf
    c[P, i] = p
    c[L, i], _ = _hang(c, i, p)
    return float(abs(p - before) / p)


@kernel
def _hang(c: FloatArray, i: int, p: float) -> tuple[float, float]:
    """Return length and slope of the upward pull of a cable at a pull."""
    length = settled_length(p, c[X2, i], c[D, i], c[KAPPA, i])
    _, F_p, F_l, _, v_p, v_l, _, _, _ = unit_cable(p, length, c[X2, i], c[D, i], c[KAPPA, i])
    return length, v_p - v_l * F_p / F_l
