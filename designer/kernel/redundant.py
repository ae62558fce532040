"""Statics and sizing of many poses of a robot with more cables than degrees of freedom.

The cables can pull against each other, so that a pose leaves a choice of internal forces. What is
chosen: when sizing, the forces that allow the thinnest cable; with a given cable, those with the
smallest largest tension over strength. As in `designer.kernel.square`, cables have unit weight, the
unknowns are the pulls p, and the platform's balance is linear in the inverse weight c:

    Σᵢ ωᵢ (pᵢ eᵢ, vᵢ(pᵢ); moments) = c · load,    tᵢ(pᵢ) ≤ f · strengthᵢ,    τᵢ(pᵢ) ≥ c · leastᵢ

with top tension t and least tension τ anywhere in the cable, and with c as large, or with c given
and f as small, as can be. Straight cables make this a linear programme, and so does each Newton
step for sagging ones; where enough cables are at a limit, the steps end on a vertex and converge
quadratically. Where a cable is best left hanging between its limits, an interior point takes over.

What is called for every pose is compiled in place (`element`): to hand so many arrays to a function
takes longer than most of these functions do.
"""

from __future__ import annotations

import numpy as np

from designer.arrays import FloatArray, VerdictArray
from designer.kernel.answer import NOT_CONVERGED, OUTSIDE_HULL, RANK_DEFICIENT, SOLVED, Answers
from designer.kernel.calling import CableFigures, Situation
from designer.kernel.compiling import element, inner, kernel
from designer.kernel.interior import (
    PATIENCE,
    START_OF_STRAIGHT,
    Scratch,
    climb,
    new_scratch,
    pull_straight,
)
from designer.kernel.linear import solve_small
from designer.kernel.pose import (
    FLOOR,
    FORCE,
    HANGS,
    LEAST,
    NOTHING,
    OPTIMAL_WITHIN,
    REACH,
    SIZE,
    TOP,
    TOP_S,
    UNIT,
    UP,
    WRENCH,
    Ask,
    Pose,
    along,
    asked,
    choose_bounds,
    limit_sag,
    linearise,
    make_straight,
    new_pose,
    place,
    settled_length,
    smallest_pull,
    store,
    write_wrenches,
)
from designer.kernel.simplex import (
    AT_TOP,
    OPTIMAL,
    Programme,
    choose_basis,
    maximise,
    new_programme,
    rebuild,
)
from designer.kernel.table import (
    CHORD,
    KAPPA,
    L_0,
    L_P,
    LIFT,
    SHARE,
    STRAIGHT,
    STRENGTH,
    T_P,
    V_P,
    X2,
    D,
    L,
    P,
    T,
    V,
)
from designer.kernel.unit_cable import PULL_FLOOR, unit_cable

KEPT_PULLS = (0.5, 0.9)
"""Share of its pull that a cable keeps in a step of the interior point; then more careful."""
_MOST_STEPS = 8
_SMALL_STEP = 1e-6
_LEAST_SLOPE = 0.3
"""Of the top tension in the pull, over the chord: a cable of less is far from its strength."""
# Newton for the pull of a hanging cable: turns, when it is settled (the error left is about the
# square), relative step of the difference for its slope, largest turn of the pull's logarithm.
_MOST_TURNS = 12
_SETTLED = 1e-4
_ALONG = 1e-5
_LARGEST_TURN = 1.5


