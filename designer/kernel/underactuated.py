"""Tensions and lengths of sagging cables that are fewer than the degrees of freedom.

A pose gives each cable its two ends; what is free is one pull p for each. Let W(p) be the wrench of
the sagging cables on the platform, f what they have to hold, both about the centre of mass, and S
the scale that makes forces of moments. The pulls are those that leave least of it,

    minimise  ‖S (f - W(p))‖² + ε tr(GᵀG)/n · ‖c (p - p₀)‖²/c̄²,   p ≥ p_least,

with the slopes G = S ∂W/∂p: as many equations as cables, Gᵀ S (f - W) = 0. The second term, with
chords c, is there for pulls that the balance hardly tells, such as those of parallel cables, and
whose errors would be those of the pose many times over: ε = ‖S (f - W)‖²/‖f‖², as if tensions were
known to within the load from straight cables with half of their weight at the platform, p₀. It
vanishes where the pose is in balance. Each cable is condensed to its pull, as in
`designer.kernel.square`; a step is that of Gauss and Newton.
"""

from __future__ import annotations

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.kernel.answer import LENGTH
from designer.kernel.calling import CableFigures, Situation
from designer.kernel.compiling import inner, kernel
from designer.kernel.lanes import (
    GOAL,
    LOAD,
    POSE_ROWS,
    STEP,
    C,
    advance,
    assemble,
    lanes_of,
    linearise,
    normal_equations,
    place,
    put_cables,
    write_lane,
)
from designer.kernel.linear import are_below, copy, fill, solve_lanes
from designer.kernel.table import CHORD, KAPPA, L_0, LANE_ROWS, LANES, SHARE, L, P

_LEAST_PULL = 1.0 / 16.0
"""Smallest pull: the cable is then nearly two hundred times as long as its horizontal distance."""

STEP_LEFT, WRENCH_LEFT, LONGEST = range(3)
"""Last axis of what is told of a pose: the last step, relative; |S (f - W)| [N]; and the largest
ratio of length to chord."""

# Rows of a cable beside those of the table: pull to start from, least pull.
_START, _LEAST = LANE_ROWS, LANE_ROWS + 1

_MOST_TURNS = 80
_PATIENCE = 15
"""Turns after which steps are made shorter."""
_SMALL_STEP = 1e-8
"""Relative step at which pulls rest; lengths, which move less by far, are then at rounding."""
_REGULAR_START, _LEAST_REGULAR = 1e-4, 1e-12
"""ε at the start, and where the pose is in balance: enough for parallel cables."""


