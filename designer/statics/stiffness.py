r"""Stiffness of the platform with sagging cables, at fixed unstrained lengths.

A small displacement :math:`(δx, δω)` of the platform moves the attachment point with lever b by
:math:`δx + δω × b`; each cable answers with its own tangent stiffness K_i and with its force F_i
about a turned lever, and the weight P about the turned lever c of the centre of mass, as any other
force that acts at a point of the body:

.. math::

    δF_i = K_i (δx + δω × b_i), \qquad
    δM = \sum_i b_i × δF_i + (δω × b_i) × F_i \; - \; (δω × c) × P

F_i acts on the cable, so K is what the platform resists with. In equilibrium K is symmetric; it is
positive definite where the equilibrium is stable. With straight cables of no weight this is the
stiffness of Behzadipour and Khajepour, J. Mech. Des. 128 (2006), pages 303 to 310; here the
cables' own tangents bring in the sag.
"""

from __future__ import annotations

import numpy as np

from designer.arrays import BoolArray, FloatArray
from designer.model.robot import Robot
from designer.physics import tangent
from designer.statics.geometry import (
    cable_geometry,
    cross_matrix,
    in_space,
    plane_vector,
    upright_poses,
)
from designer.statics.inverse import Statics
from designer.statics.pull_slopes import pull_slopes

_SOFT = 1e-12
"""Over the stiffest, or over the chord: what rounding leaves of nothing."""


def cable_tangent_stiffness_N_per_m(statics: Statics) -> FloatArray:
    """Return how the force on each cable grows as its end moves (..., n_cables, 3, 3) [N/m].

    Upright frame, at fixed unstrained length. In the cable's vertical plane this is the closed form
    of `designer.physics.tangent`; across it a cable swings about the vertical through its exit
    point with the stiffness F_x / X. Over a pulley it does so only where the load is vertical; see
    `designer.statics.pull_slopes` for any other.
    """
    robot = statics.robot
    if robot.pulley_radius_m != 0.0 and robot.cable_load_direction is not None:
        return pull_slopes(statics).by_end_at_total
    if robot.pulley_radius_m == 0.0:
        plane = tangent.stiffness_N_per_m(*statics.catenaries)
    else:
        plane = tangent.stiffness_over_pulley_N_per_m(*statics.catenaries, robot.pulley_radius_m)
    chord = cable_geometry(robot, statics.poses)
    X = chord.horizontal_distance_m
    is_vertical = chord.chord_m * _SOFT >= X
    with np.errstate(invalid="ignore", divide="ignore"):
        swing = np.where(is_vertical, plane[..., 0, 0], statics.force_x_N / X)
    outward = np.where(is_vertical[..., None], [1.0, 0.0], chord.outward)
    return in_space(plane, swing, outward)


