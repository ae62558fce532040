"""Where the platform shall be able to go: what every kind of region tells of itself, and the kinds.

An upright prism over a convex polygon, an upright rectangle for robots whose cables lie in one
plane, and a list of positions.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial import cKDTree

from designer import checked
from designer.arrays import BoolArray, FloatArray, finite_array, frozen_array
from designer.model import polygon
from designer.model.polygon import (
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

Sampling = Literal["low_discrepancy", "grid"]
Position = Callable[[FloatArray], str]
Plural = Callable[[int, str], str]
Sizes = tuple[tuple[str, float, str], ...]
"""Of each measure its name, value and unit."""

CHUNK = 2**15
"""Positions per chunk; a power of two keeps Sobol sequences balanced."""
ON_A_SIDE = 1e-6
"""Relative to the size of the region: a position that is no farther from a side lies on it."""
_STRAIGHT = 1e-9
"""Relative: a corner that turns back by less lies on a straight side."""
_BEYOND = 1e-12
"""Relative: by so much a region is made larger before boxes are cut at its border."""
_OFF_LINE = 1e-9
"""Relative: points that stray less from a straight line lie on it."""
_UNIT_SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
_MAX_VERTICES = 256
"""Of a long list only the first points are tried as corners: all of it is tried anyway."""


@dataclass(frozen=True, slots=True, eq=False)
class Border:
    """The border of a region, piece by piece: most extremes lie there, the hardest in corners."""

    vertices_m: FloatArray  # (n_vertices, 3): Corners [m]
    edges_m: FloatArray  # (n_edges, 2, 3): Ends of its edges [m]
    faces_m: list[FloatArray]  # (n_corners, 3): Corners of its faces, convex and in order [m]

    def landmarks_m(self) -> FloatArray:
        """Return vertices, middles of edges and middles of faces (n, 3) [m]."""
        middles = [face.mean(axis=0) for face in self.faces_m]
        return np.concatenate(
            [self.vertices_m, self.edges_m.mean(axis=1), np.array(middles).reshape(-1, 3)]
        )

    def samples_m(self, rng: np.random.Generator, per_edge: int, per_face: int) -> FloatArray:
        """Return random points on each edge, evenly spread, and on each face (n, 3) [m]."""
        step = (np.arange(per_edge) + rng.random((len(self.edges_m), per_edge))) / per_edge
        start, end = self.edges_m[:, :1], self.edges_m[:, 1:]
        on_edges = (start + step[..., None] * (end - start)).reshape(-1, 3)
        on_faces = [polygon.within_m(face, rng.random((per_face, 3))) for face in self.faces_m]
        return np.concatenate([on_edges, *on_faces])


def ring(corners_m: FloatArray) -> FloatArray:
    """Return the edges of a polygon (n_corners, 2, 3), from each corner to the next [m]."""
    return np.stack([corners_m, np.roll(corners_m, -1, axis=0)], axis=1)


class Region(checked.Value, ABC):
    """What every region tells of itself; positions in the world frame, z upward.

    Methods with a default here decline: whoever asks then goes without a map of a section, sides
    that move, or a proof.
    """

    __slots__ = ()
    is_discrete: ClassVar[bool] = False
    """Whether there is nothing between its points."""
    has_sides: ClassVar[bool] = False
    """Whether it has sides that may move outward."""
    is_upright: ClassVar[bool] = False
    """Whether it lies in an upright plane, and so has no area in plan."""

    @property
    @abstractmethod
    def bounds_m(self) -> FloatArray:
        """Smallest box around it, (2, 3): lower corner, upper corner [m]."""

    @property
    @abstractmethod
    def sizes(self) -> Sizes:
        """Areas and volume."""

    @property
    def volume_m3(self) -> float | None:
        """Volume [m³]; None where it has none."""
        return next((value for _, value, unit in self.sizes if unit == "m³"), None)

    @property
    def along(self) -> FloatArray:
        """Unit vector, world x and y (2,), that is drawn to the right: its width, or x."""
        return np.array([1.0, 0.0])

    @abstractmethod
    def words(self, position: Position, plural: Plural) -> str:
        """Return what it is, but for its heights.

        ``position`` writes a corner, ``plural`` a count with its noun.
        """

    @abstractmethod
    def contains(self, points_m: FloatArray) -> BoolArray:
        """Tell which of the points (..., 3) lie inside or on the boundary."""

    @abstractmethod
    def nearest(self, points_m: FloatArray) -> FloatArray:
        """Return the point of the region nearest to each of the points (..., 3) [m]."""

    @abstractmethod
    def samples_m(self, count: int, sampling: Sampling, seed: int) -> Iterator[FloatArray]:
        """Yield about so many positions, even and repeatable, in chunks (at most `CHUNK`, 3) [m].

        A list of points is taken whole.
        """

    def with_fewer_points(self, most: int) -> Region:
        """Return a list of at most so many of its points, evenly drawn; any other region whole."""
        return self

    @abstractmethod
    def inside_m(self, rng: np.random.Generator, count: int) -> FloatArray:
        """Return random positions (count, 3) [m]."""

    @abstractmethod
    def border(self) -> Border:
        """Return its vertices, edges and faces."""

    @property
    def centre_m(self) -> FloatArray:
        """Middle in plan, (2,) [m]."""
        return np.asarray(np.concatenate([*self.samples_m(1000, "grid", 0)])[:, :2].mean(axis=0))

    def reach_m(self, start_m: FloatArray, azimuth_rad: float) -> float | None:
        """Return how far it reaches in plan from a point (2,) in it [m]; None where unknown."""
        return None

    def depth_m(self, points_m: FloatArray) -> FloatArray | None:
        """Return how far points (n, 3) in it lie inside its sides, in plan [m]; None without."""
        return None

    def outward(self, position_m: FloatArray) -> FloatArray:
        """Return how a position moves as the sides move outward by a metre (3,).

        Zero within the region, and where it has no sides; in a corner, along with both sides.
        """
        return np.zeros(3)

    def grown(self, margin_m: float) -> Region:
        """Return it with its sides moved outward, its heights kept; itself where it has none."""
        return self

    def outline_m(self, plane: list[int]) -> FloatArray:
        """Return the outline (n, 2) of what is seen along the axis that is not in the plane [m]."""
        (left, low), (right, high) = self.bounds_m[:, plane]
        return np.array([[left, low], [right, low], [right, high], [left, high]])

    def section_m(
        self, share: float = 1.0, rings: int = RINGS, spokes: int = SPOKES
    ) -> FloatArray | None:
        """Return the section that maps show, as rings (rings, spokes + 1, 3) [m].

        Row 0 is the centre, the last row the outline with all its corners; the last spoke repeats
        the first. A level section is at a ``share`` of the height. None where there is no area.
        """
        return None

    def outside_m(self, rings: int, spokes: int, rows: int) -> Mapping[str, FloatArray]:
        """Return grids (n, m, 3) of its outside, by their names [m]; empty where it has no area."""
        return {}

    def cutaway_m(self, toward_m: FloatArray) -> Mapping[str, FloatArray]:
        """Return grids (n, m, 3) of its outside, opened where a position is [m]; may be empty."""
        return {}

    def opening_azimuth_rad(self, toward_m: FloatArray) -> float | None:
        """Return the direction in which `cutaway_m` is open [rad]; None where nothing is cut."""
        return None

    def frame(self) -> BoxFrame | None:
        """Return coordinates in which boxes cover it, for proofs; None where nothing is proved."""
        return None


@dataclass(frozen=True, slots=True, eq=False)
class BoxFrame:
    """Coordinates of positions in which boxes cover a region."""

    origin_m: FloatArray  #: (3,): Position where all coordinates are zero [m]
    axes: FloatArray  #: (3, 3): Its change with each of them, columns
    #: (n_boxes, 3): Boxes that cover the region
    low: FloatArray
    high: FloatArray
    #: (n_sides, 3): It is where ``sides[:, :2] @ coordinates[:2] + sides[:, 2]`` ≤ 0; none for a
    #: box
    sides: FloatArray


def require_ascending(ends_m: tuple[float, float], axis: str = "z") -> None:
    """Refuse ends that are no ascending numbers [m]."""
    low, high = ends_m
    checked.FINITE.require(f"the lowest {axis}", low)
    checked.FINITE.require(f"the highest {axis}", high)
    if low > high:
        raise ValueError(f"the lowest {axis}, {low:g} m, is above the highest, {high:g} m")


def in_plan(points_m: ArrayLike, inset_m: float) -> FloatArray:
    """Return points (n, 2 or 3) seen from above (n, 2) [m]."""
    checked.FINITE.require("inset_m", inset_m)
    points = np.asarray(points_m, dtype=np.float64)
    return finite_array("points_m", points[..., :2], None, 2)


def box_around(plan_m: FloatArray, z_m: tuple[float, float]) -> FloatArray:
    """Return the smallest box around an upright body, (2, 3) [m]."""
    low, high = plan_m.min(axis=0), plan_m.max(axis=0)
    return np.array([[*low, z_m[0]], [*high, z_m[1]]])


def in_chunks(points: FloatArray, size: int = CHUNK) -> Iterator[FloatArray]:
    """Yield points (n, 3) in chunks."""
    return (points[start : start + size] for start in range(0, len(points), size))


def even_axes(low: FloatArray, high: FloatArray, steps: FloatArray) -> list[FloatArray]:
    """Return about so many steps along each axis, both ends among them."""
    counts = np.maximum(np.ceil(steps).astype(int), 1)
    return [np.linspace(a, b, n + 1) for a, b, n in zip(low, high, counts, strict=True)]


def grid_of(*axes: ArrayLike) -> FloatArray:
    """Return all combinations of the values on axes (n, n_axes)."""
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(axes))


@checked.reports_field
@dataclass(frozen=True, slots=True, eq=False)
class Prism(Region):
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
        require_ascending(self.z_m)
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
        points = in_plan(points_m, inset_m)
        return cls(polygon.inset_hull_m(points, inset_m), z_m)

    @classmethod
    def box(
        cls, x_m: tuple[float, float], y_m: tuple[float, float], z_m: tuple[float, float]
    ) -> Prism:
        """Return an axis-parallel box."""
        require_ascending(x_m, "x")
        require_ascending(y_m, "y")
        corners = [(x_m[0], y_m[0]), (x_m[1], y_m[0]), (x_m[1], y_m[1]), (x_m[0], y_m[1])]
        return cls(frozen_array(corners), z_m)

    @property
    def bounds_m(self) -> FloatArray:
        return box_around(self.polygon_m, self.z_m)

    @property
    def area_m2(self) -> float:
        """Area of the base [m²]."""
        return polygon.area_m2(self.polygon_m)

    @property
    def sizes(self) -> Sizes:
        volume = self.area_m2 * (self.z_m[1] - self.z_m[0])
        return ("Base area", self.area_m2, "m²"), ("Volume", volume, "m³")

    def words(self, position: Position, plural: Plural) -> str:
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

    def samples_m(self, count: int, sampling: Sampling, seed: int) -> Iterator[FloatArray]:
        # Those of an even sample of the box around it that lie inside.
        low, high = self.bounds_m
        if sampling == "grid":
            spacing = np.cbrt((self.volume_m3 or 0.0) / count)
            x, y, z = even_axes(low, high, (high - low) / spacing)
            for layer in (grid_of(x, y, [height]) for height in z):
                yield from in_chunks(layer[self.contains(layer)])
            return
        sequence = sobol(3, seed, CHUNK)
        while count > 0:
            points = low + next(sequence) * (high - low)
            inside = points[self.contains(points)][:count]
            count -= len(inside)
            if len(inside) > 0:
                yield inside

    def inside_m(self, rng: np.random.Generator, count: int) -> FloatArray:
        plan = polygon.within_m(self.polygon_m, rng.random((count, 3)))
        return np.column_stack([plan, rng.uniform(*self.z_m, count)])

    def border(self) -> Border:
        low, high = (
            np.column_stack([self.polygon_m, np.full(len(self.polygon_m), z)]) for z in self.z_m
        )
        upright = np.stack([low, high], axis=1)
        sides = [
            np.array([a, b, d, c])
            for (a, c), (b, d) in zip(upright, np.roll(upright, -1, axis=0), strict=True)
        ]
        edges = np.concatenate([ring(low), ring(high), upright])
        return Border(np.concatenate([low, high]), edges, [low, high, *sides])

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
        sides = normals[gaps <= ON_A_SIDE * float(np.ptp(self.polygon_m, axis=0).max())]
        if len(sides) == 0:
            return np.zeros(3)
        direction, *_ = np.linalg.lstsq(sides, np.ones(len(sides)), rcond=None)
        return np.append(direction, 0.0)

    def grown(self, margin_m: float) -> Prism:
        return Prism.over(self.polygon_m, -margin_m, self.z_m)

    def outline_m(self, plane: list[int]) -> FloatArray:
        return self.polygon_m if plane == [0, 1] else Region.outline_m(self, plane)

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

    def frame(self) -> BoxFrame:
        low, high = self.bounds_m
        corners, edges = self.polygon_m, polygon.edges_m(self.polygon_m)
        lengths = np.hypot(*edges.T)
        edges, corners = edges[lengths > 0.0], corners[lengths > 0.0]
        outward = np.column_stack([edges[:, 1], -edges[:, 0]]) / lengths[lengths > 0.0, None]
        beyond = _BEYOND * np.abs(self.bounds_m).max()
        sides = np.column_stack([outward, -np.einsum("ij,ij->i", outward, corners) - beyond])
        return BoxFrame(np.zeros(3), np.eye(3), low[None], high[None], sides)


@checked.reports_field
@dataclass(frozen=True, slots=True, eq=False)
class Rectangle(Region):
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
        require_ascending(self.z_m)
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
        points = in_plan(points_m, inset_m)
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
        return box_around(self.ends_m, self.z_m)

    @property
    def size_m(self) -> FloatArray:
        """Width and height (2,) [m]."""
        return np.array([np.linalg.norm(np.ptp(self.ends_m, axis=0)), np.ptp(self.z_m)])

    @property
    def sizes(self) -> Sizes:
        return (("Area", float(np.prod(self.size_m)), "m²"),)

    @property
    def along(self) -> FloatArray:
        """Unit vector along its width, world x and y (2,), toward larger x."""
        edge = self.ends_m[1] - self.ends_m[0]
        edge = -edge if tuple(edge) < (0.0, 0.0) else edge
        return np.asarray(edge / np.linalg.norm(edge))

    def words(self, position: Position, plural: Plural) -> str:
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

    def samples_m(self, count: int, sampling: Sampling, seed: int) -> Iterator[FloatArray]:
        if sampling == "grid":
            spacing = np.sqrt(np.prod(self.size_m) / count)
            share = grid_of(*even_axes(np.zeros(2), np.ones(2), self.size_m / spacing))
            yield from in_chunks(self.at(share))
            return
        sequence = sobol(2, seed, CHUNK)
        for start in range(0, count, CHUNK):
            yield self.at(next(sequence)[: count - start])

    def inside_m(self, rng: np.random.Generator, count: int) -> FloatArray:
        return self.at(rng.random((count, 2)))

    def border(self) -> Border:
        corners = self.at(_UNIT_SQUARE)
        return Border(corners, ring(corners), [corners])

    def outward(self, position_m: FloatArray) -> FloatArray:
        share = float(self.shares(position_m)[0])
        direction = np.append((self.ends_m[1] - self.ends_m[0]) / self.size_m[0], 0.0)
        at_start, at_end = (abs(share - end) <= ON_A_SIDE for end in (0.0, 1.0))
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

    def frame(self) -> BoxFrame:
        edge = self.ends_m[1] - self.ends_m[0]
        axes = np.array([[edge[0], 0.0, 0.0], [edge[1], 0.0, 0.0], [0.0, 0.0, 1.0]])
        low, high = np.array([[0.0, 0.0, self.z_m[0]]]), np.array([[1.0, 0.0, self.z_m[1]]])
        return BoxFrame(np.array([*self.ends_m[0], 0.0]), axes, low, high, np.zeros((0, 3)))


@checked.reports_field
@dataclass(frozen=True, slots=True, eq=False)
class PointList(Region):
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
    def sizes(self) -> Sizes:
        return ()

    def words(self, position: Position, plural: Plural) -> str:
        return f"a list of {plural(len(self.points_m), 'point')}"

    def contains(self, points_m: FloatArray) -> BoolArray:
        return np.asarray((self.nearest(points_m) == points_m).all(axis=-1))

    def nearest(self, points_m: FloatArray) -> FloatArray:
        return np.asarray(self.points_m[cKDTree(self.points_m).query(points_m)[1]])

    def samples_m(self, count: int, sampling: Sampling, seed: int) -> Iterator[FloatArray]:
        return in_chunks(self.points_m)

    def with_fewer_points(self, most: int) -> PointList:
        count = len(self.points_m)
        every = np.linspace(0, count - 1, min(most, count)).astype(int)
        return PointList(self.points_m[every])

    def inside_m(self, rng: np.random.Generator, count: int) -> FloatArray:
        return self.points_m[rng.integers(len(self.points_m), size=count)]

    def border(self) -> Border:
        return Border(self.points_m[:_MAX_VERTICES], np.empty((0, 2, 3)), [])

    def frame(self) -> BoxFrame:
        """Return each point as a box without size."""
        return BoxFrame(np.zeros(3), np.eye(3), self.points_m, self.points_m, np.zeros((0, 3)))
