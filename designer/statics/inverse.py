"""From pose to lengths and tensions: the inverse statics of a robot with given cables."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from designer.arrays import BoolArray, FloatArray, VerdictArray
from designer.cable import Cable
from designer.physics import catenary
from designer.robot import Poses, Robot
from designer.statics.geometry import (
    CableGeometry,
    cable_geometry,
    structure_matrix,
    weight_wrench_N,
)
from designer.statics.verdict import Verdict, hangs_below

if TYPE_CHECKING:
    from designer.kernel.batch import Solution


@dataclass(frozen=True, slots=True, eq=False)
class Statics:
    """Static equilibrium of poses with sagging cables; NaN wherever the verdict is not solved.

    Parameters
    ----------
    robot : Robot
        The robot.
    poses : Poses
        The poses (...).
    verdict : array (...) of int
        One `Verdict` a pose.
    weight_N_per_m, axial_stiffness_N : array (..., 1)
        Weight per unstrained length [N/m] and EA [N] of the cables in each pose.
    length_m : array (..., n_cables)
        Unstrained lengths [m].
    force_x_N, force_z_N : array (..., n_cables)
        Force on each cable at the platform: horizontal, away from the exit point, and vertical,
        upward [N]. Riehl et al., ICRA 2010, section II.B.
    """

    robot: Robot
    poses: Poses
    verdict: VerdictArray
    weight_N_per_m: FloatArray
    axial_stiffness_N: FloatArray
    length_m: FloatArray
    force_x_N: FloatArray
    force_z_N: FloatArray

    @property
    def is_solved(self) -> BoolArray:
        """Poses (...) that carry numbers."""
        return np.asarray(self.verdict == Verdict.SOLVED)

    @property
    def hangs_below(self) -> BoolArray:
        """Poses (...) in which a cable hangs below the platform."""
        return hangs_below(self.force_z_N)

    @property
    def exit_tension_N(self) -> FloatArray:
        """Tension at the exit points, eq. (10) of the paper (..., n_cables) [N]."""
        return self._end_tensions_N()[0]

    @property
    def platform_tension_N(self) -> FloatArray:
        """Tension at the platform (..., n_cables) [N]."""
        return self._end_tensions_N()[1]

    @property
    def largest_tension_N(self) -> FloatArray:
        """Largest tension anywhere in any cable (...) [N]."""
        return np.asarray(np.maximum(*self._end_tensions_N()).max(axis=-1))

    def closure_residual_m(self) -> FloatArray:
        """Distance between the end of each cable by eqs. (7)-(8) and its attachment point [m]."""
        geometry = self.geometry()
        x, z = catenary.end_position_m(
            self.length_m,
            self.force_x_N,
            self.force_z_N,
            self.axial_stiffness_N,
            self.weight_N_per_m,
        )
        return np.asarray(np.hypot(x - geometry.horizontal_distance_m, z + geometry.drop_m))

    def equilibrium_residual_N(self) -> FloatArray:
        """What is left of the platform's balance, eq. (9), (..., degrees of freedom) [N, N·m]."""
        matrix = structure_matrix(self.robot, self.geometry())
        forces = np.stack([self.force_x_N, self.force_z_N], axis=-1)
        held = np.einsum("...ij,...j->...i", matrix, forces.reshape(*self.verdict.shape, -1))
        return np.asarray(held - weight_wrench_N(self.robot, self.poses))

    def geometry(self) -> CableGeometry:
        """Return the chords of the cables."""
        return cable_geometry(self.robot, self.poses)

    def _end_tensions_N(self) -> tuple[FloatArray, FloatArray]:
        return catenary.end_tensions_N(
            self.length_m, self.force_x_N, self.force_z_N, self.weight_N_per_m
        )


