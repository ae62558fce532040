"""Results as plain values and as JSON, which holds no number that is not finite."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from typing import Any

import numpy as np


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
