"""What a block of poses ends as: true residuals, a verdict each, and forces in newtons."""

from __future__ import annotations

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.kernel.compiling import element, kernel
from designer.kernel.layout import (
    BALANCE_ERROR,
    CLOSURE,
    CLOSURE_ERROR,
    EX,
    EY,
    FORCE_X,
    FORCE_Z,
    HIGHEST,
    L_0,
    LANES,
    LENGTH,
    LOAD,
    LOAD_FACTOR,
    LOWEST,
    MASSLESS,
    MASSLESS_TENSION,
    OVERLOAD,
    PULL,
    REACH,
    RESIDUAL,
    REST,
    RX,
    RY,
    RZ,
    SCALE,
    WEIGHT,
    X2,
    C,
    D,
    L,
    P,
    T,
    V,
)  # fmt: skip
from designer.kernel.unit_cable import PULL_FLOOR, unit_cable
from designer.model.verdict import Verdict

TOLERANCE = 1e-10
"""Largest residual of closure (over length) plus balance (over the largest force)."""
_AT_LIMIT = 1.0 + 1e-9
_ON_BOUNDARY = 1e-12
_SINGULAR = 1e12
# Numba knows plain integers, not members of an enumeration.
_SOLVED = int(Verdict.SOLVED)
_NOT_CONVERGED = int(Verdict.NOT_CONVERGED)


@kernel
def evaluate(cables: FloatArray, kappa: FloatArray, n: int) -> None:
    """Put the true pull, top tension and closure error of the state into the cable rows."""
    for i in range(n):
        row = cables[i]
        k = kappa[i]
        for j in range(LANES):
            F, _, F_l, v, _, _, t, _, _ = unit_cable(row[P, j], row[L, j], row[X2, j], row[D, j], k)
            row[V, j] = v
            row[T, j] = t
            # A cable stretched through zero length closes too, with a negative tension.
            row[L_0, j] = abs(F / F_l) if t > 0.0 else np.inf


@kernel
def check(
    poses: FloatArray,
    cables: FloatArray,
    weights: FloatArray,
    strength: FloatArray,
    rows: IntArray,
) -> None:
    """Compute the residuals of closure and of the platform's balance, and the worst overload.

    The balance in the components `rows`, moments over the reach of the attachments, ends in row
    `REST`.
    """
    n = rows.size
    for j in range(LANES):
        c = poses[C, j]
        for m in range(6):
            poses[REST + m, j] = -c * poses[m, j]
        poses[SCALE, j] = abs(c) * (abs(poses[0, j]) + abs(poses[1, j]) + abs(poses[2, j]))
        poses[REACH, j] = 1e-300
        poses[CLOSURE, j] = poses[RESIDUAL, j] = poses[OVERLOAD, j] = 0.0
        poses[LOWEST, j] = np.inf
        poses[HIGHEST, j] = 0.0
    for i in range(n):
        row = cables[i]
        w = weights[i]
        for j in range(LANES):
            x, y, v = row[P, j] * row[EX, j], row[P, j] * row[EY, j], row[V, j]
            rx, ry, rz = row[RX, j], row[RY, j], row[RZ, j]
            poses[REST, j] += w * x
            poses[REST + 1, j] += w * y
            poses[REST + 2, j] += w * v
            poses[REST + 3, j] += w * (ry * v - rz * y)
            poses[REST + 4, j] += w * (rz * x - rx * v)
            poses[REST + 5, j] += w * (rx * y - ry * x)
            poses[SCALE, j] = max(poses[SCALE, j], w * row[T, j])
            poses[REACH, j] = max(poses[REACH, j], abs(rx) + abs(ry) + abs(rz))
            poses[CLOSURE, j] = max(poses[CLOSURE, j], row[L_0, j])
            poses[RESIDUAL, j] = max(poses[RESIDUAL, j], row[L_0, j] / row[L, j])
            burst = row[T, j] / strength[i] if row[P, j] >= PULL_FLOOR else np.inf
            poses[OVERLOAD, j] = max(poses[OVERLOAD, j], burst)
            # A singular matrix leaves infinity or NaN in some cables; the sum lets them through.
            straight = row[MASSLESS, j]
            poses[LOWEST, j] = min(poses[LOWEST, j], straight) + 0.0 * straight
            poses[HIGHEST, j] = max(poses[HIGHEST, j], abs(straight)) + 0.0 * straight
    for j in range(LANES):
        force = 0.0
        for m in range(n):
            part = abs(poses[REST + rows[m], j])
            force += part if rows[m] < 3 else part / poses[REACH, j]
        poses[REST, j] = force
        poses[PULL, j] = abs(poses[LOAD, j]) + abs(poses[LOAD + 1, j]) + abs(poses[LOAD + 2, j])
        for axis in range(3, 6):
            poses[PULL, j] += abs(poses[LOAD + axis, j]) / poses[REACH, j]
        # Addition instead of a maximum, because it lets NaN through.
        poses[RESIDUAL, j] += force / poses[SCALE, j]


@element
def judge(
    residual: float,
    c: float,
    overload: float,
    sizing: bool,
) -> int:
    """Return whether a pose is solved; why not is for others to prove.

    When sizing, the state is the balance at the stress limit. It is a finite cable only if c is
    above zero (zero is the infinite section) and no slack cable breaks the limit.

    Parameters
    ----------
    residual, c, overload : float
        Of the state; an infinite overload marks a cable too slack to be evaluated.
    sizing : bool
        Whether the section was sought or given.
    """
    closed = residual <= TOLERANCE
    finite = (c > 0.0 and overload <= _AT_LIMIT) if sizing else overload < np.inf
    return _SOLVED if closed and finite else _NOT_CONVERGED


@kernel
def store(
    out_cables: FloatArray,
    out_poses: FloatArray,
    out_verdict: IntArray,
    cables: FloatArray,
    poses: FloatArray,
    indices: IntArray,
    sizing: bool,
) -> None:
    """Write lengths [m] and forces [N] of solved poses; NaN for all others."""
    n = cables.shape[0]
    for j in range(LANES):
        at = indices[j]
        verdict = judge(
            poses[RESIDUAL, j],
            poses[C, j],
            poses[OVERLOAD, j],
            sizing,
        )
        blank = 1.0 if verdict == _SOLVED else np.nan
        w = blank / poses[C, j]
        for i in range(n):
            out_cables[at, i, LENGTH] = cables[i, L, j] * blank
            out_cables[at, i, FORCE_X] = cables[i, P, j] * np.sqrt(cables[i, X2, j]) * w
            out_cables[at, i, FORCE_Z] = -cables[i, V, j] * w
        closed = poses[RESIDUAL, j] <= TOLERANCE
        held = poses[LOWEST, j] >= -_ON_BOUNDARY * poses[HIGHEST, j]
        # Where they are far above the load, straight cables leave some wrench without tension.
        held = held and poses[HIGHEST, j] <= _SINGULAR * poses[PULL, j]
        out_verdict[at] = verdict
        out_poses[at, WEIGHT] = w
        out_poses[at, CLOSURE_ERROR] = poses[CLOSURE, j] * blank
        out_poses[at, BALANCE_ERROR] = poses[REST, j] * w
        out_poses[at, LOAD_FACTOR] = poses[OVERLOAD, j] if closed else np.nan
        out_poses[at, MASSLESS_TENSION] = poses[HIGHEST, j] if held else np.nan
