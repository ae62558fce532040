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
from designer.kernel.compiling import kernel
from designer.kernel.layout import (
    CABLE_ROWS,
    FORCE_X,
    FORCE_Z,
    GOAL,
    L_0,
    LANES,
    LENGTH,
    LOAD,
    POSE_ROWS,
    STEP,
    X2,
    C,
    L,
    P,
    V,
)  # fmt: skip
from designer.kernel.linear import solve_lanes
from designer.kernel.step import advance, assemble, linearise, linearise_taut, place

LEAST_PULL = 1.0 / 16.0
"""Smallest pull: the cable is then nearly two hundred times as long as its horizontal distance."""

STEP_LEFT, WRENCH_LEFT, LONGEST = range(3)
"""Last axis of what is told of a pose: the last step, relative; |S (f - W)| [N]; and the largest
ratio of length to chord."""

# Rows of a cable beside those of the layout: chord, pull to start from, least pull.
_CHORD, _START, _LEAST = CABLE_ROWS, CABLE_ROWS + 1, CABLE_ROWS + 2
_ROWS = CABLE_ROWS + 3

_MOST_TURNS = 80
_PATIENCE = 15
"""Turns after which steps are made shorter."""
_SMALL_STEP = 1e-8
"""Relative step at which pulls rest; lengths, which move less by far, are then at rounding."""
_REGULAR_START, _LEAST_REGULAR = 1e-4, 1e-12


