"""Sizing over the whole workspace: samples first, then the continuous search for the worst."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from designer.arrays import FloatArray
from designer.model.cable import Material
from designer.model.robot import Poses, Robot
from designer.model.space import turn_of
from designer.model.verdict import Verdict
from designer.sizing.limit import limit_ratio
from designer.sizing.newton import Sizing, size_poses
from designer.study import Workspace
from designer.workspace.demand import diameter_demand, is_left_out, massless_demand, size_worst
from designer.workspace.hanging import HangingCables, look_at
from designer.workspace.refine import Pool, refine, refine_over_branches
from designer.workspace.result import Census, Extreme, WorkspaceMap
from designer.workspace.store import SweepFile

Progress = Callable[[int], None]
"""Called with the number of poses done since the last call."""


def map_workspace(
    robot: Robot,
    workspace: Workspace,
    material: Material,
    *,
    file: Path | None = None,
    attributes: Mapping[str, Any] | None = None,
    progress: Progress = lambda _: None,
) -> WorkspaceMap:
    """Size every sample of the workspace, and find the worst pose of the region.

    Parameters
    ----------
    robot, workspace, material
        What to solve.
    file : Path, optional
        NetCDF file that receives every sample; without it only the summary is kept, and memory
        does not grow with the number of samples in either case.
    attributes : mapping, optional
        Provenance that is stored in the file.
    progress : callable
        Called after each chunk.
    """
    gathered = _Gathered(workspace)
    if file is None:
        for some, sizing in _sweep(robot, workspace, material, progress):
            gathered.add(some, sizing)
    else:
        with SweepFile(file, robot.n_cables, attributes or {}) as store:
            for some, sizing in _sweep(robot, workspace, material, progress):
                gathered.add(some, sizing)
                store.append(some, sizing)
    return _summarise(robot, workspace, material, gathered, file)


def _sweep(
    robot: Robot, workspace: Workspace, material: Material, progress: Progress
) -> Iterator[tuple[FloatArray, Sizing]]:
    """Yield every position in the orientation that asks for the most there."""
    for positions in workspace.positions_m():
        yield size_worst(robot, workspace, positions, material)
        progress(len(positions))


class _Gathered:
    """Running totals of a sweep, and the few samples that the search starts from."""

    def __init__(self, workspace: Workspace) -> None:
        self._workspace = workspace
        self.verdicts: Counter[int] = Counter()
        self.hangs_below = 0
        self.excluded = 0
        self.hanging = HangingCables()
        self.starts = Pool(workspace.space)
        self.massless_starts = Pool(workspace.space)
        self.sampled: Extreme | None = None
        self.infeasible_example: FloatArray | None = None

    def add(self, some: FloatArray, sizing: Sizing) -> None:
        statics = sizing.statics
        left_out = is_left_out(statics, self._workspace.hangs_below)
        self.verdicts.update(statics.verdict.tolist())
        self.hangs_below += int(statics.hangs_below.sum())
        self.excluded += int(left_out.sum())
        counts = statics.is_solved & ~left_out
        self.hanging = look_at(self.hanging, some, statics, counts, self._workspace.floor_m)
        diameter = np.where(counts, sizing.diameter_m, -np.inf)
        massless = np.where(np.isnan(sizing.massless_tension_N), -np.inf, sizing.massless_tension_N)
        self.starts.add(some, diameter)
        self.massless_starts.add(some, massless)
        self._keep_worst(some, diameter, statics.largest_tension_N)
        served = statics.is_solved | left_out
        if self.infeasible_example is None and not served.all():
            self.infeasible_example = some[int(np.argmin(served))]

    def census(self) -> Census:
        statuses = {v.label: self.verdicts.get(int(v), 0) for v in Verdict}
        totals = sum(statuses.values()), statuses, self.hangs_below, self.excluded
        return Census(*totals, self.hanging)

    def _keep_worst(self, some: FloatArray, diameter: FloatArray, tension: FloatArray) -> None:
        at = int(np.argmax(diameter))
        if not np.isneginf(diameter[at]) and (
            self.sampled is None or diameter[at] > self.sampled.diameter_m
        ):
            self.sampled = Extreme.at(some[at], float(diameter[at]), float(tension[at]))


def _summarise(
    robot: Robot, workspace: Workspace, material: Material, gathered: _Gathered, file: Path | None
) -> WorkspaceMap:
    census = gathered.census()
    example = gathered.infeasible_example
    sagging: Extreme | None = None
    ratio = np.nan
    if example is None and gathered.sampled is not None:
        demand_with = partial(diameter_demand, robot, material, workspace.hangs_below)
        (worst,) = refine_over_branches(workspace.space, demand_with, gathered.starts.places)
        if np.isfinite(worst.demand):
            pose = Poses.at(worst.place)
            tension = float(size_poses(robot, pose, material).statics.largest_tension_N)
            sagging = Extreme.at(worst.place, worst.demand, tension)
            ratio = float(limit_ratio(robot, pose, material))
        else:
            example = worst.place
    return WorkspaceMap(
        census=census,
        is_feasible=sagging is not None,
        sagging=sagging,
        sampled=gathered.sampled,
        massless=_worst_massless(robot, workspace, material, gathered.massless_starts.places),
        infeasible_example_m=None if example is None else example[:3],
        limit_ratio=ratio,
        infeasible_rotation_vector_rad=None if example is None else turn_of(example),
        file=file,
    )


def _worst_massless(
    robot: Robot, workspace: Workspace, material: Material, starts: FloatArray
) -> Extreme | None:
    if len(starts) == 0:
        return None
    (worst,) = refine(workspace.space, massless_demand(robot), starts)
    return Extreme.at(worst.place, material.diameter_for_tension_m(worst.demand), worst.demand)
