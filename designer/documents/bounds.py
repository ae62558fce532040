"""What a machine can be: the bounds of every number in a config or grade file, with the reason.

They are wide: what lies beyond is a slip of unit or typing, or beyond what the solvers keep figures
of. Whether numbers go together is checked where they meet.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

from designer import units
from designer.model.uncertainty import LEAST_DEVIATION, MAX_DEVIATION


@dataclass(frozen=True, slots=True)
class Bound:
    """From where to where a number may lie, ends included [SI], and why not beyond."""

    dimension: units.Dimension
    least: float
    most: float
    reason: str


MAX_CABLES = 64

MOST_SAMPLES = 10**7
"""Samples of a workspace: more take days, and the search between them finds more than they do."""

BOUNDS: Mapping[str, Bound] = {
    "position": Bound(units.LENGTH, -1e7, 1e7, "as far as survey coordinates reach"),
    "distance": Bound(units.LENGTH, 0.0, 2e4, "no cable is longer than some kilometres"),
    "clearance": Bound(units.LENGTH, 1e-6, 1e3, "finer than any machine, or larger"),
    "sag": Bound(units.RELATIVE, 1e-3, 0.5, "what hangs deeper is not taut"),
    "length noise": Bound(units.LENGTH, 1e-9, 1e3, "no winch measures finer, or so badly"),
    "tension noise": Bound(units.FORCE, 1e-6, 1e8, "no load cell measures finer, or so badly"),
    "angle noise": Bound(units.ANGLE, 1e-9, 1.0, "no inclinometer measures finer, or so badly"),
    "search time": Bound(units.TIME, 0.0, 1e6, "nobody waits for weeks"),
    "proof time": Bound(units.TIME, 0.0, 1e6, "nobody waits for weeks; 0 s is no proof"),
    "sheave": Bound(units.LENGTH, 1e-3, 15.0, "the sheaves of mine hoists have up to 9 m"),
    "rope diameter": Bound(units.LENGTH, 1e-4, 0.5, "from a thread to a cable of a bridge"),
    "mass": Bound(units.MASS, 1e-6, 1e8, "from a grain to a ship"),
    "inertia": Bound(units.INERTIA, -1e12, 1e12, "of a ship, about a far point"),
    "density": Bound(units.DENSITY, 1.0, 3e4, "air has 1.2, osmium 22 600"),
    "mass per length": Bound(
        units.LINEAR_DENSITY, 1e-7, 5e3, "from a thread to a cable of a bridge"
    ),
    "breaking load": Bound(units.FORCE, 1.0, 1e9, "from a thread to a cable of a bridge"),
    "metallic area": Bound(units.AREA, 1e-10, 0.2, "from a thread to a cable of a bridge"),
    "axial stiffness": Bound(units.FORCE, 1.0, 1e12, "from a thread to a cable of a bridge"),
    "tension": Bound(units.FORCE, 0.0, 1e9, "the strongest cable of a bridge bears less"),
    "force": Bound(units.FORCE, -1e9, 1e9, "the heaviest lifts are less"),
    "moment": Bound(units.MOMENT, -1e12, 1e12, "the heaviest lifts, far off"),
    "modulus": Bound(units.STRESS, 1e5, 1.5e12, "rubber has 1e6, diamond 1.2e12"),
    "stress": Bound(units.STRESS, 1e3, 1e11, "the strongest fibre bears 6e9"),
    "direction": Bound(units.NUMBER, -1e6, 1e6, "only its direction counts"),
    "part of a quaternion": Bound(units.NUMBER, -1.01, 1.01, "its length is 1"),
    "half turn": Bound(units.ANGLE, -math.pi, math.pi, "half a turn either way reaches all"),
    # A turn at most: a bare 90 that is meant in degrees shall not pass as 90 rad.
    "fleet angle": Bound(units.ANGLE, 1e-4, 0.5, "a few degrees are too many; check the unit"),
    "angle": Bound(units.ANGLE, -2.0 * math.pi, 2.0 * math.pi, "a turn is 2 pi"),
    "speed": Bound(units.SPEED, 0.0, 120.0, "no storm is faster"),
    "acceleration": Bound(units.ACCELERATION, 0.0, 1e3, "no winch pulls so hard"),
    "dynamic factor": Bound(
        units.NUMBER, 1.0, 10.0, "1 is at rest; a dropped load is another matter"
    ),
    "drag coefficient": Bound(units.NUMBER, 0.0, 10.0, "a plate across the wind has 2"),
    "drag area": Bound(units.AREA, 0.0, 1e4, "the largest sails"),
    "frequency": Bound(units.FREQUENCY, 1e-3, 1e4, "from a swell of the sea to a note"),
    "stiffness": Bound(units.STIFFNESS, 1e-3, 1e12, "softer than a feather, or stiffer than rock"),
    "rope oversize": Bound(units.RELATIVE, 0.0, 0.2, "steel wire ropes have up to 5 %"),
    "drum capacity": Bound(units.LENGTH, 1e-2, 2e4, "no cable is longer than some kilometres"),
    "gear ratio": Bound(units.NUMBER, 1e-2, 1e5, "no gear of a winch turns faster or slower"),
    "torque": Bound(units.MOMENT, 1e-4, 1e8, "from a toy to the drum of a mine hoist"),
    "rotational speed": Bound(units.ROTATIONAL_SPEED, 1e-4, 1e5, "no motor turns a rope faster"),
    "power": Bound(units.POWER, 1e-3, 1e9, "from a toy to the drum of a mine hoist"),
    "constant of a rope's life": Bound(units.NUMBER, -100.0, 100.0, "Feyrer's are below 10"),
    "factor of a rope's life": Bound(units.NUMBER, 0.01, 100.0, "Feyrer's are from 0.8 to 2.1"),
    "runs a day": Bound(units.NUMBER, 1e-4, 1e6, "from once in decades to ten a second"),
    "days": Bound(units.NUMBER, 1e-2, 1e6, "no rope lasts for millennia"),
    "rope speed": Bound(units.SPEED, 1e-6, 200.0, "no winch pulls faster"),
    "path acceleration": Bound(units.ACCELERATION, 1e-6, 1e3, "no winch pulls so hard"),
    "ice": Bound(units.LENGTH, 1e-5, 0.5, "from rime to what breaks masts"),
    "safety factor": Bound(units.NUMBER, 1.0, 100.0, "lifts of persons have 12"),
    "sheave efficiency": Bound(
        units.FRACTION, 0.5, 1.0, "half is what a rope keeps that slides over a fixed body"
    ),
    "efficiency": Bound(units.FRACTION, 0.01, 1.0, "nothing gives more than it takes"),
    "temperature change": Bound(units.TEMPERATURE_CHANGE, -300.0, 1000.0, "steel lasts no further"),
    "temperature": Bound(units.TEMPERATURE, -200.0, 1000.0, "steel lasts no further"),
    "scale of a column": Bound(units.NUMBER, -1e12, 1e12, "units are no further apart"),
    "price": Bound(units.NUMBER, 1e-9, 1e9, "no rope is dearer"),
    "load fraction": Bound(units.NUMBER, 1e-6, 1.0, "a rope breaks at 1"),
    "stiffness over breaking load": Bound(units.NUMBER, 0.1, 1e4, "ropes break between"),
    "uncertainty": Bound(units.NUMBER, 0.0, 1.0, "it is a fraction"),
    "relative scatter": Bound(
        units.RELATIVE,
        0.0,
        MAX_DEVIATION,
        "from certain to where a normal quantity may come near zero",
    ),
    "half width": Bound(
        units.RELATIVE, 0.0, -LEAST_DEVIATION, "a tenth of a quantity is left at least"
    ),
    "deviation": Bound(
        units.RELATIVE, LEAST_DEVIATION, 10.0, "from a tenth of a quantity to ten times it"
    ),
    "scatter of points": Bound(
        units.LENGTH, 0.0, 10.0, "from certain to where nothing is surveyed"
    ),
    "shift": Bound(units.LENGTH, -10.0, 10.0, "beyond, nothing is surveyed"),
    "area factor": Bound(units.NUMBER, 1e-3, 1.0, "at most pi/4 of d² is metal"),
    "sheave ratio": Bound(units.NUMBER, 1.0, 1e3, "a rope is not bent over less than itself"),
    "expansion": Bound(units.PER_TEMPERATURE, -1e-2, 1e-2, "the softest plastics have 2e-4 /K"),
    "time": Bound(units.TIME, -1e10, 1e10, "three centuries"),
}
"""By the name of what is bounded."""

_PARAMETERS: Mapping[str, tuple[float, str]] = {
    "m": (1e4, "no cable is longer than some kilometres"),
    "rad": (2.0 * math.pi, "a turn is 2 pi"),
    "kg": (1e8, "from a grain to a ship"),
    "N": (1e9, "the strongest cable of a bridge bears less"),
    "Pa": (1.5e12, "diamond has 1.2e12"),
    "s": (1e10, "three centuries"),
    "1/K": (1e-2, "the softest plastics have 2e-4 /K"),
    "N*m^2": (1e12, "a beam 3 m thick"),
    "": (1e6, "as good as without end"),
}


def parameter_bound(dimension: units.Dimension) -> Bound:
    """Return how far a parameter of an effect may lie from zero, by its unit."""
    limit, reason = _PARAMETERS.get(dimension.unit, (1e12, "as good as without end"))
    return Bound(dimension, -limit, limit, reason)
