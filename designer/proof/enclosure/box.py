r"""Does a cable hold in a whole box of poses: existence of an equilibrium, and a bound on tensions.

Let x be the coordinates of a pose as seen from the middle of the box, |x_k| ≤ h_k, and F(p, x) the
balance of the platform where the cables pull by p, with lengths that close them (see `cable`).
Pulls are tried that follow the pose, and are mended by as many numbers u as there are balanced
directions,

    p(x, u) = p₀ + P x + Z u,      F(x, u) = F(p(x, u), x).

p₀ solves the middle, nearly; Z is such that ∂F/∂u is nearly the identity, and P such that ∂F/∂x is
nearly zero. Where there are more cables than directions, the rest of P is free: internal forces.
None of that has to be exact. Let S and N enclose *slopes from the middle* over the box,

    F(x, u) - F(0, 0) = S x + (1 - N) u      for some S ∈ 𝐒, N ∈ 𝐍, of each x and u.

They are narrower than derivatives, since of each product only one factor changes at a time:
p a - p₀ a₀ = (p - p₀) a₀ + p (a - a₀), of a product of two that are known alike with the mean of
both ends of each; and a cable's force follows its pull where its ends stand in the middle, by the
mean value theorem, then its ends. So

    |u - F(x, u)|_j ≤ |F(0, 0)|_j + Σ_k |𝐒|_jk h_k + Σ_l |𝐍|_jl U_l,    |u_l| ≤ U_l.

If the right side is at most U_j for all j, then u ↦ u - F(x, u) maps the box |u| ≤ U into itself,
for every x; it is continuous, so it has a fixed point (Brouwer), and there F = 0. **So in each pose
of the box there is an equilibrium with pulls p(x, u), |u| ≤ U**: the test of Krawczyk with poses as
parameters. That it is stable, or the only one, is not claimed.

Its tensions have slopes of the same kind; since both residual and slopes' widths shrink with the
box, what this adds to the tension shrinks with the square of it. The linear part is taken at the
corners of what of the box lies in the region.

For a point mass on three cables there is one unknown, and bounds from corners, which hold in large
boxes. Level forces balance by themselves where the pulls are p_i = s μ_i, with the vectors e_i from
the platform to the exit points, seen from above, and μ_1 = e_2 × e_3, and so on in a circle: for
any three vectors of the plane Σ μ_i e_i = 0. μ is linear in the position, so its range is that at
the corners. What is left is one equation, with c the load over weight per length,

    f(s) = Σ v(s μ_i, X_i², D_i) - c = 0.

Where the exit points are above the platform, D ≥ 0, with the slopes that `cable` tells:

1. v grows with p: l_p < 0, so all terms of v_p are positive.
2. v falls with X²: both terms of v_X² are negative, as l_X² > 0.
3. v grows with D: n ≥ 2 l + D² κ q³ A, A ≥ 1, and D q ≤ l by the closure, hence
   q A n ≥ 2 q l + D² κ q⁴ A² ≥ 2 D q² + D² κ q⁴ = (2 + κ q² D) D q², which is v_D ≥ 0.
4. t grows with X² and with D: κ q D q/2 ≤ κ q y < 1, since y = l A/2 ≥ D q/2.

So f is bounded at corners. If f ≤ 0 at s₁ in all of a box and f ≥ 0 at s₂, it has a root between
them in each pose, being continuous; the tensions there are those of pulls from s₁ μ to s₂ μ.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.kernel.compiling import allocating, inner, kernel
from designer.kernel.linear import copy, solve_small
from designer.kernel.unit_cable import unit_cable
from designer.proof.enclosure.cable import bound_sag, enclose, rough_length
from designer.proof.enclosure.interval import (
    Interval,
    absolute,
    add,
    around,
    down,
    middle,
    multiply,
    negate,
    point,
    root,
    scale,
    size,
    square,
    subtract,
    up,
)

# Of a cable over the box: vector to the exit point and lever, by components.
EX, EY, EZ, RX, RY, RZ = range(6)
# Of a cable over the box: l, v and t with their slopes in p, X² and D; then p.
L, L_P, L_X2, L_D, V, V_P, V_X2, V_D, T, T_P, T_X2, T_D, PULL = range(13)
# What is told of a box.
BOUND, ESTIMATE, CUT, CABLE, SPARE = range(5)
TOLD = 5
"""Then, from here on, where in the box the estimate is met, one number a coordinate."""


class Scene(NamedTuple):
    """What is the same of all boxes: of unit weight per length, upright frame."""

    rows: IntArray  #: which components of force and moment, 0 … 5, are balanced
    kappa: float  #: weight over stiffness [1/m]
    strength: float  #: allowable tension over weight [m]
    least: float  #: least tension over weight [m]
    sag: float  #: largest sag over chord; infinite for any
    inverse_weight: float  #: 1 / weight per length [m/N]
    reach: float  #: size of the levers, that moments are measured by; 1 for a point mass [m]
    fuzz: float  #: bound on what rounding did to vectors and levers [m]
    axes: FloatArray  #: (3, 3) how the position moves with each of its three coordinates
    level: float  #: utilisation to be proved


class Boxes(NamedTuple):
    """Boxes of poses (n_boxes,), with three coordinates of position, then three or none of turn."""

    half: FloatArray  #: (n_boxes, k) half of their sizes
    #: (n_boxes, n_corners, 2) corners of what of the box lies in the region, first two coordinates,
    #: from the middle
    corners: FloatArray
    vectors: FloatArray  #: (n_boxes, n, 3) from attachment to exit point, in the middle [m]
    levers: FloatArray  #: (n_boxes, n, 3) from the platform's origin to the attachment there [m]
    turns: FloatArray  #: (n_boxes, n, 3, k - 3) slopes of the levers with the turn there
    load: FloatArray  #: (n_boxes, 6) what the cables have to pull with there [N, N·m]
    load_turns: FloatArray  #: (n_boxes, 3, k - 3) slopes of its moment with the turn
    #: (n_boxes, n + 1) bound on how far slopes of levers, and of the moment, from the middle are
    #: from these
    bent: FloatArray
    pull: FloatArray  #: (n_boxes, n) p₀
    follow: FloatArray  #: (n_boxes, n, k) what P should be, as far as balance lets it


class Work(NamedTuple):
    """Arrays of one box; the last axis of size two holds the ends of intervals."""

    at: FloatArray  # (n, 6, 2)
    start_at: FloatArray  # (n, 6, 2), the same in the middle of the box
    mean: FloatArray  # (n, 6, 2), half the sum of both
    slope: FloatArray  # (n, 6, k, 2), of the same, from the middle
    cable: FloatArray  # (n, 13, 2)
    share: FloatArray  # (n, 2), μ of a point mass on three cables
    level: FloatArray  # (n, 6, 2), wrench of a unit pull
    lift: FloatArray  # (n, 6, 2), wrench of a unit upward pull
    start_level: FloatArray  # (n, 6, 2), the same in the middle of the box
    start_lift: FloatArray  # (n, 6, 2)
    of_x: FloatArray  # (m, k, 2), slopes of the balance
    of_u: FloatArray  # (m, m, 2), identity less slopes
    start: FloatArray  # (m,), size of the balance in the middle
    P: FloatArray  # (n, k)
    Z: FloatArray  # (n, m)
    U: FloatArray  # (m,)
    trial: FloatArray  # (m,)
    G: FloatArray  # (n, m), slopes of the balance in the pulls, moments over the reach
    weight: FloatArray  # (n,), how free the pulls are
    start_t: FloatArray  # (n,), largest tension in the middle
    start_low: FloatArray  # (n, 2), squares of least tension and level force there
    tilt: FloatArray  # (k,), middles of the slopes of a tension
    spread: FloatArray  # (k,), and how far from them the slopes may be
    system: FloatArray  # (m, m + 1)
    solution: FloatArray  # (m,)


@allocating
def new_work(n: int, m: int, k: int) -> Work:
    """Return the arrays for n cables, m balanced directions and k coordinates."""
    return Work(
        np.zeros((n, 6, 2)),
        np.zeros((n, 6, 2)),
        np.zeros((n, 6, 2)),
        np.zeros((n, 6, k, 2)),
        np.zeros((n, 13, 2)),
        np.zeros((n, 2)),
        np.zeros((n, 6, 2)),
        np.zeros((n, 6, 2)),
        np.zeros((n, 6, 2)),
        np.zeros((n, 6, 2)),
        np.zeros((m, k, 2)),
        np.zeros((m, m, 2)),
        np.zeros(m),
        np.zeros((n, k)),
        np.zeros((n, m)),
        np.zeros(m),
        np.zeros(m),
        np.zeros((n, m)),
        np.zeros(n),
        np.zeros(n),
        np.zeros((n, 2)),
        np.zeros(k),
        np.zeros(k),
        np.zeros((m, m + 1)),
        np.zeros(m),
    )


@inner
def get(table: FloatArray) -> Interval:
    """Return an interval (2,) of a table."""
    return table[0], table[1]


@inner
def put(table: FloatArray, a: Interval) -> None:
    """Put an interval into a table."""
    table[0], table[1] = a


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


_STEPS = 4
_BEYOND = 1e-6
"""Relative: by so much a root is left behind before it is proved to lie between."""


@inner
def is_three(scene: Scene, boxes: Boxes, at: int) -> bool:
    """Tell whether a box is one of a point mass on three cables that hangs from level axes."""
    load, axes = boxes.load[at], scene.axes
    return bool(
        scene.rows.size == 3
        and scene.rows[2] == 2  # not a platform in a plane
        and boxes.pull.shape[1] == 3
        and boxes.half.shape[1] == 3
        and load[0] == 0.0
        and load[1] == 0.0
        and axes[0, 2] == 0.0
        and axes[1, 2] == 0.0
    )


@inner
def bound_three(scene: Scene, boxes: Boxes, at: int, work: Work) -> float:
    """Return a bound on the largest tension over weight in a placed box; infinite where none."""
    if not _set_weights(scene, boxes, at, work):
        return math.inf
    middle = 0.0
    for i in range(3):
        if not work.at[i, EZ, 0] >= 0.0:
            return math.inf
        middle += boxes.pull[at, i] / (0.5 * (work.share[i, 0] + work.share[i, 1])) / 3.0
    c = scale(point(-boxes.load[at, 2]), scene.inverse_weight)
    low, high = 0.0, middle
    for side in (-1.0, 1.0):
        low, high = high, _root(scene, work, c, middle, side)
    if not (0.0 < low < high < math.inf):
        return math.inf
    worst = 0.0
    for i in range(3):
        p = (
            multiply(point(low), get(work.share[i]))[0],
            multiply(point(high), get(work.share[i]))[1],
        )
        t = _top_tension(p, _squares(work, i), get(work.at[i, EZ]), scene.kappa)
        worst = t if not t <= worst else worst
    return worst


@inner
def _set_weights(scene: Scene, boxes: Boxes, at: int, work: Work) -> bool:
    """Set the ranges of μ; tell whether all are above zero."""
    share, corners = work.share, boxes.corners[at]
    for i in range(3):
        share[i, 0], share[i, 1] = math.inf, -math.inf
    turn = 0.0
    for c in range(corners.shape[0]):
        for i in range(3):
            x, y = _vector(scene, boxes, at, (i + 1) % 3, corners[c])
            u, w = _vector(scene, boxes, at, (i + 2) % 3, corners[c])
            mu = subtract(multiply(x, w), multiply(y, u))
            if turn == 0.0:
                turn = 1.0 if mu[0] > 0.0 else -1.0
            if turn < 0.0:
                mu = -mu[1], -mu[0]
            share[i, 0] = min(share[i, 0], mu[0])
            share[i, 1] = max(share[i, 1], mu[1])
    return bool(share[0, 0] > 0.0 and share[1, 0] > 0.0 and share[2, 0] > 0.0)


@inner
def _vector(
    scene: Scene, boxes: Boxes, at: int, i: int, corner: FloatArray
) -> tuple[Interval, Interval]:
    """Return the level components of the vector to an exit point from a corner."""
    e, a = boxes.vectors[at, i], scene.axes
    x = e[0] - (a[0, 0] * corner[0] + a[0, 1] * corner[1])
    y = e[1] - (a[1, 0] * corner[0] + a[1, 1] * corner[1])
    return around(x, 2.0 * scene.fuzz), around(y, 2.0 * scene.fuzz)


@inner
def _squares(work: Work, i: int) -> Interval:
    """Return the range of the squared horizontal distance."""
    return add(square(get(work.at[i, EX])), square(get(work.at[i, EY])))


@inner
def _root(scene: Scene, work: Work, c: Interval, start: float, side: float) -> float:
    """Return an s at which f is proved to be of one sign in all of the box; NaN where none was."""
    s = start
    for _ in range(_STEPS):
        f, slope = c[0], 0.0
        for i in range(3):
            X2, D = _squares(work, i), work.at[i, EZ]
            mu = work.share[i, 0] if side > 0.0 else work.share[i, 1]
            wide, drop = (X2[1], D[0]) if side > 0.0 else (X2[0], D[1])
            length = rough_length(s * mu, wide, drop, scene.kappa)
            _F, F_p, F_l, v, v_p, v_l, _t, _tp, _tl = unit_cable(
                s * mu, length, wide, drop, scene.kappa
            )
            f += v
            slope += mu * (v_p - v_l * F_p / F_l)
        s = max(s - f / slope, 0.25 * s)
    s *= 1.0 + side * _BEYOND
    total = c
    for i in range(3):
        X2, D = _squares(work, i), work.at[i, EZ]
        mu = work.share[i, 0] if side > 0.0 else work.share[i, 1]
        wide, drop = (X2[1], D[0]) if side > 0.0 else (X2[0], D[1])
        enclosure = enclose(multiply(point(s), point(mu)), point(wide), point(drop), scene.kappa)
        if not enclosure[0]:
            return math.nan
        total = add(total, enclosure[5])
    if (side > 0.0 and total[0] >= 0.0) or (side < 0.0 and total[1] <= 0.0):
        return s
    return math.nan


@inner
def _top_tension(p: Interval, X2: Interval, D: Interval, kappa: float) -> float:
    """Return a bound on the top tension over a box.

    At the end of the pulls where it is larger, if its slope has one sign; else from its enclosure.
    """
    slope = point(math.nan)
    worst = math.inf
    for turn in range(2):
        at = p
        if turn > 0 and slope[0] >= 0.0:
            at = point(p[1])
        elif turn > 0 and slope[1] <= 0.0:
            at = point(p[0])
        enclosure = enclose(at, point(X2[1]), point(D[1]), kappa)
        if not enclosure[0]:
            return math.inf
        worst, slope = enclosure[9][1], enclosure[10]
    return worst


_MOST_TURNS = 5
_LARGER = 1.1
_HOPELESS = 3.0
"""Growth of U from one turn to the next after which it is given up."""
_NEAR = 1.1
"""Of the level that is asked for: bounds of three cables below which the general one is tried."""


@kernel
def bound_range(start: int, stop: int, scene: Scene, boxes: Boxes, out: FloatArray) -> None:
    """Fill what is told of the boxes `start` to `stop`.

    `BOUND` is a bound on the largest tension over the allowable one in an equilibrium that exists
    in every pose of the box, infinite where none was proved; `ESTIMATE` the same at its corners
    without what encloses it, at the coordinates from `TOLD` on; `CUT` the coordinate to halve,
    `CABLE` the cable that meets the bound, and `SPARE` by how much least tensions and pulls are
    exceeded at least, relative, NaN where that is not known.
    """
    n, k = boxes.follow.shape[1], boxes.half.shape[1]
    work = new_work(n, scene.rows.size, k)
    for at in range(start, stop):
        _bound(scene, boxes, at, work, out[at])


@inner
def _bound(scene: Scene, boxes: Boxes, at: int, work: Work, told: FloatArray) -> None:
    """Fill what is told of a box."""
    told[:] = 0.0
    told[BOUND], told[ESTIMATE], told[SPARE] = np.inf, np.nan, np.nan
    widest = 0
    for d in range(boxes.half.shape[1]):
        widest = d if boxes.half[at, d] > boxes.half[at, widest] else widest
    told[CUT] = widest
    if is_three(scene, boxes, at):
        _place(scene, boxes, at, 1.0, work)
        told[BOUND] = up(bound_three(scene, boxes, at, work) / scene.strength)
        if not scene.level < told[BOUND] < _NEAR * scene.level:
            return
    if not _prepare(scene, boxes, at, work):
        return
    if _exists(scene, boxes, at, work):
        bound_tension(scene, boxes, at, work, told)
    _choose_cut(boxes, at, work, told)


@inner
def _place(scene: Scene, boxes: Boxes, at: int, share: float, work: Work) -> None:
    """Enclose vectors and levers, and their slopes, over a share of the box (0 for its middle)."""
    n, k = work.P.shape
    half = boxes.half[at]
    for i in range(n):
        bent = boxes.bent[at, i]
        for c in range(3):
            reach, turn = scene.fuzz, scene.fuzz
            for d in range(k):
                if d < 3:
                    lever = point(0.0)
                    vector = point(-scene.axes[c, d])
                else:
                    lever = around(boxes.turns[at, i, c, d - 3], share * bent + scene.fuzz)
                    vector = negate(lever)
                put(work.slope[i, EX + c, d], vector)
                put(work.slope[i, RX + c, d], lever)
                reach = up(reach + up(up(share * half[d]) * size(vector)))
                turn = up(turn + up(up(share * half[d]) * size(lever)))
            put(work.at[i, EX + c], around(boxes.vectors[at, i, c], reach))
            put(work.at[i, RX + c], around(boxes.levers[at, i, c], turn))
        if share == 0.0:
            copy(work.at[i].reshape(-1), work.start_at[i].reshape(-1))
        for c in range(6):
            put(work.mean[i, c], scale(add(get(work.at[i, c]), get(work.start_at[i, c])), 0.5))


@inner
def _bend(scene: Scene, boxes: Boxes, at: int, share: float, work: Work) -> bool:
    """Enclose the cables, and their wrenches; tell whether it worked."""
    n, k = work.P.shape
    half = boxes.half[at]
    for i in range(n):
        reach = 0.0
        for d in range(k):
            reach = up(reach + up(up(share * half[d]) * abs(work.P[i, d])))
        for j in range(work.U.size):
            reach = up(reach + up(work.U[j] * abs(work.Z[i, j])))
        p = around(boxes.pull[at, i], reach)
        ex, ey, ez = get(work.at[i, EX]), get(work.at[i, EY]), get(work.at[i, EZ])
        rx, ry, rz = get(work.at[i, RX]), get(work.at[i, RY]), get(work.at[i, RZ])
        enclosure = enclose(p, add(square(ex), square(ey)), ez, scene.kappa)
        worked, length, l_p, l_X2, l_D, v, v_p, v_X2, v_D, t, t_p, t_X2, t_D = enclosure
        if share > 0.0:  # the pull changes first, while the ends stand in the middle
            start = work.start_at[i]
            X2 = add(square(get(start[EX])), square(get(start[EY])))
            enclosure = enclose(p, X2, get(start[EZ]), scene.kappa)
            l_p, v_p, t_p = enclosure[2], enclosure[6], enclosure[10]
            worked = worked and enclosure[0]
        if not worked:
            return False
        row = work.cable[i]
        put(row[L], length)
        put(row[L_P], l_p)
        put(row[L_X2], l_X2)
        put(row[L_D], l_D)
        put(row[V], v)
        put(row[V_P], v_p)
        put(row[V_X2], v_X2)
        put(row[V_D], v_D)
        put(row[T], t)
        put(row[T_P], t_p)
        put(row[T_X2], t_X2)
        put(row[T_D], t_D)
        put(row[PULL], p)
        put(work.level[i, 0], ex)
        put(work.level[i, 1], ey)
        put(work.level[i, 3], negate(multiply(rz, ey)))
        put(work.level[i, 4], multiply(rz, ex))
        put(work.level[i, 5], subtract(multiply(rx, ey), multiply(ry, ex)))
        put(work.lift[i, 2], point(1.0))
        put(work.lift[i, 3], ry)
        put(work.lift[i, 4], negate(rx))
        if share == 0.0:
            copy(work.level[i].reshape(-1), work.start_level[i].reshape(-1))
            copy(work.lift[i].reshape(-1), work.start_lift[i].reshape(-1))
    return True


@inner
def _level_slope(work: Work, i: int, row: int, d: int) -> Interval:
    """Return the slope of a cable's `level` in a coordinate."""
    s, a = work.slope[i, :, d], work.mean[i]
    if row < 2:
        return get(s[row])
    if row == 3:
        return negate(add(multiply(get(s[RZ]), get(a[EY])), multiply(get(a[RZ]), get(s[EY]))))
    if row == 4:
        return add(multiply(get(s[RZ]), get(a[EX])), multiply(get(a[RZ]), get(s[EX])))
    if row == 5:
        moment = add(multiply(get(s[RX]), get(a[EY])), multiply(get(a[RX]), get(s[EY])))
        two = add(multiply(get(s[RY]), get(a[EX])), multiply(get(a[RY]), get(s[EX])))
        return subtract(moment, two)
    return 0.0, 0.0


