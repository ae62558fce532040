"""What an assignment of products to groups meets: over the workspace, and at a few poses.

The few are those that have refuted others before: quick, and conclusive. A pose that an assignment
cannot hold refutes it for good; one that it can hold proves nothing, so what passes there still has
to be verified over the whole workspace, group by group.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from designer.arrays import BoolArray, FloatArray
from designer.model.cable import Cable, Cables
from designer.model.robot import Poses, Robot
from designer.model.workspace import Workspace
from designer.selection.assignment import GroupVerification
from designer.selection.candidate import Candidate
from designer.selection.groups.balance import Members
from designer.selection.groups.master import Combination
from designer.statics.geometry import cable_geometry
from designer.statics.inverse import Statics, solve_sagging
from designer.workspace.demand import is_left_out, length_demand
from designer.workspace.refine import Pool, refine

_NUDGE = 1e-3
"""Relative step in the weight of a rope: the slope guides, and need not be exact."""
_MOST_WITNESSES = 120
"""The latest are kept: each is solved in every trial."""


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
    demand = partial(_demand, robot, workspace, cables, members)
    pools = [Pool(space) for _ in members]
    utilisation = np.full(len(members), -np.inf)
    at = np.full((len(members), space.n_coordinates), np.nan)
    longest = np.zeros(robot.n_cables)
    for batch in workspace.places():
        demands, lengths = np.split(demand(batch), [len(members)], axis=1)
        for g, pool in enumerate(pools):
            pool.add(batch, demands[:, g])
        best = demands.argmax(axis=0)
        highest = demands[best, np.arange(len(members))]
        at = np.where((highest > utilisation)[:, None], batch[best], at)
        utilisation = np.maximum(utilisation, highest)
        longest = np.maximum(longest, lengths.max(axis=0))
    if np.isneginf(utilisation).any():  # every sample is left out: nothing is served
        utilisation = np.full(len(members), np.inf)
    if utilisation.max() > 1.0:
        return GroupVerification(at, utilisation, longest, np.full_like(longest, np.nan), False)
    starts = np.unique(np.concatenate([pool.places for pool in pools]), axis=0)
    worst = refine(space, demand, starts)
    demands = np.array([extreme.demand for extreme in worst])
    at = np.array([extreme.place for extreme in worst[: len(members)]])
    groups, lengths = np.split(demands, [len(members)])
    return GroupVerification(at, groups, lengths, np.full_like(lengths, np.nan), True)


def _demand(
    robot: Robot,
    workspace: Workspace,
    cables: Cables,
    members: Members,
    places: FloatArray,
) -> FloatArray:
    """What cables meet (n, n_groups + n_cables): utilisation of each group, lengths [m]."""
    statics = solve_sagging(robot, Poses.at(places), cables)
    left_out = is_left_out(statics, workspace.hangs_below)
    utilisation = utilisation_of(statics, cables, left_out)
    groups = np.column_stack([utilisation[:, cable].max(axis=1) for cable in members])
    counts = np.isfinite(groups).all(axis=1)
    length = length_demand(statics, counts)[:, : robot.n_cables]
    return np.column_stack([groups, length])


@dataclass(frozen=True, slots=True, eq=False)
class Load:
    """What cables meet at the witnesses, each (n_witnesses, n_cables).

    Largest over allowable tension, inf where not solved and minus inf where left out; largest
    tension [N] and unstrained length [m], NaN where not solved; whether the cable hangs below the
    platform.
    """

    utilisation: FloatArray
    tension_N: FloatArray
    length_m: FloatArray
    hangs: BoolArray


@dataclass(frozen=True, slots=True, eq=False)
class Refutation:
    """A pose that an assignment cannot hold."""

    group: int  # The group that is overloaded most there
    utilisation: float  # By how much; inf if the pose cannot be held at all
    place: FloatArray  # (n_coordinates,): Where, see `designer.model.space` [m, rad]


class Trials:
    """Solves assignments of products to groups at the witnesses.

    ``products`` are what may be assigned, ``members`` the cables of each group.
    """

    def __init__(
        self, robot: Robot, workspace: Workspace, products: Sequence[Candidate], members: Members
    ) -> None:
        self.robot, self.workspace = robot, workspace
        self.products, self.members = products, members
        self.count = 0
        self.reach_m = np.zeros(robot.n_cables)
        """Longest chord of each cable over the samples (n_cables,) [m]."""
        self._farthest = np.zeros((robot.n_cables, workspace.space.n_coordinates))
        for batch in workspace.places():
            chord = cable_geometry(robot, Poses.at(batch)).chord_m
            best = chord.argmax(axis=0)
            far = chord[best, np.arange(robot.n_cables)]
            is_farther = (far > self.reach_m)[:, None]
            self._farthest = np.where(is_farther, batch[best], self._farthest)
            self.reach_m = np.maximum(self.reach_m, far)
        self._found = np.empty((0, workspace.space.n_coordinates))
        self._refuted: set[Combination] = set()

    @property
    def witnesses(self) -> FloatArray:
        """Places (n_witnesses, n_coordinates); the first are samples far from each exit point."""
        return np.concatenate([self._farthest, self._found])

    def add_witnesses(self, places: FloatArray) -> None:
        """Take up places (n, n_coordinates) where assignments have failed, or nearly so."""
        present = {tuple(place) for place in self._found}
        new = [p for p in places if np.isfinite(p).all() and tuple(p) not in present]
        witnesses = np.concatenate([self._found, np.array(new).reshape(-1, self._found.shape[1])])
        self._found = witnesses[-_MOST_WITNESSES:]

    def cables(self, combination: Combination) -> Cables:
        """Return the cables of a combination, in the order of the exit points."""
        return self.on_groups([self.products[p].cable for p in combination])

    def on_groups(self, of_groups: Sequence[Cable]) -> Cables:
        """Return the cables of the robot from those of its groups."""
        of_cable = {int(c): of_groups[g] for g, cables in enumerate(self.members) for c in cables}
        return Cables(tuple(of_cable[c] for c in range(self.robot.n_cables)))

    def load(self, cables: Cables) -> Load:
        """Solve the witnesses."""
        self.count += 1
        statics = solve_sagging(self.robot, Poses.at(self.witnesses), cables)
        left_out = is_left_out(statics, self.workspace.hangs_below)
        return Load(
            utilisation_of(statics, cables, left_out),
            statics.cable_tension_N,
            statics.length_m,
            np.asarray(statics.force_z_N > 0.0),
        )

    def stands_above(self) -> BoolArray:
        """Tell at which witnesses every exit point lies above its attachment."""
        drop = cable_geometry(self.robot, Poses.at(self.witnesses)).drop_m
        return np.asarray((drop > 0.0).all(axis=1))

    def refutation(self, combination: Combination) -> Refutation | None:
        """Return the worst witness against a combination, if there is one."""
        used = self.load(self.cables(combination)).utilisation
        by_group = np.stack([used[:, cables].max(axis=1) for cables in self.members], axis=1)
        at, group = np.unravel_index(int(np.argmax(by_group)), by_group.shape)
        if by_group[at, group] <= 1.0:
            return None
        self._refuted.add(combination)
        return Refutation(int(group), float(by_group[at, group]), self.witnesses[at])

    def is_refuted(self, combination: Combination) -> bool:
        """Tell whether a witness speaks against a combination."""
        return combination in self._refuted or self.refutation(combination) is not None

    def least_length_m(self, combination: Combination) -> FloatArray:
        """Return lengths (n_cables,) that the longest ones of an assignment cannot fall below."""
        length = self.load(self.cables(combination)).length_m[: len(self._farthest)]
        return np.asarray(np.nan_to_num(length).max(axis=0, initial=0.0))

    def slopes(self, combination: Combination) -> tuple[Load, FloatArray]:
        """Return the load, and the slope of each tension in each group's weight.

        The latter (n_groups, n_witnesses, n_cables) by forward differences [N per N/m].
        """
        of_groups = [self.products[p].cable for p in combination]
        base = self.load(self.on_groups(of_groups))
        slopes = []
        for g, cable in enumerate(of_groups):
            density = (1.0 + _NUDGE) * cable.linear_density_kg_per_m
            heavier = replace(cable, linear_density_kg_per_m=density)
            moved = self.load(self.on_groups([*of_groups[:g], heavier, *of_groups[g + 1 :]]))
            slopes.append((moved.tension_N - base.tension_N) / (_NUDGE * cable.weight_N_per_m))
        return base, np.array(slopes)
