"""The best internal forces of one pose by a primal-dual interior point, for any sag.

Unknowns are the scaled pulls y of all cables and s; each cable's length follows from its closure.

    minimise -s   subject to   Σ Wᵢ(yᵢ) = (c_0 + s c_s) b
                               Tᵢ(yᵢ)/strengthᵢ + ζᵢ = f_0 + s f_s,      ζ > 0, multiplier μ
                               yᵢ - lowᵢ - leastᵢ (c_0 + s c_s) = ηᵢ,     η > 0, multiplier ν

The last line is the least tension of a cable along its tangent, over the slope; or without c, where
it is more, the least pull that keeps its sag.

As cables do not act on each other, the Hessian of the Lagrangian is diagonal; its second slopes are
differences of first ones along the closure. Where it is not convex it is cut at zero. A Newton step
then costs one m × m factorisation. Nocedal and Wright, Numerical Optimization (2006), chapter 19.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from designer.arrays import FloatArray
from designer.kernel.compiling import allocating, inner
from designer.kernel.linear import solve_small
from designer.kernel.pose import (
    COUPLING,
    D_HEIGHT,
    D_MU_HEIGHT,
    D_MU_ROOM,
    D_ROOM,
    FORCE,
    FREEDOM,
    HEIGHT,
    LOWEST_P,
    LOWEST_PP,
    MU_HEIGHT,
    MU_ROOM,
    RHS,
    ROOM,
    STEP,
    T_PP,
    UNIT,
    V_PP,
    WRENCH,
    Ask,
    Pose,
    along,
    bend,
    choose_bounds,
    make_straight,
    smallest_pull,
    write_wrenches,
)
from designer.kernel.table import CHORD, LIFT, SHARE, STRAIGHT, STRENGTH, T_P, V_P, P, T, V

START_OF_STRAIGHT = 0.8
"""Of what straight cables reach, to begin with: sag takes its part."""
MOST_ITERATIONS = 80
PATIENCE = 25
"""Steps with an inverse weight below zero in a row after which a start is given up, of a pose that
nothing has held yet. Random poses that were held by some start, 14, were so by one that needed
fewer."""
_START_PULL = 0.5
_CARRIED = 0.5
# Room above the smallest pull and first barrier: well inside, as far as scaled quantities go.
_START_SHARE = 0.05
_START_BARRIER = 0.05
_LEAST_BARRIER = 1e-11
# A pull grows to ten times itself at most in a step, for its cable is far from linear.
_LARGEST_RISE = 9.0
_TO_BOUNDARY = 0.995
_BALANCED = 1e-12
_OPTIMAL = 1e-8
_FLAT = 1e-9
"""Least curvature: a cable without any would take a step of any length."""


class Scratch(NamedTuple):
    """Arrays for intermediate results.

    Parameters
    ----------
    columns : array (n, m)
        Slopes of the balance in the scaled pulls, one row a cable.
    schur : array (m + 1, m + 2)
        A Newton step in the multipliers and s, with its right-hand side.
    step : array (m + 1,)
        Its solution.
    rest, dual : array (m,)
        What is left of the balance, and its multipliers.
    square : array (m, m + 1)
        A system for `value`, with its right-hand side.
    value : array (m,)
        By how much s rises with each component of the scaled wrench.
    """

    columns: FloatArray
    schur: FloatArray
    step: FloatArray
    rest: FloatArray
    dual: FloatArray
    square: FloatArray
    value: FloatArray


@allocating
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


@inner
def pull_straight(pose: Pose, ask: Ask, s: float) -> None:
    """Pull as much as straight cables have to, and every cable well above its smallest pull."""
    c = pose.cables
    scaled_c = max(ask.c_0 + s * ask.c_s, 0.0)
    make_straight(pose, _CARRIED)
    choose_bounds(pose, scaled_c)
    for i in range(c.shape[1]):
        low, low_c = smallest_pull(pose, i)
        least = low + low_c * scaled_c
        y = START_OF_STRAIGHT * c[STRAIGHT, i] / (c[SHARE, i] * c[STRENGTH, i])
        # Negated, so that NaN of straight cables that hold nothing is left out.
        if not y > least + _START_SHARE:
            y = least + _START_SHARE
        c[P, i] = max(y, _START_PULL / c[UNIT, i]) * c[UNIT, i]


@inner
def climb(
    pose: Pose, ask: Ask, s: float, keep: float, patience: int, scratch: Scratch
) -> tuple[float, float]:
    """Start from the pulls in `pose` and a guess of s; return s and how far it is from optimal.

    No pull falls below `keep` times what it was in a step. It gives up when an inverse weight that
    is sought has been below zero for more steps than the `patience`.
    """
    c, n = pose.cables, pose.cables.shape[1]
    bend(pose)
    choose_bounds(pose, ask.c_0 + s * ask.c_s)
    for i in range(n):  # a start of all slacks and multipliers
        c[HEIGHT, i] = max(_height(pose, ask, s, i), _START_SHARE)
        c[ROOM, i] = max(ask.f_0 + s * ask.f_s - c[T, i] / c[STRENGTH, i], _START_SHARE)
        c[MU_ROOM, i] = _START_BARRIER / c[ROOM, i]
        c[MU_HEIGHT, i] = _START_BARRIER / c[HEIGHT, i]
    scratch.dual[:] = 0.0
    gap, below = np.inf, 0
    for iteration in range(MOST_ITERATIONS):
        if iteration > 0:
            bend(pose)
            choose_bounds(pose, ask.c_0 + s * ask.c_s)
        unbalanced = _balance(pose, ask, s, scratch)
        gap = _gap(pose, ask, s, scratch)
        below = below + 1 if s < 0.0 and ask.c_s > 0.0 else 0
        # No step without closing the cables again.
        is_last = iteration == MOST_ITERATIONS - 1 or below > patience
        if is_last or (gap < _OPTIMAL and unbalanced < _BALANCED):
            break
        mean = 0.0
        for i in range(n):
            mean += c[ROOM, i] * c[MU_ROOM, i] + c[HEIGHT, i] * c[MU_HEIGHT, i]
        mean /= 2 * n
        # A fifth of the mean gap, in the end much less.
        barrier = max(min(0.2 * mean, mean**1.5), _LEAST_BARRIER)
        s = _newton(pose, ask, s, barrier, keep, scratch)
        if not np.isfinite(s):
            break
    return s, gap


@inner
def _balance(pose: Pose, ask: Ask, s: float, scratch: Scratch) -> float:
    """Fill what is left of the balance and its slopes; return the largest entry."""
    c = pose.cables
    rest, columns = scratch.rest, scratch.columns
    write_wrenches(pose)
    worst = 0.0
    for k in range(rest.size):
        row = pose.rows[k]
        rest[k] = -(ask.c_0 + s * ask.c_s) * pose.load[row]
        for i in range(c.shape[1]):
            columns[i, k] = c[WRENCH + row, i]
            # Linear in the pull but for the vertical force.
            up = c[SHARE, i] * (c[V, i] - c[V_P, i] * c[P, i]) / pose.scale[FORCE]
            rest[k] += columns[i, k] * c[P, i] / c[UNIT, i] + up * c[LIFT + row, i]
        worst = max(worst, abs(rest[k]))
    return worst


@inner
def _height(pose: Pose, ask: Ask, s: float, i: int) -> float:
    """Return by how much the scaled pull of a cable is above its smallest."""
    c = pose.cables
    scaled_c = ask.c_0 + s * ask.c_s
    low, low_c = smallest_pull(pose, i)
    return float(c[P, i] / c[UNIT, i] - low - low_c * scaled_c)


@inner
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
        _, low_c = smallest_pull(pose, i)
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


@inner
def _newton(pose: Pose, ask: Ask, s: float, barrier: float, keep: float, scratch: Scratch) -> float:
    """Take one Newton step in everything; return the new s."""
    c, columns, dual, step = pose.cables, scratch.columns, scratch.dual, scratch.step
    n, m = columns.shape
    _condense(pose, ask, s, barrier, scratch)
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
    for i in range(n):
        c[P, i] += forward * c[STEP, i] * c[UNIT, i]
        c[ROOM, i] += forward * c[D_ROOM, i]
        c[HEIGHT, i] += forward * c[D_HEIGHT, i]
        c[MU_ROOM, i] += back * c[D_MU_ROOM, i]
        c[MU_HEIGHT, i] += back * c[D_MU_HEIGHT, i]
    return s + forward * ds


@inner
def _condense(pose: Pose, ask: Ask, s: float, barrier: float, scratch: Scratch) -> None:
    """Write the system for the multipliers of the balance and s, all else eliminated.

    First the slacks and multipliers of the bounds; each cable's row becomes: step / `FREEDOM` +
    columns · d(dual) + `COUPLING` ds = `RHS`. Then the cables. Solved as a whole: at an optimum
    between the limits the part of the multipliers is singular.
    """
    c, columns, S = pose.cables, scratch.columns, scratch.schur
    n, m = columns.shape
    weight, rest = 0.0, 1.0
    for i in range(n):
        slope = c[T_P, i] / c[CHORD, i]
        _, low_c = smallest_pull(pose, i)
        H = _curvature(pose, i, scratch.dual, low_c > 0.0)
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
    for k in range(m):
        load = ask.c_s * pose.load[pose.rows[k]]
        rest += load * scratch.dual[k]
        S[k, m + 1] = scratch.rest[k]
        S[k, m] = load
        for i in range(n):
            S[k, m + 1] += columns[i, k] * c[FREEDOM, i] * c[RHS, i]
            S[k, m] += columns[i, k] * c[FREEDOM, i] * c[COUPLING, i]
        for j in range(k + 1):
            total = 0.0
            for i in range(n):
                total += columns[i, k] * c[FREEDOM, i] * columns[i, j]
            S[k, j] = S[j, k] = total
        S[m, k] = -S[k, m]
    S[m, m] = weight
    S[m, m + 1] = rest


@inner
def _curvature(pose: Pose, i: int, dual: FloatArray, has_least: bool) -> float:
    """Return the second slope of the Lagrangian in a scaled pull, where it is convex.

    ``has_least`` is whether the least tension, not the sag, sets the smallest pull.
    """
    c = pose.cables
    of_lift = c[SHARE, i] / pose.scale[FORCE] * c[V_PP, i] * along(pose, dual, LIFT, i)
    of_tension = c[MU_ROOM, i] * c[T_PP, i] / c[STRENGTH, i]
    of_least = 0.0
    if has_least:
        of_least = c[MU_HEIGHT, i] / c[UNIT, i] * c[LOWEST_PP, i] / c[LOWEST_P, i]
    return float(max(c[UNIT, i] * c[UNIT, i] * (of_lift + of_tension - of_least), _FLAT))


@inner
def _step_sizes(
    pose: Pose, ask: Ask, s: float, ds: float, barrier: float, keep: float
) -> tuple[float, float]:
    """Fill the steps of slacks and multipliers; return how far to go to keep all above zero."""
    c = pose.cables
    forward, back = 1.0, 1.0
    for i in range(c.shape[1]):
        _, low_c = smallest_pull(pose, i)
        miss = ask.f_0 + s * ask.f_s - c[T, i] / c[STRENGTH, i] - c[ROOM, i]
        room = miss + ask.f_s * ds - c[T_P, i] / c[CHORD, i] * c[STEP, i]
        sunk = _height(pose, ask, s, i) - c[HEIGHT, i]
        height = sunk + c[STEP, i] - low_c * ask.c_s * ds
        mu_room = (barrier - c[MU_ROOM, i] * room) / c[ROOM, i] - c[MU_ROOM, i]
        mu_height = (barrier - c[MU_HEIGHT, i] * height) / c[HEIGHT, i] - c[MU_HEIGHT, i]
        c[D_ROOM, i], c[D_HEIGHT, i] = room, height
        c[D_MU_ROOM, i], c[D_MU_HEIGHT, i] = mu_room, mu_height
        y, step = c[P, i] / c[UNIT, i], c[STEP, i]
        if room < 0.0:
            forward = min(forward, -_TO_BOUNDARY * c[ROOM, i] / room)
        if height < 0.0:
            forward = min(forward, -_TO_BOUNDARY * c[HEIGHT, i] / height)
        if step > _LARGEST_RISE * y:
            forward = min(forward, _LARGEST_RISE * y / step)
        if step < (keep - 1.0) * y:
            forward = min(forward, (keep - 1.0) * y / step)
        if mu_room < 0.0:
            back = min(back, -_TO_BOUNDARY * c[MU_ROOM, i] / mu_room)
        if mu_height < 0.0:
            back = min(back, -_TO_BOUNDARY * c[MU_HEIGHT, i] / mu_height)
    return forward, back
