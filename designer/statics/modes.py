r"""How the platform oscillates about its equilibrium, with winches braked.

.. math::

    K\,φ = (2 π f)^2 M\,φ, \qquad
    M = \begin{pmatrix} m I & -m [c] \\ m [c] & J + m [c]^\mathsf{T}[c] \end{pmatrix}
      + \sum_i \begin{pmatrix} M_i & -M_i [b_i] \\ [b_i] M_i & -[b_i] M_i [b_i] \end{pmatrix}

with K that of `designer.statics.stiffness`, m, c and J the platform's mass, the lever of its centre
of mass and its inertia about that, b_i the levers of the attachments, and M_i the share of each
cable that moves with its end (`designer.physics.inertia`). Over a pulley that share is of the cable
from where it leaves the pulley, as if held there. No damping.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from designer.arrays import FloatArray
from designer.model.robot import Platform, Robot
from designer.physics.inertia import consistent_mass_kg
from designer.statics.geometry import (
    centre_of_mass_arm_m,
    cross_matrix,
    in_space,
    upright_poses,
)
from designer.statics.inverse import Statics
from designer.statics.stiffness import per_reach, scaled, upright_stiffness


@dataclass(frozen=True, slots=True, eq=False)
class Mode:
    """One way in which the platform oscillates.

    Parameters
    ----------
    frequency_Hz : float
        Its natural frequency; 0 where the platform would not stay [Hz].
    shape : array (3,) or (6,)
        Displacement of the origin of the body frame, and turn, along the axes of the base frame
        [m, rad]; the attachment that moves farthest moves by 1 m.
    cable_share : float
        Share of the cables in the kinetic energy.
    """

    frequency_Hz: float
    shape: FloatArray
    cable_share: float


def knows_inertia(robot: Robot, body: Platform) -> bool:
    """Tell whether the inertia of all that moves is known: a point mass needs none."""
    return robot.is_point_mass or body.inertia_kg_m2 is not None


def cable_mass_matrix(statics: Statics, linear_density_kg_per_m: FloatArray | float) -> FloatArray:
    """Return what moves of the cables with the platform (..., dof, dof) [kg, kg·m, kg·m²].

    Upright frame, about the origin of the body frame; linear densities (1 or n_cables,) [kg/m].
    """
    robot, geometry = statics.robot, statics.geometry()
    plane, across = consistent_mass_kg(*statics.catenaries, linear_density_kg_per_m)
    outward = geometry.outward
    outward = np.where(outward.any(axis=-1, keepdims=True), outward, [1.0, 0.0])
    M = in_space(plane, across, outward)
    rows = robot.balance_rows
    if robot.is_point_mass:
        return np.asarray(M.sum(axis=-3)[..., rows[:, None], rows])
    B = cross_matrix(geometry.lever_m)
    BM = B @ M  # its transpose is -M @ B
    six = np.block(
        [
            [M.sum(axis=-3), np.swapaxes(BM.sum(axis=-3), -1, -2)],
            [BM.sum(axis=-3), -(BM @ B).sum(axis=-3)],
        ]
    )
    return np.asarray(six[..., rows[:, None], rows])


def platform_mass_matrix(statics: Statics, body: Platform) -> FloatArray:
    """Return the mass matrix of the platform itself, (..., dof, dof), as `cable_mass_matrix`."""
    robot = statics.robot
    turn = upright_poses(robot, statics.poses).rotations
    inertia = np.zeros((3, 3)) if body.inertia_kg_m2 is None else body.inertia_kg_m2
    C = cross_matrix(centre_of_mass_arm_m(robot, statics.poses))
    C = np.broadcast_to(C, turn.shape)
    J = turn @ inertia @ np.swapaxes(turn, -1, -2) - body.mass_kg * C @ C
    m = np.broadcast_to(body.mass_kg * np.eye(3), turn.shape)
    six = np.block([[m, -body.mass_kg * C], [body.mass_kg * C, J]])
    rows = robot.balance_rows
    return np.asarray(six[..., rows[:, None], rows])


def platform_frequencies_Hz(
    statics: Statics, body: Platform, linear_density_kg_per_m: FloatArray | float
) -> FloatArray:
    """Return the natural frequencies of the platform (..., dof), ascending [Hz].

    Parameters
    ----------
    statics : Statics
        Equilibria (...).
    body : Platform
        What is accelerated: mass and inertia without the dynamic factor of a load case.
    linear_density_kg_per_m : float or array (1 or n_cables,)
        Of the cables, with ice and without the load of the wind [kg/m].

    Returns
    -------
    array (..., dof)
        Zero for each way in which the platform would not stay; NaN where the pose is not solved or
        the platform's inertia is not known.
    """
    stiffness, _, _ = _modal_matrices(statics, body, linear_density_kg_per_m)
    is_known = (statics.is_solved & knows_inertia(statics.robot, body))[..., None]
    squares = np.asarray(np.linalg.eigvalsh(stiffness))
    return np.where(is_known, _frequencies_Hz(squares), np.nan)


def lowest_bound_Hz(
    statics: Statics, frequency_Hz: FloatArray | float, linear_density_kg_per_m: FloatArray | float
) -> FloatArray:
    """Return what the lowest frequency of platform and cables together is not below (...) [Hz].

    1/f² = 1/f_p² + 1/f_c², of the platform whose cables follow it as if at rest, which is the bound
    from above, and of the slowest cable between fixed ends: Dunkerley's rule for two parts, since
    no eigenvalue of a positive definite matrix is above the sum of those of its diagonal blocks.
    Nowhere is a cable softer than a string of its least tension T, so f_c is not below
    sqrt(T / (1 + T/EA) / m) / (2 l).
    """
    least = statics.least_tension_N
    softest = least / (1.0 + least / statics.axial_stiffness_N)
    cables = np.sqrt(softest / linear_density_kg_per_m) / (2.0 * statics.free_length_m)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray(1.0 / np.hypot(1.0 / np.asarray(frequency_Hz), 1.0 / cables.min(axis=-1)))


def platform_modes(
    statics: Statics, body: Platform, linear_density_kg_per_m: FloatArray | float
) -> tuple[Mode, ...]:
    """Return the modes of one equilibrium (), by frequency; parameters as above."""
    robot = statics.robot
    stiffness, to_shapes, cables = _modal_matrices(statics, body, linear_density_kg_per_m)
    squares, vectors = np.linalg.eigh(stiffness)
    vectors = to_shapes @ vectors
    full = np.zeros((len(squares), 6))
    full[:, robot.balance_rows] = vectors.T
    turned = (full.reshape(-1, 2, 3) @ robot.upright).reshape(-1, 6)
    levers = robot.attachments_m @ statics.poses.rotation.T
    moved = turned[:, None, :3] + np.cross(turned[:, None, 3:], levers)
    largest = np.linalg.norm(moved, axis=-1).max(axis=-1)
    leading = np.take_along_axis(turned, np.abs(turned).argmax(axis=1)[:, None], axis=1)[:, 0]
    shapes = turned / (largest * np.sign(leading))[:, None]
    # Eigenvectors have the kinetic energy of a unit mass.
    shares = np.einsum("ik,ij,jk->k", vectors, cables, vectors)
    rows = zip(_frequencies_Hz(squares).tolist(), shapes, shares.tolist(), strict=True)
    width = 3 if robot.is_point_mass else 6
    return tuple(Mode(frequency, shape[:width], share) for frequency, shape, share in rows)


def _frequencies_Hz(squares: FloatArray) -> FloatArray:
    """Return f of (2πf)²; 0 where that is negative."""
    return np.asarray(np.sqrt(np.maximum(squares, 0.0)) / (2.0 * np.pi))


def _modal_matrices(
    statics: Statics, body: Platform, linear_density_kg_per_m: FloatArray | float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the stiffness over the mass, and two further matrices (..., dof, dof).

    The eigenvalues of the first, which is symmetric, are (2πf)²; zero where the pose is not solved
    or the inertia not known. The second turns its eigenvectors into shapes of unit modal mass; the
    third is the mass of the cables.
    """
    robot = statics.robot
    is_known = statics.is_solved & knows_inertia(robot, body)
    # Turns are measured as displacements at the farthest attachment, or the numbers are far apart.
    scale = per_reach(robot)
    cables = cable_mass_matrix(statics, linear_density_kg_per_m)
    mass = scaled(robot, cables + platform_mass_matrix(statics, body))
    stiffness = scaled(robot, upright_stiffness(statics))
    stiffness = 0.5 * (stiffness + np.swapaxes(stiffness, -1, -2))
    known = is_known[..., None, None]
    root = np.linalg.cholesky(np.where(known, mass, np.eye(len(scale))))
    inverse = np.linalg.inv(root)
    turned = inverse @ np.where(known, stiffness, 0.0) @ np.swapaxes(inverse, -1, -2)
    return np.asarray(turned), scale[:, None] * np.swapaxes(inverse, -1, -2), cables
