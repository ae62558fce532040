r"""Enclosures of an elastic cable of unit weight, over intervals of its pull and of its ends.

As in `designer.kernel.unit_cable`: with the pull p (horizontal force per horizontal distance X and
weight per length), the drop D, the unstrained length l and κ = w/EA,

    θ = (1/p - κ l) / 2      S = (sinh θ / θ)²      C = θ coth θ      A = C/θ      r = 1 + κ l/(2 θ)
    y = l A / 2              q = 1 / (1 + κ y)      1/p = 2 θ r

    closure:       l² = D² q² + X² S / r²
    upward pull:   v = D q A / 2 - l / 2
    top tension:   t = y + |D| q / 2

What is proved of it, for p > 0 and 0 < κ l < 1/p:

1. The closure has one root l. With growing l its left side grows; θ falls, hence X² S/r² =
   4 p² X² sinh² θ falls, and y = l coth θ / 2 grows, hence q falls: the right side falls. At l = 0
   it is above the left side, at κ l = 1/p, where θ = 0, below.
2. l grows with X² and with |D|, and falls with p. At fixed l the right side grows with the first
   two. With p, θ falls, so q falls; and p sinh θ has the slope sinh θ - cosh θ/(2 p), which is at
   most sinh θ - θ cosh θ < 0, since 1/(2 p) = θ + κ l/2. A right side that grows moves the root up.
   So the length over a box lies between those of two of its corners, and a number is known to be
   above the root (below it) where the left side is above the right one (below it).
3. S and C grow with θ, A and 1/(θ² S) = 1/sinh² θ fall.

The slopes follow from the closure, with the total slope of the right side in p and l,

    y_p = l r²/S   y_l = A/2 + κ l/(4 θ² S)   n = 2 l + 2 D² κ q³ y_l + κ A X² S/r²
    l_p = -(2 D² κ q³ y_p + 2 X² S (C - 1 + κ y)/(r² p)) / n
    l_X² = S/(r² n)                            l_D = 2 D q²/n

    v_p  = D q²/2 (2 r²/S - κ l_p/2) - l_p/2   v_X² = -(1 + κ q² D/2) l_X²/2
    v_D  = q A/2 - (1 + κ q² D/2) l_D/2        t_·  = (1 - κ q² |D|/2)(y_p + y_l l_·) + q sign(D)/2

(y_p in t_p alone, and the last term in t_D alone). All terms of n and of l_p have one sign.

How far cables sag is bounded from their pull and the slope m of their chord. Of a rigid cable with
θ = 1 / (2 p) and c = √(1 + m²),

    sag over chord = (C √(S + m²) + m log((m + c) √S / (m + √(S + m²))) - c) / (2 θ c²),
    depth below its lower end over chord = (C √(S + m²) - m θ - 1) / (2 θ c),

the latter where the lowest point lies between the ends: `designer.kernel.least_pull` without its
inverse functions. Both fall as the pull grows and as the chord gets steeper; a cable that stretches
sags less. So the smallest pull and the flattest chord of a box bound all of it.
"""

from __future__ import annotations

import math

from designer.kernel.compiling import inner
from designer.kernel.unit_cable import PULL_FLOOR, sag_series, unit_cable
from designer.proof.enclosure.interval import (
    Interval,
    absolute,
    add,
    divide,
    down,
    multiply,
    negate,
    point,
    root,
    scale,
    sign,
    square,
    subtract,
    up,
)

_DOUBLINGS = 6
_SMALL = 0.5
"""θ after halving; then what the series leaves out is less than its last term times x/100."""
LARGEST_THETA = _SMALL * 2.0**_DOUBLINGS
_TERMS = 12
_NUMERATORS = tuple(2.0 ** (2 * k + 1) for k in range(1, _TERMS + 1))
# Factorials up to 26! are below 2⁹⁰, yet not all are doubles: rounded ones are divided outward.
_DENOMINATORS = tuple(float(math.factorial(2 * k + 2)) for k in range(1, _TERMS + 1))
_NEWTONS = 4
_MARGINS = (1e-14, 1e-12, 1e-9)


