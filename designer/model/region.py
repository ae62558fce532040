"""Where the platform shall be able to go: an upright prism or rectangle, or a list of points."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial import cKDTree

from designer.arrays import BoolArray, FloatArray, finite_array, frozen_array, require_number
from designer.model import polygon
from designer.model.border import Border, ring
from designer.model.sobol import sobol

Sampling = Literal["low_discrepancy", "grid"]
Position = Callable[[FloatArray], str]
Plural = Callable[[int, str], str]
Sizes = tuple[tuple[str, float, str], ...]
"""Of each measure its name, value and unit."""

CHUNK = 2**15
"""Positions per chunk; a power of two keeps Sobol sequences balanced."""
_OFF_LINE = 1e-9


class Shape(ABC):
    """What every region tells of itself; positions in the world frame, z upward.

    A new kind of region is a subclass, and one of `Region`.
    """

    __slots__ = ()
    is_discrete: ClassVar[bool] = False
    """Whether there is nothing between its points."""
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

    @abstractmethod
    def inside_m(self, rng: np.random.Generator, count: int) -> FloatArray:
        """Return random positions (count, 3) [m]."""

    @abstractmethod
    def border(self) -> Border:
        """Return its vertices, edges and faces."""


@dataclass(frozen=True, slots=True, eq=False)
class Prism(Shape):
    """An upright prism over a convex polygon.

    Parameters
    ----------
    polygon_m : array (n_corners, 2)
        Corners of the base, counter-clockwise, world x and y [m].
    z_m : tuple of float
        Lowest and highest z [m].
    """

    polygon_m: FloatArray
    z_m: tuple[float, float]

    def __post_init__(self) -> None:
        corners = finite_array("polygon_m", self.polygon_m, None, 2)
        object.__setattr__(self, "polygon_m", corners)
        _require_ascending(self.z_m)
        edge = polygon.edges_m(corners)
        after = np.roll(edge, -1, axis=0)
        turn = edge[:, 0] * after[:, 1] - edge[:, 1] * after[:, 0]
        flat = _OFF_LINE * float(np.sum(edge**2))
        if len(corners) < 3 or not self.area_m2 > 0.0 or (turn < -flat).any():
            raise ValueError("polygon_m must be convex, with its corners counter-clockwise")

    @classmethod
    def over(cls, points_m: ArrayLike, inset_m: float, z_m: tuple[float, float]) -> Prism:
        """Return the prism over the hull of ``points_m`` (n, 2 or 3), moved inward by ``inset_m``.

        Raises
        ------
        ValueError
            If the points lie on one line, or nothing is left inside the inset.
        """
        points = _in_plan(points_m, inset_m)
        return cls(polygon.inset_hull_m(points, inset_m), z_m)

    @classmethod
    def box(
        cls, x_m: tuple[float, float], y_m: tuple[float, float], z_m: tuple[float, float]
    ) -> Prism:
        """Return an axis-parallel box."""
        _require_ascending(x_m, "x")
        _require_ascending(y_m, "y")
        corners = [(x_m[0], y_m[0]), (x_m[1], y_m[0]), (x_m[1], y_m[1]), (x_m[0], y_m[1])]
        return cls(frozen_array(corners), z_m)

    @property
    def bounds_m(self) -> FloatArray:
        return _box_around(self.polygon_m, self.z_m)

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
        outside = ~self.contains(clipped)
        plan = clipped[outside, :2]
        clipped[outside, :2] = polygon.nearest_on_edges_m(self.polygon_m, plan)
        return clipped

    def samples_m(self, count: int, sampling: Sampling, seed: int) -> Iterator[FloatArray]:
        # Those of an even sample of the box around it that lie inside.
        low, high = self.bounds_m
        if sampling == "grid":
            spacing = np.cbrt((self.volume_m3 or 0.0) / count)
            x, y, z = _axes(low, high, (high - low) / spacing)
            for layer in (_grid(x, y, [height]) for height in z):
                yield from _in_chunks(layer[self.contains(layer)])
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


@dataclass(frozen=True, slots=True, eq=False)
class Rectangle(Shape):
    """An upright rectangle.

    Parameters
    ----------
    ends_m : array (2, 2)
        Where its lower edge begins and ends, world x and y [m].
    z_m : tuple of float
        Lowest and highest z [m].
    """

    is_upright: ClassVar[bool] = True

    ends_m: FloatArray
    z_m: tuple[float, float]

    def __post_init__(self) -> None:
        object.__setattr__(self, "ends_m", finite_array("ends_m", self.ends_m, 2, 2))
        _require_ascending(self.z_m)
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
        points = _in_plan(points_m, inset_m)
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
        return _box_around(self.ends_m, self.z_m)

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
            share = _grid(*_axes(np.zeros(2), np.ones(2), self.size_m / spacing))
            yield from _in_chunks(self.at(share))
            return
        sequence = sobol(2, seed, CHUNK)
        for start in range(0, count, CHUNK):
            yield self.at(next(sequence)[: count - start])

    def inside_m(self, rng: np.random.Generator, count: int) -> FloatArray:
        return self.at(rng.random((count, 2)))

    def border(self) -> Border:
        corners = self.at(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]))
        return Border(corners, ring(corners), [corners])


@dataclass(frozen=True, slots=True, eq=False)
class PointList(Shape):
    """A finite set of positions, each of which is visited.

    Parameters
    ----------
    points_m : array (n_points, 3)
        Positions of the platform, world frame [m].
    """

    is_discrete: ClassVar[bool] = True

    points_m: FloatArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "points_m", finite_array("points_m", self.points_m, None, 3))

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
        return _in_chunks(self.points_m)

    def inside_m(self, rng: np.random.Generator, count: int) -> FloatArray:
        return self.points_m[rng.integers(len(self.points_m), size=count)]

    def border(self) -> Border:
        return Border(self.points_m[:256], np.empty((0, 2, 3)), [])


Region = Prism | Rectangle | PointList
"""Any region."""


def _require_ascending(ends_m: tuple[float, float], axis: str = "z") -> None:
    low, high = ends_m
    require_number(f"the lowest {axis}", low)
    require_number(f"the highest {axis}", high)
    if low > high:
        raise ValueError(f"the lowest {axis}, {low:g} m, is above the highest, {high:g} m")


def _in_plan(points_m: ArrayLike, inset_m: float) -> FloatArray:
    require_number("inset_m", inset_m)
    points = np.asarray(points_m, dtype=np.float64)
    return finite_array("points_m", points[..., :2], None, 2)


def _box_around(plan_m: FloatArray, z_m: tuple[float, float]) -> FloatArray:
    low, high = plan_m.min(axis=0), plan_m.max(axis=0)
    return np.array([[*low, z_m[0]], [*high, z_m[1]]])


def _in_chunks(points: FloatArray, size: int = CHUNK) -> Iterator[FloatArray]:
    return (points[start : start + size] for start in range(0, len(points), size))


def _axes(low: FloatArray, high: FloatArray, steps: FloatArray) -> list[FloatArray]:
    counts = np.maximum(np.ceil(steps).astype(int), 1)
    return [np.linspace(a, b, n + 1) for a, b, n in zip(low, high, counts, strict=True)]


def _grid(*axes: ArrayLike) -> FloatArray:
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, len(axes))
