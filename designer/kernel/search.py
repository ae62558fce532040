"""Other branches of a pose: the interior point from many starts, for what the quick way left.

Cables that sag are no convex matter: a cable may hang as a counterweight or be pulled tight, and
each way can be a branch of its own. What is tried: straight cables' pulls; those with one cable
after the other hanging; all cables with half of their pull or hanging; pulls drawn at random
between hanging and the strength, the same in every run; the best of these with one cable after the
other hanging or pulled tight, and with all its pulls changed at random. An answer replaces what was
there if it is better and its residuals say that it holds; the search proves nothing of what it does
not find. Of 2265 random poses of random robots 13 ended more than 0.1 % thicker than the best of
300 random starts, the worst by a half.

Before any start it is tried to prove that **no finite cable** holds a pose that is to be sized, by
`designer.kernel.relaxation`; of what is left open after it, all starts are tried, each until it has
an end or is given up.
"""

from __future__ import annotations

import numpy as np

from designer.arrays import FloatArray
from designer.kernel.answer import FORCE_X, LOAD_FACTOR, NO_FINITE_CABLE, SOLVED, WEIGHT, Answers
from designer.kernel.calling import CableFigures, Situation
from designer.kernel.compiling import inner, kernel
from designer.kernel.interior import (
    MOST_ITERATIONS,
    PATIENCE,
    START_OF_STRAIGHT,
    Scratch,
    climb,
    new_scratch,
    pull_straight,
)
from designer.kernel.linear import copy, solve_small
from designer.kernel.pose import (
    FORCE,
    OPTIMAL_WITHIN,
    SIZE,
    UNIT,
    Ask,
    Pose,
    asked,
    limit_sag,
    new_pose,
    place,
    smallest_pull,
    store,
)
from designer.kernel.redundant import KEPT_PULLS, massless
from designer.kernel.relaxation import (
    HALVINGS,
    hanging,
    is_proved_by,
    misses_loads,
    new_body,
    pulls_borne,
)
from designer.kernel.simplex import new_programme
from designer.kernel.table import CHORD, LEVEL, LIFT, SHARE, STRAIGHT, X2, D, P

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
_SURELY = 1e-8
_NOTHING = 1e-300
_ABOVE_LEAST = 1.1


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
    body = new_body(m, n)
    sizing = inverse_weight[0] < 0.0
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
        elif out.verdict[at] == NO_FINITE_CABLE or (sizing and misses_loads(pose, body)):
            out.verdict[at] = NO_FINITE_CABLE
            continue
        state = np.uint64(_RANDOM_SEED)
        # Of redundant cables the first two have been tried where nothing was found.
        first = 2 if best == -np.inf and straight_c > 0.0 and n > m else 0
        n_starts = n + 3 + _RANDOM_STARTS
        for attempt in range(first, n_starts + 2 * n + _RANDOM_BESIDE):
            if attempt < n_starts:
                s, state = _begin(pose, ask, straight_c, attempt, state)
            elif best > -np.inf:
                s, state = _begin_beside(pose, ask, best, out, at, attempt - n_starts, state)
            else:
                break
            if np.isnan(s):
                continue
            keep = KEPT_PULLS[1 if attempt == 1 else 0]
            best = _better(pose, ask, s, keep, scratch, straight_c, best, out, at)
            # Nor does the section that is asked for hold then, within its strength.
            is_failed = best == -np.inf and not sizing
            if is_failed and is_proved_by(pose, body, scratch.dual, attempt > first):
                break


@inner
def _better(
    pose: Pose,
    ask: Ask,
    s: float,
    keep: float,
    scratch: Scratch,
    straight_c: float,
    best: float,
    out: Answers,
    at: int,
) -> float:
    """Climb from the pulls in `pose` and a guess of s; store what is better and return the best."""
    patience = PATIENCE if best == -np.inf else MOST_ITERATIONS
    s, gap = climb(pose, ask, s, keep, patience, scratch)
    if not gap <= OPTIMAL_WITHIN or not (s > best + _BETTER * abs(s) or best == -np.inf):
        return best
    before, of_pose, of_cables = out.verdict[at], out.poses[at].copy(), out.cables[at].copy()
    c = (ask.c_0 + s * ask.c_s) / (pose.scale[SIZE] / pose.scale[FORCE])
    if store(out, at, pose, c, gap, straight_c, ask.c_s > 0.0) == SOLVED:
        return s
    out.verdict[at] = before
    copy(of_pose, out.poses[at])
    for i in range(of_cables.shape[0]):
        copy(of_cables[i], out.cables[at, i])
    return best


@inner
def _begin(
    pose: Pose, ask: Ask, straight_c: float, attempt: int, state: np.uint64
) -> tuple[float, np.uint64]:
    """Set the pulls that an attempt starts from; return the guess of s and the next random state.

    First twice straight cables, then one cable after the other hanging, NaN for one that hung
    before; then all cables with half of their pull, then random ones.
    """
    c = pose.cables
    n = c.shape[1]
    s = START_OF_STRAIGHT * straight_c if straight_c > 0.0 else _LIGHT
    if ask.c_s == 0.0:
        s = -1.0
    pull_straight(pose, ask, s)
    if attempt >= 2 and attempt < n + 2:
        before = c[P, attempt - 2]
        _slacken(pose, ask, s, attempt - 2, _HANGS)
        if c[P, attempt - 2] == before:
            s = np.nan
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
        low, high = pulls_borne(pose, i, HALVINGS)
        share = max(c[STRAIGHT, i], _NOTHING) / (c[SHARE, i] * c[CHORD, i])
        least = max(least, low / share)
        largest = min(largest, high / share)
    if least > largest * (1.0 + _SURELY):
        return True
    lift_of_all, size = 0.0, 0.0
    for i in range(n):
        share = max(c[STRAIGHT, i], _NOTHING) / (c[SHARE, i] * c[CHORD, i])
        up = c[SHARE, i] * hanging(c, i, largest * share)[0]
        lift_of_all += up
        size += abs(up)
    return bool(lift_of_all < -_SURELY * size)
