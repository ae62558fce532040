"""The balance of poses whose internal forces their own readings tell.

With more cables than degrees of freedom a pose leaves the tensions a choice, and with them the
lengths. Here the choice is the one whose lengths l and tensions T at the exit points come nearest
to what was read of them:

    minimise  Σ ρ((l* - l)/σ_l) + Σ ρ((T* - T)/σ_T) + Σ (ln(p/p₀)/s)²
    subject to the platform's balance, every cable an elastic catenary,

with Huber's ρ, so that a wild reading moves little, and a weak hold of the pulls p near p₀, within
a factor of about e^s, that settles what the readings leave open. Each cable is condensed to its
pull p, as in `designer.kernel.square`; a step is that of Gauss and Newton with the balance
linearised:

    dp = -h⁻¹ (∇ + Gᵀ ν),   (G h⁻¹ Gᵀ) ν = -r - G h⁻¹ ∇

with the slopes G of the wrench in p, what is left of the balance r, and gradient ∇ and diagonal
curvature h of the sum above.
"""

from __future__ import annotations

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.kernel.compiling import element, kernel
from designer.kernel.layout import (
    CABLE_ROWS,
    FORCE_X,
    FORCE_Z,
    L_0,
    L_P,
    LANES,
    LENGTH,
    POSE_ROWS,
    STEP,
    V_P,
    X2,
    C,
    L,
    P,
    T,
    V,
)  # fmt: skip
from designer.kernel.linear import solve_lanes
from designer.kernel.step import advance, assemble, linearise, place

# Rows of a cable beside those of the layout: gradient and curvature of the sum.
_GRADIENT, _CURVATURE = CABLE_ROWS, CABLE_ROWS + 1
_ROWS = CABLE_ROWS + 2

_MOST_TURNS = 100
_PATIENCE = 15
"""Turns after which steps are made shorter: readings far off may let them overshoot."""
_LAST_TURNS = 6
"""Turns that mend the balance alone: readings far off may never come to rest."""
_SMALL_STEP = 1e-10
_CLOSED = 1e-10
"""Newton's last correction of a length, relative; the error is its square."""
_HUBER = 3.0


@kernel
def solve_internal_poses(
    exit_points: FloatArray,
    attachments: FloatArray,
    load: FloatArray,
    load_point: FloatArray,
    weight: float,
    positions: FloatArray,
    rotations: FloatArray,
    cable_weight: FloatArray,
    kappa: FloatArray,
    rows: IntArray,
    read: FloatArray,
    noise: FloatArray,
    pull: FloatArray,
    spread: float,
    scale: FloatArray,
    out: FloatArray,
    out_rest: FloatArray,
) -> None:
    """Solve all poses.

    Parameters
    ----------
    exit_points, attachments, load, load_point, weight, positions, rotations
        See `designer.kernel.step.place`; SI units.
    cable_weight, kappa : array (n_cables,)
        Weight per length [N/m], and that over EA [1/m], of each cable.
    rows : array (degrees of freedom,)
        Components of the wrench that are balanced, of 0 … 5.
    read : array (n_poses, n_cables, 2)
        Lengths [m] and tensions at the exit points [N] that were read; NaN where none was.
    noise : array (2,)
        Standard deviations σ_l [m] and σ_T [N].
    pull : array (n_poses, n_cables)
        Pulls p₀ to start from.
    spread : float
        By how much pulls may differ from p₀, s, as a logarithm.
    scale : array (degrees of freedom,)
        What makes forces of the balance's rows.
    out : array (n_poses, n_cables, 3)
        Filled with unstrained length [m] and forces on the cable at the platform [N].
    out_rest : array (n_poses,)
        Filled with what is left of the balance, over the largest tension.
    """
    count, n, m = positions.shape[0], attachments.shape[0], rows.size
    cables = np.empty((n, _ROWS, LANES))
    slopes = np.empty((n + 1, n + 2, LANES))
    normal = np.empty((m + 1, m + 1, LANES))
    poses = np.empty((POSE_ROWS, LANES))
    for first in range(0, count, LANES):
        lane = np.minimum(np.arange(first, first + LANES), count - 1)
        place(
            cables, poses, exit_points, attachments, load, load_point, weight, positions, rotations,
            lane,
        )  # fmt: skip
        poses[C] = 0.0
        _start(cables, pull, kappa, lane, n)
        for turn in range(_MOST_TURNS):
            linearise(cables, kappa, n)
            assemble(slopes, cables, poses, cable_weight, rows, n)
            for i in range(n):
                _judge(cables[i], read, noise, pull, cable_weight[i], spread, lane, i)
                cables[i, _CURVATURE] *= 1.0 + turn // _PATIENCE
                if turn >= _MOST_TURNS - _LAST_TURNS:
                    cables[i, _GRADIENT] = 0.0
            _set_normal(normal, slopes, cables, n, m)
            solve_lanes(normal, m, m + 1)
            _set_step(slopes, normal, cables, n, m)
            poses[STEP] = 0.0
            advance(cables, slopes, poses, n)
            if np.max(poses[STEP]) < _SMALL_STEP:
                break
        used = min(LANES, count - first)
        linearise(cables, kappa, n)
        _report(cables, cable_weight, out, lane, used, n)
        assemble(slopes, cables, poses, cable_weight, rows, n)
        _report_rest(slopes, cables, cable_weight, scale, out_rest, lane, used, n)


