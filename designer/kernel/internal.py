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
from designer.kernel.calling import CableFigures, Situation
from designer.kernel.compiling import element, inner, kernel
from designer.kernel.lanes import (
    POSE_ROWS,
    STEP,
    C,
    advance,
    assemble,
    lanes_of,
    linearise,
    place,
    put_cables,
    write_lane,
)
from designer.kernel.linear import are_below, copy, fill, solve_lanes
from designer.kernel.table import (
    CHORD,
    KAPPA,
    L_0,
    L_P,
    LANE_ROWS,
    LANES,
    SHARE,
    V_P,
    X2,
    L,
    P,
    T,
    V,
)

# Rows of a cable beside those of the table: gradient and curvature of the sum, the last step.
_GRADIENT, _CURVATURE, _BEFORE = LANE_ROWS, LANE_ROWS + 1, LANE_ROWS + 2

_MOST_TURNS = 100
_PATIENCE = 15
"""Turns after which steps are made shorter: readings far off may let them overshoot."""
_OVERSHOOT = 0.25
"""Of a step, that the next goes back: a wild reading bends more than its slope tells."""
_LAST_TURNS = 6
"""Turns that mend the balance alone: readings far off may never come to rest."""
_SMALL_STEP = 1e-10
_CLOSED = 1e-10
"""Newton's last correction of a length, relative; the error is its square."""
_HUBER = 3.0
"""Standard deviations up to which a reading counts in full."""


@kernel
def solve_internal_poses(
    situation: Situation,
    figures: CableFigures,
    read: FloatArray,
    noise: FloatArray,
    start: FloatArray,
    pull: FloatArray,
    spread: float,
    scale: FloatArray,
    out: FloatArray,
    out_rest: FloatArray,
) -> None:
    """Solve all poses.

    Parameters
    ----------
    figures : CableFigures
        With weights per length [N/m].
    read : array (n_poses, n_cables, 2)
        Lengths [m] and tensions at the exit points [N] that were read; NaN where none was.
    noise : array (2,)
        Standard deviations σ_l [m] and σ_T [N].
    start, pull : array (n_poses, n_cables)
        Pulls to start from, and p₀.
    spread : float
        By how much pulls may differ from p₀, s, as a logarithm.
    scale : array (degrees of freedom,)
        What makes forces of the balance's rows.
    out : array (n_poses, n_cables, 3)
        Filled with unstrained length [m] and forces on the cable at the platform [N].
    out_rest : array (n_poses,)
        Filled with what is left of the balance, over the largest tension.
    """
    rows = situation.rows
    count, n, m = situation.positions.shape[0], situation.attachments.shape[0], rows.size
    cables = np.empty((n, LANE_ROWS + 3, LANES))
    slopes = np.zeros((n + 1, n + 2, LANES))
    normal = np.empty((m + 1, m + 1, LANES))
    poses = np.empty((POSE_ROWS, LANES))
    stiffer = np.empty(LANES)
    every = np.arange(count)
    for first in range(0, count, LANES):
        lane = lanes_of(every, first)
        place(cables, poses, situation, lane)
        put_cables(cables, figures, lane)
        fill(poses[C], 0.0)
        fill(stiffer, 1.0)
        cables[:, _BEFORE] = 0.0
        for i in range(n):  # straight cables that pull so
            row = cables[i]
            for j in range(LANES):
                p, chord = start[lane[j], i], row[CHORD, j]
                row[P, j] = p
                row[L, j] = chord / (1.0 + row[KAPPA, j] * p * chord)
        for turn in range(_MOST_TURNS):
            linearise(cables)
            assemble(slopes, cables, poses, rows)
            for i in range(n):
                _judge(cables[i], read, noise, pull, spread, lane, i)
                for j in range(LANES):
                    cables[i, _CURVATURE, j] *= stiffer[j] + turn // _PATIENCE
                if turn >= _MOST_TURNS - _LAST_TURNS:
                    cables[i, _GRADIENT] = 0.0
            _set_normal(normal, slopes, cables, m)
            solve_lanes(normal, m, m + 1)
            _set_step(slopes, normal, cables, m)
            _stiffen(stiffer, slopes, cables)
            fill(poses[STEP], 0.0)
            advance(cables, slopes, poses)
            if are_below(poses[STEP], _SMALL_STEP):
                break
        linearise(cables)
        assemble(slopes, cables, poses, rows)
        for j in range(min(LANES, count - first)):
            write_lane(out[lane[j]], cables, j)
            out_rest[lane[j]] = _rest(slopes, cables, scale, j)


