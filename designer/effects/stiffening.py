"""Cables that are soft as long as they are slack, and stiffen."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from designer.effects.effect import Effect, Parameter, Readings, Size, Values, pull_of
from designer.model.machine import Machine
from designer.model.measured_data import Measured
from designer.units import FORCE, NUMBER

_STRAIN = Size(1e-4, bounds=(0.0, 0.05), plausible=(0.0, 0.01))


def _change(
    readings: Readings, values: Values, measured: Measured, *, machine: Machine
) -> Readings:
    mean = pull_of(machine, measured, readings.tension_N).mean_N
    stretch = 1.0 + mean / machine.cables.axial_stiffness_N
    more = -values["toe_strain"] * np.expm1(-mean / values["toe_tension_N"])
    # Stretched length stays; what is unstrained of it shrinks by the strain that is added.
    return replace(readings, length_m=readings.length_m * stretch / (stretch + more))


def _toe(machine: Machine) -> Size:
    """The tension at which the toe ends is near those that hold the platform."""
    weight = machine.robot.weight_N
    return Size(
        0.1 * weight,
        bounds=(0.02 * weight, 20.0 * weight),
        plausible=(0.02 * weight, 10.0 * weight),
        neutral=0.3 * weight,
    )


EFFECT = Effect(
    id="stiffening",
    summary="the cables stiffen with tension",
    law="strain is T/EA + ε (1 - exp(-T/T_toe))",
    source="Feyrer, Wire Ropes, 2015, section 2.3: rope moduli rise with stress",
    parameters=(
        Parameter("toe_strain", NUMBER, _STRAIN, at_least=0.0),
        Parameter("toe_tension_N", FORCE, _toe, above=0.0),
    ),
    on_readings=_change,
    needs=frozenset({"length"}),
    takes_machine=True,
)
