"""Results as plain values and as JSON, which holds no number that is not finite."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any

import numpy as np


def finite(values: Any) -> Any:
    """Return the same as plain values, with None for each number that is not finite.

    JSON cannot hold those. Mappings, sequences, arrays and numbers.
    """
    if isinstance(values, dict):
        return {key: finite(value) for key, value in values.items()}
    if isinstance(values, np.ndarray | np.generic):
        values = values.tolist()
    if isinstance(values, list | tuple):
        return [finite(value) for value in values]
    return None if isinstance(values, float) and not math.isfinite(values) else values


def json_text(values: Mapping[str, Any]) -> str:
    """Return results as JSON text."""
    return json.dumps(finite(values), indent=2, ensure_ascii=False, allow_nan=False)
