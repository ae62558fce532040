"""A finite set of positions."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from scipy.spatial import cKDTree

from designer import checked
from designer.arrays import BoolArray, FloatArray
from designer.model import region

_MOST_VERTICES = 256
"""Of a long list only the first points are tried as corners: all of it is tried anyway."""


@checked.reports_field
@dataclass(frozen=True, slots=True, eq=False)
class PointList(region.Region):
    """A finite set of positions, each of which is visited.

    Parameters
    ----------
    points_m : array (n_points, 3)
        Positions of the platform, world frame [m].
    """

    is_discrete: ClassVar[bool] = True

    points_m: checked.Points

    @property
    def bounds_m(self) -> FloatArray:
        return np.array([self.points_m.min(axis=0), self.points_m.max(axis=0)])

    @property
    def sizes(self) -> region.Sizes:
        return ()

    def words(self, position: region.Position, plural: region.Plural) -> str:
        return f"a list of {plural(len(self.points_m), 'point')}"

    def contains(self, points_m: FloatArray) -> BoolArray:
        return np.asarray((self.nearest(points_m) == points_m).all(axis=-1))

    def nearest(self, points_m: FloatArray) -> FloatArray:
        return np.asarray(self.points_m[cKDTree(self.points_m).query(points_m)[1]])

    def samples_m(self, count: int, sampling: region.Sampling, seed: int) -> Iterator[FloatArray]:
        return region.in_chunks(self.points_m)

    def with_fewer_points(self, most: int) -> PointList:
        count = len(self.points_m)
        every = np.linspace(0, count - 1, min(most, count)).astype(int)
        return PointList(self.points_m[every])

    def inside_m(self, rng: np.random.Generator, count: int) -> FloatArray:
        return self.points_m[rng.integers(len(self.points_m), size=count)]

    def border(self) -> region.Border:
        return region.Border(self.points_m[:_MOST_VERTICES], np.empty((0, 2, 3)), [])

    def frame(self) -> region.BoxFrame:
        """Return each point as a box without size."""
        return region.BoxFrame(
            np.zeros(3), np.eye(3), self.points_m, self.points_m, np.zeros((0, 3))
        )
