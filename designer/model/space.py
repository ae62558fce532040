"""Poses that the platform shall be able to take: positions of a region, in given orientations.

Orientations are a list, a range, or a law by which they follow the position. A place is a row of
coordinates: position [m] and, where the platform is to be turned, its rotation vector [rad].
`designer.model.robot.Poses.at` takes places as well as positions.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from functools import cached_property
from itertools import product
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial import cKDTree

from designer import checked
from designer.arrays import BoolArray, FloatArray, IntArray, finite_array, frozen_array
from designer.model.region import Region
from designer.model.sobol import halton
from designer.spelling import vector

_STRAIGHT = 1e-9
"""Sine of the angle to a point straight behind, from which on that counts as straight."""
_APART = 1e-7
_AT_AN_END = 1.0 / 3.0
"""Chance that a sample of a range has a component at its lowest value; the same for the highest."""
FILLING = 16
"""Orientations inside a range that are tried beside its middle and its corners."""


class OrientationLaw(checked.Value, ABC):
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
class Toward(OrientationLaw):
    """An axis of the platform points at a point, by the shortest turn from its drawing.

    The rotation vector is along :math:`a \\times d`, of the angle between the axis a and the
    direction d from the position to the point. Where the point is straight behind, it is half a
    turn about any axis across; nothing is turned where the position is the point itself.
    """

    point_m: checked.Vector  #: (3,): What it points at, world frame [m]
    #: (3,): Body frame; its length does not count
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
        if is_behind.any():
            normal = np.cross(axis, np.eye(3)[np.abs(axis).argmin()])
            turn[is_behind] = np.pi * (normal / np.linalg.norm(normal))
        return np.asarray(turn[:, None])

    @property
    def words(self) -> str:
        point, axis = vector(self.point_m, 6), vector(self.axis)
        return f"the platform's axis {axis} toward {point} m"


@dataclass(frozen=True, eq=False)
class OrientationTable(OrientationLaw):
    """Rotation vectors at some positions, interpolated between them.

    By :math:`\\sum_i w_i\\,|x - x_i|` and a constant, the sum that passes through all rows and, on
    a line, is linear from row to row; each component stays between its least and largest value.
    """

    positions_m: checked.Points  #: (n_rows, 3): Where [m]
    rotation_vectors_rad: checked.Points  #: (n_rows, 3): Turned how [rad]
    name: str = field(default="a table", compare=False)  #: What the reader knows it by

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
class ListedOrientations(OrientationLaw):
    """The orientations of listed poses, each at its own position."""

    positions_m: checked.Points  #: (n_positions, 3): Positions, no two alike [m]
    #: (n_positions, count, 3): Those asked for at each, repeated where a position has fewer than
    #: another [rad]
    rotation_vectors_rad: FloatArray

    @classmethod
    def of(cls, positions_m: ArrayLike, rotation_vectors_rad: ArrayLike) -> ListedOrientations:
        """Return it of poses in any order: positions and rotation vectors (n_poses, 3)."""
        turns = np.asarray(rotation_vectors_rad, dtype=np.float64)
        positions, owner = np.unique(positions_m, axis=0, return_inverse=True)
        order = np.argsort(owner, kind="stable")
        start = np.searchsorted(owner[order], np.arange(len(positions) + 1))
        count = int(np.diff(start).max())
        rows = np.minimum(start[:-1, None] + np.arange(count), start[1:, None] - 1)
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


def _distance_m(points_m: FloatArray, rows_m: FloatArray) -> FloatArray:
    """Return the distances (n_points, n_rows) [m]."""
    from scipy.spatial.distance import cdist

    return np.asarray(cdist(points_m, rows_m))


@checked.reports_field
@dataclass(frozen=True, slots=True, eq=False)
class Orientations:
    """How the platform shall be turned; a position is served when it is in every one of them.

    Parameters
    ----------
    turns_rad : array (n_orientations, 3)
        Rotation vectors that every position is tried in [rad].
    range_rad : array (2, 3) or None
        Lowest and highest components of the rotation vector, where everything between them is
        asked for [rad]; ``turns_rad`` are then samples of it.
    law : OrientationLaw or None
        Orientations that depend on the position, instead of all these.
    """

    turns_rad: checked.Points = field(default_factory=lambda: frozen_array(np.zeros((1, 3))))
    range_rad: Annotated[FloatArray, checked.Shape((2, 3))] | None = None
    law: OrientationLaw | None = None

    def __post_init__(self) -> None:
        checked.check_fields(self)
        if self.range_rad is not None and (self.range_rad[0] > self.range_rad[1]).any():
            raise ValueError("range_rad must have its lowest components first")

    @classmethod
    def within(cls, low_rad: ArrayLike, high_rad: ArrayLike) -> Orientations:
        """Return a range: its middle, its corners, and `FILLING` orientations spread inside it."""
        low, high = finite_array("low_rad", low_rad, 3), finite_array("high_rad", high_rad, 3)
        free = high > low
        if (high < low).any() or not free.any():
            raise ValueError("high_rad must not be below low_rad, and be above it somewhere")
        bounds = frozen_array([low, high])
        corners = np.array(list(product((0.0, 1.0), repeat=int(free.sum()))))
        inner = halton(int(free.sum()), FILLING)
        share = np.zeros((1 + len(corners) + FILLING, 3))
        share[:, free] = np.concatenate([np.full((1, corners.shape[1]), 0.5), corners, inner])
        return cls(frozen_array(low + share * (high - low)), bounds)

    @property
    def count(self) -> int:
        """Number of orientations that every position is tried in."""
        return len(self.turns_rad) if self.law is None else self.law.count

    @property
    def is_level(self) -> bool:
        """Whether the platform is never turned."""
        return self.law is None and self.range_rad is None and not self.turns_rad.any()

    def at(self, positions_m: FloatArray) -> FloatArray:
        """Return the rotation vectors that positions (n, 3) are tried in, (n, count, 3) [rad]."""
        if self.law is None:
            return np.broadcast_to(self.turns_rad, (len(positions_m), *self.turns_rad.shape))
        return self.law.turns_rad(positions_m)


def rotation_vector_of(place: FloatArray) -> FloatArray:
    """Return the rotation vector of a place (n_coordinates,), zeros where it has none [rad]."""
    return place[3:] if len(place) > 3 else np.zeros(3)


def named_orientation(place: FloatArray, name: str = "rotation_vector") -> dict[str, FloatArray]:
    """Return the orientation of a place as files of results name it; none if it is not turned."""
    turn = rotation_vector_of(place)
    return {name: turn} if turn.any() else {}


def named_pose(place: FloatArray) -> dict[str, FloatArray]:
    """Return a place as files of results name it, with its orientation where it is turned."""
    return {**named_position(place), **named_orientation(place)}


def named_position(place: FloatArray) -> dict[str, FloatArray]:
    """Return a place (n_coordinates,) as files of results name its position."""
    return {"pose": place[:3]}


def named_place(place: FloatArray | None) -> dict[str, FloatArray | None]:
    """Return a place (n_coordinates,) as files of results name it, with its orientation."""
    turn = None if place is None else rotation_vector_of(place)
    return {"pose": None if place is None else place[:3], "rotation_vector": turn}


@dataclass(frozen=True, slots=True, eq=False)
class Space:
    """All places: positions of a region in every orientation."""

    region: Region
    orientations: Orientations

    @property
    def n_coordinates(self) -> int:
        """3 if the platform is never turned, otherwise 6."""
        return 3 if self.orientations.is_level else 6

    @property
    def bounds(self) -> FloatArray:
        """Smallest and largest coordinates (2, n_coordinates) [m, rad].

        The two are equal in coordinates that a search cannot move.
        """
        if self.orientations.is_level:
            return self.region.bounds_m
        turns = self.orientations.range_rad
        return np.hstack([self.region.bounds_m, np.zeros((2, 3)) if turns is None else turns])

    @property
    def is_free(self) -> BoolArray:
        """Which coordinates (n_coordinates,) are no function of the others."""
        is_turn = np.arange(self.n_coordinates) >= 3
        return np.asarray(~is_turn | (self.orientations.law is None))

    @property
    def is_discrete(self) -> bool:
        """Whether there is nothing between the places."""
        return self.region.is_discrete and self.orientations.range_rad is None

    def places(self, positions_m: FloatArray) -> FloatArray:
        """Return positions (n, 3) in all orientations (n · count, n_coordinates), in groups."""
        if self.orientations.is_level:
            return positions_m
        turns = self.orientations.at(positions_m).reshape(-1, 3)
        return np.hstack([np.repeat(positions_m, self.orientations.count, axis=0), turns])

    def first(self, positions_m: FloatArray) -> FloatArray:
        """Return positions (..., 3), each in the first of its orientations (..., 6) [m, rad]."""
        turns = self.orientations.at(positions_m.reshape(-1, 3))[:, 0]
        return np.concatenate([positions_m, turns.reshape(positions_m.shape)], axis=-1)

    def landmarks(self) -> FloatArray:
        """Return the landmarks of the region, in each orientation that may matter.

        All of a list of orientations; of a range its middle and its corners. None of a discrete
        space, whose places are all samples.
        """
        if self.is_discrete:
            return np.empty((0, self.n_coordinates))
        positions = self.region.border().landmarks_m()
        if self.orientations.range_rad is None:
            return self.places(positions)
        low, high = self.orientations.range_rad
        corners = product(*zip(low, high, strict=True))
        turns = np.unique([*corners, 0.5 * (low + high)], axis=0)
        repeated = np.repeat(positions, len(turns), axis=0)
        return np.hstack([repeated, np.tile(turns, (len(positions), 1))])

    def scattered(
        self, rng: np.random.Generator, per_edge: int, per_face: int, inside: int
    ) -> FloatArray:
        """Return random places (n, n_coordinates) on every edge and face and inside [m, rad].

        Of a list of orientations each position has all, so that none is left to chance; the number
        of positions is smaller accordingly. In a range, a third of the components are at either
        end.
        """
        bounds = self.orientations.range_rad
        count = 1 if bounds is not None else self.orientations.count
        on_border = max(per_edge // count, 8), max(per_face // count, 32)
        border = self.region.border().samples_m(rng, *on_border)
        within = self.region.inside_m(rng, max(inside // count, 64))
        positions = np.concatenate([border, within])
        if bounds is None:
            return self.places(positions)
        share = (rng.random((len(positions), 3)) - _AT_AN_END) / (1.0 - 2.0 * _AT_AN_END)
        turns = bounds[0] + np.clip(share, 0.0, 1.0) * (bounds[1] - bounds[0])
        return np.hstack([positions, turns])

    def cells(self, places: FloatArray, side: int) -> IntArray:
        """Number the part of the space that each place lies in, by coordinates (n, 4).

        ``side`` steps along each edge of the region's box, and one for the orientation: of a list
        its number, of a range the half that each component lies in.
        """
        low, high = self.region.bounds_m
        size = np.where(high > low, high - low, 1.0)
        step = np.clip((places[:, :3] - low) / size * side, 0, side - 1)
        turn = np.zeros(len(places))
        if places.shape[1] > 3 and self.orientations.law is None:
            bounds = self.orientations.range_rad
            if bounds is not None:
                turn = (places[:, 3:] > bounds.mean(axis=0)) @ [1.0, 2.0, 4.0]
            else:
                away = places[:, None, 3:] - self.orientations.turns_rad
                turn = np.abs(away).sum(axis=2).argmin(axis=1)
        return np.column_stack([step, turn]).astype(np.int64)

    def outside(self, place: FloatArray) -> tuple[bool, bool]:
        """Tell whether position and orientation of a place (6,) are none of this space."""
        from scipy.spatial.transform import Rotation

        position, turn = np.split(place, [3])
        away = np.linalg.norm(self.region.nearest(position[None])[0] - position)
        beyond = bool(away > _APART * (1.0 + np.abs(self.region.bounds_m).max()))
        if self.orientations.range_rad is not None:
            low, high = self.orientations.range_rad
            return beyond, not ((turn >= low - _APART) & (turn <= high + _APART)).all()
        turns = self.orientations.at(position[None])[0]
        rotations = Rotation.from_rotvec(np.array(turns))  # read-only: refused
        gap = (rotations.inv() * Rotation.from_rotvec(np.array(turn))).magnitude()
        return beyond, not (gap < _APART).any()

    def nearest(self, places: FloatArray) -> FloatArray:
        """Return the place nearest to each of these (..., n_coordinates)."""
        position = self.region.nearest(places[..., :3])
        turn = places[..., 3:]
        if self.orientations.range_rad is not None:
            turn = np.clip(turn, *self.orientations.range_rad)
        return self.following(np.concatenate([position, turn], axis=-1))

    def following(self, places: FloatArray) -> FloatArray:
        """Return places (..., n_coordinates) turned as a law has it there, by the least change."""
        if self.orientations.law is None:
            return places
        flat = places.reshape(-1, 6)
        turns = self.orientations.at(flat[:, :3])
        nearest = np.abs(turns - flat[:, None, 3:]).sum(axis=2).argmin(axis=1)
        followed = np.hstack([flat[:, :3], turns[np.arange(len(flat)), nearest]])
        return followed.reshape(places.shape)
