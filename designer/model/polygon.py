"""Convex polygons in plan, corners (n_corners, 2) counter-clockwise [m], and grids along them.

Maps are drawn on such grids, so that the edge of a region is where it is.
"""

from __future__ import annotations

import numpy as np
from scipy.spatial import ConvexHull, HalfspaceIntersection, QhullError

from designer.arrays import BoolArray, FloatArray, IntArray, frozen_array


def edges_m(polygon_m: FloatArray) -> FloatArray:
    """Return the way from each corner to the next (n_corners, 2) [m]."""
    return np.asarray(np.concatenate([polygon_m[1:], polygon_m[:1]]) - polygon_m)


def area_m2(polygon_m: FloatArray) -> float:
    """Return the area by the shoelace formula, negative where corners are clockwise [m²]."""
    x, y = polygon_m.T
    return float(0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def inset_hull_m(points_m: FloatArray, inset_m: float) -> FloatArray:
    """Return the hull of points (n, 2), its sides moved inward (n_corners, 2) [m].

    Raises
    ------
    ValueError
        If the points lie on one line, or nothing is left inside the inset.
    """
    try:
        hull = ConvexHull(points_m)
    except QhullError:
        raise ValueError("the points lie on one line, so they span no area") from None
    sides = hull.equations + np.array([0.0, 0.0, inset_m])
    inside = points_m[hull.vertices].mean(axis=0)
    if inset_m > 0.0:
        inside, radius = _largest_circle(sides)
        if radius <= 0.0:
            raise ValueError(f"nothing is left inside an inset of {inset_m:g} m")
    corners = HalfspaceIntersection(sides, inside).intersections
    return frozen_array(corners[ConvexHull(corners).vertices])


def _largest_circle(sides: FloatArray) -> tuple[FloatArray, float]:
    """Return centre (2,) and radius of the largest circle inside `normal · x + offset ≤ 0`."""
    from scipy.optimize import linprog  # keeps `designer --help` light

    x, y, radius = linprog(
        [0.0, 0.0, -1.0],
        A_ub=np.hstack([sides[:, :2], np.ones((len(sides), 1))]),
        b_ub=-sides[:, 2],
        bounds=[(None, None)] * 3,
    ).x
    return np.array([x, y]), float(radius)


def contains(polygon_m: FloatArray, points_m: FloatArray) -> BoolArray:
    """Tell which of the points (..., 2) lie inside or on the boundary."""
    edges = edges_m(polygon_m)
    least = -1e-12 * np.hypot(*edges.T) * np.ptp(polygon_m)
    x, y = points_m[..., 0], points_m[..., 1]
    inside = np.ones(x.shape, dtype=np.bool_)
    for (u, v), (x_0, y_0), bound in zip(edges, polygon_m, least, strict=True):
        inside &= u * (y - y_0) - v * (x - x_0) >= bound
    return inside


def nearest_on_edges_m(polygon_m: FloatArray, points_m: FloatArray) -> FloatArray:
    """Return the point of the boundary nearest to each of the points (n, 2) [m]."""
    (x, y), (x_0, y_0) = points_m.T[..., None], polygon_m.T
    u, v = edges_m(polygon_m).T
    along = np.clip(((x - x_0) * u + (y - y_0) * v) / (u**2 + v**2), 0.0, 1.0)
    feet_x, feet_y = x_0 + along * u, y_0 + along * v
    rows = np.arange(len(points_m))
    best = np.argmin((feet_x - x) ** 2 + (feet_y - y) ** 2, axis=1)
    return np.column_stack([feet_x[rows, best], feet_y[rows, best]])


def within_m(corners_m: FloatArray, share: FloatArray) -> FloatArray:
    """Return points of a flat convex polygon (n_corners, 2 or 3), evenly spread over its area [m].

    ``share`` (n, 3) tells, between 0 and 1, which triangle of the fan about the first corner, and
    where in it.
    """
    corner, second, third = corners_m[0], corners_m[1:-1], corners_m[2:]
    u, v = second - corner, third - corner
    gram = np.einsum("ik,ik->i", u, u) * np.einsum("ik,ik->i", v, v)
    area = np.sqrt(np.maximum(gram - np.einsum("ik,ik->i", u, v) ** 2, 0.0))
    total = np.cumsum(area)
    which = np.minimum(np.searchsorted(total, share[:, 0] * total[-1]), len(area) - 1)
    a, b = share[:, 1], share[:, 2]
    beyond = a + b > 1.0
    a, b = np.where(beyond, 1.0 - a, a), np.where(beyond, 1.0 - b, b)
    return np.asarray(corner + a[:, None] * u[which] + b[:, None] * v[which])


def centroid_m(polygon_m: FloatArray) -> FloatArray:
    """Return the centre of area of a polygon (n_corners, 2), (2,) [m]."""
    origin = polygon_m[0]  # far from the frame's origin the products would cancel
    a, b = polygon_m - origin, np.roll(polygon_m, -1, axis=0) - origin
    twice_area = a[:, 0] * b[:, 1] - b[:, 0] * a[:, 1]
    weighted = ((a + b) * twice_area[:, None]).sum(axis=0)
    return np.asarray(origin + weighted / (3.0 * twice_area.sum()))


def reach_m(polygon_m: FloatArray, centre_m: FloatArray, azimuth_rad: float) -> float:
    """Return how far it is from a point (2,) inside a convex polygon to its edge [m].

    Parameters
    ----------
    polygon_m : array (n_corners, 2)
        Corners, counter-clockwise [m].
    centre_m, azimuth_rad : array (2,), float
        The point [m], and the direction from the x axis [rad].
    """
    edges = edges_m(polygon_m)
    outward = np.stack([edges[:, 1], -edges[:, 0]], axis=1)
    room = np.einsum("ek,ek->e", outward, polygon_m - centre_m)
    speed = outward @ np.array([np.cos(azimuth_rad), np.sin(azimuth_rad)])
    return float(np.min(room[speed > 0.0] / speed[speed > 0.0]))


OPENING_RAD = float(np.radians(100.0))
"""How wide a region is opened, so that one sees inside."""
RINGS, SPOKES = 90, 240
"""Of a map on paper: finer than its lines are wide."""


def outline_m(polygon_m: FloatArray, count: int) -> FloatArray:
    """Return some ``count`` points around a polygon (n_corners, 2), all corners among them [m].

    The first one stands again at the end.
    """
    following = np.roll(polygon_m, -1, axis=0)
    length = np.linalg.norm(following - polygon_m, axis=1)
    steps = np.maximum(np.round(count * length / length.sum()).astype(int), 1)
    parts = [
        a + np.linspace(0.0, 1.0, n, endpoint=False)[:, None] * (b - a)
        for a, b, n in zip(polygon_m, following, steps, strict=True)
    ]
    return np.concatenate([*parts, polygon_m[:1]])


def every_second(grid_m: FloatArray) -> tuple[IntArray, ...]:
    """Return the index of every second point along both axes of a grid, its rim kept."""
    rows, columns = (np.unique([*range(0, n, 2), n - 1]) for n in grid_m.shape[:2])
    return np.ix_(rows, columns)


def opened(polygon_m: FloatArray, centre_m: FloatArray, start_rad: float) -> FloatArray:
    """Return points around a polygon from the end of its opening on, back to its start (n, 2) [m].

    The opening begins in the direction ``start_rad`` from a point inside.
    """
    ends = [
        centre_m + reach_m(polygon_m, centre_m, a) * np.array([np.cos(a), np.sin(a)])
        for a in (start_rad, start_rad + OPENING_RAD)
    ]
    points = np.concatenate([outline_m(polygon_m, 180)[:-1], ends])
    angle = np.mod(azimuth_rad(points - centre_m) - start_rad, 2.0 * np.pi)
    angle[-2:] = [2.0 * np.pi, OPENING_RAD]
    order = np.argsort(angle)
    order = order[angle[order] >= OPENING_RAD]
    return np.asarray(points[order][::-1])


def rings_m(centre_m: FloatArray, outline_m: FloatArray, count: int) -> FloatArray:
    """Return rings from the centre to the outline, closer together outside [m].

    There the values that maps show climb.
    """
    share = 1.0 - (1.0 - np.linspace(0.0, 1.0, count)) ** 1.5
    return np.asarray(centre_m + share[:, None, None] * (outline_m - centre_m))


def at_height(plan_m: FloatArray, z_m: float) -> FloatArray:
    """Return points in plan (..., 2) at a height (..., 3) [m]."""
    return np.insert(plan_m, 2, z_m, axis=-1)


def azimuth_rad(direction: FloatArray) -> FloatArray:
    """Return the angle of directions (..., 2) from the x axis [rad]."""
    return np.arctan2(direction[..., 1], direction[..., 0])
