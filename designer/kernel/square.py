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
from designer.kernel.compiling import kernel
from designer.kernel.linear import solve_lanes
from designer.kernel.unit_cable import PULL_FLOOR, unit_cable

LANES = 128

# Rows of a cable in the work array.
_P, _L, _X2, _EX, _EY, _D, _RX, _RY, _RZ = range(9)
_V, _VP, _T, _TP, _L0, _LP, _MASSLESS = range(9, 16)
_ROWS = 16
# Rows of a pose in the pose array: load (6), inverse weight, largest relative step, what is left of
# the balance (6), its scales of force and length, and the figures of merit that are stored.
_C, _STEP, _REST, _SCALE, _REACH = 6, 7, 8, 14, 15
_CLOSURE, _BALANCE, _RESIDUAL, _OVERLOAD, _GOAL = range(16, 21)

# Rows of a cable in the results, and of a pose.
OUT_H, OUT_L, OUT_V, OUT_T, OUT_MASSLESS = range(5)
OUT_C, OUT_CLOSURE, OUT_BALANCE, OUT_RESIDUAL, OUT_OVERLOAD = range(5)

_ATTEMPTS = ((5, 1e-6, 0.0), (12, 1e-6, 0.0), (60, 1e-11, 0.0), (120, 1e-11, 30.0))
"""Iterations, relative step at which Newton stops, and lightness of the start of each attempt; only
the poses that fail go on to the next one. Newton converges quadratically, so as a rule a step of
1e-6 leaves an error near 1e-12."""
_LARGEST_FALL = 0.7
TOLERANCE = 1e-10
"""Largest residual of closure (over length) and of balance (over the largest force)."""


@kernel
def _place(
    cables: FloatArray,
    poses: FloatArray,
    exit_points: FloatArray,
    attachments: FloatArray,
    load: FloatArray,
    load_point: FloatArray,
    positions: FloatArray,
    rotations: FloatArray,
    indices: IntArray,
) -> None:
    """Fill the geometry of one block: cable vectors, levers and the load to be balanced."""
    n = exit_points.shape[0]
    for j in range(LANES):
        x = positions[indices[j]]
        Q = rotations[indices[j] if rotations.shape[0] > 1 else 0]
        for i in range(n):
            b = attachments[i]
            row = cables[i]
            for axis in range(3):
                r = Q[axis, 0] * b[0] + Q[axis, 1] * b[1] + Q[axis, 2] * b[2]
                row[_RX + axis, j] = r
                row[_EX + axis, j] = exit_points[i, axis] - x[axis] - r
            row[_X2, j] = row[_EX, j] ** 2 + row[_EY, j] ** 2
            row[_L, j] = np.sqrt(row[_X2, j] + row[_D, j] ** 2)
        s = load_point
        for axis in range(3):
            poses[axis, j] = load[axis]
        sx = Q[0, 0] * s[0] + Q[0, 1] * s[1] + Q[0, 2] * s[2]
        sy = Q[1, 0] * s[0] + Q[1, 1] * s[1] + Q[1, 2] * s[2]
        sz = Q[2, 0] * s[0] + Q[2, 1] * s[1] + Q[2, 2] * s[2]
        poses[3, j] = load[3] + sy * load[2] - sz * load[1]
        poses[4, j] = load[4] + sz * load[0] - sx * load[2]
        poses[5, j] = load[5] + sx * load[1] - sy * load[0]


@kernel
def _linearise_taut(cables: FloatArray, n: int) -> None:
    """Straight cables with half of their weight at the platform: the first guess."""
    for i in range(n):
        row = cables[i]
        for j in range(LANES):
            length = np.sqrt(row[_X2, j] + row[_D, j] ** 2)
            row[_P, j] = 0.0
            row[_L, j] = length
            row[_V, j] = -0.5 * length
            row[_VP, j] = row[_D, j]
            row[_T, j] = 0.5 * abs(row[_D, j])
            row[_TP, j] = length
            row[_L0, j] = 0.0
            row[_LP, j] = 0.0


