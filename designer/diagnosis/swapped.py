"""Are two sensors on each other's plugs?"""

from __future__ import annotations

from itertools import combinations

import numpy as np

from designer.arrays import FloatArray
from designer.diagnosis.problem import channel_names
from designer.diagnosis.structure import Event

_LEFT = 0.1
_OFF = 3.0


def find_swapped(residual: FloatArray, predicted: FloatArray) -> Event | None:
    """Return readings of a kind that fit each other's prediction; None where none do.

    Exchanged, they must leave less than a tenth of the mean square that they leave as they are,
    each about its own mean, since a bias is no exchange.

    Parameters
    ----------
    residual, predicted : array (n_rows, 2 n_cables)
        In units of noise; NaN where not measured.
    """
    n = residual.shape[1] // 2
    names = channel_names(n)
    pairs = [(i + k, j + k) for i, j in combinations(range(n), 2) for k in (0, n)]
    texts: list[str] = []
    most = 0.0
    for one, other in pairs:
        gap = predicted[:, other] - predicted[:, one]
        as_it_is = _size(residual[:, one]) + _size(residual[:, other])
        exchanged = _size(residual[:, other] + gap) + _size(residual[:, one] - gap)
        if as_it_is > 2.0 * _OFF**2 and exchanged < _LEFT * as_it_is:
            texts.append(f"{names[one]} and {names[other]} exchanged with each other")
            most = max(most, 1.0 - exchanged / as_it_is)
    return Event(", ".join(texts), most, 0.0) if texts else None


def _size(column: FloatArray) -> float:
    """Return the robust mean square about the median; 0 without readings."""
    known = column[~np.isnan(column)]
    if not known.size:
        return 0.0
    return float((1.4826 * np.median(np.abs(known - np.median(known)))) ** 2)
