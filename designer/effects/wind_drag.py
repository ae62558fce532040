"""Wind on the platform."""

from __future__ import annotations

from dataclasses import replace

from designer.effects.effect import Effect, Parameter, Size, Values
from designer.model.load_case import AIR_DENSITY_KG_PER_M3
from designer.model.machine import Machine
from designer.units import AREA


def _change(machine: Machine, values: Values) -> Machine:
    return replace(machine, drag_area_m2=values["drag_area_m2"])


def _size(machine: Machine) -> Size:
    """Typical is the area on which a wind of 10 m/s pulls with a hundredth of the weight."""
    area = machine.robot.weight_N / 6000.0
    return Size(area, bounds=(0.0, 1e4 * area), plausible=(0.0, 100 * area))


EFFECT = Effect(
    id="wind_drag",
    summary="the wind pushes the platform",
    law=f"force ½ ρ |v| v C_d A with ρ = {AIR_DENSITY_KG_PER_M3:g} kg/m³",
    source="EN 1991-1-4, 4.5 (air density); definition of the drag area",
    parameters=(Parameter("drag_area_m2", AREA, _size),),
    on_machine=_change,
    needs=frozenset({"wind"}),
)
