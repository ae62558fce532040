"""What the utilisation of each group of cables answers to, at the pose where it is used most.

As `designer.analysis.sensitivities`, with a rope for each group: stiffness and mass of the rope of
every group count, also those of groups that carry less.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from designer.analysis.sensitivities import Sensitivity
from designer.arrays import FloatArray, IntArray
from designer.model.cable import Cables
from designer.model.robot import Poses, Robot
from designer.model.workspace import Workspace
from designer.selection.assignment import Assignment
from designer.statics.geometry import load_wrench_N
from designer.statics.inverse import solve_sagging
from designer.statics.slopes import utilisation_slopes
from designer.study import CableGroup


@dataclass(frozen=True, slots=True, eq=False)
class GroupSlopes:
    """What the utilisation of one group answers to.

    Parameters
    ----------
    group : CableGroup
        The group.
    cable : int
        The most used of its cables there, from 1; 0 where nothing is solved.
    utilisation : float
        Of that cable.
    each : tuple of Sensitivity
        Payload, breaking load and efficiency of the group's own rope, ``modulus`` and
        ``linear_mass`` of the rope of each group (``modulus_`` and its name), region.
    exit_points_per_m : array (n_cables, 3)
        Slope in each exit point, base frame [1/m]; NaN where there is none.
    why_not : str
        Why there are no slopes, for the reader of a report; empty where there are.
    """

    group: CableGroup
    cable: int
    utilisation: float
    each: tuple[Sensitivity, ...]
    exit_points_per_m: FloatArray
    why_not: str = ""

    def of(self, name: str) -> Sensitivity:
        """Return one of them by its name."""
        return next(sensitivity for sensitivity in self.each if sensitivity.input == name)


def group_slopes(
    robot: Robot, workspace: Workspace | None, assignment: Assignment
) -> tuple[GroupSlopes, ...]:
    """Return the slopes of each group; none where no ropes for groups were found."""
    if workspace is None or not assignment.has_groups:
        return ()
    return tuple(_slopes(robot, workspace, assignment, g) for g in range(len(assignment.groups)))


def _slopes(robot: Robot, workspace: Workspace, assignment: Assignment, g: int) -> GroupSlopes:
    group, place = assignment.groups[g], assignment.verification.worst_place[g]
    cables = Cables(tuple(rope.cable for rope in assignment.by_cable))
    members = [np.array(group.cables) - 1 for group in assignment.groups]
    statics = solve_sagging(robot, Poses.at(place[None]), cables)
    used = statics.cable_tension_N[0] / cables.allowable_tension_N
    cable = int(members[g][used[members[g]].argmax()])
    slopes = utilisation_slopes(statics, cables.allowable_tension_N, cable + 1)
    no_slopes = np.full((robot.n_cables, 3), np.nan)
    if not slopes:
        why = (
            "Cables of other groups are used more there, or the internal forces that are best "
            "leave a choice, so that the utilisation has no slope."
        )
        unknown = np.full(len(members), np.nan)
        sensitivities = _named(assignment, g, (math.nan, math.nan), (unknown, unknown))
        return GroupSlopes(
            group, cable + 1, float(used[cable]), tuple(sensitivities), no_slopes, why
        )
    (slope,) = slopes
    body = robot.platform
    twice = replace(body, mass_kg=2.0 * body.mass_kg, wrench_N=2.0 * body.wrench_N)
    heavier = load_wrench_N(replace(robot, platform=twice), statics.poses)[0]
    payload = float(slope.load @ (heavier - load_wrench_N(robot, statics.poses)[0]))
    region = float(slope.position_per_m @ workspace.region.outward(place[:3]))
    mass = slope.cable_load_m_per_N @ -robot.upright[2] * cables.weight_N_per_m
    of_ropes = (_sums(slope.stiffness, members), _sums(mass, members))
    sensitivities = _named(assignment, g, (payload, region), of_ropes, float(used[cable]))
    exits = slope.exit_points_per_m
    return GroupSlopes(group, cable + 1, float(used[cable]), tuple(sensitivities), exits)


def _sums(of_cables: FloatArray, members: list[IntArray]) -> FloatArray:
    return np.array([of_cables[cables].sum() for cables in members])


def _named(
    assignment: Assignment,
    g: int,
    payload_and_region: tuple[float, float],
    of_ropes: tuple[FloatArray, FloatArray],
    used: float = math.nan,
) -> Iterator[Sensitivity]:
    """Yield slopes in logarithms, and in the region [1/m], by their names."""

    def relative(name: str, value: float, unit: str, slope: float) -> Sensitivity:
        return Sensitivity(name, value, unit, slope / value, slope / used)

    rope = assignment.ropes[g]
    yield relative("payload", 1.0, "", payload_and_region[0])
    yield relative("breaking_load", rope.size.minimum_breaking_load_N, "N", -used)
    yield relative("efficiency", rope.efficiency, "", -used)
    for k, (group, other_rope) in enumerate(zip(assignment.groups, assignment.ropes, strict=True)):
        stiffness, mass = (float(slopes[k]) for slopes in of_ropes)
        density = other_rope.cable.linear_density_kg_per_m
        yield relative(f"modulus_{group.name}", other_rope.cable.axial_stiffness_N, "N", stiffness)
        yield relative(f"linear_mass_{group.name}", density, "kg/m", mass)
    yield Sensitivity("region", 0.0, "m", payload_and_region[1], math.nan)
