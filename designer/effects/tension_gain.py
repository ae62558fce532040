"""Load cells with a wrong gain, one or all by what they share (a unit, an amplifier), or zero."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from designer.effects.effect import Effect, Parameter, Readings, Size, Values, per_cable
from designer.model.machine import Machine
from designer.model.measured_data import Measured
from designer.units import FORCE, NUMBER

_SIZE = Size(0.02, bounds=(0.02, 50.0), plausible=(0.7, 1.4))


def _change(readings: Readings, values: Values, measured: Measured, *, cable: int) -> Readings:
    tension = np.array(readings.tension_N)
    tension[:, cable - 1] *= values["gain"]
    return replace(readings, tension_N=tension)


def _change_all(readings: Readings, values: Values, measured: Measured) -> Readings:
    return replace(readings, tension_N=readings.tension_N * values["gain"])


def _change_zeros(readings: Readings, values: Values, measured: Measured) -> Readings:
    offsets = per_cable(values, "offset_{cable}_N", readings.tension_N.shape[1])
    return replace(readings, tension_N=readings.tension_N + offsets)


def _zero(machine: Machine) -> Size:
    weight = machine.robot.weight_N
    return Size(0.01 * weight, bounds=(-10 * weight, 10 * weight), plausible=(-weight, weight))


EFFECT = Effect(
    id="tension_gain",
    summary="the load cell of cable {cable} has a wrong gain",
    law="measured tension is gain times the force",
    source="definition",
    parameters=(Parameter("gain", NUMBER, _SIZE, neutral=1.0, above=0.0),),
    on_readings=_change,
    needs=frozenset({"tension"}),
    takes_cable=True,
)
ALL = replace(
    EFFECT,
    id="tension_scale",
    summary="the load cells have one wrong gain in common",
    law="measured tensions are gain times the forces",
    on_readings=_change_all,
    takes_cable=False,
)
ZEROS = replace(
    ALL,
    id="tension_bias",
    summary="the load cells have a wrong zero",
    law="measured tension plus an offset for each cable",
    parameters=(Parameter("offset_{cable}_N", FORCE, _zero, is_optional=True),),
    on_readings=_change_zeros,
)
