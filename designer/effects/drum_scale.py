"""Winches whose scale is wrong."""

from __future__ import annotations

from dataclasses import replace

from designer.effects.effect import Effect, Parameter, Readings, Values
from designer.effects.kind import EffectKind
from designer.effects.names import EffectName, ParameterName
from designer.model.machine import Machine
from designer.model.measured_data import Measured
from designer.units import NUMBER


def _change(readings: Readings, values: Values, measured: Measured) -> Readings:
    return replace(readings, length_m=readings.length_m * values["scale"])


def build(machine: Machine) -> list[Effect]:
    """Return the effect."""
    return [
        Effect(
            id="drum_scale",
            summary="the winches' scale is wrong",
            law="measured length is scale times the true one",
            source="definition",
            parameters=(Parameter("scale", "", 1.0, 1e-3, (0.2, 5.0), (0.95, 1.05)),),
            on_readings=_change,
            needs=frozenset({"length"}),
        )
    ]


KIND = EffectKind(EffectName("drum_scale", (ParameterName("scale", NUMBER, above=0.0),)), build)
