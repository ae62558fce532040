r"""A point mass on three cables: one unknown, and bounds from corners, which hold in large boxes.

Level forces balance by themselves where the pulls are p_i = s μ_i, with the vectors e_i from the
platform to the exit points, seen from above, and μ_1 = e_2 × e_3, and so on in a circle: for any
three vectors of the plane Σ μ_i e_i = 0. μ is linear in the position, so its range is that at the
corners. What is left is one equation, with c the load over weight per length,

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

from designer.arrays import FloatArray
from designer.kernel.compiling import inner
from designer.kernel.unit_cable import unit_cable
from designer.proof.enclosure.cable import enclose, rough_length
from designer.proof.enclosure.interval import (
    Interval,
    add,
    around,
    multiply,
    point,
    scale,
    square,
    subtract,
)
from designer.proof.enclosure.tables import EX, EY, EZ, Boxes, Scene, Work, get

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