@inner
def sag(theta: float) -> tuple[Interval, Interval]:
    """Return S and C - 1 at one θ, 0 < θ ≤ 32.

    R = (S - 1)/θ² by its Taylor series, 2^(2k+1) θ^(2k-2) / (2k+2)!, at θ/64, whose rest is below
    the last term, then by doubling: R(2θ) = (R + S²)/4. C - 1 = θ² (1 - R/S)/(C + 1), since
    C² = θ² + 1/S.
    """
    small = theta / 2.0**_DOUBLINGS  # exact
    x = square(point(small))
    r = point(0.0)
    for k in range(_TERMS - 1, -1, -1):
        denominator = _DENOMINATORS[k]
        term = down(_NUMERATORS[k] / up(denominator)), up(_NUMERATORS[k] / down(denominator))
        r = (term[0], up(2.0 * term[1])) if k == _TERMS - 1 else add(term, multiply(x, r))
    for _ in range(_DOUBLINGS):
        s = add(point(1.0), multiply(x, r))
        r = scale(add(r, square(s)), 0.25)
        x = scale(x, 4.0)
    s = add(point(1.0), multiply(x, r))
    c = root(add(x, divide(point(1.0), s)))
    rest = divide(subtract(s, r), s)
    return s, divide(multiply(x, rest), add(c, point(1.0)))


@inner
def _closure(length: float, p: float, X2: float, D: float, kappa: float) -> Interval:
    """Return right less left side of the closure, at numbers; NaN where κ l is not below 1/p."""
    at = point(length)
    stretched = scale(at, kappa)
    theta = scale(subtract(divide(point(1.0), point(p)), stretched), 0.5)
    if not (theta[0] > 0.0 and theta[1] <= LARGEST_THETA):
        return math.nan, math.nan
    S_low, C_low = sag(theta[0])
    S_high, C_high = sag(theta[1])
    S, C = (S_low[0], S_high[1]), add(point(1.0), (C_low[0], C_high[1]))
    y = divide(multiply(at, C), scale(theta, 2.0))
    q = divide(point(1.0), add(point(1.0), scale(y, kappa)))
    g = divide(scale(theta, 2.0), divide(point(1.0), point(p)))
    right = add(square(scale(q, D)), multiply(scale(S, X2), square(g)))
    return subtract(right, square(at))


@inner
def rough_length(p: float, X2: float, D: float, kappa: float) -> float:
    """Return the length nearly, by Newton from that of a rigid cable."""
    theta2 = 0.25 / (p * p)
    length = math.sqrt(D * D + X2 * (1.0 + theta2 * sag_series(theta2)))
    length /= 1.0 + kappa * p * length
    for _ in range(_NEWTONS):
        F, _1, F_l, _2, _3, _4, _5, _6, _7 = unit_cable(p, length, X2, D, kappa)
        length -= F / F_l
    return length


@inner
def _length(p: float, X2: float, D: float, kappa: float, side: float) -> float:
    """Return a number proved to be above (side 1) or below (-1) the length; NaN where none was."""
    length = rough_length(p, X2, D, kappa)
    for margin in _MARGINS:
        trial = length * (1.0 + side * margin)
        rest = _closure(trial, p, X2, D, kappa)
        if (side > 0.0 and rest[1] <= 0.0) or (side < 0.0 and rest[0] >= 0.0 and trial > 0.0):
            return trial
    return math.nan


