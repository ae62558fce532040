"""One pulley that swivels about an axis that is not vertical."""

from __future__ import annotations

import numpy as np

from designer.arrays import FloatArray
from designer.effects.effect import Effect, Parameter, Readings, Size, Values
from designer.effects.rebalancing import rebalancing_N
from designer.model.machine import Machine
from designer.model.measured_data import Measured
from designer.physics import pulley
from designer.statics.geometry import level_geometry, plane_vector
from designer.units import ANGLE

_SIZE = Size(0.02, bounds=(-1.2, 1.2), plausible=(-0.35, 0.35))


def _change(
    readings: Readings, values: Values, measured: Measured, *, machine: Machine, cable: int
) -> Readings:
    """Turn the pulley about its exit point: a straight cable's length and direction change."""
    from scipy.spatial.transform import Rotation

    level = level_geometry(machine.robot, measured.poses)
    ends_m = plane_vector(level.horizontal_distance_m, -level.drop_m, level.outward)[:, cable - 1]
    tilt = Rotation.from_rotvec([values.get("rx_rad", 0.0), values.get("ry_rad", 0.0), 0.0])
    radius_m = machine.robot.pulley_radius_m
    tilted_m, leaves = _over_pulley(tilt.inv().apply(ends_m), radius_m)
    upright_m, left = _over_pulley(ends_m, radius_m)
    length, moves = np.array(readings.length_m), np.zeros((*readings.length_m.shape, 3))
    length[:, cable - 1] += tilted_m - upright_m
    moves[:, cable - 1] = tilt.apply(leaves) - left
    more_N = rebalancing_N(machine.robot, measured.poses, readings.tension_N, moves)
    return Readings(length, readings.tension_N + more_N)


def _over_pulley(ends_m: FloatArray, radius_m: float) -> tuple[FloatArray, FloatArray]:
    """Return lengths of straight cables to points from the exit point, and where they leave."""
    distance, drop = np.hypot(ends_m[:, 0], ends_m[:, 1]), -ends_m[:, 2]
    outward = ends_m[:, :2] / np.maximum(distance, 1e-9)[:, None]
    slope = pulley.straight_slope_rad(distance, drop, radius_m)
    leaves = pulley.tangent_point_m(np.zeros_like(ends_m), outward, slope, radius_m)
    return pulley.straight_length_m(distance, drop, radius_m), leaves


def _is_in_space(machine: Machine) -> bool:
    return not machine.robot.is_planar


EFFECT = Effect(
    id="pulley_inclination",
    summary="the swivel axis of the pulley of cable {cable} is not vertical",
    law="length and direction of a straight cable over a pulley whose swivel axis is turned by the "
    "rotation vector (rx, ry, 0) from the vertical",
    source="Pott, Cable-Driven Parallel Robots, 2018, section 4.4",
    parameters=tuple(
        Parameter(name, ANGLE, _SIZE, is_optional=True) for name in ("rx_rad", "ry_rad")
    ),
    on_readings=_change,
    takes_cable=True,
    takes_machine=True,
    can_have=_is_in_space,
    needs=frozenset({"pulleys"}),
)
