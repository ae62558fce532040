"""Grids that follow the boundary of a region, so that its edge is drawn where it is."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.model.region import Prism, Rectangle

_OPENING_RAD = np.radians(100.0)
_RINGS, _SPOKES = 90, 240


def centroid_m(polygon_m: FloatArray) -> FloatArray:
    """Return the centre of area of a polygon (n_corners, 2), (2,) [m]."""
    origin = polygon_m[0]  # far from the frame's origin the products would cancel
    a, b = polygon_m - origin, np.roll(polygon_m, -1, axis=0) - origin
    twice_area = a[:, 0] * b[:, 1] - b[:, 0] * a[:, 1]
    weighted = ((a + b) * twice_area[:, None]).sum(axis=0)
    return np.asarray(origin + weighted / (3.0 * twice_area.sum()))


def disc_m(region: Prism, z_m: float, rings: int = _RINGS, spokes: int = _SPOKES) -> FloatArray:
    """Return a horizontal section of the region as rings about its centre (rings, spokes + 1, 3).

    Row 0 is the centre, the last row the outline with all its corners; the last spoke repeats the
    first [m].
    """
    outline = outline_m(region.polygon_m, spokes)
    return _at_height(_rings(centroid_m(region.polygon_m), outline, rings), z_m)


def upright_disc_m(region: Rectangle) -> FloatArray:
    """Return a rectangle as rings about its centre, like `disc_m` (rings, spokes + 1, 3) [m]."""
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    return region.at(_rings(np.array([0.5, 0.5]), outline_m(corners, _SPOKES), _RINGS))


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


def cutaway_m(region: Prism, toward_m: FloatArray) -> Mapping[str, FloatArray]:
    """Return the outside of the region with a piece cut out, so that one sees inside.

    One of the two cuts runs from the axis of the region through the position ``toward_m``.

    Returns
    -------
    mapping of str to array (n, m, 3)
        Grids of positions of ``top``, ``bottom``, ``wall``, ``cut`` and ``other_cut`` [m].
    """
    centre = centroid_m(region.polygon_m)
    outline = _opened(region.polygon_m, centre, toward_m)
    rings = _rings(centre, outline, 48)
    low, high = region.z_m

    def raised(line: FloatArray) -> FloatArray:
        return np.stack([_at_height(line, z) for z in np.linspace(low, high, 24)])

    return {
        "top": _at_height(rings, high),
        "bottom": _at_height(rings, low),
        "wall": raised(outline),
        "cut": raised(rings[:, 0]),
        "other_cut": raised(rings[:, -1]),
    }


def reach_m(polygon_m: FloatArray, centre_m: FloatArray, azimuth_rad: float) -> float:
    """Return how far it is from a point (2,) inside a convex polygon to its edge [m].

    Parameters
    ----------
    polygon_m : array (n_corners, 2)
        Corners, counter-clockwise [m].
    centre_m, azimuth_rad : array (2,), float
        The point [m], and the direction from the x axis [rad].
    """
    edges = np.roll(polygon_m, -1, axis=0) - polygon_m
    outward = np.stack([edges[:, 1], -edges[:, 0]], axis=1)
    room = np.einsum("ek,ek->e", outward, polygon_m - centre_m)
    speed = outward @ np.array([np.cos(azimuth_rad), np.sin(azimuth_rad)])
    return float(np.min(room[speed > 0.0] / speed[speed > 0.0]))


def opening_azimuth_rad(region: Prism, toward_m: FloatArray) -> float:
    """Return the direction in which `cutaway_m` is open, seen from the centre [rad]."""
    toward = _azimuth(toward_m[:2] - centroid_m(region.polygon_m))
    return float(toward + 0.5 * _OPENING_RAD)


def _opened(polygon_m: FloatArray, centre: FloatArray, toward_m: FloatArray) -> FloatArray:
    """Points around the polygon from the end of the opening on, back to its start."""
    start = float(_azimuth(toward_m[:2] - centre))
    ends = [
        centre + reach_m(polygon_m, centre, a) * np.array([np.cos(a), np.sin(a)])
        for a in (start, start + _OPENING_RAD)
    ]
    points = np.concatenate([outline_m(polygon_m, 180)[:-1], ends])
    turned = np.mod(_azimuth(points - centre) - start, 2.0 * np.pi)
    turned[-2:] = [2.0 * np.pi, _OPENING_RAD]
    kept = np.argsort(turned)
    kept = kept[turned[kept] >= _OPENING_RAD]
    return np.asarray(points[kept][::-1])


def _rings(centre: FloatArray, outline: FloatArray, count: int) -> FloatArray:
    """Rings from the centre to the outline, closer together outside, where the values climb."""
    share = 1.0 - (1.0 - np.linspace(0.0, 1.0, count)) ** 1.5
    return np.asarray(centre + share[:, None, None] * (outline - centre))


def _at_height(plan: FloatArray, z_m: float) -> FloatArray:
    return np.insert(plan, 2, z_m, axis=-1)


def _azimuth(direction: FloatArray) -> FloatArray:
    return np.arctan2(direction[..., 1], direction[..., 0])
