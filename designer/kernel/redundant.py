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

from designer.arrays import FloatArray, IntArray
from designer.kernel.compiling import element, kernel
from designer.kernel.redundant_answer import (
    NOTHING,
    OPTIMAL_WITHIN,
    store,
    store_deficient,
)
from designer.kernel.redundant_hanging import settle_hanging, value_wrenches
from designer.kernel.redundant_interior import improve, new_scratch
from designer.kernel.redundant_layout import (
    CHORD,
    FORCE,
    HANGS,
    L_0,
    L_P,
    LEAST,
    REACH,
    SHARE,
    SIZE,
    STRAIGHT,
    Ask,
    L,
    P,
    Pose,
    Scratch,
)  # fmt: skip
from designer.kernel.redundant_lp import (
    OPTIMAL,
    Programme,
    choose_basis,
    maximise,
    new_programme,
    rebuild,
)
from designer.kernel.redundant_pose import (
    linearise,
    make_straight,
    new_pose,
    place,
    pose_programme,
    pull_of,
)
from designer.kernel.unit_cable import PULL_FLOOR
from designer.model.verdict import Verdict

_MOST_STEPS = 8
_SMALL_STEP = 1e-6
# Share of its pull that a cable keeps at least in a step of the interior point; then more careful.
_KEPT_PULLS = (0.5, 0.9)
_START_OF_STRAIGHT = 0.8
_SOLVED = int(Verdict.SOLVED)
_NOT_CONVERGED = int(Verdict.NOT_CONVERGED)
_OUTSIDE_HULL = int(Verdict.OUTSIDE_HULL)
_RANK_DEFICIENT = int(Verdict.RANK_DEFICIENT)


@element
def massless(pose: Pose, lp: Programme) -> tuple[float, bool]:
    """Return the largest scaled c for straight weightless cables; whether they span all wrenches.

    Their tensions over the scaled strength go into row `STRAIGHT`.
    """
    c = pose.cables
    n = c.shape[1]
    ask = Ask(0.0, 1.0, 1.0, 0.0)
    make_straight(pose, 0.0)
    pose_programme(lp, pose, ask, 0.0)
    if not choose_basis(lp):
        return 0.0, False
    if maximise(lp) != OPTIMAL:
        return np.nan, True
    for i in range(n):
        c[STRAIGHT, i] = pull_of(lp, pose, ask, i) * c[CHORD, i] * c[SHARE, i]
    return float(lp.z[n]), True


@kernel
def solve_massless_range(
    start: int,
    stop: int,
    exit_points: FloatArray,
    attachments: FloatArray,
    load: FloatArray,
    load_point: FloatArray,
    weight: float,
    positions: FloatArray,
    rotations: FloatArray,
    rows: IntArray,
    least_tension: float,
    out_tension: FloatArray,
    out_wrench: FloatArray,
    out_verdict: IntArray,
) -> None:
    """Find straight cables' tensions with the smallest largest one, poses `start` to `stop`.

    Tensions are NaN where there are none; the wrenches are then such that no tensions can do work
    against them, although the load does. Elsewhere they tell by how much the largest tension falls
    with the load.
    """
    n, m = exit_points.shape[1], rows.size
    one = np.ones(n)
    pose = new_pose(one, one, one, rows, least_tension)
    lp = new_programme(m, n)
    scratch = new_scratch(m, n)
    for at in range(start, stop):
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
        c, spans = massless(pose, lp)
        held = c > NOTHING
        for i in range(n):
            tension = pose.cables[STRAIGHT, i] * pose.scale[SIZE] / c
            # Of a cable at its least, the linear programme may leave a rounding error.
            out_tension[at, i] = max(tension, least_tension) if held else np.nan
        out_verdict[at] = _SOLVED
        if not spans:
            out_verdict[at] = _RANK_DEFICIENT
        elif not held:
            out_verdict[at] = _OUTSIDE_HULL if c <= NOTHING else _NOT_CONVERGED
        known = spans and value_wrenches(pose, lp, scratch.value, scratch.square)
        for k in range(m):
            value = scratch.value[k] if rows[k] < 3 else scratch.value[k] / pose.scale[REACH]
            out_wrench[at, k] = value if known else np.nan


