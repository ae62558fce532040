"""The best internal forces of one pose by a primal-dual interior point, for any sag.

Unknowns are the scaled pulls y of all cables and s; each cable's length follows from its closure.

    minimise -s   subject to   Σ Wᵢ(yᵢ) = (c_0 + s c_s) b
                               Tᵢ(yᵢ)/strengthᵢ + ζᵢ = f_0 + s f_s,      ζ > 0, multiplier μ
                               yᵢ - lowᵢ - leastᵢ (c_0 + s c_s) = ηᵢ,     η > 0, multiplier ν

The last line is the least tension of a cable along its tangent, over the slope.

As cables do not act on each other, the Hessian of the Lagrangian is diagonal; its second slopes are
differences of first ones along the closure. Where it is not convex it is cut at zero. A Newton step
then costs one m × m factorisation. Nocedal and Wright, Numerical Optimization (2006), chapter 19.
"""

from __future__ import annotations

import numpy as np

from designer.arrays import FloatArray
from designer.kernel.compiling import kernel
from designer.kernel.linear import solve_small
from designer.kernel.redundant_layout import (
    CHORD,
    COUPLING,
    FORCE,
    FREEDOM,
    HEIGHT,
    LEAST,
    LOWEST_P,
    LOWEST_PP,
    MU_HEIGHT,
    MU_ROOM,
    RHS,
    ROOM,
    SHARE,
    STEP,
    STRAIGHT,
    STRENGTH,
    T_P,
    T_PP,
    UNIT,
    V_P,
    V_PP,
    WRENCH,
    Ask,
    P,
    Pose,
    Scratch,
    T,
    V,
)  # fmt: skip
from designer.kernel.redundant_pose import (
    bend,
    lift,
    make_straight,
    smallest_pull,
    write_wrenches,
)
from designer.kernel.unit_cable import PULL_FLOOR

_MOST_ITERATIONS = 80
_START_OF_STRAIGHT = 0.8
_START_PULL = 0.5
_CARRIED = 0.5
_START_SHARE = 0.05
_START_BARRIER = 0.05
_LEAST_BARRIER = 1e-11
_LARGEST_RISE = 9.0
_TO_BOUNDARY = 0.995
_BALANCED = 1e-12
_OPTIMAL = 1e-8
_FLAT = 1e-9


@kernel
def improve(pose: Pose, ask: Ask, s: float, keep: float, scratch: Scratch) -> tuple[float, float]:
    """Start from straight cables and a guess of s; return s and how far it is from optimal."""
    pull_straight(pose, ask, s)
    return climb(pose, ask, s, keep, scratch)


@kernel
def climb(pose: Pose, ask: Ask, s: float, keep: float, scratch: Scratch) -> tuple[float, float]:
    """Start from the pulls in `pose` and a guess of s; return s and how far it is from optimal."""
    c = pose.cables
    _begin(pose, ask, s)
    scratch.dual[:] = 0.0
    gap = np.inf
    for _ in range(_MOST_ITERATIONS):
        bend(pose)
        unbalanced = _balance(pose, ask, s, scratch)
        gap = _gap(pose, ask, s, scratch)
        if gap < _OPTIMAL and unbalanced < _BALANCED:
            break
        s = _newton(pose, ask, s, _barrier(c), keep, scratch)
        if not np.isfinite(s):
            break
    return s, gap


@kernel
def new_scratch(m: int, n: int) -> Scratch:
    """Return the arrays for n cables in m equations."""
    return Scratch(
        np.zeros((n, m)),
        np.zeros((m + 1, m + 2)),
        np.zeros(m + 1),
        np.zeros(m),
        np.zeros(m),
        np.zeros((m, m + 1)),
        np.zeros(m),
    )


