"""Contiguous blocks of rows: what is held out is not next to what is fitted."""

from __future__ import annotations

import numpy as np

from designer.arrays import BoolArray, IntArray

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
    indices = np.flatnonzero(fit_rows)
    # With five parts each fit has four fifths of the rows, at five times the work.
    part = block_of(len(indices), 5)
    answer = []
    for k in range(int(part.max()) + 1):
        rows = np.zeros_like(fit_rows)
        rows[indices[part == k]] = True
        answer.append(rows)
    return answer
