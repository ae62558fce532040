"""Statics and sizing of many poses of a robot with as many cables as degrees of freedom.

In a pose the unknowns are the pull p and the unstrained length l of each cable, and, when sizing,
the inverse weight c = 1/w. With cables of unit weight (see `unit_cable`) the platform's balance,
Riehl et al., ICRA 2010, eq. (9), is linear in c:

    Σᵢ ωᵢ (pᵢ eᵢ, vᵢ; moments) = c · load

eᵢ is the horizontal vector from attachment to exit point, ωᵢ the cable's weight relative to w.
Each cable's length is eliminated by its closure, so a Newton step is one n × n solve with two
right-hand sides: the step at c = 0 and the change per c. Sizing then takes the largest c, hence
the lightest cable, for which every linearised top tension stays within the strength length.

Poses are worked on in blocks of lanes; every array is laid out with the lane as its last axis.
"""

from __future__ import annotations

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.kernel.answer import TOLERANCE, check, evaluate, store
from designer.kernel.compiling import kernel
from designer.kernel.layout import CABLE_ROWS, GOAL, LANES, POSE_ROWS, RESIDUAL, STEP, C
from designer.kernel.linear import solve_lanes
from designer.kernel.step import (
    advance,
    aim_at_strength,
    approach,
    assemble,
    first_guess,
    linearise,
    linearise_taut,
    place,
)  # fmt: skip

_ATTEMPTS = ((5, 1e-6, 0.0), (12, 1e-6, 0.0), (60, 1e-11, 0.0), (120, 1e-11, 30.0))
"""Iterations, relative step at which Newton stops, and lightness of the start of each attempt; only
the poses that fail go on to the next one. Newton converges quadratically, so as a rule a step of
1e-6 leaves an error near 1e-12."""


@kernel
def _solve_block(
    cables: FloatArray,
    A: FloatArray,
    poses: FloatArray,
    kappa: FloatArray,
    weights: FloatArray,
    strength: FloatArray,
    rows: IntArray,
    inverse_weight: float,
    iterations: int,
    smallest_step: float,
    lightness: float,
) -> None:
    """Newton on one placed block; a negative `inverse_weight` asks for the largest instead.

    With `lightness` above zero it starts from cables lighter by that factor, which are nearly
    straight, and lets them grow heavier step by step.
    """
    n = kappa.size
    poses[GOAL] = inverse_weight
    for iteration in range(iterations):
        if iteration == 0:
            linearise_taut(cables, n)
        else:
            linearise(cables, kappa, n)
        assemble(A, cables, poses, weights, rows, n)
        solve_lanes(A, n, n + 2)
        if inverse_weight < 0.0:
            aim_at_strength(poses, A, cables, strength, n)
        if iteration == 0:
            for j in range(LANES):
                poses[C, j] = poses[GOAL, j] + lightness * abs(poses[GOAL, j])
            first_guess(cables, A, poses, weights, n)
            poses[STEP] = 0.0
        else:
            approach(poses, lightness > 0.0)
            advance(cables, A, poses, n)
            if np.max(poses[STEP]) < smallest_step:
                break


@kernel
def solve_range(
    start: int,
    stop: int,
    exit_points: FloatArray,
    attachments: FloatArray,
    load: FloatArray,
    load_point: FloatArray,
    weight: float,
    positions: FloatArray,
    rotations: FloatArray,
    kappa: FloatArray,
    weights: FloatArray,
    strength: FloatArray,
    inverse_weight: float,
    rows: IntArray,
    out_cables: FloatArray,
    out_poses: FloatArray,
    out_verdict: IntArray,
) -> None:
    """Solve the poses from `start` to `stop`: all quickly, then the failed ones again."""
    n = kappa.size
    cables = np.empty((n, CABLE_ROWS, LANES))
    A = np.empty((n + 1, n + 2, LANES))
    poses = np.empty((POSE_ROWS, LANES))
    pending = np.arange(start, stop)
    for iterations, step, lightness in _ATTEMPTS:
        failed = 0
        for first in range(0, pending.size, LANES):
            lane = pending[np.minimum(np.arange(first, first + LANES), pending.size - 1)]
            place(
                cables,
                poses,
                exit_points,
                attachments,
                load,
                load_point,
                weight,
                positions,
                rotations,
                lane,
            )
            _solve_block(
                cables, A, poses, kappa, weights, strength, rows, inverse_weight,
                iterations, step, lightness,
            )  # fmt: skip
            evaluate(cables, kappa, n)
            check(poses, cables, weights, strength, rows)
            store(out_cables, out_poses, out_verdict, cables, poses, lane, inverse_weight < 0.0)
            for j in range(min(LANES, pending.size - first)):
                # Negated, so that NaN counts as failed.
                if not poses[RESIDUAL, j] <= TOLERANCE:
                    pending[failed] = lane[j]
                    failed += 1
        pending = pending[:failed]
        if failed == 0:
            break
