"""The internal forces that a pose's own readings tell, where cables outnumber degrees of freedom.

A redundant robot holds a pose with many sets of tensions. Which of them a built machine has, its
winches decide; it shows in the tensions, and in the lengths through elasticity and sag. Each pose
gives up one reading for each cable to spare; the others test the model, whatever rule the winches
follow.
"""

from __future__ import annotations

import numpy as np

from designer.arrays import FloatArray, require_shape
from designer.kernel.calling import plain
from designer.model.cable import Cable
from designer.model.robot import Poses, Robot
from designer.model.verdict import Verdict
from designer.statics.geometry import cable_geometry, upright_poses
from designer.statics.inverse import Statics, statics_with
from designer.statics.nearest import solve_nearest
from designer.statics.stiffness import per_reach
from designer.statics.task import SETTLED_RAD, PulleyRun, over_pulleys

_LEAST_PULL = 1.0 / 16.0
_LEAST_SHARE = 0.05
_SPREAD = 1.0
_CLOSES = 1e-9


def solve_internal(
    robot: Robot,
    poses: Poses,
    cable: Cable,
    length_m: FloatArray,
    tension_N: FloatArray,
    noise: tuple[float, float],
    force_N: FloatArray | None = None,
) -> Statics:
    """Return the balance of poses (n_poses,) that comes nearest to what was read of them.

    Nearest is meant as in `designer.kernel.internal`: robust least squares in units of noise. What
    the readings leave open is settled by a weak hold near the smallest tensions that hold the pose,
    none below 5 % of the platform's weight nor `Robot.tension_min_N`, as if these were known to
    within a factor of e.

    Parameters
    ----------
    robot, poses, cable
        A robot with more cables than degrees of freedom, its poses (n_poses,), and its cables.
    length_m, tension_N : array (n_poses, n_cables)
        Unstrained lengths from the exit points, around pulleys where there are any [m], and
        tensions at the exit points [N]; NaN where nothing was read.
    noise : (float, float)
        Standard deviation of a length [m] and of a tension [N].
    force_N : array (n_poses, 3), optional
        Force on the platform beside its weight, base frame [N].

    Returns
    -------
    Statics
        ``not converged`` where the balance does not close to 1e-9 of the largest tension.
    """
    require_shape("length_m", length_m, len(poses.position_m), robot.n_cables)
    require_shape("tension_N", tension_N, len(poses.position_m), robot.n_cables)
    weight, stiffness = cable.weight_N_per_m, cable.axial_stiffness_N
    load_N = robot.loads_N(None if force_N is None else force_N @ robot.upright.T)
    _, start_N, _ = solve_nearest(robot, poses, cable, force_N)
    start_N = np.fmax(start_N, max(_LEAST_SHARE * robot.weight_N, robot.tension_min_N))
    rest = np.empty(len(poses.position_m))

    def solve(run: PulleyRun) -> tuple[FloatArray, FloatArray, FloatArray]:
        read = np.stack([length_m - run.wrap_m, tension_N], axis=-1)
        free, force_x, force_z = _nearest_balance(
            robot, poses, run, cable, load_N, read, noise, start_N, rest
        )
        downward = weight * free - force_z
        strain = np.hypot(force_x, downward) / stiffness
        return np.stack([free, force_x, force_z]), np.arctan2(downward, force_x), strain

    found, run, gap_rad = over_pulleys(robot, poses, solve)
    closes = (rest <= _CLOSES) & (gap_rad <= SETTLED_RAD)
    verdict = np.where(closes, Verdict.SOLVED, Verdict.NOT_CONVERGED).astype(np.int8)
    return statics_with(robot, poses, cable, run, verdict, found, force_N)


def _nearest_balance(
    robot: Robot,
    poses: Poses,
    run: PulleyRun,
    cable: Cable,
    load_N: FloatArray,
    read: FloatArray,
    noise: tuple[float, float],
    start_N: FloatArray,
    rest: FloatArray,
) -> FloatArray:
    """Return free lengths and forces x and z (3, n_poses, n_cables), and fill what is left."""
    from designer.kernel.internal import solve_internal_poses

    weight = cable.weight_N_per_m
    chord_m = cable_geometry(robot, poses, run.exit_points_m).chord_m
    upright = upright_poses(robot, poses)
    each = np.ones(robot.n_cables)
    out = np.empty((*start_N.shape, 3))
    solve_internal_poses(
        plain(run.exit_points_m).reshape(-1, robot.n_cables, 3),
        plain(robot.attachments_m),
        plain(load_N),
        plain(robot.platform.centre_of_mass_m),
        robot.weight_N,
        plain(upright.position_m),
        plain(upright.rotation).reshape(-1, 3, 3),
        plain(weight * each),
        plain(weight / cable.axial_stiffness_N * each),
        robot.balance_rows,
        plain(read),
        plain(noise),
        plain(np.fmax(start_N / (weight * chord_m), _LEAST_PULL)),
        _SPREAD,
        plain(per_reach(robot)),
        out,
        rest,
    )
    return np.moveaxis(out, -1, 0)
