"""Winches with a wrong scale (drum, gear or mechanical advantage), or homed at a wrong length."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from designer.effects.effect import Effect, Parameter, Readings, Size, Values, per_cable
from designer.model.measured_data import Measured
from designer.units import LENGTH, NUMBER

ZERO = Parameter(
    "offset_m",
    LENGTH,
    Size(0.01, bounds=(-1e3, 1e3), plausible=(-100.0, 100.0)),
    is_optional=True,
    part_of=("length_offset",),
)
_SCALE = Size(1e-3, bounds=(0.05, 20.0), plausible=(0.2, 5.0))
_SCALE_OF_ALL = Size(1e-3, bounds=(0.2, 5.0), plausible=(0.95, 1.05))
_ADVANTAGES = (1.001, 2.0, 0.5)
"""Just off, or with a part of the tackle too many or too few."""


def _change(readings: Readings, values: Values, measured: Measured, *, cable: int) -> Readings:
    length = np.array(readings.length_m)
    length[:, cable - 1] *= values.get("scale", 1.0)
    length[:, cable - 1] += values.get("offset_m", 0.0)
    return replace(readings, length_m=length)


def _change_all(readings: Readings, values: Values, measured: Measured) -> Readings:
    return replace(readings, length_m=readings.length_m * values["scale"])


def _change_zeros(readings: Readings, values: Values, measured: Measured) -> Readings:
    offsets = per_cable(values, "offset_{cable}_m", readings.length_m.shape[1])
    return replace(readings, length_m=readings.length_m + offsets)


EFFECT = Effect(
    id="winch_scale",
    summary="the winch of cable {cable} has a wrong scale",
    law="measured length is scale times the true one, plus an offset: right where it was homed",
    source="definition",
    parameters=(
        Parameter("scale", NUMBER, _SCALE, neutral=1.0, above=0.0),
        ZERO,
    ),
    on_readings=_change,
    cause="setting_up",
    needs=frozenset({"length"}),
    takes_cable=True,
    starts=tuple({"scale": scale} for scale in _ADVANTAGES),
)
HOMED = replace(
    EFFECT,
    id="winch_zero",
    summary="the winch of cable {cable} was homed at the wrong length",
    law="measured length plus an offset",
    parameters=(replace(ZERO, is_optional=False, part_of=("length_offset", "winch_scale")),),
    starts=(),
    shifts_lengths=True,
)
ALL = replace(
    EFFECT,
    id="drum_scale",
    summary="the winches' scale is wrong",
    law="measured length is scale times the true one",
    parameters=(Parameter("scale", NUMBER, _SCALE_OF_ALL, neutral=1.0, above=0.0),),
    on_readings=_change_all,
    takes_cable=False,
    starts=(),
)
ZEROS = replace(
    HOMED,
    id="length_offset",
    summary="the winches were homed at the wrong length",
    law="measured length plus an offset for each cable",
    parameters=(
        Parameter(
            "offset_{cable}_m",
            LENGTH,
            Size(0.01, bounds=(-1e3, 1e3), plausible=(-1.0, 1.0)),
            is_optional=True,
        ),
    ),
    on_readings=_change_zeros,
    takes_cable=False,
)