@kernel
def solve_underactuated_poses(
    exit_points: FloatArray,
    attachments: FloatArray,
    load: FloatArray,
    positions: FloatArray,
    rotations: FloatArray,
    cable_weight: FloatArray,
    kappa: FloatArray,
    rows: IntArray,
    scale: FloatArray,
    least_tension: float,
    out: FloatArray,
    out_pose: FloatArray,
) -> None:
    """Solve all poses.

    Parameters
    ----------
    exit_points, load, positions, rotations
        See `designer.kernel.step.place`; SI units. Positions are those of the centre of mass, about
        which the load's moment is.
    attachments : array (n_cables, 3)
        From the centre of mass, body frame [m].
    cable_weight, kappa : array (n_cables,)
        Weight per length [N/m], and that over EA [1/m], of each cable.
    rows : array (degrees of freedom,)
        Components of the wrench that count, of 0 … 5.
    scale : array (degrees of freedom,)
        S, 1 or 1/m.
    least_tension : float
        Least tension along the chord [N].
    out : array (n_poses, n_cables, 3)
        Filled with unstrained length [m] and forces on the cable at the platform [N].
    out_pose : array (n_poses, 3)
        Filled with `STEP_LEFT`, `WRENCH_LEFT` and `LONGEST`.
    """
    count, n, m = positions.shape[0], attachments.shape[0], rows.size
    cables = np.empty((n, _ROWS, LANES))
    slopes = np.empty((max(n, m) + 1, n + 2, LANES))
    normal = np.empty((n + 1, n + 1, LANES))
    poses = np.empty((POSE_ROWS, LANES))
    for first in range(0, count, LANES):
        lane = np.minimum(np.arange(first, first + LANES), count - 1)
        place(
            cables, poses, exit_points, attachments, load, np.zeros(3), 0.0, positions, rotations,
            lane,
        )  # fmt: skip
        poses[C] = 0.0
        _start(cables, slopes, normal, poses, cable_weight, kappa, rows, scale, least_tension)
        for turn in range(_MOST_TURNS):
            linearise(cables, kappa, n)
            _set_left(slopes, cables, poses, cable_weight, rows, scale)
            _set_regular(poses, slopes, n, m)
            _set_normal(normal, slopes, cables, poses, m)
            _keep_least(normal, cables, n, 1.0 + turn // _PATIENCE)
            solve_lanes(normal, n, n + 1)
            for i in range(n):
                slopes[i, n] = normal[i, n]
                slopes[i, n + 1] = 0.0
            poses[STEP] = 0.0
            advance(cables, slopes, poses, n)
            for i in range(n):
                cables[i, P] = np.maximum(cables[i, P], cables[i, _LEAST])
            if np.max(poses[STEP]) < _SMALL_STEP:
                break
        linearise(cables, kappa, n)
        _set_left(slopes, cables, poses, cable_weight, rows, scale)
        for j in range(min(LANES, count - first)):
            _report(cables, slopes, poses, cable_weight, m, j, out[lane[j]], out_pose[lane[j]])


@kernel
def _start(
    cables: FloatArray,
    slopes: FloatArray,
    normal: FloatArray,
    poses: FloatArray,
    cable_weight: FloatArray,
    kappa: FloatArray,
    rows: IntArray,
    scale: FloatArray,
    least_tension: float,
) -> None:
    """Set the pulls of straight cables with half of their weight at the platform."""
    n = cables.shape[0]
    linearise_taut(cables, n)
    for i in range(n):
        cables[i, _CHORD] = cables[i, L]
        cables[i, _START] = 0.0
        cables[i, _LEAST] = np.maximum(
            least_tension / (cable_weight[i] * cables[i, _CHORD]), LEAST_PULL
        )
    _set_left(slopes, cables, poses, cable_weight, rows, scale)
    poses[GOAL] = _REGULAR_START
    _set_normal(normal, slopes, cables, poses, rows.size)
    solve_lanes(normal, n, n + 1)
    for i in range(n):
        row = cables[i]
        row[_START] = np.maximum(normal[i, n], row[_LEAST])
        row[P] = row[_START]
        row[L] = row[_CHORD] / (1.0 + kappa[i] * row[P] * row[_CHORD])


@kernel
def _set_left(
    slopes: FloatArray,
    cables: FloatArray,
    poses: FloatArray,
    cable_weight: FloatArray,
    rows: IntArray,
    scale: FloatArray,
) -> None:
    """Set G in the first n columns, and S (f - W) in the next."""
    n = cables.shape[0]
    assemble(slopes, cables, poses, cable_weight, rows, n)
    for r in range(rows.size):
        slopes[r, n] += slopes[r, n + 1]
        slopes[r] *= scale[r]


@kernel
def _set_regular(poses: FloatArray, slopes: FloatArray, n: int, m: int) -> None:
    """Set ε where the layout has a goal, of which there is none."""
    for j in range(LANES):
        left = 0.0
        for r in range(m):
            left += slopes[r, n, j] ** 2
        load = poses[LOAD, j] ** 2 + poses[LOAD + 1, j] ** 2 + poses[LOAD + 2, j] ** 2
        poses[GOAL, j] = max(left / load, _LEAST_REGULAR)


@kernel
def _set_normal(
    normal: FloatArray, slopes: FloatArray, cables: FloatArray, poses: FloatArray, m: int
) -> None:
    """Set GᵀG with the hold near the start, and beside it the way down."""
    n = cables.shape[0]
    trace, chord2 = np.zeros(LANES), np.zeros(LANES)
    for i in range(n):
        normal[i] = 0.0
        for r in range(m):
            own = slopes[r, i]
            for k in range(n + 1):
                other, entry = slopes[r, k], normal[i, k]
                for j in range(LANES):
                    entry[j] += own[j] * other[j]
        for j in range(LANES):
            trace[j] += normal[i, i, j]
            chord2[j] += cables[i, _CHORD, j] ** 2
    for i in range(n):
        row = cables[i]
        for j in range(LANES):
            hold = poses[GOAL, j] * trace[j] / n * row[_CHORD, j] ** 2 / (chord2[j] / n)
            normal[i, i, j] += hold
            normal[i, n, j] -= hold * (row[P, j] - row[_START, j])


@kernel
def _keep_least(normal: FloatArray, cables: FloatArray, n: int, caution: float) -> None:
    """Leave pulls where they are that are the least and would fall; make steps shorter."""
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


@kernel
def _report(
    cables: FloatArray,
    slopes: FloatArray,
    poses: FloatArray,
    cable_weight: FloatArray,
    m: int,
    j: int,
    out: FloatArray,
    out_pose: FloatArray,
) -> None:
    """Report one lane; closure is to rounding after `linearise`, else its correction tells."""
    n = cables.shape[0]
    step, left, longest = poses[STEP, j], 0.0, 0.0
    for i in range(n):
        row, w = cables[i], cable_weight[i]
        out[i, LENGTH] = row[L, j] + row[L_0, j]
        out[i, FORCE_X] = w * row[P, j] * np.sqrt(row[X2, j])
        out[i, FORCE_Z] = -w * row[V, j]
        longest = max(longest, out[i, LENGTH] / row[_CHORD, j])
        # Negated, so that NaN shows.
        if not abs(row[L_0, j]) <= step * row[L, j]:
            step = abs(row[L_0, j]) / row[L, j]
    for r in range(m):
        left += slopes[r, n, j] ** 2
    out_pose[STEP_LEFT] = step
    out_pose[WRENCH_LEFT] = np.sqrt(left)
    out_pose[LONGEST] = longest
