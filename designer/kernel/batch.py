"""Runs the compiled solver over a batch of poses, on all processors."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from designer.arrays import FloatArray, VerdictArray
from designer.kernel import layout
from designer.kernel.square import solve_range
from designer.robot import Poses, Robot

_SHARE = 32 * layout.LANES


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """What the kernel found, pose by pose; NaN wherever the verdict is not solved.

    Parameters
    ----------
    verdict : array (n_poses,)
        One `Verdict` a pose.
    weight_N_per_m : array (n_poses,)
        Weight per length, as given or, when sizing, the least that the strength allows [N/m].
    length_m, force_x_N, force_z_N : array (n_poses, n_cables)
        Unstrained lengths [m], and forces on the cables at the platform [N].
    closure_residual_m, equilibrium_residual_N : array (n_poses,)
        Worst closure error [m]; what is left of the platform's balance, moments divided by the
        reach of its attachments [N].
    load_factor : array (n_poses,)
        Largest tension over strength; NaN only where no state was found.
    massless_tension_N : array (n_poses,)
        Largest tension of straight, weightless cables [N]; NaN outside their hull.
    """

    verdict: VerdictArray
    weight_N_per_m: FloatArray
    length_m: FloatArray
    force_x_N: FloatArray
    force_z_N: FloatArray
    closure_residual_m: FloatArray
    equilibrium_residual_N: FloatArray
    load_factor: FloatArray
    massless_tension_N: FloatArray


def solve_batch(
    robot: Robot,
    poses: Poses,
    exit_points_m: FloatArray,
    kappa_per_m: FloatArray,
    relative_weights: FloatArray,
    strength_m: FloatArray,
    inverse_weight_m_per_N: float | None,
    force_N: FloatArray | None = None,
) -> Solution:
    """Solve the statics of poses (n_poses,), or size the cables if no weight is given.

    Parameters
    ----------
    robot : Robot
        Must have as many cables as degrees of freedom.
    poses : Poses
        One leading axis, in a frame whose z axis is the vertical.
    exit_points_m : array (n_cables, 3) or (n_poses, n_cables, 3)
        Where the cables begin, in that frame [m].
    kappa_per_m, relative_weights, strength_m : array (n_cables,)
        Weight over axial stiffness [1/m], weight relative to w, allowable tension over weight [m].
    inverse_weight_m_per_N : float or None
        1 / w, zero for the infinite section; None sizes each pose for the lightest cable that the
        strength allows.
    force_N : array (n_poses, 3), optional
        Force on the platform beside its weight, in that frame [N].
    """
    n, count = robot.n_cables, len(poses.position_m)
    out_cables = np.empty((count, n, 3))
    out_poses = np.empty((count, 5))
    out_verdict = np.empty(count, dtype=np.int8)
    arguments: tuple[Any, ...] = (
        _plain(exit_points_m.reshape(-1, n, 3)),
        _plain(robot.attachments_m),
        _plain(_load(robot, force_N)),
        _plain(robot.platform.centre_of_mass_m),
        robot.weight_N,
        _plain(poses.position_m),
        _plain(poses.rotation.reshape(-1, 3, 3)),
        _plain(kappa_per_m),
        _plain(relative_weights),
        _plain(strength_m),
        -1.0 if inverse_weight_m_per_N is None else inverse_weight_m_per_N,
        out_cables,
        out_poses,
        out_verdict,
    )
    shares = [(at, min(at + _SHARE, count)) for at in range(0, count, _SHARE)]
    if len(shares) == 1:
        solve_range(0, count, *arguments)
    else:
        for future in [_pool().submit(solve_range, *share, *arguments) for share in shares]:
            future.result()
    return Solution(
        verdict=out_verdict,
        weight_N_per_m=out_poses[:, layout.WEIGHT],
        length_m=out_cables[..., layout.LENGTH],
        force_x_N=out_cables[..., layout.FORCE_X],
        force_z_N=out_cables[..., layout.FORCE_Z],
        closure_residual_m=out_poses[:, layout.CLOSURE_ERROR],
        equilibrium_residual_N=out_poses[:, layout.BALANCE_ERROR],
        load_factor=out_poses[:, layout.LOAD_FACTOR],
        massless_tension_N=out_poses[:, layout.MASSLESS_TENSION],
    )


def _plain(values: FloatArray) -> FloatArray:
    """Return the array as the one kind that the kernel is compiled for: contiguous, read-only."""
    plain = np.ascontiguousarray(values).view()
    plain.setflags(write=False)
    return plain


def _load(robot: Robot, force_N: FloatArray | None) -> FloatArray:
    """Return what the cables have to pull with (1 or n_poses, 3) [N]: upward, and against force."""
    upward = np.array([[0.0, 0.0, robot.weight_N]])
    return upward if force_N is None else upward - force_N


@cache
def _pool() -> ThreadPoolExecutor:
    """Threads are kept: starting them anew costs as much as some thousand poses."""
    return ThreadPoolExecutor(os.cpu_count())
