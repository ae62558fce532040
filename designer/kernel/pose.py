"""One pose with more cables than degrees of freedom: geometry, linearised cables, its answer.

Forces are scaled: over weight per length, and over the strongest cable's strength; moments over the
reach of the attachments.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.kernel.answer import (
    AT_LIMIT,
    LOAD_FACTOR,
    MASSLESS_TENSION,
    TOLERANCE,
    Answers,
    judge,
    write_cable,
    write_pose,
)
from designer.kernel.calling import CableFigures, Situation
from designer.kernel.compiling import allocating, element, inner
from designer.kernel.least_pull import least_pull
from designer.kernel.table import (
    CHORD,
    KAPPA,
    L_0,
    L_P,
    LANE_ROWS,
    LEVEL,
    LEVER,
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
    condense,
    condensed,
    load_of,
    place_cable,
    put_cable,
    straighten,
)
from designer.kernel.unit_cable import PULL_FLOOR, sag_series, unit_cable

# Rows beside those of the table: least tension asked for over relative weight; the pull of a
# straight cable at its strength, the unit in which pulls are measured; and the least pull for the
# sag that is allowed.
LEAST, UNIT, FLOOR = range(LANE_ROWS, LANE_ROWS + 3)
# Second slopes of pull and top tension; least tension anywhere in the cable over its weight, with
# its slopes, where one is asked for; 1 where that sets the smallest pull, 0 where the sag does.
V_PP, T_PP, LOWEST, LOWEST_P, LOWEST_PP, BY_LEAST = range(FLOOR + 1, FLOOR + 7)
# Of the interior point: slack below the strength and above the smallest pull, their multipliers,
# the inverse of the diagonal of the Hessian, right-hand side, coupling with s; then the steps of
# the pull, of both slacks and of both multipliers.
ROOM, HEIGHT, MU_ROOM, MU_HEIGHT, FREEDOM, RHS, COUPLING = range(BY_LEAST + 1, BY_LEAST + 8)
STEP, D_ROOM, D_HEIGHT, D_MU_ROOM, D_MU_HEIGHT = range(COUPLING + 1, COUPLING + 6)
# Of a linear programme: scaled pull at the strength, its change with s, lift at no pull.
TOP, TOP_S, UP = range(D_MU_HEIGHT + 1, D_MU_HEIGHT + 4)
# Scaled wrench per unit of scaled pull, six rows.
WRENCH = UP + 1
# Wrench of a unit pull across the cable's plane, six rows.
ASIDE = WRENCH + 6
# Of a pulley: the vector from the attachment to the exit point, above the pulley's edge; the
# horizontal unit vector toward the attachment; angles below the horizontal of the straight cable
# where it leaves, and of the load on the cable.
PULLEY, TOWARD, LEAST_SLOPE, MOST_SLOPE = ASIDE + 6, ASIDE + 9, ASIDE + 12, ASIDE + 13
_ROWS = ASIDE + 14

OPTIMAL_WITHIN = 1e-6
"""Largest last step, or residual of the optimality conditions, of an answer."""
NOTHING = 1e-9
"""Scaled inverse weight below which straight cables hold nothing."""
_AT_SAG = 1.0 + 1.1e-7
"""Least pull over the pull up to which the sag counts as allowed: the margin of the least pulls."""
_ALONG = 1e-5
"""Relative step of the difference that gives second slopes: the root of rounding, about."""

FORCE, SIZE, REACH = range(3)

_BLOCK = 8
"""Cables that are bent at once."""
# Rows of a block: of the table, given and found; then slope of the length, upward pull and its
# slope, a step ahead.
_GIVEN = (P, X2, D, KAPPA)
_BENT = (L, L_0, L_P, V, V_P, T, T_P, V_PP, T_PP)
_AHEAD = len(_GIVEN) + len(_BENT)
_BLOCK_ROWS = _AHEAD + 3


class Pose(NamedTuple):
    """One pose.

    Parameters
    ----------
    cables : array (rows of the table, n)
        Wrenches of the geometry are those of unscaled forces, their moments over the reach.
    rows : array (m,)
        Which components of force and moment, 0 … 5, are balanced.
    load, rest : array (6,)
        What the cables have to pull with, over its own size; what is left of the balance.
    scale : array (3,)
        Strength of the strongest cable over w [m], size of the load [N], reach of the attachments
        [m].
    least_pulls : array (n_nodes, 2)
        See `designer.kernel.least_pull`.
    radius : float
        Of the pulleys, zero without [m].
    vertical : array (3,)
        Upward unit vector in which the pulleys stand.
    block : array (rows of a block × its cables,)
        Some of the table's rows for a few cables; see `bend`.
    """

    cables: FloatArray
    rows: IntArray
    load: FloatArray
    rest: FloatArray
    scale: FloatArray
    least_pulls: FloatArray
    radius: float
    vertical: FloatArray
    block: FloatArray


class Ask(NamedTuple):
    """What is asked: the largest s, with c = c_0 + s c_s and load factors up to f_0 + s f_s.

    Sizing asks for the largest inverse weight c at load factor 1; a given cable for the smallest
    largest load factor, so s is its negative.
    """

    c_0: float
    c_s: float
    f_0: float
    f_s: float


@allocating
def new_pose(situation: Situation, figures: CableFigures) -> Pose:
    """Return the arrays of a pose."""
    cables = np.zeros((_ROWS, situation.attachments.shape[0]))
    return Pose(
        cables,
        situation.rows,
        np.zeros(6),
        np.zeros(6),
        np.ones(3),
        figures.least_pulls,
        figures.pulley_radius,
        figures.vertical,
        np.zeros(_BLOCK_ROWS * _BLOCK),
    )


@inner
def place(pose: Pose, situation: Situation, figures: CableFigures, at: int) -> None:
    """Fill cables, geometry and load."""
    c, load, scale = pose.cables, pose.load, pose.scale
    reach, size = 0.0, 1e-300
    c[FLOOR] = 0.0
    scale[FORCE] = 0.0
    for i in range(c.shape[1]):
        put_cable(c, i, figures, at, i)
        place_cable(c, i, situation, at, i)
        c[LEAST, i] = figures.least_tension / c[SHARE, i]
        scale[FORCE] = max(scale[FORCE], c[SHARE, i] * c[STRENGTH, i])
        c[UNIT, i] = c[STRENGTH, i] / c[CHORD, i]
        reach = max(reach, c[LEVER, i])
    scale[REACH] = reach = reach if reach > 0.0 else 1.0
    applied = load_of(situation, at)
    for k in range(6):
        load[k] = applied[k]
    for k in range(3, 6):
        load[k] /= reach
        for i in range(c.shape[1]):
            c[LEVEL + k, i] /= reach
            c[LIFT + k, i] /= reach
    for i in range(c.shape[1] if pose.radius > 0.0 else 0):
        _place_pulley(pose, situation, figures, at, i)
    for k in range(6):
        size = max(size, abs(load[k]))
    for k in range(6):
        load[k] /= size
    scale[SIZE] = size


@inner
def _place_pulley(pose: Pose, situation: Situation, figures: CableFigures, at: int, i: int) -> None:
    """Fill what is to be known of a cable that begins at a pulley."""
    c, up, r = pose.cables, pose.vertical, pose.radius
    leaves = situation.exit_points[at if situation.exit_points.shape[0] > 1 else 0, i]
    drop, X2 = 0.0, 0.0
    for k in range(3):
        chord = c[LEVEL + k, i] if k < 2 else c[D, i]
        c[PULLEY + k, i] = chord + figures.pulleys[i, k] - leaves[k]
        drop += c[PULLEY + k, i] * up[k]
    for k in range(3):
        c[TOWARD + k, i] = drop * up[k] - c[PULLEY + k, i]
        X2 += c[TOWARD + k, i] ** 2
    X = np.sqrt(X2)
    for k in range(3):
        c[TOWARD + k, i] /= X
    beyond = X - r
    distance = np.sqrt(beyond * beyond + drop * drop)
    c[LEAST_SLOPE, i] = np.arctan2(drop, beyond) + np.arcsin(r / distance)
    c[MOST_SLOPE, i] = np.arctan2(up[2], -c[TOWARD + 2, i])
    ex, ey = c[LEVEL, i], c[LEVEL + 1, i]
    c[ASIDE, i], c[ASIDE + 1, i], c[ASIDE + 2, i] = -ey, ex, 0.0
    c[ASIDE + 3, i], c[ASIDE + 4, i] = -c[LEVEL + 4, i], c[LEVEL + 3, i]
    c[ASIDE + 5, i] = c[LIFT + 3, i] * ey - c[LIFT + 4, i] * ex


@inner
def limit_sag(pose: Pose) -> None:
    """Let no pull be smaller than allowed; straight, weightless cables may be without any."""
    c = pose.cables
    for i in range(c.shape[1]):
        c[FLOOR, i] = least_pull(pose.least_pulls, c, i, c[KAPPA, i])


@element
def asked(pose: Pose, inverse_weight: float) -> Ask:
    """Return what is asked of a placed pose; a negative inverse weight is to be the largest."""
    if inverse_weight < 0.0:
        return Ask(0.0, 1.0, 1.0, 0.0)
    return Ask(inverse_weight * pose.scale[SIZE] / pose.scale[FORCE], 0.0, 0.0, -1.0)


@element
def along(pose: Pose, value: FloatArray, row: int, i: int) -> float:
    """Return the product of a wrench (m,) with that of a cable in six rows from `row`."""
    total = 0.0
    for k in range(value.size):
        total += value[k] * pose.cables[row + pose.rows[k], i]
    return total


@element
def make_straight(pose: Pose, carried: float) -> None:
    """Straight cables, with this share of their weight at the platform (0 or 1/2)."""
    c = pose.cables
    for i in range(c.shape[1]):
        straighten(c, i, carried)
        c[LOWEST, i] = -carried * abs(c[D, i])
        c[LOWEST_P, i] = c[CHORD, i]


@inner
def linearise(pose: Pose) -> None:
    """Condense each cable's length: pull and top tension as linear functions of the step in p."""
    c = pose.cables
    for i in range(c.shape[1]):
        condense(c, i)
        if c[LEAST, i] > 0.0:
            length = c[L, i] + c[L_0, i]
            c[LOWEST, i], c[LOWEST_P, i] = lowest_tension(
                c[P, i], length, c[L_P, i], c[V, i], c[V_P, i], c[X2, i], c[D, i]
            )


