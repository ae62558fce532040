"""Places on the border of a space: its vertices, edges and faces, each sampled on its own.

Most extremes lie on the border, the hardest of them in corners, which samples of the inside never
reach.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

from designer.arrays import FloatArray
from designer.model.region import PointList, Prism, Region
from designer.model.space import Orientations, Space

_MOST_POINTS = 256
_AT_AN_END = 1.0 / 3.0
"""Chance that a sample of a range has a component at its lowest value; the same for the highest."""


@dataclass(frozen=True, slots=True, eq=False)
class Strata:
    """The border of a region, piece by piece.

    Parameters
    ----------
    vertices_m : array (n_vertices, 3)
        Corners [m].
    edges_m : array (n_edges, 2, 3)
        Ends of its edges [m].
    faces_m : list of array (n_corners, 3)
        Corners of its faces, convex and in order [m].
    """

    vertices_m: FloatArray
    edges_m: FloatArray
    faces_m: list[FloatArray]

    @classmethod
    def of(cls, region: Region) -> Strata:
        """Return the border of a prism or rectangle; of a list of points, the points."""
        if isinstance(region, PointList):
            return cls(region.points_m[:_MOST_POINTS], np.empty((0, 2, 3)), [])
        if not isinstance(region, Prism):
            corners = region.at(np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]))
            return cls(corners, _ring(corners), [corners])
        low, high = (
            np.column_stack([region.polygon_m, np.full(len(region.polygon_m), z)])
            for z in region.z_m
        )
        upright = np.stack([low, high], axis=1)
        sides = [
            np.array([a, b, d, c])
            for (a, c), (b, d) in zip(upright, np.roll(upright, -1, axis=0), strict=True)
        ]
        edges = np.concatenate([_ring(low), _ring(high), upright])
        return cls(np.concatenate([low, high]), edges, [low, high, *sides])

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
        on_faces = [in_polygon_m(face, rng.random((per_face, 3))) for face in self.faces_m]
        return np.concatenate([on_edges, *on_faces])


def landmarks(space: Space) -> FloatArray:
    """Return the landmarks of a space: those of the region, in each orientation that may matter.

    All of a list of orientations; of a range its middle and its corners. None of a discrete space,
    whose places are all samples.
    """
    if space.is_discrete:
        return np.empty((0, space.n_coordinates))
    positions = Strata.of(space.region).landmarks_m()
    turns = _corner_turns(space.orientations)
    if space.orientations.is_level:
        return positions
    return np.hstack(
        [np.repeat(positions, len(turns), axis=0), np.tile(turns, (len(positions), 1))]
    )


def scattered(
    space: Space, rng: np.random.Generator, per_edge: int, per_face: int, inside: int
) -> FloatArray:
    """Return random places on every edge and face and inside the region, randomly turned.

    Of a list of orientations each position has all, so that none is left to chance; the number of
    positions is smaller accordingly. In a range, a third of the components are at either end.

    Returns
    -------
    array (n, n_coordinates)
        Places [m, rad].
    """
    each = 1 if space.orientations.range_rad is not None else space.orientations.count
    border = Strata.of(space.region).samples_m(
        rng, max(per_edge // each, 8), max(per_face // each, 32)
    )
    positions = np.concatenate([border, _inside_m(space.region, rng, max(inside // each, 64))])
    if space.orientations.range_rad is None:
        return space.places(positions)
    low, high = space.orientations.range_rad
    share = (rng.random((len(positions), 3)) - _AT_AN_END) / (1.0 - 2.0 * _AT_AN_END)
    return np.hstack([positions, low + np.clip(share, 0.0, 1.0) * (high - low)])


def in_polygon_m(corners_m: FloatArray, share: FloatArray) -> FloatArray:
    """Return points of a flat convex polygon (n_corners, 2 or 3), evenly spread over its area [m].

    Parameters
    ----------
    share : array (n, 3)
        Between 0 and 1: which triangle of the fan about the first corner, and where in it.
    """
    first, second, third = corners_m[0], corners_m[1:-1], corners_m[2:]
    u, v = second - first, third - first
    gram = np.einsum("ik,ik->i", u, u) * np.einsum("ik,ik->i", v, v)
    area = np.sqrt(np.maximum(gram - np.einsum("ik,ik->i", u, v) ** 2, 0.0))
    total = np.cumsum(area)
    which = np.minimum(np.searchsorted(total, share[:, 0] * total[-1]), len(area) - 1)
    a, b = share[:, 1], share[:, 2]
    beyond = a + b > 1.0
    a, b = np.where(beyond, 1.0 - a, a), np.where(beyond, 1.0 - b, b)
    return np.asarray(first + a[:, None] * u[which] + b[:, None] * v[which])


def _ring(corners_m: FloatArray) -> FloatArray:
    return np.stack([corners_m, np.roll(corners_m, -1, axis=0)], axis=1)


def _inside_m(region: Region, rng: np.random.Generator, count: int) -> FloatArray:
    if isinstance(region, PointList):
        return region.points_m[rng.integers(len(region.points_m), size=count)]
    if not isinstance(region, Prism):
        return region.at(rng.random((count, 2)))
    plan = in_polygon_m(region.polygon_m, rng.random((count, 3)))
    return np.column_stack([plan, rng.uniform(*region.z_m, count)])


def _corner_turns(orientations: Orientations) -> FloatArray:
    if orientations.range_rad is None:
        return orientations.turns_rad
    low, high = orientations.range_rad
    corners = product(*zip(low, high, strict=True))
    return np.unique([*corners, 0.5 * (low + high)], axis=0)
