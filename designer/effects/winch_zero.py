"""One winch that was homed at the wrong length."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from designer.effects.effect import Effect, Parameter, Readings, Size, Values
from designer.model.measured_data import Measured
from designer.units import LENGTH

ZERO = Parameter(
    "offset_m",
    LENGTH,
    Size(0.01, bounds=(-1e3, 1e3), plausible=(-100.0, 100.0)),
    is_optional=True,
    part_of=("length_offset",),
)


def _change(readings: Readings, values: Values, measured: Measured, *, cable: int) -> Readings:
    length = np.array(readings.length_m)
    length[:, cable - 1] += values["offset_m"]
    return replace(readings, length_m=length)


EFFECT = Effect(
    id="winch_zero",
    summary="the winch of cable {cable} was homed at the wrong length",
    law="measured length plus an offset",
    source="definition",
    parameters=(replace(ZERO, is_optional=False, part_of=("length_offset", "winch_scale")),),
    on_readings=_change,
    cause="setting_up",
    needs=frozenset({"length"}),
    takes_cable=True,
    shifts_lengths=True,
)
