"""The best tensions of straight cables by convex programmes in CVXPY: the readable reference.

Many poses are one block-diagonal problem. `designer.statics.inverse` is tested against it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal

import cvxpy as cp
import numpy as np
from scipy.sparse import bsr_array

from designer.arrays import BoolArray, FloatArray, VerdictArray
from designer.model.robot import Poses, Robot
from designer.model.verdict import Verdict
from designer.statics.geometry import cable_geometry, density_matrix, load_wrench_N
from designer.statics.pulleys import straight_run

Objective = Literal["smallest_largest", "least_squares", "centred"]
"""Smallest largest tension, smallest sum of squares, or nearest to the middle of the range."""

BLOCK = 200
"""Poses in one problem; building it costs more than solving it."""
PROVEN = 1e-6
"""Residual of the optimality conditions up to which they count as met."""
RANK = 1e-9
"""Product with a unit wrench that is rounding, and no gain."""
# Of the sum over all poses of a block, so that each of them is good.
_CLARABEL = {"tol_gap_abs": 1e-12, "tol_gap_rel": 1e-12, "tol_feas": 1e-11}


@dataclass(frozen=True, slots=True, eq=False)
class Distribution:
    """Tensions of straight cables in poses (...), each pose with its verdict and proof.

    Parameters
    ----------
    verdict : array (...)
        One `Verdict` a pose: solved, outside the wrench-feasible hull, rank deficient, or not
        converged.
    tension_N : array (..., n_cables)
        NaN wherever the verdict is not solved [N].
    optimality_residual : array (...)
        Largest violation of the optimality conditions, forces over the largest load; NaN unless
        solved.
    separating_wrench : array (..., degrees of freedom)
        Where the pose is outside the hull: force and moment [1/N, 1/(N·m)] whose product with the
        load exceeds that with every wrench that the cables can give. NaN elsewhere.
    separation : array (...)
        By how much, over the largest load; above zero is proof. NaN elsewhere.
    """

    verdict: VerdictArray
    tension_N: FloatArray
    optimality_residual: FloatArray
    separating_wrench: FloatArray
    separation: FloatArray

    @property
    def is_feasible(self) -> BoolArray:
        """Poses (...) that some allowed tensions hold."""
        return np.asarray(self.verdict == Verdict.SOLVED)

    @property
    def largest_tension_N(self) -> FloatArray:
        """Largest tension (...) [N]; NaN where there is none."""
        return np.asarray(self.tension_N.max(axis=-1))


@dataclass(frozen=True, slots=True, eq=False)
class _Shares:
    """The scaled problem of poses (n_poses,): tensions over a force, moments over a length.

    Parameters
    ----------
    matrix : array (n_poses, dof, n_cables)
        Wrench per tension.
    wrench : array (n_poses, dof)
        What the tensions have to give.
    low, high : float
        Bounds of the tensions.
    scale_N, rows : float, array (dof,)
        Force that tensions are measured in [N]; what the rows of the wrench are divided by.
    """

    matrix: FloatArray
    wrench: FloatArray
    low: float
    high: float
    scale_N: float
    rows: FloatArray


def distribute(
    robot: Robot,
    poses: Poses,
    tension_max_N: float,
    objective: Objective = "smallest_largest",
    *,
    force_N: FloatArray | None = None,
) -> Distribution:
    """Return the best tensions between `Robot.tension_min_N` and an allowable tension.

    Parameters
    ----------
    robot, poses
        The robot, with at least as many cables as degrees of freedom, and its poses (...).
    tension_max_N : float
        Allowable tension; may be infinite unless the objective is the middle of the range [N].
    objective : str
        What to prefer; see `Objective`.
    force_N : array (..., 3), optional
        Force on the platform beside its weight, base frame [N].

    Raises
    ------
    ValueError
        If the range is empty, or has no middle although that is the objective.
    """
    if not robot.tension_min_N <= tension_max_N:
        raise ValueError("the smallest tension is above the allowable one")
    if objective == "centred" and not np.isfinite(tension_max_N):
        raise ValueError("a range without an upper end has no middle")
    shares = _shares(robot, poses, tension_max_N, force_N)
    answers = [
        _solve_block(_part(shares, slice(at, at + BLOCK)), objective)
        for at in range(0, len(shares.wrench), BLOCK)
    ]
    parts = (np.concatenate(values) for values in zip(*answers, strict=True))
    return _shaped(poses.shape, shares, *parts)


def _shares(
    robot: Robot, poses: Poses, tension_max_N: float, force_N: FloatArray | None
) -> _Shares:
    run = straight_run(robot, poses)
    geometry = cable_geometry(robot, poses, run.exit_points_m)
    with np.errstate(invalid="ignore"):  # a cable of no length has no direction
        matrix = density_matrix(robot, geometry) / geometry.chord_m[..., None, :]
    wrench = load_wrench_N(robot, poses, force_N)
    reach = float(np.abs(robot.attachments_m).sum(axis=1).max()) or 1.0
    rows = np.where(robot.balance_rows < 3, 1.0, reach)
    scale = float(np.abs(wrench / rows).max(initial=0.0)) or 1.0
    dof, n = robot.degrees_of_freedom, robot.n_cables
    return _Shares(
        matrix=(matrix / rows[:, None]).reshape(-1, dof, n),
        wrench=(np.broadcast_to(wrench, (*poses.shape, dof)) / rows / scale).reshape(-1, dof),
        low=robot.tension_min_N / scale,
        high=tension_max_N / scale,
        scale_N=scale,
        rows=rows,
    )


def _shaped(
    shape: tuple[int, ...],
    shares: _Shares,
    verdict: VerdictArray,
    scaled: FloatArray,
    residual: FloatArray,
    separating: FloatArray,
    separation: FloatArray,
) -> Distribution:
    """Keep each result where it means something, in newtons and with its leading axes."""
    solved = verdict == Verdict.SOLVED
    apart = (verdict == Verdict.OUTSIDE_HULL) & (separation > 0.0)
    wrench = separating / shares.rows / shares.scale_N
    tension = np.where(solved[:, None], scaled * shares.scale_N, np.nan)
    return Distribution(
        verdict=verdict.reshape(shape),
        tension_N=tension.reshape(*shape, tension.shape[1]),
        optimality_residual=np.where(solved, residual, np.nan).reshape(shape),
        separating_wrench=np.where(apart[:, None], wrench, np.nan).reshape(*shape, wrench.shape[1]),
        separation=np.where(apart, separation, np.nan).reshape(shape),
    )


def _part(shares: _Shares, chosen: Any) -> _Shares:
    return replace(shares, matrix=shares.matrix[chosen], wrench=shares.wrench[chosen])


def _solve_block(shares: _Shares, objective: Objective) -> tuple[Any, ...]:
    """Return verdict, scaled tensions, residual, separating wrench and separation of a block."""
    count, dof, n = shares.matrix.shape
    verdict = np.full(count, Verdict.RANK_DEFICIENT, dtype=np.int8)
    tension = np.full((count, n), np.nan)
    residual = np.full(count, np.nan)
    spans = np.linalg.matrix_rank(shares.matrix, tol=RANK) == dof
    distance, separating = np.zeros(count), np.full((count, dof), np.nan)
    if spans.any():
        distance[spans], separating[spans] = _distance(_part(shares, spans))
    separation = _separation(shares, separating, upper=shares.high)
    near = spans & (distance <= PROVEN)
    verdict[spans & ~near] = np.where(
        separation[spans & ~near] > 0.0, Verdict.OUTSIDE_HULL, Verdict.NOT_CONVERGED
    )
    if near.any():
        tension[near], residual[near] = _best(_part(shares, near), objective)
        proven = residual[near] < PROVEN
        verdict[near] = np.where(proven, Verdict.SOLVED, Verdict.NOT_CONVERGED)
    return verdict, tension, residual, separating, separation


def _distance(shares: _Shares) -> tuple[FloatArray, FloatArray]:
    """Return how far each load is from what the tensions can give, and the direction of it.

    Linear programme: the largest component of A t - w, summed over the poses, which do not touch
    each other. Its multipliers make the separating wrench.
    """
    count, dof, n = shares.matrix.shape
    t, gap = cp.Variable(count * n), cp.Variable(count)
    rest = _blocks(shares.matrix) @ t - shares.wrench.ravel()
    each = _blocks(np.ones((count, dof, 1))) @ gap
    above, below = rest - each <= 0.0, -rest - each <= 0.0
    problem = cp.Problem(cp.Minimize(cp.sum(gap)), [above, below, *_range(t, shares)])
    problem.solve(solver=cp.HIGHS)
    push = np.asarray(below.dual_value - above.dual_value)
    return np.asarray(gap.value), push.reshape(count, dof)


def _best(shares: _Shares, objective: Objective) -> tuple[FloatArray, FloatArray]:
    """Return the best tensions of poses that have some, and the residual of optimality."""
    count, _, n = shares.matrix.shape
    t, largest = cp.Variable(count * n), cp.Variable(count)
    balance = _blocks(shares.matrix) @ t - shares.wrench.ravel() == 0.0
    bounds = _range(t, shares)
    if objective == "smallest_largest":
        under = t - _blocks(np.ones((count, n, 1))) @ largest <= 0.0
        problem = cp.Problem(cp.Minimize(cp.sum(largest)), [balance, under, *bounds])
        problem.solve(solver=cp.HIGHS)
    else:
        middle = 0.5 * (shares.low + shares.high) if objective == "centred" else 0.0
        problem = cp.Problem(cp.Minimize(0.5 * cp.sum_squares(t - middle)), [balance, *bounds])
        problem.solve(solver=cp.CLARABEL, **_CLARABEL)
    tension = np.asarray(t.value).reshape(count, n)
    multiplier = np.asarray(balance.dual_value).reshape(count, -1)
    if objective == "smallest_largest":
        return tension, _even_residual(shares, tension, multiplier)
    return tension, _square_residual(shares, tension, multiplier, middle)


def _range(t: Any, shares: _Shares) -> list[Any]:
    bounds = [shares.low - t <= 0.0]
    return [*bounds, t - shares.high <= 0.0] if np.isfinite(shares.high) else bounds


def _blocks(matrices: FloatArray) -> Any:
    """Return matrices (n, rows, columns) as one sparse block-diagonal matrix."""
    count, rows, columns = matrices.shape
    places = np.arange(count), np.arange(count + 1)
    return bsr_array((matrices, *places), shape=(count * rows, count * columns)).tocsc()


def _square_residual(
    shares: _Shares, tension: FloatArray, multiplier: FloatArray, middle: float
) -> FloatArray:
    """Return the residual of optimality for the least squares about a tension, pose by pose."""
    pull = -(tension - middle) - np.einsum("pi,pij->pj", multiplier, shares.matrix)
    # What remains has to be the multiplier of a bound, and vanish off that bound.
    slackness = np.where(
        pull > 0.0,
        np.minimum(pull, np.abs(shares.high - tension)),
        np.minimum(-pull, np.abs(tension - shares.low)),
    )
    return _worst(shares, tension, slackness)


def _separation(shares: _Shares, wrench: FloatArray, *, upper: float) -> FloatArray:
    """Return by how much a wrench's product with the load exceeds that with any tensions.

    Over the wrench's largest component; positive is a proof, whoever found the wrench.
    """
    size = np.abs(wrench).max(axis=1, keepdims=True)
    wrench = wrench / np.where(size > 0.0, size, 1.0)
    gain = np.einsum("pi,pij->pj", wrench, shares.matrix)
    # Rounding in a product with an unbounded tension is no gain.
    rising = gain > (RANK if np.isinf(upper) else 0.0)
    least = shares.low if np.isfinite(upper) else 0.0
    most = np.where(rising, gain * upper if np.isfinite(upper) else np.inf, gain * least)
    return np.asarray(np.einsum("pi,pi->p", wrench, shares.wrench) - most.sum(axis=1))


def _even_residual(shares: _Shares, tension: FloatArray, multiplier: FloatArray) -> FloatArray:
    """Return the residual of optimality for the smallest largest tension, pose by pose.

    With multipliers y of the balance, those of t ≤ largest and t ≥ low have to be the positive and
    the negative part of -Aᵀy; the former sum to one, and each vanishes off its bound.
    """
    pull = -np.einsum("pi,pij->pj", multiplier, shares.matrix)
    total = np.maximum(pull, 0.0).sum(axis=1, keepdims=True)
    pull = pull / np.where(total > 0.0, total, np.nan)
    room = tension.max(axis=1, keepdims=True) - tension
    height = tension - shares.low
    slackness = np.where(pull > 0.0, pull * room, -pull * height)
    return _worst(shares, tension, slackness)


def _worst(shares: _Shares, tension: FloatArray, slackness: FloatArray) -> FloatArray:
    rest = np.einsum("pij,pj->pi", shares.matrix, tension) - shares.wrench
    outside = np.maximum(shares.low - tension, tension - shares.high)
    parts = np.abs(rest).max(axis=1), outside.max(axis=1), np.abs(slackness).max(axis=1)
    return np.asarray(np.maximum(np.maximum(parts[0], parts[1]), parts[2]))
