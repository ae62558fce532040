"""Winches that were homed at the wrong length."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from designer.effects.effect import Effect, Parameter, Readings, Values
from designer.effects.kind import EffectKind
from designer.effects.names import EffectName, ParameterName
from designer.model.machine import Machine
from designer.model.measured_data import Measured
from designer.units import LENGTH


def _change(readings: Readings, values: Values, measured: Measured) -> Readings:
    offsets = np.array([values[f"offset_{k}_m"] for k in range(1, readings.length_m.shape[1] + 1)])
    return replace(readings, length_m=readings.length_m + offsets)


def build(machine: Machine) -> list[Effect]:
    """Return the effect."""
    offsets = tuple(
        Parameter(f"offset_{k}_m", "m", 0.0, 0.01, (-1e3, 1e3), (-1.0, 1.0))
        for k in range(1, machine.robot.n_cables + 1)
    )
    return [
        Effect(
            id="length_offset",
            summary="the winches were homed at the wrong length",
            law="measured length plus an offset for each cable",
            source="definition",
            parameters=offsets,
            on_readings=_change,
            needs=frozenset({"length"}),
        )
    ]


KIND = EffectKind(
    EffectName("length_offset", (ParameterName("offset_{cable}_m", LENGTH, neutral=0.0),)), build
)
