"""Poses that the platform shall be able to take: positions of a region, in given orientations.

A place is a row of coordinates: position [m] and, where the platform is to be turned, its rotation
vector [rad]. `designer.model.robot.Poses.at` takes places as well as positions.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import product

import numpy as np
from numpy.typing import ArrayLike

from designer.arrays import FloatArray, finite_array, frozen_array
from designer.model.region import Region

_APART = 1e-7
FILLING = 16
"""Orientations inside a range that are tried beside its middle and its corners."""


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
    """

    turns_rad: FloatArray = field(default_factory=lambda: frozen_array(np.zeros((1, 3))))
    range_rad: FloatArray | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "turns_rad", finite_array("turns_rad", self.turns_rad, None, 3))
        if self.range_rad is not None:
            bounds = finite_array("range_rad", self.range_rad, 2, 3)
            object.__setattr__(self, "range_rad", bounds)
            if (bounds[0] > bounds[1]).any():
                raise ValueError("range_rad must have its lowest components first")

    @classmethod
    def within(cls, low_rad: ArrayLike, high_rad: ArrayLike) -> Orientations:
        """Return a range: its middle, its corners, and `FILLING` orientations spread inside it."""
        from scipy.stats import qmc

        bounds = frozen_array(np.stack([np.asarray(low_rad), np.asarray(high_rad)]))
        low, high = bounds
        free = high > low
        corners = np.array(list(product((0.0, 1.0), repeat=int(free.sum()))))
        inner = qmc.Halton(int(free.sum()), scramble=False).random(FILLING + 1)[1:]
        share = np.zeros((1 + len(corners) + FILLING, 3))
        share[:, free] = np.concatenate([np.full((1, corners.shape[1]), 0.5), corners, inner])
        return cls(frozen_array(low + share * (high - low)), bounds)

    @property
    def count(self) -> int:
        """Number of orientations that every position is tried in."""
        return len(self.turns_rad)

    @property
    def is_level(self) -> bool:
        """Whether the platform is never turned."""
        return self.range_rad is None and not self.turns_rad.any()


def turn_of(place: FloatArray) -> FloatArray:
    """Return the rotation vector of a place (n_coordinates,), zeros where it has none [rad]."""
    return place[3:] if len(place) > 3 else np.zeros(3)


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
    def is_discrete(self) -> bool:
        """Whether there is nothing between the places."""
        return self.region.is_discrete and self.orientations.range_rad is None

    def places(self, positions_m: FloatArray) -> FloatArray:
        """Return positions (n, 3) in all orientations (n · count, n_coordinates), in groups."""
        if self.orientations.is_level:
            return positions_m
        turns = np.tile(self.orientations.turns_rad, (len(positions_m), 1))
        return np.hstack([np.repeat(positions_m, self.orientations.count, axis=0), turns])

    def outside(self, place: FloatArray) -> tuple[bool, bool]:
        """Tell whether position and orientation of a place (6,) are none of this space."""
        position, turn = np.split(place, [3])
        away = np.linalg.norm(self.region.nearest(position[None])[0] - position)
        beyond = bool(away > _APART * (1.0 + np.abs(self.region.bounds_m).max()))
        return beyond, not self._is_asked_for(turn)

    def _is_asked_for(self, turn_rad: FloatArray) -> bool:
        from scipy.spatial.transform import Rotation

        if self.orientations.range_rad is not None:
            low, high = self.orientations.range_rad
            return bool(((turn_rad >= low - _APART) & (turn_rad <= high + _APART)).all())
        asked = Rotation.from_rotvec(np.array(self.orientations.turns_rad))  # read-only: refused
        here = Rotation.from_rotvec(np.array(turn_rad))
        return bool(((asked.inv() * here).magnitude() < _APART).any())

    def nearest(self, places: FloatArray) -> FloatArray:
        """Return the place nearest to each of these (..., n_coordinates)."""
        position = self.region.nearest(places[..., :3])
        turn = places[..., 3:]
        if self.orientations.range_rad is not None:
            turn = np.clip(turn, *self.orientations.range_rad)
        return np.concatenate([position, turn], axis=-1)