@element
def lowest_tension(
    p: float, length: float, length_p: float, v: float, v_p: float, X2: float, D: float
) -> tuple[float, float]:
    """Return the least tension anywhere in a cable over its weight, and its slope in the pull.

    Where the cable hangs below both of its ends that is the horizontal force, else the tension at
    its lower end. It rises with the pull, ever faster: its tangents never promise too much.
    """
    up, up_p = (v, v_p) if D >= 0.0 else (-length - v, -length_p - v_p)
    if up < 0.0:
        up, up_p = 0.0, 0.0
    tension = np.sqrt(p * p * X2 + up * up)
    if not tension > 0.0:
        return 0.0, np.sqrt(X2 + D * D)
    return tension, (p * X2 + up * up_p) / tension


@element
def settled_length(c: FloatArray, i: int, p: float) -> float:
    """Return the length that closes the cable at this pull."""
    return closing_length(p, c[X2, i], c[D, i], c[KAPPA, i], 3)


@element
def closing_length(p: float, X2: float, D: float, kappa: float, turns: int) -> float:
    """Start from the inextensible cable, and solve the closure by so many turns of Newton."""
    theta = 0.5 / p
    straight = np.sqrt(D**2 + X2 * (1.0 + theta * theta * sag_series(theta * theta)))
    length = straight / (1.0 + kappa * p * straight)
    for _ in range(turns):
        F, _, F_l, _, _, _, _, _, _ = unit_cable(p, length, X2, D, kappa)
        length -= F / F_l
    return float(length)


