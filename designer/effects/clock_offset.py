"""Two streams whose clocks disagree."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from designer.effects.effect import Effect, Parameter, Readings, Values
from designer.machine import Machine
from designer.measured.data import Measured


def _change(readings: Readings, values: Values, measured: Measured) -> Readings:
    assert measured.time_s is not None
    from scipy.interpolate import CubicSpline

    if np.isnan(readings.length_m).any():  # a spline would spread the gap over all rows
        return readings
    first, last = measured.time_s[[0, -1]]
    then = np.clip(measured.time_s - values["offset_s"], first, last)
    return replace(readings, length_m=CubicSpline(measured.time_s, readings.length_m)(then))


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
