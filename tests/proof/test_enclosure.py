"""Enclosures of a cable against a ball library, and what their docstrings claim of its slopes."""

from __future__ import annotations

import numba
import numpy as np
import pytest
from flint import arb, ctx

from designer.proof.enclosure.cable import bound_sag, enclose, sag
from designer.proof.enclosure.interval import add, divide, down, multiply, root, subtract, up

pytestmark = pytest.mark.slow  # compiles for some ten seconds


@numba.njit
def _sag(theta):
    return sag(theta)


@numba.njit
def _bound_sag(p, slope):
    return bound_sag(p, slope)


@numba.njit
def _enclose(p, X2, D, kappa):
    return enclose(p, X2, D, kappa)


@numba.njit
def _operations(a, b):
    return add(a, b), subtract(a, b), multiply(a, b), divide(a, b), root(b)


@numba.njit
def _next(x):
    return down(x), up(x)


def _truth(p: float, X2: float, D: float, kappa: float) -> tuple[arb, arb, arb]:
    """Length, upward pull and top tension by bisection of the closure in 60 digits."""
    ctx.dps = 60
    p, X2, D, kappa = arb(p), arb(X2), arb(D), arb(kappa)
    low, high = arb(0), 1 / (kappa * p)

    def parts(length: arb) -> tuple[arb, arb, arb]:
        theta = (1 / p - kappa * length) / 2
        y = length / 2 * theta.cosh() / theta.sinh()
        q = 1 / (1 + kappa * y)
        return D**2 * q**2 + 4 * p**2 * X2 * theta.sinh() ** 2 - length**2, y, q

    for _ in range(190):
        middle = arb(((low + high) / 2).mid())
        low, high = (middle, high) if parts(middle)[0] > 0 else (low, middle)
    _, y, q = parts(low)
    return low, y * D * q / low - low / 2, y + abs(D) * q / 2


def _random(count: int) -> np.ndarray:
    """Pulls from slack to taut, distances, drops of both signs, stiffnesses: (count, 4)."""
    rng = np.random.default_rng(5)
    size = 10.0 ** rng.uniform(-1.0, 3.0, count)
    p = 10.0 ** rng.uniform(-1.0, 4.0, count)
    X2 = (size * rng.uniform(0.01, 1.0, count)) ** 2
    D = size * rng.uniform(-1.0, 1.0, count)
    kappa = 10.0 ** rng.uniform(-4.0, -2.0, count) / (p * size)
    return np.column_stack([p, X2, D, kappa])


def test_rounding_goes_outward() -> None:
    rng = np.random.default_rng(4)
    for x in [0.0, 5e-324, -1e-310, *rng.normal(size=200) * 10.0 ** rng.uniform(-300, 300, 200)]:
        below, above = _next(float(x))
        assert below <= np.nextafter(x, -np.inf)
        assert above >= np.nextafter(x, np.inf)


def test_operations_enclose() -> None:
    ctx.dps = 60
    rng = np.random.default_rng(6)
    for _ in range(300):
        a = tuple(sorted(rng.normal(size=2)))
        b = tuple(sorted(rng.uniform(0.1, 3.0, 2)))
        x, y = (float(rng.uniform(*ends)) for ends in (a, b))
        found = _operations(a, b)
        ball, divisor = arb(x), arb(y)
        true = ball + divisor, ball - divisor, ball * divisor, ball / divisor, divisor.sqrt()
        for (low, high), value in zip(found, true, strict=True):
            assert arb(low) <= value <= arb(high)


def test_sag_encloses_tightly() -> None:
    ctx.dps = 60
    for theta in 10.0 ** np.random.default_rng(7).uniform(-8.0, 1.4, 300):
        (low, high), (C_low, C_high) = _sag(theta)
        ball = arb(float(theta))
        S, C = (ball.sinh() / ball) ** 2, ball * ball.cosh() / ball.sinh() - 1
        assert arb(low) <= S <= arb(high)
        assert arb(C_low) <= C <= arb(C_high)
        assert high - low <= 1e-12 * high
        assert C_high - C_low <= 1e-12 * C_high


