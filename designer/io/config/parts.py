"""A config in parts, so that a check can look at one whatever is wrong with the others."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from typing import Any

import numpy as np
from pydantic import TypeAdapter, ValidationError

from designer.arrays import FloatArray
from designer.documents.bounds import MOST_CABLES
from designer.documents.document import Document
from designer.documents.node import Data, Key
from designer.documents.section import kind_at
from designer.effects.effect import Effect
from designer.errors import Fault
from designer.io.config.effects import Found, read_effects
from designer.io.config.schema import StudySection
from designer.model.robot import vertical_frame


@dataclass(frozen=True, slots=True)
class Parts:
    """A document whose parts can be had one by one, whatever is wrong with the others.

    ``effects`` are those that there are, by their ids. A path is written as in messages, such as
    ``robot.platform.mass``.
    """

    document: Document
    data: Data
    effects: Mapping[str, Effect]
    _read: dict[str, Any] = field(default_factory=dict)

    def raw(self, path: str) -> Data:
        """Return what the file holds at a path, None for nothing."""
        data = self.data
        for key in path.split("."):
            data = data.get(key) if isinstance(data, dict) else None
        return data

    def read(self, path: str) -> Any:
        """Return the value at a path, checked by the schema; None if it is absent or faulty."""
        if path not in self._read:
            self._read[path] = valid(_reader_at(path), self.raw(path))
        return self._read[path]

    def array(self, path: str) -> FloatArray | None:
        """Return the value at a path as an array; None if it is absent, faulty or a word."""
        value = self.read(path)
        return None if value is None or isinstance(value, str) else np.array(value, dtype=float)

    def fault(self, path: str, problem: str, expected: str = "", *below: Key) -> Fault:
        """Return a fault at a path, or at a field or item below it."""
        return self.document.fault((*path.split("."), *below), problem, expected)

    @property
    def is_planar(self) -> bool:
        """Whether the file asks for a robot in a vertical plane, as far as it can be read."""
        return self.raw("robot.planar") not in (None, False)

    @property
    def is_point_mass(self) -> bool:
        """Whether the platform has no attachments."""
        return self.raw("robot.platform.attachments") is None

    @property
    def n_cables(self) -> int:
        """Number of cables; as many as there may be where the anchors are faulty."""
        anchors = self.read("robot.anchors")
        return MOST_CABLES if anchors is None else len(anchors)

    @property
    def declared(self) -> Found:
        """The effects, each with its place, and what is wrong with them."""
        return read_effects(self.raw("effects"), self.n_cables, self.effects)

    @property
    def down(self) -> FloatArray:
        """Direction of gravity (3,)."""
        down = self.array("robot.gravity")
        return np.array([0.0, 0.0, -1.0]) if down is None else down

    def seen_from_above(self, points_m: FloatArray) -> FloatArray:
        """Return points (n, 3) along two horizontal axes (n, 2) [m]."""
        return np.asarray((points_m @ vertical_frame(self.down).T)[:, :2])


def valid(reader: TypeAdapter[Any], data: Data) -> Any:
    """Return what a reader makes of a value; None where it refuses it."""
    try:
        return reader.validate_python(data)
    except ValidationError:
        return None


@cache
def _reader_at(path: str) -> TypeAdapter[Any]:
    return TypeAdapter(kind_at(StudySection, path.split(".")))