@kernel
def solve_underactuated_poses(
    situation: Situation,
    figures: CableFigures,
    scale: FloatArray,
    out: FloatArray,
    out_pose: FloatArray,
) -> None:
    """Solve all poses.

    Parameters
    ----------
    situation : Situation
        About the centre of mass, which is the origin of the body frame.
    figures : CableFigures
        With weights per length [N/m]; the least tension is that along the chord.
    scale : array (degrees of freedom,)
        S, 1 or 1/m.
    out : array (n_poses, n_cables, 3)
        Filled with unstrained length [m] and forces on the cable at the platform [N].
    out_pose : array (n_poses, 3)
        Filled with `STEP_LEFT`, `WRENCH_LEFT` and `LONGEST`.
    """
    rows = situation.rows
    count, n, m = situation.positions.shape[0], situation.attachments.shape[0], rows.size
    cables = np.empty((n, LANE_ROWS + 2, LANES))
    slopes = np.zeros((max(n, m) + 1, n + 2, LANES))
    normal = np.empty((n + 1, n + 1, LANES))
    poses = np.empty((POSE_ROWS, LANES))
    every = np.arange(count)
    for first in range(0, count, LANES):
        lane = lanes_of(every, first)
        place(cables, poses, situation, lane)
        put_cables(cables, figures, lane)
        fill(poses[C], 0.0)
        _start(cables, slopes, normal, poses, figures.least_tension, rows, scale)
        for turn in range(_MOST_TURNS):
            linearise(cables)
            _set_left(slopes, cables, poses, rows, scale)
            for j in range(LANES):  # ε stands where a goal would, of which there is none
                load = poses[LOAD, j] ** 2 + poses[LOAD + 1, j] ** 2 + poses[LOAD + 2, j] ** 2
                poses[GOAL, j] = max(_left2(slopes, n, m, j) / load, _LEAST_REGULAR)
            _set_normal(normal, slopes, cables, poses, m)
            _keep_least(normal, cables, 1.0 + turn // _PATIENCE)
            solve_lanes(normal, n, n + 1)
            for i in range(n):
                copy(normal[i, n], slopes[i, n])
            fill(poses[STEP], 0.0)
            advance(cables, slopes, poses)
            for i in range(n):
                for j in range(LANES):
                    cables[i, P, j] = max(cables[i, P, j], cables[i, _LEAST, j])
            if are_below(poses[STEP], _SMALL_STEP):
                break
        linearise(cables)
        _set_left(slopes, cables, poses, rows, scale)
        for j in range(min(LANES, count - first)):
            write_lane(out[lane[j]], cables, j)
            told = out_pose[lane[j]]
            told[STEP_LEFT], told[LONGEST] = poses[STEP, j], 0.0
            told[WRENCH_LEFT] = np.sqrt(_left2(slopes, n, m, j))
            for i in range(n):
                row, length = cables[i], out[lane[j], i, LENGTH]
                told[LONGEST] = max(told[LONGEST], length / row[CHORD, j])
                # A cable that does not close; negated, so that NaN shows.
                if not abs(row[L_0, j]) <= told[STEP_LEFT] * row[L, j]:
                    told[STEP_LEFT] = abs(row[L_0, j]) / row[L, j]


@inner
def _start(
    cables: FloatArray,
    slopes: FloatArray,
    normal: FloatArray,
    poses: FloatArray,
    least_tension: float,
    rows: IntArray,
    scale: FloatArray,
) -> None:
    """Set the pulls of straight cables with half of their weight at the platform."""
    n = cables.shape[0]
    for i in range(n):
        row = cables[i]
        fill(row[_START], 0.0)
        for j in range(LANES):
            row[_LEAST, j] = max(least_tension / (row[SHARE, j] * row[CHORD, j]), _LEAST_PULL)
    _set_left(slopes, cables, poses, rows, scale)
    fill(poses[GOAL], _REGULAR_START)
    _set_normal(normal, slopes, cables, poses, rows.size)
    solve_lanes(normal, n, n + 1)
    for i in range(n):
        row = cables[i]
        for j in range(LANES):
            p = max(normal[i, n, j], row[_LEAST, j])
            row[_START, j] = row[P, j] = p
            row[L, j] = row[CHORD, j] / (1.0 + row[KAPPA, j] * p * row[CHORD, j])


@inner
def _set_left(
    slopes: FloatArray,
    cables: FloatArray,
    poses: FloatArray,
    rows: IntArray,
    scale: FloatArray,
) -> None:
    """Set G in the first n columns, and S (f - W) in the next."""
    n = cables.shape[0]
    assemble(slopes, cables, poses, rows)
    for r in range(rows.size):
        for j in range(LANES):
            slopes[r, n, j] += slopes[r, n + 1, j]
        for k in range(n + 2):
            for j in range(LANES):
                slopes[r, k, j] *= scale[r]


@inner
def _left2(slopes: FloatArray, n: int, m: int, j: int) -> float:
    """Return the square of what is left."""
    residual = 0.0
    for r in range(m):
        residual += slopes[r, n, j] ** 2
    return residual


@inner
def _set_normal(
    normal: FloatArray, slopes: FloatArray, cables: FloatArray, poses: FloatArray, m: int
) -> None:
    """Set GᵀG with the hold near the start, and beside it the way down."""
    n = cables.shape[0]
    normal_equations(normal, slopes, m, n)
    for j in range(LANES):
        trace, chord2 = 0.0, 0.0
        for i in range(n):
            trace += normal[i, i, j]
            chord2 += cables[i, CHORD, j] ** 2
        for i in range(n):
            row = cables[i]
            hold = poses[GOAL, j] * trace / n * row[CHORD, j] ** 2 / (chord2 / n)
            normal[i, i, j] += hold
            normal[i, n, j] -= hold * (row[P, j] - row[_START, j])


@inner
def _keep_least(normal: FloatArray, cables: FloatArray, caution: float) -> None:
    """Leave pulls where they are that are the least and would fall; make steps shorter."""
    n = cables.shape[0]
    for i in range(n):
        row = cables[i]
        for j in range(LANES):
            normal[i, i, j] *= caution
            if row[P, j] <= row[_LEAST, j] and normal[i, n, j] < 0.0:
                for k in range(n + 1):
                    normal[i, k, j] = 0.0
                for k in range(n):
                    normal[k, i, j] = 0.0
                normal[i, i, j] = 1.0
