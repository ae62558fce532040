"""Whether the cables keep clear of each other and of the platform in the whole workspace."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from designer.arrays import FloatArray
from designer.cable import Cable, Cables
from designer.interference.clearance import (
    PLATFORM,
    Clearance,
    clearance_among_cables,
    clearance_to_platform,
)
from designer.robot import Poses, Robot
from designer.statics.inverse import solve_sagging
from designer.study import Workspace
from designer.workspace.samples import places

MOST_SAMPLES = 1000
"""Poses that are looked at before the search between them."""

_TURNS = 8
_TRIALS = 24


@dataclass(frozen=True, slots=True, eq=False)
class Nearest:
    """The pose in which two things come nearest to each other.

    Parameters
    ----------
    distance_m : float
        How near [m].
    error_m : float
        The true distance there is smaller by no more than this [m].
    pair : tuple of int
        Two cables, from 0, or a cable and `designer.interference.clearance.PLATFORM`.
    position_m, place_m : array (3,)
        Where the platform is, and where on it the two are nearest, base frame [m].
    """

    distance_m: float
    error_m: float
    pair: tuple[int, int]
    position_m: FloatArray
    place_m: FloatArray

    @property
    def names(self) -> tuple[str, str]:
        """Names of the two, cables counted from 1."""
        first, second = self.pair
        return (
            f"cable {first + 1}",
            "the platform" if second == PLATFORM else f"cable {second + 1}",
        )


@dataclass(frozen=True, slots=True, eq=False)
class Interference:
    """Clearances over the workspace.

    Parameters
    ----------
    clearance_m : float
        What is asked for [m].
    samples, violating : int
        Poses that were looked at and solved, and those of them that keep less.
    among_cables : Nearest or None
        Worst pose for two cables; None where no two cables can be compared.
    to_platform : Nearest or None
        Worst pose for a cable and the platform; None for a point mass.
    """

    clearance_m: float
    samples: int
    violating: int
    among_cables: Nearest | None
    to_platform: Nearest | None

    @property
    def worst(self) -> Nearest | None:
        """The nearer of the two."""
        found = [one for one in (self.among_cables, self.to_platform) if one is not None]
        return min(found, key=lambda one: one.distance_m, default=None)

    @property
    def is_violated(self) -> bool:
        """Whether less than the clearance is kept somewhere, as far as was looked."""
        return self.worst is not None and self.worst.distance_m < self.clearance_m


def survey(
    robot: Robot, workspace: Workspace, cable: Cable | Cables, clearance_m: float
) -> Interference:
    """Look for the smallest clearances in a workspace: samples first, then between them.

    Parameters
    ----------
    robot, workspace, cable
        What to look at; at most `MOST_SAMPLES` of the workspace's samples are.
    clearance_m : float
        What is asked for [m].
    """
    positions = next(places(workspace))
    positions = positions[:: -(-len(positions) // MOST_SAMPLES)]
    statics = solve_sagging(robot, Poses.at(positions), cable)
    cables = clearance_among_cables(statics)
    platform = clearance_to_platform(statics)

    def among_cables(trials: FloatArray) -> Clearance:
        return clearance_among_cables(solve_sagging(robot, Poses.at(trials), cable))

    def to_platform(trials: FloatArray) -> Clearance:
        return clearance_to_platform(solve_sagging(robot, Poses.at(trials), cable))

    return Interference(
        clearance_m=clearance_m,
        samples=int(statics.is_solved.sum()),
        violating=int((cables.nearer(platform).distance_m < clearance_m).sum()),
        among_cables=_worst(workspace, among_cables, positions, cables),
        to_platform=_worst(workspace, to_platform, positions, platform),
    )


def _worst(
    workspace: Workspace,
    clearance: Callable[[FloatArray], Clearance],
    positions: FloatArray,
    found: Clearance,
) -> Nearest | None:
    """Return the nearest of the samples, or a still nearer one found in shrinking clouds."""
    if np.isnan(found.distance_m).all():
        return None
    best = _nearest(positions, found)
    space = workspace.space
    if space.is_discrete:
        return best
    rng = np.random.default_rng(workspace.seed)
    size = np.ptp(space.bounds, axis=0)
    for turn in range(_TURNS):
        cloud = rng.uniform(-1.0, 1.0, (_TRIALS, len(size))) * size * 0.1 * 0.5**turn
        trials = space.nearest(best.position_m + cloud)
        tried = clearance(trials)
        if np.isfinite(tried.distance_m).any():
            best = min(best, _nearest(trials, tried), key=lambda one: one.distance_m)
    return best


def _nearest(positions: FloatArray, found: Clearance) -> Nearest:
    at = int(np.nanargmin(found.distance_m))
    first, second = (int(number) for number in found.pair[at])
    return Nearest(
        distance_m=float(found.distance_m[at]),
        error_m=float(found.error_m[at]),
        pair=(first, second),
        position_m=positions[at],
        place_m=found.place_m[at],
    )
