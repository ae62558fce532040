"""Swivelling pulleys at the exit points."""

from __future__ import annotations

from dataclasses import replace

from designer.effects.effect import Effect, Parameter, Values
from designer.effects.kind import EffectKind
from designer.effects.names import EffectName, ParameterName
from designer.model.machine import Machine
from designer.units import LENGTH


def _change(machine: Machine, values: Values) -> Machine:
    return replace(machine, robot=replace(machine.robot, pulley_radius_m=values["radius_m"]))


def build(machine: Machine) -> list[Effect]:
    """Return the effect."""
    radius = Parameter("radius_m", "m", 0.0, 0.02, (0.0, 2.0), (0.005, 0.6))
    return [
        Effect(
            id="pulley_radius",
            summary="the cables run over pulleys instead of leaving from a point",
            law="tangent point and wrapped length of a swivelling pulley of this radius",
            source="Pott, Cable-Driven Parallel Robots, 2018, section 4.4",
            parameters=(radius,),
            on_machine=_change,
            reaches_design=True,
        )
    ]


KIND = EffectKind(
    EffectName("pulley_radius", (ParameterName("radius_m", LENGTH, at_least=0.0),)), build
)
