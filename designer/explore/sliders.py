"""From where to where a slider goes: about the value, as far as the machine reaches."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from designer.documents.document import Key
from designer.documents.fields import QuantityField
from designer.io.config.schema import StudySection
from designer.model.cable import STANDARD_GRAVITY_M_PER_S2
from designer.units import ANGLE, FORCE, LENGTH, MOMENT, TEMPERATURE

_FACTOR = 4.0
_TURN_RAD = math.radians(45.0)
_DEGREES = 40.0
_MOST_SAFETY = 12.0
_IN_WORLD = ("pose.position", "workspace.region.z", "workspace.region.box", "workspace.floor")
_IN_BODY = ("robot.platform.attachments", "robot.platform.centre_of_mass", "robot.platform.hull")


@dataclass(frozen=True, slots=True)
class Sizes:
    """How large the machine is.

    Parameters
    ----------
    low_m, high_m : tuple of 3 floats
        Box around the exit points, downward by half its diagonal, where the platform is [m].
    extent_m : float
        That diagonal [m].
    reach_m : float
        Twice the distance of the farthest attachment from the origin of the platform [m].
    weight_N : float
        Of the platform [N].
    """

    low_m: tuple[float, ...]
    high_m: tuple[float, ...]
    extent_m: float
    reach_m: float
    weight_N: float

    @classmethod
    def of(cls, section: StudySection) -> Sizes:
        """Return the sizes of a study."""
        anchors, platform = np.array(section.robot.anchors), section.robot.platform
        low, high = anchors.min(axis=0), anchors.max(axis=0)
        extent = float(np.linalg.norm(high - low))
        ends = np.array(platform.attachments or [(0.0, 0.0, 0.0)])
        reach = 2.0 * float(np.linalg.norm(ends, axis=1).max()) or 0.01 * extent
        low = low - [0.0, 0.0, 0.5 * extent]
        weight = platform.mass * STANDARD_GRAVITY_M_PER_S2
        return cls(tuple(low.tolist()), tuple(high.tolist()), extent, reach, weight)

    @property
    def without_load(self) -> Sizes:
        """The same of an empty machine, for all that does not depend on the load."""
        return replace(self, weight_N=0.0)


def count_slider(value: float | None, low: int, high: int, plain: str) -> dict[str, Any]:
    """Return low, high and is_log of a whole number; nothing where none makes sense."""
    if value is None or plain.endswith("seed"):
        return {}
    is_log = high > 1000
    ends = (max(low, 100), min(high, 200_000)) if is_log else (low, min(high, 12))
    lowest, highest = min(ends[0], value), max(ends[1], value)
    return {"low": float(lowest), "high": float(highest), "is_log": is_log}


def slider(
    plain: str, place: Sequence[Key], value: float | None, reader: QuantityField, sizes: Sizes
) -> dict[str, Any]:
    """Return low, high and is_log of a quantity; nothing where none makes sense."""
    least = -math.inf if reader.at_least is None else reader.at_least
    largest = math.inf if reader.at_most is None else reader.at_most
    ends = _ends(plain, place, value, reader, sizes)
    if ends is None:
        return {}
    low, high = max(ends[0], least), min(ends[1], largest)
    if not low < high:
        return {}
    is_log = low > 0.0 and least > 0.0 and high / low >= 10.0
    return {"low": low, "high": high, "is_log": is_log}


def _ends(
    plain: str, place: Sequence[Key], value: float | None, reader: QuantityField, sizes: Sizes
) -> tuple[float, float] | None:
    at, kind, least = value or 0.0, reader.dimension, reader.at_least
    ends: tuple[float, float] | None = None
    if plain in _IN_WORLD:
        axis = _axis(place)
        ends = min(at, sizes.low_m[axis]), max(at, sizes.high_m[axis])
    elif kind is ANGLE:
        ends = at - _TURN_RAD, at + _TURN_RAD
    elif kind is TEMPERATURE:
        ends = at - _DEGREES, at + _DEGREES
    elif kind in (FORCE, MOMENT):
        reach = max(sizes.weight_N * (sizes.reach_m if kind is MOMENT else 1.0), 2.0 * abs(at))
        ends = -reach, reach  # where it may not be below zero, its limit cuts this
    elif (least, reader.at_most) == (0.01, 1.0):
        ends = min(0.5, at or 0.5), 1.0
    elif (least, reader.at_most) == (1.0, 100.0):
        ends = 1.0, max(_MOST_SAFETY, at)
    elif kind is LENGTH:
        ends = _lengths(plain, value, reader, sizes)
    elif at > 0.0 and (least or 0.0) >= 0.0:
        ends = at / _FACTOR, at * _FACTOR
    return ends


def _lengths(
    plain: str, value: float | None, reader: QuantityField, sizes: Sizes
) -> tuple[float, float]:
    """Return ends of a length: in the body as far as that reaches, else by the whole machine."""
    at = value or 0.0
    if reader.at_least is None or reader.at_least < 0.0:
        reach = sizes.reach_m if plain in _IN_BODY else 0.5 * sizes.extent_m
        return at - reach, at + reach
    if reader.at_least > 0.0:  # none is another thing than a very small one
        middle = at or 0.01 * sizes.extent_m
        return middle / _FACTOR**2, middle * _FACTOR**2
    return 0.0, max(0.25 * sizes.extent_m, at)


def _axis(place: Sequence[Key]) -> int:
    """Return the axis of the world that a coordinate is along."""
    if place[-1] == "floor" or "z" in place:
        return 2
    return int(place[-2] if "box" in place else place[-1])
