"""Distances of polylines from each other and from triangles, piece by piece.

After Ericson, Real-Time Collision Detection (2005), section 5.1. Each piece is a segment, from a
point to the next; pieces whose middles are too far away for what was found are passed over.
"""

from __future__ import annotations

import math
from typing import TypeAlias

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.kernel.compiling import element, kernel

Vector: TypeAlias = tuple[float, float, float]


@element
def _at(points: FloatArray, i: int) -> Vector:
    return points[i, 0], points[i, 1], points[i, 2]


@element
def _less(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@element
def _along(a: Vector, share: float, u: Vector) -> Vector:
    return a[0] + share * u[0], a[1] + share * u[1], a[2] + share * u[2]


@element
def _dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@element
def _cross(a: Vector, b: Vector) -> Vector:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@element
def _onto(projection: float, squared_length: float) -> float:
    share = projection / squared_length if squared_length > 0.0 else 0.0
    return min(max(share, 0.0), 1.0)


@element
def _gap(a: Vector, u: Vector, c: Vector, v: Vector) -> tuple[float, Vector]:
    """Return the squared distance of segments a to a + u and c to c + v, and the middle of it.

    The foot of either on the other's line is kept between its ends, one after the other.
    """
    r = _less(a, c)
    uu, vv, uv = _dot(u, u), _dot(v, v), _dot(u, v)
    ur, vr = _dot(u, r), _dot(v, r)
    determinant = uu * vv - uv * uv
    p = 0.0
    if determinant > 1e-14 * uu * vv:
        p = min(max((uv * vr - vv * ur) / determinant, 0.0), 1.0)
    q = _onto(vr + uv * p, vv)
    p = _onto(uv * q - ur, uu)
    gap = _along(_along(r, p, u), -q, v)
    return _dot(gap, gap), _along(_along(a, p, u), -0.5, gap)


@kernel
def nearest_pieces(
    first: FloatArray, second: FloatArray, distance: FloatArray, middle: FloatArray, at: IntArray
) -> None:
    """Find the nearest pieces of polylines, pair by pair.

    Parameters
    ----------
    first, second : array (n, n_points, 3), (n, m_points, 3)
        Points of the polylines [m].
    distance, middle, at : array (n,), (n, 3), (n, 2)
        Filled with the smallest distance [m], the middle between the nearest points [m], and the
        numbers of the two pieces.
    """
    s, t = first.shape[1] - 1, second.shape[1] - 1
    half = np.empty(t)
    for k in range(first.shape[0]):
        A, B = first[k], second[k]
        for j in range(t):
            v = _less(_at(B, j + 1), _at(B, j))
            half[j] = 0.5 * math.sqrt(_dot(v, v))
        best = np.inf
        for i in range(s):
            a = _at(A, i)
            u = _less(_at(A, i + 1), a)
            reach = math.sqrt(best) + 0.5 * math.sqrt(_dot(u, u))
            for j in range(t):
                c = _at(B, j)
                v = _less(_at(B, j + 1), c)
                away = _along(_along(_less(a, c), 0.5, u), -0.5, v)
                far = reach + half[j]
                if _dot(away, away) > far * far:
                    continue
                squared, place = _gap(a, u, c, v)
                if squared < best:
                    best = squared
                    at[k, 0], at[k, 1] = i, j
                    middle[k, 0], middle[k, 1], middle[k, 2] = place
        distance[k] = math.sqrt(best)


@element
def _is_over(point: Vector, p: Vector, q: Vector, r: Vector, normal: Vector) -> bool:
    """Tell whether a point, dropped along the normal, falls into the triangle."""
    return (
        _dot(_cross(_less(q, p), _less(point, p)), normal) >= 0.0
        and _dot(_cross(_less(r, q), _less(point, q)), normal) >= 0.0
        and _dot(_cross(_less(p, r), _less(point, r)), normal) >= 0.0
    )


@element
def _gap_of_triangle(a: Vector, u: Vector, p: Vector, q: Vector, r: Vector) -> tuple[float, Vector]:
    """Return the squared distance of a segment from a filled triangle, and the nearest place."""
    squared, place = _gap(a, u, p, _less(q, p))
    for start, end in ((q, r), (r, p)):
        of_edge, there = _gap(a, u, start, _less(end, start))
        if of_edge < squared:
            squared, place = of_edge, there
    normal = _cross(_less(q, p), _less(r, p))
    size = _dot(normal, normal)
    b = _along(a, 1.0, u)
    height_a, height_b = _dot(_less(a, p), normal), _dot(_less(b, p), normal)
    for end, height in ((a, height_a), (b, height_b)):
        if height * height < squared * size and _is_over(end, p, q, r, normal):
            squared, place = height * height / size, end
    if height_a * height_b < 0.0:
        through = _along(a, height_a / (height_a - height_b), u)
        if _is_over(through, p, q, r, normal):
            squared, place = 0.0, through
    return squared, place


@kernel
def nearest_faces(
    lines: FloatArray,
    triangles: FloatArray,
    distance: FloatArray,
    nearest: FloatArray,
    at: IntArray,
) -> None:
    """Find the piece of each polyline that is nearest to a surface of triangles.

    Parameters
    ----------
    lines : array (n, n_points, 3)
        Points of the polylines [m].
    triangles : array (n_triangles, 3, 3)
        Corners, along the second axis [m].
    distance, nearest, at : array (n,), (n, 3), (n,)
        Filled with the smallest distance [m], the place on the polyline or the middle between it
        and an edge [m], and the number of the piece.
    """
    count = len(triangles)
    centre, reach = np.empty((count, 3)), np.zeros(count)
    for j in range(count):
        for k in range(3):
            centre[j, k] = (triangles[j, 0, k] + triangles[j, 1, k] + triangles[j, 2, k]) / 3.0
        for k in range(3):
            away = _less(_at(triangles[j], k), _at(centre, j))
            reach[j] = max(reach[j], math.sqrt(_dot(away, away)))
    for k in range(lines.shape[0]):
        best = np.inf
        for i in range(lines.shape[1] - 1):
            a = _at(lines[k], i)
            u = _less(_at(lines[k], i + 1), a)
            half = 0.5 * math.sqrt(_dot(u, u))
            for j in range(count):
                away = _along(_less(a, _at(centre, j)), 0.5, u)
                far = math.sqrt(best) + half + reach[j]
                if _dot(away, away) > far * far:
                    continue
                squared, place = _gap_of_triangle(
                    a, u, _at(triangles[j], 0), _at(triangles[j], 1), _at(triangles[j], 2)
                )
                if squared < best:
                    best = squared
                    at[k] = i
                    nearest[k, 0], nearest[k, 1], nearest[k, 2] = place
        distance[k] = math.sqrt(best)
