"""Climbs toward the worst poses: where each stands, and how it got there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np

from designer.arrays import FloatArray, IntArray


@dataclass(slots=True, eq=False)
class Climbs:
    """Climbs of all searches, those of one search beside each other.

    Parameters
    ----------
    search, extreme : array (n_climbs,)
        Which search, and which of its demands.
    at : array (n_climbs, n_coordinates)
        Where it is [m, rad].
    value, radius : array (n_climbs,)
        The demand there, and the size of the next cloud, as a share of the space.
    step : array (n_climbs, n_coordinates)
        The last step [m, rad].
    """

    search: IntArray
    extreme: IntArray
    at: FloatArray
    value: FloatArray
    radius: FloatArray
    step: FloatArray

    def __len__(self) -> int:
        return len(self.search)

    @property
    def kind(self) -> IntArray:
        """Number of its search and extreme together (n_climbs,)."""
        return np.asarray(self.search * (self.extreme.max(initial=0) + 1) + self.extreme)

    def part(self, rows: IntArray) -> Climbs:
        """Return some of them."""
        return Climbs(*(getattr(self, field.name)[rows] for field in fields(self)))

    @classmethod
    def beginning(
        cls, search: IntArray, extreme: IntArray, at: FloatArray, value: FloatArray, radius: float
    ) -> Climbs:
        """Return climbs that have not moved yet."""
        return cls(search, extreme, at, value, np.full(len(at), radius), np.zeros_like(at))

    @classmethod
    def joined(cls, parts: Sequence[Climbs]) -> Climbs:
        """Return the climbs of several parts as one."""
        names = (field.name for field in fields(cls))
        climbs = cls(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))
        return climbs.part(np.argsort(climbs.search, kind="stable"))
