"""Lengths and tensions of taut cables nearest to balance, whatever their number.

In a pose, let the columns of A be the wrenches of unit pulls along the straight cables and f the
wrench that they have to hold. The tensions are the regularised least squares

    (AᵀA + ε tr(AᵀA)/n) T = Aᵀ f,

raised to the least tension where they fall below it. Then each cable alone is solved for its
unstrained length at the pull p = T / (w chord), by the closure of `unit_cable`, which falls as the
length grows: Newton, kept inside a bracket.
"""

from __future__ import annotations

import math

import numpy as np

from designer.arrays import FloatArray
from designer.kernel.calling import CableFigures, Situation
from designer.kernel.compiling import inner, kernel
from designer.kernel.lanes import POSE_ROWS, assemble, lanes_of, normal_equations, place, put_cables
from designer.kernel.linear import solve_lanes
from designer.kernel.table import CHORD, KAPPA, LANE_ROWS, LANES, SHARE, X2, D, L, P
from designer.kernel.unit_cable import PULL_FLOOR, sag_series, unit_cable

LENGTH, EXIT_TENSION, DISTANCE = range(3)
"""Last axis of the results."""

# Rows of a cable beside those of the table: bracket of the length.
_LOW, _HIGH = range(LANE_ROWS, LANE_ROWS + 2)

_MOST_TURNS = 60
_SMALL_STEP = 1e-8
"""Relative step after which Newton, which converges quadratically, is at rounding."""


@kernel
def solve_taut_poses(
    situation: Situation, figures: CableFigures, regular: float, out: FloatArray
) -> None:
    """Solve all poses.

    Parameters
    ----------
    figures : CableFigures
        With weights per length [N/m].
    regular : float
        ε.
    out : array (n_poses, n_cables, 3)
        Filled with unstrained length [m], tension at the exit point [N], horizontal distance [m];
        length and tension are NaN for a pull below `PULL_FLOOR`, which is no taut cable at all.
    """
    count, n, m = situation.positions.shape[0], situation.attachments.shape[0], situation.rows.size
    cables = np.empty((n, LANE_ROWS + 2, LANES))
    A = np.empty((m, n + 2, LANES))
    normal = np.empty((n + 1, n + 1, LANES))
    poses = np.empty((POSE_ROWS, LANES))
    every = np.arange(count)
    for first in range(0, count, LANES):
        lane = lanes_of(every, first)
        place(cables, poses, situation, lane)
        put_cables(cables, figures, lane)
        assemble(A, cables, poses, situation.rows)
        for r in range(m):
            for i in range(n):
                for j in range(LANES):
                    A[r, i, j] /= cables[i, SHARE, j] * cables[i, CHORD, j]
        normal_equations(normal, A, m, n + 1)
        for j in range(LANES):
            trace = 0.0
            for i in range(n):
                trace += normal[i, i, j]
            for i in range(n):
                normal[i, i, j] += regular * trace / n
        solve_lanes(normal, n, n + 1)
        for i in range(n):
            row = cables[i]
            for j in range(LANES):
                p = max(normal[i, n, j], figures.least_tension) / row[CHORD, j] / row[SHARE, j]
                row[P, j] = p if p >= PULL_FLOOR else math.nan  # NaN stays NaN
            _close(row)
            for j in range(min(LANES, count - first)):
                p, length, X = row[P, j], row[L, j], math.sqrt(row[X2, j])
                v = unit_cable(p, length, row[X2, j], row[D, j], row[KAPPA, j])[3]
                pull = math.sqrt((p * X) ** 2 + (v + length) ** 2)
                out[first + j, i, LENGTH] = length
                out[first + j, i, EXIT_TENSION] = row[SHARE, j] * pull
                out[first + j, i, DISTANCE] = X


@inner
def _close(row: FloatArray) -> None:
    """Solve a cable for its length at the given pulls.

    A step of Newton, or half of the bracket where that would leave it.
    """
    for j in range(LANES):
        p = row[P, j]
        theta2 = 0.25 / (p * p)
        stiff = math.sqrt(row[D, j] ** 2 + row[X2, j] * (1.0 + theta2 * sag_series(theta2)))
        row[L, j] = stiff / (1.0 + row[KAPPA, j] * p * stiff)
        row[_LOW, j] = 0.0
        row[_HIGH, j] = 1.0 / (row[KAPPA, j] * p)
    for _ in range(_MOST_TURNS):
        rests = True
        for j in range(LANES):
            length = row[L, j]
            F, _F_p, F_l, _v, _v_p, _v_l, _t, _t_p, _t_l = unit_cable(
                row[P, j], length, row[X2, j], row[D, j], row[KAPPA, j]
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
            rests = rests and not step > _SMALL_STEP  # a lane of NaN rests as well
        if rests:
            break
