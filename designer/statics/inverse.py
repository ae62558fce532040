r"""From pose to lengths and tensions: the inverse statics of a robot with given cables.

Where there are more cables than degrees of freedom, straight ones share the load as follows. With
unit vectors :math:`u_i` along the cables, levers :math:`r_i` and the load wrench w, tensions t hold
a pose if

.. math::  A\,t = w, \quad A_i = (u_i,\; r_i \times u_i), \qquad t_{min} \le t_i.

What is left to choose is settled by a linear programme. Each answer carries its own proof: the
residual of the optimality conditions with the solver's multipliers. After Gouttefarde, Daney and
Merlet, IEEE Transactions on Robotics 27(1), 2011, for the set of wrenches, and Pott, Cable-Driven
Parallel Robots (2018), section 3.7, for the objective.

The supports of the exit points, masts, frames and pulleys, are pulled with the tension that a cable
has there, along its own tangent toward the platform:

.. math::  R = F - q\,l

with F the pull of the platform on the cable, q its load per unstrained length l of what hangs free.
Where a sheave redirects it, the branch that goes on to the winch pulls with the same tension along
its own direction; friction and the weight of that branch are left out.
"""

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
from designer.spelling import vector
from designer.statics.geometry import (
    CableGeometry,
    cable_geometry,
    density_matrix,
    load_wrench_N,
    plane_vector,
    structure_matrix,
    upright_poses,
    upright_situation,
)
from designer.statics.pulleys import PulleyRun, straight_run
from designer.statics.task import Task, situation_at, solve_task

if TYPE_CHECKING:
    from designer.kernel.batch import Solution

_PROVEN = 1e-6
"""Residual of the optimality conditions up to which they count as met."""
_MARGINAL = 0.2
"""Part of a wrench of unit length that its words leave out."""
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(16)


def distribute_evenly(robot: Robot, poses: Poses) -> FloatArray:
    """Return the tensions with the smallest largest one (..., n_cables), in poses (...) [N].

    None is below `Robot.tension_min_N`. NaN where no tensions hold the pose, or are not proved to
    be the best.
    """
    tension_N, _ = _tensions_and_bounds(robot, poses.flat)
    return tension_N.reshape(*poses.shape, robot.n_cables)


def tension_over_least(robot: Robot, poses: Poses) -> FloatArray:
    """Return how far each cable is above its least tension (n_poses, n_cables) [N], or from it.

    By the tensions of `distribute_evenly`. Where a cable has just its least, minus the newtons that
    the largest tension would grow by with each newton more in it; so this rises towards where a
    cable begins to carry. NaN where no tensions hold the pose.
    """
    tension_N, bound = _tensions_and_bounds(robot, poses)
    over_N = tension_N - robot.tension_min_N
    return np.where(over_N <= _PROVEN * tension_N.max(axis=1, keepdims=True), bound, over_N)


def _tensions_and_bounds(robot: Robot, flat: Poses) -> tuple[FloatArray, FloatArray]:
    """Return the tensions [N] and the multipliers of their bounds (n_poses, n_cables).

    Those of t ≤ largest are positive and sum to one, those of t ≥ low negative.
    """
    from designer.kernel.batch import solve_massless_batch

    exit_points_m = straight_run(robot, flat).exit_points_m
    situation = upright_situation(robot, flat, exit_points_m)
    tension_N, dual, _ = solve_massless_batch(robot, situation)
    geometry = cable_geometry(robot, flat, exit_points_m)
    with np.errstate(invalid="ignore"):  # a cable of no length has no direction
        matrix = density_matrix(robot, geometry) / geometry.chord_m[..., None, :]
    # With multipliers y of the balance, those of the bounds are the parts of -Aᵀy.
    bound = -np.einsum("pi,pij->pj", dual, matrix)
    total = np.maximum(bound, 0.0).sum(axis=1, keepdims=True)
    bound = bound / np.where(total > 0.0, total, np.nan)
    proven = _residual(robot, matrix, load_wrench_N(robot, flat), tension_N, bound) < _PROVEN
    return np.where(proven[:, None], tension_N, np.nan), bound


