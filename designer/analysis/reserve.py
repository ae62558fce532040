"""How much more a rope could take: payload or region, until it is used to 100 %.

Each reserve is a root of the largest utilisation over the region. The worst poses that are known
are carried along: the root for these is found, the region searched there, and what is worse joins
them, until the search finds nothing above 100 %.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from designer.analysis.sensitivities import with_payload
from designer.arrays import FloatArray
from designer.model.load_case import Loaded
from designer.model.region import Region
from designer.model.space import named_position
from designer.model.workspace import Workspace
from designer.selection.cases import CaseResult
from designer.workspace.demand import tension_demand
from designer.workspace.refine import LIGHT, refine

_FULL = 1e-5
"""Above 100 %: what is not worth another turn."""
_NEAR = 0.8
"""Utilisation at the root from where on a load case is searched there."""
_MOST_TURNS = 12
_MOST_PAYLOAD, _MOST_MARGIN = 100.0, 3.0
"""As a factor, and over the extent of the exit points."""


@dataclass(frozen=True, slots=True, eq=False)
class Reserve:
    """Where the reserve in one quantity ends.

    Parameters
    ----------
    value : float
        Payload factor, or metres by which the sides of the region may move outward; NaN where no
        end was found.
    utilisation : float
        The largest there that the search finds.
    load_case : str
        Which case is at its end there.
    place : array (n_coordinates,)
        Where [m, rad].
    is_held : bool
        Whether the rope is used up there; False where beyond it a pose is not held at all.
    """

    value: float
    utilisation: float
    load_case: str
    place: FloatArray = field(metadata={"json": named_position})
    is_held: bool = field(default=True, metadata={"json": "held"})


@dataclass(frozen=True, slots=True, eq=False)
class _Carried:
    """A load case, and a pose of it that moves with the quantity."""

    case: CaseResult
    place: FloatArray
    at: float
    outward: FloatArray

    def place_at(self, value: float) -> FloatArray:
        moved = np.asarray(self.place + (value - self.at) * self.outward)
        return self.case.workspace.space.following(moved)


_Changed = Callable[[CaseResult, float], tuple[Loaded, Workspace]]


def payload_reserve(cases: Sequence[CaseResult]) -> Reserve | None:
    """Return by which factor weight and loads of the platform may grow; None where none was found.

    Wind on the platform stays.
    """

    def heavier(case: CaseResult, factor: float) -> tuple[Loaded, Workspace]:
        return with_payload(case.loaded, factor), case.workspace

    return _end(cases, heavier, (1.0, _MOST_PAYLOAD, 0.1), is_moving=False)


def region_reserve(cases: Sequence[CaseResult], region: Region) -> Reserve | None:
    """Return by how much the sides of the region may move outward; None where none was found.

    Heights stay. Load cases with a region of their own do not count; only some regions have sides.
    """
    moving = [case for case in cases if case.case.region is None]
    if not region.has_sides or not moving:
        return None

    def wider(case: CaseResult, margin_m: float) -> tuple[Loaded, Workspace]:
        return case.loaded, replace(case.workspace, region=region.grown(margin_m))

    size = float(np.ptp(moving[0].loaded.robot.exit_points_m, axis=0).max())
    return _end(moving, wider, (0.0, _MOST_MARGIN * size, 0.02 * size), is_moving=True)


def _end(
    cases: Sequence[CaseResult],
    change: _Changed,
    span: tuple[float, float, float],
    *,
    is_moving: bool,
) -> Reserve | None:
    """Find where the worst of the cases is used to 100 %: from, to, and first step of a bracket."""

    def carried(case: CaseResult, place: FloatArray, at: float) -> _Carried:
        outward = np.zeros_like(place)
        if is_moving:
            outward[:3] = change(case, at)[1].region.outward(place[:3])
        return _Carried(case, place, at, outward)

    def used_at(pose: _Carried, value: float) -> float:
        loaded, workspace = change(pose.case, value)
        demand = tension_demand(loaded, workspace.hangs_below, pose.place_at(value)[None])
        return float(demand[0]) / loaded.cable.allowable_tension_N

    poses = [carried(case, case.verification.worst_place, span[0]) for case in cases]

    def worst(value: float) -> float:
        return max(used_at(pose, value) for pose in poses)

    for _ in range(_MOST_TURNS):
        value = _root(worst, *span)
        if value is None:
            return None
        highest = max(poses, key=lambda pose: used_at(pose, value))
        candidates = [
            carried(case, *_searched(case, change, value, [o for o in poses if o.case is case]))
            for case in dict.fromkeys(o.case for o in poses if used_at(o, value) > _NEAR)
        ]
        beyond_full = [pose for pose in candidates if used_at(pose, value) > 1.0 + _FULL]
        if not beyond_full:
            top = max(used_at(pose, value) for pose in (*poses, *candidates))
            beyond = used_at(highest, value + 1e-6 * max(abs(value), span[2]))
            name = highest.case.case.name
            return Reserve(value, top, name, highest.place_at(value), math.isfinite(beyond))
        poses += beyond_full
    return None


def _root(of: Callable[[float], float], start: float, farthest: float, step: float) -> float | None:
    """Return the last value at which the utilisation is within 100 %; None up to the most."""
    from scipy.optimize import brentq

    def beyond(value: float) -> float:
        return min(max(of(value), 0.0), 2.0) - 1.0

    low, high = start, start + step
    if beyond(low) >= 0.0:
        return low
    while beyond(high) < 0.0:
        low, step = high, 1.6 * step
        high = low + step
        if high > farthest:
            return None
    tolerance = 1e-9 * max(high, step)
    root = float(brentq(beyond, low, high, xtol=tolerance, rtol=1e-12))
    return root if beyond(root) <= _FULL else max(root - 4.0 * tolerance, low)


def _searched(
    case: CaseResult, change: _Changed, value: float, poses: Sequence[_Carried]
) -> tuple[FloatArray, float]:
    """Return the worst pose of a case that a search from the known ones finds, with the value."""
    loaded, workspace = change(case, value)
    starts = np.array([pose.place_at(value) for pose in poses])
    if loaded.keeps_lengths:
        return starts[0], value
    demand = partial(tension_demand, loaded, workspace.hangs_below)
    (worst,) = refine(workspace.space, demand, starts, LIGHT)
    return worst.place, value
