"""A constant force on the platform that nobody declared."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from designer.arrays import frozen_array
from designer.effects.effect import Effect, Parameter, Size, Values
from designer.effects.poses import moves_along
from designer.model.machine import Machine
from designer.units import FORCE


def _change(machine: Machine, values: Values) -> Machine:
    platform = machine.robot.platform
    more_N = np.array([values.get(f"{axis}_N", 0.0) for axis in "xyz"])
    force_N = frozen_array(platform.centre_force_N + more_N)
    platform = replace(platform, centre_force_N=force_N)  # which no load case replaces
    return replace(machine, robot=replace(machine.robot, platform=platform))


def _size(machine: Machine) -> Size:
    """A hose or a wind that pulls with more than a seventh of the weight would be known."""
    weight, most = machine.robot.weight_N, 0.15 * machine.robot.weight_N
    return Size(0.01 * weight, bounds=(-10 * weight, 10 * weight), plausible=(-most, most))


EFFECT = Effect(
    id="platform_force",
    summary="a constant force acts on the platform, as of a hose or a steady wind",
    law="force at the centre of mass, along the axes of the world frame",
    source="definition",
    parameters=tuple(
        Parameter(f"{name}_N", FORCE, _size, is_optional=True, can_have=partial(moves_along, axis))
        for axis, name in enumerate("xyz")
    ),
    on_machine=_change,
    parts=("base_tilt", "platform_mass"),
    reaches_design=True,
)