@kernel
def _linearise(cables: FloatArray, kappa: FloatArray, n: int) -> None:
    """Condense each cable's length: pull and top tension as linear functions of the step in p."""
    for i in range(n):
        row = cables[i]
        k = kappa[i]
        for j in range(LANES):
            F, F_p, F_l, v, v_p, v_l, t, t_p, t_l = unit_cable(
                row[_P, j], row[_L, j], row[_X2, j], row[_D, j], k
            )
            l0 = -F / F_l
            lp = -F_p / F_l
            row[_V, j] = v + v_l * l0
            row[_VP, j] = v_p + v_l * lp
            row[_T, j] = t + t_l * l0
            row[_TP, j] = t_p + t_l * lp
            row[_L0, j] = l0
            row[_LP, j] = lp


@kernel
def _assemble(
    A: FloatArray, cables: FloatArray, poses: FloatArray, weights: FloatArray, n: int
) -> None:
    """Write the linearised balance: columns dp, then minus the present wrench, then the load."""
    for m in range(n):
        for j in range(LANES):
            A[m, n, j] = 0.0
            A[m, n + 1, j] = poses[m, j]
    for i in range(n):
        row = cables[i]
        w = weights[i]
        for j in range(LANES):
            p, v = row[_P, j], row[_V, j]
            x, y, s = row[_EX, j], row[_EY, j], row[_VP, j]
            A[0, i, j] = w * x
            A[1, i, j] = w * y
            A[2, i, j] = w * s
            A[0, n, j] -= w * p * x
            A[1, n, j] -= w * p * y
            A[2, n, j] -= w * v
        if n == 6:
            for j in range(LANES):
                p, v = row[_P, j], row[_V, j]
                x, y, s = row[_EX, j], row[_EY, j], row[_VP, j]
                rx, ry, rz = row[_RX, j], row[_RY, j], row[_RZ, j]
                A[3, i, j] = w * (ry * s - rz * y)
                A[4, i, j] = w * (rz * x - rx * s)
                A[5, i, j] = w * (rx * y - ry * x)
                A[3, n, j] -= w * (ry * v - rz * p * y)
                A[4, n, j] -= w * (rz * p * x - rx * v)
                A[5, n, j] -= w * p * (rx * y - ry * x)


@kernel
def _aim_at_strength(
    poses: FloatArray, A: FloatArray, cables: FloatArray, strength: FloatArray, n: int
) -> None:
    """Set as goal the largest c that no linearised top tension forbids."""
    poses[_GOAL] = np.inf
    for i in range(n):
        row = cables[i]
        for j in range(LANES):
            slope = row[_TP, j] * A[i, n + 1, j]
            room = strength[i] - row[_T, j] - row[_TP, j] * A[i, n, j]
            bound = room / slope if slope > 0.0 else np.inf
            poses[_GOAL, j] = min(poses[_GOAL, j], bound)


@kernel
def _approach(poses: FloatArray, largest_fall: float) -> None:
    """Move c to its goal, but down by no more than a factor, and only once p has followed."""
    for j in range(LANES):
        old = poses[_C, j]
        limit = largest_fall * old if poses[_STEP, j] < 0.1 else old
        c = max(poses[_GOAL, j], limit) if largest_fall > 0.0 else poses[_GOAL, j]
        poses[_C, j] = c
        poses[_STEP, j] = abs(c - old) / (abs(c) + 1e-300)


@kernel
def _advance(cables: FloatArray, A: FloatArray, poses: FloatArray, n: int) -> None:
    """Apply the Newton step, each p within a factor of five, and note the largest relative step."""
    for i in range(n):
        row = cables[i]
        for j in range(LANES):
            old = row[_P, j]
            new = min(max(old + A[i, n, j] + poses[_C, j] * A[i, n + 1, j], 0.2 * old), 5.0 * old)
            length = row[_L, j]
            move = row[_L0, j] + row[_LP, j] * (new - old)
            row[_L, j] = min(max(length + move, 0.5 * length), 2.0 * length)
            row[_P, j] = new
            step = abs(new - old) / new + abs(row[_L, j] - length) / length
            poses[_STEP, j] = max(poses[_STEP, j], step)


