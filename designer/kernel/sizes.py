"""Statics of many cables in the same poses: every size of a catalogue in one pass.

What the sizes share is done once a block of poses: the geometry and the straight, weightless first
guess. The sizes come in the order of their weight, so that each starts from the state of its
neighbour, and Newton's first step, which is linear in c = 1/w, lands near the solution. Nothing is
kept of a pose but what raises a maximum or a count, so that memory does not grow with the poses.

For the unknowns and the balance see `designer.kernel.square`; the same rope is on every winch.
"""

from __future__ import annotations

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.kernel.answer import TOLERANCE
from designer.kernel.calling import CableFigures, LoadSummary, Situation
from designer.kernel.compiling import element, inner, kernel
from designer.kernel.lanes import (
    OVERLOAD,
    POSE_ROWS,
    RESIDUAL,
    STEP,
    C,
    advance,
    assemble,
    first_guess,
    lanes_of,
    linearise,
    place,
    put_cables,
)
from designer.kernel.linear import are_below, copy, fill, solve_lanes
from designer.kernel.square import check, evaluate
from designer.kernel.table import CHORD, LANE_ROWS, LANES, D, L, P, V

_ITERATIONS = 6
_SMALLEST_STEP = 1e-6
_LEAST_PULL = 0.01
"""Of a start: a slack cable hangs, never pushes."""


@kernel
def sweep_sizes(
    first: int,
    last: int,
    situation: Situation,
    inverse_weight: FloatArray,
    figures: CableFigures,
    cells: IntArray,
    leaves_out_hanging: bool,
    meets: LoadSummary,
) -> None:
    """Solve all poses with the sizes from `first` to `last`, and keep what they ask for.

    Parameters
    ----------
    inverse_weight : array (n_sizes,)
        1 / w [m/N].
    figures : CableFigures
        With a row for each size: the same on every winch but for what is attached to its cable.
    cells : array (n_poses,)
        Part of the region that each pose lies in.
    leaves_out_hanging : bool
        Whether poses in which a cable hangs below the platform do not count.
    """
    n, count, rows = situation.attachments.shape[0], cells.size, situation.rows
    # Taken out of the tuple once: looked up for every pose they take half of the time.
    utilisation, pose, longest_m = meets.utilisation, meets.pose, meets.longest_m
    counted, overloaded = meets.counted, meets.overloaded
    left_out, failed = meets.left_out, meets.failed
    cables = np.empty((n, LANE_ROWS, LANES))
    A = np.empty((n + 1, n + 2, LANES))
    poses = np.empty((POSE_ROWS, LANES))
    guess = np.empty((n, 2, LANES))
    every, of_size = np.arange(count), np.empty(LANES, dtype=np.int64)
    for start in range(0, count, LANES):
        lane = lanes_of(every, start)
        place(cables, poses, situation, lane)
        fill(of_size, first)
        put_cables(cables, figures, of_size)
        assemble(A, cables, poses, rows)
        solve_lanes(A, n, n + 2)
        for i in range(n):
            for right in range(2):
                copy(A[i, n + right], guess[i, right])
        fill(poses[C], inverse_weight[first])
        first_guess(cables, A, poses)
        for size in range(first, last):
            fill(poses[C], inverse_weight[size])
            fill(of_size, size)
            put_cables(cables, figures, of_size)
            for _ in range(_ITERATIONS):  # Newton, from the state that the poses are in
                linearise(cables)
                assemble(A, cables, poses, rows)
                solve_lanes(A, n, n + 2)
                fill(poses[STEP], 0.0)
                advance(cables, A, poses)
                if are_below(poses[STEP], _SMALLEST_STEP):
                    break
            evaluate(cables)
            check(poses, cables, rows)
            for j in range(min(LANES, count - start)):
                at, cell, overload = lane[j], cells[lane[j]], poses[OVERLOAD, j]
                # Negated, so that NaN counts as failed.
                if not (poses[RESIDUAL, j] <= TOLERANCE and overload < np.inf):
                    failed[size, at] = True
                elif leaves_out_hanging and _hangs_below(cables, j):
                    left_out[size] += 1
                else:
                    counted[size] += 1
                    overloaded[size] += overload > 1.0
                    for i in range(n):
                        longest_m[size, i] = max(longest_m[size, i], cables[i, L, j])
                    if overload > utilisation[size, cell]:
                        utilisation[size, cell] = overload
                        pose[size, cell] = at
            _restart_failed(cables, poses, guess)


@element
def _hangs_below(cables: FloatArray, j: int) -> bool:
    hangs = False
    for i in range(cables.shape[0]):
        hangs = hangs or (cables[i, V, j] < 0.0 and cables[i, D, j] >= 0.0)
    return hangs


@inner
def _restart_failed(cables: FloatArray, poses: FloatArray, guess: FloatArray) -> None:
    """Put lanes that failed back to straight cables, so that the next size has a start."""
    for j in range(LANES):
        if not poses[RESIDUAL, j] <= TOLERANCE:
            for i in range(cables.shape[0]):
                row = cables[i]
                row[P, j] = max(guess[i, 0, j] + poses[C, j] * guess[i, 1, j], _LEAST_PULL)
                row[L, j] = row[CHORD, j]
