"""Poses measured in a frame that is not the robot's: shifted, turned and scaled."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from designer.effects.effect import Effect, Parameter, Size, Values
from designer.effects.pose_scale import SCALE
from designer.effects.pose_shift import shift_of, shift_parameters
from designer.model.machine import Machine
from designer.model.robot import Poses
from designer.units import ANGLE

_TURN = Size(2e-3, bounds=(-1.6, 1.6), plausible=(-0.5, 0.5))


def _change(poses: Poses, values: Values, *, machine: Machine) -> Poses:
    """Take the frame's scale, turn and shift back, the turn and the scale about the exit points.

    Their middle is a point that no log moves: what one log tells is right for another.
    """
    middle = machine.robot.exit_points_m.mean(axis=0)
    vector = np.array([values[f"r{axis}_rad"] for axis in "xyz"])
    turn = Rotation.from_rotvec(vector).as_matrix()
    from_middle = poses.position_m - middle - shift_of(machine, values)
    position = middle + from_middle @ turn / values["scale"]
    if machine.robot.is_point_mass:
        return replace(poses, position_m=position)
    return Poses(position, turn.T @ poses.rotation)


EFFECT = Effect(
    id="pose_frame",
    summary="the frame of the measured poses is not the robot's",
    law="measured pose is the true one turned by (rx, ry, rz) and scaled about the middle of the "
    "exit points, plus an offset",
    source="definition; Umeyama, IEEE Trans. Pattern Anal. Mach. Intell. 13, 1991",
    parameters=(
        *shift_parameters(),
        *(Parameter(f"r{axis}_rad", ANGLE, _TURN, is_optional=True) for axis in "xyz"),
        replace(SCALE, is_optional=True),
    ),
    on_poses=_change,
    can_have=lambda machine: not machine.robot.is_planar,
    cause="setting_up",
    needs=frozenset({"pose"}),
    takes_machine=True,
)
