"""One Newton step for a block of poses; see `designer.kernel.square` for the method."""

from __future__ import annotations

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.kernel.compiling import element, kernel
from designer.kernel.layout import (
    EX,
    EY,
    GOAL,
    L_0,
    L_P,
    LANES,
    LOAD,
    MASSLESS,
    RX,
    RY,
    RZ,
    STEP,
    T_P,
    V_P,
    X2,
    C,
    D,
    L,
    P,
    T,
    V,
)  # fmt: skip
from designer.kernel.unit_cable import unit_cable

_LARGEST_FALL = 0.7
_FOLLOWED = 0.1


@kernel
def place(
    cables: FloatArray,
    poses: FloatArray,
    exit_points: FloatArray,
    attachments: FloatArray,
    load: FloatArray,
    load_point: FloatArray,
    weight: float,
    positions: FloatArray,
    rotations: FloatArray,
    indices: IntArray,
) -> None:
    """Fill the geometry of one block: cable vectors, levers and the load to be balanced.

    Exit points, load (force at the body origin, then moment) and rotations have a leading axis of
    poses, or of one for all; the weight, which is part of the force, acts at `load_point` of the
    body, and what that makes of moment comes on top.
    """
    n = exit_points.shape[1]
    for j in range(LANES):
        at = indices[j]
        x = positions[at]
        A = exit_points[at if exit_points.shape[0] > 1 else 0]
        Q = rotations[at if rotations.shape[0] > 1 else 0]
        f = load[at if load.shape[0] > 1 else 0]
        for i in range(n):
            b = attachments[i]
            row = cables[i]
            for axis in range(3):
                r = Q[axis, 0] * b[0] + Q[axis, 1] * b[1] + Q[axis, 2] * b[2]
                row[RX + axis, j] = r
                row[EX + axis, j] = A[i, axis] - x[axis] - r
            row[X2, j] = row[EX, j] ** 2 + row[EY, j] ** 2
            row[L, j] = np.sqrt(row[X2, j] + row[D, j] ** 2)
        s = load_point
        sx = Q[0, 0] * s[0] + Q[0, 1] * s[1] + Q[0, 2] * s[2]
        sy = Q[1, 0] * s[0] + Q[1, 1] * s[1] + Q[1, 2] * s[2]
        for axis in range(6):
            poses[LOAD + axis, j] = f[axis]
        poses[LOAD + 3, j] += sy * weight
        poses[LOAD + 4, j] -= sx * weight


@kernel
def linearise_taut(cables: FloatArray, n: int) -> None:
    """Straight cables with half of their weight at the platform: the first guess."""
    for i in range(n):
        row = cables[i]
        for j in range(LANES):
            length = np.sqrt(row[X2, j] + row[D, j] ** 2)
            row[P, j] = 0.0
            row[L, j] = length
            row[V, j] = -0.5 * length
            row[V_P, j] = row[D, j]
            row[T, j] = 0.5 * abs(row[D, j])
            row[T_P, j] = length
            row[L_0, j] = 0.0
            row[L_P, j] = 0.0


@kernel
def linearise(cables: FloatArray, kappa: FloatArray, n: int) -> None:
    """Condense each cable's length: pull and top tension as linear functions of the step in p."""
    for i in range(n):
        row = cables[i]
        k = kappa[i]
        for j in range(LANES):
            F, F_p, F_l, v, v_p, v_l, t, t_p, t_l = unit_cable(
                row[P, j], row[L, j], row[X2, j], row[D, j], k
            )
            l0 = -F / F_l
            lp = -F_p / F_l
            row[V, j] = v + v_l * l0
            row[V_P, j] = v_p + v_l * lp
            row[T, j] = t + t_l * l0
            row[T_P, j] = t_p + t_l * lp
            row[L_0, j] = l0
            row[L_P, j] = lp


