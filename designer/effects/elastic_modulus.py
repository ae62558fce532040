"""A cable softer or stiffer than declared."""

from __future__ import annotations

from dataclasses import replace

from designer.effects.effect import Effect, Parameter, Values
from designer.effects.kind import EffectKind
from designer.effects.names import EffectName, ParameterName
from designer.model.machine import Machine
from designer.units import NUMBER


def _change(machine: Machine, values: Values) -> Machine:
    cable = machine.cable
    changed = replace(cable, axial_stiffness_N=cable.axial_stiffness_N * values["scale"])
    return replace(machine, cable=changed)


def build(machine: Machine) -> list[Effect]:
    """Return the effect."""
    scale = Parameter("scale", "", 1.0, 0.05, (0.02, 50.0), (0.2, 5.0))
    return [
        Effect(
            id="elastic_modulus",
            summary="the cable is softer or stiffer than declared",
            law="EA is scale times the declared one",
            source="Feyrer, Wire Ropes, 2015, section 2.3: rope moduli scatter, and rise with use",
            parameters=(scale,),
            on_machine=_change,
            reaches_design=True,
        )
    ]


KIND = EffectKind(
    EffectName("elastic_modulus", (ParameterName("scale", NUMBER, above=0.0),)), build
)
