"""One attachment point that is not where the drawing of the platform has it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from designer.arrays import frozen_array
from designer.effects.effect import ALL_ATTACHMENTS, Effect, Parameter, Size, Values
from designer.model.machine import Machine
from designer.units import LENGTH


def _change(machine: Machine, values: Values, *, cable: int) -> Machine:
    moved = np.array(machine.robot.attachments_m)
    moved[cable - 1] += [values["x_m"], values["y_m"], values["z_m"]]
    platform = replace(machine.robot.platform, attachments_m=frozen_array(moved))
    return replace(machine, robot=replace(machine.robot, platform=platform))


def _size(machine: Machine) -> Size:
    size = float(np.ptp(machine.robot.attachments_m, axis=0).max()) or 1.0
    return Size(0.01 * size, bounds=(-size, size), plausible=(-0.2 * size, 0.2 * size))


EFFECT = Effect(
    id="attachment_offset",
    summary="the attachment point of cable {cable} is not where the drawing has it",
    law="attachment point plus offset, in the platform's frame",
    source="definition",
    parameters=tuple(
        Parameter(name, LENGTH, _size, is_optional=True) for name in ("x_m", "y_m", "z_m")
    ),
    on_machine=_change,
    can_have=lambda machine: not machine.robot.is_point_mass,
    cause="setting_up",
    takes_cable=True,
    reaches_design=True,
    also_called=ALL_ATTACHMENTS,
)
