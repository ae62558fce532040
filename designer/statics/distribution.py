r"""How straight cables share the load where there are more of them than degrees of freedom.

With unit vectors :math:`u_i` along the cables, levers :math:`r_i` and the load wrench w, tensions t
hold a pose if

.. math::  A\,t = w, \quad A_i = (u_i,\; r_i \times u_i), \qquad t_{min} \le t_i \le t_{max}.

What is left to choose is settled by a convex programme. Each answer carries its own proof: the
residual of the optimality conditions with the solver's multipliers, or, where there are no such
tensions, a wrench that does more work on the load than any of them can (Farkas' lemma).

After Gouttefarde, Daney and Merlet, IEEE Transactions on Robotics 27(1), 2011, for the set of
wrenches, and Pott, Cable-Driven Parallel Robots (2018), section 3.7, for the objective.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from designer.arrays import BoolArray, FloatArray, VerdictArray
from designer.model.robot import Poses, Robot
from designer.model.verdict import Verdict
from designer.statics.geometry import (
    cable_geometry,
    density_matrix,
    load_wrench_N,
    upright_situation,
)
from designer.statics.pulleys import straight_run

_PROVEN = 1e-6
"""Residual of the optimality conditions up to which they count as met."""
_RANK = 1e-9
"""Product with a unit wrench that is rounding, and no gain."""


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


def distribute_evenly(
    robot: Robot, poses: Poses, tension_max_N: float = np.inf, *, force_N: FloatArray | None = None
) -> Distribution:
    """Return the tensions of poses (...) with the smallest largest one.

    None is below `Robot.tension_min_N`. A pose that needs more than the allowable tension is
    outside the hull; without a separating wrench, for the largest tension itself is the proof. A
    force (..., 3) acts on the platform beside its weight, base frame [N].
    """
    from designer.kernel.batch import solve_massless_batch

    shares = _shares(robot, poses, tension_max_N, force_N)
    flat = poses.flat
    if force_N is not None:
        force_N = np.broadcast_to(force_N, poses.position_m.shape).reshape(-1, 3)
    points = straight_run(robot, flat).exit_points_m
    tension, dual, verdict = solve_massless_batch(
        robot, upright_situation(robot, flat, points, force_N)
    )
    scaled, multiplier = tension / shares.scale_N, dual * shares.rows
    residual = _even_residual(shares, scaled, multiplier)
    separation = _separation(shares, -multiplier)
    solved = verdict == Verdict.SOLVED
    verdict[solved & ~(residual < _PROVEN)] = Verdict.NOT_CONVERGED
    # Of a cable without direction nothing is said.
    verdict[np.isnan(shares.matrix).any(axis=(1, 2))] = Verdict.NOT_CONVERGED
    verdict[solved & (scaled.max(axis=1) > shares.high * (1.0 + 1e-12))] = Verdict.OUTSIDE_HULL
    return _shaped(poses.shape, shares, verdict, scaled, residual, -multiplier, separation)


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


def _separation(shares: _Shares, wrench: FloatArray) -> FloatArray:
    """Return a wrench's product with the load where that with any tensions is not above zero.

    Over the wrench's largest component, minus infinity elsewhere; positive is a proof, whoever
    found the wrench.
    """
    size = np.abs(wrench).max(axis=1, keepdims=True)
    wrench = wrench / np.where(size > 0.0, size, 1.0)
    gain = np.einsum("pi,pij->pj", wrench, shares.matrix)
    of_load = np.einsum("pi,pi->p", wrench, shares.wrench)
    return np.where((gain > _RANK).any(axis=1), -np.inf, of_load)


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
