"""Load cells with a wrong zero."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from designer.effects.effect import Effect, Parameter, Readings, Values
from designer.effects.kind import EffectKind
from designer.effects.names import EffectName, ParameterName
from designer.model.machine import Machine
from designer.model.measured_data import Measured
from designer.units import FORCE


def _change(readings: Readings, values: Values, measured: Measured) -> Readings:
    offsets = np.array([values[f"offset_{k}_N"] for k in range(1, readings.tension_N.shape[1] + 1)])
    return replace(readings, tension_N=readings.tension_N + offsets)


def build(machine: Machine) -> list[Effect]:
    """Return the effect."""
    weight = machine.robot.weight_N
    offsets = tuple(
        Parameter(
            f"offset_{k}_N", "N", 0.0, 0.01 * weight, (-10 * weight, 10 * weight), (-weight, weight)
        )
        for k in range(1, machine.robot.n_cables + 1)
    )
    return [
        Effect(
            id="tension_bias",
            summary="the load cells have a wrong zero",
            law="measured tension plus an offset for each cable",
            source="definition",
            parameters=offsets,
            on_readings=_change,
            needs=frozenset({"tension"}),
        )
    ]


KIND = EffectKind(
    EffectName("tension_bias", (ParameterName("offset_{cable}_N", FORCE, neutral=0.0),)), build
)
