"""One cable that grows with time under load, such as a new one among old ones."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from designer.effects import creep
from designer.effects.effect import Readings, Values
from designer.model.measured_data import Measured


def _change(readings: Readings, values: Values, measured: Measured, *, cable: int) -> Readings:
    length = np.array(readings.length_m)
    length[:, cable - 1] /= creep.growth(values, measured)
    return replace(readings, length_m=length)


EFFECT = replace(
    creep.EFFECT,
    id="cable_creep",
    summary="cable {cable} grows with time",
    law="unstrained length of this cable times 1 + c log10(1 + t/t0)",
    on_readings=_change,
    takes_cable=True,
)
