"""A platform heavier or lighter than declared."""

from __future__ import annotations

from dataclasses import replace

from designer.effects.effect import Effect, Parameter, Values
from designer.effects.kind import EffectKind
from designer.effects.names import EffectName, ParameterName
from designer.model.machine import Machine
from designer.units import MASS


def _change(machine: Machine, values: Values) -> Machine:
    platform = machine.robot.platform
    heavier = replace(platform, mass_kg=platform.mass_kg + values["offset_kg"])
    return replace(machine, robot=replace(machine.robot, platform=heavier))


def build(machine: Machine) -> list[Effect]:
    """Return the effect."""
    mass = machine.robot.platform.mass_kg
    offset = Parameter(
        "offset_kg", "kg", 0.0, 0.01 * mass, (-0.9 * mass, 10.0 * mass), (-0.3 * mass, 0.5 * mass)
    )
    return [
        Effect(
            id="platform_mass",
            summary="the platform with its payload is heavier or lighter than declared",
            law="mass plus offset",
            source="definition",
            parameters=(offset,),
            on_machine=_change,
            reaches_design=True,
        )
    ]


KIND = EffectKind(EffectName("platform_mass", (ParameterName("offset_kg", MASS),)), build)
