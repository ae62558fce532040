r"""What cables do to the supports of their exit points: masts, frames, pulleys.

At the exit point a cable pulls with the tension that it has there, along its own tangent toward the
platform:

.. math::  R = F - q\,l

with F the pull of the platform on the cable, q its load per unstrained length l of what hangs free.
Where a sheave redirects it, the branch that goes on to the winch pulls with the same tension along
its own direction; friction and the weight of that branch are left out.
"""

from __future__ import annotations

import numpy as np

from designer.arrays import FloatArray
from designer.statics.geometry import plane_vector
from designer.statics.inverse import Statics


def platform_branch_N(statics: Statics) -> FloatArray:
    """Return the pull of the cables' runs to the platform on their supports (..., n_cables, 3) [N].

    World frame.
    """
    force_z = statics.force_z_N - statics.weight_N_per_m * statics.free_length_m
    pull = plane_vector(statics.force_x_N, force_z, statics.geometry().outward)
    return np.asarray(pull @ statics.robot.upright)


def winch_branch_N(statics: Statics) -> FloatArray | None:
    """Return the pull of the branches toward the winches (..., n_cables, 3), world frame [N].

    Straight down where there are pulleys, which a cable enters from below; else toward
    `Winches.positions_m`; None where nothing tells.
    """
    robot = statics.robot
    positions = robot.winches.positions_m
    if robot.pulley_radius_m != 0.0:
        direction = -robot.level[2]
    elif positions is not None:
        along = positions - robot.exit_points_m
        direction = along / np.linalg.norm(along, axis=1, keepdims=True)
    else:
        return None
    return np.asarray(statics.exit_tension_N[..., None] * direction)


def reaction_N(statics: Statics) -> FloatArray:
    """Return what the cables do to their supports by all known branches (..., n_cables, 3) [N]."""
    winch_branch = winch_branch_N(statics)
    pull = platform_branch_N(statics)
    return pull if winch_branch is None else pull + winch_branch
