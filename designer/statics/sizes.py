"""Many cables in the same poses: what each of them meets at worst, and nothing else of a pose."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from designer.arrays import IntArray, require_shape
from designer.kernel.calling import CableFigures, LoadSummary, plain, share_out
from designer.model.cable import Cable, Cables
from designer.model.robot import Poses, Robot
from designer.progress import checkpoint
from designer.statics.inverse import solve_sagging
from designer.statics.task import situation_at

_SHARE = 64
"""Sizes that one thread takes at a time; the first of them starts without a neighbour."""


def has_fast_solver(robot: Robot) -> bool:
    """Tell whether `evaluate_sizes` solves this robot in one compiled pass."""
    return robot.is_square and robot.pulley_radius_m == 0.0


def evaluate_sizes(
    robot: Robot,
    poses: Poses,
    cables: Sequence[Cable],
    cells: IntArray,
    n_cells: int,
    *,
    leaves_out_hanging: bool,
) -> LoadSummary:
    """Solve poses (n_poses,) with each of the cables on all winches, by `designer.kernel.sizes`.

    The quick pass gives up on a pose early; what it marks as failed may still be found by
    `designer.statics.inverse.solve_sagging`. Over pulleys, whose tangent points differ from cable
    to cable, the latter is used throughout.

    Parameters
    ----------
    robot, poses
        The robot and its poses.
    cables : sequence of Cable
        In the order of their weight, so that each is like its neighbour.
    cells : array (n_poses,)
        Part of the region that each pose lies in, below ``n_cells``.
    leaves_out_hanging : bool
        Whether poses in which a cable hangs below the platform do not count.
    """
    require_shape("cells", cells, len(poses.position_m))
    if cells.size and not (cells.min() >= 0 and cells.max() < n_cells):
        raise ValueError(f"cells must be numbered from 0 to {n_cells - 1}")
    from designer.kernel.sizes import sweep_sizes

    checkpoint()
    counts = np.zeros((3, len(cables)), dtype=np.int64)
    meets = LoadSummary(
        utilisation=np.full((len(cables), n_cells), -np.inf),
        pose=np.zeros((len(cables), n_cells), dtype=np.int64),
        longest_m=np.zeros((len(cables), robot.n_cables)),
        counted=counts[0],
        overloaded=counts[1],
        left_out=counts[2],
        failed=np.zeros((len(cables), len(poses.position_m)), dtype=np.bool_),
    )
    if not has_fast_solver(robot):
        pairs = np.indices(meets.failed.shape).reshape(2, -1)
        of_one_pose = len(poses.position_m) == 1
        for rows, at in [pairs] if of_one_pose else np.split(pairs, len(cables), axis=1):
            add_slowly(meets, robot, poses, cables, rows, at, cells, leaves_out_hanging)
        return meets
    weight = np.array([cable.weight_N_per_m * np.ones(robot.n_cables) for cable in cables])
    stiffness = np.array([[cable.axial_stiffness_N] for cable in cables])
    allowable = np.array([[cable.allowable_tension_N] for cable in cables])
    heaviest = weight.max(axis=1)
    share_out(
        sweep_sizes,
        len(cables),
        _SHARE,
        situation_at(robot, poses),
        plain(1.0 / heaviest),
        CableFigures(
            plain(weight / stiffness),
            plain(weight / heaviest[:, None]),
            plain(allowable / weight),
            0.0,
        ),
        np.ascontiguousarray(cells, dtype=np.int64),
        leaves_out_hanging,
        meets,
    )
    return meets


def add_slowly(
    meets: LoadSummary,
    robot: Robot,
    poses: Poses,
    cables: Sequence[Cable],
    rows: IntArray,
    at: IntArray,
    cells: IntArray,
    leaves_out_hanging: bool,
) -> None:
    """Solve pairs of a cable and a pose, the hard ones with more patience, and add what they meet.

    Parameters
    ----------
    meets
        What is added to; the other parameters as for `evaluate_sizes`.
    rows, at : array (n_pairs,)
        Which of the cables, and of the poses.
    """
    cable: Cable | Cables
    cable = cables[rows[0]] if (rows == rows[0]).all() else Cables(cables, rows)
    part = poses.part(at)
    statics = solve_sagging(robot, part, cable)
    is_solved, tension_N = statics.is_solved, statics.largest_tension_N
    hangs, length_m = statics.hangs_below, statics.length_m
    allowable_N = np.array([rope.allowable_tension_N for rope in cables])[rows]
    meets.failed[rows, at] = ~is_solved
    left_out = hangs & is_solved & leaves_out_hanging
    counts = is_solved & ~left_out
    used, row, of_pose = (tension_N / allowable_N)[counts], rows[counts], at[counts]
    np.add.at(meets.left_out, rows[left_out], 1)
    np.add.at(meets.counted, row, 1)
    np.add.at(meets.overloaded, row[used > 1.0], 1)
    np.maximum.at(meets.longest_m, row, length_m[counts])
    # In ascending order the last of each cable's cell, which is its largest, is what stays.
    cell = cells[of_pose]
    order = np.lexsort((used, cell, row))
    is_last = np.diff(row[order], append=-1) | np.diff(cell[order], append=-1)
    order = order[is_last != 0]
    order = order[used[order] > meets.utilisation[row[order], cell[order]]]
    meets.utilisation[row[order], cell[order]] = used[order]
    meets.pose[row[order], cell[order]] = of_pose[order]
