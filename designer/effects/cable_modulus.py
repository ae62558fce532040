"""One cable that is softer or stiffer than the others."""

from __future__ import annotations

from dataclasses import replace

from designer.effects.effect import Effect, Parameter, Size, Values, of_one
from designer.model.machine import Machine
from designer.units import NUMBER

_SIZE = Size(0.05, bounds=(0.02, 50.0), plausible=(0.2, 2.0))


def _change(machine: Machine, values: Values, *, cable: int) -> Machine:
    shares = of_one(machine, machine.relative_stiffness, cable, values["scale"])
    return replace(machine, relative_stiffness=shares)


EFFECT = Effect(
    id="cable_modulus",
    summary="cable {cable} is not as stiff as the others",
    law="EA of this cable is scale times that of the others",
    source="Hooke's law",
    parameters=(Parameter("scale", NUMBER, _SIZE, neutral=1.0, above=0.0),),
    on_machine=_change,
    takes_cable=True,
    of_rope=True,
)
