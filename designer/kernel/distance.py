"""Distances of polylines, piece by piece; see `designer.interference.segments` for the geometry."""

from __future__ import annotations

import math

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.kernel.compiling import element, kernel


@element
def _onto(projection: float, squared_length: float) -> float:
    share = projection / squared_length if squared_length > 0.0 else 0.0
    return min(max(share, 0.0), 1.0)


@element
def _dot(ax: float, ay: float, az: float, bx: float, by: float, bz: float) -> float:
    return ax * bx + ay * by + az * bz


@kernel
def nearest_pieces(
    first: FloatArray, second: FloatArray, distance: FloatArray, middle: FloatArray, at: IntArray
) -> None:
    """Find the nearest pieces of polylines, pair by pair.

    Each piece is a segment, from a point to the next. The foot of either on the other's line is
    kept between its ends, one after the other, as in Ericson, Real-Time Collision Detection (2005),
    section 5.1.9. A pair of pieces whose middles are too far apart for it is passed over.

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
            x, y, z = B[j + 1, 0] - B[j, 0], B[j + 1, 1] - B[j, 1], B[j + 1, 2] - B[j, 2]
            half[j] = 0.5 * math.sqrt(x * x + y * y + z * z)
        best = np.inf
        for i in range(s):
            ux, uy, uz = A[i + 1, 0] - A[i, 0], A[i + 1, 1] - A[i, 1], A[i + 1, 2] - A[i, 2]
            uu = ux * ux + uy * uy + uz * uz
            reach = 0.5 * math.sqrt(uu)
            for j in range(t):
                vx, vy, vz = B[j + 1, 0] - B[j, 0], B[j + 1, 1] - B[j, 1], B[j + 1, 2] - B[j, 2]
                rx, ry, rz = A[i, 0] - B[j, 0], A[i, 1] - B[j, 1], A[i, 2] - B[j, 2]
                mx, my, mz = rx + 0.5 * (ux - vx), ry + 0.5 * (uy - vy), rz + 0.5 * (uz - vz)
                far = best + reach + half[j]
                if mx * mx + my * my + mz * mz > far * far:
                    continue
                vv = vx * vx + vy * vy + vz * vz
                uv = _dot(ux, uy, uz, vx, vy, vz)
                ur, vr = _dot(ux, uy, uz, rx, ry, rz), _dot(vx, vy, vz, rx, ry, rz)
                determinant = uu * vv - uv * uv
                p = 0.0
                if determinant > 1e-14 * uu * vv:
                    p = min(max((uv * vr - vv * ur) / determinant, 0.0), 1.0)
                q = _onto(vr + uv * p, vv)
                p = _onto(uv * q - ur, uu)
                gx, gy, gz = rx + p * ux - q * vx, ry + p * uy - q * vy, rz + p * uz - q * vz
                gap = math.sqrt(gx * gx + gy * gy + gz * gz)
                if gap < best:
                    best = gap
                    at[k, 0], at[k, 1] = i, j
                    middle[k, 0] = A[i, 0] + p * ux - 0.5 * gx
                    middle[k, 1] = A[i, 1] + p * uy - 0.5 * gy
                    middle[k, 2] = A[i, 2] + p * uz - 0.5 * gz
        distance[k] = best
