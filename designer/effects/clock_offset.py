"""Two streams whose clocks disagree."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from designer.effects.effect import Effect, Parameter, Readings, Values
from designer.machine import Machine
from designer.measured.data import Measured


def _change(readings: Readings, values: Values, measured: Measured) -> Readings:
    assert measured.time_s is not None
    then = measured.time_s - values["offset_s"]
    late = [np.interp(then, measured.time_s, column) for column in readings.length_m.T]
    return replace(readings, length_m=np.stack(late, axis=1))


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
