"""Results as plain values, as JSON, which holds no number that is not finite, and as CSV.

No spreadsheet takes a cell of the latter for a formula.
"""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Iterable, Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from typing import Any

import numpy as np

_STARTS_A_FORMULA = ("=", "+", "-", "@", "\t")


def finite(values: Any) -> Any:
    """Return the same as plain values, with None for each number that is not finite.

    JSON cannot hold those. Mappings, sequences, arrays, numbers, enums by their values, and
    dataclasses by their fields, see `record`.
    """
    if is_dataclass(values) and not isinstance(values, type):
        values = record(values)
    if isinstance(values, Mapping):
        return plain(values)
    if isinstance(values, np.ndarray | np.generic):
        values = values.tolist()
    if isinstance(values, Enum):
        values = values.value
    if isinstance(values, list | tuple):
        return [finite(value) for value in values]
    return None if isinstance(values, float) and not math.isfinite(values) else values


def plain(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return a mapping as `finite` has it."""
    return {key: finite(value) for key, value in values.items()}


def record(result: Any) -> dict[str, Any]:
    """Return what a file holds of a result, a dataclass: its fields by their names.

    ``json`` in the metadata of a field says otherwise: another name, None for a field that is in
    no file, or a function of the value that returns the keys in its place. Properties that stand
    in files as well are named by the class, in ``also_in_files``.
    """
    row: dict[str, Any] = {}
    for each in fields(result):
        shown, value = each.metadata.get("json", each.name), getattr(result, each.name)
        if callable(shown):
            row |= shown(value)
        elif shown is not None:
            row[shown] = value
    return row | {name: getattr(result, name) for name in getattr(result, "also_in_files", ())}


def json_text(values: Mapping[str, Any]) -> str:
    """Return results as JSON text."""
    return json.dumps(plain(values), indent=2, ensure_ascii=False, allow_nan=False)


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
