"""Tables as text, whose cells no spreadsheet takes for formulas."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable
from typing import Any

_STARTS_A_FORMULA = ("=", "+", "-", "@", "\t")


def csv_text(rows: Iterable[Iterable[Any]]) -> str:
    """Return rows as CSV; None is an empty cell."""
    stream = io.StringIO()
    writer = csv.writer(stream, lineterminator="\n")
    writer.writerows([harmless(cell) for cell in row] for row in rows)
    return stream.getvalue()


def harmless(cell: Any) -> Any:
    """Return a cell that stays a text where it is one: with a ``'`` before what begins a formula.

    A formula of a stranger's, such as a grade's name, could send away what the table holds.
    """
    if not isinstance(cell, str):
        return cell
    cell = cell.replace("\r", " ")  # the module leaves it unquoted, and it would begin a new row
    if not cell.startswith(_STARTS_A_FORMULA):
        return cell
    try:
        float(cell)
    except ValueError:
        return f"'{cell}"
    return cell
