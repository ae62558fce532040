"""Statics and sizing of many poses of a robot with as many cables as degrees of freedom.

In a pose the unknowns are the pull p and the unstrained length l of each cable, and, when sizing,
the inverse weight c = 1/w. With cables of unit weight (see `unit_cable`) the platform's balance,
Riehl et al., ICRA 2010, eq. (9), is linear in c:

    Σᵢ ωᵢ (pᵢ eᵢ, vᵢ; moments) = c · load

eᵢ is the horizontal vector from attachment to exit point, ωᵢ the cable's weight relative to w.
Each cable's length is eliminated by its closure, so a Newton step is one n × n solve with two
right-hand sides: the step at c = 0 and the change per c. Sizing then takes the largest c, hence
the lightest cable, for which every linearised top tension stays within the strength length.
"""

from __future__ import annotations

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.kernel.answer import (
    LOAD_FACTOR,
    MASSLESS_TENSION,
    NO_FINITE_CABLE,
    SOLVED,
    TOLERANCE,
    Answers,
    judge,
    write_cable,
    write_pose,
)
from designer.kernel.calling import CableFigures, Situation
from designer.kernel.compiling import element, inner, kernel
from designer.kernel.lanes import (
    CLOSURE,
    GOAL,
    HIGHEST,
    LOAD,
    LOWEST,
    OVERLOAD,
    POSE_ROWS,
    PULL,
    REACH,
    RESIDUAL,
    REST,
    SCALE,
    STEP,
    C,
    advance,
    aim_at_strength,
    approach,
    assemble,
    first_guess,
    lanes_of,
    linearise,
    place,
    put_cables,
)
from designer.kernel.linear import are_below, fill, solve_lanes, solve_small
from designer.kernel.pose import closing_length, new_pose
from designer.kernel.pose import place as place_pose
from designer.kernel.table import (
    CHORD,
    KAPPA,
    L_0,
    LANE_ROWS,
    LANES,
    LEVEL,
    LEVER,
    LIFT,
    SHARE,
    STRAIGHT,
    STRENGTH,
    X2,
    D,
    L,
    P,
    T,
    V,
    condensed,
)
from designer.kernel.unit_cable import PULL_FLOOR, unit_cable

_ATTEMPTS = ((5, 1e-6, 0.0), (12, 1e-6, 0.0), (60, 1e-11, 0.0), (120, 1e-11, 30.0))
"""Iterations, relative step at which Newton stops, and lightness of the start of each attempt; only
the poses that fail go on to the next one. Newton converges quadratically, so as a rule a step of
1e-6 leaves an error near 1e-12."""
_VECTOR = 4
"""Lanes that a processor computes at once: a block of fewer poses has no more lanes than these."""
_ON_BOUNDARY = 1e-12
"""Compression over the largest tension that is rounding: the pose is on the hull's boundary."""
_SINGULAR = 1e12
"""Tension of straight cables over the load: beyond, they leave some wrench without tension."""
_SURELY = 1e-8
"""Relative: what a proof that no finite cable is left has to be clear by, beside rounding."""
_NOTHING = 1e-300
_HALVINGS = 60


