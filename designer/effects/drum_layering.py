"""Drums that grow as cable is wound onto them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from designer.effects.effect import Effect, Parameter, Readings, Values
from designer.machine import Machine
from designer.measured.data import Measured


def _change(readings: Readings, values: Values, measured: Measured) -> Readings:
    gain = values["radius_gain_per_m"]
    # The scale is right at the longest length of each cable; shorter, the drum is thicker and a
    # turn pays out more than the winch counts.
    full = np.nanmax(readings.length_m, axis=0)
    wound = full - readings.length_m
    counted = np.log1p(gain * wound) / gain if abs(gain) > 1e-12 else wound
    return replace(readings, length_m=full - counted)


def build(machine: Machine) -> list[Effect]:
    """Return the effect."""
    return [
        Effect(
            id="drum_layering",
            summary="the drums grow as cable is wound onto them",
            law="radius times 1 + gain · wound length, wound from the longest length",
            source="definition",
            parameters=(
                Parameter("radius_gain_per_m", "1/m", 0.0, 2e-4, (-0.05, 0.05), (0.0, 0.02)),
            ),
            on_readings=_change,
            needs=frozenset({"length"}),
        )
    ]
