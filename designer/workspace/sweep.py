"""Sizing over the whole workspace: samples first, then the continuous search for the worst."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from contextlib import nullcontext
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from designer.arrays import FloatArray
from designer.model.cable import Material
from designer.model.robot import Poses, Robot
from designer.model.verdict import Verdict
from designer.model.workspace import Workspace
from designer.progress import Advance
from designer.sizing.newton import Sizing, limit_ratio, size_poses
from designer.workspace.demand import (
    diameter_demand,
    is_left_out,
    massless_demand,
    massless_demand_of,
    size_worst,
)
from designer.workspace.hanging import HangingCables, look_at
from designer.workspace.pool import Pool
from designer.workspace.refine import refine
from designer.workspace.result import Census, Extreme, WorkspaceMap
from designer.workspace.store import sweep_file


def map_workspace(
    robot: Robot,
    workspace: Workspace,
    material: Material,
    *,
    file: Path | None = None,
    attributes: Mapping[str, Any] = MappingProxyType({}),
    progress: Advance = lambda _: None,
    with_massless: bool = True,
) -> WorkspaceMap:
    """Size every sample of the workspace, and find the worst pose of the region.

    Parameters
    ----------
    file : Path, optional
        NetCDF file that receives every sample; without it only the summary is kept, and memory
        does not grow with the number of samples in either case.
    attributes : mapping, optional
        Provenance that is stored in the file.
    progress : callable
        Called after each chunk.
    with_massless : bool
        Whether to search for the worst pose of straight weightless cables as well.
    """
    gathered = _Gathered(workspace)
    kept = sweep_file(file, robot.n_cables, attributes) if file else nullcontext(lambda *_: None)
    with kept as store:
        for positions in workspace.positions_m():
            places, sizing = size_worst(robot, workspace, positions, material)
            gathered.add(places, sizing)
            store(places, sizing)
            progress(len(positions))
    return _summarise(robot, workspace, material, gathered, file, with_massless)


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

    def add(self, places: FloatArray, sizing: Sizing) -> None:
        statics = sizing.statics
        left_out = is_left_out(statics, self._workspace.hangs_below)
        self.verdicts.update(dict(enumerate(np.bincount(statics.verdict).tolist())))
        self.hangs_below += int(statics.hangs_below.sum())
        self.excluded += int(left_out.sum())
        counts = statics.is_solved & ~left_out
        self.hanging = look_at(self.hanging, places, statics, counts, self._workspace.floor_m)
        diameter = np.where(counts, sizing.diameter_m, -np.inf)
        self.starts.add(places, diameter)
        straight = massless_demand_of(sizing, self._workspace.hangs_below)
        self.massless_starts.add(places, straight)
        at = int(np.argmax(diameter))
        diameter_m = -np.inf if self.sampled is None else self.sampled.diameter_m
        if diameter[at] > diameter_m:
            tension = float(statics.largest_tension_N[at])
            self.sampled = Extreme(places[at], float(diameter[at]), tension)
        served = statics.is_solved | left_out
        if self.infeasible_example is None and not served.all():
            self.infeasible_example = places[int(np.argmin(served))]

    def census(self) -> Census:
        statuses = {v.label: self.verdicts[int(v)] for v in Verdict}
        totals = sum(statuses.values()), statuses, self.hangs_below, self.excluded
        return Census(*totals, self.hanging)


def _summarise(
    robot: Robot,
    workspace: Workspace,
    material: Material,
    gathered: _Gathered,
    file: Path | None,
    with_massless: bool,
) -> WorkspaceMap:
    example = gathered.infeasible_example
    sagging = massless = None
    ratio = np.nan
    if example is None and gathered.sampled is not None:
        demand = partial(diameter_demand, robot, material, workspace.hangs_below)
        (worst,) = refine(workspace.space, demand, gathered.starts.places)
        if np.isfinite(worst.demand):
            pose = Poses.at(worst.place)
            tension = float(size_poses(robot, pose, material).statics.largest_tension_N)
            sagging = Extreme(worst.place, worst.demand, tension)
            ratio = float(limit_ratio(robot, pose, material))
        else:
            example = worst.place
    starts = gathered.massless_starts.places
    if with_massless and len(starts):
        demand = partial(massless_demand, robot, material, workspace.hangs_below)
        (worst,) = refine(workspace.space, demand, starts)
        if np.isfinite(worst.demand):
            diameter = material.diameter_for_tension_m(worst.demand)
            massless = Extreme(worst.place, diameter, worst.demand)
    return WorkspaceMap(
        census=gathered.census(),
        is_feasible=sagging is not None,
        sagging=sagging,
        sampled=gathered.sampled,
        massless=massless,
        infeasible_place=example,
        limit_ratio=ratio,
        file=file,
    )
