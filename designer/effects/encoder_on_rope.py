"""Lengths by a wheel on the rope, which counts it as stretched as it runs past."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from designer.effects.effect import Effect, Parameter, Readings, Size, Values
from designer.model.machine import Machine
from designer.model.measured_data import Measured
from designer.units import LENGTH, NUMBER

_SHARE = Size(0.1, bounds=(-20.0, 20.0), plausible=(0.3, 3.0))
_OFFSET = Size(0.01, bounds=(-1e3, 1e3), plausible=(-1.0, 1.0))


def _change(
    readings: Readings, values: Values, measured: Measured, *, machine: Machine
) -> Readings:
    """Integrate strain over what runs past, by trapezia from row to row, from the first on."""
    is_held = ~np.isnan(readings.length_m).any(axis=1)
    length_m = readings.length_m[is_held]
    strain = readings.tension_N[is_held] / machine.cables.axial_stiffness_N
    passed_m = np.diff(length_m, axis=0, prepend=length_m[:1])
    mean_strain = 0.5 * (strain + np.vstack([strain[:1], strain[:-1]]))
    n_cables = length_m.shape[1]
    offsets_m = np.array([values.get(f"offset_{k}_m", 0.0) for k in range(1, n_cables + 1)])
    counted = np.array(readings.length_m)
    counted[is_held] += values["share"] * np.cumsum(mean_strain * passed_m, axis=0) + offsets_m
    return replace(readings, length_m=counted)


EFFECT = Effect(
    id="encoder_on_rope",
    summary="the encoders count stretched rope",
    law="measured length grows by 1 + share · T/EA of what is paid out, T at the winch",
    source="Hooke's law",
    parameters=(
        Parameter("share", NUMBER, _SHARE),
        Parameter(
            "offset_{cable}_m", LENGTH, _OFFSET, is_optional=True, part_of=("length_offset",)
        ),
    ),
    on_readings=_change,
    needs=frozenset({"length"}),
    takes_machine=True,
    follows_rows=True,
)
