"""What small moves of the points where cables leave their pulleys do to the tensions."""

from __future__ import annotations

import numpy as np

from designer.arrays import FloatArray
from designer.model.robot import Poses, Robot
from designer.statics.geometry import cable_geometry, density_matrix
from designer.statics.pulleys import straight_run

_NOTHING = 1e-12
"""Of the trace of a Gram matrix: lets it be solved where cables leave a direction free."""


def rebalancing_N(
    robot: Robot, poses: Poses, tension_N: FloatArray, moves_m: FloatArray
) -> FloatArray:
    """Return by how much tensions change where cables turn as they leave at other points.

    The least change that keeps the balance of straight cables, to first order.

    Parameters
    ----------
    robot, poses
        The robot, and its poses (n_rows,).
    tension_N : array (n_rows, n_cables)
        Before that [N].
    moves_m : array (n_rows, n_cables, 3)
        Of where straight cables leave their pulleys, upright frame [m].
    """
    leaving_m = straight_run(robot, poses).exit_points_m
    ways = (cable_geometry(robot, poses, points) for points in (leaving_m, leaving_m + moves_m))
    before, after = (density_matrix(robot, way) / way.chord_m[..., None, :] for way in ways)
    lost = (after - before) @ np.nan_to_num(tension_N)[..., None]
    gram = np.nan_to_num(before @ np.swapaxes(before, -1, -2))
    ridge = _NOTHING * np.trace(gram, axis1=1, axis2=2)[:, None, None] * np.eye(gram.shape[-1])
    share = np.linalg.solve(gram + ridge, lost)
    return np.asarray(-(np.swapaxes(before, -1, -2) @ share)[..., 0])
