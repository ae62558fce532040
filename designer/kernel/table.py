"""The table that every solver keeps of its cables: one row a quantity, one number a column.

Where there are as many cables as degrees of freedom, or fewer, a table holds one cable and its
columns are lanes: poses that go through each step together, so that the loops vectorise. Where
there are more cables, it holds one pose, and its columns are the cables. What is done with a column
is the same.

A cable that pulls by p (horizontal force per horizontal distance), and upward by v, has on the
platform the wrench p · `LEVEL` + v · `LIFT`, each six rows: force x, y, z, then moment x, y, z.
"""

from __future__ import annotations

import numpy as np

from designer.arrays import FloatArray
from designer.kernel.calling import CableFigures, Situation
from designer.kernel.compiling import element
from designer.kernel.unit_cable import unit_cable

LANES = 32
"""Poses of a block where columns are lanes."""

# Of the pose: squared horizontal distance, drop, chord; size of the lever, by its components.
X2, D, CHORD, LEVER = range(4)
LEVEL, LIFT = 4, 10
EX, EY = LEVEL, LEVEL + 1  # the horizontal vector to the exit point is the force of a unit pull
# State: pull and length; then upward pull and top tension with their slopes in the pull where the
# length follows the closure, and the change of that length.
P, L, V, V_P, T, T_P, L_0, L_P = range(16, 24)
STRAIGHT = 24  # tension of a straight, weightless cable
# Of the cable: weight over stiffness, weight relative to w, allowable tension over weight.
KAPPA, SHARE, STRENGTH = range(25, 28)
LANE_ROWS = 28
"""Of a table whose columns are lanes; more follow where they are cables."""


@element
def put_cable(table: FloatArray, j: int, figures: CableFigures, at: int, i: int) -> None:
    """Fill the figures of cable i in pose `at` into a column."""
    row = at if figures.kappa.shape[0] > 1 else 0
    table[KAPPA, j] = figures.kappa[row, i]
    table[SHARE, j] = figures.weights[row, i]
    table[STRENGTH, j] = figures.strength[row, i]


@element
def place_cable(table: FloatArray, j: int, situation: Situation, at: int, i: int) -> None:
    """Fill the geometry of cable i in pose `at` into a column."""
    Q = situation.rotations[at if situation.rotations.shape[0] > 1 else 0]
    A = situation.exit_points[at if situation.exit_points.shape[0] > 1 else 0, i]
    x, b = situation.positions[at], situation.attachments[i]
    rx = Q[0, 0] * b[0] + Q[0, 1] * b[1] + Q[0, 2] * b[2]
    ry = Q[1, 0] * b[0] + Q[1, 1] * b[1] + Q[1, 2] * b[2]
    rz = Q[2, 0] * b[0] + Q[2, 1] * b[1] + Q[2, 2] * b[2]
    ex, ey, drop = A[0] - x[0] - rx, A[1] - x[1] - ry, A[2] - x[2] - rz
    table[D, j] = drop
    table[X2, j] = ex**2 + ey**2
    table[CHORD, j] = np.sqrt(table[X2, j] + drop**2)
    table[LEVER, j] = abs(rx) + abs(ry) + abs(rz)
    table[LEVEL, j] = ex
    table[LEVEL + 1, j] = ey
    table[LEVEL + 2, j] = 0.0
    table[LEVEL + 3, j] = -rz * ey
    table[LEVEL + 4, j] = rz * ex
    table[LEVEL + 5, j] = rx * ey - ry * ex
    table[LIFT, j] = 0.0
    table[LIFT + 1, j] = 0.0
    table[LIFT + 2, j] = 1.0
    table[LIFT + 3, j] = ry
    table[LIFT + 4, j] = -rx
    table[LIFT + 5, j] = 0.0


@element
def load_of(situation: Situation, at: int) -> tuple[float, float, float, float, float, float]:
    """Return force and moment that the cables have to pull with in a pose."""
    Q = situation.rotations[at if situation.rotations.shape[0] > 1 else 0]
    f = situation.load[at if situation.load.shape[0] > 1 else 0]
    s, F = situation.load_point, situation.load_there
    sx = Q[0, 0] * s[0] + Q[0, 1] * s[1] + Q[0, 2] * s[2]
    sy = Q[1, 0] * s[0] + Q[1, 1] * s[1] + Q[1, 2] * s[2]
    sz = Q[2, 0] * s[0] + Q[2, 1] * s[1] + Q[2, 2] * s[2]
    mx, my, mz = sy * F[2] - sz * F[1], sz * F[0] - sx * F[2], sx * F[1] - sy * F[0]
    return f[0], f[1], f[2], f[3] + mx, f[4] + my, f[5] + mz


@element
def straighten(table: FloatArray, j: int, carried: float) -> None:
    """Make a cable straight, with this share of its weight at the platform (0 or 1/2)."""
    chord, drop = table[CHORD, j], table[D, j]
    table[P, j] = 0.0
    table[L, j] = chord
    table[V, j] = -carried * chord
    table[V_P, j] = drop
    table[T, j] = carried * abs(drop)
    table[T_P, j] = chord
    table[L_0, j] = 0.0
    table[L_P, j] = 0.0


@element
def condense(table: FloatArray, j: int) -> None:
    """Condense a cable's length: pull and top tension as linear functions of the step in p."""
    l_0, l_p, v, v_p, t, t_p, _ = condensed(
        table[P, j], table[L, j], table[X2, j], table[D, j], table[KAPPA, j]
    )
    table[L_0, j], table[L_P, j] = l_0, l_p
    table[V, j], table[V_P, j] = v, v_p
    table[T, j], table[T_P, j] = t, t_p


@element
def condensed(
    p: float, length: float, X2: float, D: float, kappa: float
) -> tuple[float, float, float, float, float, float, float]:
    """Return the change of length that closes a cable, upward pull and top tension after it.

    Each with its slope in the pull along the closure; and the upward pull before the change.
    """
    F, F_p, F_l, v, v_p, v_l, t, t_p, t_l = unit_cable(p, length, X2, D, kappa)
    l_0, l_p = -F / F_l, -F_p / F_l
    return l_0, l_p, v + v_l * l_0, v_p + v_l * l_p, t + t_l * l_0, t_p + t_l * l_p, v
