"""Whether a platform stays in a pose, and where else it could rest on the same cable lengths."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.spatial.transform import Rotation

from designer.arrays import FloatArray, IntArray
from designer.model.cable import Cable, Cables
from designer.model.robot import Poses, Robot
from designer.statics.forward import ForwardStatics, solve_forward
from designer.statics.stiffness import reach_m

_STARTS = 24


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
    is_stable: bool = field(metadata={"json": "stable"})
    others: int = field(metadata={"json": "other_places"})
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
        turned_by = f", turned by {np.degrees(turn):.0f}°" if turn > 1e-3 else ""
        elsewhere = "one other place" if self.others == 1 else f"{self.others} other places"
        nearest = "" if self.others == 1 else "the nearest "
        return (
            f"The platform rests here, but on the same lengths it could also rest in {elsewhere}, "
            f"{nearest}{self.nearest_m:.2g} m away{turned_by} ({searched})."
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
    starts = Poses(
        np.concatenate([pose.position_m[None], spread.position_m]),
        pose.rotation
        if robot.is_point_mass
        else np.concatenate([pose.rotation[None], spread.rotations]),
    )
    equilibria = find_equilibria(robot, cable, length_m, starts)
    own_place = equilibria.which[0]
    others = equilibria.found.is_stable & (equilibria.which != own_place)
    away = np.linalg.norm(equilibria.found.poses.position_m - pose.position_m, axis=-1)
    nearest = int(np.argmin(np.where(others, away, np.inf)))
    has_other = bool(others.any())
    turn = 0.0
    if not robot.is_point_mass:
        relative_rotation = pose.rotation.T @ equilibria.found.poses.rotation[nearest]
        turn = float(Rotation.from_matrix(relative_rotation).magnitude())
    return RestingPlaces(
        starts=len(others),
        is_stable=bool(equilibria.found.is_stable[0]),
        others=int(np.unique(equilibria.which[others]).size),
        nearest_m=float(away[nearest]) if has_other else float("nan"),
        nearest_turn_rad=turn if has_other else float("nan"),
    )


@dataclass(frozen=True, slots=True, eq=False)
class Equilibria:
    """What forward statics found from several starts.

    Parameters
    ----------
    found : ForwardStatics
        The balance from each start (..., n_starts).
    which : array (..., n_starts) of int
        Number of the balance, counted from 0 in the order of the starts; -1 where none was found.
    n_stable : array (...) of int
        How many different stable balances were found.
    """

    found: ForwardStatics
    which: IntArray
    n_stable: IntArray


def find_equilibria(
    robot: Robot,
    cable: Cable | Cables,
    length_m: FloatArray,
    starts: Poses,
    *,
    with_unstable: bool = False,
) -> Equilibria:
    """Solve the forward statics from every start, and tell the results apart.

    More may exist than are found; more starts make that less likely. ``with_unstable`` begins a
    second search at each start, which goes to any balance.

    Parameters
    ----------
    robot, cable
        The robot and its cables.
    length_m : array (..., n_cables)
        Unstrained lengths [m].
    starts : Poses
        Poses (n_starts,), such as `spread_poses`, the same for all problems.
    """
    to_any = None
    if with_unstable:
        to_any = np.repeat([False, True], starts.shape[0])
        starts = Poses(np.tile(starts.position_m, (2, 1)), np.tile(starts.rotations, (2, 1, 1)))
    length_m = np.asarray(length_m)[..., None, :]
    forward_statics = solve_forward(robot, cable, length_m, starts, to_any=to_any)
    places = forward_statics.poses.position_m
    if not robot.is_point_mass:  # turned axes times reach, so that poses compare as points
        axes = forward_statics.poses.rotation.reshape(*places.shape[:-1], 9)
        places = np.concatenate([places, reach_m(robot) * axes], axis=-1)
    shape = places.shape[:-2]
    flat = places.reshape(-1, *places.shape[-2:])
    size = float(np.linalg.norm(np.ptp(robot.exit_points_m, axis=0)))
    # So near to each other two balances are the same one.
    which = np.array([_group(row, 1e-6 * size) for row in flat]).reshape(*shape, -1)
    stable = np.where(forward_statics.is_stable, which, -1).reshape(-1, places.shape[-2])
    n_stable = np.array([len(set(row) - {-1}) for row in stable.tolist()]).reshape(shape)
    return Equilibria(forward_statics, which, n_stable)


def spread_poses(robot: Robot, count: int, largest_turn_rad: float = 0.5) -> Poses:
    """Return poses to start from: under the exit points, turned by up to some angle (count,).

    Those of a planar robot lie in its plane.

    Parameters
    ----------
    robot : Robot
        Its exit points span the plan; they go down from the highest by half their extent.
    count : int
        How many poses; the first is in the middle and not turned.
    largest_turn_rad : float
        Largest angle of the random turns [rad].
    """
    rng = np.random.default_rng(0)
    upright = robot.upright
    exits = robot.exit_points_m @ upright.T
    weights = rng.dirichlet(np.ones(len(exits)), count)
    weights[0] = 1.0 / len(exits)
    position = weights @ exits
    extent = float(np.linalg.norm(np.ptp(exits, axis=0)))
    depth = rng.uniform(0.05, 0.5, count)
    depth[0] = 0.25
    position[:, 2] = exits[:, 2].max() - depth * extent
    position = position @ upright
    if robot.is_point_mass:
        return Poses.at(position)
    axis = rng.normal(size=(count, 3))
    if robot.is_planar:
        axis = axis[:, :1] * upright[1]
    axis /= np.linalg.norm(axis, axis=1, keepdims=True)
    turn = largest_turn_rad * rng.uniform(size=(count, 1)) * axis
    turn[0] = 0.0
    return Poses.at(position, turn)


def _group(places_m: FloatArray, tolerance_m: float) -> list[int]:
    """Return a number for each place (n_starts, ·), equal for equal places; -1 for NaN."""
    kinds: list[FloatArray] = []
    which = []
    for place in places_m:
        kind_index = [
            k for k, kind in enumerate(kinds) if np.abs(place - kind).max() <= tolerance_m
        ]
        if not np.isfinite(place).all():
            kind_index = [-1]
        elif not kind_index:
            kind_index = [len(kinds)]
            kinds.append(place)
        which.append(kind_index[0])
    return which