@kernel
def assemble(
    A: FloatArray,
    cables: FloatArray,
    poses: FloatArray,
    weights: FloatArray,
    rows: IntArray,
    n: int,
) -> None:
    """Write the linearised balance: columns dp, then minus the present wrench, then the load.

    `rows` are the components of the wrench that are balanced, of 0 … 5; with more cables than those
    the matrix is wider than high.
    """
    for m in range(rows.size):
        for j in range(LANES):
            A[m, n, j] = 0.0
            A[m, n + 1, j] = poses[LOAD + rows[m], j]
        for i in range(n):
            if rows[m] < 2:
                _balance_pull(A[m, i], A[m, n], cables[i], weights[i], EX + rows[m])
            elif rows[m] == 2:
                _balance_lift(A[m, i], A[m, n], cables[i], weights[i])
            else:
                _balance_moment(A[m, i], A[m, n], cables[i], weights[i], rows[m] - 3)


@element
def _balance_pull(
    slope: FloatArray, rest: FloatArray, row: FloatArray, w: float, axis: int
) -> None:
    for j in range(LANES):
        slope[j] = w * row[axis, j]
        rest[j] -= w * row[P, j] * row[axis, j]


@element
def _balance_lift(slope: FloatArray, rest: FloatArray, row: FloatArray, w: float) -> None:
    for j in range(LANES):
        slope[j] = w * row[V_P, j]
        rest[j] -= w * row[V, j]


@element
def _balance_moment(
    slope: FloatArray, rest: FloatArray, row: FloatArray, w: float, axis: int
) -> None:
    for j in range(LANES):
        p, v = row[P, j], row[V, j]
        x, y, s = row[EX, j], row[EY, j], row[V_P, j]
        rx, ry, rz = row[RX, j], row[RY, j], row[RZ, j]
        if axis == 0:
            slope[j] = w * (ry * s - rz * y)
            rest[j] -= w * (ry * v - rz * p * y)
        elif axis == 1:
            slope[j] = w * (rz * x - rx * s)
            rest[j] -= w * (rz * p * x - rx * v)
        else:
            slope[j] = w * (rx * y - ry * x)
            rest[j] -= w * p * (rx * y - ry * x)


@kernel
def aim_at_strength(
    poses: FloatArray, A: FloatArray, cables: FloatArray, strength: FloatArray, n: int
) -> None:
    """Set as goal the largest c that no linearised top tension forbids."""
    poses[GOAL] = np.inf
    for i in range(n):
        row = cables[i]
        for j in range(LANES):
            slope = row[T_P, j] * A[i, n + 1, j]
            room = strength[i] - row[T, j] - row[T_P, j] * A[i, n, j]
            bound = room / slope if slope > 0.0 else np.inf
            poses[GOAL, j] = min(poses[GOAL, j], bound)


@kernel
def approach(poses: FloatArray, gently: bool) -> None:
    """Move c to its goal; gently, down by no more than a factor, and only once p has followed."""
    for j in range(LANES):
        old = poses[C, j]
        limit = _LARGEST_FALL * old if poses[STEP, j] < _FOLLOWED else old
        c = max(poses[GOAL, j], limit) if gently else poses[GOAL, j]
        poses[C, j] = c
        poses[STEP, j] = abs(c - old) / (abs(c) + 1e-300)


@kernel
def advance(cables: FloatArray, A: FloatArray, poses: FloatArray, n: int) -> None:
    """Apply the Newton step, each p within a factor of five, and note the largest relative step."""
    for i in range(n):
        row = cables[i]
        for j in range(LANES):
            old = row[P, j]
            new = min(max(old + A[i, n, j] + poses[C, j] * A[i, n + 1, j], 0.2 * old), 5.0 * old)
            length = row[L, j]
            move = row[L_0, j] + row[L_P, j] * (new - old)
            row[L, j] = min(max(length + move, 0.5 * length), 2.0 * length)
            row[P, j] = new
            step = abs(new - old) / new + abs(row[L, j] - length) / length
            poses[STEP, j] = max(poses[STEP, j], step)


@kernel
def first_guess(
    cables: FloatArray, A: FloatArray, poses: FloatArray, weights: FloatArray, n: int
) -> None:
    """Set p from the straight-cable balance, kept positive: a slack cable hangs, never pushes."""
    for i in range(n):
        row = cables[i]
        for j in range(LANES):
            p = A[i, n, j] + poses[C, j] * A[i, n + 1, j]
            row[P, j] = p if p > 0.01 else 0.01
            row[MASSLESS, j] = weights[i] * A[i, n + 1, j] * row[L, j]
