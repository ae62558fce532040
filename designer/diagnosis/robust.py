"""Scales of a residual that outliers do not move."""

from __future__ import annotations

import numpy as np

from designer.arrays import BoolArray, FloatArray

MAD_TO_STD = 1.4826
"""Standard deviation of normal noise over the median of its size."""


def spread(values: FloatArray) -> float:
    """Return the standard deviation of the bulk about its median; 0 without values."""
    value = values[~np.isnan(values)]
    if not value.size:
        return 0.0
    return MAD_TO_STD * float(np.median(np.abs(value - np.median(value))))


def rms(residual: FloatArray) -> float:
    """Root mean square of what was measured; NaN if nothing was."""
    finite = residual[~np.isnan(residual)]
    return float(np.sqrt(np.mean(finite**2))) if finite.size else float("nan")


def without_outliers(residual: FloatArray) -> FloatArray:
    """Blank readings that stand off by more than five times the spread of their channel.

    A residual (n_rows, n_channels) in units of noise; a spread below the noise counts as noise.
    """
    apart = np.abs(residual - _median(residual))
    # Normal noise gets there once in two million readings.
    limit = 5.0 * np.maximum(MAD_TO_STD * _median(apart), 1.0)
    return np.where(apart > limit, np.nan, residual)


def is_outlier(residual: FloatArray) -> BoolArray:
    """Tell which readings `without_outliers` blanks (n_rows, n_channels)."""
    return np.isnan(without_outliers(residual)) & ~np.isnan(residual)


def _median(residual: FloatArray) -> FloatArray:
    empty = np.isnan(residual).all(axis=0)
    return np.where(empty, 0.0, np.nanmedian(np.where(empty, 0.0, residual), axis=0))
