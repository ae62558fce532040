r"""Whether taut cables hold a pose: a place to look for an equilibrium, or a proof of none.

Cables are taut if none sags more than allowed and none is below its least tension. That and its
strength leave each cable a range of pulls p, and what it does to the platform is a short, nearly
straight curve: with the lift v(p), its wrench is p · level + v(p) · lift. Around that curve lies a
parallelogram,

    v(p) = v₀ + k p + e,    low ≤ p ≤ high,    below ≤ e ≤ above,

with the secant's slope k. So whether cables can balance c · load is, for these wider bodies, a
linear programme in p and e, with c as large as it can be, and as small. Where it has no point,
some wrench y separates what the cables can do from the load (Farkas' lemma),

    Σᵢ max (y · wrenchᵢ) < c y · load,

which is the proof: no taut cables hold the pose. It is evaluated anew for each y, so that it does
not depend on how y was found. Where there is a point, an equilibrium is sought from there. Where
none is found either, the range of the cable whose curve is farthest from that point is cut in two
at the point's pull, and each part is decided by itself (branch and bound, as in Horst and Tuy,
Global Optimization (1996), chapter 4): with the ranges the bodies shrink, in the square of their
width. As the internal forces have few directions, and the curves are nearly straight, that soon
ends.

Of the lift the values and slopes at some pulls are known. Between two of these it is taken to
differ from the straight line by no more than a quarter of their distance times what both slopes
differ from that of the line, as tangents do, with a margin for what bends both ways there;
`tests/kernel/test_feasible.py` holds that against interval arithmetic. Tensions are bounded by half
of the axial stiffness and by a thousand times what is held or borne: beyond, nothing is claimed.

Over a pulley the exit point follows the cable: its place is solved at each pull, and what is said
above holds for the curve that results. By the tangency the slope of the lift in the pull is that at
a fixed exit point. Where the load on the cables is not vertical, they bow out of the planes of
their pulleys, and turn as the exit point moves: what that makes of force along the horizontal chord
and across it are two curves more, with bodies like that of the lift; slopes are then differences.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from designer.arrays import FloatArray
from designer.kernel.compiling import allocating, element, inner
from designer.kernel.least_pull import least_pull
from designer.kernel.linear import copy, solve_small
from designer.kernel.pose import (
    ASIDE,
    FORCE,
    LEAST,
    LEAST_SLOPE,
    MOST_SLOPE,
    PULLEY,
    SIZE,
    TOWARD,
    Ask,
    Pose,
    closing_length,
    lowest_tension,
)
from designer.kernel.simplex import (
    INFEASIBLE,
    OPTIMAL,
    Programme,
    choose_basis,
    maximise,
    most_violated,
    new_programme,
)
from designer.kernel.table import (
    CHORD,
    EX,
    EY,
    KAPPA,
    LANE_ROWS,
    LEVEL,
    LIFT,
    SHARE,
    STRENGTH,
    X2,
    D,
    condensed,
)

REFUSED, UNDECIDED, FAILED = range(3)

MOST_PARTS, MOST_PARTS_OVER_PULLEYS = 50_000, 5_000
"""Parts that are looked at in one pose; all but a few in ten thousand need fewer than twenty. Over
pulleys, where a part takes ten times as long, a pose is decided several times."""
_DEPTH = 300
_NODES = 9
_MARGIN = 1.2
"""Times the largest distance between straight line and tangents, where these cross half way."""
_SURELY = 1e-9
"""Of all that is added up: what a proof has to be clear by, beside rounding."""
_LARGEST_STRAIN = 0.5
"""A cable that is stretched by more counts as broken."""
_BEYOND = 1e3
_MOST_BORNE = 10.0
"""Of the load, over the tension of a straight cable: a generous bound."""
_OUTWARD = 1e-7
"""Relative, by which ends of a range that are found by iteration are moved outward."""
_JUST_ABOVE = 4e-10
"""The same of the strength: by less than what counts as at the limit, so that ends are answers."""
_TOWARD_MIDDLE = 0.4
_LEAST_SHARE = 0.05
"""Of a range, in logarithms, that is left on either side of a cut."""
_NARROWEST = 1.0 + 1e-9
"""Ratio of the ends of a range that is not cut again."""
_THIN = 1e-9
"""Thickness of a body, over the forces, without which a programme that stalls is tried again."""
_ITERATIONS = 8
_HALVINGS = 30
_TURNS = 60
_TANGENT = 1e-14
"""Angle to the pulley at which a cable leaves it [rad]."""
_STEP = 1e-5
"""Relative, of a difference that gives a slope."""

# Rows of a part's lines: ends of the range, then lift at no pull, slope, what the curve may be
# below and above that line, and those four again for the forces along and across the chord.
LOW, HIGH, REST, SLOPE, BELOW, ABOVE = range(6)
_CURVE_ROWS = 4
_DIRECTIONS = LIFT, LEVEL, ASIDE
"""Wrenches of the curves."""


class Parts(NamedTuple):
    """Arrays for the search of one pose.

    Parameters
    ----------
    ranges : array (depth, 2, n + 1)
        Lowest and highest pull of each cable, and least and largest scaled c, in each part that is
        yet to be decided.
    lines : array (depth, 2 + 4 n_curves, n)
        Bodies of these parts, with the pulls that each of them is for: a part that is cut leaves
        its two all bodies but that of one cable.
    nodes : array (1 + 2 n_curves, n_nodes)
        Pulls of a cable, its lift there, and the slope of that; then of the other curves.
    columns : array (m, (1 + n_curves) n + 1)
        The linear programme as it was written.
    pulls, lifts : array (2, n), (2, n_curves, n)
        Of the point that bears most, then of that which bears least; first row also of the point
        to start from. Beside lifts the values of the other curves.
    borne : array (1,)
        What that point bears, as scaled c.
    wrench : array (m,)
        What may separate cables and load, moments over the reach of the attachments.
    system : array (m, m + 1)
        A system for it, with its right-hand side.
    column : array (rows of the table, 1)
        A cable over its pulley.
    """

    ranges: FloatArray
    lines: FloatArray
    nodes: FloatArray
    columns: FloatArray
    pulls: FloatArray
    lifts: FloatArray
    borne: FloatArray
    wrench: FloatArray
    system: FloatArray
    column: FloatArray


@allocating
def new_parts(m: int, n: int, curves: int = 1) -> tuple[Parts, Programme]:
    """Return the arrays for n cables in m equations, with one curve a cable or three."""
    parts = Parts(
        np.zeros((_DEPTH, 2, n + 1)),
        np.zeros((_DEPTH, 2 + _CURVE_ROWS * curves, n)),
        np.zeros((1 + 2 * curves, _NODES)),
        np.zeros((m, (1 + curves) * n + 1)),
        np.zeros((2, n)),
        np.zeros((2, curves, n)),
        np.zeros(1),
        np.zeros(m),
        np.zeros((m, m + 1)),
        np.zeros((LANE_ROWS, 1)),
    )
    return parts, new_programme(m, (1 + curves) * n)


@element
def _force_scale(pose: Pose, ask: Ask) -> float:
    """Return the tension over w that forces are measured in."""
    c = pose.cables
    if ask.c_s > 0.0:
        return float(pose.scale[FORCE])
    weights = 0.0
    for i in range(c.shape[1]):
        weights += c[SHARE, i] * c[CHORD, i]
    return float(ask.c_0 * pose.scale[FORCE] + weights)


@element
def _least_tension(pose: Pose, i: int, scaled_c: float) -> float:
    """Return the least tension that is asked for in a cable over its weight."""
    return float(scaled_c * pose.scale[FORCE] / pose.scale[SIZE] * pose.cables[LEAST, i])


@inner
def set_ranges(pose: Pose, parts: Parts, ask: Ask, any_strength: bool) -> int:
    """Fill the whole ranges; refused if some cable has none, failed if it can't be told.

    Where c is sought, up to the strength of the cables, or whatever that is.
    """
    c, whole = pose.cables, parts.ranges[0]
    n, force = c.shape[1], _force_scale(pose, ask)
    whole[0, n] = ask.c_0
    whole[1, n] = ask.c_0
    parts.lines[0, LOW] = np.nan  # of another pose
    for i in range(n):
        if pose.radius > 0.0 and np.isnan(c[LEAST_SLOPE, i]):
            return FAILED
        low = _floor(pose, parts, i)
        least = _least_tension(pose, i, ask.c_0)
        if least > 0.0:
            low = _pull_at_least(pose, i, low, least)
        high = _LARGEST_STRAIN / (c[KAPPA, i] * c[CHORD, i]) if c[KAPPA, i] > 0.0 else np.inf
        if ask.c_s > 0.0 and not any_strength:
            strong = _pull_at_strength(pose, i, low)
            if np.isnan(strong):
                return REFUSED
            high = min(high, strong)
        high = min(high, _BEYOND * force / (c[SHARE, i] * c[CHORD, i]))
        if not low < high < np.inf:
            return FAILED
        whole[0, i], whole[1, i] = low, high
        if ask.c_s > 0.0:  # none bears more than its tension along any of the components
            whole[1, n] += _MOST_BORNE * high * c[SHARE, i] * c[CHORD, i] / force
    return UNDECIDED


@inner
def _floor(pose: Pose, parts: Parts, i: int) -> float:
    """Return the least pull for the sag that is allowed; over a pulley by bracketed secants.

    Or, where a cable hangs down on its pulley so steeply that it hardly sags, the least at which it
    still leaves that as a tangent.
    """
    c, column = pose.cables, parts.column
    across, drop = c[X2, i], c[D, i]
    straight = np.sqrt(across)
    low, step, low_before, step_before = 0.0, 0.0, np.nan, np.nan
    under, over = 0.0, np.inf
    for turn in range(_TURNS):
        column[X2, 0], column[D, 0], column[CHORD, 0] = across, drop, np.sqrt(across + drop * drop)
        p = least_pull(pose.least_pulls, column, 0, c[KAPPA, i])
        if pose.radius == 0.0:
            return float(p / (1.0 + _OUTWARD))
        step = p * np.sqrt(across) / straight - low
        if abs(step) <= 1e-3 * _OUTWARD * low:
            break
        share = (low - low_before) / (step_before - step) if turn > 1 else 1.0
        low_before, step_before = low, step
        under, over = (max(under, low), over) if step > 0.0 else (under, min(over, low))
        low += min(max(share, _LEAST_SHARE), 1.0) * step
        if not under < low < over:
            if over < under * (1.0 + _OUTWARD):
                return float(over)
            low = 0.5 * (under + over) if over < np.inf else 2.0 * under
        x, y, drop, _ = _tangent(pose, i, low)
        across = x * x + y * y
    return float(min(low, low + step) / (1.0 + _OUTWARD))


@inner
def _pull_at_least(pose: Pose, i: int, low: float, least: float) -> float:
    """Return the pull from which on the tension is nowhere less; it grows with the pull.

    By Newton, and where that does not settle by halving; it is hardly above what is returned.
    """
    c = pose.cables
    if _least_at(pose, i, low)[0] >= least:
        return low
    p = max((least + 0.5 * abs(c[D, i])) / c[CHORD, i], low)
    for _ in range(_ITERATIONS):
        there, slope = _least_at(pose, i, p)
        step = (there - least) / slope
        p -= step
        if abs(step) < _OUTWARD * p:
            return float(max(p / (1.0 + _OUTWARD), low))
        if not p > low:
            break
    high = 2.0 * low
    while _least_at(pose, i, high)[0] < least:
        low, high = high, 2.0 * high
    for _ in range(_HALVINGS):
        p = 0.5 * (low + high)
        if _least_at(pose, i, p)[0] < least:
            low = p
        else:
            high = p
    return low


@inner
def _least_at(pose: Pose, i: int, p: float) -> tuple[float, float]:
    """Return the least tension anywhere in a cable over its weight, and about its slope."""
    straight = np.sqrt(pose.cables[X2, i])
    length, v, v_p, _, _, X, drop, _, _ = _hang(pose, i, p)
    share = straight / X if pose.radius > 0.0 else 1.0
    tension, slope = lowest_tension(p * share, length, 0.0, v, v_p / share, X * X, drop)
    return tension, slope * share


@inner
def _pull_at_strength(pose: Pose, i: int, low: float) -> float:
    """Return a pull that is hardly above the largest that the strength bears; NaN if there is none.

    The top tension is convex in the pull, and pull times chord at least: Newton comes down to it.
    Over a pulley the slope is about that at a fixed exit point: from both sides.
    """
    c, moves = pose.cables, pose.radius > 0.0
    most = c[STRENGTH, i] / c[CHORD, i] * (1.0 + _OUTWARD)
    while moves and _hang(pose, i, most)[3] < c[STRENGTH, i]:
        most *= 2.0
    p = most
    for _ in range(_ITERATIONS):
        _, _, _, t, t_p, _, _, _, _ = _hang(pose, i, p)
        if not t_p > 0.0:  # past the pull of least tension: all that is known is that it will do
            return float(most if moves else p)
        nearer = p - (t - c[STRENGTH, i]) / t_p
        if nearer < low and not (moves and p > low):
            return np.nan
        before, p = p, max(nearer, low) if moves else min(p, nearer)
        if abs(before - p) < 0.1 * _JUST_ABOVE * p:
            break
    p *= 1.0 + _JUST_ABOVE
    return float(most if moves and _hang(pose, i, p)[3] < c[STRENGTH, i] else p)


@inner
def _hang(
    pose: Pose, i: int, p: float
) -> tuple[float, float, float, float, float, float, float, float, float]:
    """Return length, lift, its slope, top tension, its slope, and distance and drop of the ends.

    At a pull over the distance from where the straight cable leaves; then what of that pull is
    along its chord, beyond the whole, and what is across it.
    """
    c = pose.cables
    across, drop, share, along, aside = c[X2, i], c[D, i], 1.0, 0.0, 0.0
    if pose.radius > 0.0:
        x, y, drop, _ = _tangent(pose, i, p)
        straight, across = across, x * x + y * y
        share = np.sqrt(straight / across)
        turned = p / np.sqrt(straight * across)
        along = turned * (c[EX, i] * x + c[EY, i] * y) - p
        aside = turned * (c[EX, i] * y - c[EY, i] * x)
    length = closing_length(p * share, across, drop, c[KAPPA, i], 1)
    l_0, _, v, v_p, t, t_p, _ = condensed(p * share, length, across, drop, c[KAPPA, i])
    return length + l_0, v, v_p * share, t, t_p * share, np.sqrt(across), drop, along, aside


@inner
def _tangent(pose: Pose, i: int, p: float) -> tuple[float, float, float, float]:
    """Return from where a sagging cable leaves its pulley: vector in plan, drop and slope there.

    A cable that hangs from some point of the rim points past it there, toward where it leaves: so
    that is between where the straight cable would, and where the load would point along the rim.
    By secants, else by halving.
    """
    c, r, up = pose.cables, pose.radius, pose.vertical
    pull = p * np.sqrt(c[X2, i])
    low, high = c[LEAST_SLOPE, i], c[MOST_SLOPE, i]
    slope, before, turn_before = low, np.nan, np.nan
    x, y, drop = np.nan, np.nan, np.nan
    for _ in range(_TURNS):
        out, above = r * (1.0 + np.sin(slope)), r * np.cos(slope)
        x = c[PULLEY, i] + out * c[TOWARD, i] + above * up[0]
        y = c[PULLEY + 1, i] + out * c[TOWARD + 1, i] + above * up[1]
        drop = c[PULLEY + 2, i] + out * c[TOWARD + 2, i] + above * up[2]
        X = np.sqrt(x * x + y * y)
        length = closing_length(pull / X, X * X, drop, c[KAPPA, i], 1)
        l_0, _, v, _, _, _, _ = condensed(pull / X, length, X * X, drop, c[KAPPA, i])
        down, level = length + l_0 + v, pull / X
        falls = level * (x * up[0] + y * up[1]) + down * up[2]
        leads = -level * (x * c[TOWARD, i] + y * c[TOWARD + 1, i]) - down * c[TOWARD + 2, i]
        cos, sin = np.cos(slope), np.sin(slope)
        turn = np.arctan2(falls * cos - leads * sin, falls * sin + leads * cos)
        if abs(turn) < _TANGENT:
            break
        is_beyond = x * c[EX, i] + y * c[EY, i] <= 0.0
        if is_beyond or (turn > 0.0) != (high > low):
            high = slope
        else:
            low = slope
        gain = -1.0 if np.isnan(before) or is_beyond else (turn - turn_before) / (slope - before)
        before, turn_before = slope, turn
        slope -= turn / gain
        if is_beyond or not min(low, high) < slope < max(low, high):
            slope = 0.5 * (low + high)
    return x, y, drop, slope


@inner
def leaving_slope(pose: Pose, i: int, p: float) -> float:
    """Return the angle below the horizontal at which a cable of this pull leaves [rad].

    In the plane of its present chord, in which its direction is as steep along the pulley.
    """
    c, up = pose.cables, pose.vertical
    slope, X = _tangent(pose, i, p)[3], np.sqrt(c[X2, i])
    x = np.sin(slope) * c[TOWARD, i] + np.cos(slope) * up[0]
    y = np.sin(slope) * c[TOWARD + 1, i] + np.cos(slope) * up[1]
    z = np.sin(slope) * c[TOWARD + 2, i] + np.cos(slope) * up[2]
    return float(-np.arctan((x * c[EX, i] + y * c[EY, i]) / (z * X)))


@inner
def _enclose(pose: Pose, parts: Parts, lines: FloatArray, i: int, low: float, high: float) -> bool:
    """Fill the line and the body of a cable between two pulls; False if they can't be told."""
    c, nodes, curves = pose.cables, parts.nodes, parts.lifts.shape[1]
    ratio = (high / low) ** (1.0 / (_NODES - 1))
    p = low
    for j in range(_NODES):
        nodes[0, j] = p
        p *= ratio
    nodes[0, _NODES - 1] = high
    if pose.radius == 0.0:
        _lifts(nodes[0], c[X2, i], c[D, i], c[KAPPA, i], nodes[1], nodes[2])
    for j in range(_NODES if pose.radius > 0.0 else 0):
        p = nodes[0, j]
        _, nodes[1, j], nodes[2, j], _, _, _, _, along, aside = _hang(pose, i, p)
        if curves > 1:
            _, lift_0, _, _, _, _, _, along_0, aside_0 = _hang(pose, i, p * (1.0 - _STEP))
            _, lift_1, _, _, _, _, _, along_1, aside_1 = _hang(pose, i, p * (1.0 + _STEP))
            width = 2.0 * _STEP * p
            nodes[2, j] = (lift_1 - lift_0) / width
            nodes[3, j], nodes[4, j] = along, (along_1 - along_0) / width
            nodes[5, j], nodes[6, j] = aside, (aside_1 - aside_0) / width
    thick = 0.0
    for q in range(curves):
        v, slope, rows = nodes[1 + 2 * q], nodes[2 + 2 * q], _CURVE_ROWS * q
        k = (v[_NODES - 1] - v[0]) / (high - low)
        below, above, away = 0.0, 0.0, 0.0
        for j in range(1, _NODES):
            width = nodes[0, j] - nodes[0, j - 1]
            secant = (v[j] - v[j - 1]) / width
            turns = abs(slope[j - 1] - secant) + abs(slope[j] - secant)
            bulge = _MARGIN * 0.25 * width * turns
            ahead = v[j] - v[0] - k * (nodes[0, j] - low)
            if j == _NODES - 1:
                ahead = 0.0
            below = min(below, min(away, ahead) - bulge)
            above = max(above, max(away, ahead) + bulge)
            away = ahead
        lines[REST + rows, i], lines[SLOPE + rows, i] = v[0] - k * low, k
        lines[BELOW + rows, i], lines[ABOVE + rows, i] = below, above
        thick += above - below
    is_told = thick < np.inf
    lines[LOW, i], lines[HIGH, i] = low if is_told else np.nan, high  # else not to be kept
    return bool(is_told)