def test_a_cable_lies_in_its_enclosure() -> None:
    for row in _random(100):
        worked, length, *rest = _enclose(*((x, x) for x in row[:3]), row[3])
        assert worked
        true = _truth(*map(float, row))
        for (low, high), value in zip((length, rest[3], rest[7]), true, strict=True):
            assert arb(low) <= value <= arb(high)
            assert high - low <= 1e-9 * max(abs(low), abs(high), row[1] ** 0.5)


def test_all_cables_of_a_box_lie_in_its_enclosure() -> None:
    """Values by the true cable, slopes by its differences."""
    rng = np.random.default_rng(8)
    for row in _random(40):
        half = rng.uniform(0.0, 0.1, 3) * np.abs(row[:3])
        ends = [(x - h, x + h) for x, h in zip(row[:3], half, strict=True)]
        worked, *found = _enclose(*ends, row[3])
        if not worked:
            continue
        at = [float(rng.uniform(low, high)) for low, high in ends]
        kappa = float(row[3])
        values = _truth(*at, kappa)
        for k, value in enumerate(values):
            assert arb(found[4 * k][0]) <= value <= arb(found[4 * k][1])
            for d in range(3):
                step = arb(10) ** -25
                ahead = [arb(x) + (step if d == e else 0) for e, x in enumerate(at)]
                slope = ((_truth(*ahead, kappa)[k] - value) / step).mid()
                low, high = found[4 * k + 1 + d]
                loose = 1e-12 * (abs(low) + abs(high))
                assert arb(low - loose) <= slope <= arb(high + loose)


def test_slopes_have_the_signs_that_the_bound_of_three_cables_rests_on() -> None:
    rows = _random(300)
    rows[:, 2] = np.abs(rows[:, 2])
    for row in rows:
        worked, *found = _enclose(*((x, x) for x in row[:3]), row[3])
        assert worked
        _l_p, _l_X2, _l_D = found[1:4]
        _v, v_p, v_X2, v_D, _t, _t_p, t_X2, t_D = found[4:12]
        assert _l_p[0] < 0.0 < min(_l_X2[1], v_p[1], v_D[1], t_X2[1], t_D[1])
        assert v_X2[0] < 0.0
        assert v_p[0] > -1e-9 * abs(v_p[1])


def _true_sag(p: float, slope: float) -> tuple[arb, arb]:
    """Sag across and below over chord of a rigid cable, in 60 digits; the latter where it hangs."""
    ctx.dps = 60
    theta, m = 1 / (2 * arb(p)), arb(slope)
    u, chord = (m * theta / theta.sinh()).asinh(), (1 + m * m).sqrt()
    high = u.cosh() * theta.cosh() + m * (m.asinh() - u) - chord
    return high / (2 * theta * chord**2), ((theta - u).cosh() - 1) / (2 * theta * chord)


def test_bounds_of_the_sag_hold_closely() -> None:
    rng = np.random.default_rng(3)
    for p, slope in zip(
        10.0 ** rng.uniform(-1.5, 2.0, 300), np.sinh(rng.uniform(0, 8, 300)), strict=True
    ):
        for bound, truth in zip(_bound_sag(p, slope), _true_sag(p, slope), strict=True):
            assert bound >= truth
            assert bound <= float(truth) * (1.0 + 1e-6) + 1e-9


def test_sag_falls_as_the_pull_grows_and_the_chord_gets_steeper() -> None:
    """What a box rests on: its smallest pull and flattest chord."""
    pulls = 10.0 ** np.linspace(-1.5, 2.0, 60)
    slopes = np.append(0.0, np.sinh(np.linspace(0.05, 10.0, 60)))
    theta, m = 0.5 / pulls[:, None], slopes[None]
    u, chord = np.arcsinh(m * theta / np.sinh(theta)), np.hypot(1.0, m)
    high = np.cosh(u) * np.cosh(theta) + m * (np.arcsinh(m) - u) - chord
    across = high / (2.0 * theta * chord**2)
    below = np.where(u < theta, np.sinh(0.5 * (theta - u)) ** 2 / (theta * chord), 0.0)
    for far in (across, below):
        for axis in (0, 1):
            assert (np.diff(far, axis=axis) <= 1e-12 * np.abs(far).max()).all()
