"""Two streams whose clocks disagree."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from designer.effects.effect import Effect, Parameter, Readings, Size, Values
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


EFFECT = Effect(
    id="clock_offset",
    summary="the length stream lags the pose stream",
    law="the length of a row is that of the pose this much earlier",
    source="definition",
    parameters=(
        Parameter("offset_s", TIME, Size(0.05, bounds=(-60.0, 60.0), plausible=(-5.0, 5.0))),
    ),
    on_readings=_change,
    cause="setting_up",
    needs=frozenset({"time", "motion", "length"}),
)
