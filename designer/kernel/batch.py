"""Runs the compiled solver over a batch of poses, on all processors."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from designer.arrays import FloatArray, VerdictArray, require_shape
from designer.kernel import layout
from designer.kernel.branches import rate_range
from designer.kernel.calling import plain, pool
from designer.kernel.cone import refuse_range
from designer.kernel.redundant import solve_massless_range, solve_redundant_range
from designer.kernel.redundant_search import search_range
from designer.kernel.square import solve_range
from designer.model.robot import Poses, Robot

_SHARE = 32 * layout.LANES


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """What the kernel found, pose by pose; NaN wherever the verdict is not solved.

    Parameters
    ----------
    verdict : array (n_poses,)
        One `Verdict` a pose.
    weight_N_per_m : array (n_poses,)
        The common w of the weights per length, as given or, when sizing, the least that the
        strength allows [N/m].
    length_m, force_x_N, force_z_N : array (n_poses, n_cables)
        Unstrained lengths [m], and forces on the cables at the platform [N].
    closure_residual_m, equilibrium_residual_N : array (n_poses,)
        Worst closure error [m]; what is left of the platform's balance, moments divided by the
        reach of its attachments [N].
    load_factor : array (n_poses,)
        Largest tension over strength; NaN only where no state was found.
    massless_tension_N : array (n_poses,)
        Largest tension of straight, weightless cables [N]; NaN outside their hull.
    potential : array (n_poses,)
        Estimate of what other branches could gain, relative, by `designer.kernel.branches`.
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
    potential: FloatArray


def solve_batch(
    robot: Robot,
    poses: Poses,
    exit_points_m: FloatArray,
    kappa_per_m: FloatArray,
    relative_weights: FloatArray,
    strength_m: FloatArray,
    inverse_weight_m_per_N: float | None,
    force_N: FloatArray | None = None,
    *,
    is_thorough: bool = False,
) -> Solution:
    """Solve the statics of poses (n_poses,), or size the cables if no weight is given.

    Parameters
    ----------
    robot : Robot
        With at least as many cables as degrees of freedom.
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
    is_thorough : bool
        Whether to look for other branches as well, which takes a thousand times as long.

    Raises
    ------
    ValueError
        If the robot has fewer cables than degrees of freedom, or the arrays differ in length.
    """
    n, count = robot.n_cables, len(poses.position_m)
    if n < robot.degrees_of_freedom:
        raise ValueError(f"{n} cables cannot hold {robot.degrees_of_freedom} degrees of freedom")
    _require_one_batch(robot, poses, exit_points_m, force_N)
    for name, each in (
        ("kappa_per_m", kappa_per_m),
        ("relative_weights", relative_weights),
        ("strength_m", strength_m),
    ):
        require_shape(name, each, n)
    out_cables = np.empty((count, n, 3))
    out_poses = np.empty((count, 5))
    out_verdict = np.empty(count, dtype=np.int8)
    arguments: tuple[Any, ...] = (
        plain(exit_points_m.reshape(-1, n, 3)),
        plain(robot.attachments_m),
        plain(robot.loads_N(force_N)),
        plain(robot.platform.centre_of_mass_m),
        robot.weight_N,
        plain(poses.position_m),
        plain(poses.rotation.reshape(-1, 3, 3)),
        plain(kappa_per_m),
        plain(relative_weights),
        plain(strength_m),
        -1.0 if inverse_weight_m_per_N is None else inverse_weight_m_per_N,
        robot.balance_rows,
        out_cables,
        out_poses,
        out_verdict,
    )
    least_N = robot.tension_min_N if robot.is_redundant else 0.0
    of_redundant = (*arguments[:-3], least_N, *arguments[-3:])
    if robot.is_redundant:
        _share_out(solve_redundant_range, count, of_redundant)
    else:
        _share_out(solve_range, count, arguments)
    potential = np.zeros(count)
    if inverse_weight_m_per_N != 0.0:  # at infinite section nothing is chosen
        if is_thorough:
            _share_out(search_range, count, of_redundant)
        if not robot.has_one_branch:
            sizing = inverse_weight_m_per_N is None
            _share_out(rate_range, count, (*arguments[:10], sizing, *of_redundant[11:], potential))
    if np.any(relative_weights != 1.0):  # the kernel's forces are those of cables of weight w
        out_cables[..., [layout.FORCE_X, layout.FORCE_Z]] *= relative_weights[:, None]
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
        potential=potential,
    )


