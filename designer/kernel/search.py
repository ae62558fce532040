"""Other branches of a pose: the interior point from many starts, for what the quick way left.

Cables that sag are no convex matter: a cable may hang as a counterweight or be pulled tight, and
each way can be a branch of its own. What is tried: straight cables' pulls; those with one cable
after the other hanging; all cables with half of their pull or hanging; pulls drawn at random
between hanging and the strength, the same in every run; the best of these with one cable after the
other hanging or pulled tight, and with all its pulls changed at random. An answer replaces what was
there if it is better and its residuals say that it holds; the search proves nothing of what it does
not find. Of 2265 random poses of random robots 13 ended more than 0.1 % thicker than the best of
300 random starts, the worst by a half.

What it does prove is that **no finite cable** holds a pose. For any wrench y whose product with
the load is not negative, and cables as strong as they are,

    0 ≤ c y · load = Σᵢ y · Wᵢ(pᵢ) ≤ Σᵢ max gᵢ,    gᵢ(p) = y · Wᵢ(p) = α p + β v(p),

the maximum taken over every pull that the cable's strength bears, so a sum below zero leaves no c,
whatever the section and the internal forces. Neither v nor g is concave; the maximum is bounded
part by part of the range, from the ends of each part, with a margin.
The wrench is where the search ended. It is evaluated in doubles, with a margin.
"""

from __future__ import annotations

import numpy as np

from designer.arrays import FloatArray
from designer.kernel.answer import FORCE_X, LOAD_FACTOR, NO_FINITE_CABLE, SOLVED, WEIGHT, Answers
from designer.kernel.calling import CableFigures, Situation
from designer.kernel.compiling import element, inner, kernel
from designer.kernel.interior import START_OF_STRAIGHT, climb, new_scratch, pull_straight
from designer.kernel.linear import copy, solve_small
from designer.kernel.pose import (
    FORCE,
    OPTIMAL_WITHIN,
    SIZE,
    UNIT,
    Ask,
    Pose,
    along,
    asked,
    limit_sag,
    new_pose,
    place,
    settled_length,
    smallest_pull,
    store,
)
from designer.kernel.redundant import KEPT_PULLS, massless
from designer.kernel.simplex import new_programme
from designer.kernel.table import CHORD, KAPPA, LEVEL, LIFT, SHARE, STRAIGHT, STRENGTH, X2, D, P
from designer.kernel.unit_cable import PULL_FLOOR, unit_cable

_RANDOM_STARTS = 6
_RANDOM_BESIDE = 12
_WIDTH = 20.0
"""A pull is changed by up to this factor, or divided by it."""
_RANDOM_SEED = 88172645463325252  # Marsaglia's own
_HANGS = 0.5
"""Pull of a cable that is to hang, a sixth longer than its horizontal distance."""
_HANGS_DEEP = 0.2
"""Of one that is two and a half times as long."""
_LIGHT = 0.1
"""Scaled inverse weight to start from where straight cables hold nothing."""
_BETTER = 1e-7
_SURELY = 1e-9
_NOTHING = 1e-300
_PARTS = 300
_MARGIN = 1e-3
"""Of what is bounded part by part: within a part the lift may leave its ends by their square."""
_ABOVE_LEAST = 1.1
_SHORTER = 0.7
_HALVINGS = 40