@kernel
def _start(cables: FloatArray, pull: FloatArray, kappa: FloatArray, lane: IntArray, n: int) -> None:
    """Set the first pulls, and the lengths of straight cables that pull so."""
    for i in range(n):
        row = cables[i]
        for j in range(LANES):
            p, chord = pull[lane[j], i], row[L, j]
            row[P, j] = p
            row[L, j] = chord / (1.0 + kappa[i] * p * chord)


@kernel
def _judge(
    row: FloatArray,
    read: FloatArray,
    noise: FloatArray,
    pull: FloatArray,
    w: float,
    spread: float,
    lane: IntArray,
    i: int,
) -> None:
    """Set gradient and curvature in p of what is to be small."""
    for j in range(LANES):
        at = lane[j]
        p, length, slope = row[P, j], row[L, j] + row[L_0, j], row[L_P, j]
        upward, upward_p = row[V, j] + length, row[V_P, j] + slope
        tension = w * np.sqrt(p * p * row[X2, j] + upward * upward)
        tension_p = w * w * (p * row[X2, j] + upward * upward_p) / tension
        hold = 1.0 / (p * spread)
        gradient = hold * np.log(p / pull[at, i]) / spread
        curvature = hold**2
        for value, value_p, k in ((length, slope, 0), (tension, tension_p, 1)):
            residual = (read[at, i, k] - value) / noise[k]
            share = _share(residual)
            change = value_p / noise[k]
            gradient -= share * change * residual if share > 0.0 else 0.0
            curvature += share * change**2
        row[_GRADIENT, j] = gradient
        row[_CURVATURE, j] = curvature


@element
def _share(residual: float) -> float:
    """Return the weight of a reading after Huber; none for NaN."""
    size = abs(residual)
    if size <= _HUBER:
        return 1.0
    return _HUBER / size if size > _HUBER else 0.0


@kernel
def _set_normal(normal: FloatArray, slopes: FloatArray, cables: FloatArray, n: int, m: int) -> None:
    """Set G h⁻¹ Gᵀ and, beside it, -r - G h⁻¹ ∇."""
    for r in range(m):
        for c in range(r, m):
            entry = normal[r, c]
            entry[:] = 0.0
            for i in range(n):
                row, one, other = cables[i], slopes[r, i], slopes[c, i]
                for j in range(LANES):
                    entry[j] += one[j] * other[j] / row[_CURVATURE, j]
            normal[c, r] = entry
        right = normal[r, m]
        for j in range(LANES):
            right[j] = -slopes[r, n, j] - slopes[r, n + 1, j]
        for i in range(n):
            row, one = cables[i], slopes[r, i]
            for j in range(LANES):
                right[j] -= one[j] * row[_GRADIENT, j] / row[_CURVATURE, j]


@kernel
def _set_step(slopes: FloatArray, normal: FloatArray, cables: FloatArray, n: int, m: int) -> None:
    """Write dp where `advance` looks for it, over what `assemble` had there."""
    for i in range(n):
        row = cables[i]
        for j in range(LANES):
            total = row[_GRADIENT, j]
            for r in range(m):
                total += slopes[r, i, j] * normal[r, m, j]
            slopes[i, n, j] = -total / row[_CURVATURE, j]
            slopes[i, n + 1, j] = 0.0


@kernel
def _report(
    cables: FloatArray,
    cable_weight: FloatArray,
    out: FloatArray,
    lane: IntArray,
    used: int,
    n: int,
) -> None:
    for i in range(n):
        row, w = cables[i], cable_weight[i]
        for j in range(used):
            out[lane[j], i, LENGTH] = row[L, j] + row[L_0, j]
            out[lane[j], i, FORCE_X] = w * row[P, j] * np.sqrt(row[X2, j])
            out[lane[j], i, FORCE_Z] = -w * row[V, j]


@kernel
def _report_rest(
    slopes: FloatArray,
    cables: FloatArray,
    cable_weight: FloatArray,
    scale: FloatArray,
    out_rest: FloatArray,
    lane: IntArray,
    used: int,
    n: int,
) -> None:
    """Cables close to rounding after `linearise`; what is left is in the balance."""
    for j in range(used):
        largest = 0.0
        for i in range(n):
            largest = max(largest, cable_weight[i] * cables[i, T, j])
        rest = 0.0
        for r in range(scale.size):
            rest = max(rest, abs(slopes[r, n, j] + slopes[r, n + 1, j]) * scale[r])
        for i in range(n):  # a cable that does not close, and NaN, must show
            rest += 0.0 if abs(cables[i, L_0, j]) <= _CLOSED * cables[i, L, j] else np.inf
        out_rest[lane[j]] = rest / largest
