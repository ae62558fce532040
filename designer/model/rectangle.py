"""An upright rectangle, for robots whose cables lie in one plane."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from designer import checked
from designer.arrays import BoolArray, FloatArray, frozen_array
from designer.model import region
from designer.model.rings import RINGS, SPOKES, outline_m, rings_m
from designer.model.sobol import sobol

_OFF_LINE = 1e-9
"""Relative: points that stray less from a straight line lie on it."""
_UNIT_SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


@checked.reports_field
@dataclass(frozen=True, slots=True, eq=False)
class Rectangle(region.Region):
    """An upright rectangle.

    Parameters
    ----------
    ends_m : array (2, 2)
        Where its lower edge begins and ends, world x and y [m].
    z_m : tuple of float
        Lowest and highest z [m].
    """

    has_sides: ClassVar[bool] = True
    is_upright: ClassVar[bool] = True

    ends_m: Annotated[FloatArray, checked.Shape((2, 2))]
    z_m: tuple[float, float]

    def __post_init__(self) -> None:
        checked.check_fields(self)
        region.require_ascending(self.z_m)
        if not np.ptp(self.ends_m, axis=0).any():
            raise ValueError("the two ends of the rectangle are the same point")

    @classmethod
    def over(cls, points_m: ArrayLike, inset_m: float, z_m: tuple[float, float]) -> Rectangle:
        """Return the rectangle over points (n, 2 or 3) on a line, its ends moved inward.

        Raises
        ------
        ValueError
            If the points are one point or not on a line, or nothing is left inside the inset.
        """
        points = region.in_plan(points_m, inset_m)
        middle = points.mean(axis=0)
        _, spread, axes = np.linalg.svd(points - middle)
        if spread[0] == 0.0 or (len(spread) > 1 and spread[1] > _OFF_LINE * spread[0]):
            raise ValueError("the points do not lie on one line, seen from above")
        along = (points - middle) @ axes[0]
        low, high = along.min() + inset_m, along.max() - inset_m
        if low >= high:
            raise ValueError(f"nothing is left inside an inset of {inset_m:g} m")
        return cls(frozen_array(middle + np.array([[low], [high]]) * axes[0]), z_m)

    @property
    def bounds_m(self) -> FloatArray:
        return region.box_around(self.ends_m, self.z_m)

    @property
    def size_m(self) -> FloatArray:
        """Width and height (2,) [m]."""
        return np.array([np.linalg.norm(np.ptp(self.ends_m, axis=0)), np.ptp(self.z_m)])

    @property
    def sizes(self) -> region.Sizes:
        return (("Area", float(np.prod(self.size_m)), "m²"),)

    @property
    def along(self) -> FloatArray:
        """Unit vector along its width, world x and y (2,), toward larger x."""
        edge = self.ends_m[1] - self.ends_m[0]
        edge = -edge if tuple(edge) < (0.0, 0.0) else edge
        return np.asarray(edge / np.linalg.norm(edge))

    def words(self, position: region.Position, plural: region.Plural) -> str:
        return f"upright rectangle from {' to '.join(position(end) for end in self.ends_m)}"

    def at(self, share: FloatArray) -> FloatArray:
        """Return the points (..., 3) at shares (..., 2) of width and height, from 0 to 1 [m]."""
        plan = self.ends_m[0] + share[..., :1] * (self.ends_m[1] - self.ends_m[0])
        z = self.z_m[0] + share[..., 1:] * (self.z_m[1] - self.z_m[0])
        return np.concatenate([plan, z], axis=-1)

    def shares(self, points_m: FloatArray) -> FloatArray:
        """Return shares (..., 2) of width and height of the feet of points (..., 3)."""
        edge = self.ends_m[1] - self.ends_m[0]
        along = (points_m[..., :2] - self.ends_m[0]) @ edge / (edge @ edge)
        up = (points_m[..., 2] - self.z_m[0]) / (self.z_m[1] - self.z_m[0])
        return np.stack([along, up], axis=-1)

    def contains(self, points_m: FloatArray) -> BoolArray:
        gap = np.linalg.norm(points_m - self.nearest(points_m), axis=-1)
        return np.asarray(gap <= 1e-12 * np.linalg.norm(self.size_m))

    def nearest(self, points_m: FloatArray) -> FloatArray:
        return self.at(np.clip(self.shares(points_m), 0.0, 1.0))

    def samples_m(self, count: int, sampling: region.Sampling, seed: int) -> Iterator[FloatArray]:
        if sampling == "grid":
            spacing = np.sqrt(np.prod(self.size_m) / count)
            share = region.grid_of(
                *region.even_axes(np.zeros(2), np.ones(2), self.size_m / spacing)
            )
            yield from region.in_chunks(self.at(share))
            return
        sequence = sobol(2, seed, region.CHUNK)
        for start in range(0, count, region.CHUNK):
            yield self.at(next(sequence)[: count - start])

    def inside_m(self, rng: np.random.Generator, count: int) -> FloatArray:
        return self.at(rng.random((count, 2)))

    def border(self) -> region.Border:
        corners = self.at(_UNIT_SQUARE)
        return region.Border(corners, region.ring(corners), [corners])

    def outward(self, position_m: FloatArray) -> FloatArray:
        share = float(self.shares(position_m)[0])
        direction = np.append((self.ends_m[1] - self.ends_m[0]) / self.size_m[0], 0.0)
        at_start, at_end = (abs(share - end) <= region.ON_A_SIDE for end in (0.0, 1.0))
        return np.asarray((at_end * 1.0 - at_start * 1.0) * direction)

    def grown(self, margin_m: float) -> Rectangle:
        return Rectangle.over(self.ends_m, -margin_m, self.z_m)

    def section_m(self, share: float = 1.0, rings: int = RINGS, spokes: int = SPOKES) -> FloatArray:
        """Return the rectangle itself, whatever the share of its height."""
        return self.at(rings_m(np.array([0.5, 0.5]), outline_m(_UNIT_SQUARE, spokes), rings))

    def outside_m(self, rings: int, spokes: int, rows: int) -> Mapping[str, FloatArray]:
        return {"section": self.section_m()}

    def cutaway_m(self, toward_m: FloatArray) -> Mapping[str, FloatArray]:
        return {"section": self.section_m()}

    def frame(self) -> region.BoxFrame:
        edge = self.ends_m[1] - self.ends_m[0]
        axes = np.array([[edge[0], 0.0, 0.0], [edge[1], 0.0, 0.0], [0.0, 0.0, 1.0]])
        low, high = np.array([[0.0, 0.0, self.z_m[0]]]), np.array([[1.0, 0.0, self.z_m[1]]])
        return region.BoxFrame(np.array([*self.ends_m[0], 0.0]), axes, low, high, np.zeros((0, 3)))