@kernel
def _balance(pose: Pose, ask: Ask, s: float, scratch: Scratch) -> float:
    """Fill what is left of the balance and its slopes; return the largest entry."""
    c, scale = pose.cables, pose.scale
    rest, columns = scratch.rest, scratch.columns
    write_wrenches(pose)
    worst = 0.0
    for k in range(rest.size):
        row = pose.rows[k]
        rest[k] = -(ask.c_0 + s * ask.c_s) * pose.load[row]
        for i in range(c.shape[1]):
            columns[i, k] = c[WRENCH + row, i]
            # Linear in the pull but for the vertical force.
            up = c[SHARE, i] * (c[V, i] - c[V_P, i] * c[P, i]) / scale[FORCE]
            rest[k] += columns[i, k] * c[P, i] / c[UNIT, i] + up * lift(pose, row, i)
        worst = max(worst, abs(rest[k]))
    return worst


@kernel
def pull_straight(pose: Pose, ask: Ask, s: float) -> None:
    """Pull as much as straight cables have to, and every cable well above its smallest pull."""
    c = pose.cables
    scaled_c = ask.c_0 + s * ask.c_s
    make_straight(pose, _CARRIED)
    for i in range(c.shape[1]):
        low, low_c = smallest_pull(pose, i, PULL_FLOOR)
        least = low + low_c * max(scaled_c, 0.0)
        y = _START_OF_STRAIGHT * c[STRAIGHT, i] / (c[SHARE, i] * c[STRENGTH, i])
        # Negated, so that NaN of straight cables that hold nothing is left out.
        if not y > least + _START_SHARE:
            y = least + _START_SHARE
        y = max(y, _START_PULL / c[UNIT, i])
        c[P, i] = y * c[UNIT, i]


@kernel
def _begin(pose: Pose, ask: Ask, s: float) -> None:
    """Give all slacks and multipliers a start."""
    c = pose.cables
    bend(pose)
    for i in range(c.shape[1]):
        c[HEIGHT, i] = max(_height(pose, ask, s, i), _START_SHARE)
        limit = ask.f_0 + s * ask.f_s
        c[ROOM, i] = max(limit - c[T, i] / c[STRENGTH, i], _START_SHARE)
        c[MU_ROOM, i] = _START_BARRIER / c[ROOM, i]
        c[MU_HEIGHT, i] = _START_BARRIER / c[HEIGHT, i]


@kernel
def _height(pose: Pose, ask: Ask, s: float, i: int) -> float:
    """Return by how much the scaled pull of a cable is above its smallest."""
    c = pose.cables
    low, low_c = smallest_pull(pose, i, PULL_FLOOR)
    return float(c[P, i] / c[UNIT, i] - low - low_c * (ask.c_0 + s * ask.c_s))


@kernel
def _barrier(c: FloatArray) -> float:
    """Return the next barrier parameter: a fifth of the mean gap, in the end much less."""
    mean = 0.0
    n = c.shape[1]
    for i in range(n):
        mean += c[ROOM, i] * c[MU_ROOM, i] + c[HEIGHT, i] * c[MU_HEIGHT, i]
    mean /= 2 * n
    return float(max(min(0.2 * mean, mean**1.5), _LEAST_BARRIER))


@kernel
def _gap(pose: Pose, ask: Ask, s: float, scratch: Scratch) -> float:
    """Return the largest residual of the optimality conditions, the balance left out.

    Stationarity goes into the rows `RHS` on the way.
    """
    c = pose.cables
    columns, dual = scratch.columns, scratch.dual
    n, m = columns.shape
    worst = 0.0
    in_s = -1.0
    for k in range(m):
        in_s -= ask.c_s * pose.load[pose.rows[k]] * dual[k]
    for i in range(n):
        slope = c[T_P, i] / c[CHORD, i]
        _, low_c = smallest_pull(pose, i, PULL_FLOOR)
        stationary = c[MU_ROOM, i] * slope - c[MU_HEIGHT, i]
        for k in range(m):
            stationary += columns[i, k] * dual[k]
        in_s += -ask.f_s * c[MU_ROOM, i] + ask.c_s * low_c * c[MU_HEIGHT, i]
        c[RHS, i] = stationary
        infeasible = ask.f_0 + s * ask.f_s - c[T, i] / c[STRENGTH, i] - c[ROOM, i]
        worst = max(worst, abs(stationary), abs(infeasible), c[ROOM, i] * c[MU_ROOM, i])
        worst = max(worst, c[HEIGHT, i] * c[MU_HEIGHT, i])
        worst = max(worst, abs(_height(pose, ask, s, i) - c[HEIGHT, i]))
    return max(worst, abs(in_s))


