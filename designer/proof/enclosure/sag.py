r"""A bound on how far cables sag, from their pull and the slope of their chord.

Of a rigid cable with θ = 1 / (2 p), chord of slope m, S and C as in `cable` and c = √(1 + m²),

    sag over chord = (C √(S + m²) + m log((m + c) √S / (m + √(S + m²))) - c) / (2 θ c²),
    depth below its lower end over chord = (C √(S + m²) - m θ - 1) / (2 θ c),

the latter where the lowest point lies between the ends: `designer.kernel.least_pull` without its
inverse functions. Both fall as the pull grows and as the chord gets steeper; a cable that stretches
sags less. So the smallest pull and the flattest chord of a box bound all of it.
"""

from __future__ import annotations

import math

from designer.kernel.compiling import inner
from designer.proof.enclosure.cable import LARGEST_THETA, sag
from designer.proof.enclosure.interval import (
    add,
    divide,
    down,
    multiply,
    point,
    root,
    scale,
    square,
    up,
)

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