@kernel
def prove_range(
    start: int,
    stop: int,
    situation: Situation,
    figures: CableFigures,
    out: Answers,
) -> None:
    """Tell of poses of a point mass on as few cables as hold it that no finite cable does.

    Of those that are to be sized, and have no answer: what `search_range` would say, compiled in a
    fifth of the time.
    """
    n = situation.attachments.shape[0]
    pose = new_pose(situation, figures)
    c, system, pull = pose.cables, np.empty((n, n + 1)), np.empty(n)
    for at in range(start, stop):
        if out.verdict[at] == SOLVED:
            continue
        place(pose, situation, figures, at)
        for k in range(n):
            row = pose.rows[k]
            system[k, n] = pose.load[row]
            for i in range(n):
                system[k, i] = c[LEVEL + row, i] + c[LIFT + row, i] * c[D, i]
        if not solve_small(system, pull):
            continue
        least, largest = np.inf, -np.inf
        for i in range(n):
            least, largest = min(least, pull[i]), max(largest, pull[i])
            c[STRAIGHT, i] = pull[i] * c[SHARE, i] * c[CHORD, i]
        if least >= -_SURELY * largest and _point_bounds(pose):
            out.verdict[at] = NO_FINITE_CABLE


@kernel
def search_range(
    start: int,
    stop: int,
    situation: Situation,
    figures: CableFigures,
    inverse_weight: FloatArray,
    out: Answers,
) -> None:
    """Better the answers of the poses from `start` to `stop`; see `solve_redundant_range`."""
    m, n = situation.rows.size, situation.attachments.shape[0]
    pose = new_pose(situation, figures)
    lp = new_programme(m, n)
    scratch = new_scratch(m, n)
    pulls, lifts = np.empty((n, _PARTS + 1)), np.empty((n, _PARTS + 1))
    sizing = inverse_weight[0] < 0.0
    keep_cables, keep_pose = np.empty((n, 3)), np.empty(out.poses.shape[1])
    for at in range(start, stop):
        place(pose, situation, figures, at)
        straight_c, spans = massless(pose, lp)
        if not (spans and straight_c > 0.0):
            pose.cables[STRAIGHT] = np.nan
        limit_sag(pose)
        to_scaled = pose.scale[SIZE] / pose.scale[FORCE]
        ask = asked(pose, inverse_weight[at if inverse_weight.size > 1 else 0])
        best = -np.inf
        if out.verdict[at] == SOLVED:
            best = to_scaled / out.poses[at, WEIGHT] if sizing else -out.poses[at, LOAD_FACTOR]
        state = np.uint64(_RANDOM_SEED)
        is_proved = best == -np.inf and straight_c > 0.0 and _point_bounds(pose)
        pulls[0, 0] = 0.0  # to be divided when first a start fails
        n_starts = n + 3 + _RANDOM_STARTS
        for attempt in range(n_starts + 2 * n + _RANDOM_BESIDE):
            if best == -np.inf and (is_proved or attempt >= n_starts):
                # Nor does the section that is asked for hold then, within its strength.
                out.verdict[at] = NO_FINITE_CABLE if is_proved and sizing else out.verdict[at]
                break
            if attempt < n_starts:
                s, state = _begin(pose, ask, straight_c, attempt, state)
            else:
                s, state = _begin_beside(pose, ask, best, out, at, attempt - n_starts, state)
            s, gap = climb(pose, ask, s, KEPT_PULLS[1 if attempt == 1 else 0], scratch)
            is_optimal = gap <= OPTIMAL_WITHIN
            if best == -np.inf and not (is_optimal and (s > 0.0 or not sizing)):
                for k in range(m):
                    scratch.value[k] = -scratch.dual[k]
                is_proved = _bounds(pose, scratch.value, pulls, lifts)
            if not is_optimal or not (s > best + _BETTER * abs(s) or best == -np.inf):
                continue
            _copy_answer(out.cables[at], out.poses[at], keep_cables, keep_pose)
            before = out.verdict[at]
            c = (ask.c_0 + s * ask.c_s) / to_scaled
            if store(out, at, pose, c, gap, straight_c, sizing) == SOLVED:
                best = s
            else:
                _copy_answer(keep_cables, keep_pose, out.cables[at], out.poses[at])
                out.verdict[at] = before


@element
def _copy_answer(
    cables: FloatArray, pose: FloatArray, to_cables: FloatArray, to_pose: FloatArray
) -> None:
    for i in range(cables.shape[0]):
        copy(cables[i], to_cables[i])
    copy(pose, to_pose)


