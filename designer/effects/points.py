"""Exit points, attachment points, a centre of mass that are not where the drawing has them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from designer.arrays import FloatArray, frozen_array
from designer.effects.effect import (
    ALL_ANCHORS,
    ALL_ATTACHMENTS,
    Effect,
    Parameter,
    Size,
    Values,
    frame_size_m,
)
from designer.model.machine import Machine
from designer.units import LENGTH


def _offset(values: Values) -> FloatArray:
    return np.array([values.get(f"{axis}_m", 0.0) for axis in "xyz"])


def _moved(points_m: FloatArray, values: Values, cable: int) -> FloatArray:
    moved = np.array(points_m)
    moved[cable - 1] += _offset(values)
    return frozen_array(moved)


def _move_exit(machine: Machine, values: Values, *, cable: int) -> Machine:
    exits_m = _moved(machine.robot.exit_points_m, values, cable)
    return replace(machine, robot=replace(machine.robot, exit_points_m=exits_m))


def _move_attachment(machine: Machine, values: Values, *, cable: int) -> Machine:
    attachments_m = _moved(machine.robot.attachments_m, values, cable)
    platform = replace(machine.robot.platform, attachments_m=attachments_m)
    return replace(machine, robot=replace(machine.robot, platform=platform))


def _move_centre(machine: Machine, values: Values) -> Machine:
    platform = machine.robot.platform
    centre_m = frozen_array(platform.centre_of_mass_m + _offset(values))
    platform = replace(platform, centre_of_mass_m=centre_m)
    return replace(machine, robot=replace(machine.robot, platform=platform))


def _of_exit(machine: Machine) -> Size:
    size = frame_size_m(machine)
    return Size(1e-3 * size, bounds=(-size, size), plausible=(-0.02 * size, 0.02 * size))


def _of_attachment(machine: Machine) -> Size:
    size = float(np.ptp(machine.robot.attachments_m, axis=0).max()) or 1.0
    return Size(0.01 * size, bounds=(-size, size), plausible=(-0.2 * size, 0.2 * size))


def _is_body(machine: Machine) -> bool:
    return not machine.robot.is_point_mass


EXIT = Effect(
    id="anchor_offset",
    summary="the exit point of cable {cable} is not where the drawing has it",
    law="exit point plus offset",
    source="definition",
    parameters=tuple(Parameter(f"{a}_m", LENGTH, _of_exit, is_optional=True) for a in "xyz"),
    on_machine=_move_exit,
    takes_cable=True,
    reaches_design=True,
    also_called=ALL_ANCHORS,
)
ATTACHMENT = replace(
    EXIT,
    id="attachment_offset",
    summary="the attachment point of cable {cable} is not where the drawing has it",
    law="attachment point plus offset, in the platform's frame",
    parameters=tuple(replace(p, size=_of_attachment) for p in EXIT.parameters),
    on_machine=_move_attachment,
    can_have=_is_body,
    cause="setting_up",
    also_called=ALL_ATTACHMENTS,
)
CENTRE = Effect(
    id="centre_of_mass_offset",
    summary="the centre of mass is not where the drawing has it",
    law="centre of mass plus offset, body frame",
    source="definition",
    parameters=tuple(
        replace(p, size=Size(0.01, bounds=(-5.0, 5.0), plausible=(-0.5, 0.5)))
        for p in EXIT.parameters
    ),
    on_machine=_move_centre,
    needs=frozenset({"rotation"}),
    can_have=_is_body,
    reaches_design=True,
)
