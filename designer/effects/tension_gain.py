"""One load cell with a wrong gain."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from designer.effects.effect import Effect, Parameter, Readings, Size, Values
from designer.model.measured_data import Measured
from designer.units import NUMBER

_SIZE = Size(0.02, bounds=(0.02, 50.0), plausible=(0.7, 1.4))
GAIN = Parameter("gain", NUMBER, _SIZE, neutral=1.0, above=0.0)


def _change(readings: Readings, values: Values, measured: Measured, *, cable: int) -> Readings:
    tension = np.array(readings.tension_N)
    tension[:, cable - 1] *= values["gain"]
    return replace(readings, tension_N=tension)


EFFECT = Effect(
    id="tension_gain",
    summary="the load cell of cable {cable} has a wrong gain",
    law="measured tension is gain times the force",
    source="definition",
    parameters=(GAIN,),
    on_readings=_change,
    needs=frozenset({"tension"}),
    takes_cable=True,
)
