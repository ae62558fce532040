"""Masts that give way to the pull of their cables."""

from __future__ import annotations

import numpy as np

from designer.effects.effect import Effect, Parameter, Readings, Size, Values, frame_size_m, pull_of
from designer.effects.rebalancing import rebalancing_N
from designer.model.machine import Machine
from designer.model.measured_data import Measured
from designer.statics.geometry import cable_geometry, plane_vector
from designer.units import COMPLIANCE


def _change(
    readings: Readings, values: Values, measured: Measured, *, machine: Machine
) -> Readings:
    pull = pull_of(machine, measured, readings.tension_N)
    moved = values["compliance_m_per_N"] * pull.horizontal_N
    # The exit point moves along the level pull: the way is shorter by its share along the cable.
    share = pull.horizontal_N / np.maximum(readings.tension_N, 1e-9)
    outward = cable_geometry(machine.robot, measured.poses).outward
    moves = plane_vector(moved, np.zeros_like(moved), outward)
    more_N = rebalancing_N(machine.robot, measured.poses, readings.tension_N, moves)
    return Readings(readings.length_m - moved * share, readings.tension_N + more_N)


def _size(machine: Machine) -> Size:
    """A mast gives way by 2 % of the frame at most under the platform's weight."""
    largest = 0.02 * frame_size_m(machine) / machine.robot.weight_N
    return Size(0.02 * largest, bounds=(0.0, 50 * largest), plausible=(0.0, largest))


EFFECT = Effect(
    id="mast_compliance",
    summary="the masts bend: exit points move with the pull of their cables",
    law="exit point plus compliance times the horizontal force of its cable",
    source="cantilever, H³/(3 EI): Timoshenko, Strength of Materials I, 1955, section 39",
    parameters=(Parameter("compliance_m_per_N", COMPLIANCE, _size, at_least=0.0),),
    on_readings=_change,
    takes_machine=True,
)
