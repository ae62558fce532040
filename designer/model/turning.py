"""Orientations that follow the position: the platform is turned as the place that it is in asks."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial import cKDTree

from designer import checked
from designer.arrays import FloatArray, IntArray, frozen_array
from designer.spelling import vector

_STRAIGHT = 1e-9
"""Sine of the angle to a point straight behind, from which on that counts as straight."""


class Following(checked.Value, ABC):
    """A law from the position to the orientations in which the platform is asked for there."""

    __slots__ = ()

    @property
    def count(self) -> int:
        """Number of orientations at each position."""
        return 1

    @abstractmethod
    def turns_rad(self, positions_m: FloatArray) -> FloatArray:
        """Return the rotation vectors at positions (n, 3) [m], (n, count, 3) [rad]."""

    @property
    def rows(self) -> tuple[FloatArray, FloatArray] | None:
        """Positions and rotation vectors (n, 3) of the table that is the law, if so [m, rad]."""
        return None

    @property
    @abstractmethod
    def words(self) -> str:
        """How the platform is turned."""


@dataclass(frozen=True, slots=True, eq=False)
class Toward(Following):
    """An axis of the platform points at a point, by the shortest turn from its drawing.

    The rotation vector is along :math:`a \\times d`, of the angle between the axis a and the
    direction d from the position to the point. Where the point is straight behind, it is half a
    turn about any axis across; nothing is turned where the position is the point itself.

    Parameters
    ----------
    point_m : array (3,)
        What it points at, world frame [m].
    axis : array (3,)
        Body frame; its length does not count.
    """

    point_m: checked.Vector
    axis: checked.Vector = field(default_factory=lambda: frozen_array([0.0, 0.0, 1.0]))

    def __post_init__(self) -> None:
        checked.check_fields(self)
        if not self.axis.any():
            raise ValueError("the axis has no direction")

    def turns_rad(self, positions_m: FloatArray) -> FloatArray:
        axis, along = self.axis / np.linalg.norm(self.axis), self.point_m - positions_m
        across = np.cross(axis, along)
        size = np.linalg.norm(across, axis=1)
        angle = np.arctan2(size, along @ axis)
        turn = across * np.divide(angle, size, out=np.zeros_like(size), where=size > 0.0)[:, None]
        is_behind = (along @ axis < 0.0) & (size <= _STRAIGHT * np.linalg.norm(along, axis=1))
        turn[is_behind] = np.pi * _across(axis)
        return np.asarray(turn[:, None])

    @property
    def words(self) -> str:
        point, axis = vector(self.point_m, 6), vector(self.axis)
        return f"the platform's axis {axis} toward {point} m"


@dataclass(frozen=True, eq=False)
class TurnTable(Following):
    """Rotation vectors at some positions, interpolated between them.

    By :math:`\\sum_i w_i\\,|x - x_i|` and a constant, the sum that passes through all rows and, on
    a line, is linear from row to row; each component stays between its least and largest value.

    Parameters
    ----------
    positions_m : array (n_rows, 3)
        Where [m].
    rotation_vectors_rad : array (n_rows, 3)
        Turned how [rad].
    name : str
        What the reader knows it by.
    """

    positions_m: checked.Points
    rotation_vectors_rad: checked.Points
    name: str = field(default="a table", compare=False)

    def __post_init__(self) -> None:
        checked.check_fields(self)
        if self.positions_m.shape != self.rotation_vectors_rad.shape:
            raise ValueError("each position needs one rotation vector")
        if len(np.unique(self.positions_m, axis=0)) < len(self.positions_m):
            raise ValueError("two rows have one position")

    @cached_property
    def _weights(self) -> FloatArray:
        n = len(self.positions_m)
        matrix = np.ones((n + 1, n + 1))
        matrix[:n, :n] = _distance_m(self.positions_m, self.positions_m)
        matrix[n, n] = 0.0
        values = np.vstack([self.rotation_vectors_rad, np.zeros((1, 3))])
        return np.asarray(np.linalg.solve(matrix, values), dtype=np.float64)

    def turns_rad(self, positions_m: FloatArray) -> FloatArray:
        weights, rows = self._weights, self.rotation_vectors_rad
        turn = _distance_m(positions_m, self.positions_m) @ weights[:-1] + weights[-1]
        return np.asarray(np.clip(turn, rows.min(axis=0), rows.max(axis=0))[:, None])

    @property
    def rows(self) -> tuple[FloatArray, FloatArray]:
        return self.positions_m, self.rotation_vectors_rad

    @property
    def words(self) -> str:
        return f"as {self.name} has it at {len(self.positions_m)} positions"


@dataclass(frozen=True, eq=False)
class EachPose(Following):
    """The orientations of listed poses, each at its own position.

    Parameters
    ----------
    positions_m : array (n_positions, 3)
        Positions, no two alike [m].
    rotation_vectors_rad : array (n_positions, count, 3)
        Those asked for at each, repeated where a position has fewer than another [rad].
    """

    positions_m: checked.Points
    rotation_vectors_rad: FloatArray

    @classmethod
    def of(cls, positions_m: ArrayLike, rotation_vectors_rad: ArrayLike) -> EachPose:
        """Return it of poses in any order: positions and rotation vectors (n_poses, 3)."""
        turns = np.asarray(rotation_vectors_rad, dtype=np.float64)
        positions, owner = np.unique(positions_m, axis=0, return_inverse=True)
        order = np.argsort(owner, kind="stable")
        first = np.searchsorted(owner[order], np.arange(len(positions) + 1))
        count = int(np.diff(first).max())
        rows = np.minimum(first[:-1, None] + np.arange(count), first[1:, None] - 1)
        return cls(frozen_array(positions), frozen_array(turns[order][rows]))

    @property
    def count(self) -> int:
        return int(self.rotation_vectors_rad.shape[1])

    @cached_property
    def _tree(self) -> cKDTree:
        return cKDTree(self.positions_m)

    def turns_rad(self, positions_m: FloatArray) -> FloatArray:
        nearest: IntArray = self._tree.query(positions_m)[1]
        return np.asarray(self.rotation_vectors_rad[nearest])

    @property
    def words(self) -> str:
        return "as each pose of the list has it"


def _across(axis: FloatArray) -> FloatArray:
    """Return a unit vector across a unit vector (3,)."""
    across = np.cross(axis, np.eye(3)[np.abs(axis).argmin()])
    return np.asarray(across / np.linalg.norm(across))


def _distance_m(points_m: FloatArray, rows_m: FloatArray) -> FloatArray:
    """Return the distances (n_points, n_rows) [m]."""
    from scipy.spatial.distance import cdist

    return np.asarray(cdist(points_m, rows_m))
