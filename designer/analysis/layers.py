"""Where sizes of one grade serve: one layer of the opened region for each size."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from designer.analysis.maps import WorkspaceMaps
from designer.arrays import FloatArray
from designer.model.polygon import every_second
from designer.model.robot import Poses, Robot
from designer.model.workspace import Workspace
from designer.selection.usable import Usable, UsableSize
from designer.statics.inverse import solve_sagging
from designer.workspace.demand import is_counted

_MOST = 5
_BEYOND = 1e3
_SOLVED, _SEARCHED = 2e5, 2e4
"""Poses that are solved at most, and where each may have several branches, which are searched."""
_FEW = 8
"""Rows of the largest grid that are kept in any case."""


@dataclass(frozen=True, slots=True, eq=False)
class Layers:
    """Which sizes are shown, and what each of them meets on a grid through the opened region.

    Parameters
    ----------
    sizes : tuple of UsableSize
        Thinnest first.
    grids_m : tuple of arrays (rows, columns, 3)
        Outside of the opened region [m].
    utilisation : array (n_sizes, n_points)
        Largest over allowable tension at the points of all grids; very large where a pose cannot
        be held or does not count.
    """

    sizes: tuple[UsableSize, ...]
    grids_m: tuple[FloatArray, ...]
    utilisation: FloatArray

    @property
    def position_m(self) -> FloatArray:
        """The points of all grids (n_points, 3) [m]."""
        return np.concatenate([grid.reshape(-1, 3) for grid in self.grids_m])


def layers_of(maps: WorkspaceMaps, usable: Usable) -> Layers | None:
    """Solve the outside of the opened region with the sizes that are shown.

    None for a list of points, and where no size serves a part only.
    """
    sizes = chosen_sizes(usable)
    workspace = maps.study.workspace
    if "top" not in maps.shell or not sizes or workspace is None:
        return None
    grids = tuple(field.position_m for field in maps.shell.values())
    most = _SOLVED if maps.study.robot.has_one_branch else _SEARCHED
    most /= len(sizes) * workspace.orientations.count
    while sum(grid[..., 0].size for grid in grids) > most and max(map(len, grids)) > _FEW:
        grids = tuple(grid[every_second(grid)] for grid in grids)
    points = np.concatenate([grid.reshape(-1, 3) for grid in grids])
    used = [_utilisation(maps.study.robot, workspace, size, points) for size in sizes]
    return Layers(sizes, grids, np.stack(used))


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
        serves = is_counted(statics, workspace.hangs_below)
        used = statics.largest_tension_N / size.cable.allowable_tension_N
        largest = np.maximum(largest, np.where(serves, np.minimum(used, _BEYOND), _BEYOND))
    return largest
