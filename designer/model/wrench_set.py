"""Wrenches that a platform has to be held under, each for itself: a list, or all between two."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product
from typing import Annotated

import numpy as np

from designer import checked
from designer.arrays import FloatArray

MOST_WRENCHES = 64
"""The corners of a box in all six parts of a wrench."""


@dataclass(frozen=True, slots=True, eq=False)
class WrenchSet(checked.Value):
    """Wrenches on a platform, of which any one may act.

    Parameters
    ----------
    wrenches_N : array (n, 6)
        As `Platform.wrench_N`, each for itself; of a box its corners [N, N·m].
    is_box : bool
        Whether all wrenches between them may act as well, each part for itself.
    """

    wrenches_N: Annotated[FloatArray, checked.Shape((None, 6))]
    is_box: bool = False

    def __post_init__(self) -> None:
        checked.check_fields(self)
        if not 1 <= len(self.wrenches_N) <= MOST_WRENCHES:
            raise ValueError(f"a set has 1 to {MOST_WRENCHES} wrenches, not {len(self.wrenches_N)}")

    @classmethod
    def between(cls, first_N: FloatArray, last_N: FloatArray) -> WrenchSet:
        """Return the box between two wrenches (6,), by its corners."""
        ends = [sorted({float(a), float(b)}) for a, b in zip(first_N, last_N, strict=True)]
        return cls(np.array(list(product(*ends))), is_box=True)

    @property
    def bounds_N(self) -> FloatArray:
        """Least and greatest of each part (2, 6)."""
        return np.array([self.wrenches_N.min(axis=0), self.wrenches_N.max(axis=0)])

    def scaled(self, factor: float) -> WrenchSet:
        """Return the same, so many times as large."""
        return replace(self, wrenches_N=factor * self.wrenches_N)

    def beside(self, wrench_N: FloatArray, step: float) -> Iterator[FloatArray]:
        """Yield the wrenches of a box by a step, of half its width, from one (6,) of them."""
        if not self.is_box:
            return
        lower, upper = self.bounds_N
        for part in np.flatnonzero(upper > lower):
            for along in (-step, step):
                moved = wrench_N[part] + 0.5 * along * (upper - lower)[part]
                moved = min(max(moved, lower[part]), upper[part])
                if moved != wrench_N[part]:
                    other = wrench_N.copy()
                    other[part] = moved
                    yield other
