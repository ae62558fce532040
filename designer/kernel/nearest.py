"""Lengths and tensions of many poses where cables and degrees of freedom differ in number.

In a pose, let the columns of A be the wrenches of unit pulls along the straight cables and f the
wrench that they have to hold. The tensions are the regularised least squares

    (AᵀA + ε tr(AᵀA)/n) T = Aᵀ f,

raised to the least tension where they fall below it. Then each cable alone is solved for its
unstrained length at the pull p = T / (w chord), by the closure of `unit_cable`, which falls as the
length grows: Newton, kept inside a bracket.

Poses are worked on in blocks of lanes, as in `designer.kernel.square`.
"""

from __future__ import annotations

import math

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.kernel.compiling import kernel
from designer.kernel.layout import (
    EX,
    EY,
    LANES,
    LOAD,
    POSE_ROWS,
    RX,
    RY,
    RZ,
    X2,
    D,
    L,
    P,
)  # fmt: skip
from designer.kernel.linear import solve_lanes
from designer.kernel.step import place
from designer.kernel.unit_cable import PULL_FLOOR, sag_series, unit_cable

LENGTH, EXIT_TENSION, DISTANCE = range(3)
"""Last axis of the results."""

# Rows of a cable beside those of `place`: wrench of a unit pull (6), bracket of the length,
# largest relative step, tension at the exit point over weight per length.
_UNIT, _LOW, _HIGH, _STEP, _EXIT = 9, 15, 16, 17, 18
_CABLE_ROWS = 19

_MOST_TURNS = 60
_SMALL_STEP = 1e-8
"""Relative step after which Newton, which converges quadratically, is at rounding."""


@kernel
def solve_nearest_poses(
    exit_points: FloatArray,
    attachments: FloatArray,
    load: FloatArray,
    load_point: FloatArray,
    weight: float,
    positions: FloatArray,
    rotations: FloatArray,
    cable_weight: FloatArray,
    axial_stiffness: FloatArray,
    rows: IntArray,
    regular: float,
    least_tension: float,
    out: FloatArray,
) -> None:
    """Solve all poses.

    Parameters
    ----------
    exit_points, attachments, load, load_point, weight, positions, rotations
        See `designer.kernel.step.place`; SI units.
    cable_weight, axial_stiffness : array (n_cables,)
        Weight per length [N/m] and EA [N] of each cable.
    rows : array (degrees of freedom,)
        Components of the wrench that are balanced, of 0 … 5.
    regular, least_tension : float
        ε, and the least tension [N].
    out : array (n_poses, n_cables, 3)
        Filled with unstrained length [m], tension at the exit point [N], horizontal distance [m];
        length and tension are NaN for a pull below `PULL_FLOOR`, which is no taut cable at all.
    """
    count, n = positions.shape[0], attachments.shape[0]
    cables = np.empty((n, _CABLE_ROWS, LANES))
    normal = np.empty((n + 1, n + 1, LANES))
    poses = np.empty((POSE_ROWS, LANES))
    for first in range(0, count, LANES):
        lane = np.minimum(np.arange(first, first + LANES), count - 1)
        place(
            cables, poses, exit_points, attachments, load, load_point, weight, positions, rotations,
            lane,
        )  # fmt: skip
        _set_unit_wrenches(cables, n)
        _set_normal(normal, cables, poses, n, rows, regular)
        solve_lanes(normal, n, n + 1)
        for i in range(n):
            w = cable_weight[i]
            _set_pull(cables[i], normal[i, n], least_tension, w)
            _solve_length(cables[i], w / axial_stiffness[i])
            for j in range(min(LANES, count - first)):
                out[first + j, i, LENGTH] = cables[i, L, j]
                out[first + j, i, EXIT_TENSION] = w * cables[i, _EXIT, j]
                out[first + j, i, DISTANCE] = math.sqrt(cables[i, X2, j])


