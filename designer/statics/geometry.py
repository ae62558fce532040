"""Where the cables run in a pose, and the structure matrix."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from designer.arrays import FloatArray
from designer.kernel.calling import CableFigures, Situation, plain, situation_of
from designer.model.cable import Cable, Cables
from designer.model.robot import Poses, Robot


@dataclass(frozen=True, slots=True, eq=False)
class CableGeometry:
    """Chords of all cables in all poses."""

    horizontal_distance_m: FloatArray  #: (..., n_cables) from exit point to attachment point [m]
    drop_m: FloatArray  #: (..., n_cables) the same [m]
    #: (..., n_cables, 2) unit vector from exit point toward attachment point in plan; zero for a
    #: vertical cable
    outward: FloatArray
    #: (..., n_cables, 3) from the body frame's origin to the attachment point, world axes [m]
    lever_m: FloatArray

    @property
    def chord_m(self) -> FloatArray:
        """Straight distance from exit point to attachment point (..., n_cables) [m]."""
        return np.asarray(np.hypot(self.horizontal_distance_m, self.drop_m))


def upright_poses(robot: Robot, poses: Poses) -> Poses:
    """Return the poses in the upright frame, whose z axis is the true vertical."""
    if robot.is_upright:
        return poses
    rotation = robot.upright
    return Poses(np.asarray(poses.position_m @ rotation.T), np.asarray(rotation @ poses.rotation))


def centre_of_mass_arm_m(robot: Robot, poses: Poses) -> FloatArray:
    """Return the centre of mass from the body's origin, upright frame (..., 3) [m]."""
    return np.asarray(upright_poses(robot, poses).rotation @ robot.platform.centre_of_mass_m)


def turning_moment_Nm(robot: Robot, poses: Poses, first: int = 0) -> FloatArray:
    """Return the moment of `Robot.turning_pulls_N` from one on, against them (..., 3) [N·m]."""
    rotation, moment = upright_poses(robot, poses).rotation, np.zeros(3)
    for point_m, pull_N in robot.turning_pulls_N[first:]:
        moment = moment - np.cross(rotation @ point_m, pull_N)
    return moment


def upright_exit_points_m(robot: Robot) -> FloatArray:
    """Return the exit points in that frame (n_cables, 3) [m]."""
    if robot.is_upright:
        return robot.exit_points_m
    return np.asarray(robot.exit_points_m @ robot.upright.T)


def upright_situation(
    robot: Robot, poses: Poses, exit_points_m: FloatArray, force_N: FloatArray | None = None
) -> Situation:
    """Return what kernels are told of poses (n_poses,) and a force (n_poses, 3), base frame.

    Exit points, where the cables leave their pulleys, are in the upright frame.
    """
    wrench = None if force_N is None else force_N @ robot.upright.T
    posed = _inertia_wrench_N(robot, poses)
    if len(robot.turning_pulls_N) > 1:  # kernels know of the centre of mass alone
        moment = np.broadcast_to(turning_moment_Nm(robot, poses, 1), (*poses.shape, 3))
        posed = (0.0 if posed is None else posed) + np.pad(moment, ((0, 0), (3, 0)))
    if posed is not None:
        wrench = posed if wrench is None else posed + np.pad(wrench, ((0, 0), (0, 3)))
    return situation_of(robot, upright_poses(robot, poses), exit_points_m, wrench)


def _inertia_wrench_N(robot: Robot, poses: Poses) -> FloatArray | None:
    """Return `Robot.inertia_wrench_N` in the upright frame (..., 6) [N, N·m]."""
    wrench = robot.inertia_wrench_N(poses)
    if wrench is None or robot.is_upright:
        return wrench
    rotated = wrench.reshape(*poses.shape, 2, 3) @ robot.upright.T
    return np.asarray(rotated.reshape(wrench.shape))


def one_cable(robot: Robot, cable: Cable | Cables, least_tension_N: float = 0.0) -> CableFigures:
    """Return what kernels are told of the cables, weights per length [N/m]."""
    ones, weight = np.ones((1, robot.n_cables)), cable.weight_N_per_m
    kappa = plain(weight / cable.axial_stiffness_N * ones)
    return CableFigures(kappa, plain(weight * ones), plain(np.inf * ones), least_tension_N)


def cable_geometry(
    robot: Robot, poses: Poses, exit_points_m: FloatArray | None = None
) -> CableGeometry:
    """Return the chords of all cables, Riehl et al., ICRA 2010, eq. (1), in the upright frame.

    Parameters
    ----------
    robot, poses
        The robot and its poses (...), in the base frame.
    exit_points_m : array (..., n_cables, 3), optional
        Where the cables leave their pulleys, upright frame [m]; the exit points if left out.
    """
    upright = upright_poses(robot, poses)
    start = upright_exit_points_m(robot) if exit_points_m is None else exit_points_m
    ends = upright.attachment_points_m(robot)
    chord = ends - start
    distance = np.hypot(chord[..., 0], chord[..., 1])
    outward = chord[..., :2] / np.where(distance > 0.0, distance, 1.0)[..., None]
    lever = ends - upright.position_m[..., None, :]
    return CableGeometry(distance, -chord[..., 2], outward, lever)