@inner
def _lift_slope(work: Work, i: int, row: int, d: int) -> Interval:
    if row == 3:
        return get(work.slope[i, RY, d])
    if row == 4:
        return negate(get(work.slope[i, RX, d]))
    return 0.0, 0.0


@inner
def _prepare(scene: Scene, boxes: Boxes, at: int, work: Work) -> bool:
    """Set Z, P, and the balance in the middle; tell whether the middle could be evaluated."""
    n, k = work.P.shape
    m, rows = scene.rows.size, scene.rows
    work.U[:] = 0.0
    for i in range(n):
        copy(boxes.follow[at, i], work.P[i])
    _place(scene, boxes, at, 0.0, work)
    if not _bend(scene, boxes, at, 0.0, work):
        return False
    G, weight = work.G, work.weight
    for j in range(m):
        row = rows[j]
        unit = 1.0 if row < 3 else 1.0 / scene.reach
        rest = scale(point(-boxes.load[at, row]), scene.inverse_weight)
        for i in range(n):
            p, v = get(work.cable[i, PULL]), get(work.cable[i, V])
            level, lift = get(work.level[i, row]), get(work.lift[i, row])
            rest = add(rest, add(multiply(p, level), multiply(v, lift)))
            G[i, j] = unit * (middle(level) + middle(get(work.cable[i, V_P])) * middle(lift))
        work.start[j] = size(rest)
        if row >= 3:  # what rounding did to the arm of the load
            force = abs(boxes.load[at, 0]) + abs(boxes.load[at, 1]) + abs(boxes.load[at, 2])
            work.start[j] = up(work.start[j] + 2.0 * scene.fuzz * force * scene.inverse_weight)
    for i in range(n):
        weight[i] = boxes.pull[at, i] ** 2  # so that slack cables are left nearly alone
        work.start_t[i] = work.cable[i, T, 1]
        work.start_low[i, 0] = lowest(work, i)[0]
        work.start_low[i, 1] = level_square(work, i)[0]
    if not _set_mending(scene, work):
        return False
    _slopes(scene, boxes, at, 0.0, work)
    for d in range(k):
        for i in range(n):
            for j in range(m):
                work.P[i, d] -= work.Z[i, j] * middle(get(work.of_x[j, d]))
    return True


