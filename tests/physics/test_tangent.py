"""Tangents and chains of cables against differences, CableDyn, strings and other closed forms."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from designer.physics import catenary, pulley, tangent
from designer.physics.tangent import chain_of

CASES = [
    pytest.param(500.0, 43694.6, 77634.4 - 1e5, 7.51e12, 200.0, id="long"),
    pytest.param(360.6, 71116.8, 75567.0, 7e8, 3.087, id="taut"),
    pytest.param(100.0, 5e4, 5.0, 2e7, 0.1, id="taut, level"),
    pytest.param(130.0, 31373.2, -26650.0, 7.51e8, 881.05, id="sagging"),
    pytest.param(50.0, 20.0, 900.0, 1e7, 40.0, id="slack"),
    pytest.param(50.0, 1.0, -900.0, 1e7, 4.0, id="nearly vertical"),
    pytest.param(80.0, 4e3, 100.0, np.inf, 2.0, id="inextensible"),
]


@pytest.mark.parametrize(("length", "force_x", "force_z", "EA", "w"), CASES)
def test_flexibility_is_the_derivative_of_the_end_position(length, force_x, force_z, EA, w) -> None:
    """Richardson's extrapolation of central differences: errors of the sixth order cancel."""
    found = tangent.flexibility_m_per_N(length, force_x, force_z, EA, w)
    assert np.allclose(found, found.T, rtol=1e-12)
    step = 0.02 * min(force_x, np.hypot(force_x, force_z - w * length))

    def difference(direction: np.ndarray, h: float) -> np.ndarray:
        ends = [
            catenary.end_position_m(
                length, force_x + s * h * direction[0], force_z + s * h * direction[1], EA, w
            )
            for s in (1.0, -1.0)
        ]
        return (np.array(ends[0]) - np.array(ends[1])) / (2.0 * h)

    for k, direction in enumerate(np.eye(2)):
        table = [difference(direction, step / 2**level) for level in range(3)]
        second = [(4.0 * b - a) / 3.0 for a, b in pairwise(table)]
        third = (16.0 * second[1] - second[0]) / 15.0
        size = np.abs(found[:, k]).max()
        assert np.allclose(third, found[:, k], rtol=1e-6, atol=1e-6 * size)


def test_short_and_long_arcs_meet() -> None:
    """Where quadrature hands over to the closed form both give the same."""
    w, EA, force_x = 2.0, 1e8, 100.0
    at = force_x * np.sinh(0.5) / w  # asinh(w l / F_x) is the limit of a short arc
    lengths = np.array([at * (1.0 - 1e-9), at * (1.0 + 1e-9)])
    below, above = tangent.flexibility_m_per_N(lengths, force_x, w * lengths, EA, w)
    assert np.allclose(below, above, rtol=1e-7)


def test_a_light_taut_cable_is_a_rod_that_swings() -> None:
    length, tension, EA = 100.0, 1e4, 1e7
    K = tangent.stiffness_N_per_m(
        *(np.array(v) for v in (length, 0.6 * tension, -0.8 * tension, EA, 1e-8))
    )
    along, across = np.array([0.6, -0.8]), np.array([0.8, 0.6])
    stretched = length * (1.0 + tension / EA)
    assert along @ K @ along == pytest.approx(EA / length, rel=1e-9)
    assert across @ K @ across == pytest.approx(tension / stretched, rel=1e-9)


def test_ernst_modulus_of_a_shallow_cable() -> None:
    """Ernst 1965: 1/EA_eff = 1/EA + w² X² / (12 T³) along a level chord."""
    span, tension, EA, w = 100.0, 2e4, 1e9, 2.0
    length, force_z = catenary.length_and_force_z(tension / span, span, 0.0, EA, w)
    C = tangent.flexibility_m_per_N(length, tension, force_z, EA, w)
    ernst = span / EA + (w * span) ** 2 * span / (12.0 * tension**3)
    assert C[0, 0] == pytest.approx(ernst, rel=3e-4)


def test_a_vertical_cable() -> None:
    length, pull, EA, w = 60.0, 500.0, 1e7, 3.0
    C = tangent.flexibility_m_per_N(length, 0.0, -pull, EA, w)
    assert C[1, 1] == pytest.approx(length / EA, rel=1e-12)
    assert C[0, 1] == 0.0
    # A hanging chain with a load, pushed sideways: the integral of ds / T(s).
    assert C[0, 0] == pytest.approx(length / EA + np.log1p(w * length / pull) / w, rel=1e-12)


def test_a_folded_vertical_cable_has_no_sideways_stiffness() -> None:
    force_x, force_z = catenary.forces_from_length(70.0, 0.0, 60.0, 1e7, 3.0)
    K = tangent.stiffness_N_per_m(*(np.array(v) for v in (70.0, force_x, force_z, 1e7, 3.0)))
    assert K[0, 0] == 0.0
    assert K[1, 1] > 0.0


