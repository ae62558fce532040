"""Lengths and tensions where cables and degrees of freedom differ in number.

With more degrees of freedom than cables a measured pose is not quite in balance, as the platform
sways; with fewer, the tensions are not unique. Here the tensions are those of straight cables that
pull and come nearest to balance, the smallest of them where there is a choice; lengths follow with
sag and elasticity. Good for taut cables; the full answer for redundant robots is an optimisation.
"""

from __future__ import annotations

import numpy as np

from designer.arrays import FloatArray
from designer.cable import Cable
from designer.physics import catenary
from designer.robot import Poses, Robot
from designer.statics.geometry import cable_geometry, load_wrench_N, structure_matrix
from designer.statics.task import straight_run

_SMALLEST_SHARE = 1e-3
_REGULAR = 1e-4


def solve_nearest(
    robot: Robot, poses: Poses, cable: Cable, force_N: FloatArray | None = None
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return unstrained lengths [m], upper tensions [N] and horizontal distances [m].

    Parameters
    ----------
    robot, poses, cable
        The robot, its poses (n_poses,) and its cables.
    force_N : array (n_poses, 3), optional
        Force on the platform beside its weight, base frame [N].

    Returns
    -------
    three arrays (n_poses, n_cables)
    """
    run = straight_run(robot, poses)
    geometry = cable_geometry(robot, poses, run.exit_points_m)
    density = _pulling_densities(robot, poses, force_N, run.exit_points_m)
    X, D = geometry.horizontal_distance_m, geometry.drop_m
    w, EA = cable.weight_N_per_m, cable.axial_stiffness_N
    length, force_z = catenary.length_and_force_z(density, X, D, EA, w)
    upper, _ = catenary.end_tensions_N(length, density * X, force_z, w)
    return length + run.unstrained(upper / EA).wrap_m, upper, X


def _pulling_densities(
    robot: Robot, poses: Poses, force_N: FloatArray | None, exit_points_m: FloatArray
) -> FloatArray:
    """Return force densities (n_poses, n_cables) [N/m]: regularised least squares, kept pulling."""
    geometry = cable_geometry(robot, poses, exit_points_m)
    matrix = structure_matrix(robot, geometry)
    chord = geometry.chord_m[:, None, :]
    per_tension = (
        matrix[..., 0::2] * geometry.horizontal_distance_m[:, None, :]
        - matrix[..., 1::2] * geometry.drop_m[:, None, :]
    ) / chord
    wrench = load_wrench_N(robot, poses, force_N)
    normal = np.einsum("pki,pkj->pij", per_tension, per_tension)
    n = robot.n_cables
    size = np.trace(normal, axis1=1, axis2=2)[:, None, None] / n
    right = np.einsum("pki,pk->pi", per_tension, wrench)
    tension = np.linalg.solve(normal + _REGULAR * size * np.eye(n), right[..., None])[..., 0]
    least = _SMALLEST_SHARE * robot.weight_N
    return np.asarray(np.maximum(tension, least) / geometry.chord_m)
