"""One cable whose pulley is larger than those of the others."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from designer.effects.effect import Effect, Parameter, Readings, Size, Values
from designer.model.machine import Machine
from designer.model.measured_data import Measured
from designer.physics import pulley
from designer.statics.geometry import cable_geometry, structure_matrix
from designer.units import LENGTH

_SIZE = Size(0.02, bounds=(-2.0, 2.0), plausible=(-0.6, 0.6))


def _change(
    readings: Readings, values: Values, measured: Measured, *, machine: Machine, cable: int
) -> Readings:
    """Add what a straight cable is longer by over the larger pulley, and turn its pull.

    The robot has one radius for all cables: what the pulley does to the tensions is taken to first
    order. A cable k that leaves at another slope pulls in another direction c', so that all
    tensions T change by δT, the least with C δT = -(c' - c) T_k; the columns of C are directions.
    """
    robot = replace(machine.robot, cable_load_direction=None)
    level = cable_geometry(robot, measured.poses)
    distance, drop = level.horizontal_distance_m, level.drop_m
    radii = np.tile(robot.pulley_radius_m, (2, robot.n_cables))
    radii[1, cable - 1] += values["radius_m"]
    before, after = (pulley.straight_length_m(distance, drop, radius) for radius in radii)
    slopes = (pulley.straight_slope_rad(distance, drop, radius) for radius in radii)
    matrix = structure_matrix(robot, level)
    pulls, turned = (
        matrix[..., 0::2] * np.cos(slope)[..., None, :]
        - matrix[..., 1::2] * np.sin(slope)[..., None, :]
        for slope in slopes
    )
    off = np.sum((turned - pulls) * readings.tension_N[..., None, :], axis=-1)
    balancing = np.linalg.pinv(np.nan_to_num(pulls)) @ off[..., None]
    return replace(
        readings,
        length_m=readings.length_m + (after - before),
        tension_N=readings.tension_N - balancing[..., 0],
    )


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