@kernel
def solve_redundant_range(
    start: int,
    stop: int,
    situation: Situation,
    figures: CableFigures,
    inverse_weight: FloatArray,
    out: Answers,
) -> None:
    """Solve the poses from `start` to `stop`: by linear programmes, else by the interior point."""
    m, n = situation.rows.size, situation.attachments.shape[0]
    pose = new_pose(situation, figures)
    lp = new_programme(m, n)
    scratch = new_scratch(m, n)
    sizing = inverse_weight[0] < 0.0
    for at in range(start, stop):
        place(pose, situation, figures, at)
        straight_c, spans = massless(pose, lp)
        if not spans:
            out.cables[at] = np.nan
            out.poses[at] = np.nan
            out.verdict[at] = NOT_CONVERGED
            continue
        limit_sag(pose)
        to_scaled = pose.scale[SIZE] / pose.scale[FORCE]
        ask = asked(pose, inverse_weight[at if inverse_weight.size > 1 else 0])
        s, gap = _walk(pose, lp, ask, scratch)
        verdict = NOT_CONVERGED
        if gap <= OPTIMAL_WITHIN:
            c = (ask.c_0 + s * ask.c_s) / to_scaled
            verdict = store(out, at, pose, c, gap, straight_c, sizing)
        for keep in KEPT_PULLS:
            if verdict != SOLVED:
                s = START_OF_STRAIGHT * straight_c if sizing else -1.0
                pull_straight(pose, ask, s)
                s, gap = climb(pose, ask, s, keep, PATIENCE, scratch)
                c = (ask.c_0 + s * ask.c_s) / to_scaled
                verdict = store(out, at, pose, c, gap, straight_c, sizing)


@kernel
def solve_massless_range(
    start: int,
    stop: int,
    situation: Situation,
    figures: CableFigures,
    out_tension: FloatArray,
    out_wrench: FloatArray,
    out_verdict: VerdictArray,
) -> None:
    """Find straight cables' tensions with the smallest largest one, poses `start` to `stop`.

    Tensions are NaN where there are none; the wrenches are then such that no tensions can do work
    against them, although the load does. Elsewhere they tell by how much the largest tension falls
    with the load.
    """
    rows, least_tension = situation.rows, figures.least_tension
    m, n = rows.size, situation.attachments.shape[0]
    pose = new_pose(situation, figures)
    lp = new_programme(m, n)
    scratch = new_scratch(m, n)
    for at in range(start, stop):
        place(pose, situation, figures, at)
        c, spans = massless(pose, lp)
        held = c > NOTHING
        for i in range(n):
            tension = pose.cables[STRAIGHT, i] * pose.scale[SIZE] / c
            # Of a cable at its least, the linear programme may leave a rounding error.
            out_tension[at, i] = max(tension, least_tension) if held else np.nan
        out_verdict[at] = SOLVED
        if not spans:
            out_verdict[at] = RANK_DEFICIENT
        elif not held:
            out_verdict[at] = OUTSIDE_HULL if c <= NOTHING else NOT_CONVERGED
        is_valued = spans and _value_wrenches(pose, lp, scratch)
        for k in range(m):
            value = scratch.value[k] if rows[k] < 3 else scratch.value[k] / pose.scale[REACH]
            out_wrench[at, k] = value if is_valued else np.nan


@element
def massless(pose: Pose, lp: Programme) -> tuple[float, bool]:
    """Return the largest scaled c for straight weightless cables; whether they span all wrenches.

    Their tensions over the scaled strength go into row `STRAIGHT`.
    """
    c = pose.cables
    n = c.shape[1]
    ask = Ask(0.0, 1.0, 1.0, 0.0)
    make_straight(pose, 0.0)
    choose_bounds(pose, 0.0)
    _write_programme(lp, pose, ask)
    if not choose_basis(lp):
        return 0.0, False
    if maximise(lp) != OPTIMAL:
        return np.nan, True
    for i in range(n):
        c[STRAIGHT, i] = _pull_of(lp, pose, ask, i) * c[CHORD, i] * c[SHARE, i]
    return float(lp.z[n]), True


