"""One cable whose pulley is larger than those of the others."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from designer.effects.effect import Effect, Parameter, Readings, Size, Values
from designer.model.machine import Machine
from designer.model.measured_data import Measured
from designer.physics import pulley
from designer.statics.geometry import level_geometry
from designer.units import LENGTH

_SIZE = Size(0.02, bounds=(-2.0, 2.0), plausible=(-0.6, 0.6))


def _change(
    readings: Readings, values: Values, measured: Measured, *, machine: Machine, cable: int
) -> Readings:
    """Add what a straight cable is longer by over the larger pulley.

    The robot has one radius for all cables: what the pulley does to the tensions, in proportion to
    its radius over the cable's length, is left out.
    """
    level = level_geometry(machine.robot, measured.poses)
    distance, drop = (
        of_all[..., cable - 1] for of_all in (level.horizontal_distance_m, level.drop_m)
    )
    radius = machine.robot.pulley_radius_m
    length = np.array(readings.length_m)
    length[:, cable - 1] += pulley.straight_length_m(distance, drop, radius + values["radius_m"])
    length[:, cable - 1] -= pulley.straight_length_m(distance, drop, radius)
    return replace(readings, length_m=length)


EFFECT = Effect(
    id="cable_pulley_radius",
    summary="the pulley of cable {cable} is not as large as those of the others",
    law="length of a straight cable over a swivelling pulley, of the others' radius plus this",
    source="Pott, Cable-Driven Parallel Robots, 2018, section 4.4",
    parameters=(Parameter("radius_m", LENGTH, _SIZE),),
    on_readings=_change,
    needs=frozenset({"length"}),
    takes_cable=True,
    takes_machine=True,
)