@inner
def _lifts(
    p: FloatArray, X2: float, D: float, kappa: float, v: FloatArray, slope: FloatArray
) -> None:
    """Fill lifts and their slopes at many pulls of a cable: alone, so that it vectorises."""
    for j in range(p.size):
        length = closing_length(p[j], X2, D, kappa, 1)
        _, _, v[j], slope[j], _, _, _ = condensed(p[j], length, X2, D, kappa)


@inner
def bound_part(pose: Pose, parts: Parts, part: int, lp: Programme, ask: Ask) -> tuple[int, float]:
    """Decide a part if it can be; else return a point of it, and how far it is from the curves.

    The point goes into the first row of pulls and lifts; its distance is a share of the force
    scale.
    """
    n, box, lines = pose.cables.shape[1], parts.ranges[part], parts.lines[part]
    force = _force_scale(pose, ask)
    if ask.c_s > 0.0 and not _keep_least(pose, box):
        return REFUSED, 0.0
    for i in range(n):
        is_kept = lines[LOW, i] == box[0, i] and lines[HIGH, i] == box[1, i]
        if not is_kept and not _enclose(pose, parts, lines, i, box[0, i], box[1, i]):
            return FAILED, np.inf
    to_force = pose.scale[FORCE] / force
    least_c, largest_c = box[0, n] * to_force, box[1, n] * to_force
    most, least = np.inf, -np.inf
    for side in range(2):
        if side == 1 and most <= largest_c:  # then the point that bears most is one of the part
            break
        sign = 1.0 - 2.0 * side
        status, borne = _bear(pose, parts, lines, lp, sign, force, side, 0.0)
        if status == FAILED:
            status, borne = _bear(pose, parts, lines, lp, sign, force, side, _THIN)
        misses = status == REFUSED or (borne < least_c if side == 0 else -borne > largest_c)
        if misses and _is_apart(pose, parts, lines, least_c, largest_c, force):
            return REFUSED, 0.0
        if status != UNDECIDED:
            return FAILED, np.inf
        most, least = (borne, least) if side == 0 else (most, -borne)
    c = min(most, largest_c)
    if most > c:
        share = min(max((c - least) / max(most - least, 1e-300), 0.0), 1.0)
        for i in range(n):
            parts.pulls[0, i] += (1.0 - share) * (parts.pulls[1, i] - parts.pulls[0, i])
            for q in range(parts.lifts.shape[1]):
                rest = parts.lifts[1, q, i] - parts.lifts[0, q, i]
                parts.lifts[0, q, i] += (1.0 - share) * rest
    parts.borne[0] = c / to_force
    apart = 0.0
    for i in range(n):
        apart = max(apart, _distance(pose, parts, i), _shortage(pose, parts, i, ask))
    return UNDECIDED, apart / force


