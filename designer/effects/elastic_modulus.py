"""A cable softer or stiffer than declared."""

from __future__ import annotations

from dataclasses import replace

from designer.effects.effect import Effect, Parameter, Size, Values
from designer.model.machine import Machine
from designer.units import NUMBER

_SIZE = Size(0.05, bounds=(0.02, 50.0), plausible=(0.2, 5.0))


def _change(machine: Machine, values: Values) -> Machine:
    stiffness_N = machine.cable.axial_stiffness_N * values["scale"]
    return replace(machine, cable=replace(machine.cable, axial_stiffness_N=stiffness_N))


EFFECT = Effect(
    id="elastic_modulus",
    summary="the cable is softer or stiffer than declared",
    law="EA is scale times the declared one",
    source="Feyrer, Wire Ropes, 2015, section 2.3: rope moduli scatter, and rise with use",
    parameters=(Parameter("scale", NUMBER, _SIZE, neutral=1.0, above=0.0),),
    on_machine=_change,
    reaches_design=True,
    of_rope=True,
)
