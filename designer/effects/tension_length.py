"""Lengths that are read wrong in proportion to tension."""

from __future__ import annotations

from dataclasses import replace

from designer.effects.effect import Effect, Parameter, Readings, Size, Values, frame_size_m
from designer.model.machine import Machine
from designer.model.measured_data import Measured
from designer.units import COMPLIANCE


def _change(readings: Readings, values: Values, measured: Measured) -> Readings:
    error = values["compliance_m_per_N"] * readings.tension_N
    return replace(readings, length_m=readings.length_m + error)


def _size(machine: Machine) -> Size:
    """As much as twice the frame's size of further cable would give."""
    largest = 2.0 * frame_size_m(machine) / machine.cable.axial_stiffness_N
    return Size(0.02 * largest, bounds=(-50 * largest, 50 * largest), plausible=(-largest, largest))


EFFECT = Effect(
    id="tension_length",
    summary="lengths are read wrong in proportion to tension: encoder, drum or rope lay",
    law="measured length plus compliance times the tension at the winch",
    source="Feyrer, Wire Ropes, 2015, section 2.4: turn of the lay under tension; Hooke's "
    "law of drum and cable behind the exit point",
    parameters=(Parameter("compliance_m_per_N", COMPLIANCE, _size),),
    on_readings=_change,
    needs=frozenset({"length"}),
)