@pytest.mark.parametrize("radius", [0.05, 1.0])
def test_over_a_pulley_against_differences(radius: float) -> None:
    """Move the end by a little, let the cable roll until its total length is the same again."""
    EA, w, total = 2e7, 30.0, 101.0

    def forces(X: float, D: float) -> np.ndarray:
        slope, strain = pulley.straight_slope_rad(np.array(X), np.array(D), radius), 0.0
        for _ in range(60):
            free = total - pulley.wrap_length_m(slope, radius) / (1.0 + strain)
            F_x, F_z = catenary.forces_from_length(
                free,
                X - radius * (1.0 + np.sin(slope)),
                D + radius * np.cos(slope),
                EA,
                w,
            )
            slope = np.arctan2(w * free - F_z, F_x)
            strain = np.hypot(F_x, w * free - F_z) / EA
        return np.array([F_x, F_z, free])

    X, D, h = 80.0, 55.0, 1e-4
    F_x, F_z, free = forces(X, D)
    found = tangent.stiffness_over_pulley_N_per_m(
        *(np.array(v) for v in (free, F_x, F_z, EA, w)), radius
    )
    by_x = (forces(X + h, D) - forces(X - h, D))[:2] / (2 * h)
    by_z = (forces(X, D - h) - forces(X, D + h))[:2] / (2 * h)
    expected = np.stack([by_x, by_z], axis=1)
    assert np.allclose(found, expected, rtol=1e-6, atol=1e-6 * np.abs(expected).max())


def test_a_pulley_of_no_radius_is_an_eyelet() -> None:
    arguments = [np.array(v) for v in (100.0, 5e3, -3e3, 1e7, 20.0)]
    eyelet = tangent.stiffness_N_per_m(*arguments)
    assert np.allclose(tangent.stiffness_over_pulley_N_per_m(*arguments, 0.0), eyelet, rtol=1e-9)


@pytest.mark.parametrize("seed", range(5))
def test_both_tangents_touch_the_pulley(seed: int) -> None:
    rng = np.random.default_rng(seed)
    radius, level, drop = rng.uniform([0.1, 1.0, -2.0], [0.4, 6.0, 8.0])
    straight, lower = (
        float(slope(np.float64(level), np.float64(drop), radius))
        for slope in (pulley.straight_slope_rad, pulley.lower_slope_rad)
    )
    for angle in (straight, lower):
        # The pulley's centre is a radius beyond the exit point; radius and cable are square.
        reach = (level - radius) * np.sin(angle) - drop * np.cos(angle)
        assert reach == pytest.approx(radius, rel=1e-12)
    assert straight < lower < straight + np.pi


G = 9.81


def hung(length_m: float, span_m: float, drop_m: float, stiffness_N: float, density: float):
    """Arguments of a chain, of a cable between two points."""
    force = catenary.forces_from_length(length_m, span_m, drop_m, stiffness_N, density * G)
    return *map(np.asarray, (length_m, *force, stiffness_N, density * G)), density


@pytest.mark.parametrize(
    ("length_m", "lowest_Hz"),
    [
        (100.01439402, 0.5537),
        (100.66109125, 0.2477),
        (102.61737782, 0.1753),
        (109.97103642, 0.1244),
    ],
)
def test_lowest_mode_of_sagging_cables_matches_cabledyn(length_m: float, lowest_Hz: float) -> None:
    """CableDyn 0.3.0, 80 elements: level span of 100 m, EA 1e8 N, 1 kg/m, to 1 %."""
    chain = chain_of(*hung(length_m, 100.0, 0.0, 1e8, 1.0), 16)
    squares = (2.0 * np.pi * lowest_Hz * np.array([0.99, 1.01])) ** 2
    assert chain.resistance_N_per_m(squares)[1].tolist() == [0, 1]


def test_overtones_of_a_taut_string_are_all_counted() -> None:
    cable = hung(50.0, 50.0 * 1.0001, 0.0, 1e8, 0.001)
    chain = chain_of(*cable, 400)
    transit = 50.0025 * float(np.sqrt(0.001 / np.hypot(cable[1], cable[2])))
    for overtone in (1, 2, 7, 30):
        just = (np.pi * overtone / transit * np.array([0.999, 1.001])) ** 2
        below = chain.resistance_N_per_m(just)[1].tolist()
        assert below == [2 * (overtone - 1), 2 * overtone]  # in the plane and across


@pytest.mark.parametrize("count", [3, 16, 64])
def test_chain_at_rest_is_as_stiff_as_the_cable(count: int) -> None:
    cable = hung(130.0, 89.9, 59.2, 7.5e6, 90.0)
    (xx, xz, zz, across), below = chain_of(*cable, count).resistance_N_per_m(np.asarray(0.0))
    expected = tangent.stiffness_N_per_m(*cable[:5])
    assert [[xx, xz], [xz, zz]] == pytest.approx(expected, rel=1e-9)
    assert across == pytest.approx(cable[1] / 89.9, rel=1e-9)
    assert below == 0


def test_swinging_end_of_a_string_matches_closed_form() -> None:
    """Across a taut string an end resists with (T/l) x cot x, x = 2 π f transit."""
    cable = hung(50.0, 50.0 * 1.0001, 0.0, 1e8, 0.001)
    chain = chain_of(*cable, 64)
    transit = 50.0025 * float(np.sqrt(0.001 / np.hypot(cable[1], cable[2])))
    for x in (0.3, 1.2, 2.8, 4.0):
        across = chain.resistance_N_per_m(np.asarray((x / transit) ** 2))[0][3]
        expected = float(cable[1]) / 50.005 * x / np.tan(x)
        assert across == pytest.approx(expected, rel=2e-3)
