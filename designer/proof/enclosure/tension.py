"""Bounds on tensions over a box in which an equilibrium exists: its middle, slopes, and corners."""

from __future__ import annotations

import numpy as np

from designer.arrays import FloatArray
from designer.kernel.compiling import inner
from designer.kernel.linear import copy
from designer.proof.enclosure.interval import (
    Interval,
    absolute,
    add,
    down,
    middle,
    multiply,
    negate,
    point,
    root,
    scale,
    size,
    square,
    up,
)
from designer.proof.enclosure.sag import bound_sag
from designer.proof.enclosure.tables import (
    BOUND,
    CABLE,
    ESTIMATE,
    EX,
    EY,
    EZ,
    PULL,
    SPARE,
    T_P,
    TOLD,
    Boxes,
    L,
    Scene,
    T,
    V,
    Work,
    get,
)

_STEEPEST = 1e8
"""Slope of a chord that stands for all steeper ones, which sag less."""


@inner
def along(work: Work, i: int, d: int, first: int) -> Interval:
    """Return the slope of v (first = V) or t (T) of a cable in a coordinate, its pull held."""
    s, a, row = work.slope[i, :, d], work.mean[i], work.cable[i]
    one, two = multiply(get(s[EX]), get(a[EX])), multiply(get(s[EY]), get(a[EY]))
    X2 = scale(add(one, two), 2.0)
    return add(multiply(get(row[first + 2]), X2), multiply(get(row[first + 3]), get(s[EZ])))


@inner
def _upward(work: Work, i: int, what: int) -> Interval:
    """Return v, or its slope, of the lower end of a cable: of the base, -l - v."""
    row = work.cable[i]
    v, length = get(row[V + what]), get(row[L + what])
    return v if work.at[i, EZ, 0] >= 0.0 else negate(add(v, length))


@inner
def level_square(work: Work, i: int) -> Interval:
    """Enclose the square of a cable's level force."""
    a = work.at[i]
    X2 = add(square(get(a[EX])), square(get(a[EY])))
    return multiply(square(get(work.cable[i, PULL])), X2)


@inner
def lowest(work: Work, i: int) -> Interval:
    """Enclose the square of the least tension anywhere in a cable.

    It is at the lower end, or in the lowest point, where the force is level.
    """
    lift = _upward(work, i, 0)
    return add(level_square(work, i), square((max(lift[0], 0.0), max(lift[1], 0.0))))


@inner
def _is_across(work: Work, i: int) -> bool:
    """Tell whether it is not known which end of a cable is lower.

    The square of the level force then stands for that of the least tension, which is no smaller.
    """
    return bool(work.at[i, EZ, 0] < 0.0 <= work.at[i, EZ, 1])


@inner
def _lowest_slope(work: Work, i: int, d: int) -> Interval:
    """Enclose the slope of that square in a coordinate (d ≥ 0), or in its own pull (-1)."""
    row, s, a = work.cable[i], work.slope[i, :, d], work.at[i]
    p, dp = get(row[PULL]), point(1.0 if d < 0 else work.P[i, d])
    X2 = add(square(get(a[EX])), square(get(a[EY])))
    total = scale(multiply(multiply(p, X2), dp), 2.0)
    dX2, dD = point(0.0), point(0.0)
    if d >= 0:
        b = work.mean[i]
        one, two = multiply(get(s[EX]), get(b[EX])), multiply(get(s[EY]), get(b[EY]))
        dX2, dD = scale(add(one, two), 2.0), get(s[EZ])
        total = add(total, multiply(square(p), dX2))
    if _is_across(work, i):
        return total
    lift = _upward(work, i, 0)
    lift = scale((max(lift[0], 0.0), max(lift[1], 0.0)), 2.0)
    change = multiply(_upward(work, i, 1), dp)
    change = add(change, multiply(_upward(work, i, 2), dX2))
    change = add(change, multiply(_upward(work, i, 3), dD))
    return add(total, multiply(lift, change))


