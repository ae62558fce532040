"""Poses measured on a scale that is not the robot's."""

from __future__ import annotations

from dataclasses import replace

from designer.effects.effect import Effect, Parameter, Size, Values
from designer.effects.pose_shift import in_plane
from designer.model.machine import Machine
from designer.model.robot import Poses
from designer.units import NUMBER

SCALE = Parameter(
    "scale",
    NUMBER,
    Size(1e-3, bounds=(0.5, 2.0), plausible=(0.9, 1.1)),
    neutral=1.0,
    above=0.0,
    part_of=("pose_frame",),
)


def _change(poses: Poses, values: Values, *, machine: Machine) -> Poses:
    moves = poses.position_m / values["scale"] - poses.position_m
    return replace(poses, position_m=poses.position_m + in_plane(machine, moves))


EFFECT = Effect(
    id="pose_scale",
    summary="the scale of the measured poses is wrong",
    law="measured position is scale times the true one, about the origin of the robot's frame",
    source="definition",
    parameters=(SCALE,),
    on_poses=_change,
    cause="setting_up",
    needs=frozenset({"pose"}),
    takes_machine=True,
)