@element
def _walk(pose: Pose, lp: Programme, ask: Ask, scratch: Scratch) -> tuple[float, float]:
    """Solve by linear programmes, one a Newton step; return s and the last relative step.

    The basis of the straight cables is the start. A cable that wants less than no tension is left
    to hang from then on, unless its sag is limited. An infinite step tells that the steps do not
    settle.
    """
    c = pose.cables
    n = c.shape[1]
    s = float(lp.z[n])  # of straight cables
    make_straight(pose, 0.5)
    for iteration in range(_MOST_STEPS):
        choose_bounds(pose, ask.c_0 + s * ask.c_s)
        _write_programme(lp, pose, ask)
        if not rebuild(lp) or maximise(lp) != OPTIMAL:
            return s, np.inf
        before, s = s, float(lp.z[n])
        step = abs(s - before) / abs(s)
        step = max(step, _pull(pose, lp, ask, iteration == 0))
        some_hang = False
        for i in range(n):
            if lp.dual[i] < 0.0 and c[LEAST, i] == 0.0 and c[FLOOR, i] == PULL_FLOOR:
                c[HANGS, i] = 1.0
            some_hang = some_hang or c[HANGS, i] > 0.0
        if some_hang:
            step = max(step, _hang(pose, lp, scratch))
        if not step < np.inf:
            return s, np.inf
        if iteration > 0 and step < _SMALL_STEP:
            return s, step
        linearise(pose)
    return s, np.inf


@element
def _pull(pose: Pose, lp: Programme, ask: Ask, is_first: bool) -> float:
    """Pull the cables as the linear programme has it; return the largest relative step."""
    c = pose.cables
    largest = 0.0
    for i in range(c.shape[1]):
        old, length = c[P, i], c[L, i]
        new = _pull_of(lp, pose, ask, i)
        if not is_first:
            new = min(max(new, 0.2 * old), 5.0 * old)
        c[P, i] = new = max(new, c[FLOOR, i])
        moved = length + c[L_0, i] + c[L_P, i] * (new - old)
        c[L, i] = min(max(moved, 0.5 * length), 2.0 * length)
        step = abs(new - old) / new + abs(c[L, i] - length) / length
        if not step <= largest:
            largest = step
    return largest


@element
def _write_programme(lp: Programme, pose: Pose, ask: Ask) -> None:
    """Write the linearised pose as a linear programme in the rooms below the strengths.

    The scaled pulls are y = u + s u' - z with u + s u' the pull at which the linearised top tension
    reaches its limit.
    """
    c, table = pose.cables, lp.table
    m, n = lp.basis.size, lp.dual.size
    for i in range(n):
        hangs = c[HANGS, i] > 0.0
        rest, slope = _tension_line(c, i)
        reach = 1.0 / (slope * c[UNIT, i])
        low, low_c = smallest_pull(pose, i)
        top = (ask.f_0 * c[STRENGTH, i] - rest) * reach
        top_s = ask.f_s * c[STRENGTH, i] * reach
        # The pull of a hanging cable is settled elsewhere: here it is a part of the load.
        c[TOP, i] = c[P, i] / c[UNIT, i] if hangs else top
        c[TOP_S, i] = 0.0 if hangs else top_s
        lp.room[i] = 0.0 if hangs else top - low - low_c * ask.c_0
        lp.room_slope[i] = 0.0 if hangs else top_s - low_c * ask.c_s
        c[UP, i] = c[SHARE, i] * (c[V, i] - c[V_P, i] * c[P, i]) / pose.scale[FORCE]
    write_wrenches(pose)
    for k in range(m):
        row = pose.rows[k]
        slope, rest = ask.c_s * pose.load[row], -ask.c_0 * pose.load[row]
        for i in range(n):
            wrench = c[WRENCH + row, i]
            slope -= wrench * c[TOP_S, i]
            rest += wrench * c[TOP, i] + c[UP, i] * c[LIFT + row, i]
            table[k, i] = 0.0 if c[HANGS, i] > 0.0 else wrench
        lp.slope[k] = table[k, n] = slope
        table[k, n + 1] = rest


@element
def _pull_of(lp: Programme, pose: Pose, ask: Ask, i: int) -> float:
    """Return the pull of a cable in the solution of the linear programme."""
    c = pose.cables
    if c[HANGS, i] > 0.0:
        return float(c[P, i])
    limit = (ask.f_0 + lp.z[lp.dual.size] * ask.f_s) * c[STRENGTH, i]
    rest, slope = _tension_line(c, i)
    return float((limit - rest) / slope - lp.z[i] * c[UNIT, i])


