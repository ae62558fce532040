"""Two streams whose clocks disagree."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from designer.effects.effect import Effect, Parameter, Readings, Values
from designer.effects.kind import EffectKind
from designer.effects.names import EffectName, ParameterName
from designer.model.machine import Machine
from designer.model.measured_data import Measured
from designer.units import TIME


def _change(readings: Readings, values: Values, measured: Measured) -> Readings:
    assert measured.time_s is not None
    from designer.kernel.spline import at_earlier_times

    if np.isnan(readings.length_m).any():  # a spline would spread the gap over all rows
        return readings
    length = np.empty(readings.length_m.shape)
    present = np.ascontiguousarray(readings.length_m)
    at_earlier_times(measured.time_s, present, values["offset_s"], length)
    return replace(readings, length_m=length)


def build(machine: Machine) -> list[Effect]:
    """Return the effect."""
    return [
        Effect(
            id="clock_offset",
            summary="the length stream lags the pose stream",
            law="the length of a row is that of the pose this much earlier",
            source="definition",
            parameters=(Parameter("offset_s", "s", 0.0, 0.05, (-60.0, 60.0), (-5.0, 5.0)),),
            on_readings=_change,
            needs=frozenset({"time", "motion", "length"}),
        )
    ]


KIND = EffectKind(EffectName("clock_offset", (ParameterName("offset_s", TIME),)), build)
