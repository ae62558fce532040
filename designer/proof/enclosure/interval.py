"""Intervals (low, high) that enclose: every operation is rounded outward.

In rounding to nearest, x - (φ |x| + η) is no larger than the number below x, and x + (φ |x| + η) no
smaller than the number above, with φ = u (1 + 2 u), u = 2⁻⁵³ and η the smallest number of all
(Rump, Zimmermann, Boldo, Melquiond, BIT 49 (2009), 419-431). Sum, product, quotient and root of
IEEE 754 are off by half a unit in the last place at most, so that the true result lies between.

This holds only as long as the compiler changes nothing, as `designer.kernel.compiling` sees to.
Where there is no true result, such as beyond the largest number, an end is infinite or NaN; whoever
concludes something asks for that.
"""

from __future__ import annotations

import math

from designer.kernel.compiling import inner

Interval = tuple[float, float]

_PHI = 2.0**-53 * (1.0 + 2.0**-52)
_ETA = 5e-324


@inner
def down(x: float) -> float:
    """Return a number below x, the next one as a rule."""
    return x - (_PHI * abs(x) + _ETA)


@inner
def up(x: float) -> float:
    """Return a number above x, the next one as a rule."""
    return x + (_PHI * abs(x) + _ETA)


@inner
def point(x: float) -> Interval:
    """Return a number as an interval."""
    return x, x


@inner
def add(a: Interval, b: Interval) -> Interval:
    """Return a + b."""
    return down(a[0] + b[0]), up(a[1] + b[1])


@inner
def subtract(a: Interval, b: Interval) -> Interval:
    """Return a - b."""
    return down(a[0] - b[1]), up(a[1] - b[0])


@inner
def negate(a: Interval) -> Interval:
    """Return -a."""
    return -a[1], -a[0]


@inner
def multiply(a: Interval, b: Interval) -> Interval:
    """Return a b."""
    w, x, y, z = a[0] * b[0], a[0] * b[1], a[1] * b[0], a[1] * b[1]
    return down(min(w, x, y, z)), up(max(w, x, y, z))


@inner
def scale(a: Interval, factor: float) -> Interval:
    """Return a times a number."""
    x, y = a[0] * factor, a[1] * factor
    return down(min(x, y)), up(max(x, y))


@inner
def divide(a: Interval, b: Interval) -> Interval:
    """Return a / b, of a divisor above zero."""
    x, y = a[0] / (b[0] if a[0] < 0.0 else b[1]), a[1] / (b[1] if a[1] < 0.0 else b[0])
    return down(x), up(y)


@inner
def square(a: Interval) -> Interval:
    """Return a²; not below zero."""
    least = 0.0 if a[0] <= 0.0 <= a[1] else min(abs(a[0]), abs(a[1]))
    largest = max(abs(a[0]), abs(a[1]))
    return max(down(least * least), 0.0), up(largest * largest)


@inner
def root(a: Interval) -> Interval:
    """Return √a, of what of it is not below zero."""
    return max(down(math.sqrt(max(a[0], 0.0))), 0.0), up(math.sqrt(a[1]))


@inner
def absolute(a: Interval) -> Interval:
    """Return |a|."""
    least = 0.0 if a[0] <= 0.0 <= a[1] else min(abs(a[0]), abs(a[1]))
    return least, size(a)


@inner
def sign(a: Interval) -> Interval:
    """Return the sign of a, from -1 to 1 where it is not known: the slopes of |a|."""
    return (1.0 if a[0] > 0.0 else -1.0), (-1.0 if a[1] < 0.0 else 1.0)


@inner
def size(a: Interval) -> float:
    """Return the largest of |a|."""
    return max(-a[0], a[1])


@inner
def around(middle: float, radius: float) -> Interval:
    """Return the numbers that are no farther than `radius` from `middle`."""
    return down(middle - radius), up(middle + radius)


@inner
def middle(a: Interval) -> float:
    """Return about its middle."""
    return 0.5 * (a[0] + a[1])
