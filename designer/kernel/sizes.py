"""Statics of many cables in the same poses: every size of a catalogue in one pass.

What the sizes share is done once a block of poses: the geometry and the straight, weightless first
guess. The sizes come in the order of their weight, so that each starts from the state of its
neighbour, and Newton's first step, which is linear in c = 1/w, lands near the solution. Nothing is
kept of a pose but what raises a maximum or a count, so that memory does not grow with the poses.

For the unknowns and the balance see `designer.kernel.square`; the same cable is on every winch.
"""

from __future__ import annotations

import numpy as np

from designer.arrays import BoolArray, FloatArray, IntArray
from designer.kernel.answer import TOLERANCE, check, evaluate
from designer.kernel.compiling import kernel
from designer.kernel.layout import (
    CABLE_ROWS,
    LANES,
    OVERLOAD,
    POSE_ROWS,
    RESIDUAL,
    STEP,
    X2,
    C,
    D,
    L,
    P,
    V,
)  # fmt: skip
from designer.kernel.linear import solve_lanes
from designer.kernel.step import (
    advance,
    assemble,
    first_guess,
    linearise,
    linearise_taut,
    place,
)  # fmt: skip

_ITERATIONS = 6
_SMALLEST_STEP = 1e-6
_LEAST_PULL = 0.01


@kernel
def sweep_sizes(
    first: int,
    last: int,
    exit_points: FloatArray,
    attachments: FloatArray,
    load: FloatArray,
    load_point: FloatArray,
    weight: float,
    positions: FloatArray,
    rotations: FloatArray,
    cells: IntArray,
    kappa: FloatArray,
    inverse_weight: FloatArray,
    strength: FloatArray,
    rows: IntArray,
    leaves_out_hanging: bool,
    worst: FloatArray,
    worst_at: IntArray,
    longest: FloatArray,
    counted: IntArray,
    overloaded: IntArray,
    left_out: IntArray,
    failed: BoolArray,
) -> None:
    """Solve all poses with the sizes from `first` to `last`, and keep what they ask for.

    Parameters
    ----------
    exit_points, load : array (n_cables, 3), (6,)
        The same in all poses; what follows is as in `designer.kernel.square.solve_range`.
    cells : array (n_poses,)
        Part of the region that each pose lies in.
    kappa, inverse_weight, strength : array (n_sizes,)
        Weight over axial stiffness [1/m], 1 / w [m/N], allowable tension over weight [m].
    leaves_out_hanging : bool
        Whether poses in which a cable hangs below the platform do not count.
    worst, worst_at : array (n_sizes, n_cells)
        Raised to the largest tension over the allowable one in each cell; index of that pose.
    longest : array (n_sizes, n_cables)
        Raised to the longest unstrained length of each cable [m].
    counted, overloaded, left_out : array (n_sizes,)
        Increased by the poses that count, those above the allowable tension, those left out.
    failed : array (n_sizes, n_poses)
        Set where no solution was found; such a pose is in none of the other results.
    """
    n = exit_points.shape[0]
    points, loads = exit_points.reshape(1, n, 3), load.reshape(1, 6)
    cables = np.empty((n, CABLE_ROWS, LANES))
    A = np.empty((n + 1, n + 2, LANES))
    poses = np.empty((POSE_ROWS, LANES))
    guess = np.empty((2, n, LANES))
    ones = np.ones(n)
    for start in range(0, positions.shape[0], LANES):
        lane = np.minimum(np.arange(start, start + LANES), positions.shape[0] - 1)
        place(
            cables, poses, points, attachments, loads, load_point, weight,
            positions, rotations, lane,
        )  # fmt: skip
        linearise_taut(cables, n)
        assemble(A, cables, poses, ones, rows, n)
        solve_lanes(A, n, n + 2)
        for i in range(n):
            guess[0, i] = A[i, n]
            guess[1, i] = A[i, n + 1]
        poses[C] = inverse_weight[first]
        first_guess(cables, A, poses, ones, n)
        for size in range(first, last):
            poses[C] = inverse_weight[size]
            _solve(cables, A, poses, kappa[size] * ones, ones, rows, n)
            evaluate(cables, kappa[size] * ones, n)
            check(poses, cables, ones, strength[size] * ones, rows)
            for j in range(min(LANES, positions.shape[0] - start)):
                at = lane[j]
                # Negated, so that NaN counts as failed.
                if not (poses[RESIDUAL, j] <= TOLERANCE and poses[OVERLOAD, j] < np.inf):
                    failed[size, at] = True
                elif leaves_out_hanging and _hangs_below(cables, j):
                    left_out[size] += 1
                else:
                    counted[size] += 1
                    overloaded[size] += poses[OVERLOAD, j] > 1.0
                    for i in range(n):
                        longest[size, i] = max(longest[size, i], cables[i, L, j])
                    if poses[OVERLOAD, j] > worst[size, cells[at]]:
                        worst[size, cells[at]] = poses[OVERLOAD, j]
                        worst_at[size, cells[at]] = at
            _restart_failed(cables, poses, guess, n)


@kernel
def _solve(
    cables: FloatArray,
    A: FloatArray,
    poses: FloatArray,
    kappa: FloatArray,
    weights: FloatArray,
    rows: IntArray,
    n: int,
) -> None:
    """Newton on one block at given weight, from the state that it is in."""
    for _ in range(_ITERATIONS):
        linearise(cables, kappa, n)
        assemble(A, cables, poses, weights, rows, n)
        solve_lanes(A, n, n + 2)
        poses[STEP] = 0.0
        advance(cables, A, poses, n)
        if np.max(poses[STEP]) < _SMALLEST_STEP:
            break


@kernel
def _hangs_below(cables: FloatArray, j: int) -> bool:
    found = False
    for i in range(cables.shape[0]):
        found = found or (cables[i, V, j] < 0.0 and cables[i, D, j] >= 0.0)
    return found


@kernel
def _restart_failed(cables: FloatArray, poses: FloatArray, guess: FloatArray, n: int) -> None:
    """Put lanes that failed back to straight cables, so that the next size has a start."""
    for j in range(LANES):
        if not poses[RESIDUAL, j] <= TOLERANCE:
            for i in range(n):
                row = cables[i]
                row[P, j] = max(guess[0, i, j] + poses[C, j] * guess[1, i, j], _LEAST_PULL)
                row[L, j] = np.sqrt(row[X2, j] + row[D, j] ** 2)
