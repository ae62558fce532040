"""Swivelling pulleys at the exit points."""

from __future__ import annotations

from dataclasses import replace

from designer.effects.effect import Effect, Parameter, Size, Values
from designer.model.machine import Machine
from designer.units import LENGTH

_SIZE = Size(0.02, bounds=(0.0, 2.0), plausible=(0.005, 0.6))


def _change(machine: Machine, values: Values) -> Machine:
    return replace(machine, robot=replace(machine.robot, pulley_radius_m=values["radius_m"]))


EFFECT = Effect(
    id="pulley_radius",
    summary="the cables run over pulleys instead of leaving from a point",
    law="tangent point and wrapped length of a swivelling pulley of this radius",
    source="Pott, Cable-Driven Parallel Robots, 2018, section 4.4",
    parameters=(Parameter("radius_m", LENGTH, _SIZE, at_least=0.0),),
    on_machine=_change,
    reaches_design=True,
)