@inner
def _judge(
    row: FloatArray,
    read: FloatArray,
    noise: FloatArray,
    pull: FloatArray,
    spread: float,
    lane: IntArray,
    i: int,
) -> None:
    """Set gradient and curvature in p of what is to be small."""
    for j in range(LANES):
        at, w = lane[j], row[SHARE, j]
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


@inner
def _set_normal(normal: FloatArray, slopes: FloatArray, cables: FloatArray, m: int) -> None:
    """Set G h⁻¹ Gᵀ and, beside it, -r - G h⁻¹ ∇."""
    n = cables.shape[0]
    for r in range(m):
        for c in range(r, m):
            entry = normal[r, c]
            fill(entry, 0.0)
            for i in range(n):
                row, row_slope, column_slope = cables[i], slopes[r, i], slopes[c, i]
                for j in range(LANES):
                    entry[j] += row_slope[j] * column_slope[j] / row[_CURVATURE, j]
            copy(entry, normal[c, r])
        right = normal[r, m]
        for j in range(LANES):
            right[j] = -slopes[r, n, j] - slopes[r, n + 1, j]
        for i in range(n):
            row, row_slope = cables[i], slopes[r, i]
            for j in range(LANES):
                right[j] -= row_slope[j] * row[_GRADIENT, j] / row[_CURVATURE, j]


@inner
def _set_step(slopes: FloatArray, normal: FloatArray, cables: FloatArray, m: int) -> None:
    """Write dp where `advance` looks for it, over what `assemble` had there."""
    n = cables.shape[0]
    for i in range(n):
        row = cables[i]
        for j in range(LANES):
            total = row[_GRADIENT, j]
            for r in range(m):
                total += slopes[r, i, j] * normal[r, m, j]
            slopes[i, n, j] = -total / row[_CURVATURE, j]


@inner
def _stiffen(stiffer: FloatArray, slopes: FloatArray, cables: FloatArray) -> None:
    """Raise the curvature of poses whose steps go back and forth, to what would make them end."""
    n = cables.shape[0]
    for j in range(LANES):
        along, square = 0.0, 1e-300
        for i in range(n):
            along += slopes[i, n, j] * cables[i, _BEFORE, j]
            square += cables[i, _BEFORE, j] ** 2
            cables[i, _BEFORE, j] = slopes[i, n, j]
        back = -along / square
        if back > _OVERSHOOT or stiffer[j] > 1.0:
            stiffer[j] = max(stiffer[j] * (1.0 + min(max(back, -0.5), 1.0)), 1.0)


@inner
def _rest(slopes: FloatArray, cables: FloatArray, scale: FloatArray, j: int) -> float:
    """Return what is left of a balance; cables close to rounding after `linearise`."""
    n = cables.shape[0]
    largest, rest = 0.0, 0.0
    for r in range(scale.size):
        rest = max(rest, abs(slopes[r, n, j] + slopes[r, n + 1, j]) * scale[r])
    for i in range(n):  # a cable that does not close, and NaN, must show
        largest = max(largest, cables[i, SHARE, j] * cables[i, T, j])
        rest += 0.0 if abs(cables[i, L_0, j]) <= _CLOSED * cables[i, L, j] else np.inf
    return rest / largest
