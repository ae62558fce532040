"""One winch with a wrong scale: its drum, its gear or its mechanical advantage."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from designer.effects.effect import Effect, Parameter, Readings, Size, Values
from designer.effects.winch_zero import ZERO
from designer.model.measured_data import Measured
from designer.units import NUMBER

_SCALE = Size(1e-3, bounds=(0.05, 20.0), plausible=(0.2, 5.0))
_ADVANTAGES = (1.001, 2.0, 0.5)
"""Just off, or with a part of the tackle too many or too few."""


def _change(readings: Readings, values: Values, measured: Measured, *, cable: int) -> Readings:
    length = np.array(readings.length_m)
    length[:, cable - 1] *= values["scale"]
    length[:, cable - 1] += values.get("offset_m", 0.0)
    return replace(readings, length_m=length)


EFFECT = Effect(
    id="winch_scale",
    summary="the winch of cable {cable} has a wrong scale",
    law="measured length is scale times the true one, plus an offset: right where it was homed",
    source="definition",
    parameters=(
        Parameter("scale", NUMBER, _SCALE, neutral=1.0, above=0.0),
        ZERO,
    ),
    on_readings=_change,
    cause="setting_up",
    needs=frozenset({"length"}),
    takes_cable=True,
    starts=tuple({"scale": scale} for scale in _ADVANTAGES),
)
