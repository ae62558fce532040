"""Loads on the platform that nobody declared: mass, a constant force or moment, a step, wind."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from designer.arrays import FloatArray, frozen_array
from designer.effects.effect import (
    Effect,
    Parameter,
    Size,
    Values,
    can_turn,
    moves_along,
    platform_extent_m,
    sized_by,
    weight_N,
)
from designer.model.load_case import AIR_DENSITY_KG_PER_M3
from designer.model.measurements import Measured
from designer.model.robot import Machine
from designer.units import AREA, FORCE, MASS, MOMENT, TIME

# A platform heavier or lighter than declared.


def _add_mass(machine: Machine, values: Values) -> Machine:
    platform = machine.robot.platform
    offset = values["offset_kg"]
    heavier = replace(platform, mass_kg=platform.mass_kg + offset, mass_offset_kg=offset)
    return replace(machine, robot=replace(machine.robot, platform=heavier))


def _mass_kg(machine: Machine) -> float:
    return machine.robot.platform.mass_kg


PLATFORM_MASS = Effect(
    id="platform_mass",
    summary="the platform with its payload is heavier or lighter than declared",
    law="mass plus offset",
    source="definition",
    parameters=(
        Parameter(
            "offset_kg", MASS, sized_by(_mass_kg, 0.01, bounds=(-0.9, 10.0), plausible=(-0.3, 0.5))
        ),
    ),
    on_machine=_add_mass,
    reaches_design=True,
)


# A constant force, or moment.


def _add_wrench(machine: Machine, values: Values) -> Machine:
    platform = machine.robot.platform
    names = [f"{axis}_{unit}" for unit in ("N", "N_m") for axis in "xyz"]
    more_N = np.array([values.get(name, 0.0) for name in names])
    platform = replace(
        platform,
        wrench_N=frozen_array(platform.wrench_N + more_N),
        wrench_offset_N=frozen_array(platform.wrench_offset_N + more_N),
    )
    return replace(machine, robot=replace(machine.robot, platform=platform))


_FORCE_SIZE = sized_by(weight_N, 0.01, bounds=(-10.0, 10.0), plausible=(-0.15, 0.15))
"""A hose or a wind that pulls with more than a seventh of the weight would be known."""


def _moment_size(machine: Machine) -> Size:
    """As of such a force at the edge of the platform."""
    force, arm_m = _FORCE_SIZE(machine), platform_extent_m(machine)
    typical, *ends = (arm_m * np.array([force.typical, *force.bounds, *force.plausible])).tolist()
    return Size(typical, (ends[0], ends[1]), plausible=(ends[2], ends[3]))


def _turns_about(axis: int, machine: Machine) -> bool:
    """Tell whether a robot turns about an axis, 0 to 2: about that across its plane, if planar."""
    robot = machine.robot
    is_free = not robot.is_planar or abs(robot.level[1, axis]) > 1e-9
    return not robot.is_point_mass and bool(is_free)


PLATFORM_FORCE = Effect(
    id="platform_force",
    summary="a constant force acts on the platform, as of a hose or a steady wind",
    law="force at the origin of the platform's frame, along the axes of the world frame",
    source="definition",
    parameters=tuple(
        Parameter(
            f"{name}_N", FORCE, _FORCE_SIZE, is_optional=True, can_have=partial(moves_along, axis)
        )
        for axis, name in enumerate("xyz")
    ),
    on_machine=_add_wrench,
    parts=("base_tilt", "platform_mass"),
    reaches_design=True,
)
PLATFORM_MOMENT = replace(
    PLATFORM_FORCE,
    id="platform_moment",
    summary="a constant moment acts on the platform, as of a hose that pulls beside its origin",
    law="moment on the platform, about the axes of the world frame",
    parameters=tuple(
        Parameter(
            f"{name}_N_m",
            MOMENT,
            _moment_size,
            is_optional=True,
            can_have=partial(_turns_about, axis),
        )
        for axis, name in enumerate("xyz")
    ),
    can_have=can_turn,
    needs=frozenset({"rotation"}),
    parts=(),
)


# A load that is put on the platform, or taken off, during the measurements.

LEAST_ROWS = 5
"""On either side of a step: fewer have no mean to speak of."""


class BestStep(NamedTuple):
    """Where a step explains most: its share of the variance, its first row, its channel."""

    share: float
    row: int
    channel: int


def best_step(channels: FloatArray) -> BestStep:
    """Return where one step explains most; channels have no mean (n_rows, n_channels)."""
    n = len(channels)
    at = np.arange(LEAST_ROWS, n - LEAST_ROWS + 1)
    sums = np.cumsum(channels, axis=0)[at - 1]
    share = (
        sums**2 * (n / (at * (n - at)))[:, None] / np.maximum(np.sum(channels**2, axis=0), 1e-300)
    )
    which, channel = np.unravel_index(int(np.argmax(share)), share.shape)
    return BestStep(float(share[which, channel]), int(at[which]), int(channel))


def _step_starts(measured: Measured, residual: FloatArray) -> tuple[dict[str, float], ...]:
    """Start where the mean of all tensions, or else of all lengths, steps most."""
    assert measured.time_s is not None
    n = residual.shape[1] // 2
    for kind in (residual[:, n:], residual[:, :n]):
        is_read = ~np.isnan(kind)
        rows = np.flatnonzero(is_read.any(axis=1))
        if len(rows) < 2 * LEAST_ROWS:
            continue
        mean = np.nan_to_num(kind).sum(axis=1)[rows] / is_read.sum(axis=1)[rows]
        row = rows[best_step((mean - mean.mean())[:, None]).row]
        middle = 0.5 * (measured.time_s[row - 1] + measured.time_s[row])
        return ({"time_s": float(middle)},)
    return ()


_STEP_LOOKS = 6
"""How much more probable by chance the gain at the best of all times is than that of two numbers.

