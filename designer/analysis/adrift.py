"""Load cases that carry the platform away: straight cables hold it at rest, and not in the case.

A sagging rope may still hold such a pose, by hanging far below as a counterweight; its length then
says nothing about a design.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from designer.arrays import BoolArray, FloatArray
from designer.model.cable import Cable
from designer.model.load_case import LoadCase, Loaded
from designer.model.robot import Poses, Robot
from designer.model.space import named_place
from designer.model.workspace import Workspace
from designer.statics.inverse import solve_massless

_MOST_SAMPLES, _FEW_SAMPLES = 512, 32
"""Poses of each direction; the few for robots with spare cables, of which each is a programme."""


def _named_loads(loaded: Loaded) -> dict[str, Any]:
    directions = {"wind_direction": loaded.wind, "inertia_direction": loaded.inertia}
    return {"load_case": loaded.case.name, **directions, "wrench_N": loaded.wrench_N}


@dataclass(frozen=True, slots=True, eq=False)
class Adrift:
    """A load case in which straight cables do not hold the platform everywhere.

    Parameters
    ----------
    loaded : Loaded
        In the direction of wind and inertia in which that is so most often.
    share : float
        Of the poses that straight cables hold at rest.
    place : array (n_coordinates,)
        One of them [m, rad].
    push_N : float
        Force on the platform beside its weight and what acts on it at rest [N].
    """

    loaded: Loaded = field(metadata={"json": _named_loads})
    share: float
    place: FloatArray = field(metadata={"json": named_place})
    push_N: float = field(metadata={"json": "force_N"})


def adrift_in(
    robot: Robot, workspace: Workspace, cases: Sequence[LoadCase], cable: Cable
) -> Iterator[Adrift]:
    """Yield the load cases whose wind, inertia or wrenches carry the platform away somewhere."""
    samples = _FEW_SAMPLES if robot.is_redundant else _MOST_SAMPLES
    for case in cases:
        is_still = case.wind is None and case.acceleration_m_per_s2 == 0.0
        if is_still and case.wrench_set is None:
            continue
        space = workspace.of_case(case)
        places = np.concatenate([space.space.landmarks(), space.thinned(samples)])
        places = places[_holds(robot, places)]
        surveys = [
            _adrift(robot, loaded, places)
            for loaded in replace(case, cable_lost=None).on(robot, cable)
        ]
        worst = max(surveys, key=lambda survey: survey.share)
        if worst.share > 0.0:
            yield worst


def _holds(robot: Robot, places: FloatArray) -> BoolArray:
    return np.isfinite(solve_massless(robot, Poses.at(places)).largest_tension_N)


def _adrift(robot: Robot, loaded: Loaded, places: FloatArray) -> Adrift:
    is_held = _holds(loaded.robot, places)
    before, body = robot.platform, loaded.robot.platform
    push, at_rest = (
        each.wrench_N[:3] + each.centre_force_N + each.drag_force_N for each in (body, before)
    )
    example = places[int(is_held.argmin())] if len(places) else np.full(3, np.nan)
    share = float((~is_held).mean()) if len(places) else 0.0
    return Adrift(loaded, share, example, float(np.linalg.norm(push - at_rest)))
