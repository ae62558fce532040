"""The largest of each part of a space: what is kept of a sweep, and where a search starts."""

from __future__ import annotations

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.model.space import Space

CELLS_A_SIDE = 12


class Pool:
    """The places of largest demand of a sweep, one for each small part of the space.

    Memory does not grow with the number of places.
    """

    def __init__(self, space: Space) -> None:
        self._space = space
        self._places, self._values = np.empty((0, space.n_coordinates)), np.empty(0)

    def add(self, places: FloatArray, values: FloatArray) -> None:
        """Take in places (n, n_coordinates) and what they ask for (n,)."""
        places = np.concatenate([self._places, places])
        values = np.concatenate([self._values, values])
        best_of_cells = _best_of_cells(self._space, places, values)
        self._places, self._values = places[best_of_cells], values[best_of_cells]

    @property
    def places(self) -> FloatArray:
        """Return the largest of each part, those left out that do not count (n, n_coordinates)."""
        return self._places[~np.isneginf(self._values)]


def _best_of_cells(space: Space, places: FloatArray, values: FloatArray) -> IntArray:
    """Return the index of the largest value in each part of the space, the largest first."""
    x, y, z, turn = space.cells(places, CELLS_A_SIDE).T
    cell = ((turn * CELLS_A_SIDE + x) * CELLS_A_SIDE + y) * CELLS_A_SIDE + z
    best = np.full(cell.max(initial=0) + 1, -np.inf)
    np.fmax.at(best, cell, values)
    tops = np.flatnonzero(values >= best[cell])  # a few, and those of one cell that are as large
    order = tops[np.argsort(-values[tops], kind="stable")]
    _, first = np.unique(cell[order], return_index=True)
    return np.asarray(order[np.sort(first)])


def local_maxima(space: Space, places: FloatArray, values: FloatArray, number: int) -> IntArray:
    """Return the indices of places that none in the parts around theirs exceed, largest first."""
    from scipy.ndimage import maximum_filter

    best_of_cells = _best_of_cells(space, places, values)
    best_of_cells = best_of_cells[~np.isneginf(values[best_of_cells])]
    x, y, z, turn = cell = space.cells(places[best_of_cells], CELLS_A_SIDE).T
    highest = np.full((*[CELLS_A_SIDE] * 3, int(turn.max(initial=0)) + 1), -np.inf)
    highest[*cell] = values[best_of_cells]
    is_top = maximum_filter(highest, size=(3, 3, 3, 1))[x, y, z, turn] == values[best_of_cells]
    return np.asarray(best_of_cells[is_top][:number])
