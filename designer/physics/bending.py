"""How often a running rope bends at each place along it, and how many bends it bears."""

from __future__ import annotations

import numpy as np

from designer.arrays import BoolArray, FloatArray

_THINNEST_M, _SHORTEST = 4e-3, 10.0
"""Thinner ropes count as that thick, zones shorter than so many diameters as that long: beyond, the
factors of the fit grow without bound."""


def crossings(edge_m: FloatArray, places_m: FloatArray) -> BoolArray:
    """Tell in which step an end of a bent piece passes which place (n_instants - 1, n_places).

    The end (n_instants,), where the rope comes to a sheave, leaves it or comes to a drum, moves
    along the rope; places (n_places,) on the rope [m]. Each passage bends the rope or straightens
    it: half a bending cycle.
    """
    is_beyond = edge_m[:, None] > places_m
    return np.asarray(is_beyond[1:] != is_beyond[:-1])


def borne_cycles(
    tension_N: FloatArray,
    rope_diameter_m: float,
    sheave_diameter_m: float,
    zone_m: float,
    b: tuple[float, float, float, float],
    wire_strength_Pa: float,
    core_factor: float,
) -> FloatArray:
    r"""Return the bending cycles that a wire rope bears at tensions (...), in the mean.

    .. math::  \lg N = b_0 + (b_1 + b_3 \lg (D/d)) \left(\lg \frac{S}{d^2} - 0.4 \lg
        \frac{R_0}{1770}\right) + b_2 \lg (D/d) + \lg f_d + \lg f_L + \lg f_C

    with the tension S in N, the diameter d in mm and the strength R_0 of the wires in MPa; for the
    size :math:`f_d = 0.52 / ((d / 16)^{0.3} - 0.48)` and for the length l of the bent zone
    :math:`f_L = 1.49 / (2.49 - ((l/d - 2.5) / 57.5)^{-0.14})`. Feyrer, Wire Ropes: Tension,
    Endurance, Reliability, 2nd ed., Springer 2015, eq. 3.55 and table 3.14a. Ropes below 4 mm are
    taken as 4 mm, zones below 10 d as 10 d, which is on the safe side.
    """
    d_mm, ratio = 1e3 * rope_diameter_m, np.log10(sheave_diameter_m / rope_diameter_m)
    size_factor = 0.52 / ((1e3 * max(rope_diameter_m, _THINNEST_M) / 16.0) ** 0.3 - 0.48)
    zone = max(zone_m / rope_diameter_m, _SHORTEST)
    length_factor = 1.49 / (2.49 - ((zone - 2.5) / 57.5) ** -0.14)
    with np.errstate(divide="ignore"):  # a slack rope bears any number
        load = np.log10(tension_N / d_mm**2) - 0.4 * np.log10(wire_strength_Pa / 1770e6)
    b0, b1, b2, b3 = b
    factors = np.log10(size_factor * length_factor * core_factor)
    return np.asarray(10.0 ** (b0 + (b1 + b3 * ratio) * load + b2 * ratio + factors))
