"""A constant force, or moment, on the platform that nobody declared."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from designer.arrays import frozen_array
from designer.effects.effect import Effect, Parameter, Size, Values
from designer.effects.poses import moves_along
from designer.model.machine import Machine
from designer.units import FORCE, MOMENT


def _change(machine: Machine, values: Values) -> Machine:
    platform = machine.robot.platform
    names = [f"{axis}_{unit}" for unit in ("N", "Nm") for axis in "xyz"]
    more_N = np.array([values.get(name, 0.0) for name in names])
    platform = replace(
        platform,
        wrench_N=frozen_array(platform.wrench_N + more_N),
        wrench_offset_N=frozen_array(platform.wrench_offset_N + more_N),
    )
    return replace(machine, robot=replace(machine.robot, platform=platform))


def _size(machine: Machine) -> Size:
    """A hose or a wind that pulls with more than a seventh of the weight would be known."""
    weight, limit = machine.robot.weight_N, 0.15 * machine.robot.weight_N
    return Size(0.01 * weight, bounds=(-10 * weight, 10 * weight), plausible=(-limit, limit))


def _size_of_moment(machine: Machine) -> Size:
    """As of such a force at the edge of the platform."""
    force, arm_m = _size(machine), float(np.ptp(machine.robot.attachments_m, axis=0).max())
    typical, *ends = (arm_m * np.array([force.typical, *force.bounds, *force.plausible])).tolist()
    return Size(typical, (ends[0], ends[1]), plausible=(ends[2], ends[3]))


def _turns_about(axis: int, machine: Machine) -> bool:
    """Tell whether a robot turns about an axis, 0 to 2: about that across its plane, if planar."""
    robot = machine.robot
    is_free = not robot.is_planar or abs(robot.level[1, axis]) > 1e-9
    return not robot.is_point_mass and bool(is_free)


EFFECT = Effect(
    id="platform_force",
    summary="a constant force acts on the platform, as of a hose or a steady wind",
    law="force at the origin of the platform's frame, along the axes of the world frame",
    source="definition",
    parameters=tuple(
        Parameter(f"{name}_N", FORCE, _size, is_optional=True, can_have=partial(moves_along, axis))
        for axis, name in enumerate("xyz")
    ),
    on_machine=_change,
    parts=("base_tilt", "platform_mass"),
    reaches_design=True,
)
TURNING = replace(
    EFFECT,
    id="platform_moment",
    summary="a constant moment acts on the platform, as of a hose that pulls beside its origin",
    law="moment on the platform, about the axes of the world frame",
    parameters=tuple(
        Parameter(
            f"{name}_Nm",
            MOMENT,
            _size_of_moment,
            is_optional=True,
            can_have=partial(_turns_about, axis),
        )
        for axis, name in enumerate("xyz")
    ),
    can_have=lambda machine: not machine.robot.is_point_mass,
    needs=frozenset({"rotation"}),
    parts=(),
)
