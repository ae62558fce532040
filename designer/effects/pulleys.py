"""Where cables leave the frame: pulleys, and masts that give way."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from designer.arrays import FloatArray
from designer.effects.effect import (
    Effect,
    Parameter,
    Readings,
    Size,
    Values,
    frame_size_m,
    is_in_space,
    pull_of,
    sized_by,
)
from designer.model.measurements import Measured
from designer.model.robot import Machine, Poses, Robot
from designer.physics import pulley
from designer.statics.geometry import cable_geometry, density_matrix, level_geometry, plane_vector
from designer.statics.pulleys import straight_run
from designer.units import ANGLE, COMPLIANCE, LENGTH

_RIDGE = 1e-12
"""Of the trace of a Gram matrix: lets it be solved where cables leave a direction free."""


def rebalancing_N(
    robot: Robot, poses: Poses, tension_N: FloatArray, moves_m: FloatArray
) -> FloatArray:
    """Return by how much tensions change where cables turn as they leave at other points.

    The least change that keeps the balance of straight cables, to first order.

    Tensions (n_rows, n_cables) [N] are those before that; moves (n_rows, n_cables, 3) [m], upright
    frame, those of where straight cables leave their pulleys.
    """
    leaving_m = straight_run(robot, poses).exit_points_m
    geometries = (
        cable_geometry(robot, poses, points) for points in (leaving_m, leaving_m + moves_m)
    )
    before, after = (
        density_matrix(robot, geometry) / geometry.chord_m[..., None, :] for geometry in geometries
    )
    lost = (after - before) @ np.nan_to_num(tension_N)[..., None]
    gram = np.nan_to_num(before @ np.swapaxes(before, -1, -2))
    ridge = _RIDGE * np.trace(gram, axis1=1, axis2=2)[:, None, None] * np.eye(gram.shape[-1])
    share = np.linalg.solve(gram + ridge, lost)
    return np.asarray(-(np.swapaxes(before, -1, -2) @ share)[..., 0])


# Swivelling pulleys at the exit points.


def _pulley_radius_size(machine: Machine) -> Size:
    """Small machines have small pulleys: a two-thousandth of the frame is plausible."""
    least = min(0.005, 5e-4 * frame_size_m(machine))
    return Size(0.02, bounds=(0.0, 2.0), plausible=(least, 0.6))


PULLEY_RADIUS = Effect(
    id="pulley_radius",
    summary="the cables run over pulleys instead of leaving from a point",
    law="tangent point and wrapped length of a swivelling pulley of this radius",
    source="Pott, Cable-Driven Parallel Robots, 2018, section 4.4",
    parameters=(Parameter("radius_m", LENGTH, _pulley_radius_size, at_least=0.0),),
    on_machine=lambda machine, values: replace(
        machine, robot=replace(machine.robot, pulley_radius_m=values["radius_m"])
    ),
    reaches_design=True,
)


# One cable whose pulley is larger than those of the others.

_EXTRA_RADIUS = Size(0.02, bounds=(-2.0, 2.0), plausible=(-0.6, 0.6))


def _enlarge_pulley(
    readings: Readings, values: Values, measured: Measured, *, machine: Machine, cable: int
) -> Readings:
    """Add what a straight cable is longer by over the larger pulley, and turn its pull."""
    robot = replace(machine.robot, cable_load_direction=None)
    level = cable_geometry(robot, measured.poses)
    run = level.horizontal_distance_m, level.drop_m
    radii = np.tile(robot.pulley_radius_m, (2, robot.n_cables))
    radii[1, cable - 1] += values["radius_m"]
    lengths = [pulley.straight_length_m(*run, radius) for radius in radii]
    start = np.zeros((*level.drop_m.shape, 3))
    points = [
        pulley.tangent_point_m(start, level.outward, pulley.straight_slope_rad(*run, r), r)
        for r in radii
    ]
    moves = points[1] - points[0]
    more_N = rebalancing_N(robot, measured.poses, readings.tension_N, moves)
    longer_m = lengths[1] - lengths[0]
    return Readings(readings.length_m + longer_m, readings.tension_N + more_N)


CABLE_PULLEY_RADIUS = Effect(
    id="cable_pulley_radius",
    summary="the pulley of cable {cable} is not as large as those of the others",
    law="length and direction of a straight cable over a swivelling pulley, of the others' radius "
    "plus this",
    source="Pott, Cable-Driven Parallel Robots, 2018, section 4.4",
    parameters=(Parameter("radius_m", LENGTH, _EXTRA_RADIUS),),
    on_readings=_enlarge_pulley,
    needs=frozenset({"length"}),
    takes_cable=True,
    takes_machine=True,
)


# One pulley that swivels about an axis that is not vertical.

_INCLINATION = Size(0.02, bounds=(-1.2, 1.2), plausible=(-0.35, 0.35))


def _incline_pulley(
    readings: Readings, values: Values, measured: Measured, *, machine: Machine, cable: int
) -> Readings:
    """Turn the pulley about its exit point: a straight cable's length and direction change."""
    from scipy.spatial.transform import Rotation

    level = level_geometry(machine.robot, measured.poses)
    ends_m = plane_vector(level.horizontal_distance_m, -level.drop_m, level.outward)[:, cable - 1]
    tilt = Rotation.from_rotvec([values.get("rx_rad", 0.0), values.get("ry_rad", 0.0), 0.0])
    radius_m = machine.robot.pulley_radius_m
    tilted_m, leaves = _over_pulley(tilt.inv().apply(ends_m), radius_m)
    upright_m, upright_leaves = _over_pulley(ends_m, radius_m)
    length, moves = np.array(readings.length_m), np.zeros((*readings.length_m.shape, 3))
    length[:, cable - 1] += tilted_m - upright_m
    moves[:, cable - 1] = tilt.apply(leaves) - upright_leaves
    more_N = rebalancing_N(machine.robot, measured.poses, readings.tension_N, moves)
    return Readings(length, readings.tension_N + more_N)


