"""How the kernels are called: what they are given, in the one kind of array they know, and threads.

Importing this imports no Numba.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from designer.arrays import BoolArray, FloatArray, IntArray, frozen_array, require_shape
from designer.model.robot import Poses, Robot

ANY_SAG = frozen_array(np.empty((0, 2)))
"""Least pulls of cables that may hang as they like."""


class Situation(NamedTuple):
    """Poses, and what the cables have to hold in them: SI units, z axis the vertical.

    Parameters
    ----------
    exit_points : array (1 or n_poses, n_cables, 3)
        Where the cables begin.
    attachments : array (n_cables, 3)
        Where they end, body frame.
    load : array (1 or n_poses, 6)
        What they have to pull with: force at the origin of the body frame, then moment.
    load_point, load_there : array (3,)
        This part of the force, such as that against the weight, acts at this point of the body;
        what that makes of moment comes on top.
    positions, rotations : array (n_poses, 3), (1 or n_poses, 3, 3)
        The poses.
    rows : array (degrees of freedom,)
        Which components of the wrench are balanced, of 0 … 5.
    """

    exit_points: FloatArray
    attachments: FloatArray
    load: FloatArray
    load_point: FloatArray
    load_there: FloatArray
    positions: FloatArray
    rotations: FloatArray
    rows: IntArray

    def part(self, at: IntArray) -> Situation:
        """Return the situation in some of the poses, by their numbers in growing order."""
        count = len(self.positions)
        if len(at) == count:
            return self
        changed: dict[str, Any] = {}
        for name in ("exit_points", "load", "positions", "rotations"):
            values = getattr(self, name)
            if len(values) == count:
                changed[name] = plain(values[at])
        return self._replace(**changed)

    def starting_at(self, points_m: FloatArray) -> Situation:
        """Return the situation with cables that begin at points (…, n_cables, 3) [m]."""
        return self._replace(exit_points=plain(points_m.reshape(-1, *points_m.shape[-2:])))


class CableFigures(NamedTuple):
    """The cables of the poses.

    Parameters
    ----------
    kappa, weights, strength : array (1 or n_poses, n_cables)
        Weight over axial stiffness [1/m], weight relative to w (or, where there is no common w,
        weight per length [N/m]), allowable tension over weight [m].
    least_tension : float
        Least tension that is asked for anywhere in a cable [N].
    least_pulls : array (n_nodes, 2)
        Least pulls for the sag that is allowed, see `designer.kernel.least_pull`; no rows for any.
    pulleys : array (n_cables, 3)
        Exit points above the edges of the pulleys, in the frame of the situation; no rows without
        pulleys [m].
    pulley_radius : float
        Zero without pulleys [m].
    vertical : array (3,)
        Upward unit vector in which the pulleys stand, in that frame: where it is not its z axis,
        cables bow out of the planes of their pulleys.
    """

    kappa: FloatArray
    weights: FloatArray
    strength: FloatArray
    least_tension: float
    least_pulls: FloatArray = ANY_SAG
    pulleys: FloatArray = frozen_array(np.empty((0, 3)))
    pulley_radius: float = 0.0
    vertical: FloatArray = frozen_array([0.0, 0.0, 1.0])


class LoadSummary(NamedTuple):
    """What cables meet in some poses at worst; the kernel raises or increases all but `failed`.

    Parameters
    ----------
    utilisation : array (n_cables_tried, n_cells)
        Largest over allowable tension in each part of the region; -inf where no pose counts.
    pose : array (n_cables_tried, n_cells)
        Index of the pose that it was met in.
    longest_m : array (n_cables_tried, n_cables)
        Longest unstrained length of each cable of the robot [m].
    counted, overloaded, left_out : array (n_cables_tried,)
        Poses that count, those of them above the allowable tension, and those left out.
    failed : array (n_cables_tried, n_poses)
        Where no solution was found; such a pose is in none of the other results.
    """

    utilisation: FloatArray
    pose: IntArray
    longest_m: FloatArray
    counted: IntArray
    overloaded: IntArray
    left_out: IntArray
    failed: BoolArray


def situation_of(
    robot: Robot, poses: Poses, exit_points_m: FloatArray, wrench_N: FloatArray | None = None
) -> Situation:
    """Return what the kernels are told of poses (n_poses,).

    Parameters
    ----------
    poses : Poses
        One leading axis, in a frame whose z axis is the vertical.
    exit_points_m : array (n_cables, 3) or (n_poses, n_cables, 3)
        Where the cables begin, in that frame [m].
    wrench_N : array (n_poses, 3 or 6), optional
        Force on the platform beside its weight, and moment about its origin, in that frame
        [N, N·m].

    Raises
    ------
    ValueError
        If the arrays differ in length: compiled code would read beyond their ends.
    """
    count, n = len(poses.position_m), robot.n_cables
    rotations = poses.rotation.reshape(-1, 3, 3)
    require_shape("position_m", poses.position_m, count, 3)
    if len(rotations) not in (1, count):
        raise ValueError(f"{len(rotations)} rotations do not fit {count} poses")
    if exit_points_m.shape not in ((n, 3), (1, n, 3), (count, n, 3)):
        raise ValueError(
            f"exit points {exit_points_m.shape} do not fit {count} poses of {n} cables"
        )
    if wrench_N is not None and wrench_N.shape not in ((1, 3), (count, 3), (count, 6)):
        raise ValueError(f"forces {wrench_N.shape} do not fit {count} poses")
    return Situation(
        plain(exit_points_m.reshape(-1, n, 3)),
        plain(robot.attachments_m),
        plain(robot.loads_N(wrench_N)),
        plain(robot.platform.centre_of_mass_m),
        plain(robot.centre_pull_N),
        plain(poses.position_m),
        plain(rotations),
        robot.balance_rows,
    )


def plain(values: ArrayLike) -> FloatArray:
    """Return the array as kernels are compiled for it: contiguous, read-only."""
    array = np.ascontiguousarray(values, dtype=np.float64).view()
    array.setflags(write=False)
    return array


def share_out(solve: Callable[..., None], count: int, share: int, *arguments: Any) -> None:
    """Call ``solve(first, last, …)`` for all of ``count``, on all processors where there are many.

    Each call gets as many as a ``share``; a thread that is done takes the next, this one as well.
    """
    firsts = iter(range(0, count, share))

    def work() -> None:
        for first in firsts:
            solve(first, min(first + share, count), *arguments)

    helpers = min(os.cpu_count() or 1, -(-count // share)) - 1
    futures = [_pool().submit(work) for _ in range(helpers)]
    work()
    for future in futures:
        future.result()


@cache
def _pool() -> ThreadPoolExecutor:
    """Return one thread a processor; starting them anew costs as much as some thousand poses."""
    return ThreadPoolExecutor(os.cpu_count())