@inner
def _set_mending(scene: Scene, work: Work) -> bool:
    """Set Z = W Gᵀ (G W Gᵀ)⁻¹, column by column; tell whether it worked."""
    G, weight, rows = work.G, work.weight, scene.rows
    n, m = G.shape
    for j in range(m):
        for a in range(m):
            for b in range(m):
                total = 0.0
                for i in range(n):
                    total += G[i, a] * weight[i] * G[i, b]
                work.system[a, b] = total
            work.system[a, m] = 0.0
        work.system[j, m] = 1.0
        if not solve_small(work.system, work.solution):
            return False
        unit = 1.0 if rows[j] < 3 else 1.0 / scene.reach
        for i in range(n):
            total = 0.0
            for a in range(m):
                total += G[i, a] * work.solution[a]
            work.Z[i, j] = weight[i] * total * unit
    return True


@inner
def _slopes(scene: Scene, boxes: Boxes, at: int, share: float, work: Work) -> None:
    """Enclose the slopes of the balance."""
    n, k = work.P.shape
    m, rows = scene.rows.size, scene.rows
    c = scene.inverse_weight
    for j in range(m):
        row = rows[j]
        for d in range(k):
            total = point(0.0)
            if row >= 3 and d >= 3:
                slope = boxes.load_turns[at, row - 3, d - 3]
                bent = share * boxes.bent[at, n] + scene.fuzz
                total = scale(around(-slope, bent), c)
            for i in range(n):
                cable = work.cable[i]
                level, lift = get(work.start_level[i, row]), get(work.start_lift[i, row])
                term = add(
                    scale(level, work.P[i, d]),
                    multiply(get(cable[PULL]), _level_slope(work, i, row, d)),
                )
                if row >= 2 and row < 5:
                    up_slope = add(scale(get(cable[V_P]), work.P[i, d]), along(work, i, d, V))
                    term = add(term, multiply(up_slope, lift))
                    term = add(term, multiply(get(cable[V]), _lift_slope(work, i, row, d)))
                total = add(total, term)
            put(work.of_x[j, d], total)
        for e in range(m):
            total = point(1.0 if e == j else 0.0)
            for i in range(n):
                cable = work.cable[i]
                level, lift = get(work.start_level[i, row]), get(work.start_lift[i, row])
                slope = add(level, multiply(get(cable[V_P]), lift))
                total = subtract(total, scale(slope, work.Z[i, e]))
            put(work.of_u[j, e], total)