def platform_stiffness(statics: Statics) -> FloatArray:
    """Return the stiffness of the platform in poses (...), (..., dof, dof) [N/m, N, N·m].

    Rows are force and moment about the origin of the body frame, columns displacement and turn,
    along the axes of the base frame; 3×3 for a point mass. For a planar robot, what its cables
    balance: along x and z of the upright frame and, for a body, about y. NaN where the pose is not
    solved.
    """
    robot = statics.robot
    K = upright_stiffness(statics)
    if robot.is_planar or robot.is_upright:
        return K
    turn = np.kron(np.eye(K.shape[-1] // 3), robot.upright)
    return np.asarray(turn.T @ K @ turn)


def upright_stiffness(statics: Statics) -> FloatArray:
    """Return `platform_stiffness` along the axes of the upright frame, (..., dof, dof)."""
    robot = statics.robot
    K = cable_tangent_stiffness_N_per_m(statics)
    if robot.is_point_mass:
        return _balanced(robot, K.sum(axis=-3))
    geometry = statics.geometry()
    B = cross_matrix(geometry.lever_m)
    F = cross_matrix(plane_vector(statics.force_x_N, statics.force_z_N, geometry.outward))
    turn = -K @ B
    moment = B @ K
    turning = (B @ turn + F @ B).sum(axis=-3)
    rotation = upright_poses(robot, statics.poses).rotation
    for point_m, pull_N in robot.turning_pulls_N:
        turning = turning + cross_matrix(pull_N) @ cross_matrix(rotation @ point_m)
    left = np.concatenate([K.sum(axis=-3), moment.sum(axis=-3)], axis=-2)
    right = np.concatenate([turn.sum(axis=-3), turning], axis=-2)
    return _balanced(robot, np.concatenate([left, right], axis=-1))


def is_stable(robot: Robot, stiffness: FloatArray) -> BoolArray:
    """Tell where a stiffness (..., dof, dof) of the robot is positive definite."""
    return np.asarray(least_eigenvalue_N_per_m(robot, stiffness) > 0.0)


def least_eigenvalue_N_per_m(robot: Robot, stiffness: FloatArray) -> FloatArray:
    """Return the lowest eigenvalue of stiffnesses (..., dof, dof), turns at `reach_m` (...) [N/m].

    Zero where rounding leaves no more of it, or they are not finite.
    """
    K = scaled(robot, stiffness)
    K = np.where(np.isfinite(K).all(axis=(-2, -1), keepdims=True), K, 0.0)
    eigenvalues = np.linalg.eigvalsh(0.5 * (K + np.swapaxes(K, -1, -2)))
    least = eigenvalues[..., 0]
    return np.where(np.abs(least) <= _SOFT * np.abs(eigenvalues).max(axis=-1), 0.0, least)


def scaled(robot: Robot, stiffness: FloatArray) -> FloatArray:
    """Return a stiffness [N/m], or mass, with turns as displacements at `reach_m`: in one unit."""
    scale = per_reach(robot)
    return np.asarray(stiffness * scale * scale[:, None])


def per_reach(robot: Robot) -> FloatArray:
    """Return the factors (dof,) that make forces of a wrench's moments: one over `reach_m`."""
    return np.where(robot.balance_rows < 3, 1.0, 1.0 / reach_m(robot))


def reach_m(robot: Robot) -> float:
    """Return the distance of the farthest attachment from the origin of the body frame [m]."""
    farthest = float(np.linalg.norm(robot.attachments_m, axis=-1).max())
    return farthest if farthest > 0.0 else 1.0


def compliance(statics: Statics) -> FloatArray:
    """Return the displacement under a unit wrench (..., dof, dof) [m/N, 1/N, 1/(N·m)].

    The inverse of `platform_stiffness`; NaN where the pose is not solved or not stable.
    """
    K = platform_stiffness(statics)
    good = statics.is_solved & is_stable(statics.robot, K)
    safe = np.where(good[..., None, None], K, np.eye(K.shape[-1]))
    return np.where(good[..., None, None], np.linalg.inv(safe), np.nan)


def largest_displacement_m_per_N(statics: Statics) -> FloatArray:
    """Return how far a unit force at the origin of the body frame can move it (...) [m/N].

    The force may point anywhere, and the platform may turn; the inverse of this is the smallest
    translational stiffness. NaN where the pose is not solved or not stable.
    """
    n = int((statics.robot.balance_rows < 3).sum())
    C = compliance(statics)[..., :n, :n]
    good = np.asarray(np.isfinite(C).all(axis=(-2, -1)))
    C = np.where(good[..., None, None], C, 0.0)  # symmetric, as an equilibrium has it
    largest = np.linalg.eigvalsh(0.5 * (C + np.swapaxes(C, -1, -2)))[..., -1]
    return np.where(good, largest, np.nan)


def _balanced(robot: Robot, stiffness: FloatArray) -> FloatArray:
    """Return the rows and columns that the cables balance."""
    rows = robot.balance_rows
    return np.asarray(stiffness[..., rows[:, None], rows])
