"""Drums that grow as cable is wound onto them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from designer.arrays import FloatArray
from designer.effects.effect import Effect, Parameter, Readings, Values
from designer.effects.kind import EffectKind
from designer.effects.names import EffectName, ParameterName
from designer.model.machine import Machine
from designer.model.measured_data import Measured
from designer.units import LENGTH, PER_LENGTH


def _change(readings: Readings, values: Values, measured: Measured) -> Readings:
    gain = values["radius_gain_per_m"]
    n = readings.length_m.shape[1]
    reference = np.array([values[f"reference_{k}_m"] for k in range(1, n + 1)])
    return replace(readings, length_m=_counted(readings.length_m, gain, reference))


def _counted(length_m: FloatArray, gain: float, reference_m: FloatArray) -> FloatArray:
    """Return what a winch counts that is right at a reference length.

    A turn pays out 1 + gain · (reference - length) times what is counted, so the counted length
    is the integral of its inverse.
    """
    wound = reference_m - length_m
    if abs(gain) < 1e-12:
        return length_m
    return np.asarray(reference_m - np.log(np.maximum(1.0 + gain * wound, 1e-6)) / gain)


def build(machine: Machine) -> list[Effect]:
    """Return the effect; where each winch's scale is right is fitted with it."""
    exits = machine.robot.exit_points_m
    size = float(np.ptp(exits, axis=0).max())
    gain = Parameter("radius_gain_per_m", "1/m", 0.0, 1e-2 / size, (0.0, 0.9 / size), (0.0, 0.02))
    # A tiny gain about a reference far off would be a wrong scale of each winch, not layering.
    references = tuple(
        Parameter(f"reference_{k}_m", "m", 0.0, 0.1 * size, (0.0, 2 * size), (0.0, 2 * size))
        for k in range(1, machine.robot.n_cables + 1)
    )
    return [
        Effect(
            id="drum_layering",
            summary="the drums grow as cable is wound onto them",
            law="drum radius times 1 + gain · length wound on since the reference length",
            source="definition",
            parameters=(gain, *references),
            on_readings=_change,
            needs=frozenset({"length"}),
        )
    ]


KIND = EffectKind(
    EffectName(
        "drum_layering",
        (
            ParameterName("radius_gain_per_m", PER_LENGTH),
            ParameterName("reference_{cable}_m", LENGTH, neutral=0.0),
        ),
    ),
    build,
)