@inner
def enclose(
    p: Interval, X2: Interval, D: Interval, kappa: float
) -> tuple[bool, Interval, Interval, Interval, Interval, Interval, Interval, Interval, Interval,
           Interval, Interval, Interval, Interval]:  # fmt: skip
    """Return whether it worked, then l, v and t, each with its slopes in p, X² and D.

    Parameters
    ----------
    p : Interval
        Pull.
    X2, D : Interval
        Squared horizontal distance [m²], and drop from exit point to attachment point [m].
    kappa : float
        Weight per length over axial stiffness [1/m].

    Returns
    -------
    worked : bool
        False where the pull is below `PULL_FLOOR`, or the cable has no length somewhere.
    l, l_p, l_X2, l_D, v, v_p, v_X2, v_D, t, t_p, t_X2, t_D : Interval
        Per weight per length. They hold everywhere in the box.
    """
    nan = point(math.nan)
    failed = (False, nan, nan, nan, nan, nan, nan, nan, nan, nan, nan, nan, nan)
    if not (p[0] >= PULL_FLOOR and p[1] < math.inf):
        return failed
    unit, high = point(1.0), absolute(D)
    length = (
        _length(p[1], X2[0], high[0], kappa, -1.0),
        _length(p[0], X2[1], high[1], kappa, 1.0),
    )
    if not (length[0] > 0.0 and length[1] < math.inf):
        return failed
    theta = scale(subtract(divide(unit, p), scale(length, kappa)), 0.5)
    if not (theta[0] > 0.0 and theta[1] <= LARGEST_THETA):
        return failed
    S_low, C1_low = sag(theta[0])
    S_high, C1_high = sag(theta[1])
    S, C1 = (S_low[0], S_high[1]), (C1_low[0], C1_high[1])
    A_low = divide(add(unit, C1_high), point(theta[1]))
    A_high = divide(add(unit, C1_low), point(theta[0]))
    A = A_low[0], A_high[1]
    B_low = divide(unit, multiply(square(point(theta[1])), S_high))
    B_high = divide(unit, multiply(square(point(theta[0])), S_low))
    B = B_low[0], B_high[1]
    r = add(unit, divide(scale(length, kappa), scale(theta, 2.0)))
    r2 = square(r)
    across = divide(S, r2)  # (2 p sinh θ)²
    steep = divide(r2, S)
    y = scale(multiply(length, A), 0.5)
    q = divide(unit, add(unit, scale(y, kappa)))
    q2 = square(q)
    y_p = multiply(length, steep)
    y_l = add(scale(A, 0.5), scale(scale(multiply(length, B), kappa), 0.25))
    K = multiply(X2, across)
    bend = scale(scale(multiply(square(D), multiply(q2, q)), kappa), 2.0)
    n = add(scale(length, 2.0), add(multiply(bend, y_l), scale(multiply(A, K), kappa)))
    slack = add(C1, scale(y, kappa))
    l_p = negate(divide(add(multiply(bend, y_p), divide(scale(multiply(K, slack), 2.0), p)), n))
    l_X2 = divide(across, n)
    l_D = divide(scale(multiply(D, q2), 2.0), n)
    Dq2 = multiply(D, q2)
    half = scale(add(unit, scale(scale(Dq2, kappa), 0.5)), 0.5)
    qA = scale(multiply(q, A), 0.5)
    v = subtract(multiply(D, qA), scale(length, 0.5))
    lift = subtract(scale(steep, 2.0), scale(scale(l_p, kappa), 0.5))
    v_p = subtract(scale(multiply(Dq2, lift), 0.5), scale(l_p, 0.5))
    v_X2 = negate(multiply(half, l_X2))
    v_D = subtract(qA, multiply(half, l_D))
    t = add(y, scale(multiply(high, q), 0.5))
    part = subtract(unit, scale(scale(multiply(high, q2), kappa), 0.5))
    t_p = multiply(part, add(y_p, multiply(y_l, l_p)))
    t_X2 = multiply(part, multiply(y_l, l_X2))
    t_D = add(multiply(part, multiply(y_l, l_D)), scale(multiply(q, sign(D)), 0.5))
    return True, length, l_p, l_X2, l_D, v, v_p, v_X2, v_D, t, t_p, t_X2, t_D


_LOG_MARGIN = 2.0**-50
"""Relative and absolute: more than the last place, which a logarithm is good to."""


@inner
def bound_sag(p: float, slope: float) -> tuple[float, float]:
    """Return bounds on sag across and below over chord, pulls ≥ p > 0 and slopes ≥ slope ≥ 0."""
    theta = up(0.5 / p)
    if not theta <= LARGEST_THETA:
        return math.inf, math.inf
    S, C1 = sag(theta)
    m = point(slope)
    chord, reach = root(add(point(1.0), square(m))), root(add(S, square(m)))
    high = multiply(add(point(1.0), C1), reach)
    ratio = divide(multiply(add(m, chord), root(S)), add(m, reach))[1]
    turn = up(up(math.log(ratio) * (1.0 + _LOG_MARGIN)) + _LOG_MARGIN)
    across = up(up(high[1] + up(slope * turn)) - chord[0])
    below = up(up(high[1] - down(slope * theta)) - 1.0)
    twice = 2.0 * theta
    return (
        up(across / down(twice * square(chord)[0])),
        up(below / scale(chord, twice)[0]),
    )