@inner
def _keep_least(pose: Pose, box: FloatArray) -> bool:
    """Keep to pulls and c between which the least tensions can be kept; False if there are none."""
    n = pose.cables.shape[1]
    for i in range(n if pose.cables[LEAST, 0] > 0.0 else 0):
        box[0, i] = _pull_at_least(pose, i, box[0, i], _least_tension(pose, i, box[0, n]))
        largest_c = _least_at(pose, i, box[1, i])[0] / _least_tension(pose, i, 1.0)
        box[1, n] = min(box[1, n], largest_c * (1.0 + _OUTWARD))
        if not (box[0, i] < box[1, i] and box[0, n] <= box[1, n]):
            return False
    return True


@inner
def _distance(pose: Pose, parts: Parts, i: int) -> float:
    """Return how far the point is from the curves of the cable at its pull, over w."""
    c, farthest = pose.cables, 0.0
    _, lift, _, _, _, _, _, along, aside = _hang(pose, i, parts.pulls[0, i])
    for q in range(parts.lifts.shape[1]):
        lever = 0.0
        for k in pose.rows:
            lever = max(lever, abs(c[_DIRECTIONS[q] + k, i]))
        there = lift if q == 0 else along if q == 1 else aside
        farthest = max(farthest, abs(there - parts.lifts[0, q, i]) * lever)
    return float(farthest * c[SHARE, i])


