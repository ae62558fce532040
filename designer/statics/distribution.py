r"""How straight cables share the load where there are more of them than degrees of freedom.

With unit vectors :math:`u_i` along the cables, levers :math:`r_i` and the load wrench w, tensions t
hold a pose if

.. math::  A\,t = w, \quad A_i = (u_i,\; r_i \times u_i), \qquad t_{min} \le t_i.

What is left to choose is settled by a linear programme. Each answer carries its own proof: the
residual of the optimality conditions with the solver's multipliers.

After Gouttefarde, Daney and Merlet, IEEE Transactions on Robotics 27(1), 2011, for the set of
wrenches, and Pott, Cable-Driven Parallel Robots (2018), section 3.7, for the objective.
"""

from __future__ import annotations

import numpy as np

from designer.arrays import FloatArray
from designer.model.robot import Poses, Robot
from designer.statics.geometry import (
    cable_geometry,
    density_matrix,
    load_wrench_N,
    upright_situation,
)
from designer.statics.pulleys import straight_run

_PROVEN = 1e-6
"""Residual of the optimality conditions up to which they count as met."""


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