@inner
def _exists(scene: Scene, boxes: Boxes, at: int, work: Work) -> bool:
    """Look for U that the map takes into itself."""
    m, k = scene.rows.size, boxes.half.shape[1]
    _place(scene, boxes, at, 1.0, work)
    for turn in range(_MOST_TURNS):
        if not _bend(scene, boxes, at, 1.0, work):
            return False
        _slopes(scene, boxes, at, 1.0, work)
        is_inside, largest = True, 0.0
        for j in range(m):
            total = work.start[j]
            for d in range(k):
                total = up(total + up(size(get(work.of_x[j, d])) * boxes.half[at, d]))
            for e in range(m):
                total = up(total + up(size(get(work.of_u[j, e])) * work.U[e]))
            work.trial[j] = total
            is_inside = is_inside and total <= work.U[j]
            largest = max(largest, total) + 0.0 * total  # a sum where NaN has to get through
        if is_inside:
            return True
        if not largest < 1e300:
            return False
        for j in range(m):
            if turn > 0 and work.trial[j] > _HOPELESS * work.U[j]:
                return False
            work.U[j] = max(_LARGER * work.trial[j], work.U[j])
    return False


@inner
def _choose_cut(boxes: Boxes, at: int, work: Work, out: FloatArray) -> None:
    """Choose the coordinate that adds most to the enclosure, or else that changes pulls most."""
    n, k = work.P.shape
    best = 0.0
    for d in range(k):
        share = 0.0
        if out[BOUND] < np.inf:
            i = int(out[CABLE])
            slope = add(scale(get(work.cable[i, T_P]), work.P[i, d]), along(work, i, d, T))
            share = 0.5 * (slope[1] - slope[0])
            for j in range(work.U.size):
                rest = size(scale(get(work.cable[i, T_P]), work.Z[i, j]))
                share += rest * size(get(work.of_x[j, d]))
        else:
            for i in range(n):
                far = 0.0
                for c in range(3):
                    far += abs(boxes.vectors[at, i, c])
                share += abs(work.P[i, d]) / boxes.pull[at, i]
                for c in range(3):
                    share += size(get(work.slope[i, EX + c, d])) / far
        share *= boxes.half[at, d]
        if share > best:
            best = share
            out[CUT] = d