@kernel
def _first_guess(
    cables: FloatArray, A: FloatArray, poses: FloatArray, weights: FloatArray, n: int
) -> None:
    """Set p from the straight-cable balance, kept positive: a slack cable hangs, it never pushes."""
    for i in range(n):
        row = cables[i]
        for j in range(LANES):
            p = A[i, n, j] + poses[_C, j] * A[i, n + 1, j]
            row[_P, j] = p if p > 0.01 else 0.01
            row[_MASSLESS, j] = weights[i] * A[i, n + 1, j] * row[_L, j]


@kernel
def _evaluate(cables: FloatArray, kappa: FloatArray, n: int) -> None:
    """Put the true pull, top tension and closure error of the state into the cable rows."""
    for i in range(n):
        row = cables[i]
        k = kappa[i]
        for j in range(LANES):
            F, _, F_l, v, _, _, t, _, _ = unit_cable(
                row[_P, j], row[_L, j], row[_X2, j], row[_D, j], k
            )
            row[_V, j] = v
            row[_T, j] = t
            # A cable stretched through zero length closes too, with a negative tension.
            row[_L0, j] = abs(F / F_l) if t > 0.0 else np.inf


@kernel
def _check(
    poses: FloatArray, cables: FloatArray, weights: FloatArray, strength: FloatArray, n: int
) -> None:
    """Compute the residuals of closure and of the platform's balance, and the worst overload."""
    for j in range(LANES):
        c = poses[_C, j]
        for m in range(6):
            poses[_REST + m, j] = -c * poses[m, j]
        poses[_SCALE, j] = abs(c) * (abs(poses[0, j]) + abs(poses[1, j]) + abs(poses[2, j]))
        poses[_REACH, j] = 1e-300
        poses[_CLOSURE, j] = poses[_RESIDUAL, j] = poses[_OVERLOAD, j] = 0.0
    for i in range(n):
        row = cables[i]
        w = weights[i]
        for j in range(LANES):
            x, y, v = row[_P, j] * row[_EX, j], row[_P, j] * row[_EY, j], row[_V, j]
            rx, ry, rz = row[_RX, j], row[_RY, j], row[_RZ, j]
            poses[_REST, j] += w * x
            poses[_REST + 1, j] += w * y
            poses[_REST + 2, j] += w * v
            poses[_REST + 3, j] += w * (ry * v - rz * y)
            poses[_REST + 4, j] += w * (rz * x - rx * v)
            poses[_REST + 5, j] += w * (rx * y - ry * x)
            poses[_SCALE, j] = max(poses[_SCALE, j], w * row[_T, j])
            poses[_REACH, j] = max(poses[_REACH, j], abs(rx) + abs(ry) + abs(rz))
            poses[_CLOSURE, j] = max(poses[_CLOSURE, j], row[_L0, j])
            poses[_RESIDUAL, j] = max(poses[_RESIDUAL, j], row[_L0, j] / row[_L, j])
            burst = row[_T, j] / strength[i] if row[_P, j] >= PULL_FLOOR else np.inf
            poses[_OVERLOAD, j] = max(poses[_OVERLOAD, j], burst)
    for j in range(LANES):
        force = abs(poses[_REST, j]) + abs(poses[_REST + 1, j]) + abs(poses[_REST + 2, j])
        moment = abs(poses[_REST + 3, j]) + abs(poses[_REST + 4, j]) + abs(poses[_REST + 5, j])
        force += moment / poses[_REACH, j] if n == 6 else 0.0
        poses[_BALANCE, j] = force
        # Addition instead of a maximum, because it lets NaN through.
        poses[_RESIDUAL, j] += force / poses[_SCALE, j]


