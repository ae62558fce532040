"""A cable heavier or lighter than declared: water, grease, ice."""

from __future__ import annotations

from dataclasses import replace

from designer.effects.effect import Effect, Parameter, Size, Values
from designer.model.machine import Machine
from designer.units import NUMBER

_SIZE = Size(0.05, bounds=(0.02, 50.0), plausible=(0.8, 2.5))


def _change(machine: Machine, values: Values) -> Machine:
    density = machine.cable.linear_density_kg_per_m * values["scale"]
    return replace(machine, cable=replace(machine.cable, linear_density_kg_per_m=density))


EFFECT = Effect(
    id="linear_mass",
    summary="the cable is heavier or lighter than declared",
    law="mass per length is scale times the declared one",
    source="definition",
    parameters=(Parameter("scale", NUMBER, _SIZE, neutral=1.0, above=0.0),),
    on_machine=_change,
    reaches_design=True,
    of_rope=True,
)
