"""The border of a region: most extremes lie on it, the hardest of them in corners."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from designer.arrays import FloatArray
from designer.model import polygon


@dataclass(frozen=True, slots=True, eq=False)
class Border:
    """The border of a region, piece by piece."""

    vertices_m: FloatArray  # (n_vertices, 3): Corners [m]
    edges_m: FloatArray  # (n_edges, 2, 3): Ends of its edges [m]
    faces_m: list[FloatArray]  # (n_corners, 3): Corners of its faces, convex and in order [m]

    def landmarks_m(self) -> FloatArray:
        """Return vertices, middles of edges and middles of faces (n, 3) [m]."""
        middles = [face.mean(axis=0) for face in self.faces_m]
        return np.concatenate(
            [self.vertices_m, self.edges_m.mean(axis=1), np.array(middles).reshape(-1, 3)]
        )

    def samples_m(self, rng: np.random.Generator, per_edge: int, per_face: int) -> FloatArray:
        """Return random points on each edge, evenly spread, and on each face (n, 3) [m]."""
        step = (np.arange(per_edge) + rng.random((len(self.edges_m), per_edge))) / per_edge
        start, end = self.edges_m[:, :1], self.edges_m[:, 1:]
        on_edges = (start + step[..., None] * (end - start)).reshape(-1, 3)
        on_faces = [polygon.within_m(face, rng.random((per_face, 3))) for face in self.faces_m]
        return np.concatenate([on_edges, *on_faces])


def ring(corners_m: FloatArray) -> FloatArray:
    """Return the edges of a polygon (n_corners, 2, 3), from each corner to the next [m]."""
    return np.stack([corners_m, np.roll(corners_m, -1, axis=0)], axis=1)
