"""Lengths that are read wrong in proportion to tension."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from designer.effects.effect import Effect, Parameter, Readings, Values
from designer.effects.kind import EffectKind
from designer.effects.names import EffectName, ParameterName
from designer.model.machine import Machine
from designer.model.measured_data import Measured
from designer.units import COMPLIANCE


def _change(readings: Readings, values: Values, measured: Measured) -> Readings:
    error = values["compliance_m_per_N"] * readings.tension_N
    return replace(readings, length_m=readings.length_m + error)


def build(machine: Machine) -> list[Effect]:
    """Return the effect; as much as twice the frame's size of further cable would give."""
    size = float(np.ptp(machine.robot.exit_points_m, axis=0).max())
    most = 2.0 * size / machine.cable.axial_stiffness_N
    compliance = Parameter(
        "compliance_m_per_N", "m/N", 0.0, 0.02 * most, (-50 * most, 50 * most), (-most, most)
    )
    return [
        Effect(
            id="tension_length",
            summary="lengths are read wrong in proportion to tension: encoder, drum or rope lay",
            law="measured length plus compliance times the tension at the winch",
            source="Feyrer, Wire Ropes, 2015, section 2.4: turn of the lay under tension; Hooke's "
            "law of drum and cable behind the exit point",
            parameters=(compliance,),
            on_readings=_change,
            needs=frozenset({"length"}),
        )
    ]


KIND = EffectKind(
    EffectName("tension_length", (ParameterName("compliance_m_per_N", COMPLIANCE),)), build
)
