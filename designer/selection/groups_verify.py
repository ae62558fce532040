"""Proof that cables which differ hold everywhere: the whole workspace, group by group."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from designer.arrays import BoolArray, FloatArray, IntArray
from designer.cable import Cables
from designer.robot import Poses, Robot
from designer.statics.inverse import Statics, solve_sagging
from designer.study import Workspace
from designer.workspace.demand import is_left_out
from designer.workspace.refine import Demand, refine, spread_starts
from designer.workspace.samples import places

Members = Sequence[IntArray]
"""Of each group the indices of its cables."""

_STARTS = 4


@dataclass(frozen=True, slots=True, eq=False)
class GroupVerification:
    """What given cables meet in the workspace.

    Parameters
    ----------
    worst_place : array (n_groups, n_coordinates)
        Places where each group is used most [m, rad].
    utilisation : array (n_groups,)
        Largest over allowable tension there; inf if a pose cannot be held at all.
    longest_m : array (n_cables,)
        Longest unstrained length that each cable needs [m].
    is_refined : bool
        Whether the worst poses were searched for between the samples as well. Where a sample
        already fails, they were not.
    """

    worst_place: FloatArray
    utilisation: FloatArray
    longest_m: FloatArray
    is_refined: bool

    @property
    def holds(self) -> bool:
        """Whether every group stays within its allowable tension everywhere."""
        return self.is_refined and bool((self.utilisation <= 1.0).all())


def utilisation_of(statics: Statics, cables: Cables, left_out: BoolArray) -> FloatArray:
    """Return largest over allowable tension of each cable (..., n_cables).

    Infinite where a pose is not solved, minus infinity where it does not count.
    """
    used = statics.cable_tension_N / cables.allowable_tension_N
    used = np.where(statics.is_solved[..., None], used, np.inf)
    return np.where(left_out[..., None], -np.inf, used)


def verify_groups(
    robot: Robot, workspace: Workspace, cables: Cables, members: Members
) -> GroupVerification:
    """Solve every sample with these cables, then search between them for each group's worst."""
    longest = np.zeros(robot.n_cables)
    n_coordinates = workspace.space.n_coordinates
    pools = [(np.empty((0, n_coordinates)), np.empty(0)) for _ in members]
    for some in places(workspace):
        statics = solve_sagging(robot, Poses.at(some), cables)
        left_out = is_left_out(statics, workspace.hangs_below)
        counted = statics.length_m[statics.is_solved & ~left_out]
        longest = np.maximum(longest, counted.max(axis=0, initial=0.0))
        used = utilisation_of(statics, cables, left_out)
        for g, cable in enumerate(members):
            pools[g] = _best(workspace, pools[g], some, used[:, cable].max(axis=1))
    if any(len(at) == 0 for at, _ in pools):  # every sample is left out: nothing is served
        return GroupVerification(
            np.full((len(members), n_coordinates), np.nan),
            np.full(len(members), np.inf),
            longest,
            False,
        )
    if any(value.max() > 1.0 for _, value in pools):
        at_samples = np.array([at[int(np.argmax(value))] for at, value in pools])
        used_there = np.array([value.max() for _, value in pools])
        return GroupVerification(at_samples, used_there, longest, False)
    worst = [
        refine(workspace.space, _demand(robot, workspace, cables, cable), at)
        for cable, (at, _) in zip(members, pools, strict=True)
    ]
    return GroupVerification(
        np.array([w.place for w in worst]), np.array([w.demand for w in worst]), longest, True
    )


def _best(
    workspace: Workspace,
    pool: tuple[FloatArray, FloatArray],
    some: FloatArray,
    used: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Return the most used places of the pool and the new ones, well apart."""
    some = np.concatenate([pool[0], some])
    used = np.concatenate([pool[1], used])
    kept = spread_starts(workspace.space, some, used, _STARTS)
    at = [int(np.argmin(np.abs(some - start).sum(axis=1))) for start in kept]
    return some[at], used[at]


def _demand(robot: Robot, workspace: Workspace, cables: Cables, cable: IntArray) -> Demand:
    def demand(some: FloatArray) -> FloatArray:
        statics = solve_sagging(robot, Poses.at(some), cables)
        left_out = is_left_out(statics, workspace.hangs_below)
        return np.asarray(utilisation_of(statics, cables, left_out)[:, cable].max(axis=1))

    return demand
