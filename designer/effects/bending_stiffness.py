"""A cable stiff enough in bending to straighten its ends."""

from __future__ import annotations

import math
from dataclasses import replace

from designer.effects.effect import Effect, Parameter, Values
from designer.effects.kind import EffectKind
from designer.effects.names import EffectName, ParameterName
from designer.model.machine import Machine
from designer.units import FLEXURAL_RIGIDITY

_LIGHTEST_KG_PER_M3 = 1000.0


def _change(machine: Machine, values: Values) -> Machine:
    return replace(machine, flexural_rigidity_N_m2=values["flexural_rigidity_N_m2"])


def build(machine: Machine) -> list[Effect]:
    """Return the effect."""
    cable = machine.cable
    # That of a solid bar, EA · A/(4π), of the lightest material: no rope is stiffer.
    area_m2 = cable.linear_density_kg_per_m / _LIGHTEST_KG_PER_M3
    stiffest = cable.axial_stiffness_N * area_m2 / (4.0 * math.pi)
    rigidity = Parameter("flexural_rigidity_N_m2", "N·m²", 0.0, 10.0, (0.0, 1e6), (0.0, stiffest))
    return [
        Effect(
            id="bending_stiffness",
            summary="the cable resists bending, so its ends sag less",
            law="boundary layers of length √(EI/T) at both ends, clamped along the chord",
            source="Irvine, Cable Structures, 1981, section 2.5",
            parameters=(rigidity,),
            on_machine=_change,
        )
    ]


KIND = EffectKind(
    EffectName(
        "bending_stiffness",
        (ParameterName("flexural_rigidity_N_m2", FLEXURAL_RIGIDITY, at_least=0.0),),
    ),
    build,
)
