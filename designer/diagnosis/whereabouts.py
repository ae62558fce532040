"""In which reading, and at which rows, a residual goes with a covariate."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.diagnosis.errors_of import without_outliers
from designer.diagnosis.problem import channel_names

_CLIP = 4.0
_MOST_ROWS = 6


@dataclass(frozen=True, slots=True)
class Whereabouts:
    """Where a residual goes with a covariate.

    Parameters
    ----------
    reading : str
        The one of whose variance a parabola in the covariate explains most.
    rows : tuple of int
        Numbers of the rows at which that parabola is farthest off, as in the file, rising.
    size : float
        How far it is off there at most, in units of noise, with its sign.
    """

    reading: str
    rows: tuple[int, ...]
    size: float


def whereabouts(residual: FloatArray, covariate: FloatArray, row_numbers: IntArray) -> Whereabouts:
    """Return where a residual (n_rows, 2 n_cables) goes with a covariate (n_rows,)."""
    clean = without_outliers(residual)
    channel = strongest_channel(clean, covariate)
    trend = _parabola(clean[:, channel], covariate)
    far = np.argsort(-np.nan_to_num(np.abs(trend), nan=-1.0), kind="stable")[:_MOST_ROWS]
    return Whereabouts(
        reading=channel_names(residual.shape[1] // 2)[channel],
        rows=tuple(sorted(int(k) for k in row_numbers[far])),
        size=float(trend[far[0]]),
    )


def strongest_channel(residual: FloatArray, covariate: FloatArray) -> int:
    """Return the reading of whose variance a parabola in the covariate explains most."""
    return int(np.nanargmax([_explained(column, covariate) for column in residual.T]))


def in_runs(rows: Sequence[int]) -> list[str]:
    """Return row numbers with neighbours drawn together: ``12``, ``45 to 48``."""
    parts = np.split(np.array(rows), np.flatnonzero(np.diff(rows) > 1) + 1)
    return [str(p[0]) if len(p) == 1 else f"{p[0]} to {p[-1]}" for p in parts]


def _explained(column: FloatArray, covariate: FloatArray) -> float:
    known = np.isfinite(column) & np.isfinite(covariate)
    if known.sum() < 4:
        return -1.0
    clipped = np.where(known, _clipped(column), np.nan)
    y = clipped[known] - clipped[known].mean()
    left = clipped[known] - _parabola(clipped, covariate)[known]
    return float((y @ y - left @ left) / max(y @ y, 1e-300))


def _clipped(column: FloatArray) -> FloatArray:
    middle = np.nanmedian(column)
    spread = 1.4826 * np.nanmedian(np.abs(column - middle))
    return np.clip(column, middle - _CLIP * spread, middle + _CLIP * spread)


def _parabola(column: FloatArray, covariate: FloatArray) -> FloatArray:
    """Return the parabola in a covariate that comes nearest to a column; NaN where neither is."""
    known = np.isfinite(column) & np.isfinite(covariate)
    x = covariate[known]
    powers = np.vander((x - x.mean()) / (x.std() + 1e-300), 3)
    fitted = np.full(len(column), np.nan)
    fitted[known] = powers @ np.linalg.lstsq(powers, column[known], rcond=None)[0]
    return fitted
