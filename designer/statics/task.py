"""A task for the kernel: poses made upright, and cables led over their pulleys."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from itertools import count
from typing import TYPE_CHECKING, Any

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.kernel.calling import Situation, plain
from designer.model.robot import SAG_MAX, Poses, Robot
from designer.model.verdict import Verdict, are_open
from designer.physics import pulley
from designer.progress import checkpoint
from designer.statics.geometry import (
    CableGeometry,
    cable_geometry,
    level_geometry,
    upright_exit_points_m,
    upright_situation,
)
from designer.statics.pulleys import (
    MOST_ITERATIONS,
    PATIENCE,
    SETTLED_RAD,
    STILL_RAD,
    PulleyRun,
    over_pulleys,
    run_at,
    straight_run,
)

if TYPE_CHECKING:
    from designer.kernel.batch import Solution

_FEW_TURNS = 5
"""Of pulleys, for the poses that straight cables do not bring to rest."""
LONG = 1.5
"""Length over chord above which a cable counts as far too long."""
_NO_LENGTH = 1e-12
"""Of a chord over the longest one of the pose: the attachment is at the exit point."""


@dataclass(frozen=True, slots=True, eq=False)
class Task:
    """What the kernel is asked for; see `designer.kernel.batch.solve_batch`.

    Parameters
    ----------
    situation : Situation
        Poses (n_poses,) and load, the cables beginning at the exit points; see `situation_at`.
    kappa_per_m, strength_m : float or array (n_cables,) or (n_poses, 1 or n_cables)
        Weight over axial stiffness [1/m], allowable tension over weight [m]; one for all cables, or
        each its own, in all poses or each.
    inverse_weight_m_per_N : float, array (n_poses,) or None
        1 / w; None asks for the lightest cable.
    relative_weights : float or array (n_cables,) or (n_poses, 1 or n_cables)
        Weight of the cables relative to w.
    sag_max : float
        Largest sag over chord.
    """

    situation: Situation
    kappa_per_m: float | FloatArray
    strength_m: float | FloatArray
    inverse_weight_m_per_N: float | FloatArray | None
    relative_weights: float | FloatArray = 1.0
    sag_max: float = SAG_MAX

    def part(self, at: IntArray) -> Task:
        """Return the task for some of poses (n_poses,)."""
        changed: dict[str, Any] = {"situation": self.situation.part(at)}
        for name in ("kappa_per_m", "strength_m", "relative_weights"):
            values = getattr(self, name)
            if np.ndim(values) == 2:
                changed[name] = values[at]
        inverse = self.inverse_weight_m_per_N
        if isinstance(inverse, np.ndarray) and inverse.ndim == 1:
            changed["inverse_weight_m_per_N"] = inverse[at]
        return replace(self, **changed)


def situation_at(robot: Robot, poses: Poses, force_N: FloatArray | None = None) -> Situation:
    """Return what kernels are told of poses (...), flattened, without pulleys.

    And of a force (..., 3) on the platform beside its weight, base frame [N].
    """
    if force_N is not None:
        force_N = np.broadcast_to(force_N, poses.position_m.shape).reshape(-1, 3)
    return upright_situation(robot, poses.flat, upright_exit_points_m(robot), force_N)


def solve_task(
    robot: Robot, poses: Poses, task: Task, *, proves_best: bool = False
) -> tuple[Solution, PulleyRun]:
    """Solve poses (...), flattened to one axis, of which the task tells `situation_at`."""
    checkpoint()
    flat = poses.flat
    solution, run = _solve_over_pulleys(robot, flat, task, proves_best=proves_best)
    _judge_unsolved(robot, flat, solution, task, is_taut=robot.is_redundant)
    at = np.flatnonzero(are_open(solution.verdict))
    if robot.is_square and len(at) > 0 and np.all(task.inverse_weight_m_per_N != 0.0):
        # Most are proved to be impossible before the solver of taut cables need be compiled.
        some, part = flat.part(at), task.part(at)
        again, its_run = _solve_over_pulleys(robot, some, part, decides=True)
        _judge_unsolved(robot, some, again, part, is_taut=True)
        _replace(solution, run, at, again, its_run)
    if robot.pulley_radius_m == 0.0:
        return solution, run
    shape = (*poses.shape, robot.n_cables)
    points = run.exit_points_m.reshape(*shape, 3)
    return solution, PulleyRun(points, run.wrap_m.reshape(shape))


def _solve_over_pulleys(
    robot: Robot, flat: Poses, task: Task, turns: int = 1, **wishes: bool
) -> tuple[Solution, PulleyRun]:
    """Solve with one turn, and those poses that have not come to rest again with more."""
    from designer.kernel.batch import solve_batch

    ones = np.ones(robot.n_cables)
    pulleys_m = upright_exit_points_m(robot) if robot.pulley_radius_m > 0.0 else None
    # Of several equilibria it is to stay with one, or the tangent points swing between them.
    follows = turns > PATIENCE
    near = np.full((len(flat.position_m) if follows else 0, robot.n_cables + 1), np.nan)
    turn = count()

    def solve(run: PulleyRun) -> tuple[Solution, FloatArray, float]:
        solution = solve_batch(
            robot,
            task.situation.starting_at(run.exit_points_m),
            task.kappa_per_m * ones,
            task.relative_weights * ones,
            task.strength_m * ones,
            task.inverse_weight_m_per_N,
            sag_max=task.sag_max,
            pulleys_m=pulleys_m,
            near=near if next(turn) >= PATIENCE else None,
            **wishes,
        )
        if robot.pulley_radius_m == 0.0:  # no cable leaves at an angle that matters
            return solution, np.empty(0), 0.0
        with np.errstate(invalid="ignore"):  # forces are infinite at infinite section
            weight = solution.weight_N_per_m[:, None] * task.relative_weights
            downward = weight * solution.length_m - solution.force_z_N
        slope_rad = np.arctan2(downward, solution.force_x_N)
        is_solved = (solution.verdict == Verdict.SOLVED)[:, None]
        if follows:
            across = cable_geometry(robot, flat, run.exit_points_m).horizontal_distance_m
            with np.errstate(invalid="ignore", divide="ignore"):
                pulls = solution.force_x_N / (weight * across)
            answer = np.hstack([pulls, 1.0 / solution.weight_N_per_m[:, None]])
            np.copyto(near, answer, where=is_solved)
        return solution, np.where(is_solved, slope_rad, solution.leaving_rad), 0.0

    solution, run, gap_rad = over_pulleys(robot, flat, solve, turns)
    if turns >= MOST_ITERATIONS:  # what is said of poses that did not settle is taken back
        lost = ~(gap_rad <= SETTLED_RAD) & (solution.verdict == Verdict.SOLVED)
        solution.verdict[lost] = Verdict.NOT_CONVERGED
        for values in (getattr(solution, field.name) for field in fields(solution)):
            if values.dtype == np.float64:
                values[lost] = np.nan
        return solution, run
    at = np.flatnonzero(gap_rad > STILL_RAD)
    if len(at) > 0:
        again, its_run = _solve_over_pulleys(
            robot, flat.part(at), task.part(at), max(2 * turns, _FEW_TURNS), **wishes
        )
        _replace(solution, run, at, again, its_run)
    return solution, run


def _replace(
    solution: Solution, run: PulleyRun, at: IntArray, by: Solution, its_run: PulleyRun
) -> None:
    """Write the answers for the poses `at`, and their run, over the former."""
    for field in fields(solution):
        getattr(solution, field.name)[at] = getattr(by, field.name)
    if run.exit_points_m.ndim > 2:
        run.exit_points_m[at], run.wrap_m[at] = its_run.exit_points_m, its_run.wrap_m


def _judge_unsolved(
    robot: Robot, flat: Poses, solution: Solution, task: Task, *, is_taut: bool
) -> None:
    """Say of poses without a solution what is proved of any cables, straight or sagging.

    What the solver has proved stands unless that is more; over pulleys, where they are near or
    cables bow out, only that of taut cables does.
    """
    from designer.kernel.batch import refuse_batch

    unsolved = np.flatnonzero(solution.verdict != Verdict.SOLVED)
    if len(unsolved) == 0:
        return
    poses = flat.part(unsolved)
    points = straight_run(robot, poses).exit_points_m
    situation = task.situation.part(unsolved).starting_at(points)
    is_near, least_N = np.zeros(len(unsolved), dtype=np.bool_), robot.tension_min_N
    bows_out, level = False, level_geometry(robot, poses)
    chord_m = np.hypot(level.horizontal_distance_m, level.drop_m)
    has_no_length = chord_m.min(axis=1) <= _NO_LENGTH * chord_m.max(axis=1)
    has_no_length |= np.isnan(points).any(axis=(-2, -1))
    if robot.pulley_radius_m > 0.0:  # the cone bounds a cable only beyond its pulley
        is_near |= (level.horizontal_distance_m < 2.0 * robot.pulley_radius_m).any(axis=1)
        bows_out = robot.cable_load_direction is not None
        if bows_out:
            situation, least_N = _between_tangents(robot, level, situation), 0.0
    verdict, wrench, _ = refuse_batch(situation, least_N if robot.is_redundant else 0.0)
    of_solver = solution.verdict[unsolved]
    verdict[is_near] = Verdict.NOT_CONVERGED
    says_more = ~np.isin(verdict, (Verdict.OUTSIDE_HULL, Verdict.RANK_DEFICIENT))
    says_more &= (of_solver != Verdict.NOT_CONVERGED) & (is_taut | ~(is_near | bows_out))
    verdict = np.where(says_more, of_solver, verdict)
    verdict[has_no_length] = Verdict.NO_LENGTH
    solution.verdict[unsolved] = verdict
    solution.wrench[unsolved] = np.where(
        are_open(verdict)[:, None],
        np.nan,
        np.where(says_more[:, None], solution.wrench[unsolved], wrench),
    )


def _between_tangents(robot: Robot, level: CableGeometry, situation: Situation) -> Situation:
    """Return a situation with a second cable from the lower end of each pulley, as it is seen.

    Where the load on a cable is not vertical, its chord may rise more than that of a straight one
    as seen across the load; but it stays between these two.
    """
    slope = pulley.lower_slope_rad(level.horizontal_distance_m, level.drop_m, robot.pulley_radius_m)
    lower = run_at(robot, level, slope).exit_points_m
    return situation._replace(
        exit_points=plain(np.concatenate([situation.exit_points, lower], axis=1)),
        attachments=plain(np.tile(situation.attachments, (2, 1))),
    )
