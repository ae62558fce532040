"""Cables that grow with time under load."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from designer.effects.effect import Effect, Parameter, Readings, Values
from designer.effects.kind import EffectKind
from designer.effects.names import EffectName, ParameterName
from designer.model.machine import Machine
from designer.model.measured_data import Measured
from designer.units import NUMBER, TIME


def _change(readings: Readings, values: Values, measured: Measured) -> Readings:
    assert measured.time_s is not None
    decades = np.log10(1.0 + np.maximum(measured.time_s, 0.0) / values["onset_s"])
    growth = 1.0 + values["strain_per_decade"] * decades
    return replace(readings, length_m=readings.length_m / growth[:, None])


def build(machine: Machine) -> list[Effect]:
    """Return the effect."""
    return [
        Effect(
            id="creep",
            summary="the cables grow with time",
            law="unstrained length times 1 + c log10(1 + t/t0)",
            source="McKenna, Hearle and O'Hear, Handbook of Fibre Rope Technology, 2004",
            parameters=(
                Parameter("strain_per_decade", "", 0.0, 1e-4, (-0.05, 0.05), (0.0, 0.01)),
                Parameter("onset_s", "s", 100.0, 50.0, (0.1, 1e7), (1.0, 1e6)),
            ),
            on_readings=_change,
            needs=frozenset({"time", "length"}),
            starts=tuple({"strain_per_decade": 1e-4, "onset_s": t} for t in (5.0, 100.0, 2000.0)),
        )
    ]


KIND = EffectKind(
    EffectName(
        "creep",
        (
            ParameterName("strain_per_decade", NUMBER),
            ParameterName("onset_s", TIME, above=0.0),
        ),
    ),
    build,
)