@kernel
def _set_unit_wrenches(cables: FloatArray, n: int) -> None:
    """Set the wrench on the platform of a unit pull along each straight cable."""
    for i in range(n):
        row = cables[i]
        for j in range(LANES):
            chord = row[L, j]
            x, y, z = row[EX, j] / chord, row[EY, j] / chord, row[D, j] / chord
            row[_UNIT, j] = x
            row[_UNIT + 1, j] = y
            row[_UNIT + 2, j] = z
            row[_UNIT + 3, j] = row[RY, j] * z - row[RZ, j] * y
            row[_UNIT + 4, j] = row[RZ, j] * x - row[RX, j] * z
            row[_UNIT + 5, j] = row[RX, j] * y - row[RY, j] * x


@kernel
def _set_normal(
    normal: FloatArray,
    cables: FloatArray,
    poses: FloatArray,
    n: int,
    rows: IntArray,
    regular: float,
) -> None:
    """Set AᵀA, its diagonal raised, and beside it Aᵀ f."""
    trace = np.zeros(LANES)
    for i in range(n):
        normal[i, : n + 1] = 0.0
        for m in rows:
            own = cables[i, _UNIT + m]
            for k in range(n):
                other = cables[k, _UNIT + m]
                for j in range(LANES):
                    normal[i, k, j] += own[j] * other[j]
            for j in range(LANES):
                normal[i, n, j] += own[j] * poses[LOAD + m, j]
        for j in range(LANES):
            trace[j] += normal[i, i, j]
    for i in range(n):
        for j in range(LANES):
            normal[i, i, j] += regular * trace[j] / n


@kernel
def _set_pull(row: FloatArray, tension: FloatArray, least_tension: float, w: float) -> None:
    """Set the pull of a cable from its tension; NaN stays NaN, and a slack cable becomes NaN."""
    for j in range(LANES):
        T = tension[j]
        p = (least_tension if least_tension > T else T) / row[L, j] / w
        row[P, j] = math.nan if p < PULL_FLOOR else p


@kernel
def _solve_length(row: FloatArray, kappa: float) -> None:
    """Solve a cable for its length at the given pull, and set its tension at the exit point."""
    for j in range(LANES):
        p = row[P, j]
        theta2 = 0.25 / (p * p)
        stiff = math.sqrt(row[D, j] ** 2 + row[X2, j] * (1.0 + theta2 * sag_series(theta2)))
        row[L, j] = stiff / (1.0 + kappa * p * stiff)
        row[_LOW, j] = 0.0
        row[_HIGH, j] = 1.0 / (kappa * p)
    for _ in range(_MOST_TURNS):
        _advance_length(row, kappa)
        if np.max(row[_STEP]) == 0.0:
            break
    for j in range(LANES):
        p, length = row[P, j], row[L, j]
        _F, _F_p, _F_l, v, _v_p, _v_l, _t, _t_p, _t_l = unit_cable(
            p, length, row[X2, j], row[D, j], kappa
        )
        row[_EXIT, j] = math.sqrt(p * p * row[X2, j] + (v + length) ** 2)


@kernel
def _advance_length(row: FloatArray, kappa: float) -> None:
    """Take one step of Newton, or halve the bracket where that would leave it."""
    for j in range(LANES):
        length = row[L, j]
        F, _F_p, F_l, _v, _v_p, _v_l, _t, _t_p, _t_l = unit_cable(
            row[P, j], length, row[X2, j], row[D, j], kappa
        )
        low = length if F > 0.0 else row[_LOW, j]
        high = row[_HIGH, j] if F > 0.0 else length
        newton = length - F / F_l
        middle = 0.5 * (low + min(high, 4.0 * length))
        new = newton if low <= newton <= high else middle
        step = abs(new - length) / length
        row[_LOW, j] = low
        row[_HIGH, j] = high
        row[L, j] = new
        row[_STEP, j] = step if step > _SMALL_STEP else 0.0  # a lane of NaN rests as well
