"""Cables that grow with temperature."""

from __future__ import annotations

from dataclasses import replace

from designer.effects.effect import Effect, Parameter, Readings, Size, Values
from designer.model.measured_data import Measured
from designer.units import PER_TEMPERATURE

_SIZE = Size(1e-5, bounds=(-1e-3, 1e-3), plausible=(-5e-5, 2e-4))


def _change(readings: Readings, values: Values, measured: Measured) -> Readings:
    assert measured.temperature_C is not None
    growth = 1.0 + values["coefficient_per_K"] * (measured.temperature_C - 20.0)
    # The winch pays out length at 20 °C; what hangs is longer by the growth.
    return replace(readings, length_m=readings.length_m / growth[:, None])


EFFECT = Effect(
    id="thermal_expansion",
    summary="the cables grow with temperature",
    law="unstrained length times 1 + α (T - 20 °C)",
    source="definition; steel 12.5e-6 /K",
    parameters=(Parameter("coefficient_per_K", PER_TEMPERATURE, _SIZE),),
    on_readings=_change,
    needs=frozenset({"temperature", "length"}),
)