def _residual(
    robot: Robot, matrix: FloatArray, load: FloatArray, tension_N: FloatArray, bound: FloatArray
) -> FloatArray:
    """Return the residual of optimality (n_poses,), forces over the largest load.

    The multiplier of each bound has to vanish off it. Moments are taken over the reach of the
    attachments.
    """
    room = tension_N.max(axis=1, keepdims=True) - tension_N
    height = tension_N - robot.tension_min_N
    slackness = np.where(bound > 0.0, bound * room, -bound * height)
    reach = float(np.abs(robot.attachments_m).sum(axis=1).max()) or 1.0
    lever = np.where(robot.balance_rows < 3, 1.0, reach)
    imbalance = (np.einsum("pij,pj->pi", matrix, tension_N) - load) / lever
    parts = np.hstack([np.abs(imbalance), -height, np.abs(slackness)])
    return np.asarray(parts.max(axis=1) / (np.abs(load / lever).max(initial=0.0) or 1.0))


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Statics(checked.Shown):
    """Static equilibrium of poses with sagging cables; NaN wherever the verdict is not solved."""

    robot: Robot
    poses: Poses  #: (...)
    verdict: VerdictArray  #: one `Verdict` a pose
    weight_N_per_m: FloatArray  #: (..., 1 or n_cables) per unstrained length [N/m]
    axial_stiffness_N: FloatArray  #: (..., 1 or n_cables) EA [N]
    #: (..., n_cables) unstrained, from the exit points, around pulleys where there are any [m]
    length_m: FloatArray
    #: (..., n_cables) force on each cable at the platform, away from the exit point [N]; Riehl et
    #: al., ICRA 2010, section II.B
    force_x_N: FloatArray
    force_z_N: FloatArray  #: (..., n_cables) the same, upward [N]
    run: PulleyRun  #: where the cables leave their pulleys, and how much lies on them
    #: (..., 3) force on the platform beside its weight, base frame [N]
    force_N: FloatArray | None = None
    #: of a pose that one wrench proves to be impossible, that wrench, upright frame, of unit
    #: length, moments over the reach of the attachments: what is needed has a part along it, what
    #: the cables can do has none; NaN elsewhere
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
        motions = [
            f"{verb} {vector(part)}"
            for verb, part in zip(("push along", "turn it about"), parts, strict=True)
            if np.linalg.norm(part) > _MARGINAL
        ]
        return f"{verdict.sentence} The cables would have to {' and '.join(motions)}."

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
        wrench = np.einsum("...ij,...j->...i", matrix, flat)
        return np.asarray(wrench - load_wrench_N(self.robot, self.poses, self.force_N))

    def geometry(self) -> CableGeometry:
        """Return the chords of the cables, upright frame."""
        return cable_geometry(self.robot, self.poses, self.run.exit_points_m)

    def _chords_m(self) -> FloatArray:
        ends = upright_poses(self.robot, self.poses).attachment_points_m(self.robot)
        return np.asarray(ends - self.run.exit_points_m)


@dataclass(frozen=True, slots=True, eq=False)
class MasslessStatics:
    """Static equilibrium with straight, weightless cables."""

    length_m: FloatArray  #: (..., n_cables)
    tension_N: FloatArray  #: (..., n_cables); below zero where the cable would have to push

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


def exit_angle_rad(statics: Statics) -> FloatArray:
    """Return how far below the horizontal each cable leaves its exit point (..., n_cables) [rad].

    With V_0 = F_z - w l, the vertical pull at the exit point, tan α = -V_0 / F_x.
    """
    length, force_x, force_z, _, weight = statics.catenaries
    return np.asarray(np.arctan2(weight * length - force_z, force_x))


def sag_m(statics: Statics) -> FloatArray:
    """Return how far each cable strays from its chord (..., n_cables) [m]; see `physics.catenary`.

    Below the lower end is along the load on the cables, of weight and wind.
    """
    chord = statics.geometry()
    return catenary.sag_m(*statics.catenaries, chord.horizontal_distance_m, chord.drop_m)


def sag_ratio(statics: Statics) -> FloatArray:
    """Return the sag of each cable over its chord (..., n_cables), which `Robot.sag_max` limits."""
    return sag_m(statics) / statics.geometry().chord_m


def stretch_m(statics: Statics) -> FloatArray:
    """Return how much longer each cable is under its load (..., n_cables) [m].

    The integral of T / EA over the unstrained length between pulley and platform, with
    T = √(F_x² + V(s)²), by Gauss's rule with 16 points.
    """
    length, force_x, force_z, stiffness, weight = (v[..., None] for v in statics.catenaries)
    s = 0.5 * (1.0 + _POINTS) * length
    tension = np.hypot(force_x, force_z + weight * (s - length))
    return np.asarray((tension * _WEIGHTS).sum(axis=-1) * (0.5 * length / stiffness)[..., 0])


def platform_branch_N(statics: Statics) -> FloatArray:
    """Return the pull of the cables' runs to the platform on their supports (..., n_cables, 3) [N].

    World frame.
    """
    force_z = statics.force_z_N - statics.weight_N_per_m * statics.free_length_m
    pull = plane_vector(statics.force_x_N, force_z, statics.geometry().outward)
    return np.asarray(pull @ statics.robot.upright)


def winch_branch_N(statics: Statics) -> FloatArray | None:
    """Return the pull of the branches toward the winches (..., n_cables, 3), world frame [N].

    Straight down where there are pulleys, which a cable enters from below; else toward
    `Winches.positions_m`; None where nothing tells.
    """
    robot = statics.robot
    positions = robot.winches.positions_m
    if robot.pulley_radius_m != 0.0:
        direction = -robot.level[2]
    elif positions is not None:
        along = positions - robot.exit_points_m
        direction = along / np.linalg.norm(along, axis=1, keepdims=True)
    else:
        return None
    return np.asarray(statics.exit_tension_N[..., None] * direction)


def reaction_N(statics: Statics) -> FloatArray:
    """Return what the cables do to their supports by all known branches (..., n_cables, 3) [N]."""
    winch_branch = winch_branch_N(statics)
    pull = platform_branch_N(statics)
    return pull if winch_branch is None else pull + winch_branch
