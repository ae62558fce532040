"""Wraps an effect that a plugin brought in, so that its failures are one line with its name."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TypeVar

import numpy as np

from designer.effects.checks import flaws_of_built
from designer.effects.effect import Effect, Readings, Values
from designer.effects.kind import EffectKind
from designer.errors import EffectError
from designer.model.machine import Machine
from designer.model.measured_data import Measured
from designer.plugins.guard import one_line

Value = TypeVar("Value")


def guarded(kind: EffectKind, label: str) -> EffectKind:
    """Return the same effect; whatever goes wrong in it is raised as an `EffectError`.

    Parameters
    ----------
    kind : EffectKind
        Of a plugin.
    label : str
        Which plugin it is.
    """
    effect_id = kind.name.id

    def fail(problem: object) -> EffectError:
        line = f"{label}: effect {effect_id!r} fails at work: {one_line(problem)}"
        return EffectError(effect_id, line)

    def build(machine: Machine) -> list[Effect]:
        flaw = _attempt(lambda: next(flaws_of_built(kind.name, kind.build, machine), None), fail)
        if flaw is not None:
            raise fail(flaw)
        return [
            _guarded_effect(effect, fail) for effect in _attempt(lambda: kind.build(machine), fail)
        ]

    return replace(kind, build=build)


def _guarded_effect(effect: Effect, fail: Callable[[object], EffectError]) -> Effect:
    on_machine, on_readings = effect.on_machine, effect.on_readings

    def change_machine(machine: Machine, values: Values) -> Machine:
        assert on_machine is not None
        changed = _attempt(lambda: on_machine(machine, values), fail)
        if not isinstance(changed, Machine):
            raise fail(f"it returned {type(changed).__name__}, not a Machine")
        problem = _impossible(changed)
        if problem:
            raise fail(problem)
        return changed

    def change_readings(readings: Readings, values: Values, measured: Measured) -> Readings:
        assert on_readings is not None
        changed = _attempt(lambda: on_readings(readings, values, measured), fail)
        problem = _misfit(changed, readings)
        if problem:
            raise fail(problem)
        return changed

    return replace(
        effect,
        on_machine=change_machine if on_machine is not None else None,
        on_readings=change_readings if on_readings is not None else None,
    )


def _attempt(action: Callable[[], Value], fail: Callable[[object], EffectError]) -> Value:
    try:
        return action()
    except (Exception, SystemExit) as error:  # a stranger's code may raise anything
        raise fail(f"{type(error).__name__}: {one_line(error)}") from error


def _impossible(machine: Machine) -> str:
    """Return what no machine can have; a cable without strength or diameter is only measured."""
    figures = {
        "the platform's mass": machine.robot.platform.mass_kg,
        "the cable's mass per length": machine.cable.linear_density_kg_per_m,
        "the cable's stiffness": machine.cable.axial_stiffness_N,
        "the cable's allowable tension": machine.cable.allowable_tension_N,
    }
    for name, value in figures.items():
        if not value > 0.0:
            asks = " (does it ask for measurements.cable.diameter?)" if np.isnan(value) else ""
            return f"it makes {name} {value:g}{asks}"
    return ""


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
