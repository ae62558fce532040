"""Which solved poses may have a better branch: what another pull of single cables could gain.

The balance couples the cables only through its multipliers y, a wrench. With them, no choice of
pulls p gives c (or saves load factor) beyond what each cable can add on its own to

    Σᵢ gᵢ(pᵢ) - c y · load,    gᵢ(p) = y · Wᵢ(p) = α p + β v(p)

(weak duality: whatever y). Where a force up at its attachment does no harm (β ≥ 0), the pull of a
solved pose is nearly the best there is, v being all but concave in the pull. Where β < 0 the cable
might rather hang as a counterweight, or be pulled: what it could gain is the potential.

It is an estimate that tells which poses deserve a search, and **no proof**: of 1112 random poses of
random robots 63 were bettered by the search where it said so, 5 more where it did not.
"""

from __future__ import annotations

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.kernel.answer import FORCE_X, LENGTH, LOAD_FACTOR, SOLVED, WEIGHT, Answers
from designer.kernel.calling import CableFigures, Situation
from designer.kernel.compiling import element, inner, kernel
from designer.kernel.interior import Scratch, new_scratch
from designer.kernel.linear import solve_small
from designer.kernel.pose import (
    FLOOR,
    FORCE,
    LEAST,
    LOWEST,
    SIZE,
    UNIT,
    WRENCH,
    Pose,
    along,
    choose_bounds,
    limit_sag,
    linearise,
    new_pose,
    place,
    smallest_pull,
    write_wrenches,
)
from designer.kernel.table import CHORD, LIFT, SHARE, STRENGTH, T_P, V_P, X2, D, L, P, T, V

_AT_LIMIT = 1e-6
"""Relative distance from a limit at which a cable counts as at it."""
_NEARLY_SINGULAR = 1e-13
"""Beside squares of unit wrenches; without, the system is singular, as it is meant to be nearly."""
_HANGING = 0.2
"""Pull of a cable that hangs, about two and a half times as long as its horizontal distance; then
C and S of `designer.kernel.unit_cable`, for a rigid cable."""
_HANGING_C = 2.5 / np.tanh(2.5)
_HANGING_S = (np.sinh(2.5) / 2.5) ** 2


@kernel
def rate_range(
    start: int,
    stop: int,
    situation: Situation,
    figures: CableFigures,
    is_sizing: bool,
    answers: Answers,
    out: FloatArray,
) -> None:
    """Fill the potential (n_poses,) of the solved poses `start` to `stop`, of cables of weight w.

    Relative to the inverse weight when sizing, else to the load factor; infinite where the
    multipliers are not to be had.
    """
    m, n = situation.rows.size, situation.attachments.shape[0]
    pose = new_pose(situation, figures)
    scratch = new_scratch(m, n)
    for at in range(start, stop):
        out[at] = 0.0
        if answers.verdict[at] != SOLVED:
            continue
        place(pose, situation, figures, at)
        limit_sag(pose)
        c, w = pose.cables, answers.poses[at, WEIGHT]
        for i in range(n):
            c[L, i] = answers.cables[at, i, LENGTH]
            c[P, i] = answers.cables[at, i, FORCE_X] / (w * np.sqrt(c[X2, i]))
        scaled_c = pose.scale[SIZE] / (w * pose.scale[FORCE])
        limit = 1.0 if is_sizing else answers.poses[at, LOAD_FACTOR]
        linearise(pose)
        choose_bounds(pose, scaled_c)
        write_wrenches(pose)
        out[at] = np.inf
        if _find_value(pose, scaled_c, limit, scratch):
            out[at] = _potential(pose, scaled_c, limit, is_sizing, scratch.value)