@inner
def _begin(
    pose: Pose, ask: Ask, straight_c: float, attempt: int, state: np.uint64
) -> tuple[float, np.uint64]:
    """Set the pulls that an attempt starts from; return the guess of s and the next random state.

    First twice straight cables, then one cable after the other hanging, then all cables with half
    of their pull, then random ones.
    """
    c = pose.cables
    n = c.shape[1]
    s = START_OF_STRAIGHT * straight_c if straight_c > 0.0 else _LIGHT
    if ask.c_s == 0.0:
        s = -1.0
    pull_straight(pose, ask, s)
    if attempt >= 2 and attempt < n + 2:
        _slacken(pose, ask, s, attempt - 2, _HANGS)
    elif attempt == n + 2:
        for i in range(n):
            _slacken(pose, ask, s, i, max(0.5 * c[P, i], _HANGS))
        s *= 0.5 if ask.c_s > 0.0 else 2.0
    elif attempt > n + 2:
        for i in range(n):
            state, share = _random(state)
            _slacken(pose, ask, s, i, _HANGS * (c[UNIT, i] / _HANGS) ** share)
        state, share = _random(state)
        s *= share if ask.c_s > 0.0 else 1.0 + share
    return s, state


@inner
def _begin_beside(
    pose: Pose, ask: Ask, best: float, out: Answers, at: int, attempt: int, state: np.uint64
) -> tuple[float, np.uint64]:
    """Set the pulls of the answer, but changed; return the guess of s and the next random state.

    First one cable after the other hangs, or is pulled tight; then all are changed at random. Where
    many cables hang, each way in which they share the load has a small neighbourhood only, which
    starts from straight cables miss.
    """
    c = pose.cables
    s = (START_OF_STRAIGHT if best > 0.0 else 1.0 / START_OF_STRAIGHT) * best
    for i in range(c.shape[1]):
        c[P, i] = out.cables[at, i, FORCE_X] / (out.poses[at, WEIGHT] * np.sqrt(c[X2, i]))
    if attempt < 2 * c.shape[1]:
        i = attempt // 2
        _slacken(pose, ask, s, i, _HANGS_DEEP if attempt % 2 == 0 else 0.5 * c[UNIT, i])
        return s, state
    for i in range(c.shape[1]):
        state, share = _random(state)
        _slacken(pose, ask, s, i, c[P, i] * _WIDTH ** (2.0 * share - 1.0))
    return s, state


@inner
def _slacken(pose: Pose, ask: Ask, s: float, i: int, p: float) -> None:
    """Set a pull, above the smallest that the cable has to keep."""
    scaled_c = max(ask.c_0 + s * ask.c_s, 0.0)
    low, low_c = smallest_pull(pose, i)
    least = low + low_c * scaled_c
    pose.cables[P, i] = max(p, _ABOVE_LEAST * least * pose.cables[UNIT, i])


@inner
def _random(state: np.uint64) -> tuple[np.uint64, float]:
    """Return the next state of Marsaglia's xorshift generator and a number from 0 to 1."""
    state ^= state << np.uint64(13)
    state ^= state >> np.uint64(7)
    state ^= state << np.uint64(17)
    return state, float(state >> np.uint64(11)) * 2.0**-53


@inner
def _point_bounds(pose: Pose) -> bool:
    """Tell whether a point mass on as many cables as it has degrees of freedom has no c above zero.

    Without a horizontal load its pulls are p = s λ, with λ as straight cables have it. Strength
    leaves each p a range; if these have no s in common, nothing is left. The lift grows with s, so
    if it is below zero at the largest s, it is so for all.
    """
    c, rows, load = pose.cables, pose.rows, pose.load
    n = c.shape[1]
    if rows.size != n or rows[n - 1] != 2 or load[0] != 0.0 or load[1] != 0.0:
        return False
    least, largest = 0.0, np.inf
    for i in range(n):
        low, high = _range(pose, i)
        share = max(c[STRAIGHT, i], _NOTHING) / (c[SHARE, i] * c[CHORD, i])
        least = max(least, low / share)
        largest = min(largest, high / share)
    if least > largest * (1.0 + _SURELY):
        return True
    lift_of_all, size = 0.0, 0.0
    for i in range(n):
        share = max(c[STRAIGHT, i], _NOTHING) / (c[SHARE, i] * c[CHORD, i])
        up = c[SHARE, i] * _lift_and_top(c, i, largest * share)[0]
        lift_of_all += up
        size += abs(up)
    return bool(lift_of_all < -_SURELY * size)


