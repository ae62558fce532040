"""Checks of what the cables carry: there is a load, of fitting size and for this material."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from designer.arrays import FloatArray
from designer.documents.fields import Direction, Forces, Mass, Modulus, Moments, Point, Stress
from designer.errors import Fault
from designer.io.config.effects import read_effects
from designer.io.config.parts import Parts
from designer.io.config.schema import MOST_CABLES, Anchors, Box
from designer.model.cable import STANDARD_GRAVITY_M_PER_S2

_WEIGHTLESS = 1e-9
_LARGEST_STRAIN = 0.5
"""Linear elasticity says nothing beyond; the softest rope of the catalogue breaks before."""
_PLATFORM = ("robot", "platform")
_WRENCH = (*_PLATFORM, "wrench")
_DOWN = np.array([0.0, 0.0, -1.0])


def load_is_not_cancelled(parts: Parts) -> Iterator[Fault]:
    """The wrench leaves something to hold: cables of no load have no diameter."""
    force = parts.array(Forces, *_WRENCH, "force")
    weight = _weight_N(parts)
    if force is None or weight is None:
        return
    moment = _or_zero(parts.array(Moments, *_WRENCH, "moment"))
    lever = _or_zero(parts.array(Point, *_PLATFORM, "centre_of_mass"))
    size_N = _WEIGHTLESS * float(np.linalg.norm(weight))
    if (
        np.linalg.norm(force + weight) <= size_N
        and np.linalg.norm(moment + np.cross(lever, weight)) <= size_N
    ):
        problem = "cancels the platform's weight, so there is nothing for the cables to hold"
        yield parts.fault((*_WRENCH, "force"), problem, "a load that is left")


def strain_stays_small(parts: Parts) -> Iterator[Fault]:
    """The allowable stress is well below the modulus; else one of them is in another unit."""
    keys = ("cable", "allowable_stress")
    stress_Pa = parts.read(Stress, *keys)
    modulus_Pa = parts.read(Modulus, "cable", "youngs_modulus")
    if stress_Pa is None or modulus_Pa is None or stress_Pa <= _LARGEST_STRAIN * modulus_Pa:
        return
    problem = f"stretches the cable by {stress_Pa / modulus_Pa:.0%}"
    expected = f"at most {_LARGEST_STRAIN:.0%}; check the unit, also that of cable.youngs_modulus"
    yield parts.fault(keys, problem, expected)


def hull_is_smaller_than_the_robot(parts: Parts) -> Iterator[Fault]:
    """The platform finds room between the exit points; else its hull is in another unit."""
    keys = (*_PLATFORM, "hull")
    hull = parts.array(Box, *keys)
    anchors = parts.array(Anchors, "robot", "anchors")
    if hull is None or anchors is None:
        return
    size_m = float(np.linalg.norm(np.ptp(hull, axis=1)))
    room_m = float(np.linalg.norm(np.ptp(anchors, axis=0)))
    if size_m > room_m:
        problem = f"is {size_m:.3g} m from corner to corner, the exit points {room_m:.3g} m"
        yield parts.fault(keys, problem, "a box that fits between them; check the unit")


LOAD_CHECKS = (load_is_not_cancelled, strain_stays_small, hull_is_smaller_than_the_robot)


def _weight_N(parts: Parts) -> FloatArray | None:
    """Return the platform's weight with what the effects add to it (3,), world frame [N]."""
    mass_kg = parts.read(Mass, *_PLATFORM, "mass")
    if mass_kg is None:
        return None
    declared = read_effects(parts.raw("effects"), MOST_CABLES, parts.effects).effects
    mass_kg += sum(
        one.parameters.get("offset_kg", 0.0) for _, one in declared if one.id == "platform_mass"
    )
    down = parts.array(Direction, "robot", "gravity")
    down = _DOWN if down is None else down
    return np.asarray(mass_kg * STANDARD_GRAVITY_M_PER_S2 * down / np.linalg.norm(down))


def _or_zero(vector: FloatArray | None) -> FloatArray:
    return np.zeros(3) if vector is None else vector
