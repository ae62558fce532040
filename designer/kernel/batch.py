"""Runs the compiled solver over a batch of poses, on all processors."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np

from designer.arrays import FloatArray
from designer.kernel import square
from designer.robot import Poses, Robot

_SHARE = 32 * square.LANES


@dataclass(frozen=True, slots=True, eq=False)
class UnitSolution:
    """State of cables of unit weight; forces are in metres of cable.

    Parameters
    ----------
    horizontal_pull_m, length_m, upward_pull_m, top_tension_m : array (n_cables, n_poses)
        Horizontal force, unstrained length, vertical pull on the platform, tension at the upper
        end.
    massless_tension_N : array (n_cables, n_poses)
        Tension of straight, weightless cables; negative where no pulling cable can balance.
    inverse_weight_m_per_N : array (n_poses,)
        1 / w, as given or, when sizing, the largest that the strength allows.
    closure_m, balance_m, residual : array (n_poses,)
        Worst closure error, what is left of the platform's balance, and the larger of the two
        over their scales.
    overload : array (n_poses,)
        Largest top tension over strength.
    """

    horizontal_pull_m: FloatArray
    length_m: FloatArray
    upward_pull_m: FloatArray
    top_tension_m: FloatArray
    massless_tension_N: FloatArray
    inverse_weight_m_per_N: FloatArray
    closure_m: FloatArray
    balance_m: FloatArray
    residual: FloatArray
    overload: FloatArray


def solve_units(
    robot: Robot,
    poses: Poses,
    kappa_per_m: FloatArray,
    relative_weights: FloatArray,
    strength_m: FloatArray,
    inverse_weight_m_per_N: float | None,
) -> UnitSolution:
    """Solve the statics of poses (n_poses,), or size the cables if no weight is given.

    Parameters
    ----------
    robot : Robot
        Must have as many cables as degrees of freedom.
    poses : Poses
        One leading axis.
    kappa_per_m, relative_weights, strength_m : array (n_cables,)
        Weight over axial stiffness, weight relative to w, allowable tension over weight.
    inverse_weight_m_per_N : float or None
        1 / w; None sizes each pose for the lightest cable that the strength allows.
    """
    n, count = robot.n_cables, len(poses.position_m)
    out_cables = np.empty((n, 5, count))
    out_poses = np.empty((5, count))
    arguments: tuple[Any, ...] = (
        robot.exit_points_m,
        robot.attachments_m,
        np.array([0.0, 0.0, robot.weight_N, 0.0, 0.0, 0.0]),
        robot.platform.centre_of_mass_m,
        np.ascontiguousarray(poses.position_m),
        np.ascontiguousarray(poses.rotation.reshape(-1, 3, 3)),
        np.ascontiguousarray(kappa_per_m),
        np.ascontiguousarray(relative_weights),
        np.ascontiguousarray(strength_m),
        -1.0 if inverse_weight_m_per_N is None else inverse_weight_m_per_N,
        out_cables,
        out_poses,
    )
    shares = [(at, min(at + _SHARE, count)) for at in range(0, count, _SHARE)]
    if len(shares) == 1:
        square.solve_range(0, count, *arguments)
    else:
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            for future in [pool.submit(square.solve_range, *share, *arguments) for share in shares]:
                future.result()
    return UnitSolution(
        horizontal_pull_m=out_cables[:, square.OUT_H],
        length_m=out_cables[:, square.OUT_L],
        upward_pull_m=out_cables[:, square.OUT_V],
        top_tension_m=out_cables[:, square.OUT_T],
        massless_tension_N=out_cables[:, square.OUT_MASSLESS],
        inverse_weight_m_per_N=out_poses[square.OUT_C],
        closure_m=out_poses[square.OUT_CLOSURE],
        balance_m=out_poses[square.OUT_BALANCE],
        residual=out_poses[square.OUT_RESIDUAL],
        overload=out_poses[square.OUT_OVERLOAD],
    )
