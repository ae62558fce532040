"""Many cables in the same poses: what each of them meets at worst, and nothing else of a pose."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from designer.arrays import BoolArray, IntArray, require_shape
from designer.kernel.calling import CableFigures, Meets, plain, share_out
from designer.model.cable import Cable
from designer.model.robot import Poses, Robot
from designer.progress import checkpoint
from designer.statics.geometry import upright_exit_points_m, upright_situation
from designer.statics.inverse import Statics, solve_sagging
from designer.statics.shape import sag_ratio
from designer.statics.task import LONG

_SHARE = 64
"""Sizes that one thread takes at a time; the first of them starts without a neighbour."""

_SAME = 1e-9


def is_quick(robot: Robot) -> bool:
    """Tell whether `meet` solves this robot in one compiled pass."""
    return robot.is_square and robot.pulley_radius_m == 0.0


def meet(
    robot: Robot,
    poses: Poses,
    cables: Sequence[Cable],
    cells: IntArray,
    n_cells: int,
    *,
    leaves_out_hanging: bool,
) -> Meets:
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
    meets = Meets(
        utilisation=np.full((len(cables), n_cells), -np.inf),
        pose=np.zeros((len(cables), n_cells), dtype=np.int64),
        longest_m=np.zeros((len(cables), robot.n_cables)),
        counted=counts[0],
        overloaded=counts[1],
        left_out=counts[2],
        failed=np.zeros((len(cables), len(poses.position_m)), dtype=np.bool_),
    )
    if not is_quick(robot):
        for row, cable in enumerate(cables):
            add_slowly(meets, row, robot, poses, cable, cells, leaves_out_hanging)
        return meets
    weight = np.array([cable.weight_N_per_m * np.ones(robot.n_cables) for cable in cables])
    stiffness = np.array([[cable.axial_stiffness_N] for cable in cables])
    allowable = np.array([[cable.allowable_tension_N] for cable in cables])
    heaviest = weight.max(axis=1)
    share_out(
        sweep_sizes,
        len(cables),
        _SHARE,
        upright_situation(robot, poses, upright_exit_points_m(robot)),
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
    meets: Meets,
    row: int,
    robot: Robot,
    poses: Poses,
    cable: Cable,
    cells: IntArray,
    leaves_out_hanging: bool,
    indices: IntArray | None = None,
) -> None:
    """Solve poses one cable at a time, the hard ones with more patience, and add what they meet.

    Other branches, which take a hundred times as long, are tried only where the first does not
    serve: where it is overloaded, or exceeds the largest sag, or hangs.

    Parameters
    ----------
    meets, row
        What is added to, and the cable's place in it.
    indices : array, optional
        The poses to solve; all if left out.
    """
    at = np.arange(len(poses.position_m)) if indices is None else indices
    part = poses.part(at)
    statics = solve_sagging(robot, part, cable, seeks_better=False)
    is_solved, tension_N = statics.is_solved, statics.largest_tension_N
    hangs, length_m = statics.hangs_below, statics.length_m
    again = np.flatnonzero(_may_serve_better(statics, cable, leaves_out_hanging))
    if len(again):
        better = solve_sagging(robot, part.part(again), cable)
        is_solved[again], tension_N[again] = better.is_solved, better.largest_tension_N
        hangs[again], length_m[again] = better.hangs_below, better.length_m
    meets.failed[row, at] = ~is_solved
    left_out = hangs & is_solved & leaves_out_hanging
    counts = is_solved & ~left_out
    used = tension_N[counts] / cable.allowable_tension_N
    meets.left_out[row] += int(left_out.sum())
    meets.counted[row] += len(used)
    meets.overloaded[row] += int((used > 1.0).sum())
    meets.longest_m[row] = np.maximum(
        meets.longest_m[row], length_m[counts].max(axis=0, initial=0.0)
    )
    # In ascending order the last of each cell, which is its largest, is what stays.
    order = np.argsort(used, kind="stable")
    best = np.full(meets.utilisation.shape[1], -np.inf)
    where = np.zeros(len(best), dtype=np.int64)
    best[cells[at][counts][order]] = used[order]
    where[cells[at][counts][order]] = at[counts][order]
    higher = best > meets.utilisation[row]
    meets.utilisation[row, higher] = best[higher]
    meets.pose[row, higher] = where[higher]


def _may_serve_better(statics: Statics, cable: Cable, leaves_out_hanging: bool) -> BoolArray:
    """Tell in which poses (n,) another branch is to be tried, as this one does not serve.

    A cable that exceeds the largest sag in the branches of one pose does not serve, whatever
    those of other poses are: the pose where it hangs lowest is tried before them.
    """
    robot, poses = statics.robot, statics.poses
    doubtful = statics.largest_tension_N > cable.allowable_tension_N
    if leaves_out_hanging:
        doubtful |= statics.hangs_below
    if not robot.is_redundant or robot.sag_max is None:
        return np.asarray(doubtful | (statics.length_over_chord > LONG).any(axis=-1))
    doubtful |= ~statics.is_solved
    excess = sag_ratio(statics).max(axis=-1) / robot.sag_max
    hangs = excess > 1.0 + _SAME
    if hangs.any():
        lowest = np.array([np.nanargmax(excess)])
        sag = sag_ratio(solve_sagging(robot, poses.part(lowest), cable))
        if (sag <= robot.sag_max * (1.0 + _SAME)).all():
            doubtful |= hangs
    return doubtful