@inner
def bend(pose: Pose) -> None:
    """Close each cable at its present pull; first and second slopes along the closure."""
    c, block = pose.cables, pose.block
    n = c.shape[1]
    for first in range(0, n, _BLOCK):
        for j in range(_BLOCK):
            i = min(first + j, n - 1)  # the last cable again where there are no more
            for k in range(len(_GIVEN)):
                block[k * _BLOCK + j] = c[_GIVEN[k], i]
        _bend_block(block)
        for j in range(min(_BLOCK, n - first)):
            i = first + j
            for k in range(len(_BENT)):
                c[_BENT[k], i] = block[(len(_GIVEN) + k) * _BLOCK + j]
            if c[LEAST, i] > 0.0:
                p, length_p, v, v_p = c[P, i], c[L_P, i], c[V, i], c[V_P, i]
                ends = c[X2, i], c[D, i]
                lowest = lowest_tension(p, c[L, i] + c[L_0, i], length_p, v, v_p, *ends)
                c[LOWEST, i], c[LOWEST_P, i] = lowest
                step, at = _ALONG * p, _AHEAD * _BLOCK + j
                length_p, v, v_p = block[at], block[at + _BLOCK], block[at + 2 * _BLOCK]
                length = c[L, i] + step * c[L_P, i]
                _, slope = lowest_tension(p + step, length, length_p, v, v_p, *ends)
                c[LOWEST_PP, i] = (slope - c[LOWEST_P, i]) / step


