"""From pose to lengths and tensions: the inverse statics of a robot with given cables."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from designer import checked
from designer.arrays import BoolArray, FloatArray, IntArray, VerdictArray
from designer.model.cable import Cable, Cables
from designer.model.robot import Poses, Robot
from designer.model.verdict import Verdict, hanging_cables
from designer.physics import catenary
from designer.statics.distribution import distribute_evenly
from designer.statics.geometry import (
    CableGeometry,
    cable_geometry,
    density_matrix,
    load_wrench_N,
    structure_matrix,
    upright_poses,
)
from designer.statics.pulleys import PulleyRun, straight_run
from designer.statics.task import Task, situation_at, solve_task

if TYPE_CHECKING:
    from designer.kernel.batch import Solution


_MARGINAL = 0.2
"""Part of a wrench of unit length that its words leave out."""


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Statics(checked.Shown):
    """Static equilibrium of poses with sagging cables; NaN wherever the verdict is not solved.

    Parameters
    ----------
    robot : Robot
        The robot.
    poses : Poses
        The poses (...).
    verdict : array (...) of int
        One `Verdict` a pose.
    weight_N_per_m, axial_stiffness_N : array (..., 1 or n_cables)
        Weight per unstrained length [N/m] and EA [N] of the cables in each pose; one for all
        cables, or each its own.
    length_m : array (..., n_cables)
        Unstrained lengths from the exit points, around pulleys where there are any [m].
    force_x_N, force_z_N : array (..., n_cables)
        Force on each cable at the platform: horizontal, away from the exit point, and vertical,
        upward [N]. Riehl et al., ICRA 2010, section II.B.
    run : PulleyRun
        Where the cables leave their pulleys, and how much lies on them.
    force_N : array (..., 3) or None
        Force on the platform beside its weight, base frame [N].
    wrench : array (..., degrees of freedom) or None
        Of a pose that one wrench proves to be impossible, that wrench, upright frame, of unit
        length, moments over the reach of the attachments: what is needed has a part along it, what
        the cables can do has none. NaN elsewhere.
    """

    robot: Robot
    poses: Poses
    verdict: VerdictArray
    weight_N_per_m: FloatArray
    axial_stiffness_N: FloatArray
    length_m: FloatArray
    force_x_N: FloatArray
    force_z_N: FloatArray
    run: PulleyRun
    force_N: FloatArray | None = None
    wrench: FloatArray | None = None

    def part(self, rows: int | IntArray) -> Statics:
        """Return some of the poses by their numbers, without leading axes for a single number."""
        n, shape = self.robot.n_cables, self.verdict.shape

        def chosen(values: FloatArray, *rest: int) -> FloatArray:
            return np.broadcast_to(values, (*shape, *rest)).reshape(-1, *rest)[rows]

        run, poses = self.run, self.poses
        return Statics(
            robot=self.robot,
            poses=Poses(chosen(poses.position_m, 3), chosen(poses.rotation, 3, 3)),
            verdict=self.verdict.reshape(-1)[rows],
            weight_N_per_m=chosen(self.weight_N_per_m, n),
            axial_stiffness_N=chosen(self.axial_stiffness_N, n),
            length_m=chosen(self.length_m, n),
            force_x_N=chosen(self.force_x_N, n),
            force_z_N=chosen(self.force_z_N, n),
            run=PulleyRun(chosen(run.exit_points_m, n, 3), chosen(run.wrap_m, n)),
            force_N=None if self.force_N is None else chosen(self.force_N, 3),
            wrench=None if self.wrench is None else chosen(self.wrench, self.wrench.shape[-1]),
        )

    @property
    def sentence(self) -> str:
        """What became of a single pose, for the reader, with what the cables would have to do."""
        verdict = Verdict(int(self.verdict))
        if self.wrench is None or not np.isfinite(self.wrench).all():
            return verdict.sentence
        wrench = np.zeros(6)
        wrench[self.robot.balance_rows] = self.wrench
        parts = np.round(wrench.reshape(2, 3) @ self.robot.upright, 2) + 0.0
        what = [
            f"{verb} ({', '.join(f'{x:g}' for x in part)})"
            for verb, part in zip(("push along", "turn it about"), parts, strict=True)
            if np.linalg.norm(part) > _MARGINAL
        ]
        return f"{verdict.sentence} The cables would have to {' and '.join(what)}."

    @property
    def free_length_m(self) -> FloatArray:
        """Unstrained lengths between pulley and platform (..., n_cables) [m]."""
        return self.length_m - self.run.wrap_m

    @property
    def is_solved(self) -> BoolArray:
        """Poses (...) that carry numbers."""
        return np.asarray(self.verdict == Verdict.SOLVED)

    @property
    def hangs_below(self) -> BoolArray:
        """Poses (...) in which a cable from above hangs below the platform."""
        return np.asarray(self.hanging_cables.any(axis=-1))

    @property
    def hanging_cables(self) -> BoolArray:
        """Those cables (..., n_cables), along the true vertical whatever else loads them."""
        if self.robot.cable_load_direction is None:
            return hanging_cables(self.force_z_N, -self._chords_m()[..., 2])
        chord = self.geometry()
        *plan, up = self.robot.leaning[:, 2]
        along = chord.outward @ plan
        return hanging_cables(
            along * self.force_x_N + up * self.force_z_N,
            up * chord.drop_m - along * chord.horizontal_distance_m,
        )

    @property
    def end_tensions_N(self) -> tuple[FloatArray, FloatArray]:
        """Tensions at the exit points and at the platform, each (..., n_cables) [N]."""
        return catenary.end_tensions_N(
            self.free_length_m, self.force_x_N, self.force_z_N, self.weight_N_per_m
        )

    @property
    def exit_tension_N(self) -> FloatArray:
        """Tension at the exit points, eq. (10) of the paper (..., n_cables) [N]."""
        return self.end_tensions_N[0]

    @property
    def platform_tension_N(self) -> FloatArray:
        """Tension at the platform (..., n_cables) [N]."""
        return self.end_tensions_N[1]

    @property
    def cable_tension_N(self) -> FloatArray:
        """Largest tension anywhere in each cable (..., n_cables) [N]."""
        return np.asarray(np.maximum(*self.end_tensions_N))

    @property
    def least_tension_N(self) -> FloatArray:
        """Least tension anywhere in each cable (..., n_cables) [N]."""
        return catenary.least_tension_N(
            self.free_length_m, self.force_x_N, self.force_z_N, self.weight_N_per_m
        )

    @property
    def largest_tension_N(self) -> FloatArray:
        """Largest tension anywhere in any cable (...) [N]."""
        return np.asarray(self.cable_tension_N.max(axis=-1))

    @property
    def length_over_chord(self) -> FloatArray:
        """Unstrained length of each cable off its pulley over its chord (..., n_cables)."""
        return np.asarray(self.free_length_m / np.linalg.norm(self._chords_m(), axis=-1))

    @property
    def lowest_m(self) -> FloatArray:
        """Height of the lowest point of each cable's true shape (..., n_cables), level frame [m].

        Where the load on the cables is not vertical, it is lowest where its tension is level.
        """
        if self.robot.cable_load_direction is None:
            return self.run.exit_points_m[..., 2] + catenary.lowest_z_m(*self.catenaries)
        *plan, up = self.robot.leaning[:, 2]
        length, force_x, force_z, stiffness, weight = self.catenaries
        along = self.geometry().outward @ plan
        below = length - force_z / weight - along * force_x / (up * weight)
        s = np.clip(below, 0.0, length)
        x, z = catenary.position_m(s, length, force_x, force_z, stiffness, weight)
        start = self.run.exit_points_m @ self.robot.leaning[:, 2]
        return np.asarray(start + along * x + up * z)

    @property
    def catenaries(self) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]:
        """What `designer.physics` asks of a cable: length, forces x and z, EA, weight per length.

        Between pulley and platform (..., n_cables), in the order of its arguments.
        """
        return (
            self.free_length_m,
            self.force_x_N,
            self.force_z_N,
            self.axial_stiffness_N,
            self.weight_N_per_m,
        )

    def closure_residual_m(self) -> FloatArray:
        """Distance between the end of each cable by eqs. (7)-(8) and its attachment point [m]."""
        geometry = self.geometry()
        x, z = catenary.end_position_m(*self.catenaries)
        return np.asarray(np.hypot(x - geometry.horizontal_distance_m, z + geometry.drop_m))

    def equilibrium_residual_N(self) -> FloatArray:
        """What is left of the platform's balance, eq. (9), (..., degrees of freedom) [N, N·m]."""
        matrix = structure_matrix(self.robot, self.geometry())
        forces = np.stack([self.force_x_N, self.force_z_N], axis=-1)
        flat = forces.reshape(*self.verdict.shape, matrix.shape[-1])
        held = np.einsum("...ij,...j->...i", matrix, flat)
        return np.asarray(held - load_wrench_N(self.robot, self.poses, self.force_N))

    def geometry(self) -> CableGeometry:
        """Return the chords of the cables, upright frame."""
        return cable_geometry(self.robot, self.poses, self.run.exit_points_m)

    def _chords_m(self) -> FloatArray:
        ends = upright_poses(self.robot, self.poses).attachment_points_m(self.robot)
        return np.asarray(ends - self.run.exit_points_m)


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

    The unknowns are force densities, so that a vertical cable needs no special case. With more
    cables than degrees of freedom the tensions are those with the smallest largest one, NaN where
    none hold the pose.
    """
    run = straight_run(robot, poses)
    geometry = cable_geometry(robot, poses, run.exit_points_m)
    if robot.is_redundant:
        tension = distribute_evenly(robot, poses)
        return MasslessStatics(geometry.chord_m + run.wrap_m, tension)
    with np.errstate(invalid="ignore", divide="ignore"):
        matrices = density_matrix(robot, geometry)
        # A singular one gives NaN instead of an exception.
        scale = np.abs(matrices).max(axis=(-2, -1), keepdims=True)
        singular = np.abs(np.linalg.det(matrices / scale)) < 1e-14
        safe = np.where(singular[..., None, None], np.eye(matrices.shape[-1]), matrices)
        solution = np.linalg.solve(safe, load_wrench_N(robot, poses)[..., None])[..., 0]
        density = np.where(singular[..., None], np.nan, solution)
    return MasslessStatics(geometry.chord_m + run.wrap_m, density * geometry.chord_m)


def solve_sagging(
    robot: Robot,
    poses: Poses,
    cable: Cable | Cables,
    force_N: FloatArray | None = None,
) -> Statics:
    """Return the equilibrium of poses (...) with these cables, with sag and elasticity.

    Solves eqs. (7)-(9) of Riehl et al., ICRA 2010, by the compiled Newton of
    `designer.kernel.square`. A pose that fails is told by its verdict, never by an exception.

    Parameters
    ----------
    robot, poses, cable
        The robot, with at least as many cables as degrees of freedom, its poses, and its cables:
        one `Cable` for all, or `Cables`. Of more cables than that the internal forces are those
        with the smallest largest tension over the allowable one.
    force_N : array (..., 3), optional
        Force on the platform beside its weight, base frame [N].

    Raises
    ------
    ValueError
        If there are more or fewer `Cables` than exit points, or fewer than degrees of freedom.
    """
    weight = np.atleast_1d(cable.weight_N_per_m)
    fits = (robot.n_cables,), (*poses.shape, 1), (*poses.shape, robot.n_cables)
    if isinstance(cable, Cables) and weight.shape not in fits:
        raise ValueError(f"{weight.shape[-1]} cables do not fit {robot.n_cables} exit points")
    heaviest = weight.max(axis=-1, keepdims=True)
    task = Task(
        situation_at(robot, poses, force_N),
        kappa_per_m=weight / cable.axial_stiffness_N,
        strength_m=cable.allowable_tension_N / weight,
        inverse_weight_m_per_N=1.0 / heaviest[..., 0],
        relative_weights=weight / heaviest,
        sag_max=robot.sag_max,
    )
    solution, run = solve_task(robot, poses, task)
    solved = solution.verdict[:, None] == Verdict.SOLVED
    stiffness = np.where(solved, cable.axial_stiffness_N, np.nan)
    return statics_of(robot, poses, solution, run, stiffness, force_N, task.relative_weights)


def statics_of(
    robot: Robot,
    poses: Poses,
    solution: Solution,
    run: PulleyRun,
    axial_stiffness_N: FloatArray,
    force_N: FloatArray | None = None,
    relative_weights: float | FloatArray = 1.0,
) -> Statics:
    """Give a solution its leading axes back, and its lengths what lies on the pulleys.

    EA (n_poses,) is that of every cable, EA (n_poses, 1 or n_cables) that of each.
    """
    shape = poses.shape
    weight = solution.weight_N_per_m.reshape(*shape, 1) * relative_weights
    cable_shape = *shape, robot.n_cables  # no -1, which says nothing of no poses
    stiffness = axial_stiffness_N.reshape(*shape, *(axial_stiffness_N.shape[1:] or (1,)))
    free = solution.length_m.reshape(cable_shape)
    force_x = solution.force_x_N.reshape(cable_shape)
    force_z = solution.force_z_N.reshape(cable_shape)
    if run.has_wrap:
        exit_N, _ = catenary.end_tensions_N(free, force_x, force_z, weight)
        run = run.unstrained(exit_N / stiffness)
    return Statics(
        robot=robot,
        poses=poses,
        verdict=solution.verdict.reshape(shape),
        weight_N_per_m=weight,
        axial_stiffness_N=stiffness,
        length_m=free + run.wrap_m if run.has_wrap else free,
        force_x_N=force_x,
        force_z_N=force_z,
        run=run,
        force_N=force_N,
        wrench=solution.wrench.reshape(*shape, robot.degrees_of_freedom),
    )


def statics_with(
    robot: Robot,
    poses: Poses,
    cable: Cable | Cables,
    run: PulleyRun,
    verdict: VerdictArray,
    lengths_and_forces: FloatArray,
    force_N: FloatArray | None,
) -> Statics:
    """Return the statics of poses (n_poses,) with one cable for all, or `Cables`.

    ``lengths_and_forces`` are free lengths [m] and forces x and z at the platform [N],
    (3, n_poses, n_cables); NaN unless solved.
    """
    is_solved = (verdict == Verdict.SOLVED)[:, None]
    free, force_x, force_z = np.where(is_solved, lengths_and_forces, np.nan)
    ones = np.ones((len(verdict), 1))
    return Statics(
        robot=robot,
        poses=poses,
        verdict=verdict,
        weight_N_per_m=cable.weight_N_per_m * ones,
        axial_stiffness_N=cable.axial_stiffness_N * ones,
        length_m=free + run.wrap_m,
        force_x_N=force_x,
        force_z_N=force_z,
        run=run,
        force_N=force_N,
    )
