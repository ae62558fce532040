"""A task for the kernel: poses made upright, and cables led over their pulleys."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from designer.arrays import BoolArray, FloatArray, IntArray
from designer.kernel.calling import Situation, plain
from designer.model.robot import Poses, Robot
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
    SETTLED_RAD,
    STILL_RAD,
    PulleyRun,
    over_pulleys,
    run_at,
    straight_run,
)

if TYPE_CHECKING:
    from designer.kernel.batch import Solution

_WORTH_A_SEARCH = 5e-4
"""Relative, in weight or tension: half of that in diameter."""
_SAME = 1e-7
"""Relative: what two searches may leave between them that end in the same branch."""
_FEW_TURNS = 5
"""Of pulleys, before poses that have come to rest are left out. A search, which costs more than
all else, leaves them out after its first turn: a pose without an answer rests at once."""
LONG = 1.5
"""Length over chord above which a cable counts as far too long."""


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
    sag_max : float or None
        Largest sag over chord, of more cables than degrees of freedom.
    """

    situation: Situation
    kappa_per_m: float | FloatArray
    strength_m: float | FloatArray
    inverse_weight_m_per_N: float | FloatArray | None
    relative_weights: float | FloatArray = 1.0
    sag_max: float | None = None

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
    robot: Robot, poses: Poses, task: Task, *, seeks_better: bool = True, is_quick: bool = False
) -> tuple[Solution, PulleyRun]:
    """Solve poses (...), flattened to one axis, of which the task tells `situation_at`.

    Other branches are tried where nothing is found, unless it ``is_quick``, and, if it
    ``seeks_better``, where one may be better than what is. Where none keeps the largest sag, the
    answer is one that does not.
    """
    checkpoint()
    flat = poses.flat
    solution, run = _solve_over_pulleys(
        robot, flat, task, is_thorough=False, rates_branches=seeks_better
    )
    _judge_unsolved(robot, flat, solution, task)
    limits_sag = robot.is_redundant and task.sag_max is not None
    hangs = np.zeros(len(flat.position_m), dtype=np.bool_)
    if limits_sag and not seeks_better:
        hangs = _let_hang(robot, flat, solution, run, task, seeks_better)
    if not is_quick:
        _try_other_branches(robot, flat, solution, run, task, ~hangs)
    if limits_sag:
        _let_hang(robot, flat, solution, run, task, seeks_better, ~hangs)
    if robot.pulley_radius_m == 0.0:
        return solution, run
    shape = (*poses.shape, robot.n_cables)
    points = run.exit_points_m.reshape(*shape, 3)
    return solution, PulleyRun(points, run.wrap_m.reshape(shape))


def _solve_over_pulleys(
    robot: Robot,
    flat: Poses,
    task: Task,
    *,
    is_thorough: bool,
    rates_branches: bool,
    is_open: bool = False,
    turns: int = _FEW_TURNS,
) -> tuple[Solution, PulleyRun]:
    """Solve with a few turns, and those poses that have not come to rest again with more."""
    from designer.kernel.batch import solve_batch

    ones = np.ones(robot.n_cables)

    def solve(run: PulleyRun) -> tuple[Solution, FloatArray, float]:
        solution = solve_batch(
            robot,
            task.situation.starting_at(run.exit_points_m),
            task.kappa_per_m * ones,
            task.relative_weights * ones,
            task.strength_m * ones,
            task.inverse_weight_m_per_N,
            sag_max=task.sag_max,
            is_thorough=is_thorough,
            is_open=is_open,
            rates_branches=rates_branches,
        )
        if robot.pulley_radius_m == 0.0:  # no cable leaves at an angle that matters
            return solution, np.empty(0), 0.0
        with np.errstate(invalid="ignore"):  # forces are infinite at infinite section
            weight = solution.weight_N_per_m[:, None] * task.relative_weights
            downward = weight * solution.length_m - solution.force_z_N
        return solution, np.arctan2(downward, solution.force_x_N), 0.0

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
        again = _solve_over_pulleys(
            robot,
            flat.part(at),
            task.part(at),
            is_thorough=is_thorough,
            rates_branches=rates_branches,
            turns=max(2 * turns, _FEW_TURNS),
        )
        _replace(solution, run, at, *again)
    return solution, run