@inner
def _bend_block(block: FloatArray) -> None:
    """Fill the rows `_BENT` of a block, then those from `_AHEAD`.

    All in one array, at distances that the compiler knows, so that it vectorises.
    """
    for j in range(_BLOCK):
        p, X2, D, kappa = block[j], block[_BLOCK + j], block[2 * _BLOCK + j], block[3 * _BLOCK + j]
        length = closing_length(p, X2, D, kappa, 3)
        l_0, l_p, v, v_p, t, t_p, _ = condensed(p, length, X2, D, kappa)
        step = _ALONG * p
        _, m_p, _, u_p, _, s_p, u = condensed(p + step, length + step * l_p, X2, D, kappa)
        v_pp, t_pp = (u_p - v_p) / step, (s_p - t_p) / step
        filled = (length, l_0, l_p, v, v_p, t, t_p, v_pp, t_pp, m_p, u, u_p)
        for k in range(len(filled)):
            block[(len(_GIVEN) + k) * _BLOCK + j] = filled[k]


@element
def write_wrenches(pose: Pose) -> None:
    """Write each cable's scaled wrench per unit of scaled pull, its length following."""
    c = pose.cables
    for i in range(c.shape[1]):
        factor = c[SHARE, i] * c[UNIT, i] / pose.scale[FORCE]
        for k in pose.rows:
            c[WRENCH + k, i] = factor * (c[LEVEL + k, i] + c[LIFT + k, i] * c[V_P, i])


@inner
def choose_bounds(pose: Pose, scaled_c: float) -> None:
    """Tell of each cable whether its least tension or its sag sets its smallest pull.

    Which of them is more, at a scaled c; where any sag is allowed the least tension. It stays so
    for a step: a change within one costs poses near the border.
    """
    c = pose.cables
    for i in range(c.shape[1]):
        c[BY_LEAST, i] = 0.0
        if c[LEAST, i] > 0.0:
            low, low_c = _line_of_least(pose, i)
            is_more = (low + low_c * scaled_c) * c[UNIT, i] >= c[FLOOR, i]
            c[BY_LEAST, i] = 1.0 if is_more or c[FLOOR, i] <= PULL_FLOOR else 0.0


@element
def smallest_pull(pose: Pose, i: int) -> tuple[float, float]:
    """Return the smallest scaled pull and its rise per scaled c, as `choose_bounds` has it."""
    c = pose.cables
    if c[BY_LEAST, i] > 0.0:
        return _line_of_least(pose, i)
    return c[FLOOR, i] / c[UNIT, i], 0.0