@inner
def _shortage(pose: Pose, parts: Parts, i: int, ask: Ask) -> float:
    """Return by how much the point is below the least tension of a cable, over w."""
    if ask.c_s == 0.0 or pose.cables[LEAST, i] == 0.0:
        return 0.0
    least = _least_tension(pose, i, parts.borne[0])
    short = least - _least_at(pose, i, parts.pulls[0, i])[0]
    return float(max(short, 0.0) * pose.cables[SHARE, i])


@inner
def _bear(
    pose: Pose,
    parts: Parts,
    lines: FloatArray,
    lp: Programme,
    sign: float,
    force: float,
    row: int,
    thin: float,
) -> tuple[int, float]:
    """Bear as much of the load as the bodies can, or with sign -1 of its opposite.

    Bodies that are ``thin`` count as none. Returns that, over the force scale; refused if they have
    no point at all, failed if the linear programme ends otherwise. The multipliers go into the
    wrench.
    """
    c, table = pose.cables, lp.table
    m, n, curves = lp.basis.size, c.shape[1], parts.lifts.shape[1]
    last = (1 + curves) * n
    for i in range(n):
        unit = force / (c[SHARE, i] * c[CHORD, i])
        lp.room[i] = (lines[HIGH, i] - lines[LOW, i]) / unit
        for q in range(curves):
            thick = lines[ABOVE + _CURVE_ROWS * q, i] - lines[BELOW + _CURVE_ROWS * q, i]
            lp.room[n * (1 + q) + i] = thick / _unit(pose, i, q, force)
    for k in range(m):
        at = pose.rows[k]
        rest = 0.0
        for i in range(n):
            own = c[LEVEL + at, i]
            for q in range(curves):
                rows, direction = _CURVE_ROWS * q, c[_DIRECTIONS[q] + at, i]
                own += direction * lines[SLOPE + rows, i]
                is_thin = lp.room[n * (1 + q) + i] < thin
                unit = 0.0 if is_thin else _unit(pose, i, q, force)
                table[k, n * (1 + q) + i] = direction * unit * c[SHARE, i] / force
                rest -= (
                    direction
                    * (lines[REST + rows, i] + lines[BELOW + rows, i])
                    * c[SHARE, i]
                    / force
                )
            table[k, i] = own / c[CHORD, i]
            rest -= own * lines[LOW, i] * c[SHARE, i] / force
        for j in range(last):
            parts.columns[k, j] = table[k, j]
        parts.columns[k, last] = table[k, last] = lp.slope[k] = -sign * pose.load[at]
        table[k, last + 1] = rest
    if not choose_basis(lp):
        return FAILED, np.nan
    status = maximise(lp)
    if status == INFEASIBLE:
        return REFUSED if _value(parts, lp, most_violated(lp)[0]) else FAILED, np.nan
    if status != OPTIMAL:
        return FAILED, np.nan
    for i in range(n):
        unit = force / (c[SHARE, i] * c[CHORD, i])
        p = min(max(lines[LOW, i] + unit * lp.z[i], lines[LOW, i]), lines[HIGH, i])
        parts.pulls[row, i] = p
        for q in range(curves):
            rows = _CURVE_ROWS * q
            error = lines[BELOW + rows, i] + lp.z[n * (1 + q) + i] * _unit(pose, i, q, force)
            parts.lifts[row, q, i] = lines[REST + rows, i] + lines[SLOPE + rows, i] * p + error
    s_row = 0
    for k in range(m):
        if lp.basis[k] == last:
            s_row = k
    return UNDECIDED if _value(parts, lp, s_row) else FAILED, float(lp.z[last])


