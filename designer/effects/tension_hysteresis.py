"""Friction that does not grow with the load: in gears, bearings or load cells."""

from __future__ import annotations

from dataclasses import replace

from designer.effects.backlash import direction_of
from designer.effects.effect import Effect, Parameter, Readings, Size, Values, per_cable
from designer.model.machine import Machine
from designer.model.measured_data import Measured
from designer.units import FORCE


def _change(readings: Readings, values: Values, measured: Measured) -> Readings:
    widths_N = per_cable(values, "width_{cable}_N", readings.tension_N.shape[1])
    less_N = 0.5 * widths_N * direction_of(readings.length_m)
    return replace(readings, tension_N=readings.tension_N - less_N)


def _size(machine: Machine) -> Size:
    weight = machine.robot.weight_N
    return Size(0.01 * weight, bounds=(-weight, weight), plausible=(-0.5 * weight, 0.5 * weight))


EFFECT = Effect(
    id="tension_hysteresis",
    summary="tensions read less while paying out and more while hauling in, whatever the load",
    law="measured tension is less by half the width while paying out, and more while hauling in",
    source="Coulomb friction",
    parameters=(Parameter("width_{cable}_N", FORCE, _size, is_optional=True),),
    on_readings=_change,
    needs=frozenset({"tension", "reversals"}),
    follows_rows=True,
)
