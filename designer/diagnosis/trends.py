"""What a residual does with a covariate: in which reading, at which rows, and what is left."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from designer.arrays import BoolArray, FloatArray, IntArray
from designer.diagnosis.problem import channel_names
from designer.diagnosis.robust import rms, spread, without_outliers

_MOST_ROWS = 6
"""As many as one looks up in a log."""


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


@dataclass(frozen=True, slots=True, eq=False)
class Correction:
    """A smooth empirical correction: no physics, and not used by the design.

    Parameters
    ----------
    covariate : str
        Each channel is corrected by a parabola in it, fitted to the rows for fitting.
    heldout_before, heldout_after : float
        Root mean square over held-out rows, in units of noise.
    """

    covariate: str
    heldout_before: float
    heldout_after: float


def whereabouts(residual: FloatArray, covariate: FloatArray, row_numbers: IntArray) -> Whereabouts:
    """Return where a residual (n_rows, 2 n_cables) goes with a covariate (n_rows,)."""
    clean = without_outliers(residual)
    channel = strongest_channel(clean, covariate)
    trend = np.where(np.isnan(clean[:, channel]), np.nan, _parabola(clean[:, channel], covariate))
    far = np.argsort(-np.nan_to_num(np.abs(trend), nan=-1.0), kind="stable")[:_MOST_ROWS]
    return Whereabouts(
        reading=channel_names(residual.shape[1] // 2)[channel],
        rows=tuple(sorted(int(k) for k in row_numbers[far])),
        size=float(trend[far[0]]),
    )


def smooth_correction(
    residual: FloatArray, name: str, covariate: FloatArray, heldout: BoolArray
) -> Correction:
    """Correct each channel of a residual (n_rows, 2 n_cables) by a parabola in a covariate."""
    filled = np.where(np.isnan(covariate), np.nanmean(covariate), covariate)
    clean = without_outliers(residual)
    corrected = np.full_like(clean, np.nan)
    for channel, column in enumerate(clean.T):
        seen = np.where(heldout, np.nan, column)
        if np.isfinite(seen).sum() > 3:
            corrected[:, channel] = column - _parabola(seen, filled)
    return Correction(name, rms(clean[heldout]), rms(corrected[heldout]))


def strongest_channel(residual: FloatArray, covariate: FloatArray) -> int:
    """Return the reading of whose variance a parabola in the covariate explains most."""
    return int(np.nanargmax([_explained(column, covariate) for column in residual.T]))


def _explained(column: FloatArray, covariate: FloatArray) -> float:
    is_known = np.isfinite(column) & np.isfinite(covariate)
    if is_known.sum() < 4:  # a parabola goes through three of anything
        return -1.0
    # A reading farther off counts as one at this distance: noise reaches it once in 16 000.
    middle, limit = np.nanmedian(column), 4.0 * spread(column)
    clipped = np.where(is_known, np.clip(column, middle - limit, middle + limit), np.nan)
    y = clipped[is_known] - clipped[is_known].mean()
    remainder = clipped[is_known] - _parabola(clipped, covariate)[is_known]
    return float((y @ y - remainder @ remainder) / max(y @ y, 1e-300))


def _parabola(column: FloatArray, covariate: FloatArray) -> FloatArray:
    """Return the parabola in a covariate that comes nearest to a column (n_rows,)."""
    is_known = np.isfinite(column) & np.isfinite(covariate)
    x = covariate[is_known]
    powers = np.vander((covariate - x.mean()) / (x.std() or 1.0), 3)
    return np.asarray(powers @ np.linalg.lstsq(powers[is_known], column[is_known], rcond=None)[0])
