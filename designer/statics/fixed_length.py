"""Cables of given unstrained lengths on a platform that is held in a given pose."""

from __future__ import annotations

import numpy as np

from designer.arrays import FloatArray
from designer.kernel.calling import plain
from designer.model.robot import Poses, Robot
from designer.model.verdict import Verdict
from designer.physics import catenary
from designer.statics.geometry import cable_geometry
from designer.statics.inverse import Statics
from designer.statics.pulleys import SETTLED_RAD, PulleyRun, leaving, over_pulleys


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

    cable = axial_stiffness_N, weight_N_per_m

    def solve(run: PulleyRun) -> tuple[tuple[FloatArray, FloatArray], FloatArray, FloatArray]:
        geometry = cable_geometry(robot, poses, run.exit_points_m)
        free = length_m - run.wrap_m
        force_x, force_z = np.where(
            free > 0.0,
            _forces_N(
                np.where(free > 0.0, free, 1.0),
                geometry.horizontal_distance_m,
                geometry.drop_m,
                *cable,
            ),
            np.nan,
        )
        free = np.where(free > 0.0, free, np.nan)
        return (force_x, force_z), *leaving(*cable, free, force_x, force_z)

    (force_x, force_z), run, gap_rad = over_pulleys(robot, poses, solve)
    is_held = np.isfinite(force_x).all(axis=-1) & (gap_rad <= SETTLED_RAD)
    return Statics(
        robot=robot,
        poses=poses,
        verdict=np.where(is_held, Verdict.SOLVED, Verdict.NOT_CONVERGED).astype(np.int8),
        weight_N_per_m=weight_N_per_m,
        axial_stiffness_N=axial_stiffness_N,
        length_m=length_m,
        force_x_N=force_x,
        force_z_N=force_z,
        run=run,
        force_N=force_N,
    )


def _forces_N(
    length_m: FloatArray,
    horizontal_distance_m: FloatArray,
    drop_m: FloatArray,
    axial_stiffness_N: float | FloatArray,
    weight_N_per_m: float | FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Return what `catenary.forces_from_length` does, cable by cable in compiled code."""
    from designer.kernel.fixed_length import solve_thetas

    kappa_per_m = np.asarray(weight_N_per_m) / axial_stiffness_N
    length, X, D, kappa, w = map(
        plain,
        np.broadcast_arrays(length_m, horizontal_distance_m, drop_m, kappa_per_m, weight_N_per_m),
    )
    theta = np.empty(length.shape)
    solve_thetas(length.ravel(), X.ravel(), D.ravel(), kappa.ravel(), theta.reshape(-1))
    return catenary.forces_from_theta(theta, length, X, D, kappa, w)
