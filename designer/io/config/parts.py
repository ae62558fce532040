"""A config in parts, so that a check can look at one whatever is wrong with the others."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from pydantic import TypeAdapter, ValidationError

from designer.arrays import FloatArray
from designer.documents.document import Document
from designer.documents.node import Data, Key
from designer.effects.effect import Effect
from designer.errors import Fault


@dataclass(frozen=True, slots=True)
class Parts:
    """A document whose parts can be had one by one, whatever is wrong with the others.

    ``effects`` are those that there are, by their ids.
    """

    document: Document
    data: Data
    effects: Mapping[str, Effect]

    def raw(self, *keys: str) -> Data:
        """Return what the file holds at a path, None for nothing."""
        found = self.data
        for key in keys:
            found = found.get(key) if isinstance(found, dict) else None
        return found

    def read(self, kind: Any, *keys: str) -> Any:
        """Return the value at a path, checked as ``kind``; None if it is absent or faulty."""
        try:
            return TypeAdapter(kind).validate_python(self.raw(*keys))
        except ValidationError:
            return None

    def array(self, kind: Any, *keys: str) -> FloatArray | None:
        """Return the value at a path as an array; None if it is absent or faulty."""
        value = self.read(kind, *keys)
        return None if value is None else np.array(value, dtype=np.float64)

    def fault(self, keys: tuple[Key, ...], problem: str, expected: str = "") -> Fault:
        """Return a fault at a path."""
        return self.document.fault(keys, problem, expected)
