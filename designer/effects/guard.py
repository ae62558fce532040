"""Wraps an effect that a plugin brought in, so that its failures are one line with its name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np

from designer.effects.checks import flaws_of_size
from designer.effects.effect import Effect, Parameter, Readings, Size, Values
from designer.errors import EffectError, described, one_line
from designer.model.machine import Machine
from designer.model.measured_data import Measured

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
