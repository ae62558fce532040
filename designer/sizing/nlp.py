"""Sizing as a constrained optimum, Riehl et al., ICRA 2010, section IV.C: the readable reference.

One pose at a time, by SciPy's SLSQP on the paper's own unknowns and equations. The compiled Newton
of `designer.sizing.newton` is tested against it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from designer.arrays import FloatArray
from designer.model.cable import STANDARD_GRAVITY_M_PER_S2, Material
from designer.model.robot import Poses, Robot
from designer.physics import catenary
from designer.statics.geometry import (
    CableGeometry,
    cable_geometry,
    load_wrench_N,
    structure_matrix,
)
from designer.statics.inverse import solve_massless

_LEAST_SHARE = 0.02
"""Of the largest tension, that each cable starts with: a slack one has no slope to follow."""


@dataclass(frozen=True, slots=True, eq=False)
class NlpSizing:
    """The optimum and how well it meets its constraints.

    Parameters
    ----------
    diameter_m : float
        Nominal diameter [m]; NaN if the optimiser failed.
    length_m, force_x_N, force_z_N : array (n_cables,)
        Unstrained lengths [m] and forces on the cables at the platform [N].
    largest_residual : float
        Worst violation of any constraint, each over its scale.
    has_converged : bool
        Whether the optimiser reports success and the residual is below 1e-8.
    message : str
        The optimiser's own words.
    """

    diameter_m: float
    length_m: FloatArray
    force_x_N: FloatArray
    force_z_N: FloatArray
    largest_residual: float
    has_converged: bool
    message: str


def size_by_nlp(robot: Robot, pose: Poses, material: Material) -> NlpSizing:
    """Minimise the linear density subject to eqs. (9), (11), (12) and (14).

    Parameters
    ----------
    robot : Robot
        The robot.
    pose : Poses
        A single pose that straight cables can hold.
    material : Material
        The family of cables.

    Raises
    ------
    ValueError
        If straight cables cannot hold the pose, so that there is no start, or if the robot has
        pulleys or a least tension, which the paper's equations do not know.
    """
    if robot.pulley_radius_m != 0.0 or robot.tension_min_N > 0.0:
        raise ValueError("the reference has no pulleys and no least tension")
    from scipy.optimize import minimize

    problem = _NonlinearProgramme.of(robot, pose, material)
    answer = minimize(
        lambda u: u[-1],
        problem.start(),
        jac=lambda u: np.eye(u.size)[-1],
        method="SLSQP",
        bounds=[(1e-9, None) if k % 3 != 1 else (None, None) for k in range(3 * robot.n_cables)]
        + [(1e-9, None)],
        constraints=[
            {"type": "eq", "fun": problem.equations},
            {"type": "ineq", "fun": problem.strength_margin},
        ],
        options={"ftol": 1e-14, "maxiter": 400},
    )
    worst = max(
        float(np.abs(problem.equations(answer.x)).max()),
        float(np.maximum(-problem.strength_margin(answer.x), 0.0).max()),
    )
    # SLSQP may stop on its line search at the rounding floor; the residual is what counts.
    converged = worst < 1e-8
    force_x, force_z, length, density = problem.unpack(answer.x)
    area = np.max(density / material.density_kg_per_m3)
    return NlpSizing(
        diameter_m=float(np.sqrt(4.0 * area / np.pi)) if converged else float("nan"),
        length_m=length,
        force_x_N=force_x,
        force_z_N=force_z,
        largest_residual=worst,
        has_converged=converged,
        message=str(answer.message),
    )


@dataclass(frozen=True, slots=True, eq=False)
class _NonlinearProgramme:
    """The constraints in scaled unknowns (F_x, F_z, l of each cable, then ρ₀): eq. (13).

    Forces are over the largest of straight cables, lengths over the chord, and the linear density
    is over that of the massless design.
    """

    material: Material
    geometry: CableGeometry
    matrix: FloatArray
    load_N: FloatArray
    tension_N: FloatArray
    force_N: float

    @classmethod
    def of(cls, robot: Robot, pose: Poses, material: Material) -> _NonlinearProgramme:
        geometry = cable_geometry(robot, pose)
        massless = solve_massless(robot, pose)
        largest = float(massless.largest_tension_N)
        if not largest > 0.0:
            raise ValueError("straight cables cannot hold this pose")
        tension = np.maximum(massless.tension_N, _LEAST_SHARE * largest)
        matrix, load = structure_matrix(robot, geometry), load_wrench_N(robot, pose)
        return cls(material, geometry, matrix, load, tension, float(tension.max()))

    def start(self) -> FloatArray:
        """The massless design, as the loop has it."""
        pull = self.tension_N / self.geometry.chord_m / self.force_N
        X, D = self.geometry.horizontal_distance_m, self.geometry.drop_m
        return np.append(np.stack([pull * X, -pull * D, np.ones_like(X)], axis=1).ravel(), 1.0)

    def unpack(
        self, u: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray, float | FloatArray]:
        """Return F_x, F_z [N], unstrained lengths [m] and linear density [kg/m]."""
        cables = u[:-1].reshape(-1, 3)
        section = float(u[-1]) * self.force_N / self.material.allowable_stress_Pa
        return (
            cables[:, 0] * self.force_N,
            cables[:, 1] * self.force_N,
            cables[:, 2] * self.geometry.chord_m,
            section * self.material.density_kg_per_m3,
        )

    def equations(self, u: FloatArray) -> FloatArray:
        """Eqs. (11) and (12) over the chord, eq. (9) over the largest force."""
        force_x, force_z, length, density = self.unpack(u)
        stiffness = self.material.youngs_modulus_Pa * density / self.material.density_kg_per_m3
        weight = density * STANDARD_GRAVITY_M_PER_S2
        x, z = catenary.end_position_m(length, force_x, force_z, stiffness, weight)
        forces = np.stack([force_x, force_z], axis=1).ravel()
        balance = (self.matrix @ forces - self.load_N) / self.force_N
        at = self.geometry
        closure = np.concatenate([x - at.horizontal_distance_m, z + at.drop_m])
        return np.concatenate([closure / np.tile(at.chord_m, 2), balance])

    def strength_margin(self, u: FloatArray) -> FloatArray:
        """Eq. (14), the allowable stress minus the stress at the exit point, over the former."""
        force_x, force_z, length, density = self.unpack(u)
        weight = density * STANDARD_GRAVITY_M_PER_S2
        exit_N, platform_N = catenary.end_tensions_N(length, force_x, force_z, weight)
        section = density / self.material.density_kg_per_m3
        limit_N = self.material.allowable_stress_Pa * section
        return np.asarray((limit_N - np.maximum(exit_N, platform_N)) / limit_N)