@kernel
def _newton(pose: Pose, ask: Ask, s: float, barrier: float, keep: float, scratch: Scratch) -> float:
    """Take one Newton step in everything; return the new s."""
    c, columns, dual, step = pose.cables, scratch.columns, scratch.dual, scratch.step
    n, m = columns.shape
    weight_of_s, rest_of_s = _condense(pose, ask, s, barrier, dual)
    _assemble(pose, ask, weight_of_s, rest_of_s, scratch)
    if not solve_small(scratch.schur, step):
        return np.nan
    ds = float(step[m])
    for i in range(n):
        c[STEP, i] = c[RHS, i] - c[COUPLING, i] * ds
        for k in range(m):
            c[STEP, i] -= columns[i, k] * step[k]
        c[STEP, i] *= c[FREEDOM, i]
    forward, back = _step_sizes(pose, ask, s, ds, barrier, keep)
    for k in range(m):
        dual[k] += back * step[k]
    _take(pose, ask, s, ds, barrier, forward, back)
    return s + forward * ds


@kernel
def _condense(
    pose: Pose, ask: Ask, s: float, barrier: float, dual: FloatArray
) -> tuple[float, float]:
    """Eliminate slacks and multipliers of the bounds; return what is left in the row of s.

    Each cable's row becomes: step / `FREEDOM` + columns · d(dual) + `COUPLING` ds = `RHS`; the row
    of s, with the cables eliminated as well: weight · ds - (load + …) · d(dual) = rest.
    """
    c, rows, load = pose.cables, pose.rows, pose.load
    weight, rest = 0.0, 1.0
    for k in range(dual.size):
        rest += ask.c_s * load[rows[k]] * dual[k]
    for i in range(c.shape[1]):
        H = _curvature(pose, i, dual)
        slope = c[T_P, i] / c[CHORD, i]
        _, low_c = smallest_pull(pose, i, PULL_FLOOR)
        low_s = low_c * ask.c_s
        d_room = c[MU_ROOM, i] / c[ROOM, i]
        d_height = c[MU_HEIGHT, i] / c[HEIGHT, i]
        miss = ask.f_0 + s * ask.f_s - c[T, i] / c[STRENGTH, i] - c[ROOM, i]
        push_room = barrier / c[ROOM, i] - c[MU_ROOM, i] - d_room * miss
        sunk = _height(pose, ask, s, i) - c[HEIGHT, i]
        push_height = barrier / c[HEIGHT, i] - c[MU_HEIGHT, i] - d_height * sunk
        c[FREEDOM, i] = 1.0 / (H + d_room * slope * slope + d_height)
        c[RHS, i] = -c[RHS, i] - slope * push_room + push_height
        c[COUPLING, i] = -ask.f_s * d_room * slope - low_s * d_height
        # s couples in one of the two ways at most; written so that nothing cancels.
        weight += ask.f_s**2 * d_room * (H + d_height) * c[FREEDOM, i]
        weight += low_s**2 * d_height * (H + d_room * slope * slope) * c[FREEDOM, i]
        rest += ask.f_s * (c[MU_ROOM, i] + push_room) - low_s * (c[MU_HEIGHT, i] + push_height)
        rest -= c[COUPLING, i] * c[RHS, i] * c[FREEDOM, i]
    return weight, rest


@kernel
def _curvature(pose: Pose, i: int, dual: FloatArray) -> float:
    """Return the second slope of the Lagrangian in a scaled pull, where it is convex."""
    c = pose.cables
    arm = 0.0
    for k in range(dual.size):
        arm += dual[k] * lift(pose, pose.rows[k], i)
    of_lift = c[SHARE, i] / pose.scale[FORCE] * c[V_PP, i] * arm
    of_tension = c[MU_ROOM, i] * c[T_PP, i] / c[STRENGTH, i]
    of_least = 0.0
    if c[LEAST, i] > 0.0:
        of_least = c[MU_HEIGHT, i] / c[UNIT, i] * c[LOWEST_PP, i] / c[LOWEST_P, i]
    return float(max(c[UNIT, i] * c[UNIT, i] * (of_lift + of_tension - of_least), _FLAT))


