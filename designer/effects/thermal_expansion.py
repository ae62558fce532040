"""Cables, and winches, that grow with temperature."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from designer.arrays import FloatArray
from designer.effects.effect import Effect, Parameter, Readings, Size, Values
from designer.model.machine import Machine
from designer.model.measured_data import Measured
from designer.units import PER_TEMPERATURE

_METAL_KG_PER_M3 = 2500.0
"""Ropes of metal weigh at least 3500, of fibre at most 1500, over the circle of their diameter."""


def _growth(values: Values, measured: Measured) -> FloatArray:
    assert measured.temperature_C is not None
    growth = 1.0 + values["coefficient_per_K"] * (measured.temperature_C - 20.0)
    return np.asarray(growth[:, None])


def _change(readings: Readings, values: Values, measured: Measured) -> Readings:
    # The winch pays out length at 20 °C; what hangs is longer by the growth.
    return replace(readings, length_m=readings.length_m / _growth(values, measured))


def _change_of_winches(readings: Readings, values: Values, measured: Measured) -> Readings:
    return replace(readings, length_m=readings.length_m * _growth(values, measured))


def _size(machine: Machine) -> Size:
    """Fibre may shrink; metal grows, in the sun by more than the air's temperature tells."""
    is_metal = machine.rope_density_kg_per_m3 > _METAL_KG_PER_M3
    return Size(1e-5, (-1e-3, 1e-3), plausible=(0.0, 5e-5) if is_metal else (-5e-5, 2e-4))


EFFECT = Effect(
    id="thermal_expansion",
    summary="the cables grow with temperature",
    law="unstrained length times 1 + α (T - 20 °C)",
    source="definition; steel 12.5e-6 /K, aramid -2e-6 /K, HMPE -12e-6 /K along the fibre",
    parameters=(Parameter("coefficient_per_K", PER_TEMPERATURE, _size),),
    on_readings=_change,
    needs=frozenset({"temperature", "length"}),
)
WINCH = replace(
    EFFECT,
    id="winch_expansion",
    summary="the winches' readings change with temperature, as where the drums grow",
    law="true length times 1 + α (T - 20 °C); α of a drum that grows and counts its turns is minus "
    "its own expansion",
    source="definition; steel 12e-6 /K, aluminium 23e-6 /K",
    parameters=(
        Parameter(
            "coefficient_per_K", PER_TEMPERATURE, Size(1e-5, (-1e-3, 1e-3), plausible=(-5e-5, 5e-5))
        ),
    ),
    on_readings=_change_of_winches,
)
