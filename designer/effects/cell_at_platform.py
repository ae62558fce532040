"""Load cells at the platform, where the cable's own weight is not in the tension."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from designer.effects.effect import Effect, Parameter, Readings, Size, Values
from designer.model.machine import Machine
from designer.model.measured_data import Measured
from designer.physics import pulley
from designer.statics.geometry import level_geometry
from designer.units import NUMBER

_SIZE = Size(0.1, bounds=(-20.0, 20.0), plausible=(0.7, 1.3))


def _change(
    readings: Readings, values: Values, measured: Measured, *, machine: Machine
) -> Readings:
    """Return tensions less the weight below the winch.

    Along a hanging cable T dT = V dV, so that w times the drop from where it leaves its pulley is
    the change of T + T²/(2 EA).
    """
    level = level_geometry(machine.robot, measured.poses)
    stiffness_N, radius_m = machine.cables.axial_stiffness_N, machine.robot.pulley_radius_m
    slope = pulley.straight_slope_rad(level.horizontal_distance_m, level.drop_m, radius_m)
    drop_m = level.drop_m + radius_m * np.cos(slope)
    winch_N = readings.tension_N
    stretched = winch_N + winch_N**2 / (2.0 * stiffness_N) - machine.cables.weight_N_per_m * drop_m
    inside = np.maximum(1.0 + 2.0 * stretched / stiffness_N, 0.0)
    platform_N = stiffness_N * (np.sqrt(inside) - 1.0)
    return replace(readings, tension_N=winch_N + values["share"] * (platform_N - winch_N))


EFFECT = Effect(
    id="cell_at_platform",
    summary="the load cells are at the platform",
    law="measured tension is on the way from that at the winch (share 0) to that at the platform "
    "(share 1)",
    source="elastic catenary: Irvine, Cable Structures, 1981",
    parameters=(Parameter("share", NUMBER, _SIZE),),
    on_readings=_change,
    cause="setting_up",
    needs=frozenset({"tension"}),
    takes_machine=True,
)
