"""Statics and sizing of many poses of a robot with more cables than degrees of freedom.

The cables can pull against each other, so that a pose leaves a choice of internal forces. What is
chosen: when sizing, the forces that allow the thinnest cable; with a given cable, those with the
smallest largest tension over strength. As in `designer.kernel.square`, cables have unit weight, the
unknowns are the pulls p, and the platform's balance is linear in the inverse weight c:

    Σᵢ ωᵢ (pᵢ eᵢ, vᵢ(pᵢ); moments) = c · load,    tᵢ(pᵢ) ≤ f · strengthᵢ,    τᵢ(pᵢ) ≥ c · leastᵢ

with top tension t and least tension τ anywhere in the cable, and with c as large, or with c given
and f as small, as can be. Straight cables make this a linear programme, and so does each Newton
step for sagging ones; where enough cables are at a limit, the steps end on a vertex and converge
quadratically. Where a cable is best left between its limits, an interior point takes over; where
neither ends in an equilibrium, `designer.kernel.feasible` proves that there is none, or tells where
else to start.

What is called for every pose is compiled in place (`element`): to hand so many arrays to a function
takes longer than most of these functions do.
"""

from __future__ import annotations

import numpy as np

from designer.arrays import FloatArray, VerdictArray
from designer.kernel.answer import (
    NO_FINITE_CABLE,
    NOT_CONVERGED,
    OUTSIDE_HULL,
    RANK_DEFICIENT,
    SOLVED,
    WEIGHT,
    Answers,
)
from designer.kernel.calling import CableFigures, Situation
from designer.kernel.compiling import allocating, element, inner, kernel
from designer.kernel.feasible import (
    FAILED,
    MOST_PARTS,
    MOST_PARTS_OVER_PULLEYS,
    REFUSED,
    UNDECIDED,
    Parts,
    bound_part,
    cut_part,
    leaving_slope,
    new_parts,
    set_ranges,
)
from designer.kernel.interior import (
    PATIENCE,
    START_OF_STRAIGHT,
    Scratch,
    climb,
    new_scratch,
    pull_straight,
)
from designer.kernel.linear import copy, solve_small
from designer.kernel.pose import (
    FLOOR,
    FORCE,
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
    write_massless,
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
    L_0,
    L_P,
    LIFT,
    SHARE,
    STRAIGHT,
    STRENGTH,
    T_P,
    V_P,
    D,
    L,
    P,
    T,
    V,
)

KEPT_PULLS = (0.5, 0.9)
"""Share of its pull that a cable keeps in a step of the interior point; then more careful."""
_MOST_STEPS = 8
_SMALL_STEP = 1e-6
_LEAST_SLOPE = 0.3
"""Of the top tension in the pull, over the chord: a cable of less is far from its strength."""
_NEARER = 0.1
"""Of its distance from the curves: what a point has to be nearer by to be the next start."""
_ON_CURVES = 1e-11
"""Distance from the curves, over the forces, at which a point is an equilibrium."""
_AT_ROUNDING = 1e-13
"""The same, as near as it gets."""
_LIGHTER = 1.0 + 1e-5
"""Of the inverse weight: what a better answer has at least; half of it in diameter."""
_MOST_BETTER = 8
_MOST_PARTS_OF_PROOF = 5_000
"""Parts that are looked at to prove that nothing lighter holds, each time that something does."""


@kernel
def solve_redundant_range(
    start: int,
    stop: int,
    situation: Situation,
    figures: CableFigures,
    inverse_weight: FloatArray,
    near: FloatArray,
    proves_best: bool,
    out: Answers,
) -> None:
    """Solve the poses from `start` to `stop`, or prove of them that no taut cables hold them.

    Of cables that are sized it may be proved as well that no thinner ones do. Where an equilibrium
    is known to be ``near`` (0 or n_poses, n_cables + 1), by its pulls and its inverse weight, that
    is where to start; NaN where none is.
    """
    m, n = situation.rows.size, situation.attachments.shape[0]
    pose = new_pose(situation, figures)
    lp = new_programme(m, n)
    scratch = new_scratch(m, n)
    bows_out = figures.pulley_radius > 0.0 and figures.vertical[2] < 1.0
    parts, bodies = new_parts(m, n, 3 if bows_out else 1)
    for at in range(start, stop):
        _solve(
            at, situation, figures, inverse_weight, near, proves_best,
            pose, lp, scratch, parts, bodies, out,
        )  # fmt: skip


