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
from designer.model.cable import Cable, Cables
from designer.model.robot import Poses, Robot
from designer.statics.geometry import one_cable, upright_situation
from designer.statics.pulleys import straight_run

_SMALLEST_SHARE = 1e-3
_REGULAR = 1e-4


def solve_taut(
    robot: Robot, poses: Poses, cable: Cable | Cables, force_N: FloatArray | None = None
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
    from designer.kernel import taut as kernel

    run = straight_run(robot, poses)
    out = np.empty((len(poses.position_m), robot.n_cables, 3))
    kernel.solve_taut_poses(
        upright_situation(robot, poses, run.exit_points_m, force_N),
        one_cable(robot, cable, _SMALLEST_SHARE * robot.weight_N),
        _REGULAR,
        out,
    )
    upper = out[..., kernel.EXIT_TENSION]
    wrap_m = run.unstrained(upper / cable.axial_stiffness_N).wrap_m
    return out[..., kernel.LENGTH] + wrap_m, upper, out[..., kernel.DISTANCE]
