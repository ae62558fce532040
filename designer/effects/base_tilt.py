"""A base that does not stand upright."""

from __future__ import annotations

from dataclasses import replace

from designer.arrays import frozen_array
from designer.effects.effect import Effect, Parameter, Size, Values
from designer.model.machine import Machine
from designer.units import ANGLE

_SIZE = Size(2e-3, bounds=(-0.5, 0.5), plausible=(-0.1, 0.1))


def _change(machine: Machine, values: Values) -> Machine:
    tilt = frozen_array([values["rx_rad"], values["ry_rad"]])
    return replace(machine, robot=replace(machine.robot, tilt_rad=tilt))


EFFECT = Effect(
    id="base_tilt",
    summary="gravity is not along the frame's -z: the base stands tilted",
    law="the base frame is turned by the rotation vector (rx, ry, 0) against the vertical",
    source="definition",
    parameters=tuple(
        Parameter(name, ANGLE, _SIZE, is_optional=True) for name in ("rx_rad", "ry_rad")
    ),
    on_machine=_change,
    reaches_design=True,
)