@inner
def _solve(
    at: int,
    situation: Situation,
    figures: CableFigures,
    inverse_weight: FloatArray,
    near: FloatArray,
    proves_best: bool,
    pose: Pose,
    lp: Programme,
    scratch: Scratch,
    parts: Parts,
    bodies: Programme,
    out: Answers,
) -> None:
    """Solve a pose: near what is known, from straight cables, or where a proof leaves it open."""
    place(pose, situation, figures, at)
    out.wrench[at] = np.nan
    out.leaving[at] = np.nan
    straight_c, spans = massless(pose, lp)
    straight_s = float(lp.z[-1])
    limit_sag(pose)
    ask = asked(pose, inverse_weight[at if inverse_weight.size > 1 else 0])
    verdict = NOT_CONVERGED
    # From what is known to be near by a climb, which stays there, else by steps; or from straight.
    is_near = near.shape[0] > 0 and near[at, -1] > 0.0
    for turn in range(0 if is_near else 2, 3 if spans else 0):
        s = straight_s
        if turn < 2:
            borne = near[at, -1] * pose.scale[SIZE] / pose.scale[FORCE]
            s = _pull_as(pose, ask, near[at], borne)
        if turn == 0:
            s, gap = climb(pose, ask, s, KEPT_PULLS[1], PATIENCE, scratch)
        else:
            s, gap = _walk(pose, lp, ask, s, is_near=turn == 1)
        if gap <= OPTIMAL_WITHIN:
            verdict = _store(out, at, pose, ask, s, gap, straight_c)
        if verdict == SOLVED:
            break
    if verdict != SOLVED:
        verdict = _decide(pose, parts, bodies, ask, scratch, straight_c, out, at)
    if verdict != SOLVED:
        out.cables[at] = np.nan
        out.poses[at] = np.nan
        write_massless(out, at, pose, straight_c)
    out.is_best[at] = False
    if verdict == SOLVED and proves_best and ask.c_s > 0.0:
        out.is_best[at] = _is_best(pose, parts, bodies, scratch, straight_c, out, at)
    out.verdict[at] = verdict


@inner
def _store(
    out: Answers, at: int, pose: Pose, ask: Ask, s: float, gap: float, straight_c: float
) -> int:
    c = (ask.c_0 + s * ask.c_s) / (pose.scale[SIZE] / pose.scale[FORCE])
    return store(out, at, pose, c, gap, straight_c, ask.c_s > 0.0)


@inner
def _refusal(pose: Pose, parts: Parts, bodies: Programme, ask: Ask, out: Answers, at: int) -> int:
    """Tell of a pose that cables of their strength do not hold whether stronger ones would not."""
    if ask.c_s == 0.0:
        return OUTSIDE_HULL
    if set_ranges(pose, parts, ask, True) != UNDECIDED:
        return NO_FINITE_CABLE
    if bound_part(pose, parts, 0, bodies, ask)[0] != REFUSED:
        return NO_FINITE_CABLE
    copy(parts.wrench, out.wrench[at])
    return OUTSIDE_HULL


@inner
def _decide(
    pose: Pose,
    parts: Parts,
    bodies: Programme,
    ask: Ask,
    scratch: Scratch,
    straight_c: float,
    out: Answers,
    at: int,
) -> int:
    """Prove that no taut cables hold a pose, or start the interior point where they might."""
    status, nearest = set_ranges(pose, parts, ask, False), np.inf
    if status == REFUSED:
        return _refusal(pose, parts, bodies, ask, out, at)
    count = 0 if status == FAILED else 1
    for turn in range(MOST_PARTS_OVER_PULLEYS if pose.radius > 0.0 else MOST_PARTS):
        apart = np.inf
        if count > 0:
            status, apart = bound_part(pose, parts, count - 1, bodies, ask)
            if status == REFUSED:
                count -= 1
                if turn == 0:
                    copy(parts.wrench, out.wrench[at])
                if count == 0:
                    out.leaving[at] = np.nan
                    return _refusal(pose, parts, bodies, ask, out, at)
                continue
        if turn == 0 and straight_c > NOTHING:
            for keep in KEPT_PULLS:
                s = START_OF_STRAIGHT * straight_c if ask.c_s > 0.0 else -1.0
                pull_straight(pose, ask, s)
                s, gap = climb(pose, ask, s, keep, PATIENCE, scratch)
                if _store(out, at, pose, ask, s, gap, straight_c) == SOLVED:
                    return SOLVED
        if count == 0:
            break
        if apart < max(_NEARER * nearest, _ON_CURVES) or turn & (turn - 1) == 0:
            nearest = min(apart, nearest)
            s, gap = _climb_from_point(pose, parts, ask, apart, scratch)
            for i in range(pose.cables.shape[1] if pose.radius > 0.0 else 0):
                out.leaving[at, i] = leaving_slope(pose, i, parts.pulls[0, i])
            if _store(out, at, pose, ask, s, gap, straight_c) == SOLVED:
                return SOLVED
            if pose.radius > 0.0 and apart < _AT_ROUNDING:
                break  # an equilibrium, but over pulleys that are yet to be moved
        if not cut_part(pose, parts, count - 1, ask, apart):
            break
        count += 1
    return NOT_CONVERGED


