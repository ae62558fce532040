"""Whether a platform stays in a pose, and where else it could rest on the same cable lengths."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from designer.arrays import FloatArray
from designer.model.cable import Cable, Cables
from designer.model.robot import Poses, Robot
from designer.statics.equilibria import find_equilibria, spread_poses

_STARTS = 24
_SMALL_TURN_RAD = 1e-3


@dataclass(frozen=True, slots=True)
class RestingPlaces:
    """What forward statics says of a pose.

    Parameters
    ----------
    starts : int
        From how many poses it was searched; more may exist than were found.
    is_stable : bool
        Whether the platform stays in the pose itself.
    others : int
        How many other stable places were found on the same lengths.
    nearest_m, nearest_turn_rad : float
        How far the nearest of them is from the pose [m], and how much it is turned against it
        [rad]; NaN where there is none.
    """

    starts: int
    is_stable: bool
    others: int
    nearest_m: float
    nearest_turn_rad: float

    @property
    def sentence(self) -> str:
        """One sentence for the reader of a report."""
        searched = f"searched from {self.starts} starts"
        if not self.is_stable:
            return f"The platform would not stay here: the balance is not stable ({searched})."
        if not self.others:
            return (
                f"The platform rests here, and on these lengths nowhere else that was found "
                f"({searched})."
            )
        turn = self.nearest_turn_rad
        turned = f", turned by {np.degrees(turn):.0f}°" if turn > _SMALL_TURN_RAD else ""
        where = "one other place" if self.others == 1 else f"{self.others} other places"
        nearest = "" if self.others == 1 else "the nearest "
        return (
            f"The platform rests here, but on the same lengths it could also rest in {where}, "
            f"{nearest}{self.nearest_m:.2g} m away{turned} ({searched})."
        )


def resting_places(
    robot: Robot, pose: Poses, cable: Cable | Cables, length_m: FloatArray
) -> RestingPlaces:
    """Return whether a pose is stable, and where else its lengths let the platform rest.

    Parameters
    ----------
    robot, cable
        The robot and its cables.
    pose : Poses
        One pose in balance, no leading axes.
    length_m : array (n_cables,)
        Unstrained lengths in it [m].
    """
    spread = spread_poses(robot, _STARTS)
    rotation = np.broadcast_to(spread.rotation, (_STARTS, 3, 3))
    starts = Poses(
        np.concatenate([pose.position_m[None], spread.position_m]),
        pose.rotation if robot.is_point_mass else np.concatenate([pose.rotation[None], rotation]),
    )
    found = find_equilibria(robot, cable, length_m, starts)
    own = found.which[0]
    others = found.found.is_stable & (found.which != own)
    away = np.linalg.norm(found.found.poses.position_m - pose.position_m, axis=-1)
    nearest = int(np.argmin(np.where(others, away, np.inf)))
    has_other = bool(others.any())
    turn = 0.0 if robot.is_point_mass else _turn_rad(pose, found.found.poses.rotation[nearest])
    return RestingPlaces(
        starts=len(others),
        is_stable=bool(found.found.is_stable[0]),
        others=int(np.unique(found.which[others]).size),
        nearest_m=float(away[nearest]) if has_other else float("nan"),
        nearest_turn_rad=turn if has_other else float("nan"),
    )


def _turn_rad(pose: Poses, rotation: FloatArray) -> float:
    return float(Rotation.from_matrix(pose.rotation.T @ rotation).magnitude())
