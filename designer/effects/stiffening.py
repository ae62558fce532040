"""Cables that are soft as long as they are slack, and stiffen."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from designer.effects.along import pull_of
from designer.effects.effect import Effect, Parameter, Readings, Values
from designer.effects.kind import EffectKind
from designer.effects.names import EffectName, ParameterName
from designer.model.machine import Machine
from designer.model.measured_data import Measured
from designer.units import FORCE, NUMBER


def _change(
    readings: Readings, values: Values, measured: Measured, *, machine: Machine
) -> Readings:
    mean = pull_of(machine, measured, readings.tension_N).mean_N
    stretch = 1.0 + mean / machine.cable.axial_stiffness_N
    more = -values["toe_strain"] * np.expm1(-mean / values["toe_tension_N"])
    # Stretched length stays; what is unstrained of it shrinks by the strain that is added.
    return replace(readings, length_m=readings.length_m * stretch / (stretch + more))


def build(machine: Machine) -> list[Effect]:
    """Return the effect; the tension at which the toe ends is near those that hold the platform."""
    weight = machine.robot.weight_N
    strain = Parameter("toe_strain", "", 0.0, 1e-4, (0.0, 0.05), (0.0, 0.01))
    tension = Parameter(
        "toe_tension_N", "N", 0.3 * weight, 0.1 * weight,
        (0.02 * weight, 20.0 * weight), (0.02 * weight, 10.0 * weight),
    )  # fmt: skip
    return [
        Effect(
            id="stiffening",
            summary="the cables stiffen with tension",
            law="strain is T/EA + ε (1 - exp(-T/T_toe))",
            source="Feyrer, Wire Ropes, 2015, section 2.3: rope moduli rise with stress",
            parameters=(strain, tension),
            on_readings=partial(_change, machine=machine),
            needs=frozenset({"length"}),
        )
    ]


KIND = EffectKind(
    EffectName(
        "stiffening",
        (
            ParameterName("toe_strain", NUMBER, at_least=0.0),
            ParameterName("toe_tension_N", FORCE, above=0.0),
        ),
    ),
    build,
)
