r"""Statistics of residuals: scales that outliers do not move, blocks of rows, correlated rows.

Blocks are contiguous: what is held out is not next to what is fitted.

Channels of one row share the error of its pose; rows that follow one another share what drifts. A
fit that takes all readings for independent states deviations that are too small, and takes chance
for a gain. With slopes J and residual r, the covariance of the parameters is the sandwich
A⁻¹ V A⁻¹, A = JᵀJ, V the covariance of Jᵀr, for which there are three estimates:

- by rows and by blocks, Σ s sᵀ over their sums s of Jᵀr (Liang and Zeger, Biometrika 73, 1986);
- with noise that is correlated between channels and lasts over rows, the latter as c φᵏ over k
  rows, both taken from the residual.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from designer.arrays import BoolArray, FloatArray, IntArray

SIGNIFICANCE = 0.001
"""Chance of a false finding in a whole round of candidates, or of structure where there is none.

One log in a thousand is explained wrongly."""
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


def outside_span(basis: FloatArray, columns: FloatArray) -> FloatArray:
    """Return what columns hold beside the span of an orthonormal basis."""
    return np.asarray(columns - basis @ (basis.T @ columns))


def orthonormal(columns: FloatArray) -> FloatArray:
    """Return an orthonormal basis of the columns, those that are nearly dependent left out."""
    if columns.shape[1] == 0:
        return columns
    scale = np.linalg.norm(columns, axis=0)
    scale[scale == 0.0] = 1.0
    u, s, _ = np.linalg.svd(columns / scale, full_matrices=False)
    return np.asarray(u[:, s > 1e-6 * s[0]])


_HELD_OUT_EVERY = 4
"""A quarter of the rows: three blocks at least, and the fit keeps most."""


def block_of(n_rows: int, n_blocks: int | None = None) -> IntArray:
    """Return the number of the block of each row (n_rows,), blocks of nearly equal length.

    Twelve, or twice as many where each still has ten rows: what is held out is then spread more
    widely, and how clear a gain is shows better.
    """
    # Few blocks are long against what neighbours share; many show how much a gain scatters.
    blocks = n_blocks or (12 if n_rows < 240 else 24)
    return (np.arange(n_rows) * min(blocks, n_rows)) // n_rows


def heldout_rows(n_rows: int, session: IntArray | None = None) -> BoolArray:
    """Return which rows no fit may see: every fourth block, of each session (n_rows,) by itself."""
    if session is not None:
        counts = np.unique(session, return_counts=True)[1].tolist()
        return np.concatenate([heldout_rows(count) for count in counts])
    return np.asarray(block_of(n_rows) % _HELD_OUT_EVERY == _HELD_OUT_EVERY - 1)


def folds(fit_rows: BoolArray) -> list[BoolArray]:
    """Split the rows for fitting into contiguous parts for cross-validation.

    Returns
    -------
    list of array (n_rows,)
        The rows of each part; together they are ``fit_rows``.
    """
    indices = np.flatnonzero(fit_rows)
    # With five parts each fit has four fifths of the rows, at five times the work.
    part = block_of(len(indices), 5)
    answer = []
    for k in range(int(part.max()) + 1):
        rows = np.zeros_like(fit_rows)
        rows[indices[part == k]] = True
        answer.append(rows)
    return answer


_LONGEST = 0.98
"""Largest decay: what lasts over more than fifty rows is a drift, and tested as such."""


@dataclass(frozen=True, slots=True)
class Lasting:
    """Correlation of a residual between rows that follow one another: ``share · decay**k``."""

    share: float  #: share of the variance that lasts; 0 where rows are independent
    decay: float  #: what of it is left one row later

    @property
    def rows(self) -> float:
        """How many rows tell as much as one independent row would, of a mean over all."""
        return 1.0 + 2.0 * self.share * self.decay / (1.0 - self.decay)

    def correlated(self, columns: FloatArray) -> FloatArray:
        """Return the product of the correlation between rows with columns (n_rows, n_columns).

        By one pass from either end, Σₖ φᵏ over the rows on that side: the matrix itself would have
        the square of the rows.
        """
        from scipy.signal import lfilter

        earlier, later = (
            lfilter([1.0], [1.0, -self.decay], columns[::step], axis=0)[::step] for step in (1, -1)
        )
        lasting_part = earlier + later - columns  # each row is in both passes
        return np.asarray(columns + self.share * (lasting_part - columns))

    def draw(self, rng: np.random.Generator, shape: tuple[int, int]) -> FloatArray:
        """Return normal noise (n_rows, n_columns) of unit variance with this correlation."""
        from scipy.signal import lfilter

        passing, lasting_part = rng.normal(size=(2, *shape))
        lasting_part[1:] *= np.sqrt(1.0 - self.decay**2)  # the first row has all of its variance
        lasting_part = lfilter([1.0], [1.0, -self.decay], lasting_part, axis=0)
        return np.asarray(np.sqrt(1.0 - self.share) * passing + np.sqrt(self.share) * lasting_part)


INDEPENDENT = Lasting(0.0, 0.0)
"""Rows that have nothing in common."""


def lasting(residual: FloatArray) -> Lasting:
    """Return how the residual (n_rows, n_channels) lasts, over all its channels; gaps are NaN."""
    is_read = ~np.isnan(residual)
    mean = np.nan_to_num(residual).sum(axis=0) / np.maximum(is_read.sum(axis=0), 1)
    centred = np.where(is_read, residual - mean, 0.0)
    lags = range(1, min(8, len(residual) - 2) + 1)
    square = float(np.sum(centred**2)) / max(int(is_read.sum()), 1)
    if square == 0.0 or len(lags) < 2:
        return INDEPENDENT
    pairs = np.array([np.sum(is_read[k:] & is_read[:-k]) for k in lags])
    sums = np.array([np.sum(centred[k:] * centred[:-k]) for k in lags])
    correlations = sums / np.maximum(pairs, 1) / square
    # Channels of a row that share its errors count as one.
    alike = centred.T @ centred
    channels = np.trace(alike) ** 2 / np.sum(alike**2)
    doubt = 1.0 / np.sqrt(max(pairs[0] / is_read.shape[1] * channels, 1.0))
    # Correlations of independent rows seldom are three standard deviations from 0.
    if correlations[0] + doubt**2 < 3.0 * doubt:
        return INDEPENDENT
    answer, n_rows = INDEPENDENT, int(is_read.any(axis=1).sum())
    for _ in range(10):  # until what lasts, and what the mean takes of it, agree
        # The mean holds that share of the rows' variance; no more than a quarter is made up for.
        absorbed = min(answer.rows / n_rows, 0.25)
        correlation = correlations + (1.0 - correlations) * absorbed
        earlier, later = np.maximum(correlation[:-1], 0.0), np.maximum(correlation[1:], 0.0)
        decay = float(np.clip(earlier @ later / (earlier @ earlier), 0.0, _LONGEST))
        powers = decay ** np.arange(1, len(correlation) + 1)
        square = max(float(powers @ powers), 1e-12)
        share = float(np.clip(powers @ correlation / square, 0.0, 1.0))
        answer = Lasting(share, decay)
    return answer


def score_covariances(slopes: FloatArray, residual: FloatArray) -> Iterator[FloatArray]:
    """Yield the three estimates of the covariance of Jᵀr (n_parameters, n_parameters).

    Slopes (n_rows, n_channels, n_parameters) are 0, and the residual is NaN, where nothing was
    fitted.
    """
    filled = np.nan_to_num(residual)
    rows = np.einsum("rcp,rc->rp", slopes, filled)
    yield rows.T @ rows
    block = block_of(len(rows))
    blocks = np.stack([rows[block == k].sum(axis=0) for k in np.unique(block)])
    used = int(blocks.any(axis=1).sum())
    yield blocks.T @ blocks * (used / max(used - 1, 1))
    count = np.maximum((~np.isnan(residual)).T.astype(float) @ ~np.isnan(residual), 1.0)
    values, vectors = np.linalg.eigh(filled.T @ filled / count)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    spread = np.einsum("rcp,cd->rdp", slopes, root)
    mixed = lasting(residual).correlated(spread.reshape(len(rows), -1))
    yield np.einsum("rdp,rdq->pq", spread, mixed.reshape(spread.shape))