@dataclass(frozen=True, slots=True, eq=False)
class MasslessStatics:
    """Static equilibrium with straight, weightless cables.

    Parameters
    ----------
    length_m, tension_N : array (..., n_cables)
        Lengths [m] and tensions [N]; a negative tension means that the cable would have to push.
    """

    length_m: FloatArray
    tension_N: FloatArray

    @property
    def largest_tension_N(self) -> FloatArray:
        """Largest tension (...) [N]; NaN where a cable would have to push."""
        feasible = np.all(self.tension_N >= 0.0, axis=-1)
        return np.where(feasible, self.tension_N.max(axis=-1), np.nan)


def solve_massless(robot: Robot, poses: Poses) -> MasslessStatics:
    """Return lengths and tensions of straight cables in poses (...), Riehl et al., section II.A.

    The unknowns are force densities, so that a vertical cable needs no special case.
    """
    geometry = cable_geometry(robot, poses)
    matrix = structure_matrix(robot, geometry)
    per_density = (
        matrix[..., 0::2] * geometry.horizontal_distance_m[..., None, :]
        - matrix[..., 1::2] * geometry.drop_m[..., None, :]
    )
    wrench = weight_wrench_N(robot, poses)
    with np.errstate(invalid="ignore", divide="ignore"):
        density = _solve_or_nan(per_density, wrench)
    return MasslessStatics(geometry.chord_m, density * geometry.chord_m)


def solve_sagging(robot: Robot, poses: Poses, cable: Cable) -> Statics:
    """Return the equilibrium of poses (...) with this cable, with sag and elasticity.

    Solves eqs. (7)-(9) of Riehl et al., ICRA 2010, by the compiled Newton of
    `designer.kernel.square`. A pose that fails is told by its verdict, never by an exception.
    """
    weight = cable.weight_N_per_m
    solution = solve_flat(
        robot,
        poses,
        kappa_per_m=weight / cable.axial_stiffness_N,
        strength_m=cable.allowable_tension_N / weight,
        inverse_weight_m_per_N=1.0 / weight,
    )
    stiffness = np.where(solution.verdict == Verdict.SOLVED, cable.axial_stiffness_N, np.nan)
    return statics_of(robot, poses, solution, stiffness)


def solve_flat(
    robot: Robot,
    poses: Poses,
    kappa_per_m: float,
    strength_m: float,
    inverse_weight_m_per_N: float | None,
) -> Solution:
    """Flatten the leading axes of the poses and call the kernel with equal cables."""
    from designer.kernel.batch import solve_batch

    count = int(np.prod(poses.shape, dtype=np.int64))
    rotation = poses.rotation
    if rotation.ndim > 2:
        rotation = np.broadcast_to(rotation, (*poses.shape, 3, 3)).reshape(-1, 3, 3)
    flat = Poses(poses.position_m.reshape(count, 3), rotation)
    each = np.ones(robot.n_cables)
    return solve_batch(
        robot, flat, kappa_per_m * each, each, strength_m * each, inverse_weight_m_per_N
    )


def statics_of(
    robot: Robot, poses: Poses, solution: Solution, axial_stiffness_N: FloatArray
) -> Statics:
    """Give a solution its leading axes back."""
    shape = poses.shape
    return Statics(
        robot=robot,
        poses=poses,
        verdict=solution.verdict.reshape(shape),
        weight_N_per_m=solution.weight_N_per_m.reshape(*shape, 1),
        axial_stiffness_N=axial_stiffness_N.reshape(*shape, 1),
        length_m=solution.length_m.reshape(*shape, -1),
        force_x_N=solution.force_x_N.reshape(*shape, -1),
        force_z_N=solution.force_z_N.reshape(*shape, -1),
    )


def _solve_or_nan(matrices: FloatArray, right: FloatArray) -> FloatArray:
    """Solve many small systems; a singular one gives NaN instead of an exception."""
    scale = np.abs(matrices).max(axis=(-2, -1), keepdims=True)
    singular = np.abs(np.linalg.det(matrices / scale)) < 1e-14
    safe = np.where(singular[..., None, None], np.eye(matrices.shape[-1]), matrices)
    solution = np.linalg.solve(safe, right[..., None])[..., 0]
    return np.where(singular[..., None], np.nan, solution)
