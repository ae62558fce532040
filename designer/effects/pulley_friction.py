"""Friction between winch and platform."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from designer.effects.effect import Effect, Parameter, Readings, Size, Values
from designer.model.measured_data import Measured
from designer.units import NUMBER

_SIZE = Size(5e-3, bounds=(0.0, 1.0), plausible=(0.0, 0.3))


def _change(readings: Readings, values: Values, measured: Measured) -> Readings:
    # The direction is that of the predicted lengths, since measured ones may be missing.
    change = np.diff(readings.length_m, axis=0, prepend=readings.length_m[:1])
    ratio = np.exp(-values["coefficient"] * np.sign(change))
    return replace(readings, tension_N=readings.tension_N * ratio)


EFFECT = Effect(
    id="pulley_friction",
    summary="friction: the winch feels less while paying out and more while hauling in",
    law="winch-side tension is T exp(-μ s), s = +1 paying out, -1 hauling in",
    source="Euler-Eytelwein",
    parameters=(Parameter("coefficient", NUMBER, _SIZE),),
    on_readings=_change,
    needs=frozenset({"tension"}),
    follows_rows=True,
)
