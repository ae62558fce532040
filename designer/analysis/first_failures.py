"""How far the platform may leave its region in each direction, until a pose is not held."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from designer.arrays import BoolArray, FloatArray
from designer.model.load_case import Loaded
from designer.model.region import Region
from designer.model.robot import Poses
from designer.model.verdict import Verdict
from designer.selection.cases import CaseResult
from designer.statics.inverse import solve_sagging

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
    return tuple(
        _along(region, loaded, turn, name, along) for name, along in _directions(region, loaded)
    )


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


def _along(
    region: Region, loaded: Loaded, turn_rad: FloatArray, name: str, along: FloatArray
) -> FirstFailure:
    """March out from the border until the first pose fails, and halve the last step."""
    reach = float(np.ptp(loaded.bare[0].exit_points_m, axis=0).max())
    border = region.border()
    starts = border.samples_m(np.random.default_rng(0), _PER_EDGE, _PER_FACE)
    starts = np.concatenate([border.landmarks_m(), starts])
    starts = starts[~region.contains(starts + _OUT * reach * along)]

    def fails(start_m: FloatArray, distance_m: FloatArray) -> BoolArray:
        return _failure(loaded, start_m + distance_m[:, None] * along, turn_rad)[0]

    before = 0.0
    for far in reach * (np.arange(1, _TURNS + 1) / _TURNS) ** 2:
        hit = fails(starts, np.full(len(starts), far))
        if hit.any():
            starts = starts[hit]
            break
        before = far
    else:
        return FirstFailure(name, along, np.nan, np.full(3, np.nan), "", reach)
    low, high = np.full(len(starts), before), np.full(len(starts), far)
    for _ in range(_HALVES):
        middle = 0.5 * (low + high)
        hit = fails(starts, middle)
        low, high = np.where(hit, low, middle), np.where(hit, middle, high)
        candidates = low <= high.min()  # what fails farther out for sure is not the first
        starts, low, high = starts[candidates], low[candidates], high[candidates]
    nearest = int(high.argmin())
    place = starts[nearest] + high[nearest] * along
    why = _failure(loaded, place[None], turn_rad)[1][0]
    return FirstFailure(name, along, float(high[nearest]), place, why, reach)


def _failure(
    loaded: Loaded, position_m: FloatArray, turn_rad: FloatArray
) -> tuple[BoolArray, list[str]]:
    """Tell which positions fail (n,), and why the first of them does, or the last does not."""
    turns = np.broadcast_to(turn_rad, (len(position_m), len(turn_rad)))
    places = np.hstack([position_m, turns])
    statics = solve_sagging(loaded.robot, Poses.at(places), loaded.cable, seeks_better=False)
    over = statics.largest_tension_N > loaded.cable.allowable_tension_N
    why = ["overloaded" if s else Verdict(int(v)).label for s, v in
           zip(statics.is_solved, statics.verdict, strict=True)]  # fmt: skip
    return np.asarray(~statics.is_solved | over), why
