"""Errors before and after, on rows that were fitted and on rows that no fit has seen."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from designer.arrays import BoolArray, FloatArray, IntArray
from designer.diagnosis.blocks import block_of
from designer.diagnosis.problem import Problem, channel_names
from designer.diagnosis.robust import is_outlier, rms
from designer.effects.effect import Setting

_DRAWS = 400
"""Of the bootstrap: the ends of a 95 % interval scatter by a thirtieth of its width."""


@dataclass(frozen=True, slots=True)
class Interval:
    """A root mean square with its 95 % interval by block bootstrap."""

    value: float
    low: float
    high: float


@dataclass(frozen=True, slots=True, eq=False)
class Error:
    """Error of one kind of reading, in SI units.

    Parameters
    ----------
    rms : float
        Over the rows that were fitted.
    heldout : Interval
        Over the rows that no fit has seen.
    heldout_of_cable : array (n_cables,)
        The same, cable by cable.
    """

    rms: float
    heldout: Interval
    heldout_of_cable: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Stage:
    """The model at one point of the search: as declared, then with each effect.

    Parameters
    ----------
    label : str
        What was added.
    settings : tuple of Setting
        All effects with their values.
    length_m, tension_N : Error or None
        None where nothing of the kind was measured.
    """

    label: str
    settings: tuple[Setting, ...]
    length_m: Error | None
    tension_N: Error | None


@dataclass(frozen=True, slots=True)
class Outlier:
    """A reading that no model here explains; shown, and given little weight."""

    row: int
    channel: str = field(metadata={"json": "reading"})
    size: float


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
    length_m, tension_N = np.hsplit(residual, 2)
    return Stage(label, settings, _error(length_m, heldout), _error(tension_N, heldout))


def outliers_of(residual: FloatArray, row_numbers: IntArray) -> tuple[Outlier, ...]:
    """Name the readings that stand off, in units of noise."""
    names = channel_names(residual.shape[1] // 2)
    return tuple(
        Outlier(int(row_numbers[row]), names[channel], float(residual[row, channel]))
        for row, channel in np.argwhere(is_outlier(residual))
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


def _error(residual: FloatArray, heldout: BoolArray) -> Error | None:
    if np.isnan(residual).all():
        return None
    unseen = residual[heldout]
    return Error(
        rms=rms(residual[~heldout]),
        heldout=bootstrap(unseen, block_of(len(residual))[heldout]),
        heldout_of_cable=np.array([rms(column) for column in unseen.T]),
    )