@kernel
def solve_range(
    start: int,
    stop: int,
    situation: Situation,
    figures: CableFigures,
    inverse_weight: FloatArray,
    out: Answers,
) -> None:
    """Solve the poses from `start` to `stop`: all quickly, then the failed ones again.

    A negative `inverse_weight` (1 or n_poses,) asks for the largest instead.
    """
    n, rows = situation.attachments.shape[0], situation.rows
    sizing = inverse_weight[0] < 0.0
    pending = np.arange(start, stop)
    for iterations, step, lightness in _ATTEMPTS:
        failed, width = 0, min(LANES, -(-pending.size // _VECTOR) * _VECTOR)
        cables = np.empty((n, LANE_ROWS, width))
        A = np.empty((n + 1, n + 2, width))
        poses = np.empty((POSE_ROWS, width))
        for first in range(0, pending.size, width):
            lane = lanes_of(pending, first, width)
            place(cables, poses, situation, lane)
            put_cables(cables, figures, lane)
            for j in range(width):
                poses[GOAL, j] = inverse_weight[lane[j] if inverse_weight.size > 1 else 0]
            _solve_block(cables, A, poses, rows, sizing, iterations, step, lightness)
            evaluate(cables)
            check(poses, cables, rows)
            for j in range(width):  # balanced with cables lighter still than those asked for
                if not sizing and poses[C, j] != poses[GOAL, j]:
                    poses[RESIDUAL, j] = np.inf
            _store(out, cables, poses, lane, sizing)
            for j in range(min(width, pending.size - first)):
                # Negated, so that NaN counts as failed.
                if not poses[RESIDUAL, j] <= TOLERANCE:
                    pending[failed] = lane[j]
                    failed += 1
        pending = pending[:failed]
        if failed == 0:
            break


@inner
def _solve_block(
    cables: FloatArray,
    A: FloatArray,
    poses: FloatArray,
    rows: IntArray,
    sizing: bool,
    iterations: int,
    smallest_step: float,
    lightness: float,
) -> None:
    """Newton on one placed block.

    With `lightness` above zero it starts from cables lighter by that factor, which are nearly
    straight, and lets them grow heavier step by step.
    """
    n = cables.shape[0]
    for iteration in range(iterations):
        if iteration > 0:
            linearise(cables)
        assemble(A, cables, poses, rows)
        solve_lanes(A, n, n + 2)
        if sizing:
            aim_at_strength(poses, A, cables)
        if iteration == 0:
            for j in range(poses.shape[1]):
                poses[C, j] = poses[GOAL, j] + lightness * abs(poses[GOAL, j])
            first_guess(cables, A, poses)
            fill(poses[STEP], 0.0)
        else:
            approach(poses, lightness > 0.0)
            advance(cables, A, poses)
            if are_below(poses[STEP], smallest_step):
                break


@inner
def evaluate(cables: FloatArray) -> None:
    """Put the true pull, top tension and closure error of the state into the cable rows."""
    for i in range(cables.shape[0]):
        row = cables[i]
        for j in range(cables.shape[2]):
            F, _, F_l, v, _, _, t, _, _ = unit_cable(
                row[P, j], row[L, j], row[X2, j], row[D, j], row[KAPPA, j]
            )
            row[V, j] = v
            row[T, j] = t
            # A cable stretched through zero length closes too, with a negative tension.
            row[L_0, j] = abs(F / F_l) if t > 0.0 else np.inf


@inner
def check(poses: FloatArray, cables: FloatArray, rows: IntArray) -> None:
    """Compute the residuals of closure and of the platform's balance, and the worst overload.

    The balance in the components `rows`, moments over the reach of the attachments, ends in row
    `REST`.
    """
    for j in range(poses.shape[1]):
        poses[SCALE, j] = abs(poses[C, j]) * _size_of_force(poses, j)
        poses[REACH, j] = 1e-300
        poses[CLOSURE, j] = poses[RESIDUAL, j] = poses[OVERLOAD, j] = poses[HIGHEST, j] = 0.0
        poses[LOWEST, j] = np.inf
    for m in rows:
        for j in range(poses.shape[1]):
            poses[REST + m, j] = -poses[C, j] * poses[LOAD + m, j]
        for i in range(cables.shape[0]):
            row = cables[i]
            for j in range(poses.shape[1]):
                poses[REST + m, j] += row[SHARE, j] * (
                    row[LEVEL + m, j] * row[P, j] + row[LIFT + m, j] * row[V, j]
                )
    for i in range(cables.shape[0]):
        row = cables[i]
        for j in range(poses.shape[1]):
            poses[SCALE, j] = max(poses[SCALE, j], row[SHARE, j] * row[T, j])
            poses[REACH, j] = max(poses[REACH, j], row[LEVER, j])
            poses[CLOSURE, j] = max(poses[CLOSURE, j], row[L_0, j])
            poses[RESIDUAL, j] = max(poses[RESIDUAL, j], row[L_0, j] / row[L, j])
            burst = row[T, j] / row[STRENGTH, j] if row[P, j] >= PULL_FLOOR else np.inf
            poses[OVERLOAD, j] = max(poses[OVERLOAD, j], burst)
            # A singular matrix leaves infinity or NaN in some cables; the sum lets them through.
            straight = row[STRAIGHT, j]
            poses[LOWEST, j] = min(poses[LOWEST, j], straight) + 0.0 * straight
            poses[HIGHEST, j] = max(poses[HIGHEST, j], abs(straight)) + 0.0 * straight
    for j in range(poses.shape[1]):
        force = 0.0
        for m in rows:
            part = abs(poses[REST + m, j])
            force += part if m < 3 else part / poses[REACH, j]
        poses[REST, j] = force
        poses[PULL, j] = _size_of_force(poses, j)
        for axis in range(3, 6):
            poses[PULL, j] += abs(poses[LOAD + axis, j]) / poses[REACH, j]
        # Addition instead of a maximum, because it lets NaN through.
        poses[RESIDUAL, j] += force / poses[SCALE, j]


@element
def _size_of_force(poses: FloatArray, j: int) -> float:
    return float(abs(poses[LOAD, j]) + abs(poses[LOAD + 1, j]) + abs(poses[LOAD + 2, j]))


@inner
def _store(
    out: Answers, cables: FloatArray, poses: FloatArray, lane: IntArray, sizing: bool
) -> None:
    """Write lengths [m] and forces [N] of solved poses; NaN for all others."""
    for j in range(lane.size):
        at, c, overload = lane[j], poses[C, j], poses[OVERLOAD, j]
        verdict = judge(poses[RESIDUAL, j], c, overload, sizing)
        w = write_pose(out, at, verdict, c, poses[CLOSURE, j], poses[REST, j])
        for i in range(cables.shape[0]):
            write_cable(out, at, i, cables[i], j, w)
        closed = poses[RESIDUAL, j] <= TOLERANCE
        is_held = poses[LOWEST, j] >= -_ON_BOUNDARY * poses[HIGHEST, j]
        is_held = is_held and poses[HIGHEST, j] <= _SINGULAR * poses[PULL, j]
        out.poses[at, LOAD_FACTOR] = overload if closed else np.nan
        out.poses[at, MASSLESS_TENSION] = poses[HIGHEST, j] if is_held else np.nan


@kernel
def refuse_points_range(
    start: int,
    stop: int,
    situation: Situation,
    figures: CableFigures,
    out: Answers,
) -> None:
    """Tell of poses of a point mass on as few cables as hold it that no finite cable does.

    Of those from `start` to `stop` that are to be sized and have no answer. Without a horizontal
    load the pulls are p = s λ, with λ as straight cables have it. Strength leaves each p a range;
    where these have no s in common, no cable is left. The lift grows with s: where it is below zero
    at the largest s, it is so for all.
    """
    n = situation.attachments.shape[0]
    pose = new_pose(situation, figures)
    c, system, pull = pose.cables, np.empty((n, n + 1)), np.empty(n)
    for at in range(start, stop):
        if out.verdict[at] == SOLVED:
            continue
        place_pose(pose, situation, figures, at)
        if pose.rows[n - 1] != 2 or pose.load[0] != 0.0 or pose.load[1] != 0.0:
            continue
        for k in range(n):
            row = pose.rows[k]
            system[k, n] = pose.load[row]
            for i in range(n):
                system[k, i] = c[LEVEL + row, i] + c[LIFT + row, i] * c[D, i]
        if not solve_small(system, pull):
            continue
        least, largest, smallest_s, largest_s = np.inf, -np.inf, 0.0, np.inf
        for i in range(n):
            low, high = _pulls_borne(c, i)
            share = max(pull[i], _NOTHING)
            smallest_s, largest_s = max(smallest_s, low / share), min(largest_s, high / share)
            least, largest = min(least, pull[i]), max(largest, pull[i])
        lift, size = 0.0, 0.0
        for i in range(n):
            p = largest_s * max(pull[i], _NOTHING)
            length = closing_length(p, c[X2, i], c[D, i], c[KAPPA, i], 3)
            up = c[SHARE, i] * condensed(p, length, c[X2, i], c[D, i], c[KAPPA, i])[2]
            lift += up
            size += abs(up)
        is_empty = smallest_s > largest_s * (1.0 + _SURELY)
        if least >= -_SURELY * largest and (is_empty or lift < -_SURELY * size):
            out.verdict[at] = NO_FINITE_CABLE


@inner
def _pulls_borne(c: FloatArray, i: int) -> tuple[float, float]:
    """Return the smallest and the largest pull that the strength of a cable bears.

    Somewhere a cable is parallel to its chord, and there its tension is pull times chord. From that
    bound downward the top tension, which is convex, falls, and once the cable is slack it rises.
    Where the tangents at both ends of a bracket of its least value cross above the strength, no
    pull is borne: infinity and zero.
    """
    strength = c[STRENGTH, i]
    low, high = PULL_FLOOR, strength / c[CHORD, i]
    t_low, slope_low = _top_tension(c, i, low)
    t_high, slope_high = _top_tension(c, i, high)
    borne = low if t_low <= strength else high if t_high <= strength else 0.0
    slack, tight = low, high
    for _ in range(_HALVINGS if borne == 0.0 else 0):
        crossing = (t_high - t_low + slope_low * slack - slope_high * tight) / (
            slope_low - slope_high
        )
        if slope_low >= 0.0 or t_low + slope_low * (crossing - slack) > strength:
            return np.inf, 0.0
        p = np.sqrt(slack * tight)
        t, slope = _top_tension(c, i, p)
        if t <= strength:
            borne = p
            break
        if slope > 0.0:
            tight, t_high, slope_high = p, t, slope
        else:
            slack, t_low, slope_low = p, t, slope
    if borne == 0.0:
        return low, high
    for side in range(2):
        inside, outside = borne, low if side == 0 else high
        if _top_tension(c, i, outside)[0] > strength:
            for _ in range(_HALVINGS):
                p = 0.5 * (inside + outside)
                if _top_tension(c, i, p)[0] > strength:
                    outside = p
                else:
                    inside = p
        if side == 0:
            low = outside
        else:
            high = outside
    return low, high


@element
def _top_tension(c: FloatArray, i: int, p: float) -> tuple[float, float]:
    length = closing_length(p, c[X2, i], c[D, i], c[KAPPA, i], 3)
    _, _, _, _, t, slope, _ = condensed(p, length, c[X2, i], c[D, i], c[KAPPA, i])
    return t, slope
