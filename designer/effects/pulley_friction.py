"""Friction between winch and platform."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from designer.effects.effect import Effect, Parameter, Readings, Values
from designer.effects.kind import EffectKind
from designer.effects.names import EffectName, ParameterName
from designer.model.machine import Machine
from designer.model.measured_data import Measured
from designer.units import NUMBER


def _change(readings: Readings, values: Values, measured: Measured) -> Readings:
    # The direction is that of the predicted lengths, since measured ones may be missing.
    change = np.diff(readings.length_m, axis=0, prepend=readings.length_m[:1])
    return replace(
        readings, tension_N=readings.tension_N * np.exp(-values["coefficient"] * np.sign(change))
    )


def build(machine: Machine) -> list[Effect]:
    """Return the effect."""
    return [
        Effect(
            id="pulley_friction",
            summary="friction: the winch feels less while paying out and more while hauling in",
            law="winch-side tension is T exp(-μ s), s = +1 paying out, -1 hauling in",
            source="Euler-Eytelwein",
            parameters=(Parameter("coefficient", "", 0.0, 5e-3, (0.0, 1.0), (0.0, 0.3)),),
            on_readings=_change,
            needs=frozenset({"tension"}),
        )
    ]


KIND = EffectKind(EffectName("pulley_friction", (ParameterName("coefficient", NUMBER),)), build)
