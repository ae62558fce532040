"""Bending cycles that a rope bears: the equation and its factors, one by one."""

from __future__ import annotations

import math

import numpy as np
import pytest

from designer.physics.bending import borne_cycles, crossings

B = (1.2, -2.5, 5.5, -1.7)


def borne(tension_N: float, d_m: float = 0.016, **changed: float) -> float:
    given = {"sheave_m": 0.4, "zone_m": 60.0 * d_m, "strength_Pa": 1770e6, "core": 1.0}
    sheave_m, zone_m, strength_Pa, core = (given | changed).values()
    return float(borne_cycles(np.array(tension_N), d_m, sheave_m, zone_m, B, strength_Pa, core))


def test_at_the_reference_no_factor_acts() -> None:
    """16 mm, a zone of 60 d, wires of 1 770 MPa: the equation alone."""
    ratio = math.log10(25.0)
    expected = 1.2 + (-2.5 - 1.7 * ratio) * math.log10(2e4 / 256.0) + 5.5 * ratio
    assert math.log10(borne(2e4)) == pytest.approx(expected, rel=1e-12)


def test_tension_acts_with_its_power() -> None:
    power = -2.5 - 1.7 * math.log10(25.0)
    assert borne(4e4) / borne(2e4) == pytest.approx(2.0**power, rel=1e-12)
    assert borne(2e4, strength_Pa=1960e6) / borne(2e4) == pytest.approx(
        (1960 / 1770) ** (-0.4 * power), rel=1e-12
    )
    assert borne(2e4, core=0.81) / borne(2e4) == pytest.approx(0.81)
    assert borne(0.0) == math.inf


def test_thick_ropes_and_long_zones_bear_less() -> None:
    assert borne(2e4, zone_m=5.0) < borne(2e4) < borne(2e4, zone_m=0.4)
    assert borne(2e4, zone_m=0.001) == borne(2e4, zone_m=0.16) < math.inf
    same_stress = [
        borne(2e4 * (d / 0.016) ** 2, d, sheave_m=25.0 * d) for d in (0.001, 0.004, 0.03)
    ]
    assert same_stress[0] == pytest.approx(same_stress[1], rel=1e-9)
    assert same_stress[1] > same_stress[2]


def test_an_end_that_comes_and_goes_passes_twice() -> None:
    edge = np.array([1.0, 3.0, 3.0, 2.0])
    passes = crossings(edge, np.array([0.5, 1.5, 2.5, 3.5]))
    assert passes.sum(axis=0).tolist() == [0, 1, 2, 0]
