"""How far the platform may leave its region in each direction, until a pose is not held."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from designer.arrays import BoolArray, FloatArray, IntArray
from designer.model.load_case import Loaded
from designer.model.region import Region
from designer.model.robot import Poses
from designer.model.verdict import Verdict
from designer.selection.cases import CaseResult
from designer.statics.inverse import Statics, solve_sagging

_PER_EDGE, _PER_FACE = 2, 6
_TURNS = 24
"""Steps from the region to the reach, shorter near the region."""
_HALVES = 30
_OUT = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class FirstFailure:
    """The first pose on the way out of the region that a rope does not hold.

    Parameters
    ----------
    name : str
        Of the direction, such as ``+x`` or ``up``.
    direction : array (3,)
        Unit vector.
    distance_m : float
        From where the way leaves the region [m]; NaN where all poses up to the reach are held.
    position_m : array (3,)
        Where it fails [m].
    why : str
        ``overloaded``, or the label of the verdict.
    reach_m : float
        How far it was looked [m].
    """

    name: str
    direction: FloatArray
    distance_m: float
    position_m: FloatArray = field(metadata={"json": "pose"})
    why: str
    reach_m: float = field(metadata={"json": "looked_m"})


def first_failures(case: CaseResult) -> tuple[FirstFailure, ...]:
    """Return the first failure in each direction, in a load case, as turned at its worst pose.

    Ways lead from corners, edges and sides of the region straight outward. Empty for a list of
    points, and where lengths are kept.
    """
    region, loaded = case.workspace.region, case.loaded
    if region.is_discrete or loaded.keeps_lengths:
        return ()
    turn = case.verification.worst_place[3:]
    reach = float(np.ptp(loaded.bare[0].exit_points_m, axis=0).max())
    border, directions = region.border(), _directions(region, loaded)
    places = border.samples_m(np.random.default_rng(0), _PER_EDGE, _PER_FACE)
    places = np.concatenate([border.landmarks_m(), places])
    leaves = [~region.contains(places + _OUT * reach * along) for _, along in directions]
    way = np.repeat(np.arange(len(directions)), [mask.sum() for mask in leaves])
    start = np.concatenate([places[mask] for mask in leaves])
    along = np.array([along for _, along in directions])[way]
    distance = _first_distances_m(
        lambda rows, far: _fails(loaded, start[rows] + far[:, None] * along[rows], turn),
        way,
        reach,
    )
    failures = []
    for k, (name, direction) in enumerate(directions):
        rows = np.flatnonzero((way == k) & np.isfinite(distance))
        far, place, why = np.nan, np.full(3, np.nan), ""
        if len(rows):
            nearest = rows[distance[rows].argmin()]
            far, place = float(distance[nearest]), start[nearest] + distance[nearest] * direction
            statics = _solved(loaded, place[None], turn)
            is_solved, verdict = statics.is_solved[0], Verdict(int(statics.verdict[0]))
            why = "overloaded" if is_solved else verdict.label
        failures.append(FirstFailure(name, direction, far, place, why, reach))
    return tuple(failures)


def _directions(region: Region, loaded: Loaded) -> list[tuple[str, FloatArray]]:
    robot = loaded.bare[0]
    up = robot.level[2]
    if robot.is_planar or region.is_upright:
        across = np.append(region.along, 0.0) if region.is_upright else robot.level[0]
        level = {"outward": across, "outward, other side": -across}
    else:
        x, y = np.eye(3)[:2]
        level = {"+x": x, "+x +y": x + y, "+y": y, "-x +y": y - x}
        level |= {"-x": -x, "-x -y": -x - y, "-y": -y, "+x -y": x - y}
    axes = {**level, "up": up, "down": -up}
    return [(name, along / np.linalg.norm(along)) for name, along in axes.items()]


def _first_distances_m(
    fails: Callable[[IntArray, FloatArray], BoolArray], way: IntArray, reach_m: float
) -> FloatArray:
    """March out along all ways (n,) of each direction until one fails, and halve the last step.

    Returns
    -------
    array (n,)
        Where the first of a direction fail [m]; infinite for the others.
    """
    low, high = np.zeros(len(way)), np.full(len(way), np.inf)
    going = np.arange(len(way))
    for far in reach_m * (np.arange(1, _TURNS + 1) / _TURNS) ** 2:
        hit = fails(going, np.full(len(going), far))
        high[going[hit]] = far
        going = going[~np.isin(way[going], way[going[hit]])]
        if not len(going):
            break
        low[going] = far
    rows = np.flatnonzero(np.isfinite(high))
    for _ in range(_HALVES if len(rows) else 0):
        middle = 0.5 * (low[rows] + high[rows])
        hit = fails(rows, middle)
        high[rows[hit]], low[rows[~hit]] = middle[hit], middle[~hit]
        least = np.full(way.max() + 1, np.inf)
        np.minimum.at(least, way[rows], high[rows])
        is_first = low[rows] <= least[way[rows]]
        high[rows[~is_first]] = np.inf  # what fails farther out for sure is not the first
        rows = rows[is_first]
    return high


def _solved(loaded: Loaded, position_m: FloatArray, turn_rad: FloatArray) -> Statics:
    turns = np.broadcast_to(turn_rad, (len(position_m), len(turn_rad)))
    poses = Poses.at(np.hstack([position_m, turns]))
    return solve_sagging(loaded.robot, poses, loaded.cable)


def _fails(loaded: Loaded, position_m: FloatArray, turn_rad: FloatArray) -> BoolArray:
    statics = _solved(loaded, position_m, turn_rad)
    over = statics.largest_tension_N > loaded.cable.allowable_tension_N
    return np.asarray(~statics.is_solved | over)
