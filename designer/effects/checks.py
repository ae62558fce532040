"""Checks that an effect is what its name in the files promises."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator

from designer.arrays import frozen_array
from designer.effects.effect import NEEDS, Effect, Parameter
from designer.effects.kind import EffectKind
from designer.effects.names import EffectName, ParameterName
from designer.model.cable import Cable
from designer.model.machine import Machine
from designer.model.robot import Platform, Robot
from designer.units import Dimension, QuantityError, read_quantity

RESERVED_IDS = frozenset({"anchors", "cable"})
"""Words of the config that stand where an id or a parameter may stand."""

_ID = re.compile(r"[a-z][a-z0-9_]{0,59}")
_PARAMETER = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,59}")
_CABLE = Cable(0.01, 0.4, 6e6, 1e4)
_CORNERS = [[0, 0, 9], [9, 0, 9], [9, 7, 9], [0, 7, 9], [5, 0, 9], [0, 4, 9]]
_BODY = [[0.5, 0, 0], [0, 0.5, 0], [-0.5, 0, 0], [0, -0.5, 0], [0.4, 0, 0.5], [0, 0.4, 0.5]]
_SAMPLES = (
    Machine(Robot(frozen_array(_CORNERS[:3]), Platform(100.0)), _CABLE),
    Machine(Robot(frozen_array(_CORNERS), Platform(100.0, frozen_array(_BODY))), _CABLE),
)


def find_flaw(kind: EffectKind) -> str:
    """Return what is wrong with an effect; empty where it can be used.

    It is built for a point mass on three cables and for a platform on six.
    """
    for flaw in _flaws_of_name(kind.name):
        return flaw
    for machine in _SAMPLES:
        for flaw in flaws_of_built(kind.name, kind.build, machine):
            return flaw
    return ""


def flaws_of_built(name: EffectName, build: object, machine: Machine) -> Iterator[str]:
    """Yield what keeps the effects that ``build`` makes for a machine from fitting their name."""
    if not callable(build):
        yield f"its build is {type(build).__name__}, not a function"
        return
    effects = build(machine)
    if not isinstance(effects, list | tuple):
        yield f"its build returned {type(effects).__name__}, not a list of Effect"
        return
    for effect in effects:
        if not isinstance(effect, Effect):
            yield f"its build gave {type(effect).__name__}, not an Effect"
            return
        yield from _flaws_of_effect(name, effect, machine.robot.n_cables)
    yield from _flaws_of_cables(name, [effect.cable for effect in effects], machine)


def _flaws_of_name(name: object) -> Iterator[str]:
    if not isinstance(name, EffectName):
        yield f"its name is {type(name).__name__}, not an EffectName"
        return
    if not isinstance(name.id, str) or not _ID.fullmatch(name.id) or name.id in RESERVED_IDS:
        yield f"{name.id!r} is no effect id (expected lower-case letters, digits or '_')"
    if not name.parameters:
        yield "it has no parameter"
    for parameter in name.parameters:
        yield from _flaws_of_parameter_name(parameter)
    names = [parameter.name for parameter in name.parameters_for(3)]
    if len(set(names)) < len(names):
        yield "two of its parameters have one name"


def _flaws_of_parameter_name(parameter: object) -> Iterator[str]:
    if not isinstance(parameter, ParameterName):
        yield f"a parameter is {type(parameter).__name__}, not a ParameterName"
        return
    plain = parameter.name.replace("{cable}", "1")
    if not _PARAMETER.fullmatch(plain) or plain in RESERVED_IDS:
        yield f"{parameter.name!r} is no parameter name (expected letters, digits or '_')"
    if not isinstance(parameter.dimension, Dimension):
        yield f"the dimension of {parameter.name!r} is no Dimension"
        return
    try:
        read_quantity(parameter.dimension.example, parameter.dimension)
    except QuantityError as error:
        yield f"the dimension of {parameter.name!r}: its example {error}"


def _flaws_of_effect(name: EffectName, effect: Effect, n_cables: int) -> Iterator[str]:
    wanted = name.parameters_for(n_cables)
    names = [parameter.name for parameter in effect.parameters]
    if effect.id != name.id:
        yield f"its Effect has the id {effect.id!r}"
    if names != [one.name for one in wanted]:
        expected = ", ".join(one.name for one in wanted)
        yield f"its Effect has the parameters {', '.join(names)} (expected {expected})"
        return
    for one, parameter in zip(wanted, effect.parameters, strict=True):
        if one.neutral is not None and one.neutral != parameter.neutral:
            yield f"{one.name} is neutral at {parameter.neutral:g} (expected {one.neutral:g})"
        yield from _flaws_of_numbers(parameter)
    if callable(effect.on_machine) == callable(effect.on_readings):
        yield "its Effect acts on both machine and readings or on none (expected one of them)"
    for start in effect.starts:
        if not start.keys() <= set(names) or not all(map(math.isfinite, start.values())):
            yield f"it starts from {dict(start)} (expected finite values of its parameters)"
    for need in sorted(effect.needs - NEEDS.keys()):
        yield f"it needs {need!r} (expected {', '.join(NEEDS)})"
    for text in ("summary", "law", "source"):
        if not isinstance(getattr(effect, text), str) or not getattr(effect, text).strip():
            yield f"its {text} is no text"


def _flaws_of_numbers(parameter: Parameter) -> Iterator[str]:
    (low, high), (least, most) = parameter.bounds, parameter.plausible
    numbers = (low, high, least, most, parameter.neutral, parameter.typical)
    if not all(math.isfinite(number) for number in numbers):
        yield f"{parameter.name} has a number that is not finite"
    elif not (low < high and low <= parameter.neutral <= high):
        yield f"{parameter.name} has no bounds around its neutral value {parameter.neutral:g}"
    elif parameter.typical <= 0.0 or least > most:
        yield f"{parameter.name} has no typical size above 0, or no plausible range"


def _flaws_of_cables(name: EffectName, cables: list[int | None], machine: Machine) -> Iterator[str]:
    n_cables = machine.robot.n_cables
    if name.takes_cable:
        numbers = set(range(1, n_cables + 1))
        if len(set(cables)) < len(cables) or not set(cables) <= numbers:
            yield f"its build gave cables {cables} (expected each of 1 to {n_cables} once at most)"
    elif len(cables) > 1 or any(cable is not None for cable in cables):
        yield "its build gave effects of single cables (expected takes_cable in its EffectName)"
