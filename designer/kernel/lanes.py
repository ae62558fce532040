"""Newton's method on a block of poses at once, one a lane; see `designer.kernel.square`.

`cables` is (n_cables, rows of the table, n_lanes), `poses` (POSE_ROWS, n_lanes).
"""

from __future__ import annotations

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.kernel.answer import FORCE_X, FORCE_Z, LENGTH
from designer.kernel.calling import CableFigures, Situation
from designer.kernel.compiling import allocating, inner
from designer.kernel.linear import copy, fill
from designer.kernel.table import (
    L_0,
    L_P,
    LANES,
    LEVEL,
    LIFT,
    SHARE,
    STRAIGHT,
    STRENGTH,
    T_P,
    V_P,
    X2,
    L,
    P,
    T,
    V,
    condense,
    load_of,
    place_cable,
    put_cable,
    straighten,
)

# Rows of a pose: load (6), inverse weight and its goal, largest relative step.
LOAD, C, GOAL, STEP = 0, 6, 7, 8
# What is left of the balance (6), its scales of force and length, and the figures of merit.
REST, SCALE, REACH = 9, 15, 16
CLOSURE, RESIDUAL, OVERLOAD, LOWEST, HIGHEST, PULL = range(17, 23)
POSE_ROWS = 23

_LARGEST_FALL = 0.7
_FOLLOWED = 0.1
"""A c that falls faster than this a step, or before p has followed to this share, loses the way."""
_LEAST_START = 0.01
"""Pull that a cable starts with at least."""


@allocating
def lanes_of(indices: IntArray, first: int, width: int = LANES) -> IntArray:
    """Return the poses of a block: from `first`, the last one repeated where there are no more."""
    lane = np.empty(width, dtype=np.int64)
    for j in range(width):
        lane[j] = indices[min(first + j, indices.size - 1)]
    return lane


@inner
def place(cables: FloatArray, poses: FloatArray, situation: Situation, lane: IntArray) -> None:
    """Fill the geometry of one block, and the load to be balanced.

    Cables are straight, with half of their weight at the platform: the first guess.
    """
    for i in range(cables.shape[0]):
        row = cables[i]
        for j in range(lane.size):
            place_cable(row, j, situation, lane[j], i)
            straighten(row, j, 0.5)
    for j in range(lane.size):
        load = load_of(situation, lane[j])
        for axis in range(6):
            poses[LOAD + axis, j] = load[axis]


@inner
def put_cables(cables: FloatArray, figures: CableFigures, lane: IntArray) -> None:
    """Fill the figures of the cables of one block."""
    for i in range(cables.shape[0]):
        for j in range(lane.size):
            put_cable(cables[i], j, figures, lane[j], i)


@inner
def linearise(cables: FloatArray) -> None:
    """Condense each cable's length: pull and top tension as linear functions of the step in p."""
    for i in range(cables.shape[0]):
        row = cables[i]
        for j in range(cables.shape[2]):
            condense(row, j)


@inner
def assemble(A: FloatArray, cables: FloatArray, poses: FloatArray, rows: IntArray) -> None:
    """Write the linearised balance: columns dp, then minus the present wrench, then the load.

    `rows` are the components of the wrench that are balanced, of 0 … 5; with more cables than those
    the matrix is wider than high.
    """
    n = cables.shape[0]
    for m in range(rows.size):
        level, lift, is_level = LEVEL + rows[m], LIFT + rows[m], rows[m] in (0, 1, 5)
        rest = A[m, n]
        fill(rest, 0.0)
        copy(poses[LOAD + rows[m]], A[m, n + 1])
        for i in range(n):
            row, slope = cables[i], A[m, i]
            if is_level:  # nothing to lift: the same, but quicker
                for j in range(poses.shape[1]):
                    slope[j] = row[SHARE, j] * row[level, j]
                    rest[j] -= slope[j] * row[P, j]
                continue
            for j in range(poses.shape[1]):
                w, across, up = row[SHARE, j], row[level, j], row[lift, j]
                slope[j] = w * (across + up * row[V_P, j])
                rest[j] -= w * (across * row[P, j] + up * row[V, j])


@inner
def aim_at_strength(poses: FloatArray, A: FloatArray, cables: FloatArray) -> None:
    """Set as goal the largest c that no linearised top tension forbids."""
    fill(poses[GOAL], np.inf)
    n = cables.shape[0]
    for i in range(n):
        row = cables[i]
        for j in range(poses.shape[1]):
            slope = row[T_P, j] * A[i, n + 1, j]
            room = row[STRENGTH, j] - row[T, j] - row[T_P, j] * A[i, n, j]
            bound = room / slope if slope > 0.0 else np.inf
            poses[GOAL, j] = min(poses[GOAL, j], bound)


@inner
def approach(poses: FloatArray, gently: bool) -> None:
    """Move c to its goal; gently, down by no more than a factor, and only once p has followed."""
    for j in range(poses.shape[1]):
        old = poses[C, j]
        limit = _LARGEST_FALL * old if poses[STEP, j] < _FOLLOWED else old
        c = max(poses[GOAL, j], limit) if gently else poses[GOAL, j]
        poses[C, j] = c
        poses[STEP, j] = abs(c - old) / (abs(c) + 1e-300)


@inner
def advance(cables: FloatArray, A: FloatArray, poses: FloatArray) -> None:
    """Apply the Newton step, each p within a factor of five, and note the largest relative step."""
    n = cables.shape[0]
    for i in range(n):
        row = cables[i]
        for j in range(poses.shape[1]):
            old = row[P, j]
            new = min(max(old + A[i, n, j] + poses[C, j] * A[i, n + 1, j], 0.2 * old), 5.0 * old)
            length = row[L, j]
            move = row[L_0, j] + row[L_P, j] * (new - old)
            row[L, j] = min(max(length + move, 0.5 * length), 2.0 * length)
            row[P, j] = new
            step = abs(new - old) / new + abs(row[L, j] - length) / length
            poses[STEP, j] = max(poses[STEP, j], step)


@inner
def first_guess(cables: FloatArray, A: FloatArray, poses: FloatArray) -> None:
    """Set p from the straight-cable balance, kept positive: a slack cable hangs, never pushes."""
    n = cables.shape[0]
    for i in range(n):
        row = cables[i]
        for j in range(poses.shape[1]):
            p = A[i, n, j] + poses[C, j] * A[i, n + 1, j]
            row[P, j] = p if p > _LEAST_START else _LEAST_START
            row[STRAIGHT, j] = row[SHARE, j] * A[i, n + 1, j] * row[L, j]


@inner
def normal_equations(normal: FloatArray, A: FloatArray, m: int, right: int) -> None:
    """Set AᵀA of the first m rows of A and, beside it, Aᵀ times their column `right`."""
    n = normal.shape[0] - 1
    for i in range(n):
        normal[i] = 0.0
        for r in range(m):
            own = A[r, i]
            for k in range(n + 1):
                other, entry = A[r, k if k < n else right], normal[i, k]
                for j in range(own.size):
                    entry[j] += own[j] * other[j]


@inner
def write_lane(out: FloatArray, cables: FloatArray, j: int) -> None:
    """Write unstrained length [m] and forces at the platform [N] of a pose, (n_cables, 3).

    After `linearise`, whose change of length closes the cables to rounding.
    """
    for i in range(cables.shape[0]):
        row = cables[i]
        w = row[SHARE, j]
        out[i, LENGTH] = row[L, j] + row[L_0, j]
        out[i, FORCE_X] = w * row[P, j] * np.sqrt(row[X2, j])
        out[i, FORCE_Z] = -w * row[V, j]
