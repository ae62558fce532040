"""A cable stiff enough in bending to straighten its ends."""

from __future__ import annotations

import math
from dataclasses import replace

from designer.effects.effect import Effect, Parameter, Size, Values
from designer.model.machine import Machine
from designer.units import FLEXURAL_RIGIDITY


def _change(machine: Machine, values: Values) -> Machine:
    return replace(machine, flexural_rigidity_N_m2=values["flexural_rigidity_N_m2"])


def _size(machine: Machine) -> Size:
    """No rope is stiffer than a solid bar, EA · A/(4π), of the lightest material, 1000 kg/m³."""
    cable = machine.cable
    area_m2 = cable.mean_density_kg_per_m / 1000.0
    stiffest = cable.axial_stiffness_N * area_m2 / (4.0 * math.pi)
    return Size(10.0, bounds=(0.0, 1e6), plausible=(0.0, stiffest))


EFFECT = Effect(
    id="bending_stiffness",
    summary="the cable resists bending, so its ends sag less",
    law="boundary layers of length √(EI/T) at both ends, clamped along the chord",
    source="Irvine, Cable Structures, 1981, section 2.5",
    parameters=(Parameter("flexural_rigidity_N_m2", FLEXURAL_RIGIDITY, _size, at_least=0.0),),
    on_machine=_change,
)
