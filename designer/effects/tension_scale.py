"""All load cells with one wrong gain: a unit, an amplifier, a calibration that they share."""

from __future__ import annotations

from dataclasses import replace

from designer.effects.effect import Effect, Readings, Values
from designer.effects.tension_gain import GAIN
from designer.model.measured_data import Measured


def _change(readings: Readings, values: Values, measured: Measured) -> Readings:
    return replace(readings, tension_N=readings.tension_N * values["gain"])


EFFECT = Effect(
    id="tension_scale",
    summary="the load cells have one wrong gain in common",
    law="measured tensions are gain times the forces",
    source="definition",
    parameters=(GAIN,),
    on_readings=_change,
    needs=frozenset({"tension"}),
)
