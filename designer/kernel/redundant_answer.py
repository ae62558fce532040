"""What a pose of a redundant robot ends as: true residuals, a verdict, forces in newtons."""

from __future__ import annotations

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.kernel.answer import TOLERANCE
from designer.kernel.compiling import kernel
from designer.kernel.layout import (
    BALANCE_ERROR,
    CLOSURE_ERROR,
    FORCE_X,
    FORCE_Z,
    LENGTH,
    LOAD_FACTOR,
    MASSLESS_TENSION,
    WEIGHT,
)
from designer.kernel.redundant_layout import (
    EX,
    EY,
    FORCE,
    KAPPA,
    LEAST,
    REACH,
    RX,
    RY,
    RZ,
    SHARE,
    SIZE,
    STRAIGHT,
    STRENGTH,
    X2,
    D,
    L,
    P,
    Pose,
    T,
    V,
)  # fmt: skip
from designer.kernel.redundant_pose import lowest_tension
from designer.kernel.unit_cable import PULL_FLOOR, unit_cable
from designer.model.verdict import Verdict

OPTIMAL_WITHIN = 1e-6
"""Largest last step, or residual of the optimality conditions, of an answer."""
_AT_LIMIT = 1.0 + 1e-9
NOTHING = 1e-9
"""Scaled inverse weight below which straight cables hold nothing."""
_SOLVED = int(Verdict.SOLVED)
_NOT_CONVERGED = int(Verdict.NOT_CONVERGED)


@kernel
def measure(pose: Pose, c: float) -> tuple[float, float, float]:
    """Return closure error [m], balance error over w [m] and load factor of the state.

    Pull and top tension of every cable are put into its rows. A load factor is infinite where a
    cable is too slack to be evaluated, stretched through zero length or below its least tension.
    """
    cables, rows, load, rest, scale = pose
    for k in range(6):
        rest[k] = -c * scale[SIZE] * load[k]
    closure, overload = 0.0, 0.0
    for i in range(cables.shape[1]):
        p, w = cables[P, i], cables[SHARE, i]
        F, _, F_l, v, _, _, t, _, _ = unit_cable(
            p, cables[L, i], cables[X2, i], cables[D, i], cables[KAPPA, i]
        )
        cables[V, i] = v
        cables[T, i] = t
        x, y = p * cables[EX, i], p * cables[EY, i]
        rx, ry, rz = cables[RX, i], cables[RY, i], cables[RZ, i]
        rest[0] += w * x
        rest[1] += w * y
        rest[2] += w * v
        rest[3] += w * (ry * v - rz * y) / scale[REACH]
        rest[4] += w * (rz * x - rx * v) / scale[REACH]
        rest[5] += w * (rx * y - ry * x) / scale[REACH]
        # Sums instead of maxima where NaN has to get through.
        closure = max(closure, abs(F / F_l)) + 0.0 * F
        lowest, _ = lowest_tension(p, cables[L, i], 0.0, v, 0.0, cables[X2, i], cables[D, i])
        held = p >= PULL_FLOOR and t > 0.0 and lowest * _AT_LIMIT >= c * cables[LEAST, i]
        overload = max(overload, t / cables[STRENGTH, i] if held else np.inf)
    error = 0.0
    for k in range(rows.size):
        error += abs(rest[rows[k]])
    return closure, error, overload


@kernel
def store(
    out_cables: FloatArray,
    out_poses: FloatArray,
    out_verdict: IntArray,
    at: int,
    pose: Pose,
    c: float,
    gap: float,
    straight_c: float,
    sizing: bool,
) -> int:
    """Write a pose's answer, NaN unless it is solved; return that, or not converged.

    Parameters
    ----------
    c, gap : float
        Inverse weight [m/N], and how far the state is from optimal.
    straight_c : float
        Largest scaled inverse weight of straight cables; none if not above zero.
    sizing : bool
        Whether c was sought or given.
    """
    cables, scale = pose.cables, pose.scale
    closure, error, overload = measure(pose, c)
    heaviest, shortest = abs(c) * scale[SIZE], np.inf
    for i in range(cables.shape[1]):
        heaviest = max(heaviest, cables[SHARE, i] * cables[T, i])
        shortest = min(shortest, cables[L, i])
    is_balanced = closure / shortest + error / heaviest <= TOLERANCE
    is_optimal = gap <= OPTIMAL_WITHIN
    holds = (c > 0.0 and overload <= _AT_LIMIT) if sizing else overload < np.inf
    verdict = _SOLVED if is_balanced and is_optimal and holds else _NOT_CONVERGED
    blank = 1.0 if verdict == _SOLVED else np.nan
    w = blank / c
    massless = 0.0
    for i in range(cables.shape[1]):
        out_cables[at, i, LENGTH] = cables[L, i] * blank
        out_cables[at, i, FORCE_X] = cables[P, i] * np.sqrt(cables[X2, i]) * w
        out_cables[at, i, FORCE_Z] = -cables[V, i] * w
        massless = max(massless, cables[STRAIGHT, i])
    out_verdict[at] = verdict
    out_poses[at, WEIGHT] = w
    out_poses[at, CLOSURE_ERROR] = closure * blank
    out_poses[at, BALANCE_ERROR] = error * w
    out_poses[at, LOAD_FACTOR] = overload if is_balanced and is_optimal else np.nan
    to_N = scale[SIZE] / (scale[FORCE] * straight_c) if straight_c > NOTHING else np.nan
    out_poses[at, MASSLESS_TENSION] = massless * to_N
    return verdict


@kernel
def store_deficient(
    out_cables: FloatArray, out_poses: FloatArray, out_verdict: IntArray, at: int
) -> None:
    """Write the answer of a pose in which straight cables leave some wrench without tension."""
    out_cables[at] = np.nan
    out_poses[at] = np.nan
    out_verdict[at] = _NOT_CONVERGED