@kernel
def _store(
    out_cables: FloatArray,
    out_poses: FloatArray,
    cables: FloatArray,
    poses: FloatArray,
    indices: IntArray,
    n: int,
) -> None:
    for j in range(LANES):
        at = indices[j]
        for i in range(n):
            out_cables[i, OUT_H, at] = cables[i, _P, j] * np.sqrt(cables[i, _X2, j])
            for out, row in ((OUT_L, _L), (OUT_V, _V), (OUT_T, _T)):
                out_cables[i, out, at] = cables[i, row, j]
            out_cables[i, OUT_MASSLESS, at] = cables[i, _MASSLESS, j]
        out_poses[OUT_C, at] = poses[_C, j]
        out_poses[OUT_CLOSURE, at] = poses[_CLOSURE, j]
        out_poses[OUT_BALANCE, at] = poses[_BALANCE, j]
        out_poses[OUT_RESIDUAL, at] = poses[_RESIDUAL, j]
        out_poses[OUT_OVERLOAD, at] = poses[_OVERLOAD, j]


@kernel
def _solve_block(
    cables: FloatArray,
    A: FloatArray,
    poses: FloatArray,
    kappa: FloatArray,
    weights: FloatArray,
    strength: FloatArray,
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
    poses[_GOAL] = inverse_weight
    for iteration in range(iterations):
        if iteration == 0:
            _linearise_taut(cables, n)
        else:
            _linearise(cables, kappa, n)
        _assemble(A, cables, poses, weights, n)
        solve_lanes(A, n, n + 2)
        if inverse_weight < 0.0:
            _aim_at_strength(poses, A, cables, strength, n)
        if iteration == 0:
            for j in range(LANES):
                poses[_C, j] = poses[_GOAL, j] + lightness * abs(poses[_GOAL, j])
            _first_guess(cables, A, poses, weights, n)
            poses[_STEP] = 0.0
        else:
            _approach(poses, _LARGEST_FALL if lightness > 0.0 else 0.0)
            _advance(cables, A, poses, n)
            if np.max(poses[_STEP]) < smallest_step:
                break


@kernel
def solve_range(
    start: int,
    stop: int,
    exit_points: FloatArray,
    attachments: FloatArray,
    load: FloatArray,
    load_point: FloatArray,
    positions: FloatArray,
    rotations: FloatArray,
    kappa: FloatArray,
    weights: FloatArray,
    strength: FloatArray,
    inverse_weight: float,
    out_cables: FloatArray,
    out_poses: FloatArray,
) -> None:
    """Solve the poses from `start` to `stop`: all quickly, then the failed ones again."""
    n = kappa.size
    cables = np.empty((n, _ROWS, LANES))
    A = np.empty((n + 1, n + 2, LANES))
    poses = np.empty((21, LANES))
    pending = np.arange(start, stop)
    for iterations, step, lightness in _ATTEMPTS:
        failed = 0
        for first in range(0, pending.size, LANES):
            lane = pending[np.minimum(np.arange(first, first + LANES), pending.size - 1)]
            _place(
                cables,
                poses,
                exit_points,
                attachments,
                load,
                load_point,
                positions,
                rotations,
                lane,
            )
            _solve_block(
                cables, A, poses, kappa, weights, strength, inverse_weight,
                iterations, step, lightness,
            )  # fmt: skip
            _evaluate(cables, kappa, n)
            _check(poses, cables, weights, strength, n)
            _store(out_cables, out_poses, cables, poses, lane, n)
            for j in range(min(LANES, pending.size - first)):
                # Negated, so that NaN counts as failed.
                if not (out_poses[OUT_RESIDUAL, lane[j]] < TOLERANCE):
                    pending[failed] = lane[j]
                    failed += 1
        pending = pending[:failed]
        if failed == 0:
            break
