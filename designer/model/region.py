"""Where the platform shall be able to go: an upright prism or rectangle, or a list of points."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial import ConvexHull, HalfspaceIntersection, QhullError, cKDTree

from designer.arrays import BoolArray, FloatArray, finite_array, frozen_array, require_number

_OFF_LINE = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class Prism:
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
        polygon = finite_array("polygon_m", self.polygon_m, None, 2)
        object.__setattr__(self, "polygon_m", polygon)
        _require_ascending(self.z_m)
        edge = np.roll(polygon, -1, axis=0) - polygon
        after = np.roll(edge, -1, axis=0)
        turn = edge[:, 0] * after[:, 1] - edge[:, 1] * after[:, 0]
        flat = _OFF_LINE * float(np.sum(edge**2))
        if len(polygon) < 3 or not self.area_m2 > 0.0 or (turn < -flat).any():
            raise ValueError("polygon_m must be convex, with its corners counter-clockwise")

    @classmethod
    def over(cls, points_m: ArrayLike, inset_m: float, z_m: tuple[float, float]) -> Prism:
        """Return the prism over the hull of ``points_m`` (n, 2 or 3), moved inward by ``inset_m``.

        Raises
        ------
        ValueError
            If the points lie on one line, or nothing is left inside the inset.
        """
        points = np.asarray(points_m, dtype=np.float64)[:, :2]
        try:
            hull = ConvexHull(points)
        except QhullError:
            raise ValueError("the points lie on one line, so they span no area") from None
        halfplanes = hull.equations + np.array([0.0, 0.0, inset_m])
        inner, depth = _deepest_point(halfplanes)
        if depth <= 0.0:
            raise ValueError(f"nothing is left inside an inset of {inset_m:g} m")
        corners = HalfspaceIntersection(halfplanes, inner).intersections
        return cls(frozen_array(corners[ConvexHull(corners).vertices]), z_m)

    @classmethod
    def box(
        cls, x_m: tuple[float, float], y_m: tuple[float, float], z_m: tuple[float, float]
    ) -> Prism:
        """Return an axis-parallel box."""
        corners = [(x_m[0], y_m[0]), (x_m[1], y_m[0]), (x_m[1], y_m[1]), (x_m[0], y_m[1])]
        return cls(frozen_array(corners), z_m)

    @property
    def is_discrete(self) -> bool:
        """Whether there is nothing between its points."""
        return False

    @property
    def bounds_m(self) -> FloatArray:
        """Smallest box around the region, (2, 3): lower corner, upper corner [m]."""
        low, high = self.polygon_m.min(axis=0), self.polygon_m.max(axis=0)
        return np.array([[*low, self.z_m[0]], [*high, self.z_m[1]]])

    @property
    def area_m2(self) -> float:
        """Area of the base by the shoelace formula [m²]."""
        x, y = self.polygon_m.T
        return float(0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))

    @property
    def volume_m3(self) -> float:
        """Volume [m³]."""
        return self.area_m2 * (self.z_m[1] - self.z_m[0])

    def contains(self, points_m: FloatArray) -> BoolArray:
        """Tell which of the points (..., 3) lie inside or on the boundary."""
        edges = np.roll(self.polygon_m, -1, axis=0) - self.polygon_m
        to_point = points_m[..., None, :2] - self.polygon_m
        left = edges[:, 0] * to_point[..., 1] - edges[:, 1] * to_point[..., 0]
        scale = np.linalg.norm(edges, axis=1) * np.ptp(self.polygon_m)
        in_base = np.all(left >= -1e-12 * scale, axis=-1)
        return np.asarray(
            in_base & (points_m[..., 2] >= self.z_m[0]) & (points_m[..., 2] <= self.z_m[1])
        )

    def nearest(self, points_m: FloatArray) -> FloatArray:
        """Return the point of the region nearest to each of the points (..., 3) [m]."""
        clipped = np.array(points_m, dtype=np.float64)
        clipped[..., 2] = np.clip(points_m[..., 2], *self.z_m)
        outside = ~self.contains(clipped)
        clipped[outside, :2] = self._nearest_on_edges(clipped[outside, :2])
        return clipped

    def _nearest_on_edges(self, points_m: FloatArray) -> FloatArray:
        start = self.polygon_m
        edge = np.roll(start, -1, axis=0) - start
        along = np.einsum("pek,ek->pe", points_m[:, None] - start, edge) / np.sum(edge**2, axis=1)
        feet = start + np.clip(along, 0.0, 1.0)[..., None] * edge
        best = np.argmin(np.linalg.norm(feet - points_m[:, None], axis=2), axis=1)
        return np.asarray(feet[np.arange(len(points_m)), best])


@dataclass(frozen=True, slots=True, eq=False)
class Rectangle:
    """An upright rectangle.

    Parameters
    ----------
    ends_m : array (2, 2)
        Where its lower edge begins and ends, world x and y [m].
    z_m : tuple of float
        Lowest and highest z [m].
    """

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
        points = np.asarray(points_m, dtype=np.float64)[:, :2]
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
    def is_discrete(self) -> bool:
        """Whether there is nothing between its points."""
        return False

    @property
    def bounds_m(self) -> FloatArray:
        """Smallest box around the rectangle, (2, 3) [m]."""
        low, high = self.ends_m.min(axis=0), self.ends_m.max(axis=0)
        return np.array([[*low, self.z_m[0]], [*high, self.z_m[1]]])

    @property
    def size_m(self) -> FloatArray:
        """Width and height (2,) [m]."""
        return np.array([np.linalg.norm(np.ptp(self.ends_m, axis=0)), np.ptp(self.z_m)])

    @property
    def along(self) -> FloatArray:
        """Unit vector along its width, world x and y (2,), toward larger x."""
        edge = self.ends_m[1] - self.ends_m[0]
        edge = -edge if tuple(edge) < (0.0, 0.0) else edge
        return np.asarray(edge / np.linalg.norm(edge))

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
        """Tell which of the points (..., 3) lie in it."""
        gap = np.linalg.norm(points_m - self.nearest(points_m), axis=-1)
        return np.asarray(gap <= 1e-12 * np.linalg.norm(self.size_m))

    def nearest(self, points_m: FloatArray) -> FloatArray:
        """Return the point of the rectangle nearest to each of the points (..., 3) [m]."""
        return self.at(np.clip(self.shares(points_m), 0.0, 1.0))


@dataclass(frozen=True, slots=True, eq=False)
class PointList:
    """A finite set of positions, each of which is visited.

    Parameters
    ----------
    points_m : array (n_points, 3)
        Positions of the platform, world frame [m].
    """

    points_m: FloatArray

    def __post_init__(self) -> None:
        object.__setattr__(self, "points_m", finite_array("points_m", self.points_m, None, 3))

    @property
    def is_discrete(self) -> bool:
        """Whether there is nothing between its points."""
        return True

    @property
    def bounds_m(self) -> FloatArray:
        """Smallest box around the points, (2, 3) [m]."""
        return np.array([self.points_m.min(axis=0), self.points_m.max(axis=0)])

    def nearest(self, points_m: FloatArray) -> FloatArray:
        """Return the position nearest to each of the points (..., 3) [m]."""
        return np.asarray(self.points_m[cKDTree(self.points_m).query(points_m)[1]])


Region = Prism | Rectangle | PointList
"""Any region."""


def _require_ascending(z_m: tuple[float, float]) -> None:
    low, high = z_m
    require_number("the lowest z", low)
    require_number("the highest z", high)
    if low > high:
        raise ValueError(f"the lowest z, {low:g} m, is above the highest, {high:g} m")


def _deepest_point(halfplanes: FloatArray) -> tuple[FloatArray, float]:
    """Return the centre and radius of the largest circle inside ``normal · x + offset ≤ 0``."""
    from scipy.optimize import linprog  # keeps `designer --help` light

    answer = linprog(
        [0.0, 0.0, -1.0],
        A_ub=np.hstack([halfplanes[:, :2], np.ones((len(halfplanes), 1))]),
        b_ub=-halfplanes[:, 2],
        bounds=[(None, None)] * 3,
    )
    return np.asarray(answer.x[:2]), float(answer.x[2])
