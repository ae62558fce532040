"""Formats of the files that are read and written, and results as plain values, JSON and CSV.

A format, counted from 1, grows by one where an older program would misread the file; fields and
keys that are only added leave it as it is. A file without a number is of the first.

JSON holds no number that is not finite, and no spreadsheet takes a cell of a CSV for a formula.
"""

from __future__ import annotations

import csv
import io
import json
import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields, is_dataclass
from enum import Enum
from typing import Any

import numpy as np

from designer import __version__

Json = dict[str, Any]
"""A part of a file of results."""
CONFIG_FORMAT = 1
"""Of studies."""
GRADE_FORMAT = 1
"""Of grade files."""
RESULT_FORMAT = 1
"""Of ``result.json``."""
DIAGNOSIS_FORMAT = 1
"""Of ``diagnosis.json``."""


def why_unreadable(value: object, newest: int, written_by: str = "") -> tuple[str, str] | None:
    """Return why a file of this format cannot be read and what to do; None where it can be.

    Parameters
    ----------
    value : object
        What the file says under ``format``; None where it says nothing.
    newest : int
        The newest format that is read.
    written_by : str
        Version of the program that wrote the file, where the file tells.
    """
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, int) or value < 1:
        return "is no format", f"a whole number, 1 to {newest}"
    if value <= newest:
        return None
    needed = f"{written_by} or newer" if written_by else f"newer than {__version__}"
    problem = f"format {value} is newer than this cdpr-designer {__version__} reads"
    return problem, f"format 1 to {newest}; this file needs cdpr-designer {needed}"


def is_requested(part: str, paths: Sequence[str] | None) -> bool:
    """Tell whether a part of a file is one of some paths, or one lies in it; None are all."""
    return paths is None or any(f"{path}.".startswith(f"{part}.") for path in paths)


_STARTS_A_FORMULA = tuple("=+-@＝＋－＠\t")  # Excel takes the wide ones as well
_LATER_FORMULA = re.compile('(?:(?<=;)|(?<=.[\t\n]))(?="*[=+@＝＋－＠-])', re.DOTALL)
"""Within a cell, where a spreadsheet may begin another one; not after a comma, which is quoted."""


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
    for entry in fields(result):
        key, value = entry.metadata.get("json", entry.name), getattr(result, entry.name)
        if callable(key):
            row |= key(value)
        elif key is not None:
            row[key] = value
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

    So it does behind a ``;`` or a tab within it, at which some spreadsheets divide cells. A formula
    of a stranger's, such as a grade's name, could send away what the table holds.
    """
    if not isinstance(cell, str):
        return cell
    cell = cell.replace("\r", " ")  # the module leaves it unquoted, and it would begin a new row
    cell = _LATER_FORMULA.sub("'", cell)
    if not cell.startswith(_STARTS_A_FORMULA):
        return cell
    try:
        float(cell)
    except ValueError:
        return f"'{cell}"
    return cell
