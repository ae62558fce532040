"""What a scene is made of, as points, lines and faces: for the picture, the page and the window."""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import NDArray

from designer.arrays import FloatArray
from designer.model.robot import Robot

Faces = NDArray[np.int64]
"""Of each face, or edge, the numbers of its corners (n, 2 to 4)."""


def base_outline_m(robot: Robot) -> FloatArray:
    """Return the exit points on the hull in plan, the first one again at the end (n, 3) [m].

    In the plane of a planar robot; where the points lie on a line, all of them in their order.
    """
    from scipy.spatial import ConvexHull, QhullError

    points = robot.exit_points_m
    flat = (points @ robot.upright.T)[:, [0, 2]] if robot.is_planar else points[:, :2]
    try:
        corners = ConvexHull(flat).vertices
    except QhullError:
        return points
    return np.asarray(points[[*corners, corners[0]]])


def posts_m(tops_m: FloatArray, floor_m: float) -> FloatArray:
    """Return uprights (n, 2, 3) from points (n, 3) down to the floor [m]."""
    return np.stack([tops_m, tops_m * [1.0, 1.0, 0.0] + [0.0, 0.0, floor_m]], axis=1)


def floor_m(bounds_m: FloatArray, below_m: float = 0.0) -> list[FloatArray]:
    """Return a grid of round numbers on the floor of a box (2, 3), or below it, each (2, 3) [m]."""
    low, high = bounds_m
    lines = []
    for axis, across in ((0, 1), (1, 0)):
        for at in [low[axis], *ticks_between(low[axis], high[axis]), high[axis]]:
            line = np.full((2, 3), low[2] - below_m)
            line[:, axis] = at
            line[:, across] = low[across], high[across]
            lines.append(line)
    return lines


def floor_corners(bounds_m: FloatArray) -> FloatArray:
    """Return the four lower corners (4, 3) of a box (2, 3) [m]."""
    return np.array([*product(*bounds_m[:, :2].T, bounds_m[:1, 2])])


def ticks_between(low: float, high: float, most: int = 5) -> FloatArray:
    """Return round numbers from low to high."""
    from matplotlib.ticker import MaxNLocator

    if not high > low:
        return np.array([low])
    ticks = np.asarray(MaxNLocator(nbins=most, steps=[1, 2, 5, 10]).tick_values(low, high))
    slack = 1e-9 * (high - low)
    return ticks[(ticks >= low - slack) & (ticks <= high + slack)]


def hull_faces(points_m: FloatArray) -> Faces:
    """Return the triangles of the hull of points, by their indices (n_faces, 3), seen from outside.

    For points in one plane the triangles of their outline, for points on a line none.
    """
    from scipy.spatial import ConvexHull

    centred = points_m - points_m.mean(axis=0)
    _, extent, axes = np.linalg.svd(centred)
    rank = int(np.sum(extent > 1e-6 * max(float(extent[0]), 1e-12)))
    if rank < 2 or len(points_m) < 3:
        return np.empty((0, 3), dtype=np.int64)
    if rank == 3:
        hull = ConvexHull(points_m)
        first, second, third = points_m[hull.simplices.T]
        normals = np.cross(second - first, third - first)
        faces: Faces = np.array(hull.simplices, dtype=np.int64)
        is_inward = np.einsum("ij,ij->i", normals, hull.equations[:, :3]) < 0.0
        faces[is_inward] = faces[is_inward, ::-1]
        return faces
    outline = ConvexHull(centred @ axes[:2].T).vertices
    fan = [[outline[0], outline[k], outline[k + 1]] for k in range(1, len(outline) - 1)]
    return np.array(fan, dtype=np.int64)


def hull_edges(points_m: FloatArray, faces: Faces) -> Faces:
    """Return the edges (n, 2) between faces (n_faces, 3) that do not lie in one plane."""
    import pyvista

    hull = pyvista.PolyData.from_regular_faces(points_m.astype(np.float64), faces)
    hull.point_data["number"] = np.arange(len(points_m))
    edges = hull.extract_feature_edges(feature_angle=20.0)
    if edges.n_cells == 0:
        return np.empty((0, 2), dtype=np.int64)
    return np.asarray(edges["number"][edges.lines.reshape(-1, 3)[:, 1:]])


def grid_faces(rows: int, columns: int) -> Faces:
    """Return the cells of a grid of points, row after row ((rows - 1) * (columns - 1), 4)."""
    number = np.arange(rows * columns).reshape(rows, columns)
    corners = (number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:])
    return np.stack([corner.ravel() for corner in corners], axis=1)
