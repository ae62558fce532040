"""Proof that cables which differ hold everywhere: the whole workspace, group by group."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from designer.arrays import BoolArray, FloatArray, IntArray
from designer.model.cable import Cables
from designer.model.robot import Poses, Robot
from designer.statics.inverse import Statics, solve_sagging
from designer.study import Workspace
from designer.workspace.demand import is_left_out, length_demand
from designer.workspace.refine import Demand, Pool, refine_over_branches

Members = Sequence[IntArray]
"""Of each group the indices of its cables."""


@dataclass(frozen=True, slots=True, eq=False)
class GroupVerification:
    """What given cables meet in the workspace."""

    # (n_groups, n_coordinates): Places where each group is used most [m, rad]
    worst_place: FloatArray
    # (n_groups,): Largest over allowable tension there; inf if a pose cannot be held at all
    utilisation: FloatArray
    longest_m: FloatArray  # (n_cables,): Longest unstrained length that each cable needs [m]
    # Whether the worst poses were searched for between the samples as well. Where a sample already
    # fails, they were not.
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
    space = workspace.space
    demand_with = partial(_demand, robot, workspace, cables, members)
    demand = demand_with()
    pools = [Pool(space) for _ in members]
    used = np.full(len(members), -np.inf)
    at = np.full((len(members), space.n_coordinates), np.nan)
    longest = np.zeros(robot.n_cables)
    for some in workspace.places():
        asked, lengths = np.split(demand(some), [len(members)], axis=1)
        for g, pool in enumerate(pools):
            pool.add(some, asked[:, g])
        best = asked.argmax(axis=0)
        highest = asked[best, np.arange(len(members))]
        at = np.where((highest > used)[:, None], some[best], at)
        used = np.maximum(used, highest)
        longest = np.maximum(longest, lengths.max(axis=0))
    if np.isneginf(used).any():  # every sample is left out: nothing is served
        used = np.full(len(members), np.inf)
    if used.max() > 1.0:
        return GroupVerification(at, used, longest, False)
    starts = np.unique(np.concatenate([pool.places for pool in pools]), axis=0)
    worst = refine_over_branches(space, demand_with, starts)
    asked = np.array([one.demand for one in worst])
    at = np.array([one.place for one in worst[: len(members)]])
    groups, lengths = np.split(asked, [len(members)])
    return GroupVerification(at, groups, lengths, True)


def _demand(
    robot: Robot,
    workspace: Workspace,
    cables: Cables,
    members: Members,
    *,
    seeks_better: bool = True,
) -> Demand:
    """What cables meet (n, n_groups + n_cables): utilisation of each group, lengths [m]."""

    def demand(some: FloatArray) -> FloatArray:
        statics = solve_sagging(robot, Poses.at(some), cables, seeks_better=seeks_better)
        left_out = is_left_out(statics, workspace.hangs_below)
        used = utilisation_of(statics, cables, left_out)
        groups = np.column_stack([used[:, cable].max(axis=1) for cable in members])
        counts = np.isfinite(groups).all(axis=1)
        length = length_demand(statics, counts)[:, : robot.n_cables]
        return np.column_stack([groups, length])

    return demand
