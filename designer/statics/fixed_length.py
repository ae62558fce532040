"""Cables of given unstrained lengths on a platform that is held in a given pose."""

from __future__ import annotations

import numpy as np

from designer.arrays import FloatArray
from designer.physics import catenary, pulley
from designer.robot import Poses, Robot
from designer.statics.geometry import cable_geometry, upright_exit_points_m
from designer.statics.inverse import Statics
from designer.statics.task import PulleyRun
from designer.verdict import Verdict

_MOST_TURNS = 40
_STILL_RAD = 1e-14


def cables_of_length(
    robot: Robot,
    poses: Poses,
    length_m: FloatArray,
    axial_stiffness_N: FloatArray,
    weight_N_per_m: FloatArray,
    force_N: FloatArray | None = None,
) -> Statics:
    """Return the forces of cables of fixed unstrained lengths in poses (...), balanced or not.

    Each cable is an elastic catenary by itself; `Statics.equilibrium_residual_N` of the result says
    what is left of the platform's balance. A slack cable hangs between its ends.

    Parameters
    ----------
    robot, poses
        The robot and its poses (...).
    length_m : array (..., n_cables)
        Unstrained lengths from the exit points, around pulleys where there are any [m].
    axial_stiffness_N, weight_N_per_m : array (..., 1) or (..., n_cables)
        EA [N] and weight per unstrained length [N/m].
    force_N : array (..., 3), optional
        Force on the platform beside its weight, base frame [N].

    Returns
    -------
    Statics
        NaN where a cable cannot reach: no length is left beyond its pulley, or it is inextensible
        and too short.
    """
    if robot.pulley_radius_m == 0.0:
        run = PulleyRun(upright_exit_points_m(robot), np.zeros(1))
        _, force_x, force_z = _between(
            robot, poses, run, length_m, axial_stiffness_N, weight_N_per_m
        )
    else:
        run, force_x, force_z = _over_pulleys(
            robot, poses, length_m, axial_stiffness_N, weight_N_per_m
        )
    held = np.isfinite(force_x).all(axis=-1)
    return Statics(
        robot=robot,
        poses=poses,
        verdict=np.where(held, Verdict.SOLVED, Verdict.NOT_CONVERGED).astype(np.int8),
        weight_N_per_m=weight_N_per_m,
        axial_stiffness_N=axial_stiffness_N,
        length_m=length_m,
        force_x_N=force_x,
        force_z_N=force_z,
        run=run,
        force_N=force_N,
    )


def _over_pulleys(
    robot: Robot,
    poses: Poses,
    length_m: FloatArray,
    axial_stiffness_N: FloatArray,
    weight_N_per_m: FloatArray,
) -> tuple[PulleyRun, FloatArray, FloatArray]:
    """Let the tangent points come to rest: each follows the slope of its cable's upper end."""
    radius = robot.pulley_radius_m
    exits = upright_exit_points_m(robot)
    geometry = cable_geometry(robot, poses)
    slope = pulley.straight_slope_rad(geometry.horizontal_distance_m, geometry.drop_m, radius)
    strain = np.zeros(slope.shape)
    for _ in range(_MOST_TURNS):
        run = PulleyRun(
            pulley.tangent_point_m(exits, geometry.outward, slope, radius),
            pulley.wrap_length_m(slope, radius),
        ).unstrained(strain)
        free, force_x, force_z = _between(
            robot, poses, run, length_m, axial_stiffness_N, weight_N_per_m
        )
        downward = weight_N_per_m * free - force_z
        new = np.arctan2(downward, force_x)
        change = np.nanmax(np.abs(new - slope), initial=0.0)
        slope, strain = new, np.hypot(force_x, downward) / axial_stiffness_N
        if change <= _STILL_RAD:
            break
    return run, force_x, force_z


def _between(
    robot: Robot,
    poses: Poses,
    run: PulleyRun,
    length_m: FloatArray,
    axial_stiffness_N: FloatArray,
    weight_N_per_m: FloatArray,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return free lengths [m] and forces on the cables at the platform [N]."""
    geometry = cable_geometry(robot, poses, run.exit_points_m)
    free = length_m - run.wrap_m
    usable = np.where(free > 0.0, free, np.nan)
    force_x, force_z = catenary.forces_from_length(
        np.where(free > 0.0, free, 1.0),
        geometry.horizontal_distance_m,
        geometry.drop_m,
        axial_stiffness_N,
        weight_N_per_m,
    )
    unreachable = np.isnan(usable)
    return usable, np.where(unreachable, np.nan, force_x), np.where(unreachable, np.nan, force_z)