def _replace(
    solution: Solution,
    run: PulleyRun,
    at: IntArray,
    by: Solution,
    its_run: PulleyRun,
    chosen: BoolArray | slice = slice(None),
) -> None:
    """Write what is chosen of the answers for the poses `at`, and their run, over the former."""
    for field in fields(solution):
        getattr(solution, field.name)[at[chosen]] = getattr(by, field.name)[chosen]
    if run.exit_points_m.ndim > 2:
        run.exit_points_m[at[chosen]] = its_run.exit_points_m[chosen]
        run.wrap_m[at[chosen]] = its_run.wrap_m[chosen]


def _try_other_branches(
    robot: Robot,
    flat: Poses,
    solution: Solution,
    run: PulleyRun,
    task: Task,
    among: BoolArray,
) -> None:
    """Search ``among`` poses again where nothing is found or another branch is rated better.

    Of branches that are as good, one without cables far longer than their chords is preferred.

    Writes what is better into the solution and the run of the cables.
    """
    is_open = are_open(solution.verdict)
    at = np.flatnonzero(among & (is_open | (solution.potential > _WORTH_A_SEARCH)))
    if len(at) == 0 or np.any(task.inverse_weight_m_per_N == 0.0):
        return
    poses = flat.part(at)
    again, its_run = _solve_over_pulleys(
        robot,
        poses,
        task.part(at),
        is_thorough=True,
        is_open=robot.pulley_radius_m == 0.0 and bool(is_open[at].all()),
        rates_branches=False,
        turns=1,
    )
    if robot.pulley_radius_m == 0.0:  # a proof is for points that stay where they are
        solution.verdict[at[again.verdict == Verdict.NO_FINITE_CABLE]] = Verdict.NO_FINITE_CABLE
    solved = again.verdict == Verdict.SOLVED
    if not solved.any():
        return
    if task.inverse_weight_m_per_N is None:
        burden, before = again.weight_N_per_m, solution.weight_N_per_m[at]
    else:
        burden, before = again.load_factor, solution.load_factor[at]
    chord = cable_geometry(robot, poses).chord_m
    was_long, is_long = (
        (length > LONG * chord).any(axis=1) for length in (solution.length_m[at], again.length_m)
    )
    tauter = was_long & ~is_long & (burden <= (1.0 + _SAME) * before)
    lighter = burden < (1.0 - _SAME) * before
    better = solved & (lighter | tauter | (solution.verdict[at] != Verdict.SOLVED))
    _replace(solution, run, at, again, its_run, better)


def _let_hang(
    robot: Robot,
    flat: Poses,
    solution: Solution,
    run: PulleyRun,
    task: Task,
    seeks_better: bool,
    among: BoolArray | bool = True,
) -> BoolArray:
    """Solve poses that have no answer again, whatever the sag: what is found exceeds it.

    Where no better branch is sought, before other branches are tried within the limit, which takes
    long and rarely finds one. Tells which poses (n_poses,) these were.
    """
    hangs = are_open(solution.verdict) & among
    at = np.flatnonzero(hangs)
    if len(at) > 0:
        slack = replace(task.part(at), sag_max=None)
        poses = flat.part(at)
        _replace(solution, run, at, *solve_task(robot, poses, slack, seeks_better=seeks_better))
    return hangs


def _judge_unsolved(robot: Robot, flat: Poses, solution: Solution, task: Task) -> None:
    """Replace the verdicts of poses without a solution by what is proved of them."""
    from designer.kernel.batch import refuse_batch

    unsolved = np.flatnonzero(solution.verdict != Verdict.SOLVED)
    if len(unsolved) == 0:
        return
    poses = flat.part(unsolved)
    points = straight_run(robot, poses).exit_points_m
    situation = task.situation.part(unsolved).starting_at(points)
    is_near, least_N = np.zeros(len(unsolved), dtype=np.bool_), robot.tension_min_N
    if robot.pulley_radius_m > 0.0:  # the cone bounds a cable only beyond its pulley
        level = level_geometry(robot, poses)
        is_near |= (level.horizontal_distance_m < 2.0 * robot.pulley_radius_m).any(axis=1)
        if robot.cable_load_direction is not None:
            situation, least_N = _between_tangents(robot, level, situation), 0.0
    verdict, _, _ = refuse_batch(situation, least_N if robot.is_redundant else 0.0)
    verdict[is_near] = Verdict.NOT_CONVERGED
    solution.verdict[unsolved] = verdict


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
