"""Lengths and tensions of taut cables, nearest to balance, whatever the number of cables.

With more cables than degrees of freedom the tensions are not unique. Here they are those of
straight cables that pull and come nearest to balance, the smallest of them where there is a choice;
lengths follow with sag and elasticity. Good for taut cables, and as a start; the full answer for
redundant robots is an optimisation, and for those with fewer cables than degrees of freedom
`designer.statics.underactuated`.
"""

from __future__ import annotations

import numpy as np

from designer.arrays import FloatArray
from designer.kernel.calling import plain
from designer.model.cable import Cable
from designer.model.robot import Poses, Robot
from designer.statics.geometry import upright_poses
from designer.statics.task import straight_run

_SMALLEST_SHARE = 1e-3
_REGULAR = 1e-4


def solve_nearest(
    robot: Robot, poses: Poses, cable: Cable, force_N: FloatArray | None = None
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return unstrained lengths [m], upper tensions [N] and horizontal distances [m].

    Lengths and tensions are NaN where a cable would hang so slack that it is many times as long as
    its chord; no tension falls below a thousandth of the platform's weight.

    Parameters
    ----------
    robot, poses, cable
        The robot, its poses (n_poses,) and its cables.
    force_N : array (n_poses, 3), optional
        Force on the platform beside its weight, base frame [N].

    Returns
    -------
    three arrays (n_poses, n_cables)
    """
    from designer.kernel import nearest as kernel

    run = straight_run(robot, poses)
    upright = upright_poses(robot, poses)
    load = robot.loads_N(None if force_N is None else force_N @ robot.upright.T)
    n = robot.n_cables
    out = np.empty((len(upright.position_m), n, 3))
    kernel.solve_nearest_poses(
        plain(run.exit_points_m).reshape(-1, n, 3),
        plain(robot.attachments_m),
        plain(load),
        plain(robot.platform.centre_of_mass_m),
        robot.weight_N,
        plain(upright.position_m),
        plain(upright.rotation).reshape(-1, 3, 3),
        plain(np.broadcast_to(cable.weight_N_per_m, (n,))),
        plain(np.broadcast_to(cable.axial_stiffness_N, (n,))),
        robot.balance_rows,
        _REGULAR,
        _SMALLEST_SHARE * robot.weight_N,
        out,
    )
    upper = out[..., kernel.EXIT_TENSION]
    wrap_m = run.unstrained(upper / cable.axial_stiffness_N).wrap_m
    return out[..., kernel.LENGTH] + wrap_m, upper, out[..., kernel.DISTANCE]