def _over_pulley(ends_m: FloatArray, radius_m: float) -> tuple[FloatArray, FloatArray]:
    """Return lengths of straight cables to points from the exit point, and where they leave."""
    distance, drop = np.hypot(ends_m[:, 0], ends_m[:, 1]), -ends_m[:, 2]
    outward = ends_m[:, :2] / np.maximum(distance, 1e-9)[:, None]
    slope = pulley.straight_slope_rad(distance, drop, radius_m)
    leaves = pulley.tangent_point_m(np.zeros_like(ends_m), outward, slope, radius_m)
    return pulley.straight_length_m(distance, drop, radius_m), leaves


PULLEY_INCLINATION = Effect(
    id="pulley_inclination",
    summary="the swivel axis of the pulley of cable {cable} is not vertical",
    law="length and direction of a straight cable over a pulley whose swivel axis is turned by the "
    "rotation vector (rx, ry, 0) from the vertical",
    source="Pott, Cable-Driven Parallel Robots, 2018, section 4.4",
    parameters=tuple(
        Parameter(name, ANGLE, _INCLINATION, is_optional=True) for name in ("rx_rad", "ry_rad")
    ),
    on_readings=_incline_pulley,
    takes_cable=True,
    takes_machine=True,
    can_have=is_in_space,
    needs=frozenset({"pulleys"}),
)


# Masts that give way to the pull of their cables.


def _bend_masts(
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


def _soft_mast_m_per_N(machine: Machine) -> float:
    """Return the compliance of a mast that gives way by 2 % of the frame under the weight."""
    return 0.02 * frame_size_m(machine) / machine.robot.weight_N


MAST_COMPLIANCE = Effect(
    id="mast_compliance",
    summary="the masts bend: exit points move with the pull of their cables",
    law="exit point plus compliance times the horizontal force of its cable",
    source="cantilever, H³/(3 EI): Timoshenko, Strength of Materials I, 1955, section 39",
    parameters=(
        Parameter(
            "compliance_m_per_N",
            COMPLIANCE,
            sized_by(_soft_mast_m_per_N, 0.02, bounds=(0.0, 50.0), plausible=(0.0, 1.0)),
            at_least=0.0,
        ),
    ),
    on_readings=_bend_masts,
    takes_machine=True,
)
