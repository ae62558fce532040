"""A platform heavier or lighter than declared."""

from __future__ import annotations

from dataclasses import replace

from designer.effects.effect import Effect, Parameter, Size, Values
from designer.model.machine import Machine
from designer.units import MASS


def _change(machine: Machine, values: Values) -> Machine:
    platform = machine.robot.platform
    offset = values["offset_kg"]
    heavier = replace(platform, mass_kg=platform.mass_kg + offset, mass_offset_kg=offset)
    return replace(machine, robot=replace(machine.robot, platform=heavier))


def _size(machine: Machine) -> Size:
    mass = machine.robot.platform.mass_kg
    return Size(0.01 * mass, bounds=(-0.9 * mass, 10.0 * mass), plausible=(-0.3 * mass, 0.5 * mass))


EFFECT = Effect(
    id="platform_mass",
    summary="the platform with its payload is heavier or lighter than declared",
    law="mass plus offset",
    source="definition",
    parameters=(Parameter("offset_kg", MASS, _size),),
    on_machine=_change,
    reaches_design=True,
)
