"""The candidates that nothing else beats in every objective at once."""

from __future__ import annotations

import numpy as np

from designer.arrays import BoolArray, FloatArray


def is_undominated(burdens: FloatArray) -> BoolArray:
    """Tell which rows (n,) of burdens (n, n_objectives) no other row dominates.

    A row dominates another one if it is nowhere greater and somewhere less; less is better.
    """
    undominated = np.ones(len(burdens), dtype=np.bool_)
    for index, row in enumerate(burdens):
        undominated[index] = dominator_of(row, burdens) is None
    return undominated


def dominator_of(row: FloatArray, others: FloatArray) -> int | None:
    """Return the row of ``others`` (n, n_objectives) that dominates, None where none does.

    Of several, the one that is best in the first objective.
    """
    dominates = np.all(others <= row, axis=1) & np.any(others < row, axis=1)
    at = np.flatnonzero(dominates)
    return int(at[np.argmin(others[at, 0])]) if len(at) else None
