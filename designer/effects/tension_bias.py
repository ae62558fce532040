"""Load cells with a wrong zero."""

from __future__ import annotations

from dataclasses import replace

from designer.effects.effect import Effect, Parameter, Readings, Size, Values, per_cable
from designer.model.machine import Machine
from designer.model.measured_data import Measured
from designer.units import FORCE


def _change(readings: Readings, values: Values, measured: Measured) -> Readings:
    offsets = per_cable(values, "offset_{cable}_N", readings.tension_N.shape[1])
    return replace(readings, tension_N=readings.tension_N + offsets)


def _size(machine: Machine) -> Size:
    weight = machine.robot.weight_N
    return Size(0.01 * weight, bounds=(-10 * weight, 10 * weight), plausible=(-weight, weight))


EFFECT = Effect(
    id="tension_bias",
    summary="the load cells have a wrong zero",
    law="measured tension plus an offset for each cable",
    source="definition",
    parameters=(Parameter("offset_{cable}_N", FORCE, _size, is_optional=True),),
    on_readings=_change,
    needs=frozenset({"tension"}),
)