@element
def walk(pose: Pose, lp: Programme, ask: Ask, scratch: Scratch) -> tuple[float, float]:
    """Solve by linear programmes, one a Newton step; return s and the last relative step.

    The basis of the straight cables is the start. A cable that wants less than no tension is left
    to hang from then on. An infinite step tells that the steps do not settle.
    """
    c = pose.cables
    n = c.shape[1]
    s = 0.0
    make_straight(pose, 0.5)
    for iteration in range(_MOST_STEPS):
        pose_programme(lp, pose, ask, PULL_FLOOR)
        if not rebuild(lp) or maximise(lp) != OPTIMAL:
            return s, np.inf
        before, s = s, float(lp.z[n])
        step = abs(s - before) / abs(s)
        step = max(step, pull(pose, lp, ask, iteration == 0))
        if some_hang(pose, lp):
            step = max(step, hang(pose, lp, scratch))
        if not step < np.inf:
            return s, np.inf
        if iteration > 0 and step < _SMALL_STEP:
            return s, step
        linearise(pose)
    return s, np.inf


@element
def pull(pose: Pose, lp: Programme, ask: Ask, is_first: bool) -> float:
    """Pull the cables as the linear programme has it; return the largest relative step."""
    c = pose.cables
    largest = 0.0
    for i in range(c.shape[1]):
        old, length = c[P, i], c[L, i]
        new = pull_of(lp, pose, ask, i)
        if not is_first:
            new = min(max(new, 0.2 * old), 5.0 * old)
        c[P, i] = new = max(new, PULL_FLOOR)
        moved = length + c[L_0, i] + c[L_P, i] * (new - old)
        c[L, i] = min(max(moved, 0.5 * length), 2.0 * length)
        step = abs(new - old) / new + abs(c[L, i] - length) / length
        if not step <= largest:
            largest = step
    return largest


@element
def some_hang(pose: Pose, lp: Programme) -> bool:
    """Mark the cables that want no tension as hanging; tell whether any hangs."""
    c = pose.cables
    some = False
    for i in range(c.shape[1]):
        if lp.dual[i] < 0.0 and c[LEAST, i] == 0.0:
            c[HANGS, i] = 1.0
        some = some or c[HANGS, i] > 0.0
    return some


@kernel
def hang(pose: Pose, lp: Programme, scratch: Scratch) -> float:
    """Let hanging cables find their pull; return the largest relative step of them."""
    c = pose.cables
    if not value_wrenches(pose, lp, scratch.value, scratch.square):
        return np.inf
    largest = 0.0
    for i in range(c.shape[1]):
        if c[HANGS, i] > 0.0:
            largest = max(largest, settle_hanging(pose, scratch.value, i))
    return largest


@kernel
def solve_redundant_range(
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
    inverse_weight: float,
    rows: IntArray,
    least_tension: float,
    out_cables: FloatArray,
    out_poses: FloatArray,
    out_verdict: IntArray,
) -> None:
    """Solve the poses from `start` to `stop`."""
    m, n = rows.size, kappa.size
    pose = new_pose(kappa, weights, strength, rows, least_tension)
    lp = new_programme(m, n)
    scratch = new_scratch(m, n)
    for at in range(start, stop):
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
        straight_c, spans = massless(pose, lp)
        if spans:
            solve_pose(
                out_cables, out_poses, out_verdict, at, pose, lp, scratch, straight_c,
                inverse_weight,
            )  # fmt: skip
        else:
            store_deficient(out_cables, out_poses, out_verdict, at)


@element
def solve_pose(
    out_cables: FloatArray,
    out_poses: FloatArray,
    out_verdict: IntArray,
    at: int,
    pose: Pose,
    lp: Programme,
    scratch: Scratch,
    straight_c: float,
    inverse_weight: float,
) -> None:
    """Solve a placed pose: by linear programmes, else by the interior point."""
    to_scaled = pose.scale[SIZE] / pose.scale[FORCE]
    sizing = inverse_weight < 0.0
    ask = Ask(0.0, 1.0, 1.0, 0.0) if sizing else Ask(inverse_weight * to_scaled, 0.0, 0.0, -1.0)
    s, gap = walk(pose, lp, ask, scratch)
    if gap <= OPTIMAL_WITHIN:
        c = (ask.c_0 + s * ask.c_s) / to_scaled
        verdict = store(out_cables, out_poses, out_verdict, at, pose, c, gap, straight_c, sizing)
        if verdict == _SOLVED:
            return
    for keep in _KEPT_PULLS:
        start = _START_OF_STRAIGHT * straight_c if sizing else -1.0
        s, gap = improve(pose, ask, start, keep, scratch)
        c = (ask.c_0 + s * ask.c_s) / to_scaled
        verdict = store(out_cables, out_poses, out_verdict, at, pose, c, gap, straight_c, sizing)
        if verdict == _SOLVED:
            return
