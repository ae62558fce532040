"""Checks that an effect can be used: what a plugin brings in may be anything."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator

from designer.arrays import frozen_array
from designer.effects.effect import ALL_ANCHORS, NEEDS, Effect, Parameter, Size
from designer.model.cable import Cable
from designer.model.machine import Machine
from designer.model.measurements import POSES
from designer.model.robot import Platform, Robot
from designer.units import Dimension, QuantityError, read_quantity

RESERVED_IDS = frozenset({ALL_ANCHORS, POSES, "cable"})
"""Words of the config that stand where an id or a parameter may stand."""

_ID = re.compile(r"[a-z][a-z0-9_]{0,59}")

_CABLE = Cable(0.01, 0.4, 6e6, 1e4)
_CORNERS = [[0, 0, 9], [9, 0, 9], [9, 7, 9], [0, 7, 9], [5, 0, 9], [0, 4, 9]]
_BODY = [[0.5, 0, 0], [0, 0.5, 0], [-0.5, 0, 0], [0, -0.5, 0], [0.4, 0, 0.5], [0, 0.4, 0.5]]
_SAMPLES = (
    Machine(Robot(frozen_array(_CORNERS[:3]), Platform(100.0)), _CABLE),
    Machine(Robot(frozen_array(_CORNERS), Platform(100.0, frozen_array(_BODY))), _CABLE),
)


def find_flaw(effect: Effect) -> str:
    """Return what is wrong with an effect; empty where it can be used.

    It is made for a point mass on three cables and for a platform on six.
    """
    for flaw in _flaws_of_record(effect):
        return flaw
    for machine in _SAMPLES:
        if effect.can_have(machine):
            for parameter in effect.parameters:
                for flaw in flaws_of_size(parameter, machine):
                    return flaw
    return ""


def _flaws_of_record(effect: Effect) -> Iterator[str]:
    if not isinstance(effect.id, str) or not _ID.fullmatch(effect.id) or effect.id in RESERVED_IDS:
        yield f"{effect.id!r} is no effect id (expected lower-case letters, digits or '_')"
    if not effect.parameters:
        yield "it has no parameter"
    for parameter in effect.parameters:
        yield from _flaws_of_parameter(parameter)
    names = [parameter.name for parameter in effect.parameters_for(3)]
    if len(set(names)) < len(names):
        yield "two of its parameters have one name"
    if callable(effect.on_machine) == callable(effect.on_readings):
        yield "it acts on both machine and readings or on none (expected one of them)"
    for start in effect.starts:
        if not start.keys() <= set(names) or not all(map(math.isfinite, start.values())):
            yield f"it starts from {dict(start)} (expected finite values of its parameters)"
    for need in sorted(effect.needs - NEEDS.keys()):
        yield f"it needs {need!r} (expected {', '.join(NEEDS)})"
    for text in ("summary", "law", "source"):
        if not isinstance(getattr(effect, text), str) or not getattr(effect, text).strip():
            yield f"its {text} is no text"
    if effect.cable is not None:
        yield f"it is for cable {effect.cable} alone (expected takes_cable, for each of them)"


def _flaws_of_parameter(parameter: object) -> Iterator[str]:
    if not isinstance(parameter, Parameter):
        yield f"a parameter is {type(parameter).__name__}, not a Parameter"
        return
    plain = parameter.name.replace("{cable}", "1")
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_]{0,59}", plain) or plain in RESERVED_IDS:
        yield f"{parameter.name!r} is no parameter name (expected letters, digits or '_')"
    if not isinstance(parameter.dimension, Dimension):
        yield f"the dimension of {parameter.name!r} is no Dimension"
        return
    try:
        read_quantity(parameter.dimension.example, parameter.dimension)
    except QuantityError as error:
        yield f"the dimension of {parameter.name!r}: its example {error}"
    if not isinstance(parameter.size, Size) and not callable(parameter.size):
        name__ = type(parameter.size).__name__
        yield f"the size of {parameter.name} is {name__}, not a Size or a function"


def flaws_of_size(parameter: Parameter, machine: Machine) -> Iterator[str]:
    """Yield what keeps a parameter from being fitted on a machine."""
    sized = parameter.sized(machine)
    (low, high), (least, greatest) = sized.bounds, sized.plausible
    numbers = (low, high, least, greatest, sized.neutral, sized.typical)
    if not all(math.isfinite(number) for number in numbers):
        yield f"{sized.name} has a number that is not finite"
    elif not (low < high and low <= sized.neutral <= high):
        yield f"{sized.name} has no bounds around its neutral value {sized.neutral:g}"
    elif sized.typical <= 0.0 or least > greatest:
        yield f"{sized.name} has no typical size above 0, or no plausible range"
    elif parameter.is_optional and sized.neutral != parameter.neutral:
        expected = f"expected {parameter.neutral:g}, as it may be left out"
        yield f"{sized.name} is neutral at {sized.neutral:g} ({expected})"
