"""One cable whose pulley is larger than those of the others."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from designer.effects.effect import Effect, Parameter, Readings, Size, Values
from designer.effects.rebalancing import rebalancing_N
from designer.model.machine import Machine
from designer.model.measured_data import Measured
from designer.physics import pulley
from designer.statics.geometry import cable_geometry
from designer.units import LENGTH

_SIZE = Size(0.02, bounds=(-2.0, 2.0), plausible=(-0.6, 0.6))


def _change(
    readings: Readings, values: Values, measured: Measured, *, machine: Machine, cable: int
) -> Readings:
    """Add what a straight cable is longer by over the larger pulley, and turn its pull."""
    robot = replace(machine.robot, cable_load_direction=None)
    level = cable_geometry(robot, measured.poses)
    way = level.horizontal_distance_m, level.drop_m
    radii = np.tile(robot.pulley_radius_m, (2, robot.n_cables))
    radii[1, cable - 1] += values["radius_m"]
    lengths = [pulley.straight_length_m(*way, radius) for radius in radii]
    start = np.zeros((*level.drop_m.shape, 3))
    points = [
        pulley.tangent_point_m(start, level.outward, pulley.straight_slope_rad(*way, r), r)
        for r in radii
    ]
    moves = points[1] - points[0]
    more_N = rebalancing_N(robot, measured.poses, readings.tension_N, moves)
    longer_m = lengths[1] - lengths[0]
    return Readings(readings.length_m + longer_m, readings.tension_N + more_N)


EFFECT = Effect(
    id="cable_pulley_radius",
    summary="the pulley of cable {cable} is not as large as those of the others",
    law="length and direction of a straight cable over a swivelling pulley, of the others' radius "
    "plus this",
    source="Pott, Cable-Driven Parallel Robots, 2018, section 4.4",
    parameters=(Parameter("radius_m", LENGTH, _SIZE),),
    on_readings=_change,
    needs=frozenset({"length"}),
    takes_cable=True,
    takes_machine=True,
)
