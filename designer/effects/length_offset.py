"""Winches that were homed at the wrong length."""

from __future__ import annotations

from dataclasses import replace

from designer.effects.effect import Effect, Parameter, Readings, Size, Values, per_cable
from designer.model.measured_data import Measured
from designer.units import LENGTH

_SIZE = Size(0.01, bounds=(-1e3, 1e3), plausible=(-1.0, 1.0))


def _change(readings: Readings, values: Values, measured: Measured) -> Readings:
    offsets = per_cable(values, "offset_{cable}_m", readings.length_m.shape[1])
    return replace(readings, length_m=readings.length_m + offsets)


EFFECT = Effect(
    id="length_offset",
    summary="the winches were homed at the wrong length",
    law="measured length plus an offset for each cable",
    source="definition",
    parameters=(Parameter("offset_{cable}_m", LENGTH, _SIZE, is_optional=True),),
    on_readings=_change,
    cause="setting_up",
    needs=frozenset({"length"}),
    shifts_lengths=True,
)