def solve_massless_batch(
    robot: Robot, poses: Poses, exit_points_m: FloatArray, force_N: FloatArray | None = None
) -> tuple[FloatArray, FloatArray, VerdictArray]:
    """Return tensions of straight cables with the smallest largest one, in poses (n_poses,).

    Parameters
    ----------
    robot : Robot
        With more cables than degrees of freedom.
    poses, exit_points_m, force_N
        As for `solve_batch`.

    Returns
    -------
    tension_N : array (n_poses, n_cables)
        NaN where no tensions hold the pose.
    wrench : array (n_poses, degrees of freedom)
        The dual of the load, of any length: where no tensions hold the pose it separates the load
        from all that they can do.
    verdict : array (n_poses,)
        One `Verdict` a pose.
    """
    n, count = robot.n_cables, len(poses.position_m)
    _require_one_batch(robot, poses, exit_points_m, force_N)
    tension = np.empty((count, n))
    wrench = np.empty((count, robot.degrees_of_freedom))
    verdict = np.empty(count, dtype=np.int8)
    arguments = (
        plain(exit_points_m.reshape(-1, n, 3)),
        plain(robot.attachments_m),
        plain(robot.loads_N(force_N)),
        plain(robot.platform.centre_of_mass_m),
        robot.weight_N,
        plain(poses.position_m),
        plain(poses.rotation.reshape(-1, 3, 3)),
        robot.balance_rows,
        robot.tension_min_N,
        tension,
        wrench,
        verdict,
    )
    _share_out(solve_massless_range, count, arguments)
    return tension, wrench, verdict


def _require_one_batch(
    robot: Robot, poses: Poses, exit_points_m: FloatArray, force_N: FloatArray | None
) -> None:
    """Raise ValueError where compiled code would read beyond the end of an array."""
    count, n = len(poses.position_m), robot.n_cables
    require_shape("position_m", poses.position_m, count, 3)
    if poses.rotation.reshape(-1, 3, 3).shape[0] not in (1, count):
        raise ValueError(f"{len(poses.rotation)} rotations do not fit {count} poses")
    if exit_points_m.shape not in ((n, 3), (1, n, 3), (count, n, 3)):
        raise ValueError(
            f"exit points {exit_points_m.shape} do not fit {count} poses of {n} cables"
        )
    if force_N is not None and force_N.shape not in ((1, 3), (count, 3)):
        raise ValueError(f"forces {force_N.shape} do not fit {count} poses")


def refuse_batch(
    robot: Robot, poses: Poses, exit_points_m: FloatArray, force_N: FloatArray | None = None
) -> tuple[VerdictArray, FloatArray, FloatArray]:
    """Return what is proved of poses (n_poses,) that no cables were found for; see `cone`.

    Parameters
    ----------
    robot, poses, exit_points_m, force_N
        As for `solve_batch`.

    Returns
    -------
    verdict : array (n_poses,)
        Outside the hull or rank deficient if that is proved; not found if straight cables are
        proved not to hold the pose; else not converged.
    wrench : array (n_poses, degrees of freedom)
        Of a pose outside the hull, what separates the load from all that cables can do: of unit
        length, moments over the reach of the attachments.
    separation : array (n_poses,)
        Its product with the load of unit length.
    """
    n, count = robot.n_cables, len(poses.position_m)
    wrench = np.empty((count, robot.degrees_of_freedom))
    separation = np.empty(count)
    verdict = np.empty(count, dtype=np.int8)
    arguments = (
        plain(exit_points_m.reshape(-1, n, 3)),
        plain(robot.attachments_m),
        plain(robot.loads_N(force_N)),
        plain(robot.platform.centre_of_mass_m),
        robot.weight_N,
        plain(poses.position_m),
        plain(poses.rotation.reshape(-1, 3, 3)),
        robot.balance_rows,
        robot.tension_min_N if robot.is_redundant else 0.0,
        wrench,
        separation,
        verdict,
    )
    _share_out(refuse_range, count, arguments)
    return verdict, wrench, separation


def _share_out(solve: Callable[..., None], count: int, arguments: tuple[Any, ...]) -> None:
    """Solve all poses, on all processors where there are many."""
    shares = [(at, min(at + _SHARE, count)) for at in range(0, count, _SHARE)]
    if len(shares) == 1:
        solve(0, count, *arguments)
    else:
        for future in [pool().submit(solve, *share, *arguments) for share in shares]:
            future.result()
