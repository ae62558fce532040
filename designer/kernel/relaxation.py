"""That **no finite cable** holds a pose, whatever the section and the internal forces: a proof.

Strength leaves each cable a range of pulls p, and with them its lift v is given. Let pull and lift
be anything in the convex hull of what they can be: what the cables then can do is a convex body.
If c · load meets it for no c ≥ 0, no cable holds the pose, and some wrench y tells them apart:

    y · load ≥ 0,    Σᵢ max gᵢ < 0,    gᵢ(p) = y · Wᵢ(p) = α p + β v(p)

It is sought from the body's points: of those found so far the mixture nearest to the loads leaves a
rest, the next y, and the point farthest along y is the next (Wolfe, Finding the nearest point in a
polytope, Mathematical Programming 11 (1976)). Where this ends without a proof, the hull may be too
wide, of cables that could either hang or be pulled tight: the range of the cable whose lift is
farthest from its own is cut in two, and each part is to be proved, from those points of the last
that lie in it, up to some number of parts.

Whoever found y, the sum is bounded from above. Neither v nor g is concave or convex: the maximum of
g is bounded piece by piece of the range, by the ends of each and, where v bends down between them,
by the tangents at both, which are nowhere above the larger end by more than a quarter of the
piece times their difference in slope. In doubles, with a margin.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.kernel.compiling import element, inner
from designer.kernel.cone import Cone, new_cone, normalise, product, reach, restart
from designer.kernel.linear import copy
from designer.kernel.pose import FORCE, Pose, along, closing_length
from designer.kernel.table import CHORD, KAPPA, LEVEL, LIFT, SHARE, STRENGTH, X2, D, condensed
from designer.kernel.unit_cable import PULL_FLOOR

_PIECES = 64
_MARGIN = 1e-3
"""Of what is bounded piece by piece: a lift may bend both ways in one."""
_MOST_PARTS = 32
_MOST_TURNS = 40
_STILL = 1e-3
"""Of the squared distance from the loads: what a further point has to bring it nearer by."""
_NEAR = 1e-4
"""Scaled distance from the loads below which there is no proof."""
_LEAST_PART = 0.1
"""Of the pieces of a range, in each of the two that it is cut into."""
_SHORTER = 0.7
HALVINGS = 40
_FEW_HALVINGS = 12
"""Where the range may be a little wider than what the strength bears."""


class CableRanges(NamedTuple):
    """Arrays for what the cables can do.

    Parameters
    ----------
    pulls, lifts, bulges : array (n, pieces + 1)
        Ends of the pieces of each cable's range, and how much the lift may exceed both ends of the
        piece before, or fall short of them.
    cone : Cone
        First the loads, turned round, then the points that were found; with a one each, of which
        the mixture is to have one in all.
    ends : array (1 + turns, n)
        Which ends of pieces each point is made of.
    cuts : array (most parts, 2, n)
        First and last end of the ranges in each part that is yet to be proved.
    wrench : array (m,)
        What may tell them apart.
    """

    pulls: FloatArray
    lifts: FloatArray
    bulges: FloatArray
    cone: Cone
    ends: IntArray
    cuts: IntArray
    wrench: FloatArray


@inner
def new_body(m: int, n: int) -> CableRanges:
    """Return the arrays for n cables in m equations."""
    return CableRanges(
        np.zeros((n, _PIECES + 1)),
        np.zeros((n, _PIECES + 1)),
        np.zeros((n, _PIECES + 1)),
        new_cone(m + 1, 1 + _MOST_TURNS),
        np.zeros((1 + _MOST_TURNS, n), dtype=np.int64),
        np.zeros((_MOST_PARTS + 1, 2, n), dtype=np.int64),
        np.zeros(m),
    )


@inner
def misses_loads(pose: Pose, body: CableRanges) -> bool:
    """Tell whether it is proved that no c above zero is left."""
    _divide(pose, body)
    parts, n_points = 1, 1
    for _ in range(_MOST_PARTS):
        n_points, is_proved = _approach(pose, body, parts - 1, n_points)
        if is_proved:
            parts -= 1
        elif _cut(pose, body, parts - 1, n_points):
            parts += 1
        else:
            return False
        if parts == 0:
            return True
    return False


@inner
def is_proved_by(pose: Pose, body: CableRanges, dual: FloatArray, is_divided: bool) -> bool:
    """Tell whether the multipliers that a start ended with prove it; divides first if need be."""
    if not is_divided:
        _divide(pose, body)
    for k in range(dual.size):
        body.wrench[k] = -dual[k]
    return normalise(body.wrench) < np.inf and _is_apart(pose, body, body.cuts[0], 1)


@inner
def _approach(pose: Pose, body: CableRanges, part: int, n_points: int) -> tuple[int, bool]:
    """Bring a mixture of points of a part near to the loads; return how many, and if it is proved.

    From those of `n_points` points of other parts that lie in this one.
    """
    cone, wrench, cut = body.cone, body.wrench, body.cuts[part]
    m = wrench.size
    cone.load[:], cone.rays[0] = 0.0, 0.0
    cone.load[m] = 1.0
    for k in range(m):
        wrench[k] = pose.load[pose.rows[k]]
        cone.rays[0, k] = -wrench[k]
    normalise(cone.rays[0])
    n_points = _keep(body, cut, n_points)
    restart(cone)
    in_use = reach(cone, n_points, 0)
    if in_use > 0:
        copy(cone.rest[:m], wrench)
        normalise(wrench)
    else:
        n_points, in_use = 1, 0
        restart(cone)
    for turn in range(n_points, 1 + _MOST_TURNS):
        if _is_apart(pose, body, cut, turn):
            return turn, True
        ahead = product(cone.rest, cone.rays[turn])
        normalise(cone.rays[turn])
        in_use = reach(cone, turn + 1, in_use)
        far = product(cone.rest, cone.rest)
        if in_use < 0 or (turn > 1 and ahead < _STILL * far) or far < _NEAR**2:
            return turn + 1, False
        copy(cone.rest[:m], wrench)
        normalise(wrench)
    return 1 + _MOST_TURNS, False


@inner
def _keep(body: CableRanges, cut: IntArray, n_points: int) -> int:
    """Keep the points that lie in a part and bear on the mixture; return how many are left."""
    kept = 1
    for j in range(1, n_points):
        is_inside = body.cone.share[j] > 0.0
        for i in range(cut.shape[1]):
            is_inside = is_inside and cut[0, i] <= body.ends[j, i] <= cut[1, i]
        if is_inside:
            copy(body.cone.rays[j], body.cone.rays[kept])
            for i in range(cut.shape[1]):
                body.ends[kept, i] = body.ends[j, i]
            kept += 1
    return kept


@inner
def _is_apart(pose: Pose, body: CableRanges, cut: IntArray, at: int) -> bool:
    """Tell whether a wrench proves that a part misses the loads; write its farthest point `at`."""
    value, point, m = body.wrench, body.cone.rays[at], body.wrench.size
    of_load, size_of_load = 0.0, 0.0
    for k in range(m):
        of_load += value[k] * pose.load[pose.rows[k]]
        size_of_load += pose.load[pose.rows[k]] ** 2
    if of_load <= 0.0:  # to rounding: it must not be less
        for k in range(m):
            value[k] += (1e-15 - 2.0 * of_load) * pose.load[pose.rows[k]] / size_of_load
    point[:] = 0.0
    point[m] = 1.0
    total, size = 0.0, 0.0
    for i in range(pose.cables.shape[1]):
        factor = pose.cables[SHARE, i] / pose.scale[FORCE]
        alpha = along(pose, value, LEVEL, i) * factor
        beta = along(pose, value, LIFT, i) * factor
        first, last = cut[0, i], cut[1, i]
        g = alpha * body.pulls[i, first] + beta * body.lifts[i, first]
        largest, best, end = -np.inf, g, first
        for j in range(first + 1, last + 1):
            before, g = g, alpha * body.pulls[i, j] + beta * body.lifts[i, j]
            largest = max(largest, max(before, g) + abs(beta) * body.bulges[i, j])
            if g > best:
                best, end = g, j
        total += largest
        size += abs(largest)
        body.ends[at, i] = end
        for k in range(m):
            row = pose.rows[k]
            level, lift = pose.cables[LEVEL + row, i], pose.cables[LIFT + row, i]
            point[k] += factor * (level * body.pulls[i, end] + lift * body.lifts[i, end])
    return bool(total < -_MARGIN * size)


@inner
def _cut(pose: Pose, body: CableRanges, part: int, n_points: int) -> bool:
    """Cut a part where the mixture is farthest from what a cable can do; False if too small."""
    cone, cuts, c = body.cone, body.cuts, pose.cables
    m = body.wrench.size
    whole = 0.0
    for j in range(1, n_points):
        whole += cone.share[j] * cone.rays[j, m]
    widest, cable, at = 0.0, -1, 0
    for i in range(c.shape[1]):
        p, up, lever = 0.0, 0.0, 0.0
        for j in range(1, n_points):
            share = cone.share[j] * cone.rays[j, m] / whole
            p += share * body.pulls[i, body.ends[j, i]]
            up += share * body.lifts[i, body.ends[j, i]]
        first, last = cuts[part, 0, i], cuts[part, 1, i]
        end = np.searchsorted(body.pulls[i, first : last + 1], p) + first
        inset = int(_LEAST_PART * (last - first)) + 1
        end = min(max(end, first + inset), last - inset)
        for k in pose.rows:
            lever += abs(c[LIFT + k, i])
        apart = abs(up - body.lifts[i, end]) * lever * c[SHARE, i]
        if last - first > 2 and apart > widest:
            widest, cable, at = apart, i, end
    if cable < 0:
        return False
    for side in range(2):
        copy(cuts[part, side], cuts[part + 1, side])
    cuts[part, 1, cable] = cuts[part + 1, 0, cable] = at
    return True


@inner
def _divide(pose: Pose, body: CableRanges) -> None:
    """Divide all pulls that the strength of each cable bears into pieces."""
    c = pose.cables
    body.cuts[0, 0], body.cuts[0, 1] = 0, _PIECES
    for i in range(c.shape[1]):
        low, high = pulls_borne(pose, i, _FEW_HALVINGS)
        ratio = (high / low) ** (1.0 / _PIECES)
        for j in range(_PIECES + 1):
            body.pulls[i, j] = low
            low *= ratio
        bulges = body.bulges[i]
        _hang(body.pulls[i], c[X2, i], c[D, i], c[KAPPA, i], body.lifts[i], bulges)
        for j in range(_PIECES, 0, -1):
            width = body.pulls[i, j] * (1.0 - 1.0 / ratio)
            bulges[j] = 0.25 * width * abs(bulges[j] - bulges[j - 1])


@inner
def _hang(
    p: FloatArray, X2: float, D: float, kappa: float, lift: FloatArray, slope: FloatArray
) -> None:
    """Fill upward pulls and their slopes at many pulls of a cable: alone, so that it vectorises."""
    for j in range(p.size):
        lift[j], slope[j], _ = _hanging(p[j], X2, D, kappa)


@element
def hanging(c: FloatArray, i: int, p: float) -> tuple[float, float, float]:
    """Return the upward pull at a pull, its slope, and the top tension; to 1e-9."""
    return _hanging(p, c[X2, i], c[D, i], c[KAPPA, i])


@element
def _hanging(p: float, X2: float, D: float, kappa: float) -> tuple[float, float, float]:
    length = closing_length(p, X2, D, kappa, 1)
    _, _, lift, slope, tension, _, _ = condensed(p, length, X2, D, kappa)
    return lift, slope, tension


@inner
def pulls_borne(pose: Pose, i: int, halvings: int) -> tuple[float, float]:
    """Return pulls between which lie all those that the strength bears.

    Somewhere a cable is parallel to its chord, and there its tension is pull times chord. From that
    bound downward: the top tension falls, and once the cable is slack it rises.
    """
    c = pose.cables
    strength = c[STRENGTH, i]
    high = strength / c[CHORD, i]
    low = high
    while low > PULL_FLOOR and hanging(c, i, low)[2] > strength:
        low *= _SHORTER
    if low <= PULL_FLOOR:
        return PULL_FLOOR, high
    slack, high = _halve(c, i, low, high, halvings)
    while low > PULL_FLOOR and hanging(c, i, low)[2] <= strength:
        slack = low
        low *= _SHORTER
    return _halve(c, i, slack, max(low, PULL_FLOOR), halvings)[1], high


@inner
def _halve(
    c: FloatArray, i: int, borne: float, beyond: float, halvings: int
) -> tuple[float, float]:
    """Bring a pull that the strength bears and one that it does not nearer to each other."""
    for _ in range(halvings):
        p = 0.5 * (borne + beyond)
        if hanging(c, i, p)[2] > c[STRENGTH, i]:
            beyond = p
        else:
            borne = p
    return borne, beyond
