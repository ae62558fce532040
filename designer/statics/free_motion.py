"""A motion of the platform that no cable resists, in all poses alike: known before any is solved.

Straight cables resist a motion t of the platform by their structure matrix: where its rank is less
than the degrees of freedom, some t has W'ᵀ t = 0. Sagging cables pull in the vertical planes of
their chords, so none of them resists t where that holds of the horizontal and the vertical force of
each cable alike, as with a turn about a vertical axis that all these planes meet.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from designer.arrays import FloatArray, frozen_array
from designer.model.robot import Poses, Robot
from designer.spelling import vector
from designer.statics.geometry import cable_geometry, density_matrix, structure_matrix
from designer.statics.pulleys import straight_run

_NOTHING = 1e-9
"""Singular value over the largest one that is rounding."""
_SAME = 1e-6
"""Part of a motion that counts as none, and cosine short of one between equal directions."""


@dataclass(frozen=True, slots=True, eq=False)
class FreeMotion:
    """A motion that stays free in every pose of a study.

    Parameters
    ----------
    kind : str
        ``turn``, ``move``, or ``mixed`` where it differs from pose to pose.
    axis : array (3,)
        Its direction, base frame; NaN where it is ``mixed``.
    of_any_cable : bool
        Whether sagging cables do not resist it either.
    poses : int
        In how many poses that was seen, which are all that were looked at.
    """

    kind: str
    axis: FloatArray
    of_any_cable: bool
    poses: int = field(metadata={"json": None})

    @property
    def words(self) -> str:
        """What the platform can do, for a sentence."""
        names = ("x axis", "y axis", "z axis")
        along = np.flatnonzero(np.abs(self.axis) > 1.0 - _SAME)
        line = vector(self.axis, 3)
        axis = f"the {names[along[0]]}" if len(along) else f"the direction {line}"
        return {
            "turn": f"turns freely about {axis}",
            "move": f"moves freely along {axis}",
            "mixed": "moves freely in a direction that differs from pose to pose",
        }[self.kind]

    @property
    def clause(self) -> str:
        """Why no pose is held, in a clause."""
        where = "in every pose" if self.poses > 1 else "there"
        cables = "cable" if self.of_any_cable else "straight cable"
        return f"the platform {self.words} {where}: no {cables} resists that, whatever the rope"


def free_motion(robot: Robot, poses: Poses) -> FreeMotion | None:
    """Return the motion that is free in all of these poses (n,); None where there is none."""
    dof = robot.degrees_of_freedom
    if robot.n_cables < dof:
        return None
    geometry = cable_geometry(robot, poses, straight_run(robot, poses).exit_points_m)
    reach_m = float(np.linalg.norm(geometry.lever_m, axis=-1).max()) or 1.0
    scale = np.where(robot.balance_rows < 3, 1.0, 1.0 / reach_m)[:, None]
    straight = density_matrix(robot, geometry) * scale
    if (geometry.chord_m == 0.0).any():  # in an exit point no cable has a direction
        return None
    length = np.linalg.norm(straight, axis=-2, keepdims=True)
    straight = np.divide(straight, length, out=straight, where=length > 0.0)
    left, values, _ = np.linalg.svd(straight)
    if (values[:, -1] > _NOTHING * values[:, 0]).any():
        return None
    motion = np.zeros((len(left), 6))  # of the slowest, unless more than one is free
    motion[:, robot.balance_rows] = left[..., -1]
    resisted = np.einsum("nd,ndk->nk", left[..., -1], structure_matrix(robot, geometry) * scale)
    of_any_cable = bool((np.abs(resisted) < _SAME).all())
    moves, turns = motion[:, :3], motion[:, 3:]
    for kind, part, other in (("turn", turns, moves), ("move", moves, turns)):
        size = np.linalg.norm(part, axis=1, keepdims=True)
        is_kind = (size > _SAME).all() if kind == "turn" else (np.abs(other) < _SAME).all()
        if is_kind and (np.abs(part @ part[0]) > (1.0 - _SAME) * size[:, 0] * size[0]).all():
            axis = (part[0] / size[0]) @ robot.upright
            axis = axis * np.sign(axis[np.abs(axis).argmax()])
            return FreeMotion(kind, frozen_array(axis), of_any_cable, len(left))
    return FreeMotion("mixed", frozen_array(np.full(3, np.nan)), of_any_cable, len(left))
