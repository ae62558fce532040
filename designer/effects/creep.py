"""Cables that grow with time under load: all, or one, such as a new one among old ones."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from designer.arrays import FloatArray
from designer.effects.effect import Effect, Parameter, Readings, Size, Values
from designer.model.measured_data import Measured
from designer.units import NUMBER, TIME

_STRAIN = Size(1e-4, bounds=(-0.05, 0.05), plausible=(0.0, 0.01))
_ONSET = Size(50.0, bounds=(0.1, 1e7), plausible=(1.0, 1e6))


def _growth(values: Values, measured: Measured) -> FloatArray:
    """Return length over length at the start of each row (n_rows,)."""
    assert measured.time_s is not None
    decades = np.log10(1.0 + np.maximum(measured.time_s, 0.0) / values["onset_s"])
    return np.asarray(1.0 + values["strain_per_decade"] * decades)


def _change(readings: Readings, values: Values, measured: Measured) -> Readings:
    return replace(readings, length_m=readings.length_m / _growth(values, measured)[:, None])


def _change_one(readings: Readings, values: Values, measured: Measured, *, cable: int) -> Readings:
    length = np.array(readings.length_m)
    length[:, cable - 1] /= _growth(values, measured)
    return replace(readings, length_m=length)


EFFECT = Effect(
    id="creep",
    summary="the cables grow with time",
    law="unstrained length times 1 + c log10(1 + t/t0)",
    source="McKenna, Hearle and O'Hear, Handbook of Fibre Rope Technology, 2004",
    parameters=(
        Parameter("strain_per_decade", NUMBER, _STRAIN),
        Parameter("onset_s", TIME, _ONSET, neutral=100.0, above=0.0),
    ),
    on_readings=_change,
    needs=frozenset({"time", "length"}),
    starts=tuple({"strain_per_decade": 1e-4, "onset_s": t} for t in (5.0, 100.0, 2000.0)),
)
ONE = replace(
    EFFECT,
    id="cable_creep",
    summary="cable {cable} grows with time",
    law="unstrained length of this cable times 1 + c log10(1 + t/t0)",
    on_readings=_change_one,
    takes_cable=True,
)
