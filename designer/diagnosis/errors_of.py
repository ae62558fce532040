"""Errors before and after, on rows that were fitted and on rows that no fit has seen."""

from __future__ import annotations

import numpy as np

from designer.arrays import BoolArray, FloatArray, IntArray
from designer.diagnosis.blocks import block_of
from designer.diagnosis.problem import Problem, channel_names
from designer.diagnosis.result import Error, Interval, Outlier, Stage
from designer.effects.effect import Setting

_DRAWS = 400
_OUTLYING = 5.0


def stage(
    problem: Problem,
    label: str,
    settings: tuple[Setting, ...],
    heldout: BoolArray,
    sound: BoolArray,
) -> Stage:
    """Return the errors of a model in SI units over readings that are ``sound``.

    The latter (n_rows, 2 n_cables) are the same at every stage, so that no model looks better for
    having dropped more.
    """
    residual = np.where(sound, problem.residual(settings), np.nan) * problem.sigma
    n = residual.shape[1] // 2
    return Stage(
        label,
        settings,
        _error(residual[:, :n], heldout),
        _error(residual[:, n:], heldout),
    )


def without_outliers(residual: FloatArray) -> FloatArray:
    """Blank readings that stand off by more than five times the spread of their channel."""
    apart = np.abs(residual - _median(residual))
    limit = _OUTLYING * np.maximum(1.4826 * _median(apart), 1.0)
    return np.where(apart > limit, np.nan, residual)


def outliers_of(residual: FloatArray, row_numbers: IntArray) -> tuple[Outlier, ...]:
    """Name the readings that `without_outliers` blanks, in units of noise."""
    names = channel_names(residual.shape[1] // 2)
    gone = np.isnan(without_outliers(residual)) & ~np.isnan(residual)
    return tuple(
        Outlier(int(row_numbers[row]), names[channel], float(residual[row, channel]))
        for row, channel in np.argwhere(gone)
    )


def rms(residual: FloatArray) -> float:
    """Root mean square of what was measured; NaN if nothing was."""
    known = residual[~np.isnan(residual)]
    return float(np.sqrt(np.mean(known**2))) if known.size else float("nan")


def _error(residual: FloatArray, heldout: BoolArray) -> Error | None:
    if np.isnan(residual).all():
        return None
    unseen = residual[heldout]
    return Error(
        rms=rms(residual[~heldout]),
        heldout=bootstrap(unseen, block_of(len(residual))[heldout]),
        heldout_of_cable=np.array([rms(column) for column in unseen.T]),
    )


def bootstrap(unseen: FloatArray, block: IntArray) -> Interval:
    """Return the root mean square of held-out rows with its 95 % interval.

    Blocks are drawn with replacement, since within a block rows may be alike.

    Parameters
    ----------
    unseen : array (n_rows, n_channels)
        Residuals; NaN where there is none.
    block : array (n_rows,)
        Number of the block of each row.
    """
    square = np.nansum(unseen**2, axis=1)
    count = np.sum(~np.isnan(unseen), axis=1)
    third = thirds_of(block)
    sums = np.array([[square[third == k].sum(), count[third == k].sum()] for k in np.unique(third)])
    rng = np.random.default_rng(0)
    draw = rng.integers(len(sums), size=(_DRAWS, len(sums)))
    total = sums[draw].sum(axis=1)
    low, high = np.quantile(np.sqrt(total[:, 0] / np.maximum(total[:, 1], 1)), [0.025, 0.975])
    return Interval(rms(unseen), float(low), float(high))


def thirds_of(block: IntArray) -> IntArray:
    """Split each of the blocks (n_rows,) in three: few would leave an interval to chance."""
    return np.asarray((np.arange(len(block)) * 3 * len(np.unique(block))) // max(len(block), 1))


def _median(residual: FloatArray) -> FloatArray:
    empty = np.isnan(residual).all(axis=0)
    return np.where(empty, 0.0, np.nanmedian(np.where(empty, 0.0, residual), axis=0))
