"""A cable heavier or lighter than declared: water, grease, ice."""

from __future__ import annotations

from dataclasses import replace

from designer.effects.effect import Effect, Parameter, Values
from designer.effects.kind import EffectKind
from designer.effects.names import EffectName, ParameterName
from designer.model.machine import Machine
from designer.units import NUMBER


def _change(machine: Machine, values: Values) -> Machine:
    cable = machine.cable
    changed = replace(
        cable, linear_density_kg_per_m=cable.linear_density_kg_per_m * values["scale"]
    )
    return replace(machine, cable=changed)


def build(machine: Machine) -> list[Effect]:
    """Return the effect."""
    scale = Parameter("scale", "", 1.0, 0.05, (0.02, 50.0), (0.8, 2.5))
    return [
        Effect(
            id="linear_mass",
            summary="the cable is heavier or lighter than declared",
            law="mass per length is scale times the declared one",
            source="definition",
            parameters=(scale,),
            on_machine=_change,
            reaches_design=True,
        )
    ]


KIND = EffectKind(EffectName("linear_mass", (ParameterName("scale", NUMBER, above=0.0),)), build)
