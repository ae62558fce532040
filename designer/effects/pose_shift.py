"""Poses measured from a zero that is not the robot's."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from designer.arrays import FloatArray
from designer.effects.effect import Effect, Parameter, Size, Values, frame_size_m
from designer.model.machine import Machine
from designer.model.robot import Poses
from designer.units import LENGTH


def size_of_shift(machine: Machine) -> Size:
    """As far as half the frame's size is believed: a camera may stand anywhere."""
    size = frame_size_m(machine)
    return Size(1e-3 * size, bounds=(-size, size), plausible=(-0.5 * size, 0.5 * size))


def in_plane(machine: Machine, moves_m: FloatArray) -> FloatArray:
    """Return moves (..., 3) [m], of a planar robot without what is across its plane."""
    if not machine.robot.is_planar:
        return moves_m
    across = machine.robot.level[1]
    return np.asarray(moves_m - (moves_m @ across)[..., None] * across)


def shift_of(machine: Machine, values: Values) -> FloatArray:
    """Return x, y and z (3,) [m], in the plane of a planar robot."""
    return in_plane(machine, np.array([values.get(f"{axis}_m", 0.0) for axis in "xyz"]))


def shift_parameters() -> tuple[Parameter, ...]:
    """Return x, y and z, without an axis that is across the plane of a planar robot."""
    return tuple(
        Parameter(
            f"{name}_m",
            LENGTH,
            size_of_shift,
            is_optional=True,
            can_have=partial(_moves_along, axis),
            part_of=("pose_frame",),
        )
        for axis, name in enumerate("xyz")
    )


def _moves_along(axis: int, machine: Machine) -> bool:
    return not machine.robot.is_planar or bool(abs(machine.robot.level[1, axis]) < 1.0 - 1e-9)


def _change(poses: Poses, values: Values, *, machine: Machine) -> Poses:
    return replace(poses, position_m=poses.position_m - shift_of(machine, values))


EFFECT = Effect(
    id="pose_shift",
    summary="the zero of the measured poses is not the robot's",
    law="measured position is the true one plus an offset",
    source="definition",
    parameters=shift_parameters(),
    on_poses=_change,
    cause="setting_up",
    needs=frozenset({"pose"}),
    takes_machine=True,
)
