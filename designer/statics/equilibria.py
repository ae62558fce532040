"""All balances that a robot with cables of given lengths can come to rest in."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from designer.arrays import BoolArray, FloatArray, IntArray
from designer.model.cable import Cable, Cables
from designer.model.robot import Poses, Robot
from designer.statics.forward import ForwardStatics, solve_forward
from designer.statics.stiffness import reach_m

_SAME = 1e-6


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

    @property
    def is_ambiguous(self) -> BoolArray:
        """Problems (...) in which the lengths leave the platform a choice where to rest."""
        return np.asarray(self.n_stable > 1)

    @property
    def first_stable(self) -> IntArray:
        """The first start (...) that led to a stable balance; -1 where none did."""
        stable = self.found.is_stable
        return np.where(stable.any(axis=-1), np.argmax(stable, axis=-1), -1)

    def note(self) -> str:
        """Return a sentence on what was found."""
        starts = self.which.shape[-1]
        none, several = int((self.n_stable == 0).sum()), int(self.is_ambiguous.sum())
        if self.n_stable.ndim == 0:
            count = int(self.n_stable)
            noun = "stable equilibrium was" if count == 1 else "stable equilibria were"
            return f"{count or 'No'} {noun} found from {starts} starts."
        return (
            f"Of {self.n_stable.size} problems, {several} have more than one stable equilibrium "
            f"and {none} have none that was found from {starts} starts."
        )


def find_equilibria(
    robot: Robot,
    cable: Cable | Cables,
    length_m: FloatArray,
    starts: Poses,
    force_N: FloatArray | None = None,
) -> Equilibria:
    """Solve the forward statics from every start, and tell the results apart.

    More may exist than are found; more starts make that less likely.

    Parameters
    ----------
    robot, cable
        The robot and its cables.
    length_m : array (..., n_cables)
        Unstrained lengths [m].
    starts : Poses
        Poses (n_starts,), such as `spread_poses`, the same for all problems.
    force_N : array (..., 3), optional
        Force on the platform beside its weight, base frame [N].
    """
    force = None if force_N is None else np.asarray(force_N)[..., None, :]
    found = solve_forward(robot, cable, np.asarray(length_m)[..., None, :], starts, force)
    places = _places_m(robot, found)
    shape = places.shape[:-2]
    flat = places.reshape(-1, *places.shape[-2:])
    size = float(np.linalg.norm(np.ptp(robot.exit_points_m, axis=0)))
    which = np.array([_group(one, _SAME * size) for one in flat]).reshape(*shape, -1)
    stable = np.where(found.is_stable, which, -1).reshape(-1, places.shape[-2])
    n_stable = np.array([len(set(row) - {-1}) for row in stable.tolist()]).reshape(shape)
    return Equilibria(found, which, n_stable)


def spread_poses(robot: Robot, count: int, largest_turn_rad: float = 0.5, seed: int = 0) -> Poses:
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
    seed : int
        Of the random choice.
    """
    rng = np.random.default_rng(seed)
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


def _places_m(robot: Robot, found: ForwardStatics) -> FloatArray:
    """Return position and turned axes times reach, so that poses compare as points [m]."""
    position = found.poses.position_m
    if robot.is_point_mass:
        return position
    axes = found.poses.rotation.reshape(*position.shape[:-1], 9)
    return np.concatenate([position, reach_m(robot) * axes], axis=-1)


def _group(places_m: FloatArray, tolerance_m: float) -> list[int]:
    """Return a number for each place (n_starts, ·), equal for equal places; -1 for NaN."""
    kinds: list[FloatArray] = []
    which = []
    for place in places_m:
        if not np.isfinite(place).all():
            which.append(-1)
            continue
        known = (k for k, kind in enumerate(kinds) if np.abs(place - kind).max() <= tolerance_m)
        number = next(known, len(kinds))
        if number == len(kinds):
            kinds.append(place)
        which.append(number)
    return which
