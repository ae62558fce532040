"""Where the cables run in a pose, and the structure matrix."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from designer.arrays import FloatArray
from designer.robot import Poses, Robot


@dataclass(frozen=True, slots=True, eq=False)
class CableGeometry:
    """Chords of all cables in all poses.

    Parameters
    ----------
    horizontal_distance_m, drop_m : array (..., n_cables)
        Horizontal distance and drop from exit point to attachment point [m].
    outward : array (..., n_cables, 2)
        Unit vector from exit point toward attachment point in plan; zero for a vertical cable.
    lever_m : array (..., n_cables, 3)
        From the body frame's origin to the attachment point, world axes [m].
    """

    horizontal_distance_m: FloatArray
    drop_m: FloatArray
    outward: FloatArray
    lever_m: FloatArray

    @property
    def chord_m(self) -> FloatArray:
        """Straight distance from exit point to attachment point (..., n_cables) [m]."""
        return np.asarray(np.hypot(self.horizontal_distance_m, self.drop_m))


def cable_geometry(robot: Robot, poses: Poses) -> CableGeometry:
    """Return the chords of all cables, Riehl et al., ICRA 2010, eq. (1)."""
    ends = poses.attachment_points_m(robot)
    chord = ends - robot.exit_points_m
    distance = np.hypot(chord[..., 0], chord[..., 1])
    outward = chord[..., :2] / np.where(distance > 0.0, distance, 1.0)[..., None]
    lever = ends - poses.position_m[..., None, :]
    return CableGeometry(distance, -chord[..., 2], outward, lever)


def structure_matrix(robot: Robot, geometry: CableGeometry) -> FloatArray:
    """Return W_f of eq. (9), (..., degrees of freedom, 2 n_cables).

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
    flat = pairs.reshape(*pairs.shape[:-3], -1, pairs.shape[-1])
    return np.asarray(np.swapaxes(flat, -1, -2))


def weight_wrench_N(robot: Robot, poses: Poses) -> FloatArray:
    """Return the platform's weight as a wrench about the body origin (..., dof) [N, N·m]."""
    force = np.array([0.0, 0.0, -robot.weight_N])
    if robot.is_point_mass:
        return np.broadcast_to(force, poses.position_m.shape)
    arm = np.einsum("...ij,j->...i", poses.rotation, robot.platform.centre_of_mass_m)
    wrench = np.concatenate([np.broadcast_to(force, arm.shape), np.cross(arm, force)], axis=-1)
    return np.broadcast_to(wrench, (*poses.shape, 6))
