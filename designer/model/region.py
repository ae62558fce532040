"""Where the platform shall be able to go: what every kind of region tells of itself."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike

from designer import checked
from designer.arrays import BoolArray, FloatArray, finite_array
from designer.model import polygon
from designer.model.rings import RINGS, SPOKES

Sampling = Literal["low_discrepancy", "grid"]
Position = Callable[[FloatArray], str]
Plural = Callable[[int, str], str]
Sizes = tuple[tuple[str, float, str], ...]
"""Of each measure its name, value and unit."""

CHUNK = 2**15
"""Positions per chunk; a power of two keeps Sobol sequences balanced."""
ON_A_SIDE = 1e-6
"""Relative to the size of the region: a position that is no farther from a side lies on it."""


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

    A new kind of region is a subclass in a file of its own. Methods with a default here decline:
    whoever asks then goes without a map of a section, sides that move, or a proof.
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
    """Coordinates of positions in which boxes cover a region.

    Parameters
    ----------
    origin_m : array (3,)
        Position where all coordinates are zero [m].
    axes : array (3, 3)
        Its change with each of them, columns.
    low, high : array (n_boxes, 3)
        Boxes that cover the region.
    sides : array (n_sides, 3)
        It is where ``sides[:, :2] @ coordinates[:2] + sides[:, 2]`` ≤ 0; none for a box.
    """

    origin_m: FloatArray
    axes: FloatArray
    low: FloatArray
    high: FloatArray
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