@kernel
def _assemble(pose: Pose, ask: Ask, weight_of_s: float, rest_of_s: float, scratch: Scratch) -> None:
    """Write the system for the multipliers of the balance and s, the cables eliminated.

    Solved as a whole: at an optimum between the limits the part of the multipliers is singular.
    """
    c, columns, S = pose.cables, scratch.columns, scratch.schur
    n, m = columns.shape
    for k in range(m):
        S[k, m + 1] = scratch.rest[k]
        S[k, m] = ask.c_s * pose.load[pose.rows[k]]
        for i in range(n):
            S[k, m + 1] += columns[i, k] * c[FREEDOM, i] * c[RHS, i]
            S[k, m] += columns[i, k] * c[FREEDOM, i] * c[COUPLING, i]
        for j in range(k + 1):
            total = 0.0
            for i in range(n):
                total += columns[i, k] * c[FREEDOM, i] * columns[i, j]
            S[k, j] = total
            S[j, k] = total
        S[m, k] = -S[k, m]
    S[m, m] = weight_of_s
    S[m, m + 1] = rest_of_s


@kernel
def _changes(
    pose: Pose, ask: Ask, s: float, ds: float, barrier: float, i: int
) -> tuple[float, float, float, float]:
    """Return the steps of both slacks and both multipliers of a cable."""
    c = pose.cables
    _, low_c = smallest_pull(pose, i, PULL_FLOOR)
    miss = ask.f_0 + s * ask.f_s - c[T, i] / c[STRENGTH, i] - c[ROOM, i]
    room = miss + ask.f_s * ds - c[T_P, i] / c[CHORD, i] * c[STEP, i]
    sunk = _height(pose, ask, s, i) - c[HEIGHT, i]
    height = sunk + c[STEP, i] - low_c * ask.c_s * ds
    mu_room = (barrier - c[MU_ROOM, i] * room) / c[ROOM, i] - c[MU_ROOM, i]
    mu_height = (barrier - c[MU_HEIGHT, i] * height) / c[HEIGHT, i] - c[MU_HEIGHT, i]
    return room, height, mu_room, mu_height


@kernel
def _step_sizes(
    pose: Pose, ask: Ask, s: float, ds: float, barrier: float, keep: float
) -> tuple[float, float]:
    """Return how far to go so that slacks and multipliers stay above zero.

    No pull falls below `keep` times what it was, for a slack cable is far from linear.
    """
    c = pose.cables
    fall = 1.0 - keep
    forward, back = 1.0, 1.0
    for i in range(c.shape[1]):
        room, height, mu_room, mu_height = _changes(pose, ask, s, ds, barrier, i)
        y = c[P, i] / c[UNIT, i]
        if room < 0.0:
            forward = min(forward, -_TO_BOUNDARY * c[ROOM, i] / room)
        if height < 0.0:
            forward = min(forward, -_TO_BOUNDARY * c[HEIGHT, i] / height)
        if c[STEP, i] > _LARGEST_RISE * y:
            forward = min(forward, _LARGEST_RISE * y / c[STEP, i])
        if c[STEP, i] < -fall * y:
            forward = min(forward, -fall * y / c[STEP, i])
        if mu_room < 0.0:
            back = min(back, -_TO_BOUNDARY * c[MU_ROOM, i] / mu_room)
        if mu_height < 0.0:
            back = min(back, -_TO_BOUNDARY * c[MU_HEIGHT, i] / mu_height)
    return forward, back


@kernel
def _take(
    pose: Pose, ask: Ask, s: float, ds: float, barrier: float, forward: float, back: float
) -> None:
    c = pose.cables
    for i in range(c.shape[1]):
        room, height, mu_room, mu_height = _changes(pose, ask, s, ds, barrier, i)
        c[P, i] += forward * c[STEP, i] * c[UNIT, i]
        c[ROOM, i] += forward * room
        c[HEIGHT, i] += forward * height
        c[MU_ROOM, i] += back * mu_room
        c[MU_HEIGHT, i] += back * mu_height