@inner
def _find_value(pose: Pose, scaled_c: float, limit: float, scratch: Scratch) -> bool:
    """Fill the multipliers of the balance: the wrench that no cable off its limits can add to.

    By one inverse iteration, from the cables at their limit, which add to it.
    """
    c, rows, system, value = pose.cables, pose.rows, scratch.square, scratch.value
    m, n = rows.size, c.shape[1]
    system[:] = 0.0
    for k in range(m):
        system[k, k] = _NEARLY_SINGULAR
    for i in range(n):
        if _is_full(c, i, limit):
            for k in range(m):
                system[k, m] += c[WRENCH + rows[k], i]
        elif not _is_least(pose, i, scaled_c):
            _add_square(system, c, rows, i)
    if not solve_small(system, value):
        return False
    size = 0.0
    for k in range(m):
        size = max(size, abs(value[k]))
    if not 0.0 < size < np.inf:
        return False
    of_full = 0.0
    for i in range(n):
        if _is_full(c, i, limit):
            of_full += along(pose, value, WRENCH, i)
    for k in range(m):  # cables at their limit are to add to it
        value[k] /= -size if of_full < 0.0 else size
    return of_full != 0.0


@inner
def _add_square(system: FloatArray, c: FloatArray, rows: IntArray, i: int) -> None:
    """Add the product of a cable's unit wrench with itself."""
    size = 0.0
    for row in rows:
        size += c[WRENCH + row, i] ** 2
    for k in range(rows.size):
        for q in range(rows.size):
            system[k, q] += c[WRENCH + rows[k], i] * c[WRENCH + rows[q], i] / size


@element
def _is_full(c: FloatArray, i: int, limit: float) -> bool:
    return bool(c[T, i] >= limit * c[STRENGTH, i] * (1.0 - _AT_LIMIT))


@element
def _is_least(pose: Pose, i: int, scaled_c: float) -> bool:
    c, scale = pose.cables, pose.scale
    least = scaled_c * scale[FORCE] / scale[SIZE] * c[LEAST, i]
    is_lowest = least > 0.0 and c[LOWEST, i] <= least * (1.0 + _AT_LIMIT)
    return bool(is_lowest or c[P, i] <= c[FLOOR, i] * (1.0 + _AT_LIMIT))


@inner
def _potential(
    pose: Pose, scaled_c: float, limit: float, is_sizing: bool, value: FloatArray
) -> float:
    """Add up what single cables could gain: from tangents where β ≥ 0, else at two pulls."""
    c = pose.cables
    gain, worth = 0.0, 0.0
    for k in range(value.size):
        worth += scaled_c * value[k] * pose.load[pose.rows[k]] if is_sizing else 0.0
    for i in range(c.shape[1]):
        is_full = _is_full(c, i, limit)
        slope = along(pose, value, WRENCH, i) / c[UNIT, i]
        if not is_sizing and is_full:
            worth += slope * limit * c[STRENGTH, i] / c[T_P, i]
        beta = along(pose, value, LIFT, i) * c[SHARE, i] / pose.scale[FORCE]
        alpha = slope - beta * c[V_P, i]
        tight = limit * c[STRENGTH, i] / c[CHORD, i]
        low, low_c = smallest_pull(pose, i)
        least = (low + low_c * scaled_c) * c[UNIT, i]
        if beta < 0.0:
            best = 0.0
            if not is_full:  # pulled tight, when the lift nears p D - L/2
                sag = 0.5 * c[CHORD, i] + c[X2, i] / (48.0 * c[CHORD, i] * tight * tight)
                moved = alpha * (tight - c[P, i]) + beta * (tight * c[D, i] - sag - c[V, i])
                best = max(best, moved)
            if least <= _HANGING and c[P, i] > _HANGING:
                length = np.sqrt(c[D, i] * c[D, i] + c[X2, i] * _HANGING_S)
                lift_there = _HANGING * _HANGING_C * c[D, i] - 0.5 * length
                moved = alpha * (_HANGING - c[P, i]) + beta * (lift_there - c[V, i])
                best = max(best, moved)
            gain += best
        elif slope > 0.0 and not (is_full and c[T_P, i] > 0.0):
            gain += slope * max(tight - c[P, i], 0.0)
        elif slope < 0.0 and not _is_least(pose, i, scaled_c):
            gain -= slope * (c[P, i] - least)
    if not (worth > 0.0 and gain >= 0.0):
        return np.inf
    return gain / worth