@inner
def _climb_from_point(
    pose: Pose, parts: Parts, ask: Ask, apart: float, scratch: Scratch
) -> tuple[float, float]:
    """Start the interior point from a point of the bodies; where that is on the curves, take it."""
    c, s = pose.cables, _pull_as(pose, ask, parts.pulls[0], parts.borne[0])
    if apart > _ON_CURVES:
        return climb(pose, ask, s, KEPT_PULLS[0], PATIENCE, scratch)
    for i in range(c.shape[1]):
        c[L, i] = settled_length(c, i, c[P, i])
    return s, 0.0


@inner
def _pull_as(pose: Pose, ask: Ask, pulls: FloatArray, scaled_c: float) -> float:
    """Pull the cables so; return the s of that, with the c where c is sought."""
    c, s = pose.cables, -1.0
    for i in range(c.shape[1]):
        c[P, i] = pulls[i]
        s = min(s, -c[P, i] / c[UNIT, i])
    return scaled_c if ask.c_s > 0.0 else s


@allocating
def _is_best(
    pose: Pose,
    parts: Parts,
    bodies: Programme,
    scratch: Scratch,
    straight_c: float,
    out: Answers,
    at: int,
) -> bool:
    """Prove that no taut cables of a lighter section hold a pose, or answer with those."""
    ask, scale = Ask(0.0, 1.0, 1.0, 0.0), pose.scale
    of_pose, of_cables = out.poses[at].copy(), out.cables[at].copy()
    for _ in range(_MOST_BETTER):
        best = scale[SIZE] / (scale[FORCE] * out.poses[at, WEIGHT])
        lighter = Ask(best * _LIGHTER, 1.0, 1.0, 0.0)
        status = set_ranges(pose, parts, lighter, False)
        count, is_better = 1 if status == UNDECIDED else 0, False
        for turn in range(_MOST_PARTS_OF_PROOF if count > 0 else 0):
            status, apart = bound_part(pose, parts, count - 1, bodies, lighter)
            if status == REFUSED:
                count -= 1
                if count == 0:
                    break
                continue
            if apart < _ON_CURVES or turn & (turn - 1) == 0:
                s, gap = _climb_from_point(pose, parts, ask, apart, scratch)
                copy(out.poses[at], of_pose)
                for i in range(of_cables.shape[0]):
                    copy(out.cables[at, i], of_cables[i])
                is_better = s > best * _LIGHTER and (
                    _store(out, at, pose, ask, s, gap, straight_c) == SOLVED
                )
                if is_better:
                    break
                copy(of_pose, out.poses[at])
                for i in range(of_cables.shape[0]):
                    copy(of_cables[i], out.cables[at, i])
            if not cut_part(pose, parts, count - 1, lighter, apart):
                break
            count += 1
        if not is_better:
            return status == REFUSED and count == 0
    return False


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
def _walk(pose: Pose, lp: Programme, ask: Ask, s: float, is_near: bool) -> tuple[float, float]:
    """Solve by linear programmes, one a Newton step; return s and the last relative step.

    The basis of the straight cables is the start, and so are these, unless the pulls of the pose
    are near. An infinite step tells that the steps do not settle.
    """
    c, n = pose.cables, pose.cables.shape[1]
    if is_near:
        for i in range(n):
            c[L, i] = settled_length(c, i, c[P, i])
        linearise(pose)
    else:
        make_straight(pose, 0.5)
    for iteration in range(1 if is_near else 0, _MOST_STEPS):
        choose_bounds(pose, ask.c_0 + s * ask.c_s)
        _write_programme(lp, pose, ask)
        if not rebuild(lp) or maximise(lp) != OPTIMAL:
            return s, np.inf
        before, s = s, float(lp.z[n])
        step = abs(s - before) / abs(s)
        step = max(step, _pull(pose, lp, ask, iteration == 0))
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
        rest, slope = _tension_line(c, i)
        reach = 1.0 / (slope * c[UNIT, i])
        low, low_c = smallest_pull(pose, i)
        top = (ask.f_0 * c[STRENGTH, i] - rest) * reach
        top_s = ask.f_s * c[STRENGTH, i] * reach
        c[TOP, i], c[TOP_S, i] = top, top_s
        lp.room[i] = top - low - low_c * ask.c_0
        lp.room_slope[i] = top_s - low_c * ask.c_s
        c[UP, i] = c[SHARE, i] * (c[V, i] - c[V_P, i] * c[P, i]) / pose.scale[FORCE]
    write_wrenches(pose)
    for k in range(m):
        row = pose.rows[k]
        slope, rest = ask.c_s * pose.load[row], -ask.c_0 * pose.load[row]
        for i in range(n):
            wrench = c[WRENCH + row, i]
            slope -= wrench * c[TOP_S, i]
            rest += wrench * c[TOP, i] + c[UP, i] * c[LIFT + row, i]
            table[k, i] = wrench
        lp.slope[k] = table[k, n] = slope
        table[k, n + 1] = rest


@element
def _pull_of(lp: Programme, pose: Pose, ask: Ask, i: int) -> float:
    """Return the pull of a cable in the solution of the linear programme."""
    c = pose.cables
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
