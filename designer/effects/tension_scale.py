"""All load cells with one wrong gain: a unit, an amplifier, a calibration that they share."""

from __future__ import annotations

from dataclasses import replace

from designer.effects.effect import Effect, Parameter, Readings, Size, Values
from designer.model.measured_data import Measured
from designer.units import NUMBER

_SIZE = Size(0.02, bounds=(0.02, 50.0), plausible=(0.7, 1.4))


def _change(readings: Readings, values: Values, measured: Measured) -> Readings:
    return replace(readings, tension_N=readings.tension_N * values["gain"])


EFFECT = Effect(
    id="tension_scale",
    summary="the load cells have one wrong gain in common",
    law="measured tensions are gain times the forces",
    source="definition",
    parameters=(Parameter("gain", NUMBER, _SIZE, neutral=1.0, above=0.0),),
    on_readings=_change,
    needs=frozenset({"tension"}),
)