@element
def _unit(pose: Pose, i: int, q: int, force: float) -> float:
    """Return what a curve is measured in by the linear programme: lifts are lengths, else pulls."""
    c = pose.cables
    return float(force / (c[SHARE, i] * (1.0 if q == 0 else c[CHORD, i])))


@inner
def _value(parts: Parts, lp: Programme, row: int) -> bool:
    """Fill the wrench with which only one unknown of the basis does work: that of a row."""
    m, system = lp.basis.size, parts.system
    for k in range(m):
        for q in range(m):
            system[k, q] = parts.columns[q, lp.basis[k]]
        system[k, m] = 1.0 if k == row else 0.0
    if not solve_small(system, parts.wrench):
        return False
    size = 0.0
    for k in range(m):
        size += parts.wrench[k] * parts.wrench[k]
    if not 0.0 < size < np.inf:
        return False
    for k in range(m):
        parts.wrench[k] /= np.sqrt(size)
    return True


@inner
def _is_apart(
    pose: Pose, parts: Parts, lines: FloatArray, least_c: float, largest_c: float, force: float
) -> bool:
    """Tell whether the wrench, or its opposite, proves that the part misses the load.

    At all c between two, over the force scale: what is missed is linear in c.
    """
    y = parts.wrench
    for _ in range(2):
        bound, size = _support(pose, lines, y, force)
        of_load = 0.0
        for k in range(y.size):
            of_load += y[k] * pose.load[pose.rows[k]]
        borne = min(least_c * of_load, largest_c * of_load)
        if bound - borne < -_SURELY * (size + abs(borne)):
            return True
        for k in range(y.size):
            y[k] = -y[k]
    return False


