"""Masts that give way to the pull of their cables."""

from __future__ import annotations

import numpy as np

from designer.arrays import FloatArray
from designer.effects.effect import Effect, Parameter, Readings, Size, Values, frame_size_m, pull_of
from designer.model.machine import Machine
from designer.model.measured_data import Measured
from designer.model.robot import Poses, Robot
from designer.statics.geometry import (
    cable_geometry,
    density_matrix,
    plane_vector,
    upright_exit_points_m,
)
from designer.units import COMPLIANCE

_NOTHING = 1e-12
"""Of the trace of a Gram matrix: lets it be solved where cables leave a direction free."""


def _change(
    readings: Readings, values: Values, measured: Measured, *, machine: Machine
) -> Readings:
    pull = pull_of(machine, measured, readings.tension_N)
    moved = values["compliance_m_per_N"] * pull.horizontal_N
    # The exit point moves along the level pull: the way is shorter by its share along the cable.
    share = pull.horizontal_N / np.maximum(readings.tension_N, 1e-9)
    more_N = _rebalancing_N(machine.robot, measured.poses, readings.tension_N, moved)
    return Readings(readings.length_m - moved * share, readings.tension_N + more_N)


def _rebalancing_N(
    robot: Robot, poses: Poses, tension_N: FloatArray, moved_m: FloatArray
) -> FloatArray:
    """Return by how much tensions change where cables turn as their exit points move.

    The least change that keeps the balance of straight cables, to first order.
    """
    geometry = cable_geometry(robot, poses)
    moves = plane_vector(moved_m, np.zeros_like(moved_m), geometry.outward)
    moved = cable_geometry(robot, poses, upright_exit_points_m(robot) + moves)
    before, after = (
        density_matrix(robot, way) / way.chord_m[..., None, :] for way in (geometry, moved)
    )
    lost = (after - before) @ np.nan_to_num(tension_N)[..., None]
    gram = before @ np.swapaxes(before, -1, -2)
    ridge = _NOTHING * np.trace(gram, axis1=1, axis2=2)[:, None, None] * np.eye(gram.shape[-1])
    share = np.linalg.solve(gram + ridge, lost)
    return np.asarray(-(np.swapaxes(before, -1, -2) @ share)[..., 0])


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
