"""Proof that a given cable holds everywhere: the whole workspace again, with its own figures."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from designer.arrays import FloatArray
from designer.cable import Cable
from designer.robot import Poses, Robot
from designer.statics.inverse import solve_sagging
from designer.study import Workspace
from designer.workspace.demand import is_left_out, tension_demand
from designer.workspace.refine import Demand, Worst, refine, spread_starts
from designer.workspace.samples import places

_STARTS = 4


@dataclass(frozen=True, slots=True, eq=False)
class Verification:
    """What a given cable meets in the workspace.

    Parameters
    ----------
    worst_position_m : array (n_coordinates,)
        Place where its tension is largest, see `designer.space` [m, rad].
    max_tension_N : float
        The largest tension there [N]; inf if the pose cannot be held at all.
    utilisation : float
        Largest over allowable tension; the cable holds up to 1.
    longest_m : array (n_cables,)
        Longest unstrained length that each cable needs [m].
    is_refined : bool
        Whether the largest tension was searched for between the samples as well.
    """

    worst_position_m: FloatArray
    max_tension_N: float
    utilisation: float
    longest_m: FloatArray
    is_refined: bool = True

    @property
    def holds(self) -> bool:
        """Whether the cable stays within its allowable tension everywhere."""
        return self.utilisation <= 1.0


def verify(robot: Robot, workspace: Workspace, cable: Cable) -> Verification:
    """Solve every sample with this cable, then search for its largest tension between them."""
    longest = np.zeros(robot.n_cables)

    def observed(places: FloatArray) -> FloatArray:
        nonlocal longest
        statics = solve_sagging(robot, Poses.at(places), cable)
        left_out = is_left_out(statics, workspace.hangs_below)
        counted = statics.length_m[statics.is_solved & ~left_out]
        longest = np.maximum(longest, counted.max(axis=0, initial=0.0))
        tension = np.where(statics.is_solved, statics.largest_tension_N, np.inf)
        return np.where(left_out, -np.inf, tension)

    demand = tension_demand(robot, cable, workspace.hangs_below)
    worst = worst_of(workspace, observed, demand)
    return Verification(
        worst_position_m=worst.place,
        max_tension_N=worst.demand,
        utilisation=worst.demand / cable.allowable_tension_N,
        longest_m=longest,
    )


def worst_of(
    workspace: Workspace, demand: Demand, refined_demand: Callable[[FloatArray], FloatArray]
) -> Worst:
    """Return the largest demand over the samples, then over the region from the best of them.

    Where every sample is left out, nothing is served: infinite, at no position.
    """
    space = workspace.space
    kept = np.empty((0, space.n_coordinates))
    values = np.empty(0)
    for some in places(workspace):
        pool = np.concatenate([kept, some])
        asked = np.concatenate([values, demand(some)])
        kept = spread_starts(space, pool, asked, _STARTS)
        at = [int(np.argmin(np.abs(pool - start).sum(axis=1))) for start in kept]
        values = asked[at]
    if len(kept) == 0:
        return Worst(np.full(space.n_coordinates, np.nan), np.inf)
    return refine(space, refined_demand, kept)
