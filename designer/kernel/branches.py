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
from designer.kernel.compiling import kernel
from designer.kernel.layout import FORCE_X, LENGTH, LOAD_FACTOR, WEIGHT
from designer.kernel.linear import solve_small
from designer.kernel.redundant_layout import (
    CHORD,
    FORCE,
    KAPPA,
    LEAST,
    LOWEST,
    SHARE,
    SIZE,
    STRENGTH,
    T_P,
    UNIT,
    V_P,
    WRENCH,
    X2,
    D,
    L,
    P,
    Pose,
    T,
    V,
)  # fmt: skip
from designer.kernel.redundant_pose import (
    lift,
    linearise,
    new_pose,
    place,
    settled_length,
    smallest_pull,
    write_wrenches,
)
from designer.kernel.unit_cable import PULL_FLOOR, unit_cable
from designer.model.verdict import Verdict

_SOLVED = int(Verdict.SOLVED)
_AT_LIMIT = 1e-6
_NEARLY_SINGULAR = 1e-13
_HANGING = 0.2
"""Pull of a cable that hangs, about two and a half times as long as its horizontal distance; then
C and S of `designer.kernel.unit_cable`, for a rigid cable."""
_HANGING_C = 2.5 / np.tanh(2.5)
_HANGING_S = (np.sinh(2.5) / 2.5) ** 2


@kernel
def rate_range(
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
    is_sizing: bool,
    rows: IntArray,
    least_tension: float,
    cables: FloatArray,
    poses: FloatArray,
    verdict: IntArray,
    out: FloatArray,
) -> None:
    """Fill the potential of the solved poses `start` to `stop`.

    Relative to the inverse weight when sizing, else to the load factor; infinite where the
    multipliers are not to be had.

    Parameters
    ----------
    cables, poses, verdict
        What was found, in the layout of `designer.kernel.layout`, forces of cables of weight w.
    out : array (n_poses,)
        Receives the potential.
    """
    m, n = rows.size, kappa.size
    pose = new_pose(kappa, weights, strength, rows, least_tension)
    system, value, before = np.zeros((m, m + 1)), np.zeros(m), np.zeros(m)
    for at in range(start, stop):
        out[at] = 0.0
        if verdict[at] != _SOLVED:
            continue
        place(
            pose,
            exit_points[at if exit_points.shape[0] > 1 else 0],
            attachments,
            rotations[at if rotations.shape[0] > 1 else 0],
            positions[at],
            load[at if load.shape[0] > 1 else 0],
            load_point,
            weight,
        )
        c = pose.cables
        w = poses[at, WEIGHT]
        for i in range(n):
            c[L, i] = cables[at, i, LENGTH]
            c[P, i] = cables[at, i, FORCE_X] / (w * np.sqrt(c[X2, i]))
        scaled_c = pose.scale[SIZE] / (w * pose.scale[FORCE])
        limit = 1.0 if is_sizing else poses[at, LOAD_FACTOR]
        linearise(pose)
        write_wrenches(pose)
        out[at] = np.inf
        if find_value(pose, scaled_c, limit, system, value, before):
            out[at] = _potential(pose, scaled_c, limit, is_sizing, value)


@kernel
def find_value(
    pose: Pose,
    scaled_c: float,
    limit: float,
    system: FloatArray,
    value: FloatArray,
    before: FloatArray,
) -> bool:
    """Fill the multipliers of the balance: the wrench that no cable off its limits can add to.

    By one inverse iteration, from the cables at their limit, which add to it.
    """
    c, rows = pose.cables, pose.rows
    m, n = rows.size, c.shape[1]
    before[:] = 0.0
    for i in range(n):
        if _is_full(c, i, limit):
            for k in range(m):
                before[k] += c[WRENCH + rows[k], i]
    for k in range(m):
        for q in range(m):
            system[k, q] = _NEARLY_SINGULAR if k == q else 0.0
        system[k, m] = before[k]
    for i in range(n):
        if not _is_full(c, i, limit) and not _is_least(c, pose.scale, i, scaled_c):
            _add_square(system, c, rows, i)
    if not solve_small(system, value):
        return False
    size = 0.0
    for k in range(m):
        size = max(size, abs(value[k]))
    if not 0.0 < size < np.inf:
        return False
    for k in range(m):
        value[k] /= size
    return _orient(pose, limit, value)


