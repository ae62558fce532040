"""Proof that a given cable holds everywhere: the whole workspace again, with its own figures."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from designer.arrays import FloatArray
from designer.model.cable import Cable
from designer.model.robot import Robot
from designer.study import Workspace
from designer.workspace.demand import rope_demand
from designer.workspace.refine import Demand, Pool, Worst, refine_over_branches


@dataclass(frozen=True, slots=True, eq=False)
class Verification:
    """What a given cable meets in the workspace.

    Parameters
    ----------
    worst_position_m : array (n_coordinates,)
        Place where its tension is largest, see `designer.model.space` [m, rad].
    max_tension_N : float
        The largest tension there [N]; inf if the pose cannot be held at all.
    utilisation : float
        Largest over allowable tension; the cable holds up to 1.
    longest_m, shortest_m : array (n_cables,)
        Longest and shortest unstrained length that each cable has [m]; the latter NaN where it was
        not searched for.
    is_refined : bool
        Whether the extremes were searched for between the samples as well.
    """

    worst_position_m: FloatArray
    max_tension_N: float
    utilisation: float
    longest_m: FloatArray
    shortest_m: FloatArray
    is_refined: bool = True

    @property
    def holds(self) -> bool:
        """Whether the cable stays within its allowable tension everywhere."""
        return self.utilisation <= 1.0


def verify(robot: Robot, workspace: Workspace, cable: Cable) -> Verification:
    """Solve every sample with this cable, then search for its extremes between them."""
    demand = rope_demand(robot, cable, workspace.hangs_below)
    pool = Pool(workspace.space)
    for some in workspace.places():
        pool.add(some, demand(some)[:, 0])
    return searched(robot, workspace, cable, pool.places)


def searched(robot: Robot, workspace: Workspace, cable: Cable, starts: FloatArray) -> Verification:
    """Search a workspace for the extremes of a cable, from samples in which much is asked of it.

    Where every pose is left out, nothing is served: infinite, at no position.
    """
    demand_with = partial(rope_demand, robot, cable, workspace.hangs_below)
    tension, *lengths = refine_over_branches(workspace.space, demand_with, starts)
    most = np.inf if np.isneginf(tension.demand) else tension.demand
    length = np.array([one.demand for one in lengths]).reshape(2, -1)
    return Verification(
        worst_position_m=tension.place,
        max_tension_N=most,
        utilisation=most / cable.allowable_tension_N,
        longest_m=np.maximum(length[0], 0.0),
        shortest_m=np.where(np.isneginf(length[1]), np.nan, -length[1]),
    )


def worst_of(workspace: Workspace, demand_with: Callable[..., Demand]) -> Worst:
    """Return the largest demand over the samples, then over the region from the best of them.

    See `refine_over_branches` for what makes the demand.

    Where every pose is left out, nothing is served: infinite, at no position.
    """
    pool, demand = Pool(workspace.space), demand_with()
    for some in workspace.places():
        pool.add(some, demand(some))
    (worst,) = refine_over_branches(workspace.space, demand_with, pool.places)
    return Worst(worst.place, np.inf) if np.isneginf(worst.demand) else worst
