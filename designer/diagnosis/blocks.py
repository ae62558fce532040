"""Contiguous blocks of rows: what is held out is not next to what is fitted."""

from __future__ import annotations

import numpy as np

from designer.arrays import BoolArray, IntArray

_BLOCKS = 12
_HELD_OUT_EVERY = 4
_FOLDS = 5


def block_of(n_rows: int, n_blocks: int = _BLOCKS) -> IntArray:
    """Return the number of the block of each row (n_rows,), blocks of nearly equal length."""
    return (np.arange(n_rows) * min(n_blocks, n_rows)) // n_rows


def heldout_rows(n_rows: int) -> BoolArray:
    """Return which rows no fit may see: every fourth block."""
    return np.asarray(block_of(n_rows) % _HELD_OUT_EVERY == _HELD_OUT_EVERY - 1)


def folds(fit_rows: BoolArray) -> list[BoolArray]:
    """Split the rows for fitting into contiguous parts for cross-validation.

    Returns
    -------
    list of array (n_rows,)
        The rows of each part; together they are ``fit_rows``.
    """
    where = np.flatnonzero(fit_rows)
    part = block_of(len(where), _FOLDS)
    answer = []
    for k in range(int(part.max()) + 1):
        rows = np.zeros_like(fit_rows)
        rows[where[part == k]] = True
        answer.append(rows)
    return answer
