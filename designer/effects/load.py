"""Brings the effects of all plugins together, checked; a failure is one line with their name."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any, TypeVar, get_args

import numpy as np

from designer.arrays import frozen_array
from designer.effects.effect import (
    ALL_ANCHORS,
    ALL_ATTACHMENTS,
    NEEDS,
    Cause,
    Effect,
    Parameter,
    Readings,
    Size,
    Values,
)
from designer.effects.registry import KnownEffects
from designer.errors import EffectError, described, one_line
from designer.model.cable import Cable
from designer.model.measurements import POSES, Measured
from designer.model.robot import Machine, Platform, Poses, Robot
from designer.plugins import OWN_NAMES, Offer, Plugins, attempt, call_hook
from designer.units import Dimension, QuantityError, read_quantity

RESERVED_IDS = frozenset({ALL_ANCHORS, ALL_ATTACHMENTS, POSES, "cable"})
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
    if sum(map(callable, (effect.on_machine, effect.on_readings, effect.on_poses))) != 1:
        yield "it acts on several of machine, readings and poses or on none (expected one of them)"
    if effect.cause not in get_args(Cause):
        yield f"its cause is {effect.cause!r} (expected {' or '.join(get_args(Cause))})"
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
        kind = type(parameter.size).__name__
        yield f"the size of {parameter.name} is {kind}, not a Size or a function"


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


Value = TypeVar("Value")


def guarded(effect: Effect, label: str) -> Effect:
    """Return the same effect; whatever goes wrong in it is an `EffectError` with a label."""

    def fail(problem: object) -> EffectError:
        line = f"{label}: effect {effect.id!r} fails at work: {one_line(problem)}"
        return EffectError(effect.id, line)

    def attempt(action: Callable[..., Value], *arguments: object, **more: object) -> Value:
        try:
            return action(*arguments, **more)
        except (Exception, SystemExit) as error:  # a stranger's code may raise anything
            asks = " (does it ask for measurements.cable.diameter?)" * ("not nan" in str(error))
            raise fail(f"{described(error)}{asks}") from error

    def change_machine(machine: Machine, values: Values, **more: Any) -> Machine:
        assert effect.on_machine is not None
        changed = attempt(effect.on_machine, machine, values, **more)
        if not isinstance(changed, Machine):
            raise fail(f"it returned {type(changed).__name__}, not a Machine")
        mass_kg = changed.robot.platform.mass_kg  # whatever else cannot be is refused when made
        if not mass_kg > 0.0:
            raise fail(f"it makes the platform's mass {mass_kg:g}")
        return changed

    def change_readings(
        readings: Readings, values: Values, measured: Measured, **more: Any
    ) -> Readings:
        assert effect.on_readings is not None
        changed = attempt(effect.on_readings, readings, values, measured, **more)
        if problem := _misfit(changed, readings):
            raise fail(problem)
        return changed

    def change_poses(poses: Poses, values: Values, **more: Any) -> Poses:
        assert effect.on_poses is not None
        changed = attempt(effect.on_poses, poses, values, **more)
        if not isinstance(changed, Poses) or changed.shape != poses.shape:
            raise fail(f"it returned {type(changed).__name__}, not as many Poses")
        return changed

    def sized(parameter: Parameter) -> Parameter:
        if isinstance(parameter.size, Size):
            return parameter

        def size(machine: Machine) -> Size:
            for flaw in attempt(lambda: [*flaws_of_size(parameter, machine)]):
                raise fail(flaw)
            return parameter.sized(machine).size_here

        return replace(parameter, size=size)

    return replace(
        effect,
        on_machine=effect.on_machine and change_machine,
        on_readings=effect.on_readings and change_readings,
        on_poses=effect.on_poses and change_poses,
        can_have=lambda machine: bool(attempt(effect.can_have, machine)),
        parameters=tuple(sized(parameter) for parameter in effect.parameters),
    )


def _misfit(changed: object, before: Readings) -> str:
    """Return what keeps changed readings from standing for the readings before."""
    if not isinstance(changed, Readings):
        return f"it returned {type(changed).__name__}, not Readings"
    for name in ("length_m", "tension_N"):
        array, shape = getattr(changed, name), getattr(before, name).shape
        if not isinstance(array, np.ndarray) or array.shape != shape or array.dtype != np.float64:
            return f"its {name} is no array {shape} of numbers"
        if np.isinf(array).any():
            return f"its {name} is infinite"
    return ""


def load_effects(plugins: Plugins) -> KnownEffects:
    """Return our own effects and those of the plugins, ours first.

    A plugin that fails, or an effect that is faulty, is left out and reported in ``problems``.
    """
    offers, failures = call_hook(plugins, "register_effects")
    problems = [*plugins.problems, *failures]
    origins: dict[str, str] = {}
    effects: list[Effect] = []
    for offer in offers:
        for item in offer.items:
            effect = _sound(item, offer, origins, problems)
            if effect is not None:
                origins[effect.id] = offer.name
                is_own = offer.name in OWN_NAMES
                effects.append(effect if is_own else guarded(effect, offer.label))
    return KnownEffects(tuple(effects), tuple(dict.fromkeys(problems)))


def _sound(
    item: object, offer: Offer, origins: dict[str, str], problems: list[str]
) -> Effect | None:
    """Return an effect that can be used; None, and a line in ``problems``, for another."""
    if not isinstance(item, Effect):
        kind = type(item).__name__
        problems.append(f"{offer.label}: register_effects() gave {kind}, not an Effect: left out")
        return None
    named = f"{offer.label}: effect {one_line(repr(item.id))}"
    is_own = offer.name in OWN_NAMES  # and then it is for our tests to find its flaws
    flaw = "" if is_own else attempt(lambda: find_flaw(item), named, "cannot be built", problems)
    if flaw is None:  # reported by then
        return None
    if flaw:
        problems.append(f"{named}: {one_line(flaw)}: left out")
        return None
    if item.id in origins:
        problems.append(f"{named} is in {origins[item.id]!r} already: left out")
        return None
    return item
