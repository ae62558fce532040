"""Frozen values of a robot, its platform and its poses."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial.transform import Rotation

from designer.arrays import FloatArray, frozen_array
from designer.cable import STANDARD_GRAVITY_M_PER_S2


@dataclass(frozen=True, slots=True, eq=False)
class Platform:
    """What the cables carry.

    Parameters
    ----------
    mass_kg : float
        Mass [kg].
    attachments_m : array (n_cables, 3) or None
        Attachment points in the body frame [m]; None for a point mass with 3 degrees of freedom.
    centre_of_mass_m : array (3,)
        Centre of mass in the body frame [m].
    """

    mass_kg: float
    attachments_m: FloatArray | None = None
    centre_of_mass_m: FloatArray = field(default_factory=lambda: frozen_array(np.zeros(3)))


@dataclass(frozen=True, slots=True, eq=False)
class Robot:
    """A cable-driven parallel robot.

    Parameters
    ----------
    exit_points_m : array (n_cables, 3)
        Points where the cables leave the base, world frame, z upward [m].
    platform : Platform
        The load.
    pulley_radius_m : float
        Radius of the swivelling pulleys at the exit points [m]; see `designer.physics.pulley`.
    tilt_rad : array (2,)
        The base is turned by the rotation vector (rx, ry, 0) against the vertical [rad].
    """

    exit_points_m: FloatArray
    platform: Platform
    pulley_radius_m: float = 0.0
    tilt_rad: FloatArray = field(default_factory=lambda: frozen_array(np.zeros(2)))

    @property
    def n_cables(self) -> int:
        """Number of cables."""
        return len(self.exit_points_m)

    @property
    def is_point_mass(self) -> bool:
        """Whether all cables meet in one point and the platform cannot turn."""
        return self.platform.attachments_m is None

    @property
    def degrees_of_freedom(self) -> int:
        """3 for a point mass, 6 otherwise."""
        return 3 if self.is_point_mass else 6

    @property
    def is_square(self) -> bool:
        """Whether there are as many cables as degrees of freedom."""
        return self.n_cables == self.degrees_of_freedom

    @property
    def upright(self) -> FloatArray:
        """Rotation (3, 3) from the base frame to a frame whose z axis is the true vertical."""
        return np.asarray(Rotation.from_rotvec([*self.tilt_rad, 0.0]).as_matrix())

    @property
    def attachments_m(self) -> FloatArray:
        """Attachment points in the body frame, zeros for a point mass (n_cables, 3) [m]."""
        if self.platform.attachments_m is None:
            return frozen_array(np.zeros((self.n_cables, 3)))
        return self.platform.attachments_m

    @property
    def weight_N(self) -> float:
        """Weight of the platform [N]."""
        return self.platform.mass_kg * STANDARD_GRAVITY_M_PER_S2


@dataclass(frozen=True, slots=True, eq=False)
class Poses:
    """A batch of platform poses, over any leading axes.

    Parameters
    ----------
    position_m : array (..., 3)
        Origin of the body frame in the world frame [m].
    rotation : array (..., 3, 3)
        Rotation from the body frame to the world frame; may be one matrix (3, 3) for all.
    """

    position_m: FloatArray
    rotation: FloatArray

    @classmethod
    def at(cls, position_m: ArrayLike, rotation_vector_rad: ArrayLike | None = None) -> Poses:
        """Return poses from positions (..., 3) [m] and rotation vectors (..., 3) [rad]."""
        position = frozen_array(position_m)
        if rotation_vector_rad is None:
            return cls(position, frozen_array(np.eye(3)))
        vectors = np.asarray(rotation_vector_rad, dtype=np.float64)
        matrices = Rotation.from_rotvec(vectors.reshape(-1, 3)).as_matrix()
        return cls(position, frozen_array(matrices.reshape(*vectors.shape[:-1], 3, 3)))

    @property
    def shape(self) -> tuple[int, ...]:
        """Leading axes of the batch."""
        return self.position_m.shape[:-1]

    def attachment_points_m(self, robot: Robot) -> FloatArray:
        """Return the attachment points in the world frame (..., n_cables, 3) [m]."""
        levers = np.einsum("...ij,nj->...ni", self.rotation, robot.attachments_m)
        return np.asarray(self.position_m[..., None, :] + levers, dtype=np.float64)
