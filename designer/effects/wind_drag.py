"""Wind on the platform."""

from __future__ import annotations

from dataclasses import replace

from designer.effects.effect import Effect, Parameter, Values
from designer.effects.kind import EffectKind
from designer.effects.names import EffectName, ParameterName
from designer.model.machine import Machine
from designer.units import AREA


def _change(machine: Machine, values: Values) -> Machine:
    return replace(machine, drag_area_m2=values["drag_area_m2"])


def build(machine: Machine) -> list[Effect]:
    """Return the effect."""
    # The area on which a wind of 10 m/s pulls with a hundredth of the weight.
    area = machine.robot.weight_N / 6000.0
    return [
        Effect(
            id="wind_drag",
            summary="the wind pushes the platform",
            law="force ½ ρ |v| v C_d A with ρ = 1.225 kg/m³",
            source="ISO 2533 (air density); definition of the drag area",
            parameters=(
                Parameter("drag_area_m2", "m²", 0.0, area, (0.0, 1e4 * area), (0.0, 100 * area)),
            ),
            on_machine=_change,
            needs=frozenset({"wind"}),
        )
    ]


KIND = EffectKind(EffectName("wind_drag", (ParameterName("drag_area_m2", AREA),)), build)
