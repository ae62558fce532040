"""Drums that grow as cable is wound onto them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from designer.effects.effect import (
    Effect,
    Parameter,
    Readings,
    Size,
    Values,
    frame_size_m,
    per_cable,
)
from designer.model.machine import Machine
from designer.model.measured_data import Measured
from designer.units import LENGTH, PER_LENGTH


def _change(readings: Readings, values: Values, measured: Measured) -> Readings:
    """Return what winches count that are right at a reference length.

    A turn pays out 1 + gain · (reference - length) times what is counted, so the counted length
    is the integral of its inverse.
    """
    gain = values["radius_gain_per_m"]
    if abs(gain) < 1e-12:
        return readings
    reference_m = per_cable(values, "reference_{cable}_m", readings.length_m.shape[1])
    paid_out = np.maximum(1.0 + gain * (reference_m - readings.length_m), 1e-6)
    return replace(readings, length_m=reference_m - np.log(paid_out) / gain)


def _gain(machine: Machine) -> Size:
    """Small machines have thin lines on small spools: a fifth more over the frame is plausible."""
    size = frame_size_m(machine)
    return Size(1e-2 / size, bounds=(0.0, 0.9 / size), plausible=(0.0, max(0.02, 0.2 / size)))


def _reference(machine: Machine) -> Size:
    """A tiny gain about a reference far off would be a wrong scale of each winch, not layering.

    Fits start at a tenth of the typical size: among the lengths, since from far off they end at no
    gain at all.
    """
    size = frame_size_m(machine)
    return Size(5.0 * size, bounds=(0.0, 2 * size), plausible=(0.0, 2 * size))


EFFECT = Effect(
    id="drum_layering",
    summary="the drums grow as cable is wound onto them",
    law="drum radius times 1 + gain · length wound on since the reference length",
    source="definition",
    parameters=(
        Parameter("radius_gain_per_m", PER_LENGTH, _gain),
        Parameter("reference_{cable}_m", LENGTH, _reference, is_optional=True, is_shape=True),
    ),
    on_readings=_change,
    needs=frozenset({"length"}),
)
