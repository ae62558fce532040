"""Swivelling pulleys at the exit points."""

from __future__ import annotations

from dataclasses import replace

from designer.effects.effect import Effect, Parameter, Size, Values, frame_size_m
from designer.model.machine import Machine
from designer.units import LENGTH


def _radius(machine: Machine) -> Size:
    """Small machines have small pulleys: a two-thousandth of the frame is plausible."""
    least = min(0.005, 5e-4 * frame_size_m(machine))
    return Size(0.02, bounds=(0.0, 2.0), plausible=(least, 0.6))


def _change(machine: Machine, values: Values) -> Machine:
    return replace(machine, robot=replace(machine.robot, pulley_radius_m=values["radius_m"]))


EFFECT = Effect(
    id="pulley_radius",
    summary="the cables run over pulleys instead of leaving from a point",
    law="tangent point and wrapped length of a swivelling pulley of this radius",
    source="Pott, Cable-Driven Parallel Robots, 2018, section 4.4",
    parameters=(Parameter("radius_m", LENGTH, _radius, at_least=0.0),),
    on_machine=_change,
    reaches_design=True,
)
