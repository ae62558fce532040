"""The platform's convex hull as triangles in the body frame."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from designer.arrays import FloatArray
from designer.model.robot import Robot

_FLAT = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class Hull:
    """A convex body, or a flat one without a volume."""

    triangles_m: FloatArray  # (n_triangles, 3, 3): Its surface, body frame [m]
    # (n_faces, 4): Outward unit normals and offsets: `normal · x + offset ≤ 0` for all of them in
    # the body, and for no other point [-, m]
    halfspaces: FloatArray

    @property
    def extent_m(self) -> float:
        """Largest distance of two of its corners [m]."""
        corners = self.triangles_m.reshape(-1, 3)
        return float(np.linalg.norm(corners[:, None] - corners, axis=-1).max())

    def heights_m(self, points_m: FloatArray) -> FloatArray:
        """Return how far points (..., 3) lie beyond each face (..., n_faces) [m]."""
        return np.asarray(points_m @ self.halfspaces[:, :3].T + self.halfspaces[:, 3])

    def depth_m(self, points_m: FloatArray) -> FloatArray:
        """Return how far below the surface points (..., 3) lie; zero outside [m]."""
        return np.asarray(np.maximum(-self.heights_m(points_m).max(axis=-1), 0.0))


def platform_hull(robot: Robot) -> Hull | None:
    """Return the hull that the study gives, or that of the attachments; None for a point mass.

    None as well where all attachments lie on one line.
    """
    if robot.is_point_mass:
        return None
    hull_m = robot.platform.hull_m
    corners = robot.attachments_m if hull_m is None else hull_m
    middle = corners.mean(axis=0)
    _, spread, axes = np.linalg.svd(corners - middle)
    if spread[1] <= _FLAT * spread[0]:
        return None
    from scipy.spatial import ConvexHull

    if spread[2] > _FLAT * spread[0]:
        hull = ConvexHull(corners)
        return Hull(corners[hull.simplices], hull.equations)
    # A convex polygon, as a fan of triangles, between two faces and within its edges.
    outline = ConvexHull((corners - middle) @ axes[:2].T)
    ring = corners[outline.vertices]
    fan = [np.stack([ring[0], b, c]) for b, c in pairwise(ring[1:])]
    edges = outline.equations[:, :2] @ axes[:2]
    normals = np.concatenate([axes[2:], -axes[2:], edges])
    within = np.concatenate([[0.0, 0.0], outline.equations[:, 2]])
    return Hull(np.array(fan), np.column_stack([normals, within - normals @ middle]))
