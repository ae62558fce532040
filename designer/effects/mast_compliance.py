"""Masts that give way to the pull of their cables."""

from __future__ import annotations

import numpy as np

from designer.arrays import FloatArray
from designer.effects.along import pull_of
from designer.effects.effect import Effect, Parameter, Readings, Size, Values, frame_size_m
from designer.model.machine import Machine
from designer.model.measured_data import Measured
from designer.model.robot import Robot
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
    more_N = _rebalancing_N(machine.robot, measured, readings.tension_N, moved)
    return Readings(readings.length_m - moved * share, readings.tension_N + more_N)


def _rebalancing_N(
    robot: Robot, measured: Measured, tension_N: FloatArray, moved_m: FloatArray
) -> FloatArray:
    """Return by how much tensions change where cables turn as their exit points move.

    The least change that keeps the balance of straight cables, to first order.
    """
    chord = (measured.poses.attachment_points_m(robot) - robot.exit_points_m) @ robot.upright.T
    level = chord * [1.0, 1.0, 0.0]
    level = level / np.maximum(np.linalg.norm(level, axis=-1, keepdims=True), 1e-9)
    lever = measured.poses.attachment_points_m(robot) - measured.poses.position_m[:, None]
    before, after = _direction(chord), _direction(chord - moved_m[..., None] * level)
    wrench = _wrench(after - before, lever @ robot.upright.T, robot)
    balance = _wrench(before, lever @ robot.upright.T, robot)
    lost = np.einsum("rcw,rc->rw", wrench, np.nan_to_num(tension_N))
    gram = np.einsum("rcv,rcw->rvw", balance, balance)
    ridge = _NOTHING * np.trace(gram, axis1=1, axis2=2)[:, None, None] * np.eye(gram.shape[-1])
    share = np.linalg.solve(gram + ridge, lost[..., None])[..., 0]
    return np.asarray(-np.einsum("rcw,rw->rc", balance, share))


def _direction(chord: FloatArray) -> FloatArray:
    return np.asarray(-chord / np.linalg.norm(chord, axis=-1, keepdims=True))


def _wrench(force: FloatArray, lever: FloatArray, robot: Robot) -> FloatArray:
    """Return force and moment of each cable (n_rows, n_cables, 3 or 6)."""
    if robot.is_point_mass:
        return force
    return np.concatenate([force, np.cross(lever, force)], axis=-1)


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
