"""From the text of a cell to a number."""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from typing import NamedTuple

import numpy as np

from designer.arrays import FloatArray

MOST_ALIKE = 20
"""How many faults of one kind are told one by one; nobody reads more."""

_NOTHING = frozenset({"", "nan", "-nan", "na"})


class TextCell(NamedTuple):
    """A cell that holds a text: its row, counted from 0, and the text."""

    row: int
    text: str


def read_cells(cells: Sequence[str], first_row: int) -> tuple[FloatArray, list[TextCell]]:
    """Return the numbers of a column, NaN for nothing or a text, and the texts."""
    with suppress(ValueError):  # the quick way, which most columns allow
        return np.array([_float(cell) for cell in cells]), []
    numbers = [_number(cell) for cell in cells]
    texts = [
        TextCell(row, cell.strip())
        for row, (cell, number) in enumerate(zip(cells, numbers, strict=True), start=first_row)
        if number is None
    ]
    return np.array([math.nan if number is None else number for number in numbers]), texts


def is_number(cell: str) -> bool:
    """Return whether a cell holds a number, be it infinite."""
    return cell.strip().casefold() not in _NOTHING and _number(cell) is not None


def _number(cell: str) -> float | None:
    """Return the number, NaN for nothing, None for a text."""
    if cell.strip().casefold() in _NOTHING:
        return math.nan
    try:
        return _float(cell)
    except ValueError:
        return None


def _float(cell: str) -> float:
    if "_" in cell:  # Python reads '1_2' as 12
        raise ValueError(cell)
    return float(cell)
