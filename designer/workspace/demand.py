"""What places ask for: a diameter, or a tension; what the search for the worst is to maximise."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from itertools import chain

import numpy as np

from designer.arrays import BoolArray, FloatArray, IntArray
from designer.model.cable import Cable, Cables, Material, MaterialsByPose
from designer.model.load_case import Loaded
from designer.model.robot import Poses, Robot
from designer.model.space import Space
from designer.model.verdict import Verdict
from designer.model.workspace import HangsBelow, Workspace
from designer.sizing.newton import Sizing, size_poses
from designer.statics.cable_loss import CableLoss, settle
from designer.statics.inverse import Statics, solve_massless, solve_sagging, tension_over_least
from designer.workspace.refine import ONE_CLIMB, places_of, refine_each

_TWO_CLIMBS = replace(ONE_CLIMB, inside=512, starts=2)
"""For each cable: what straight ones give is searched again with the cable's weight."""


def is_left_out(statics: Statics, hangs_below: HangsBelow) -> BoolArray:
    """Tell which poses (...) the study leaves out because a cable hangs below the platform.

    Poses without a finite cable are among them: as the section grows, the platform's weight stops
    mattering, so the pulls on it sum to zero, and one cable at least hangs below it.
    """
    if hangs_below == "include":
        return np.zeros(statics.verdict.shape, dtype=np.bool_)
    return np.asarray(statics.hangs_below | (statics.verdict == Verdict.NO_FINITE_CABLE))


def is_counted(statics: Statics, hangs_below: HangsBelow) -> BoolArray:
    """Tell which poses (...) are solved and not left out."""
    return statics.is_solved & ~is_left_out(statics, hangs_below)


def size_worst(
    robot: Robot, workspace: Workspace, positions_m: FloatArray, material: Material
) -> tuple[FloatArray, Sizing]:
    """Size positions (n, 3), each in the orientation that asks for the most there.

    The places (n, n_coordinates) in that orientation [m, rad], and what is needed there.
    """
    demand = partial(diameter_demand, robot, material, workspace.hangs_below)
    places = at_worst_orientation(workspace.space, positions_m, demand)
    return places, size_poses(robot, Poses.at(places), material)


def at_worst_orientation(
    space: Space, positions_m: FloatArray, demand: Callable[[FloatArray], FloatArray]
) -> FloatArray:
    """Return of positions (n, 3) the place (n, n_coordinates) in the orientation of most demand.

    Where nothing is enough in an orientation, no other one is tried.
    """
    places, count = space.places(positions_m), space.orientations.count
    values, rows = np.full((len(positions_m), count), -np.inf), np.arange(len(positions_m))
    for k in range(count if count > 1 else 0):
        values[rows, k] = demand(places[rows * count + k])
        rows = rows[~np.isposinf(values[rows, k])]
    return np.asarray(places[np.arange(len(positions_m)) * count + values.argmax(axis=1)])


def diameter_demand(
    robot: Robot,
    material: Material | MaterialsByPose,
    hangs_below: HangsBelow,
    places: FloatArray,
) -> FloatArray:
    """Needed diameter [m]; inf where no cable of the family will do."""
    sizing = size_poses(robot, Poses.at(places), material)
    return demand_of(sizing.diameter_m, sizing.statics, hangs_below)


def rope_demand(
    robot: Robot,
    cable: Cable | Cables,
    hangs_below: HangsBelow,
    places: FloatArray,
) -> FloatArray:
    """What a given cable meets (n, 1 + 2 n_cables): largest tension [N], lengths, negated lengths.

    Lengths are unstrained [m]; the largest of the negated ones is the shortest.
    """
    statics = solve_sagging(robot, Poses.at(places), cable)
    tension = demand_of(statics.largest_tension_N, statics, hangs_below)
    return np.column_stack([tension, length_demand(statics, np.isfinite(tension))])


def tension_demand(loaded: Loaded, hangs_below: HangsBelow, places: FloatArray) -> FloatArray:
    """Largest tension in a load case [N]; inf where the platform is not held, or finds no rest.

    On kept lengths that after it has settled; which poses are left out is told by how the cables
    hang before.
    """
    poses = Poses.at(places)
    if loaded.keeps_lengths:
        cable_loss = settled(loaded, poses)
        left_out = is_left_out(cable_loss.before, hangs_below)
        return np.where(left_out, -np.inf, cable_loss.largest_tension_N)
    statics = solve_sagging(loaded.robot, poses, loaded.cable)
    return demand_of(statics.largest_tension_N, statics, hangs_below)


def settled(loaded: Loaded, poses: Poses) -> CableLoss:
    """Return what becomes of poses (n_poses,) in a load case in which lengths are kept."""
    return settle(loaded.robot, poses, loaded.cable, loaded.lost_cable, loaded.growth)


def length_demand(statics: Statics, counts: BoolArray) -> FloatArray:
    """Return lengths and negated lengths (n, 2 n_cables) [m], -inf where a pose does not count."""
    lengths = np.hstack([statics.length_m, -statics.length_m])
    return np.where(counts[:, None], lengths, -np.inf)


def massless_demand(
    robot: Robot,
    material: Material,
    hangs_below: HangsBelow,
    places: FloatArray,
) -> FloatArray:
    """Largest tension of straight weightless cables [N]; inf where they do not hold the platform.

    Of the poses that count with sagging cables, so that the two can be compared. Toward a pose that
    straight cables do not hold the tension can grow without bound, so that among those that they
    do hold there need be no largest.
    """
    if hangs_below == "include":
        tension = solve_massless(robot, Poses.at(places)).largest_tension_N
        return np.where(np.isnan(tension), np.inf, tension)
    sizing = size_poses(robot, Poses.at(places), material)
    return massless_demand_of(sizing, hangs_below)


def massless_demand_of(sizing: Sizing, hangs_below: HangsBelow) -> FloatArray:
    """Return the largest tension of straight cables (...) as demands; see `massless_demand`."""
    tension = sizing.massless_tension_N
    demand = np.where(np.isnan(tension), np.inf, tension)
    return np.where(is_left_out(sizing.statics, hangs_below), -np.inf, demand)


def demand_of(value: FloatArray, statics: Statics, hangs_below: HangsBelow) -> FloatArray:
    """Return values (...) as demands: inf where a pose is not solved, -inf where it is left out."""
    demand = np.where(statics.is_solved, value, np.inf)
    return np.where(is_left_out(statics, hangs_below), -np.inf, demand)


def where_each_pulls_most(robots: Sequence[Robot], space: Space, places: FloatArray) -> FloatArray:
    """Return where each straight cable pulls most (n, n_coordinates), by a short climb from places.

    Of one robot under one or several loads. Some cables of redundant robots have their least
    tension in almost every pose, and nothing there leads a search to the few in which they carry.
    With straight cables something does: how far each is from it. None for other robots, nor in a
    space in which every place is tried.
    """
    if space.is_discrete or not robots[0].is_redundant:
        return np.empty((0, space.n_coordinates))

    def pull(places: FloatArray, load: IntArray) -> FloatArray:
        loads, first = np.unique(load, return_index=True)
        parts = zip(loads, np.split(places, first[1:]), strict=True)
        over = [tension_over_least(robots[k], Poses.at(part)) for k, part in parts]
        return np.nan_to_num(np.concatenate(over), nan=-np.inf)

    worsts = refine_each(space, pull, [places] * len(robots), _TWO_CLIMBS)
    return places_of(chain.from_iterable(worsts))