def level_geometry(robot: Robot, poses: Poses) -> CableGeometry:
    """Return the chords from the exit points in the frame whose z axis is the true vertical."""
    return cable_geometry(replace(robot, cable_load_direction=None), poses)


def structure_matrix(robot: Robot, geometry: CableGeometry) -> FloatArray:
    """Return W_f of eq. (9), (..., degrees of freedom, 2 n_cables), one row a balanced direction.

    Columns alternate between the horizontal and the vertical force on each cable at the platform;
    the product with them is the wrench that holds the platform against gravity, with opposite sign.
    """
    out_x, out_y = geometry.outward[..., 0], geometry.outward[..., 1]
    zero = np.zeros_like(out_x)
    horizontal = np.stack([out_x, out_y, zero], axis=-1)
    vertical = np.broadcast_to([0.0, 0.0, 1.0], horizontal.shape)
    columns = []
    for direction in (horizontal, vertical):
        if robot.is_point_mass:
            columns.append(direction)
        else:
            moment = np.cross(geometry.lever_m, direction)
            columns.append(np.concatenate([direction, moment], axis=-1))
    pairs = np.stack(columns, axis=-2)  # (..., n_cables, 2, dof)
    flat = pairs.reshape(*pairs.shape[:-3], 2 * pairs.shape[-3], pairs.shape[-1])
    return np.asarray(np.swapaxes(flat, -1, -2)[..., robot.balance_rows, :])


def density_matrix(robot: Robot, geometry: CableGeometry) -> FloatArray:
    """Return the wrench that straight cables of unit force density hold, (..., dof, n_cables).

    Force density is tension over length: with it a vertical cable needs no special case.
    """
    matrix = structure_matrix(robot, geometry)
    across = geometry.horizontal_distance_m[..., None, :]
    return matrix[..., 0::2] * across - matrix[..., 1::2] * geometry.drop_m[..., None, :]


def load_wrench_N(robot: Robot, poses: Poses, force_N: FloatArray | None = None) -> FloatArray:
    """Return weight and all other load on the platform as a wrench (..., dof) [N, N·m].

    Parameters
    ----------
    robot, poses
        The robot and its poses (...).
    force_N : array (..., 3), optional
        Force on the platform at the origin of the body frame, base frame, beside weight and the
        platform's own wrench [N].

    Returns
    -------
    array (..., degrees of freedom)
        About the origin of the body frame, upright frame; one row a balanced direction.
    """
    shape = poses.position_m.shape
    force, moment = np.split(-robot.pull_N, 2)
    if force_N is not None:
        force = force + force_N @ robot.upright.T
    moment = moment + turning_moment_Nm(robot, poses)
    parts = [np.broadcast_to(force, shape), np.broadcast_to(moment, shape)]
    wrench = np.concatenate(parts, axis=-1)
    inertia = _inertia_wrench_N(robot, poses)
    wrench = wrench if inertia is None else wrench + inertia
    return np.asarray(wrench[..., robot.balance_rows])


def plane_vector(x: FloatArray, z: FloatArray, outward: FloatArray) -> FloatArray:
    """Return vectors (..., 3) of a part along ``outward`` (..., 2) and one along z."""
    return np.concatenate([x[..., None] * outward, z[..., None]], axis=-1)


def in_space(plane: FloatArray, swing: FloatArray, outward: FloatArray) -> FloatArray:
    """Turn stiffness in the vertical plane and across it into three dimensions."""
    x, y = outward[..., 0], outward[..., 1]
    along = plane[..., 0, 0]
    turned = np.empty((*np.broadcast_shapes(x.shape, along.shape), 3, 3))
    turned[..., 0, 0] = along * x * x + swing * y * y
    turned[..., 1, 1] = along * y * y + swing * x * x
    turned[..., 0, 1] = turned[..., 1, 0] = (along - swing) * x * y
    turned[..., :2, 2] = plane[..., 0, 1, None] * outward
    turned[..., 2, :2] = plane[..., 1, 0, None] * outward
    turned[..., 2, 2] = plane[..., 1, 1]
    return turned


def cross_matrix(vector: FloatArray) -> FloatArray:
    """Return the matrices of ``vector ×`` (..., 3, 3)."""
    x, y, z = vector[..., 0], vector[..., 1], vector[..., 2]
    zero = np.zeros_like(x)
    rows = [[zero, -z, y], [z, zero, -x], [-y, x, zero]]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)
