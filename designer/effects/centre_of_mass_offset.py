"""A centre of mass that is not where the drawing has it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from designer.arrays import frozen_array
from designer.effects.effect import Effect, Parameter, Size, Values
from designer.model.machine import Machine
from designer.units import LENGTH

_SIZE = Size(0.01, bounds=(-5.0, 5.0), plausible=(-0.5, 0.5))


def _change(machine: Machine, values: Values) -> Machine:
    platform = machine.robot.platform
    offset = np.array([values["x_m"], values["y_m"], values["z_m"]])
    moved = replace(platform, centre_of_mass_m=frozen_array(platform.centre_of_mass_m + offset))
    return replace(machine, robot=replace(machine.robot, platform=moved))


EFFECT = Effect(
    id="centre_of_mass_offset",
    summary="the centre of mass is not where the drawing has it",
    law="centre of mass plus offset, body frame",
    source="definition",
    parameters=tuple(
        Parameter(name, LENGTH, _SIZE, is_optional=True) for name in ("x_m", "y_m", "z_m")
    ),
    on_machine=_change,
    needs=frozenset({"rotation"}),
    can_have=lambda machine: not machine.robot.is_point_mass,
    reaches_design=True,
)
