"""One load cell with a wrong gain."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from designer.effects.effect import Effect, Parameter, Readings, Values
from designer.effects.kind import EffectKind
from designer.effects.names import EffectName, ParameterName
from designer.model.machine import Machine
from designer.model.measured_data import Measured
from designer.units import NUMBER


def _change(readings: Readings, values: Values, measured: Measured, *, cable: int) -> Readings:
    tension = np.array(readings.tension_N)
    tension[:, cable - 1] *= values["gain"]
    return replace(readings, tension_N=tension)


def build(machine: Machine) -> list[Effect]:
    """Return one effect for each cable."""
    return [
        Effect(
            id="tension_gain",
            summary=f"the load cell of cable {cable} has a wrong gain",
            law="measured tension is gain times the force",
            source="definition",
            parameters=(Parameter("gain", "", 1.0, 0.02, (0.02, 50.0), (0.7, 1.4)),),
            on_readings=partial(_change, cable=cable),
            needs=frozenset({"tension"}),
            cable=cable,
        )
        for cable in range(1, machine.robot.n_cables + 1)
    ]


KIND = EffectKind(
    EffectName("tension_gain", (ParameterName("gain", NUMBER, above=0.0),), takes_cable=True), build
)
