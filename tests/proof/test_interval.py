"""Every operation encloses all that it may give, and not visibly more: against exact fractions."""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from functools import cache
from importlib.util import module_from_spec, spec_from_file_location
from itertools import product
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from designer.kernel import compiling
from designer.proof.enclosure import interval

Interval = tuple[float, float]

ENDS = (-3.7, -1.0, -0.4, 0.0, 0.3, 1.0, 2.9)
INTERVALS = [(low, high) for low, high in product(ENDS, ENDS) if low <= high]


@cache
def operations() -> ModuleType:
    """Return the module without its decorator: Python rounds as the compiled code does."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(compiling, "inner", lambda function: function)
        spec = spec_from_file_location("interval_as_python", interval.__file__)
        assert spec is not None and spec.loader is not None
        module = module_from_spec(spec)
        spec.loader.exec_module(module)
    return module


def enclosed_by(name: str, *intervals: Any) -> Any:
    return getattr(operations(), name)(*intervals)


def is_tight(enclosure: Interval, values: list[Fraction]) -> bool:
    """Tell whether an enclosure holds all values and ends where they end, but for rounding."""
    low, high = min(values), max(values)
    room = 4e-16 * max(abs(float(low)), abs(float(high)), 1e-300) + 1e-300
    return (
        Fraction(enclosure[0]) <= low <= high <= Fraction(enclosure[1])
        and float(low) - enclosure[0] <= room
        and enclosure[1] - float(high) <= room
    )


BINARY: dict[str, Callable[[Fraction, Fraction], Fraction]] = {
    "add": lambda a, b: a + b,
    "subtract": lambda a, b: a - b,
    "multiply": lambda a, b: a * b,
}


@pytest.mark.parametrize("name", BINARY)
def test_of_two_intervals(name: str) -> None:
    for a, b in product(INTERVALS, INTERVALS):
        corners = [BINARY[name](Fraction(x), Fraction(y)) for x, y in product(a, b)]
        assert is_tight(enclosed_by(name, a, b), corners), (a, b)


def test_quotients_of_divisors_above_zero() -> None:
    divisors = [b for b in INTERVALS if b[0] > 0.0]
    for a, b in product(INTERVALS, divisors):
        corners = [Fraction(x) / Fraction(y) for x, y in product(a, b)]
        assert is_tight(enclosed_by("divide", a, b), corners), (a, b)


@pytest.mark.parametrize("a", INTERVALS)
def test_of_one_interval(a: Interval) -> None:
    ends = [Fraction(end) for end in a]
    with_zero = [*ends, Fraction(0)] if a[0] <= 0.0 <= a[1] else ends
    assert is_tight(enclosed_by("negate", a), [-end for end in ends])
    assert is_tight(enclosed_by("square", a), [end**2 for end in with_zero])
    assert is_tight(enclosed_by("absolute", a), [abs(end) for end in with_zero])
    for factor in (-1.7, 0.0, 0.6):
        products = [end * Fraction(factor) for end in ends]
        assert is_tight(enclosed_by("scale", a, factor), products)
    assert enclosed_by("size", a) == max(map(abs, a))
    assert enclosed_by("middle", a) == pytest.approx(float(np.mean(a)), abs=1e-15)
    signs = {float(np.sign(end)) for end in a} | ({-1.0, 1.0} if a[0] < 0.0 < a[1] else set())
    low, high = enclosed_by("sign", a)
    assert low <= min(signs) and max(signs) <= high
    assert (low, high) == (min(signs), max(signs)) or 0.0 in a


@pytest.mark.parametrize("a", [a for a in INTERVALS if a[1] >= 0.0])
def test_roots(a: Interval) -> None:
    low, high = enclosed_by("root", a)
    assert low >= 0.0
    assert Fraction(low) ** 2 <= Fraction(max(a[0], 0.0))
    assert Fraction(a[1]) <= Fraction(high) ** 2
    assert math.isclose(low, math.sqrt(max(a[0], 0.0)), rel_tol=1e-15, abs_tol=1e-300)
    assert math.isclose(high, math.sqrt(a[1]), rel_tol=1e-15, abs_tol=1e-300)


def test_around_a_middle() -> None:
    low, high = enclosed_by("around", 0.1, 0.2)
    assert Fraction(low) <= Fraction(0.1) - Fraction(0.2) <= Fraction(low) + Fraction(1e-16)
    assert Fraction(high) - Fraction(1e-16) <= Fraction(0.1) + Fraction(0.2) <= Fraction(high)
