"""Winches whose scale is wrong."""

from __future__ import annotations

from dataclasses import replace

from designer.effects.effect import Effect, Parameter, Readings, Size, Values
from designer.model.measured_data import Measured
from designer.units import NUMBER

_SIZE = Size(1e-3, bounds=(0.2, 5.0), plausible=(0.95, 1.05))


def _change(readings: Readings, values: Values, measured: Measured) -> Readings:
    return replace(readings, length_m=readings.length_m * values["scale"])


EFFECT = Effect(
    id="drum_scale",
    summary="the winches' scale is wrong",
    law="measured length is scale times the true one",
    source="definition",
    parameters=(Parameter("scale", NUMBER, _SIZE, neutral=1.0, above=0.0),),
    on_readings=_change,
    cause="setting_up",
    needs=frozenset({"length"}),
)