@element
def _tension_line(c: FloatArray, i: int) -> tuple[float, float]:
    """Return the linear top tension: its value at no pull, and its slope.

    A cable so slack that its tension falls with the pull is far from its strength, and taken as
    straight; were it to come near, it would be taut.
    """
    if c[T_P, i] > _LEAST_SLOPE * c[CHORD, i]:
        return c[T, i] - c[T_P, i] * c[P, i], c[T_P, i]
    return 0.5 * abs(c[D, i]), c[CHORD, i]


@inner
def _value_wrenches(pose: Pose, lp: Programme, scratch: Scratch) -> bool:
    """Fill by how much s rises per unit of each component of the scaled wrench; False if undefined.

    Cables in the basis are free, so what they can give is worth nothing: value · Aⱼ = 0 for them,
    and value · h = 1 with h the column of s, but for what s itself changes through the bounds.
    """
    value, A = scratch.value, scratch.square
    m, n = lp.basis.size, lp.dual.size
    for k in range(m):
        j = lp.basis[k]
        for q in range(m):
            A[k, q] = pose.cables[WRENCH + pose.rows[q], j] if j < n else lp.slope[q]
        A[k, m] = 0.0 if j < n else 1.0
    if not solve_small(A, value):
        return False
    coupling = 1.0
    for j in range(n):
        if lp.rests[j] == AT_TOP:
            coupling += along(pose, value, WRENCH, j) * lp.room_slope[j]
    for q in range(m):
        value[q] /= coupling
    return True


@inner
def _hang(pose: Pose, lp: Programme, scratch: Scratch) -> float:
    """Let hanging cables find their pull; return the largest relative step of them."""
    c = pose.cables
    if not _value_wrenches(pose, lp, scratch):
        return np.inf
    largest = 0.0
    for i in range(c.shape[1]):
        if c[HANGS, i] > 0.0:
            largest = max(largest, _settle_hanging(pose, scratch.value, i))
    return largest


@inner
def _settle_hanging(pose: Pose, value: FloatArray, i: int) -> float:
    """Move a hanging cable to the pull at which s cannot rise; return the relative step.

    There value · W'(p) = 0: it is at no limit, but where its own weight harms least. W' is its
    horizontal part plus the slope v' of the upward pull, so the condition asks for one v'. What
    that is above the drop falls about as X² / (24 L p³), L being the chord: Newton in logarithms.
    An infinite step tells that there is no such pull.
    """
    c = pose.cables
    upward = along(pose, value, LIFT, i) * (c[SHARE, i] * c[UNIT, i] / pose.scale[FORCE])
    sideways = along(pose, value, WRENCH, i) - upward * c[V_P, i]
    goal = -sideways / upward - c[D, i]
    if not (upward > 0.0 and goal > 0.0):
        return np.inf
    before = c[P, i]
    p = (c[X2, i] / (24.0 * c[CHORD, i] * goal)) ** (1.0 / 3.0)
    for _ in range(_MOST_TURNS):
        excess = _lift_slope(c, i, p) - c[D, i]
        excess_ahead = _lift_slope(c, i, p * (1.0 + _ALONG)) - c[D, i]
        if not (excess_ahead > 0.0 and excess > excess_ahead):
            return np.inf
        turn = np.log(excess / goal) / np.log(excess / excess_ahead) * np.log(1.0 + _ALONG)
        p *= np.exp(min(max(turn, -_LARGEST_TURN), _LARGEST_TURN))
        if abs(turn) < _SETTLED:
            break
    if not (PULL_FLOOR < p < np.inf):
        return np.inf
    c[P, i] = p
    c[L, i] = settled_length(c, i, p)
    return float(abs(p - before) / p)


@inner
def _lift_slope(c: FloatArray, i: int, p: float) -> float:
    """Return the slope of a cable's upward pull in its pull."""
    length = settled_length(c, i, p)
    _, F_p, F_l, _, v_p, v_l, _, _, _ = unit_cable(p, length, c[X2, i], c[D, i], c[KAPPA, i])
    return float(v_p - v_l * F_p / F_l)
