"""What the choice of a rope rests on: slopes, reserves, neighbouring sizes, and where it ends.

The governing pose is the worst of its region, so it may be held: what it gains by moving is of
second order (the envelope theorem). Only where it lies on a side of the region does it move, with
that side. With ropes for groups of cables each group has its own. On kept lengths, after the loss
of a cable or a change of temperature, when the platform rests elsewhere, slopes are differences of
solved states.

Each reserve is a root of the largest utilisation over the region. The worst poses that are known
are carried along: the root for these is found, the region searched there, and what is worse joins
them, until the search finds nothing above 100 %.

How far the platform may leave its region is marched out in each direction, until a pose is not
held.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from functools import partial

import numpy as np

from designer.arrays import BoolArray, FloatArray, IntArray
from designer.documents.plain import Json
from designer.model.cable import Cables
from designer.model.load_case import STATIC, Loaded
from designer.model.region import Region
from designer.model.robot import Poses, Robot
from designer.model.space import named_position
from designer.model.verdict import Verdict
from designer.model.workspace import Workspace
from designer.selection.assignment import Assignment
from designer.selection.candidate import Candidate
from designer.selection.cases import CaseResult
from designer.selection.result import SelectionResult
from designer.statics.geometry import load_wrench_N
from designer.statics.inverse import Statics, solve_sagging
from designer.statics.slopes import Slopes, utilisation_slopes
from designer.study import CableGroup, Study
from designer.workspace.demand import tension_demand
from designer.workspace.refine import LIGHT, refine

_STEP = 1e-4
"""Of differences, relative to an input, or in metres."""
_SAME = 1e-6
"""Relative: slopes that differ by less are the same."""
_FULL = 1e-5
"""Above 100 %: what is not worth another iteration."""
_NEAR = 0.8
"""Utilisation at the root from where on a load case is searched there."""
_MAX_ITERATIONS = 12
_MAX_PAYLOAD, _MAX_MARGIN = 100.0, 3.0
"""As a factor, and over the extent of the exit points."""
_PER_EDGE, _PER_FACE = 2, 6
"""Starts of ways out of the region."""
_STEPS, _BISECTIONS = 24, 30
"""From the region to the reach, shorter near the region; and of the last step."""
_OUTSIDE = 1e-6
"""Step that leaves the region, over the reach."""


@dataclass(frozen=True, slots=True)
class Sensitivity:
    """How the utilisation answers to one input."""

    input: str  #: its name in result files
    value: float  #: what it is now [unit]
    unit: str  #: SI; empty for a factor
    derivative: float  #: slope of the utilisation in it [1/unit]; NaN where there is none
    #: relative change over relative change; NaN also for an input without a scale of its own
    elasticity: float


@dataclass(frozen=True, slots=True, eq=False)
class Sensitivities:
    """What the utilisation of a rope answers to, where it is used most."""

    utilisation: float  #: now
    #: payload (a factor on weight and loads of the platform, with its inertia), breaking load and
    #: efficiency of the rope, modulus, mass of the rope, and region (metres by which its sides move
    #: outward). With ropes for groups ``modulus_`` and ``linear_mass_`` of the rope of each group,
    #: also of those that carry less.
    each: tuple[Sensitivity, ...]
    #: (n_cables, 3) slope in each exit point, base frame [1/m]; NaN where there is none
    exit_points_per_m: FloatArray
    method: str = "adjoint"  #: ``adjoint`` or ``differences``
    #: why there are no slopes, or not all, for the reader of a report; empty where there are
    why_not: str = ""
    group: CableGroup | None = None  #: the group that the rope is for; None of one for all cables

    def of(self, name: str) -> Sensitivity:
        """Return one of them by its name."""
        return next(slope for slope in self.each if slope.input == name)


_Mounted = tuple[str, IntArray, Loaded]
"""A rope: what its inputs are called by, the cables it is on (from 0), and with its load."""


def sensitivities(case: CaseResult, efficiency: float, breaking_load_N: float) -> Sensitivities:
    """Return the slopes at the worst pose of a load case, of a rope with these figures."""
    figures = breaking_load_N, efficiency
    if case.loaded.keeps_lengths:
        return _by_differences(case, figures)
    ties: tuple[Slopes, ...] = ()
    if case.statics is not None and case.statics.is_solved[0]:
        ties = utilisation_slopes(case.statics, case.loaded.cable.allowable_tension_N)
    why = ""
    if not ties:
        why = (
            "The internal forces that are best here are at a corner at which several choices are "
            "as good, so that the utilisation has no slope."
        )
    elif len(ties) > 1:
        cables = " and ".join(str(slopes.cable) for slopes in ties)
        why = f"Cables {cables} are used alike: where only one of them gains, there is no slope."
    ropes = [("", np.arange(case.loaded.robot.n_cables), case.loaded)]
    slopes, exits = _by_adjoint(ties, ropes, case.pose, case.workspace.region)
    if slopes and case.workspace.orientations.law is not None:
        slopes["region"] = _slope_of_sides(case)
    inputs = _named(case.utilisation, figures, ropes, slopes)
    return Sensitivities(case.utilisation, inputs, exits, why_not=why)


def group_sensitivities(
    robot: Robot, workspace: Workspace | None, assignment: Assignment
) -> tuple[Sensitivities, ...]:
    """Return the slopes of each group of cables; none where no ropes for groups were found."""
    if workspace is None or not assignment.has_groups:
        return ()
    return tuple(_of_group(robot, workspace, assignment, g) for g in range(len(assignment.groups)))


def _of_group(robot: Robot, workspace: Workspace, assignment: Assignment, g: int) -> Sensitivities:
    cables = Cables(tuple(rope.cable for rope in assignment.by_cable))
    ropes: list[_Mounted] = [
        (f"_{group.name}", np.array(group.cables) - 1, Loaded(STATIC, bare, *bare))
        for group, rope in zip(assignment.groups, assignment.ropes, strict=True)
        for bare in [(robot, rope.cable)]
    ]
    statics = solve_sagging(robot, Poses.at(assignment.verification.worst_place[g, None]), cables)
    of_group, rope = ropes[g][1], assignment.ropes[g]
    used = statics.cable_tension_N[0, of_group] / rope.cable.allowable_tension_N
    cable = int(of_group[used.argmax()])
    ties = utilisation_slopes(statics, cables.allowable_tension_N, cable + 1)
    slopes, exits = _by_adjoint(ties, ropes, statics.poses, workspace.region)
    if slopes and workspace.orientations.law is not None:
        slopes["region"] = np.nan  # the rotation that goes with it is not among the slopes
    figures = rope.size.minimum_breaking_load_N, rope.efficiency
    named = _named(float(used.max()), figures, ropes, slopes)
    why = (
        "Cables of other groups are used more there, or the internal forces that are best "
        "leave a choice, so that the utilisation has no slope."
    )
    return Sensitivities(
        float(used.max()), named, exits, why_not="" if ties else why, group=assignment.groups[g]
    )


def _by_adjoint(
    ties: Sequence[Slopes], ropes: Sequence[_Mounted], pose: Poses, region: Region
) -> tuple[dict[str, float], FloatArray]:
    """Return slopes by their names and in the exit points, NaN where cables that tie differ."""
    if not ties:
        return {}, np.full((ropes[0][2].robot.n_cables, 3), np.nan)
    rows = [dict(_slopes_at(slopes, ropes, pose, region)) for slopes in ties]
    exits = np.stack([slopes.exit_points_per_m for slopes in ties])
    is_same = np.ptp(exits, axis=0) <= _SAME * np.abs(exits).max()
    common = {}
    for name in rows[0]:
        values = [row[name] for row in rows]
        difference, largest = max(values) - min(values), max(map(abs, values))
        common[name] = values[0] if difference <= _SAME * largest else math.nan
    return common, np.where(is_same, exits[0], np.nan)


def _slopes_at(
    slopes: Slopes, ropes: Sequence[_Mounted], pose: Poses, region: Region
) -> Iterator[tuple[str, float]]:
    """Yield slopes in the logarithms of payload, modulus and mass, and in the region [1/m]."""
    loaded = ropes[0][2]
    heavier = load_wrench_N(with_payload(loaded, 2.0).robot, pose)[0]
    yield "payload", float(slopes.load @ (heavier - load_wrench_N(loaded.robot, pose)[0]))
    yield "region", float(slopes.position_per_m @ region.outward(pose.position_m[0]))
    for name, cables, rope in ropes:
        load = (_cable_load(with_density(rope, 2.0)) - _cable_load(rope))[cables]
        yield f"modulus{name}", float(slopes.stiffness[cables].sum())
        yield f"linear_mass{name}", float((slopes.cable_load_m_per_N[cables] * load).sum())


def _by_differences(case: CaseResult, figures: tuple[float, float]) -> Sensitivities:
    loaded = case.loaded

    def slope(changed: Callable[[float], Loaded]) -> float:
        ends = [case.tension_N(changed(sign * _STEP)) for sign in (1.0, -1.0)]
        return (ends[0] - ends[1]) / (2.0 * _STEP * loaded.cable.allowable_tension_N)

    slopes = {
        "payload": slope(lambda by: with_payload(loaded, 1.0 + by)),
        "modulus": slope(lambda by: with_stiffness(loaded, 1.0 + by)),
        "linear_mass": slope(lambda by: with_density(loaded, 1.0 + by)),
        "region": _slope_of_sides(case),
    }
    exits = np.full((loaded.robot.n_cables, 3), np.nan)
    for cable, axis in np.ndindex(exits.shape):
        exits[cable, axis] = slope(partial(with_exit_moved, loaded, cable, axis))
    finite = np.isfinite([*slopes.values(), *exits.ravel()]).all()
    why = "" if finite else "Near this pose the platform finds no rest on the kept lengths."
    ropes = [("", np.arange(len(exits)), loaded)]
    inputs = _named(case.utilisation, figures, ropes, slopes)
    exits = np.where(np.isfinite(exits), exits, np.nan)
    return Sensitivities(case.utilisation, inputs, exits, "differences", why)


def _slope_of_sides(case: CaseResult) -> float:
    """Return the slope of the utilisation as the sides of the region move outward [1/m]."""
    space, place = case.workspace.space, case.verification.worst_place
    side = np.zeros_like(place)
    side[:3] = space.region.outward(place[:3])

    def utilisation(by: float) -> float:
        moved = replace(case.verification, worst_place=space.following(place + by * side))
        tension_N = replace(case, verification=moved).tension_N(case.loaded)
        return tension_N / case.loaded.cable.allowable_tension_N

    return (utilisation(_STEP) - utilisation(-_STEP)) / (2.0 * _STEP) if side.any() else 0.0


def _named(
    utilisation: float,
    figures: tuple[float, float],
    ropes: Sequence[_Mounted],
    slopes: Mapping[str, float],
) -> tuple[Sensitivity, ...]:
    """Return slopes in logarithms, and in the region [1/m], NaN where there is none.

    ``figures`` are breaking load [N] and efficiency of the rope.
    """

    def relative(name: str, value: float, unit: str, slope: float) -> Sensitivity:
        return Sensitivity(name, value, unit, slope / value, slope / utilisation)

    bare = [(name, loaded.bare[1]) for name, _, loaded in ropes]
    of_ropes = {
        f"{quantity}{name}": (value, unit)
        for name, cable in bare
        for quantity, value, unit in (
            ("modulus", cable.axial_stiffness_N, "N"),
            ("linear_mass", cable.rope_density_kg_per_m, "kg/m"),
        )
    }
    return (
        relative("payload", 1.0, "", slopes.get("payload", math.nan)),
        relative("breaking_load", figures[0], "N", -utilisation),
        relative("efficiency", figures[1], "", -utilisation),
        *(relative(name, *of, slopes.get(name, math.nan)) for name, of in of_ropes.items()),
        Sensitivity("region", 0.0, "m", slopes.get("region", math.nan), math.nan),
    )


def _cable_load(loaded: Loaded) -> FloatArray:
    """Return the load per unstrained length of the cables (n_cables, 3), base frame [N/m]."""
    weight = loaded.cable.weight_N_per_m * np.ones(loaded.robot.n_cables)
    return np.asarray(np.multiply.outer(-weight, loaded.robot.upright[2]))


def with_payload(loaded: Loaded, factor: float) -> Loaded:
    """Return the same with weight, inertia and loads of the platform so many times as large.

    Wind on the platform stays.
    """
    scaled = payload_scaled(loaded, factor)
    return scaled.on(*scaled.bare)


def payload_scaled(loaded: Loaded, factor: float) -> Loaded:
    """Return its load case with that, and what it is put on, to be put on."""
    (robot, cable), case = loaded.bare, loaded.case
    body = robot.platform
    wrench, offset = factor * case.wrench_on(body), factor * body.wrench_offset_N
    inertia = body.inertia_kg_m2 if case.inertia_kg_m2 is None else case.inertia_kg_m2
    scaled = replace(body, mass_kg=factor * case.mass_on(body), wrench_offset_N=offset)
    if body.motion is not None and inertia is not None:
        case = replace(case, inertia_kg_m2=None)
        scaled = replace(scaled, inertia_kg_m2=factor * inertia)
    robot = replace(robot, platform=scaled)
    if case.wrench_set is None or loaded.wrench_N is None:
        case = replace(case, mass_kg=None, wrench_N=wrench - offset)
        return replace(loaded, case=case, bare=(robot, cable))
    case = replace(case, mass_kg=None, wrench_set=case.wrench_set.scaled(factor))
    return replace(loaded, case=case, bare=(robot, cable), wrench_N=factor * loaded.wrench_N)


def with_density(loaded: Loaded, factor: float) -> Loaded:
    """Return the same with a rope so many times as heavy."""
    robot, cable = loaded.bare
    return loaded.on(robot, cable.with_rope_scaled(factor))


def with_stiffness(loaded: Loaded, factor: float) -> Loaded:
    """Return the same with a rope so many times as stiff."""
    robot, cable = loaded.bare
    stiffer = replace(cable, axial_stiffness_N=factor * cable.axial_stiffness_N)
    return loaded.on(robot, stiffer)


def with_exit_moved(loaded: Loaded, cable: int, axis: int, by_m: float) -> Loaded:
    """Return the same with one exit point moved along an axis, both from 0 [m]."""
    robot, line = loaded.bare
    exits = np.array(robot.exit_points_m)
    exits[cable, axis] += by_m
    moved = replace(robot, exit_points_m=exits)
    return loaded.on(moved, line)


@dataclass(frozen=True, slots=True, eq=False)
class Reserve:
    """Where the reserve in one quantity ends."""

    #: payload factor, or metres by which the sides of the region may move outward; NaN where no end
    #: was found
    value: float
    utilisation: float  #: the largest there that the search finds
    load_case: str  #: which case is at its end there
    place: FloatArray = field(metadata={"json": named_position})  #: (n_coordinates,) where [m, rad]
    #: whether the rope is used up there; False where beyond it a pose is not held at all
    is_held: bool = field(default=True, metadata={"json": "held"})


@dataclass(frozen=True, slots=True, eq=False)
class _MovingPose:
    """A pose of a load case that moves with the quantity whose reserve is sought."""

    case: CaseResult
    place: FloatArray
    value: float  #: of the quantity, where the pose is at ``place``
    outward: FloatArray  #: by how much the place moves for each unit of it

    def place_at(self, value: float) -> FloatArray:
        moved = np.asarray(self.place + (value - self.value) * self.outward)
        return self.case.workspace.space.following(moved)


_Change = Callable[[CaseResult, float], tuple[Loaded, Workspace]]


def payload_reserve(cases: Sequence[CaseResult]) -> Reserve | None:
    """Return by which factor weight and loads of the platform may grow; None where none was found.

    Wind on the platform stays.
    """

    def heavier(case: CaseResult, factor: float) -> tuple[Loaded, Workspace]:
        return with_payload(case.loaded, factor), case.workspace

    return _end(cases, heavier, (1.0, _MAX_PAYLOAD, 0.1), is_moving=False)


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
    return _end(moving, wider, (0.0, _MAX_MARGIN * size, 0.02 * size), is_moving=True)


def _end(
    cases: Sequence[CaseResult],
    change: _Change,
    span: tuple[float, float, float],
    *,
    is_moving: bool,
) -> Reserve | None:
    """Find where the worst of the cases is used to 100 %: from, to, and first step of a bracket."""

    def moving(case: CaseResult, place: FloatArray, value: float) -> _MovingPose:
        outward = np.zeros_like(place)
        if is_moving:
            outward[:3] = change(case, value)[1].region.outward(place[:3])
        return _MovingPose(case, place, value, outward)

    def utilisation(pose: _MovingPose, value: float) -> float:
        loaded, workspace = change(pose.case, value)
        demand = tension_demand(loaded, workspace.hangs_below, pose.place_at(value)[None])
        return float(demand[0]) / loaded.cable.allowable_tension_N

    def searched(case: CaseResult, value: float) -> _MovingPose:
        """Return the worst pose of a case there that a search from its poses finds."""
        loaded, workspace = change(case, value)
        starts = np.array([pose.place_at(value) for pose in poses if pose.case is case])
        if loaded.keeps_lengths:
            return moving(case, starts[0], value)
        demand = partial(tension_demand, loaded, workspace.hangs_below)
        (worst,) = refine(workspace.space, demand, starts, LIGHT)
        return moving(case, worst.place, value)

    def largest(value: float) -> float:
        return max(utilisation(pose, value) for pose in poses)

    poses = [moving(case, case.verification.worst_place, span[0]) for case in cases]
    for _ in range(_MAX_ITERATIONS):
        value = _root(largest, *span)
        if value is None:
            return None
        highest = max(poses, key=lambda pose: utilisation(pose, value))
        near = dict.fromkeys(pose.case for pose in poses if utilisation(pose, value) > _NEAR)
        candidates = [searched(case, value) for case in near]
        overloaded = [pose for pose in candidates if utilisation(pose, value) > 1.0 + _FULL]
        if not overloaded:
            highest_found = max(utilisation(pose, value) for pose in (*poses, *candidates))
            beyond = utilisation(highest, value + 1e-6 * max(abs(value), span[2]))
            name = highest.case.case.name
            return Reserve(
                value, highest_found, name, highest.place_at(value), math.isfinite(beyond)
            )
        poses += overloaded
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


@dataclass(frozen=True, slots=True, eq=False)
class FirstFailure:
    """The first pose on the way out of the region that a rope does not hold."""

    name: str  #: of the direction, such as ``+x`` or ``up``
    direction: FloatArray  #: (3,) unit vector
    #: from where the way leaves the region [m]; NaN where all poses up to the reach are held
    distance_m: float
    position_m: FloatArray = field(metadata={"json": "pose"})  #: (3,) where it fails [m]
    why: str  #: ``overloaded``, or the label of the verdict
    reach_m: float = field(metadata={"json": "looked_m"})  #: how far it was looked [m]


def first_failures(case: CaseResult) -> tuple[FirstFailure, ...]:
    """Return the first failure in each direction, in a load case, as turned at its worst pose.

    Ways lead from corners, edges and sides of the region straight outward. Empty for a list of
    points, and where lengths are kept.
    """
    region, loaded = case.workspace.region, case.loaded
    if region.is_discrete or loaded.keeps_lengths:
        return ()
    rotation = case.verification.worst_place[3:]
    reach = float(np.ptp(loaded.bare[0].exit_points_m, axis=0).max())
    border, directions = region.border(), _directions(region, loaded)
    places = border.samples_m(np.random.default_rng(0), _PER_EDGE, _PER_FACE)
    places = np.concatenate([border.landmarks_m(), places])
    leaves = [~region.contains(places + _OUTSIDE * reach * along) for _, along in directions]
    way = np.repeat(np.arange(len(directions)), [mask.sum() for mask in leaves])
    start = np.concatenate([places[mask] for mask in leaves])
    along = np.array([along for _, along in directions])[way]

    def solve(position_m: FloatArray) -> Statics:
        rotations = np.broadcast_to(rotation, (len(position_m), len(rotation)))
        poses = Poses.at(np.hstack([position_m, rotations]))
        return solve_sagging(loaded.robot, poses, loaded.cable)

    def fails(rows: IntArray, distance_m: FloatArray) -> BoolArray:
        statics = solve(start[rows] + distance_m[:, None] * along[rows])
        is_overloaded = statics.largest_tension_N > loaded.cable.allowable_tension_N
        return np.asarray(~statics.is_solved | is_overloaded)

    distance = _first_distances_m(fails, way, reach)
    failures = []
    for k, (name, direction) in enumerate(directions):
        rows = np.flatnonzero((way == k) & np.isfinite(distance))
        far, place, why = np.nan, np.full(3, np.nan), ""
        if len(rows):
            nearest = rows[distance[rows].argmin()]
            far, place = float(distance[nearest]), start[nearest] + distance[nearest] * direction
            statics = solve(place[None])
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
    for far in reach_m * (np.arange(1, _STEPS + 1) / _STEPS) ** 2:
        hit = fails(going, np.full(len(going), far))
        high[going[hit]] = far
        going = going[~np.isin(way[going], way[going[hit]])]
        if not len(going):
            break
        low[going] = far
    rows = np.flatnonzero(np.isfinite(high))
    for _ in range(_BISECTIONS if len(rows) else 0):
        middle = 0.5 * (low[rows] + high[rows])
        hit = fails(rows, middle)
        high[rows[hit]], low[rows[~hit]] = middle[hit], middle[~hit]
        least = np.full(way.max() + 1, np.inf)
        np.minimum.at(least, way[rows], high[rows])
        is_first = low[rows] <= least[way[rows]]
        high[rows[~is_first]] = np.inf  # what fails farther out for sure is not the first
        rows = rows[is_first]
    return high


@dataclass(frozen=True, slots=True, eq=False)
class NeighbouringSize:
    """The chosen size, or the next one of its grade."""

    #: the size
    candidate: Candidate = field(
        metadata={"json": lambda rope: rope.ids | {"total_mass_kg": rope.total_mass_kg}}
    )
    load_case: str  #: the one that asks for most of it
    #: the largest of the samples and of the chosen size's worst pose, for the chosen one searched
    max_tension_N: float
    utilisation: float
    safety_factor: float  #: what is left of the breaking load over that tension


@dataclass(frozen=True, slots=True, eq=False)
class SensitivityReport:
    """What the choice of a rope for all cables rests on."""

    governing: CaseResult  #: the load case that governs
    sensitivities: Sensitivities  #: at its worst pose
    #: of the payload, in all load cases; None where no end was found, as the next
    payload: Reserve | None
    region: Reserve | None
    #: the next thinner size of the grade, the chosen one, the next thicker one, where there are
    sizes: tuple[NeighbouringSize, ...]
    #: the first pose that is not held, in each direction out of the region
    failures: tuple[FirstFailure, ...]

    @property
    def nearest(self) -> FirstFailure | None:
        """The nearest of the failures."""
        return min(
            (failure for failure in self.failures if failure.distance_m >= 0.0),
            key=lambda failure: failure.distance_m,
            default=None,
        )


def sensitivity_report(
    study: Study, selection: SelectionResult | None, rope: Candidate | None
) -> SensitivityReport | None:
    """Return what the choice of a rope for all cables rests on; None without one."""
    if selection is None or rope is None or study.selection is None or study.workspace is None:
        return None
    breaking_load_N = rope.size.minimum_breaking_load_N
    return SensitivityReport(
        governing=rope.governing,
        sensitivities=sensitivities(rope.governing, rope.efficiency, breaking_load_N),
        payload=payload_reserve(rope.cases),
        region=region_reserve(rope.cases, study.workspace.region),
        sizes=tuple(_sizes(selection, rope, study.selection.safety_factor)),
        failures=first_failures(rope.governing),
    )


def _sizes(
    selection: SelectionResult, rope: Candidate, safety_factor: float
) -> Iterator[NeighbouringSize]:
    """Yield the size and its neighbours, by diameter."""
    worst = rope.governing
    for candidate in selection.beside(rope):
        governing = candidate.governing
        case, tension_N = governing.case, governing.verification.max_tension_N
        utilisation = governing.utilisation
        for case_result in (c for c in candidate.cases if c.case is worst.case):
            loaded = worst.loaded.on(*case_result.loaded.bare)
            at_worst_N = worst.tension_N(loaded)
            if at_worst_N / loaded.cable.allowable_tension_N > utilisation:
                utilisation = at_worst_N / loaded.cable.allowable_tension_N
                tension_N, case = at_worst_N, case_result.case
        factor = case.safety_factor or safety_factor
        yield NeighbouringSize(candidate, case.name, tension_N, utilisation, factor / utilisation)


def sensitivity_dict(report: SensitivityReport | None, groups: Sequence[Sensitivities]) -> Json:
    """Return sensitivities, reserves, sizes and first failures; empty where none is chosen.

    Of ``groups`` there are sensitivities alone, each with the name of its group.
    """
    if report is None:
        rows = [*_sensitivities(groups)]
        return {"sensitivities": rows, "reserve": None, "sizes_beside": [], "first_failures": []}
    return {
        "sensitivities": [*_sensitivities([report.sensitivities])],
        "reserve": {
            "payload_factor": math.nan if report.payload is None else report.payload.value,
            "region_margin_m": math.nan if report.region is None else report.region.value,
            "payload": report.payload,
            "region": report.region,
        },
        "sizes_beside": report.sizes,
        "first_failures": report.failures,
    }


def _sensitivities(of_ropes: Iterable[Sensitivities]) -> Iterator[Json]:
    for of_rope in of_ropes:
        rows: list[Json] = [asdict(sensitivity) for sensitivity in of_rope.each]
        for (cable, axis), slope in np.ndenumerate(of_rope.exit_points_per_m):
            name = f"exit_point_{cable + 1}_{'xyz'[axis]}"
            rows.append(asdict(Sensitivity(name, math.nan, "m", float(slope), math.nan)))
        group = of_rope.group and of_rope.group.name
        yield from (row | {"method": of_rope.method, "group": group} for row in rows)
