"""Cables as chains: against CableDyn, strings in closed form, and the tangent of the catenary."""

from __future__ import annotations

import numpy as np
import pytest

from designer.physics import catenary, tangent
from designer.physics.tangent import chain_of

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
