"""An upright prism over a convex polygon."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from designer import checked
from designer.arrays import BoolArray, FloatArray, frozen_array
from designer.model import polygon, region
from designer.model.rings import (
    OPENING_RAD,
    RINGS,
    SPOKES,
    at_height,
    azimuth_rad,
    opened,
    outline_m,
    rings_m,
)
from designer.model.sobol import sobol

_STRAIGHT = 1e-9
"""Relative: a corner that turns back by less lies on a straight side."""
_BEYOND = 1e-12
"""Relative: by so much a region is made larger before boxes are cut at its border."""


@checked.reports_field
@dataclass(frozen=True, slots=True, eq=False)
class Prism(region.Region):
    """An upright prism over a convex polygon.

    Parameters
    ----------
    polygon_m : array (n_corners, 2)
        Corners of the base, counter-clockwise, world x and y [m].
    z_m : tuple of float
        Lowest and highest z [m].
    """

    has_sides: ClassVar[bool] = True

    polygon_m: Annotated[FloatArray, checked.Shape((None, 2))]
    z_m: tuple[float, float]

    def __post_init__(self) -> None:
        checked.check_fields(self)
        region.require_ascending(self.z_m)
        edge = polygon.edges_m(self.polygon_m)
        after = np.roll(edge, -1, axis=0)
        turn = edge[:, 0] * after[:, 1] - edge[:, 1] * after[:, 0]
        flat = _STRAIGHT * float(np.sum(edge**2))
        if len(edge) < 3 or not self.area_m2 > 0.0 or (turn < -flat).any():
            raise ValueError("polygon_m must be convex, with its corners counter-clockwise")

    @classmethod
    def over(cls, points_m: ArrayLike, inset_m: float, z_m: tuple[float, float]) -> Prism:
        """Return the prism over the hull of ``points_m`` (n, 2 or 3), moved inward by ``inset_m``.

        Raises
        ------
        ValueError
            If the points lie on one line, or nothing is left inside the inset.
        """
        points = region.in_plan(points_m, inset_m)
        return cls(polygon.inset_hull_m(points, inset_m), z_m)

    @classmethod
    def box(
        cls, x_m: tuple[float, float], y_m: tuple[float, float], z_m: tuple[float, float]
    ) -> Prism:
        """Return an axis-parallel box."""
        region.require_ascending(x_m, "x")
        region.require_ascending(y_m, "y")
        corners = [(x_m[0], y_m[0]), (x_m[1], y_m[0]), (x_m[1], y_m[1]), (x_m[0], y_m[1])]
        return cls(frozen_array(corners), z_m)

    @property
    def bounds_m(self) -> FloatArray:
        return region.box_around(self.polygon_m, self.z_m)

    @property
    def area_m2(self) -> float:
        """Area of the base [m²]."""
        return polygon.area_m2(self.polygon_m)

    @property
    def sizes(self) -> region.Sizes:
        volume = self.area_m2 * (self.z_m[1] - self.z_m[0])
        return ("Base area", self.area_m2, "m²"), ("Volume", volume, "m³")

    def words(self, position: region.Position, plural: region.Plural) -> str:
        return f"upright prism over {len(self.polygon_m)} corners"

    def contains(self, points_m: FloatArray) -> BoolArray:
        in_base = polygon.contains(self.polygon_m, points_m[..., :2])
        return np.asarray(
            in_base & (points_m[..., 2] >= self.z_m[0]) & (points_m[..., 2] <= self.z_m[1])
        )

    def nearest(self, points_m: FloatArray) -> FloatArray:
        clipped = np.array(points_m, dtype=np.float64)
        clipped[..., 2] = np.clip(points_m[..., 2], *self.z_m)
        outside = ~polygon.contains(self.polygon_m, clipped[..., :2])
        if outside.any():
            plan = clipped[outside, :2]
            clipped[outside, :2] = polygon.nearest_on_edges_m(self.polygon_m, plan)
        return clipped

    def samples_m(self, count: int, sampling: region.Sampling, seed: int) -> Iterator[FloatArray]:
        # Those of an even sample of the box around it that lie inside.
        low, high = self.bounds_m
        if sampling == "grid":
            spacing = np.cbrt((self.volume_m3 or 0.0) / count)
            x, y, z = region.even_axes(low, high, (high - low) / spacing)
            for layer in (region.grid_of(x, y, [height]) for height in z):
                yield from region.in_chunks(layer[self.contains(layer)])
            return
        sequence = sobol(3, seed, region.CHUNK)
        while count > 0:
            points = low + next(sequence) * (high - low)
            inside = points[self.contains(points)][:count]
            count -= len(inside)
            if len(inside) > 0:
                yield inside

    def inside_m(self, rng: np.random.Generator, count: int) -> FloatArray:
        plan = polygon.within_m(self.polygon_m, rng.random((count, 3)))
        return np.column_stack([plan, rng.uniform(*self.z_m, count)])

    def border(self) -> region.Border:
        low, high = (
            np.column_stack([self.polygon_m, np.full(len(self.polygon_m), z)]) for z in self.z_m
        )
        upright = np.stack([low, high], axis=1)
        sides = [
            np.array([a, b, d, c])
            for (a, c), (b, d) in zip(upright, np.roll(upright, -1, axis=0), strict=True)
        ]
        edges = np.concatenate([region.ring(low), region.ring(high), upright])
        return region.Border(np.concatenate([low, high]), edges, [low, high, *sides])

    @property
    def centre_m(self) -> FloatArray:
        return polygon.centroid_m(self.polygon_m)

    def reach_m(self, start_m: FloatArray, azimuth_rad: float) -> float:
        return polygon.reach_m(self.polygon_m, start_m, azimuth_rad)

    def depth_m(self, points_m: FloatArray) -> FloatArray:
        edges, to_point = polygon.edges_m(self.polygon_m), points_m[:, None, :2] - self.polygon_m
        area = edges[:, 0] * to_point[..., 1] - edges[:, 1] * to_point[..., 0]
        return np.asarray((area / np.linalg.norm(edges, axis=1)).min(axis=1))

    def outward(self, position_m: FloatArray) -> FloatArray:
        edges = polygon.edges_m(self.polygon_m)
        normals = np.column_stack([edges[:, 1], -edges[:, 0]])
        normals /= np.linalg.norm(edges, axis=1)[:, None]
        gaps = np.einsum("ek,ek->e", normals, self.polygon_m - position_m[:2])
        sides = normals[gaps <= region.ON_A_SIDE * float(np.ptp(self.polygon_m, axis=0).max())]
        if len(sides) == 0:
            return np.zeros(3)
        direction, *_ = np.linalg.lstsq(sides, np.ones(len(sides)), rcond=None)
        return np.append(direction, 0.0)

    def grown(self, margin_m: float) -> Prism:
        return Prism.over(self.polygon_m, -margin_m, self.z_m)

    def outline_m(self, plane: list[int]) -> FloatArray:
        return self.polygon_m if plane == [0, 1] else region.Region.outline_m(self, plane)

    def section_m(self, share: float = 1.0, rings: int = RINGS, spokes: int = SPOKES) -> FloatArray:
        outline = outline_m(self.polygon_m, spokes)
        height_m = (1.0 - share) * self.z_m[0] + share * self.z_m[1]
        return at_height(rings_m(self.centre_m, outline, rings), height_m)

    def outside_m(self, rings: int, spokes: int, rows: int) -> Mapping[str, FloatArray]:
        top, bottom = (self.section_m(share, rings, spokes) for share in (1.0, 0.0))
        heights_m = np.linspace(*self.z_m, rows) - self.z_m[0]
        wall = np.stack([bottom[-1] + np.array([0.0, 0.0, height]) for height in heights_m])
        return {"top": top, "bottom": bottom, "wall": wall}

    def cutaway_m(self, toward_m: FloatArray) -> Mapping[str, FloatArray]:
        """Return ``top``, ``bottom``, ``wall``, ``cut`` and ``other_cut``.

        One of the two cuts runs from the axis of the prism through the position.
        """
        start_rad = azimuth_rad(toward_m[:2] - self.centre_m)
        outline = opened(self.polygon_m, self.centre_m, float(start_rad))
        rings = rings_m(self.centre_m, outline, 48)

        def raised(line: FloatArray) -> FloatArray:
            return np.stack([at_height(line, z) for z in np.linspace(*self.z_m, 24)])

        return {
            "top": at_height(rings, self.z_m[1]),
            "bottom": at_height(rings, self.z_m[0]),
            "wall": raised(outline),
            "cut": raised(rings[:, 0]),
            "other_cut": raised(rings[:, -1]),
        }

    def opening_azimuth_rad(self, toward_m: FloatArray) -> float:
        return float(azimuth_rad(toward_m[:2] - self.centre_m) + 0.5 * OPENING_RAD)

    def frame(self) -> region.BoxFrame:
        low, high = self.bounds_m
        corners, edges = self.polygon_m, polygon.edges_m(self.polygon_m)
        lengths = np.hypot(*edges.T)
        edges, corners = edges[lengths > 0.0], corners[lengths > 0.0]
        outward = np.column_stack([edges[:, 1], -edges[:, 0]]) / lengths[lengths > 0.0, None]
        beyond = _BEYOND * np.abs(self.bounds_m).max()
        sides = np.column_stack([outward, -np.einsum("ij,ij->i", outward, corners) - beyond])
        return region.BoxFrame(np.zeros(3), np.eye(3), low[None], high[None], sides)