@kernel
def _add_square(system: FloatArray, c: FloatArray, rows: IntArray, i: int) -> None:
    """Add the product of a cable's unit wrench with itself."""
    size = 0.0
    for row in rows:
        size += c[WRENCH + row, i] ** 2
    for k in range(rows.size):
        for q in range(rows.size):
            system[k, q] += c[WRENCH + rows[k], i] * c[WRENCH + rows[q], i] / size


@kernel
def _orient(pose: Pose, limit: float, value: FloatArray) -> bool:
    """Turn the wrench so that cables at their limit add to it."""
    total = 0.0
    for i in range(pose.cables.shape[1]):
        if _is_full(pose.cables, i, limit):
            total += _slope(pose, value, i)
    if total < 0.0:
        for k in range(value.size):
            value[k] = -value[k]
    return total != 0.0


@kernel
def _slope(pose: Pose, value: FloatArray, i: int) -> float:
    total = 0.0
    for k in range(value.size):
        total += value[k] * pose.cables[WRENCH + pose.rows[k], i]
    return total


@kernel
def _is_full(c: FloatArray, i: int, limit: float) -> bool:
    return bool(c[T, i] >= limit * c[STRENGTH, i] * (1.0 - _AT_LIMIT))


@kernel
def _is_least(c: FloatArray, scale: FloatArray, i: int, scaled_c: float) -> bool:
    least = scaled_c * scale[FORCE] / scale[SIZE] * c[LEAST, i]
    return bool(least > 0.0 and c[LOWEST, i] <= least * (1.0 + _AT_LIMIT))


@kernel
def upward_share(pose: Pose, value: FloatArray, i: int) -> float:
    """Return β: what a vertical pull of unit length at the attachment adds."""
    total = 0.0
    for k in range(value.size):
        total += value[k] * lift(pose, pose.rows[k], i)
    return float(total * pose.cables[SHARE, i] / pose.scale[FORCE])


@kernel
def rise(pose: Pose, i: int, p: float) -> float:
    """Return the upward pull of a cable at a pull."""
    c = pose.cables
    length = settled_length(p, c[X2, i], c[D, i], c[KAPPA, i])
    return float(unit_cable(p, length, c[X2, i], c[D, i], c[KAPPA, i])[3])


@kernel
def _potential(
    pose: Pose, scaled_c: float, limit: float, is_sizing: bool, value: FloatArray
) -> float:
    """Add up what single cables could gain: from tangents where β ≥ 0, else at two pulls."""
    c = pose.cables
    gain, worth = 0.0, 0.0
    for k in range(value.size):
        worth += scaled_c * value[k] * pose.load[pose.rows[k]] if is_sizing else 0.0
    for i in range(c.shape[1]):
        slope = _slope(pose, value, i) / c[UNIT, i]
        if not is_sizing and _is_full(c, i, limit):
            worth += slope * limit * c[STRENGTH, i] / c[T_P, i]
        beta = upward_share(pose, value, i)
        alpha = slope - beta * c[V_P, i]
        tight = limit * c[STRENGTH, i] / c[CHORD, i]
        low, low_c = smallest_pull(pose, i, PULL_FLOOR)
        least = (low + low_c * scaled_c) * c[UNIT, i]
        if beta < 0.0:
            best = 0.0
            if not _is_full(c, i, limit):  # pulled tight, when the lift nears p D - L/2
                sag = 0.5 * c[CHORD, i] + c[X2, i] / (48.0 * c[CHORD, i] * tight * tight)
                moved = alpha * (tight - c[P, i]) + beta * (tight * c[D, i] - sag - c[V, i])
                best = max(best, moved)
            if least <= _HANGING and c[P, i] > _HANGING:
                length = np.sqrt(c[D, i] * c[D, i] + c[X2, i] * _HANGING_S)
                lift_there = _HANGING * _HANGING_C * c[D, i] - 0.5 * length
                moved = alpha * (_HANGING - c[P, i]) + beta * (lift_there - c[V, i])
                best = max(best, moved)
            gain += best
        elif slope > 0.0 and not (_is_full(c, i, limit) and c[T_P, i] > 0.0):
            gain += slope * max(tight - c[P, i], 0.0)
        elif slope < 0.0 and not _is_least(c, pose.scale, i, scaled_c):
            gain -= slope * (c[P, i] - least)
    if not (worth > 0.0 and gain >= 0.0):
        return np.inf
    return gain / worth
