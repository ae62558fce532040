"""Distances between straight pieces, and from straight pieces to triangles; all arrays broadcast.

After Ericson, Real-Time Collision Detection (2005), section 5.1.
"""

from __future__ import annotations

import numpy as np

from designer.arrays import BoolArray, FloatArray

_PARALLEL = 1e-14


def segment_distance_m(
    a: FloatArray, b: FloatArray, c: FloatArray, d: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the distance of segments ab and cd, and the middle between their nearest points.

    The squared distance is convex in the two parameters: its least value on the unit square is
    either inside, where both segments are crossed at right angles, or on one of the four sides,
    where an end of one is dropped onto the other.

    Parameters
    ----------
    a, b, c, d : array (..., 3)
        Ends [m].

    Returns
    -------
    distance_m : array (...)
    middle_m : array (..., 3)
    """
    u, v, r = b - a, d - c, a - c
    uu, vv, uv = _dot(u, u), _dot(v, v), _dot(u, v)
    ur, vr = _dot(u, r), _dot(v, r)
    determinant = uu * vv - uv * uv
    with np.errstate(invalid="ignore", divide="ignore"):
        s = (uv * vr - vv * ur) / determinant
        t = (uu * vr - uv * ur) / determinant
        inside = (
            (determinant > _PARALLEL * uu * vv) & (s >= 0.0) & (s <= 1.0) & (t >= 0.0) & (t <= 1.0)
        )
    zero, one = np.zeros_like(s), np.ones_like(s)
    candidates = (
        (np.where(inside, s, 0.0), np.where(inside, t, _onto(vr, vv))),
        (zero, _onto(vr, vv)),
        (one, _onto(vr + uv, vv)),
        (_onto(-ur, uu), zero),
        (_onto(uv - ur, uu), one),
    )
    best = np.full(s.shape, np.inf)
    best_s, best_t = zero, zero
    for s_k, t_k in candidates:
        gap = r + s_k[..., None] * u - t_k[..., None] * v
        squared = _dot(gap, gap)
        nearer = squared < best
        best = np.where(nearer, squared, best)
        best_s, best_t = np.where(nearer, s_k, best_s), np.where(nearer, t_k, best_t)
    middle = 0.5 * (a + best_s[..., None] * u + c + best_t[..., None] * v)
    return np.sqrt(best), middle


def triangle_distance_m(
    a: FloatArray, b: FloatArray, corners: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the distance of segments ab from filled triangles, and the nearest place on ab.

    Parameters
    ----------
    a, b : array (..., 3)
        Ends of the segments [m].
    corners : array (..., 3, 3)
        Corners of the triangles, along the second axis from the end [m].

    Returns
    -------
    distance_m : array (...)
    place_m : array (..., 3)
    """
    following = np.roll(corners, -1, axis=-2)
    to_edges, middles = segment_distance_m(a[..., None, :], b[..., None, :], corners, following)
    nearest = np.argmin(to_edges, axis=-1)[..., None]
    distance = np.take_along_axis(to_edges, nearest, axis=-1)[..., 0]
    place = np.take_along_axis(middles, nearest[..., None], axis=-2)[..., 0, :]
    normal = np.cross(
        following[..., 0, :] - corners[..., 0, :], corners[..., 2, :] - corners[..., 0, :]
    )
    normal = normal / np.linalg.norm(normal, axis=-1, keepdims=True)
    height_a = _dot(a - corners[..., 0, :], normal)
    height_b = _dot(b - corners[..., 0, :], normal)
    for end, height in ((a, height_a), (b, height_b)):
        over = _is_over(end, corners, following, normal) & (np.abs(height) < distance)
        distance = np.where(over, np.abs(height), distance)
        place = np.where(over[..., None], end, place)
    with np.errstate(invalid="ignore", divide="ignore"):
        share = height_a / (height_a - height_b)
    crosses = height_a * height_b < 0.0
    through = a + np.where(crosses, share, 0.0)[..., None] * (b - a)
    pierces = crosses & _is_over(through, corners, following, normal)
    return np.where(pierces, 0.0, distance), np.where(pierces[..., None], through, place)


def _is_over(
    point: FloatArray, corners: FloatArray, following: FloatArray, normal: FloatArray
) -> BoolArray:
    """Tell whether a point, dropped along the normal, falls into the triangle."""
    side = np.cross(following - corners, point[..., None, :] - corners)
    return np.asarray(np.all(_dot(side, normal[..., None, :]) >= 0.0, axis=-1))


def _onto(projection: FloatArray, squared_length: FloatArray) -> FloatArray:
    """Return where on a segment the foot of a point lies, from 0 to 1."""
    with np.errstate(invalid="ignore", divide="ignore"):
        share = projection / squared_length
    return np.clip(np.where(squared_length > 0.0, share, 0.0), 0.0, 1.0)


def _dot(a: FloatArray, b: FloatArray) -> FloatArray:
    return np.asarray(np.einsum("...k,...k->...", a, b))
