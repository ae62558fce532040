"""Where sizes of one grade serve: one layer of the opened region for each size."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from designer.analysis.maps import WorkspaceMaps
from designer.arrays import FloatArray
from designer.model.robot import Poses, Robot
from designer.model.workspace import Workspace
from designer.selection.usable import Usable, UsableSize
from designer.statics.inverse import solve_sagging
from designer.workspace.demand import is_left_out

_MOST = 5
_HEIGHTS = 25
_BEYOND = 1e3
_SOLVED, _SEARCHED = 2e5, 2e4
"""Poses that are solved at most, and where each may have several branches, which are searched."""


@dataclass(frozen=True, slots=True, eq=False)
class Layers:
    """Which sizes are shown, and what each of them meets on a grid through the opened region.

    Parameters
    ----------
    sizes : tuple of UsableSize
        Thinnest first.
    position_m : array (rings, spokes, heights, 3)
        Grid [m].
    utilisation : array (n_sizes, rings, spokes, heights)
        Largest over allowable tension; very large where a pose cannot be held or does not count.
    """

    sizes: tuple[UsableSize, ...]
    position_m: FloatArray
    utilisation: FloatArray


def layers_of(maps: WorkspaceMaps, usable: Usable) -> Layers | None:
    """Solve the grid with the sizes that are shown.

    None for a list of points, and where no size serves a part only.
    """
    sizes = chosen_sizes(usable)
    workspace = maps.study.workspace
    if "top" not in maps.shell or not sizes or workspace is None:
        return None
    plan = maps.shell["top"].position_m
    solved = plan[..., 0].size * _HEIGHTS * len(sizes) * workspace.orientations.count
    most = _SOLVED if maps.study.robot.has_one_branch else _SEARCHED
    share = min(1.0, np.sqrt(most / solved))  # a coarser grid where there would be more to solve
    rings = np.linspace(0, len(plan) - 1, max(2, round(share * len(plan)))).round().astype(int)
    low, high = maps.region.bounds_m[:, 2]
    heights = np.linspace(low, high, max(2, round(share * _HEIGHTS)))
    position = np.repeat(plan[rings, :, None], len(heights), axis=2)
    position[..., 2] = heights
    used = [_utilisation(maps.study.robot, workspace, size, position) for size in sizes]
    return Layers(sizes, position, np.stack(used))


def chosen_sizes(usable: Usable) -> tuple[UsableSize, ...]:
    """Return a few sizes that serve a part, spread over their shares, and one that serves all.

    Thinnest first. Empty where no size serves a part only.
    """
    part = [size for size in usable.sizes if 0.0 < size.fraction < 1.0]
    serves_all = [size for size in usable.sizes if size.fraction == 1.0][:1]
    if not part:
        return ()
    shares = [size.fraction for size in part]
    spread = np.linspace(min(shares), max(shares), min(_MOST - len(serves_all), len(part)))
    nearest = [min(part, key=lambda size: abs(size.fraction - share)) for share in spread]
    return tuple(size for size in usable.sizes if size in nearest or size in serves_all)


def _utilisation(
    robot: Robot, workspace: Workspace, size: UsableSize, position_m: FloatArray
) -> FloatArray:
    largest = np.zeros(position_m.shape[:-1])
    turns = workspace.orientations.at(position_m.reshape(-1, 3))
    for turn_rad in turns.swapaxes(0, 1):
        poses = Poses.at(position_m, turn_rad.reshape(position_m.shape))
        statics = solve_sagging(robot, poses, size.cable)
        serves = statics.is_solved & ~is_left_out(statics, workspace.hangs_below)
        used = statics.largest_tension_N / size.cable.allowable_tension_N
        largest = np.maximum(largest, np.where(serves, np.minimum(used, _BEYOND), _BEYOND))
    return largest
