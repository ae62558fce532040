"""What the utilisation at the governing pose answers to, by the slopes of the solved state.

The governing pose is the worst of its region, so it may be held: what it gains by moving is of
second order (the envelope theorem). Only where it lies on a side of the region does it move, with
that side. With ropes for groups of cables each group has its own. On kept lengths, after the loss
of a cable or a change of temperature, when the platform rests elsewhere, slopes are differences of
solved states.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.model.cable import Cables
from designer.model.load_case import STATIC, Loaded
from designer.model.region import Region
from designer.model.robot import Poses, Robot
from designer.model.workspace import Workspace
from designer.selection.assignment import Assignment
from designer.selection.cases import CaseResult
from designer.statics.geometry import load_wrench_N
from designer.statics.inverse import solve_sagging
from designer.statics.slopes import Slopes, utilisation_slopes
from designer.study import CableGroup

_STEP = 1e-4
_ALIKE = 1e-6


@dataclass(frozen=True, slots=True)
class Sensitivity:
    """How the utilisation answers to one input.

    Parameters
    ----------
    input : str
        Its name in result files.
    value : float
        What it is now [unit].
    unit : str
        SI; empty for a factor.
    derivative : float
        Slope of the utilisation in it [1/unit]; NaN where there is none.
    elasticity : float
        Relative change over relative change; NaN also for an input without a scale of its own.
    """

    input: str
    value: float
    unit: str
    derivative: float
    elasticity: float


@dataclass(frozen=True, slots=True, eq=False)
class Sensitivities:
    """What the utilisation of a rope answers to, where it is used most.

    Parameters
    ----------
    utilisation : float
        Now.
    each : tuple of Sensitivity
        Payload (a factor on weight and loads of the platform, with its inertia), breaking load and
        efficiency of the rope, modulus, mass of the rope, and region (metres by which its sides
        move outward). With ropes for groups ``modulus_`` and ``linear_mass_`` of the rope of each
        group, also of those that carry less.
    exit_points_per_m : array (n_cables, 3)
        Slope in each exit point, base frame [1/m]; NaN where there is none.
    method : str
        ``adjoint`` or ``differences``.
    why_not : str
        Why there are no slopes, or not all, for the reader of a report; empty where there are.
    group : CableGroup or None
        The group that the rope is for; None of one for all cables.
    """

    utilisation: float
    each: tuple[Sensitivity, ...]
    exit_points_per_m: FloatArray
    method: str = "adjoint"
    why_not: str = ""
    group: CableGroup | None = None

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
    used = case.utilisation
    return Sensitivities(used, _named(used, figures, ropes, slopes), exits, why_not=why)


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
        slopes["region"] = np.nan  # the turn that goes with it is not among the slopes
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
    alike = np.ptp(exits, axis=0) <= _ALIKE * np.abs(exits).max()
    agreed = {name: _agreed([row[name] for row in rows]) for name in rows[0]}
    return agreed, np.where(alike, exits[0], np.nan)


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

    def used(by: float) -> float:
        moved = replace(case.verification, worst_place=space.following(place + by * side))
        tension_N = replace(case, verification=moved).tension_N(case.loaded)
        return tension_N / case.loaded.cable.allowable_tension_N

    return (used(_STEP) - used(-_STEP)) / (2.0 * _STEP) if side.any() else 0.0


def _named(
    used: float,
    figures: tuple[float, float],
    ropes: Sequence[_Mounted],
    slopes: Mapping[str, float],
) -> tuple[Sensitivity, ...]:
    """Return slopes in logarithms, and in the region [1/m], NaN where there is none.

    ``figures`` are breaking load [N] and efficiency of the rope.
    """

    def relative(name: str, value: float, unit: str, slope: float) -> Sensitivity:
        return Sensitivity(name, value, unit, slope / value, slope / used)

    bare = [(name, loaded.bare[1]) for name, _, loaded in ropes]
    every = {
        f"{quantity}{name}": (value, unit)
        for name, cable in bare
        for quantity, value, unit in (
            ("modulus", cable.axial_stiffness_N, "N"),
            ("linear_mass", cable.rope_density_kg_per_m, "kg/m"),
        )
    }
    return (
        relative("payload", 1.0, "", slopes.get("payload", math.nan)),
        relative("breaking_load", figures[0], "N", -used),
        relative("efficiency", figures[1], "", -used),
        *(relative(name, *of, slopes.get(name, math.nan)) for name, of in every.items()),
        Sensitivity("region", 0.0, "m", slopes.get("region", math.nan), math.nan),
    )


def _agreed(values: list[float]) -> float:
    """Return the slope that all ties have; NaN where they differ."""
    alike = max(values) - min(values) <= _ALIKE * max(map(abs, values), default=0.0)
    return values[0] if alike else math.nan


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