@inner
def _bounds(pose: Pose, value: FloatArray, pulls: FloatArray, lifts: FloatArray) -> bool:
    """Tell whether a wrench proves that no c above zero is left.

    Pulls and lifts (n, parts + 1) are the same for all wrenches; they are filled where the first
    pull is zero.
    """
    of_load = 0.0
    for k in range(value.size):
        of_load += value[k] * pose.load[pose.rows[k]]
    if not of_load >= 0.0:
        return False
    if pulls[0, 0] == 0.0:
        _divide(pose, pulls, lifts)
    total, size = 0.0, 0.0
    for i in range(pose.cables.shape[1]):
        factor = pose.cables[SHARE, i] / pose.scale[FORCE]
        alpha = along(pose, value, LEVEL, i) * factor
        beta = along(pose, value, LIFT, i) * factor
        largest, p, up = -np.inf, pulls[i, 0], lifts[i, 0]
        for j in range(1, _PARTS + 1):
            before, p_before, p, up = up, p, pulls[i, j], lifts[i, j]
            bound = max(alpha * p_before, alpha * p) + max(beta * before, beta * up)
            largest = max(largest, bound)
        total += largest
        size += abs(largest)
    return bool(total < -_MARGIN * size)


@inner
def _divide(pose: Pose, pulls: FloatArray, lifts: FloatArray) -> None:
    """Divide all pulls that the strength of each cable bears into parts; lifts (n, parts + 1)."""
    for i in range(pose.cables.shape[1]):
        low, high = _range(pose, i)
        ratio = (high / low) ** (1.0 / _PARTS)
        for j in range(_PARTS + 1):
            pulls[i, j], lifts[i, j] = low, _lift_and_top(pose.cables, i, low)[0]
            low *= ratio


@inner
def _lift_and_top(c: FloatArray, i: int, p: float) -> tuple[float, float]:
    """Return the upward pull and the top tension of a cable at a pull."""
    length = settled_length(c, i, p)
    _, _, _, v, _, _, t, _, _ = unit_cable(p, length, c[X2, i], c[D, i], c[KAPPA, i])
    return v, t


@inner
def _range(pose: Pose, i: int) -> tuple[float, float]:
    """Return pulls between which lie all those that the strength bears.

    Somewhere a cable is parallel to its chord, and there its tension is pull times chord. From that
    bound downward: the top tension falls, and once the cable is slack it rises.
    """
    c = pose.cables
    strength = c[STRENGTH, i]
    high = strength / c[CHORD, i]
    low = high
    while low > PULL_FLOOR and _lift_and_top(c, i, low)[1] > strength:
        low *= _SHORTER
    if low <= PULL_FLOOR:
        return PULL_FLOOR, high
    borne = low
    for _ in range(_HALVINGS):
        p = 0.5 * (borne + high)
        if _lift_and_top(c, i, p)[1] > strength:
            high = p
        else:
            borne = p
    slack = borne
    while low > PULL_FLOOR and _lift_and_top(c, i, low)[1] <= strength:
        slack = low
        low *= _SHORTER
    low = max(low, PULL_FLOOR)
    for _ in range(_HALVINGS):
        p = 0.5 * (slack + low)
        if _lift_and_top(c, i, p)[1] > strength:
            low = p
        else:
            slack = p
    return low, high
