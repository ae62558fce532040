"""Where the platform may choose its orientation: the one that needs the thinnest cable.

It is sought at some positions of the region and interpolated between them, as a controller would
do it: a law that has jumps could not be driven. What holds along the law holds in some orientation
of the range; where nothing holds along it, another orientation may.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import Annotated

import numpy as np

from designer import checked
from designer.arrays import FloatArray, frozen_array
from designer.model.cable import Material
from designer.model.region import Region
from designer.model.robot import Poses, Robot
from designer.model.space import OrientationLaw, OrientationTable
from designer.model.workspace import HangsBelow
from designer.sizing.newton import size_poses
from designer.spelling import vector
from designer.workspace.demand import demand_of

_NODES = 256
"""Positions at which the best orientation is sought, at most; between them it is interpolated."""
_GRID = {1: 25, 2: 13, 3: 7}
"""Orientations along each of so many free components, first."""
_STEPS = 12
"""Of the search from the best of these: to a neighbour, or half as far."""
_NEIGHBOURS = np.array([-1.0, 0.0, 1.0])
_TIE = 1e-4
"""Relative: what a rotation to the end of the range may cost; of equal ones the least is taken."""
_CHECKED = 64
"""Positions between the others at which the law is compared with the best."""


@dataclass(frozen=True, eq=False)
class BestOrientations(OrientationLaw):
    """The orientation in a range that needs the thinnest cable of a family, at each position."""

    robot: Robot  #: without load cases, as drawn
    material: Material  #: the family
    region: Region  #: whose positions are asked; elsewhere the law goes on as it is at its rim
    #: (2, 3) lowest and highest components of the rotation vector [rad]
    range_rad: Annotated[FloatArray, checked.Shape((2, 3))]
    #: see `Workspace`; an orientation whose pose is left out is not taken
    hangs_below: HangsBelow = "include"

    @cached_property
    def table(self) -> OrientationTable:
        """The law: the best orientations where they were sought; level where none holds."""
        positions = self._positions_m(_NODES, 0)
        rotations, diameter_m = self.best(positions)
        is_held = np.isfinite(diameter_m)
        if not is_held.any():
            return OrientationTable(positions[:1], np.clip(np.zeros((1, 3)), *self.range_rad))
        return OrientationTable(frozen_array(positions[is_held]), frozen_array(rotations[is_held]))

    @cached_property
    def excess(self) -> float:
        """By how much the law needs a thicker cable than the best orientations, relative.

        The largest diameter of each, at other positions than those of the table; infinite where
        the law does not hold and another orientation does; zero where the table has all.
        """
        if self._has_all:
            return 0.0
        positions = self._positions_m(_CHECKED, 1)
        best = self.best(positions)[1]
        places = np.hstack([positions, self.turns_rad(positions)[:, 0]])[np.isfinite(best)]
        if not len(places):
            return 0.0
        largest = self._diameter_m(places).max()
        return max(float(largest / best[np.isfinite(best)].max()) - 1.0, 0.0)

    @property
    def _has_all(self) -> bool:
        """Whether the table has all positions that are asked for, of a list."""
        return self.region.is_discrete and len(self._drawn_m(_NODES, 0)) <= _NODES

    def _drawn_m(self, count: int, seed: int) -> FloatArray:
        """Return positions of the region, no two alike; a list of points is taken whole."""
        drawn = np.concatenate([*self.region.samples_m(count, "low_discrepancy", seed)])
        return np.unique(drawn, axis=0)

    def _positions_m(self, count: int, seed: int) -> FloatArray:
        """Return about so many of them, some of a list; the first time landmarks as well."""
        drawn = self._drawn_m(count, seed)
        if self.region.is_discrete:
            order = np.random.default_rng(seed).permutation(len(drawn))
            return frozen_array(drawn[np.sort(order[:count])])
        if seed == 0:
            drawn = np.unique(np.vstack([self.region.border().landmarks_m(), drawn]), axis=0)
        return frozen_array(drawn)

    def best(self, positions_m: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return the best rotation vectors at positions (n, 3) [rad], and what is needed there [m].

        On a grid over the range, and on finer ones about the best; infinite where nothing holds.
        """
        low, high = self.range_rad
        free = np.flatnonzero(high > low)
        steps = np.linspace(-1.0, 1.0, _GRID[len(free)])
        n = len(positions_m)
        best = np.tile(0.5 * (low + high), (n, 1))
        least, need = np.full(n, np.inf), np.full(n, np.inf)
        reach = np.tile(0.5 * (high - low), (n, 1, 1))
        for _ in range(1 + _STEPS):
            grid = np.zeros((len(steps) ** len(free), 3))
            grid[:, free] = list(product(steps, repeat=len(free)))
            rotations = np.clip(best[:, None] + grid * reach, low, high)
            places = np.concatenate(
                [np.broadcast_to(positions_m[:, None], rotations.shape), rotations], axis=-1
            )
            diameter_m = self._diameter_m(places.reshape(-1, 6)).reshape(n, -1)
            size = np.linalg.norm(rotations, axis=2) / np.abs(self.range_rad).max()
            value = diameter_m * (1.0 + _TIE * size**2)
            row, at = np.arange(n), value.argmin(axis=1)
            better = value[row, at] < least
            best = np.where(better[:, None], rotations[row, at], best)
            need = np.where(better, diameter_m[row, at], need)
            least = np.minimum(least, value[row, at])
            if len(steps) > len(_NEIGHBOURS):
                reach = reach * 2.0 / (len(steps) - 1)
            else:
                reach = np.where(better[:, None, None], reach, 0.5 * reach)
            steps = _NEIGHBOURS
        return best, need

    def _diameter_m(self, places: FloatArray) -> FloatArray:
        """Return what places (n, 6) need [m]; infinite where nothing holds or it is left out."""
        sizing = size_poses(self.robot, Poses.at(places), self.material)
        demand = demand_of(sizing.diameter_m, sizing.statics, self.hangs_below)
        return np.where(np.isneginf(demand), np.inf, demand)

    def turns_rad(self, positions_m: FloatArray) -> FloatArray:
        return self.table.turns_rad(positions_m)

    @property
    def rows(self) -> tuple[FloatArray, FloatArray]:
        return self.table.rows

    @property
    def words(self) -> str:
        low, high = (vector(np.degrees(end), 3) for end in self.range_rad)
        costs = (
            f"at {_CHECKED} others the thickest cable along this law is {self.excess:.1%} thicker "
            "than in the best orientation of each"
        )
        if math.isinf(self.excess):
            costs = (
                f"at some of {_CHECKED} others no taut cables hold the platform along this law, "
                "where they do in the best orientation"
            )
        if self._has_all:
            costs = "there are no others"
        return (
            f"in the orientation between {low} and {high} degrees that needs the thinnest cable, "
            f"sought at {len(self.table.positions_m)} positions; {costs}"
        )