@element
def _line_of_least(pose: Pose, i: int) -> tuple[float, float]:
    """Return the line in c that touches the least tension in the cable at the present pull."""
    c, scale = pose.cables, pose.scale
    slope = c[LOWEST_P, i] * c[UNIT, i]
    low_c = c[LEAST, i] * scale[FORCE] / (scale[SIZE] * slope)
    return c[P, i] / c[UNIT, i] - c[LOWEST, i] / slope, low_c


@inner
def _measure(pose: Pose, c: float) -> tuple[float, float, float, float]:
    """Return closure error [m] and over each length, balance error over w [m] and load factor.

    Pull and top tension of every cable are put into its rows. A load factor is infinite where a
    cable is too slack to be evaluated or for its sag, stretched through zero length or below its
    least tension.
    """
    cables, rest = pose.cables, pose.rest
    for k in range(6):
        rest[k] = -c * pose.scale[SIZE] * pose.load[k]
    closure, apart, error, overload = 0.0, 0.0, 0.0, 0.0
    for i in range(cables.shape[1]):
        p, length = cables[P, i], cables[L, i]
        F, _, F_l, v, _, _, t, _, _ = unit_cable(
            p, length, cables[X2, i], cables[D, i], cables[KAPPA, i]
        )
        cables[V, i] = v
        cables[T, i] = t
        for k in pose.rows:
            rest[k] += cables[SHARE, i] * (cables[LEVEL + k, i] * p + cables[LIFT + k, i] * v)
        # Sums instead of maxima where NaN has to get through.
        closure = max(closure, abs(F / F_l)) + 0.0 * F
        apart = max(apart, abs(F / F_l) / length) + 0.0 * F
        lowest, _ = lowest_tension(p, length, 0.0, v, 0.0, cables[X2, i], cables[D, i])
        is_held = (
            p * _AT_SAG >= cables[FLOOR, i]
            and t > 0.0
            and lowest * AT_LIMIT >= c * cables[LEAST, i]
        )
        overload = max(overload, t / cables[STRENGTH, i] if is_held else np.inf)
    for k in pose.rows:
        error += abs(rest[k])
    return closure, apart, error, overload


@inner
def store(
    out: Answers, at: int, pose: Pose, c: float, gap: float, straight_c: float, sizing: bool
) -> int:
    """Write a pose's answer, NaN unless it is solved; return that, or not converged.

    Parameters
    ----------
    c, gap : float
        Inverse weight [m/N], and how far the state is from optimal.
    straight_c : float
        Largest scaled inverse weight of straight cables; none if not above zero.
    sizing : bool
        Whether c was sought or given.
    """
    cables, scale = pose.cables, pose.scale
    closure, apart, error, overload = _measure(pose, c)
    heaviest = abs(c) * scale[SIZE]
    for i in range(cables.shape[1]):
        heaviest = max(heaviest, cables[SHARE, i] * cables[T, i])
    residual = apart + error / heaviest if gap <= OPTIMAL_WITHIN else np.inf
    verdict = judge(residual, c, overload, sizing)
    w = write_pose(out, at, verdict, c, closure, error)
    for i in range(cables.shape[1]):
        write_cable(out, at, i, cables, i, w)
    out.poses[at, LOAD_FACTOR] = overload if residual <= TOLERANCE else np.nan
    write_massless(out, at, pose, straight_c)
    return verdict


@element
def write_massless(out: Answers, at: int, pose: Pose, straight_c: float) -> None:
    """Write the largest tension of straight, weightless cables."""
    massless, scale = 0.0, pose.scale
    for i in range(pose.cables.shape[1]):
        massless = max(massless, pose.cables[STRAIGHT, i])
    to_N = scale[SIZE] / (scale[FORCE] * straight_c) if straight_c > NOTHING else np.nan
    out.poses[at, MASSLESS_TENSION] = massless * to_N