@inner
def _most_sag(work: Work, i: int) -> float:
    """Bound the sag of a cable over its chord."""
    a = work.at[i]
    X2 = add(square(get(a[EX])), square(get(a[EY])))
    slope = down(absolute(get(a[EZ]))[0] / root(X2)[1])
    across, below = bound_sag(work.cable[i, PULL, 0], min(max(slope, 0.0), _STEEPEST))
    return across if _upward(work, i, 0)[0] >= 0.0 else max(across, below)


@inner
def _rise(scene: Scene, boxes: Boxes, at: int, work: Work, slope_u: float, i: int) -> tuple[
    float, float, int
]:  # fmt: skip
    """Return how far something grows over the box at most, at its corners, and at which of them.

    Of slopes that lie `work.spread` around `work.tilt`, and `slope_u` at most in the own pull.
    """
    k = work.tilt.size
    half, corners = boxes.half[at], boxes.corners[at]
    flat, spread = 0.0, 0.0
    for d in range(k):
        spread = up(spread + up(work.spread[d] * half[d]))
        if d >= 2:
            flat = up(flat + up(abs(work.tilt[d]) * half[d]))
    for j in range(work.U.size):
        spread = up(spread + up(up(slope_u * abs(work.Z[i, j])) * work.U[j]))
    best, worst_corner = -np.inf, 0
    for c in range(corners.shape[0]):
        a = scale(point(work.tilt[0]), corners[c, 0])
        value = add(a, scale(point(work.tilt[1]), corners[c, 1]))[1]
        if value > best:
            best, worst_corner = value, c
    rounding = up(scene.fuzz * up(abs(work.tilt[0]) + abs(work.tilt[1])))
    at_corner = up(best + flat)
    return up(up(at_corner + spread) + rounding), at_corner, worst_corner


@inner
def _set_tilt(work: Work, d: int, slope: Interval, factor: float) -> None:
    work.tilt[d] = factor * middle(slope)
    spread = max(slope[1] - middle(slope), middle(slope) - slope[0])
    work.spread[d] = up(spread)


@inner
def bound_tension(scene: Scene, boxes: Boxes, at: int, work: Work, out: FloatArray) -> None:
    """Set the bound and the estimate; leave the former infinite where limits are missed.

    These are the least tension and the sag.
    """
    n, k = work.P.shape
    worst, estimate, is_tight, spare = 0.0, -np.inf, True, np.inf
    for i in range(n):
        t_p = get(work.cable[i, T_P])
        for d in range(k):
            slope = add(scale(t_p, work.P[i, d]), along(work, i, d, T))
            _set_tilt(work, d, slope, 1.0)
        rise, at_corner, worst_corner = _rise(scene, boxes, at, work, size(t_p), i)
        highest = up(work.start_t[i] + rise)
        if not highest <= worst:
            worst = highest
            out[CABLE] = i
        if work.start_t[i] + at_corner > estimate:
            estimate = work.start_t[i] + at_corner
            copy(boxes.corners[at, worst_corner], out[TOLD : TOLD + 2])
            for d in range(2, k):
                out[TOLD + d] = boxes.half[at, d] if work.tilt[d] > 0.0 else -boxes.half[at, d]
        if scene.least > 0.0:
            for d in range(k):
                _set_tilt(work, d, _lowest_slope(work, i, d), -1.0)
            fall, _at, _where = _rise(scene, boxes, at, work, size(_lowest_slope(work, i, -1)), i)
            least = up(scene.least * scene.least)
            start = work.start_low[i, 1 if _is_across(work, i) else 0]
            left = down(start - fall)
            is_tight = is_tight and left >= least
            spare = min(spare, 0.5 * (left / least - 1.0))
        if scene.sag < np.inf:
            highest = _most_sag(work, i)
            is_tight = is_tight and highest <= scene.sag
            spare = min(spare, scene.sag / highest - 1.0)
    out[SPARE] = spare
    out[ESTIMATE] = estimate / scene.strength
    if is_tight and worst < np.inf:
        out[BOUND] = min(out[BOUND], up(worst / scene.strength))
