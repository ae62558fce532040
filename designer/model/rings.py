"""Grids that follow the boundary of a region, so that its edge is drawn where it is."""

from __future__ import annotations

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.model import polygon

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
        centre_m + polygon.reach_m(polygon_m, centre_m, a) * np.array([np.cos(a), np.sin(a)])
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
