"""Sizing by batched, compiled Newton: what the workspace sweep uses."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from designer.arrays import FloatArray
from designer.cable import STANDARD_GRAVITY_M_PER_S2, Material
from designer.robot import Poses, Robot
from designer.statics.inverse import Statics, solve_flat, statics_of
from designer.statics.verdict import judge


@dataclass(frozen=True, slots=True, eq=False)
class Sizing:
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
    """

    statics: Statics
    diameter_m: FloatArray
    massless_tension_N: FloatArray
    massless_diameter_m: FloatArray
    closure_residual_m: FloatArray
    equilibrium_residual_N: FloatArray


def size_poses(robot: Robot, poses: Poses, material: Material) -> Sizing:
    """Return the thinnest cable of the family for each pose (...).

    Solves Riehl et al., ICRA 2010, eqs. (9) and (11)-(14), where at the optimum the most loaded
    cable is at the allowable stress, by the compiled Newton of `designer.kernel.square`.
    """
    from designer.kernel.square import TOLERANCE

    solution = solve_flat(
        robot,
        poses,
        kappa_per_m=material.elastic_compliance_per_m,
        strength_m=material.strength_length_m,
        inverse_weight_m_per_N=None,
    )
    verdict = judge(
        solution.residual,
        TOLERANCE,
        solution.inverse_weight_m_per_N,
        solution.overload,
        solution.massless_tension_N,
        sizing=True,
    )
    with np.errstate(divide="ignore", invalid="ignore"):
        weight = 1.0 / solution.inverse_weight_m_per_N
        area = np.where(
            verdict == 0, weight / (STANDARD_GRAVITY_M_PER_S2 * material.density_kg_per_m3), np.nan
        )
    statics = statics_of(robot, poses, solution, verdict, material.youngs_modulus_Pa * area)
    pushes = (solution.massless_tension_N < 0.0).any(axis=0)
    massless = np.where(pushes, np.nan, solution.massless_tension_N.max(axis=0))
    blank = np.where(verdict == 0, 1.0, np.nan)
    shape = poses.shape
    return Sizing(
        statics=statics,
        diameter_m=np.sqrt(4.0 * area / np.pi).reshape(shape),
        massless_tension_N=massless.reshape(shape),
        massless_diameter_m=np.sqrt(
            4.0 * massless / (np.pi * material.allowable_stress_Pa)
        ).reshape(shape),
        closure_residual_m=(solution.closure_m * blank).reshape(shape),
        equilibrium_residual_N=(solution.balance_m * weight * blank).reshape(shape),
    )
