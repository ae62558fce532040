"""Sizing by batched, compiled Newton, and how near a pose is to having no finite cable at all."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from designer import checked
from designer.arrays import BoolArray, FloatArray
from designer.model.cable import STANDARD_GRAVITY_M_PER_S2, Material, MaterialsByPose
from designer.model.robot import Poses, Robot
from designer.model.verdict import Verdict
from designer.statics.inverse import Statics, statics_of
from designer.statics.task import Task, situation_at, solve_task


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Sizing(checked.Shown):
    """The thinnest cable of a family for each pose; NaN wherever the verdict is not solved.

    Parameters
    ----------
    statics : Statics
        Equilibrium with that cable, and the verdicts (...).
    diameter_m : array (...)
        Nominal diameter [m].
    massless_tension_N, massless_diameter_m : array (...)
        Largest tension [N] of straight weightless cables and the diameter [m] that it asks for:
        what the design would be if sag were ignored.
    closure_residual_m : array (...)
        Worst closure error of the solver's own form of eqs. (7)-(8) [m].
    equilibrium_residual_N : array (...)
        What is left of the platform's balance, moments divided by the platform's reach [N].
    is_thinnest : array (...)
        Whether it is known that no thinner cable of the family holds the pose: of a point mass on
        as few cables as hold it, which has one equilibrium, and where that was to be proved.
    """

    statics: Statics
    diameter_m: FloatArray
    massless_tension_N: FloatArray
    massless_diameter_m: FloatArray
    closure_residual_m: FloatArray
    equilibrium_residual_N: FloatArray
    is_thinnest: BoolArray


def size_poses(
    robot: Robot,
    poses: Poses,
    material: Material | MaterialsByPose,
    *,
    proves_thinnest: bool = False,
) -> Sizing:
    """Return the thinnest cable of the family for each pose (...).

    Solves Riehl et al., ICRA 2010, eqs. (9) and (11)-(14), where at the optimum the most loaded
    cable is at the allowable stress, by the compiled Newton of `designer.kernel.square`; with more
    cables than degrees of freedom, over all internal forces, by `designer.kernel.redundant`. Where
    it ``proves_thinnest`` it is proved of such a robot that no thinner taut cable holds a pose, to
    five parts in a million, or such a cable is the answer.
    """
    task = _task(robot, poses, material, None)
    solution, run = solve_task(robot, poses, task, proves_best=proves_thinnest)
    heaviest = _densities(material).max(axis=-1)
    area = solution.weight_N_per_m / (STANDARD_GRAVITY_M_PER_S2 * heaviest)
    massless_area = solution.massless_tension_N / material.allowable_stress_Pa
    shape = poses.shape
    return Sizing(
        statics=statics_of(
            robot,
            poses,
            solution,
            run,
            material.youngs_modulus_Pa * area,
            relative_weights=task.relative_weights,
        ),
        diameter_m=np.sqrt(4.0 * area / np.pi).reshape(shape),
        massless_tension_N=solution.massless_tension_N.reshape(shape),
        massless_diameter_m=np.sqrt(4.0 * massless_area / np.pi).reshape(shape),
        closure_residual_m=solution.closure_residual_m.reshape(shape),
        equilibrium_residual_N=solution.equilibrium_residual_N.reshape(shape),
        is_thinnest=(
            (solution.verdict == Verdict.SOLVED) & (solution.is_best | robot.has_one_branch)
        ).reshape(shape),
    )


def limit_ratio(robot: Robot, poses: Poses, material: Material) -> FloatArray:
    """Return the stress at infinite section over the allowable stress, for each pose (...).

    As the section grows, the platform's weight stops mattering: the cables hang between the exit
    points and a weightless platform, and their stress tends to a value that depends on geometry
    and ρ g only. The margin to the boundary of the workspace is 1 minus this ratio: below 1, a
    finite cable exists. At or above 1 none does where the taut cable sets the ratio; where it is
    the slack one, pulling it up may still help, which the verdict of the sizing decides.

    With more cables than degrees of freedom it is the least ratio that any internal forces reach.

    NaN where no taut cables balance a weightless platform, so that no limit exists, and where it
    was not solved.
    """
    solution, _ = solve_task(robot, poses, _task(robot, poses, material, 0.0))
    return solution.load_factor.reshape(poses.shape)


def _task(
    robot: Robot,
    poses: Poses,
    material: Material | MaterialsByPose,
    inverse_m_per_N: float | None,
) -> Task:
    density = _densities(material)
    heaviest = density.max(axis=-1, keepdims=True)
    return Task(
        situation_at(robot, poses),
        np.reshape(material.elastic_compliance_per_m, density.shape),
        np.reshape(material.strength_length_m, density.shape),
        inverse_m_per_N,
        relative_weights=density / heaviest,
        sag_max=robot.sag_max,
    )


def _densities(material: Material | MaterialsByPose) -> FloatArray:
    """Return densities (1 or n_cables,), or (n_poses, 1 or n_cables) [kg/m³]."""
    density = np.atleast_1d(material.density_kg_per_m3)
    is_by_pose = isinstance(material, MaterialsByPose) and density.ndim == 1
    return density[:, None] if is_by_pose else density