@inner
def _support(pose: Pose, lines: FloatArray, y: FloatArray, force: float) -> tuple[float, float]:
    """Return the most work that cables can do with a wrench, and the size of what is added up."""
    c, curves = pose.cables, (lines.shape[0] - 2) // _CURVE_ROWS
    total, size = 0.0, 0.0
    for i in range(c.shape[1]):
        along, rest, rest_size = 0.0, 0.0, 0.0
        for k in range(y.size):
            along += y[k] * c[LEVEL + pose.rows[k], i]
        for q in range(curves):
            rows, beta = _CURVE_ROWS * q, 0.0
            for k in range(y.size):
                beta += y[k] * c[_DIRECTIONS[q] + pose.rows[k], i]
            along += beta * lines[SLOPE + rows, i]
            of_curve = beta * (
                lines[REST + rows, i] + lines[(ABOVE if beta > 0.0 else BELOW) + rows, i]
            )
            rest += of_curve
            rest_size += abs(of_curve)
        work = along * lines[HIGH if along > 0.0 else LOW, i]
        total += (work + rest) * c[SHARE, i] / force
        size += (abs(work) + rest_size) * c[SHARE, i] / force
    return total, size


@inner
def cut_part(pose: Pose, parts: Parts, part: int, ask: Ask, apart: float) -> bool:
    """Cut a part where its point is farthest from what the cables do, if there is a point.

    That is at the point's pull of one of them, or below its c where it is short of a least tension.
    Where it could not be told how far ``apart`` they are, the widest range is cut. False where none
    is left to be cut, or there is no room for one more part.
    """
    ranges, n = parts.ranges, pose.cables.shape[1]
    if part + 1 >= _DEPTH:
        return False
    farthest, axis, at = 0.0, -1, 0.0
    widest = _NARROWEST
    for i in range(n if not apart < np.inf else 0):
        width = ranges[part, 1, i] / ranges[part, 0, i]
        if width > widest:
            widest, axis, at = width, i, np.sqrt(ranges[part, 0, i] * ranges[part, 1, i])
    for i in range(n if apart < np.inf else 0):
        away, short = _distance(pose, parts, i), _shortage(pose, parts, i, ask)
        if away > farthest and ranges[part, 1, i] > _NARROWEST * ranges[part, 0, i]:
            farthest, axis, at = away, i, parts.pulls[0, i]
            middle = np.sqrt(ranges[part, 0, i] * ranges[part, 1, i])
            at *= (middle / at) ** _TOWARD_MIDDLE
        if short > farthest and ranges[part, 1, n] > _NARROWEST * ranges[part, 0, n]:
            farthest, axis = short, n
            at = 0.5 * (ranges[part, 0, n] + parts.borne[0])
    if axis < 0:
        return False
    low, high = ranges[part, 0, axis], ranges[part, 1, axis]
    if axis < n:
        inset = (high / low) ** _LEAST_SHARE
        at = min(max(at, low * inset), high / inset)
    else:
        at = min(max(at, low + _LEAST_SHARE * (high - low)), high - _LEAST_SHARE * (high - low))
    for side in range(2):
        copy(ranges[part, side], ranges[part + 1, side])
    for row in range(parts.lines.shape[1]):
        copy(parts.lines[part, row], parts.lines[part + 1, row])
    ranges[part, 1, axis] = ranges[part + 1, 0, axis] = at
    return True
