"""One exit point that is not where the drawing has it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from designer.arrays import frozen_array
from designer.effects.effect import ALL_ANCHORS, Effect, Parameter, Size, Values, frame_size_m
from designer.model.machine import Machine
from designer.units import LENGTH


def _change(machine: Machine, values: Values, *, cable: int) -> Machine:
    moved = np.array(machine.robot.exit_points_m)
    moved[cable - 1] += [values.get(name, 0.0) for name in ("x_m", "y_m", "z_m")]
    return replace(machine, robot=replace(machine.robot, exit_points_m=frozen_array(moved)))


def _size(machine: Machine) -> Size:
    size = frame_size_m(machine)
    return Size(1e-3 * size, bounds=(-size, size), plausible=(-0.02 * size, 0.02 * size))


EFFECT = Effect(
    id="anchor_offset",
    summary="the exit point of cable {cable} is not where the drawing has it",
    law="exit point plus offset",
    source="definition",
    parameters=tuple(
        Parameter(name, LENGTH, _size, is_optional=True) for name in ("x_m", "y_m", "z_m")
    ),
    on_machine=_change,
    takes_cable=True,
    reaches_design=True,
    also_called=ALL_ANCHORS,
)
