"""Whether the cables keep clear of each other and of the platform in the whole workspace."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from designer.arrays import FloatArray
from designer.model.cable import Cable, Cables
from designer.model.robot import Poses, Robot
from designer.model.workspace import Workspace
from designer.statics.inverse import Statics, solve_sagging
from designer.workspace.clearance import (
    Clearance,
    cable_pairs,
    clearance_among_cables,
    clearance_to_platform,
    distances_among_cables_m,
    names_of,
)
from designer.workspace.demand import is_counted, is_left_out
from designer.workspace.refine import LIGHT, ONE_CLIMB, places_of, refine

MOST_SAMPLES = 1000
"""Poses that are looked at before the search between them."""


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
        Two cables, from 0, or a cable and `designer.workspace.clearance.PLATFORM`.
    place : array (n_coordinates,)
        Where the platform is and how it is turned, see `designer.model.space` [m, rad].
    point_m : array (3,)
        Where the two are nearest, base frame [m].
    """

    distance_m: float
    error_m: float
    pair: tuple[int, int]
    place: FloatArray
    point_m: FloatArray

    @property
    def names(self) -> tuple[str, str]:
        """Names of the two, cables counted from 1."""
        return names_of(self.pair)


@dataclass(frozen=True, slots=True, eq=False)
class Interference:
    """Clearances over the workspace.

    Parameters
    ----------
    clearance_m : float
        What is asked for [m].
    samples, violating : int
        Poses that were looked at and count, and those of them that keep less.
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
        clearances = [
            clearance
            for clearance in (self.among_cables, self.to_platform)
            if clearance is not None
        ]
        return min(clearances, key=lambda clearance: clearance.distance_m, default=None)

    @property
    def is_violated(self) -> bool:
        """Whether less than the clearance is kept somewhere, as far as was looked."""
        return self.worst is not None and self.worst.distance_m < self.clearance_m


def where_pairs_are_near(
    robot: Robot, workspace: Workspace, cable: Cable | Cables, places: FloatArray
) -> FloatArray:
    """Return where each pair of cables comes near (n, n_coordinates), by a short climb from places.

    Starts for a search of the smallest clearance: some pairs cross in so small a part of the space
    that no sample shows it. None in a space in which every place is tried.
    """

    def nearness(places: FloatArray) -> FloatArray:
        statics = solve_sagging(robot, Poses.at(places), cable)
        distance = distances_among_cables_m(statics)
        distance[is_left_out(statics, workspace.hangs_below)] = np.nan
        return -np.nan_to_num(distance, nan=np.inf)

    space = workspace.space
    if space.is_discrete or not len(cable_pairs(robot)):
        return np.empty((0, space.n_coordinates))
    return places_of(refine(space, nearness, places, ONE_CLIMB))


def survey(
    robot: Robot, workspace: Workspace, cable: Cable | Cables, clearance_m: float
) -> Interference:
    """Look for the smallest clearances in a workspace: `MOST_SAMPLES` first, then between them."""
    thinned = workspace.thinned(MOST_SAMPLES)
    statics = solve_sagging(robot, Poses.at(thinned), cable)

    def counted(among: Callable[[Statics], Clearance], statics: Statics) -> Clearance:
        clearance, is_out = among(statics), is_left_out(statics, workspace.hangs_below)
        return replace(clearance, distance_m=np.where(is_out, np.nan, clearance.distance_m))

    cables = counted(clearance_among_cables, statics)
    platform = counted(clearance_to_platform, statics)

    def nearest(
        among: Callable[[Statics], Clearance], sampled: Clearance, starts: FloatArray
    ) -> Nearest | None:
        def clearance(places: FloatArray) -> Clearance:
            poses = Poses.at(places)
            return counted(among, solve_sagging(robot, poses, cable))

        def nearness(places: FloatArray) -> FloatArray:
            return -np.nan_to_num(clearance(places).distance_m, nan=np.inf)

        if np.isnan(sampled.distance_m).all():
            return None
        (worst,) = refine(workspace.space, nearness, starts, LIGHT)
        closest = clearance(worst.place[None])
        first, second = (int(number) for number in closest.pair[0])
        return Nearest(
            distance_m=float(closest.distance_m[0]),
            error_m=float(closest.error_m[0]),
            pair=(first, second),
            place=worst.place,
            point_m=closest.place_m[0],
        )

    near = np.concatenate([thinned, where_pairs_are_near(robot, workspace, cable, thinned)])
    return Interference(
        clearance_m=clearance_m,
        samples=int(is_counted(statics, workspace.hangs_below).sum()),
        violating=int((cables.nearer(platform).distance_m < clearance_m).sum()),
        among_cables=nearest(clearance_among_cables, cables, near),
        to_platform=nearest(clearance_to_platform, platform, thinned),
    )
