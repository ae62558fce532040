"""Assignments tried at the few poses that have refuted others before: quick, and conclusive.

A pose that an assignment cannot hold refutes it for good; one that it can hold proves nothing, so
what passes here still has to be verified over the whole workspace.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from designer.arrays import BoolArray, FloatArray
from designer.model.cable import Cable, Cables
from designer.model.robot import Poses, Robot
from designer.selection.groups.master import Assignment
from designer.selection.groups.verify import Members, utilisation_of
from designer.selection.products import Product
from designer.statics.geometry import cable_geometry
from designer.statics.inverse import solve_sagging
from designer.study import Workspace
from designer.workspace.demand import is_left_out

_MOST_WITNESSES = 120
_NUDGE = 1e-3


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
        self, robot: Robot, workspace: Workspace, products: Sequence[Product], members: Members
    ) -> None:
        self.robot, self.workspace = robot, workspace
        self.products, self.members = products, members
        self.count = 0
        self.reach_m = np.zeros(robot.n_cables)
        """Longest chord of each cable over the samples (n_cables,) [m]."""
        self._farthest = np.zeros((robot.n_cables, workspace.space.n_coordinates))
        for some in workspace.places():
            chord = cable_geometry(robot, Poses.at(some)).chord_m
            best = chord.argmax(axis=0)
            far = chord[best, np.arange(robot.n_cables)]
            is_farther = (far > self.reach_m)[:, None]
            self._farthest = np.where(is_farther, some[best], self._farthest)
            self.reach_m = np.maximum(self.reach_m, far)
        self._found = np.empty((0, workspace.space.n_coordinates))
        self._refuted: set[Assignment] = set()

    @property
    def witnesses(self) -> FloatArray:
        """Places (n_witnesses, n_coordinates); the first are samples far from each exit point."""
        return np.concatenate([self._farthest, self._found])

    def add_witnesses(self, some: FloatArray) -> None:
        """Take up places (n, n_coordinates) where assignments have failed, or nearly so."""
        known = {tuple(place) for place in self._found}
        new = [p for p in some if np.isfinite(p).all() and tuple(p) not in known]
        found = np.concatenate([self._found, np.array(new).reshape(-1, self._found.shape[1])])
        self._found = found[-_MOST_WITNESSES:]

    def cables(self, assignment: Assignment) -> Cables:
        """Return the cables of an assignment, in the order of the exit points."""
        return self.on_groups([self.products[p].cable for p in assignment])

    def on_groups(self, each: Sequence[Cable]) -> Cables:
        """Return the cables of the robot from those of its groups."""
        of_cable = {int(c): each[g] for g, cables in enumerate(self.members) for c in cables}
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

    def refutation(self, assignment: Assignment) -> Refutation | None:
        """Return the worst witness against an assignment, if there is one."""
        used = self.load(self.cables(assignment)).utilisation
        by_group = np.stack([used[:, cables].max(axis=1) for cables in self.members], axis=1)
        at, group = np.unravel_index(int(np.argmax(by_group)), by_group.shape)
        if by_group[at, group] <= 1.0:
            return None
        self._refuted.add(assignment)
        return Refutation(int(group), float(by_group[at, group]), self.witnesses[at])

    def is_refuted(self, assignment: Assignment) -> bool:
        """Tell whether a witness speaks against an assignment."""
        return assignment in self._refuted or self.refutation(assignment) is not None

    def least_length_m(self, assignment: Assignment) -> FloatArray:
        """Return lengths (n_cables,) that the longest ones of an assignment cannot fall below."""
        length = self.load(self.cables(assignment)).length_m[: len(self._farthest)]
        return np.asarray(np.nan_to_num(length).max(axis=0, initial=0.0))

    def slopes(self, assignment: Assignment) -> tuple[Load, FloatArray]:
        """Return the load, and the slope of each tension in each group's weight.

        The latter (n_groups, n_witnesses, n_cables) by forward differences [N per N/m].
        """
        each = [self.products[p].cable for p in assignment]
        base = self.load(self.on_groups(each))
        slopes = []
        for g, cable in enumerate(each):
            density = (1.0 + _NUDGE) * cable.linear_density_kg_per_m
            heavier = replace(cable, linear_density_kg_per_m=density)
            moved = self.load(self.on_groups([*each[:g], heavier, *each[g + 1 :]]))
            slopes.append((moved.tension_N - base.tension_N) / (_NUDGE * cable.weight_N_per_m))
        return base, np.array(slopes)
