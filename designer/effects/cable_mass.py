"""One cable that is heavier or lighter than the others."""

from __future__ import annotations

from dataclasses import replace

from designer.effects.effect import Effect, Parameter, Size, Values, of_one
from designer.model.machine import Machine
from designer.units import NUMBER

_SIZE = Size(0.05, bounds=(0.02, 50.0), plausible=(0.5, 3.0))


def _change(machine: Machine, values: Values, *, cable: int) -> Machine:
    shares = of_one(machine, machine.relative_mass, cable, values["scale"])
    return replace(machine, relative_mass=shares)


EFFECT = Effect(
    id="cable_mass",
    summary="cable {cable} is not as heavy as the others",
    law="mass per length of this cable is scale times that of the others",
    source="definition",
    parameters=(Parameter("scale", NUMBER, _SIZE, neutral=1.0, above=0.0),),
    on_machine=_change,
    takes_cable=True,
    of_rope=True,
)