In white noise of 60 rows it is 4, of 200 rows 7, at one in 100, with five rows on each side."""
_STEP_SIZE = sized_by(_mass_kg, 0.02, bounds=(-0.95, 20.0), plausible=(-1.0, 1.0))
_STEP_TIME = Size(1.0, bounds=(-1e9, 1e9), plausible=(-1e9, 1e9))

LOAD_STEP = Effect(
    id="load_step",
    summary="the load on the platform changes at a time",
    law="platform mass plus offset from that time on, at the origin of the body's frame",
    source="definition",
    parameters=(
        Parameter("offset_kg", MASS, _STEP_SIZE),
        Parameter("time_s", TIME, _STEP_TIME, is_shape=True, is_step_time=True),
    ),
    on_machine=lambda machine, values: replace(
        machine, late_load_kg=values["offset_kg"], late_load_from_s=values["time_s"]
    ),
    needs=frozenset({"time"}),
    starts_from=_step_starts,
    looks=_STEP_LOOKS,
)


# Wind on the platform.


def _area_m2(machine: Machine) -> float:
    """Return the area on which a wind of 10 m/s pulls with a hundredth of the weight."""
    return machine.robot.weight_N / 6000.0


WIND_DRAG = Effect(
    id="wind_drag",
    summary="the wind pushes the platform",
    law=f"force ½ ρ |v| v C_d A with ρ = {AIR_DENSITY_KG_PER_M3:g} kg/m³",
    source="EN 1991-1-4, 4.5 (air density); definition of the drag area",
    parameters=(
        Parameter(
            "drag_area_m2", AREA, sized_by(_area_m2, 1.0, bounds=(0.0, 1e4), plausible=(0.0, 100.0))
        ),
    ),
    on_machine=lambda machine, values: replace(machine, drag_area_m2=values["drag_area_m2"]),
    needs=frozenset({"wind"}),
)
