"""What becomes of a platform in a pose when one of its cables is gone, or all get warmer.

The other cables keep the lengths that they had, as on braked winches, but for what warmth adds to
them, and the platform comes to rest on these, if it does anywhere: near the pose where they still
hold it, else elsewhere. What the loss itself sets swinging is not in this: it is the state after
that.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import Self

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.model.cable import Cable
from designer.model.robot import Poses, Robot
from designer.statics.forward import solve_forward
from designer.statics.inverse import Statics, solve_sagging

_NEAR = 0.01


class Fate(IntEnum):
    """What becomes of the platform, with the words for readers of a report."""

    words: str

    def __new__(cls, code: int, words: str = "") -> Self:
        """Return the member of this code with its words."""
        fate = int.__new__(cls, code)
        fate._value_ = code
        fate.words = words
        return fate

    HOLDS = 0, "the other cables hold the platform where it is"
    RESTS_ELSEWHERE = 1, "the platform comes to rest elsewhere"
    FALLS = 2, "no place was found where the platform comes to rest: it falls"
    NOT_HELD = 3, "the pose is not held with all cables either"

    @property
    def label(self) -> str:
        """Its name in result files."""
        return self.name.lower()


@dataclass(frozen=True, slots=True, eq=False)
class CableLoss:
    """The state after the loss of a cable, or a change of temperature."""

    fate: IntArray  #: (n_poses,) one `Fate` a pose
    before: Statics  #: with all cables (n_poses,); the others keep the lengths that they have there
    #: (n_poses, n_cables) largest tension anywhere in each cable at rest, 0 in the lost one; NaN
    #: where there is no rest [N]
    tension_N: FloatArray
    rest: Poses  #: where the platform is then (n_poses,); NaN where nowhere
    moved_m: FloatArray  #: (n_poses,) how far the origin of its frame has moved [m]
    #: of the cables that are left, at rest, in the poses that were held with all cables
    statics: Statics

    @property
    def largest_tension_N(self) -> FloatArray:
        """Largest of these tensions (n_poses,); inf where there is no rest [N]."""
        return np.asarray(np.nan_to_num(self.tension_N.max(axis=1), nan=np.inf))


def settle(
    robot: Robot,
    poses: Poses,
    cable: Cable,
    lost: int | None = None,
    growth: float = 0.0,
) -> CableLoss:
    """Return what becomes of poses (n_poses,) on kept lengths.

    ``lost`` is a cable that is gone, counted from 1, and ``growth`` the strain that warmth adds to
    the unstrained lengths, what lies on pulleys included.

    The search for a rest starts in the pose and follows falling energy; a balance that is not
    stable is no rest. Where the platform moves by less than a hundredth of the cables' mean length,
    the others are said to hold it.
    """
    before = solve_sagging(robot, poses, cable)
    count, at = len(poses.position_m), np.flatnonzero(before.is_solved)
    fate = np.where(before.is_solved, Fate.FALLS, Fate.NOT_HELD).astype(np.int64)
    tension = np.full((count, robot.n_cables), np.nan)
    position = np.full((count, 3), np.nan)
    rotation = np.array(poses.rotations)
    cables = np.arange(robot.n_cables)
    remaining = cables if lost is None else np.delete(cables, lost - 1)
    start = Poses(poses.position_m[at], rotation[at])
    reduced_robot, reduced_cable = robot, cable
    if lost is not None:
        reduced_robot, reduced_cable = robot.without_cable(lost), cable.without(lost)
    length = (1.0 + growth) * before.length_m[at][:, remaining]
    forward_statics = solve_forward(reduced_robot, reduced_cable, length, start)
    rests, at = forward_statics.is_stable, at[forward_statics.is_stable]
    tension[at] = 0.0
    tension[np.ix_(at, remaining)] = forward_statics.statics.cable_tension_N[rests]
    position[at] = forward_statics.poses.position_m[rests]
    if not robot.is_point_mass:
        rotation[at] = forward_statics.poses.rotation[rests]
    moved = np.linalg.norm(position - poses.position_m, axis=1)
    is_near = moved[at] <= _NEAR * before.length_m[at].mean(axis=1)
    fate[at] = np.where(is_near, Fate.HOLDS, Fate.RESTS_ELSEWHERE)
    return CableLoss(
        fate, before, tension, Poses(position, rotation), moved, forward_statics.statics
    )
