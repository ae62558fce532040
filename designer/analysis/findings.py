"""What a reviewer asks next: a few small extra solves about the answer.

What would ignoring sag have led to? How much does the doubt about the rope's modulus matter? How
near is the chosen rope to the boundary of what any section can hold? What changes if poses with a
cable below the platform count, or not? How wide is the strip that cannot be served?

Which load cases carry the platform away: do straight cables hold it at rest, and not in the case?
A sagging rope may still hold such a pose, by hanging far below as a counterweight; its length then
says nothing about a design.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from statistics import mean
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from designer.arrays import BoolArray, FloatArray
from designer.grades.grade import Size
from designer.model.cable import Cable
from designer.model.load_case import LoadCase, Loaded
from designer.model.robot import Platform, Poses, Robot
from designer.model.space import named_place
from designer.model.workspace import HangsBelow, Workspace
from designer.selection.candidate import Candidate
from designer.selection.result import GradeOutcome
from designer.selection.verify import Verification, verify
from designer.sizing.newton import limit_ratio, size_poses
from designer.statics.free_motion import FreeMotion
from designer.statics.inverse import solve_massless, solve_sagging
from designer.statics.sizes import has_fast_solver
from designer.workspace.demand import is_left_out
from designer.workspace.effort import (
    EQUILIBRIUM,
    EQUILIBRIUM_REDUNDANT,
    HANGING,
    SLOW_HANGING,
    slow_positions,
)
from designer.workspace.sweep import WorkspaceMap, map_workspace, open_sweep

if TYPE_CHECKING:
    from designer.analysis.analyse import Analysis


_CHUNK = 2**18
_THIN_M = 1e-3
_STEPS = np.array([0.1, 0.2, 0.3, 0.5, 0.75, 1.0])  # of the way to the middle
_BELOW = 0.25  # of the robot's size: how far below the exit points cables hold a platform easily
_RISES, _FACTORS = (0.02, 0.05, 0.1, 0.2, 0.5), (1.1, 1.25, 1.5, 2.0, 4.0)


def _named_worst(survey: WorkspaceMap) -> dict[str, Any]:
    worst, samples = survey.sagging, survey.census.samples
    return {
        "samples": samples,
        "feasible": survey.is_feasible,
        "diameter_m": worst and worst.diameter_m,
        "max_tension_N": worst and worst.max_tension_N,
        "pose": worst and worst.position_m,
    }


@dataclass(frozen=True, slots=True, eq=False)
class MasslessChoice:
    """The size of the chosen grade that a design without sag would have picked."""

    #: the thinnest whose allowable tension covers the massless one
    candidate: Candidate = field(metadata={"json": lambda rope: rope.ids})
    verification: Verification = field(  #: with its weight, in the workspace
        metadata={
            "json": lambda v: {"max_tension_N": v.max_tension_N, "utilisation": v.utilisation}
        }
    )

    also_in_files: ClassVar = ("safety_factor",)

    @property
    def size(self) -> Size:
        """The size."""
        return self.candidate.size

    @property
    def safety_factor(self) -> float:
        """What is left of its breaking load over the largest tension that it really meets."""
        strength_N = self.candidate.efficiency * self.size.minimum_breaking_load_N
        return strength_N / self.verification.max_tension_N


@dataclass(frozen=True, slots=True, eq=False)
class OtherPolicy:
    """The workspace with the opposite setting of ``hangs_below``, and what that leads to.

    From at most 20 000 samples and the search between them.
    """

    hangs_below: HangsBelow = field(metadata={"json": "policy"})
    map: WorkspaceMap = field(metadata={"json": _named_worst})


@dataclass(frozen=True, slots=True)
class Unserved:
    """Where the samples lie that no cable of the configured family can serve."""

    depth_m: float  #: largest distance of any of them from the sides of the region [m]
    inradius_m: float  #: largest distance of any sample from the sides [m]
    lowest_z_m: float  #: smallest z of any of them [m]


@dataclass(frozen=True, slots=True, eq=False)
class Remedies:
    """What was tried on a pose that the configured family does not hold, and holds it."""

    #: (3,) the nearest one that is held, of some toward the middle below the exit points [m]
    position_m: FloatArray | None
    raised_m: float | None  #: by how much the exit points above the pose are raised for it [m]
    stronger: float | None  #: how many times as strong the cable is for its weight


def _named_loads(loaded: Loaded) -> dict[str, Any]:
    directions = {"wind_direction": loaded.wind, "inertia_direction": loaded.inertia}
    return {"load_case": loaded.case.name, **directions, "wrench_N": loaded.wrench_N}


@dataclass(frozen=True, slots=True, eq=False)
class EquilibriumLoss:
    """A load case in which straight cables do not hold the platform everywhere."""

    #: in the direction of wind and inertia in which that is so most often
    loaded: Loaded = field(metadata={"json": _named_loads})
    share: float  #: of the poses that straight cables hold at rest
    #: (n_coordinates,) one of them [m, rad]
    place: FloatArray = field(metadata={"json": named_place})
    #: force on the platform beside its weight and what acts on it at rest [N]
    push_N: float = field(metadata={"json": "force_N"})


@dataclass(frozen=True, slots=True, eq=False)
class Findings:
    """Answers to the questions of this module; None where a question does not arise."""

    #: the grade of the chosen product
    chosen_outcome: GradeOutcome | None = field(default=None, metadata={"json": None})
    #: stress at infinite section over allowable stress, in that grade's family, at the worst pose
    #: of the chosen product
    chosen_limit_ratio: float | None = None
    #: None also where the grade has no size thick enough for the massless tension
    massless_choice: MasslessChoice | None = field(
        default=None, metadata={"json": "without_cable_weight"}
    )
    #: utilisation at the worst pose with the lowest and the highest modulus that is possible
    modulus_utilisation: tuple[float, float] | None = None
    #: None where no cable hangs below the platform
    other_policy: OtherPolicy | None = field(default=None, metadata={"json": "other_hangs_below"})
    #: share of the samples in which a cable hangs below the platform: with the chosen rope, or
    #: those of groups, where there is one, else with what the configured family needs. None without
    #: a workspace.
    hanging: float | None = field(default=None, metadata={"json": "hanging_share"})
    #: None where every sample is served, or none is, and for a list of points
    unserved: Unserved | None = None
    #: load cases in which straight cables do not hold all that they hold at rest
    equilibrium_losses: tuple[EquilibriumLoss, ...] = field(
        default=(), metadata={"json": "not_in_equilibrium"}
    )
    #: a motion of the platform that no cable resists in any pose
    free_motion: FreeMotion | None = None
    #: of the configured pose if that is not held, else of one of the workspace; None where all are
    remedies: Remedies | None = None


def find(analysis: Analysis) -> Findings:
    """Answer the questions of this module."""
    findings = Findings(free_motion=analysis.free_motion, remedies=_remedies(analysis))
    study, built, survey = analysis.study, analysis.built, analysis.workspace
    if survey is None:
        return findings
    # Straight cables are of any thickness.
    thin = built.material(study.material).cable(_THIN_M)
    losses = equilibrium_losses(built.robot, survey.workspace, study.load_cases, thin)
    findings = replace(
        findings,
        other_policy=_other_policy(analysis, survey),
        hanging=_hanging(analysis, survey),
        unserved=_unserved(survey),
        equilibrium_losses=tuple(losses),
    )
    chosen = analysis.chosen
    if chosen is None or analysis.selection is None:
        return findings
    outcome = next(o for o in analysis.selection.outcomes if o.best is chosen)
    worst = Poses.at(chosen.verification.worst_place)
    return replace(
        findings,
        chosen_outcome=outcome,
        chosen_limit_ratio=float(limit_ratio(built.robot, worst, outcome.family)),
        massless_choice=_massless_choice(analysis, survey, outcome),
        modulus_utilisation=modulus_utilisation(chosen),
    )


def equilibrium_losses(
    robot: Robot, workspace: Workspace, cases: Sequence[LoadCase], cable: Cable
) -> Iterator[EquilibriumLoss]:
    """Yield the load cases in which straight cables hold fewer poses than at rest."""
    samples = EQUILIBRIUM_REDUNDANT if robot.is_redundant else EQUILIBRIUM

    def holds(robot: Robot, places: FloatArray) -> BoolArray:
        return np.isfinite(solve_massless(robot, Poses.at(places)).largest_tension_N)

    def force_N(body: Platform) -> FloatArray:
        return body.wrench_N[:3] + body.centre_force_N + body.drag_force_N

    for case in cases:
        is_still = case.wind is None and case.acceleration_m_per_s2 == 0.0
        if is_still and case.wrench_set is None:
            continue
        space = workspace.of_case(case)
        places = np.concatenate([space.space.landmarks(), space.thinned(samples)])
        places = places[holds(robot, places)]
        losses = []
        for loaded in replace(case, cable_lost=None).on(robot, cable):
            is_held = holds(loaded.robot, places)
            example = places[int(is_held.argmin())] if len(places) else np.full(3, np.nan)
            share = float((~is_held).mean()) if len(places) else 0.0
            push = force_N(loaded.robot.platform) - force_N(robot.platform)
            losses.append(EquilibriumLoss(loaded, share, example, float(np.linalg.norm(push))))
        worst = max(losses, key=lambda loss: loss.share)
        if worst.share > 0.0:
            yield worst


def modulus_utilisation(candidate: Candidate) -> tuple[float, float]:
    """Return the utilisation at the worst pose with the lowest and the highest modulus."""
    governing, doubt = candidate.governing, candidate.grade.elasticity.uncertainty
    loaded, cable = governing.loaded, governing.loaded.cable

    def at(scale: float) -> float:
        stretched = replace(cable, axial_stiffness_N=scale * cable.axial_stiffness_N)
        return governing.tension_N(replace(loaded, cable=stretched)) / cable.allowable_tension_N

    return at(1.0 - doubt), at(1.0 + doubt)


def neighbours_utilisation(candidate: Candidate) -> tuple[list[Size], float]:
    """Return the sizes next to one in its table, and its utilisation if it were as they are.

    With their breaking load and mass over d², at its worst pose. A size that the catalogue doubts
    is no neighbour.
    """
    size, governing, sizes = candidate.size, candidate.governing, candidate.grade.sizes
    thinner = [s for s in sizes if s.diameter_m < size.diameter_m and not s.doubt][-1:]
    neighbours = thinner + [s for s in sizes if s.diameter_m > size.diameter_m and not s.doubt][:1]
    if not neighbours:
        return [], math.nan
    strength = mean(s.breaking_stress_Pa for s in neighbours) / size.breaking_stress_Pa
    mass = mean(s.density_kg_per_m3 for s in neighbours) / size.density_kg_per_m3
    robot, cable = governing.loaded.bare
    allowable_N = strength * cable.allowable_tension_N
    similar = replace(cable.with_rope_scaled(mass), allowable_tension_N=allowable_N)
    loaded = governing.loaded.on(robot, similar)
    return neighbours, governing.tension_N(loaded) / loaded.cable.allowable_tension_N


def _massless_choice(
    analysis: Analysis, survey: WorkspaceMap, outcome: GradeOutcome
) -> MasslessChoice | None:
    if survey.massless is None:
        return None
    if analysis.study.load_cases or analysis.assignment.has_groups:
        return None
    needed_N = survey.massless.max_tension_N
    for candidate in outcome.candidates:
        if candidate.cable.allowable_tension_N >= needed_N:
            verification = candidate.verification
            if not verification.is_refined:
                verification = verify(analysis.built.robot, survey.workspace, candidate.cable)
            return MasslessChoice(candidate, verification)
    return None


def _other_policy(analysis: Analysis, survey: WorkspaceMap) -> OtherPolicy | None:
    if survey.census.hangs_below == 0:
        return None
    built, workspace = analysis.built, survey.workspace
    policy: HangsBelow = "exclude" if workspace.hangs_below == "include" else "include"
    changed = replace(_with_fewer_samples(built.robot, workspace), hangs_below=policy)
    material = built.material(analysis.study.material)
    return OtherPolicy(policy, map_workspace(built.robot, changed, material, with_massless=False))


def _hanging(analysis: Analysis, survey: WorkspaceMap) -> float:
    if not analysis.assignment.is_found:
        return survey.census.hangs_below / survey.census.samples
    robot, cable = analysis.built.robot, analysis.assignment.cable
    hangs = [
        is_left_out(solve_sagging(robot, Poses.at(positions), cable), "exclude")
        for positions in _with_fewer_samples(robot, survey.workspace).places()
    ]
    return float(np.concatenate(hangs).mean())


def _with_fewer_samples(robot: Robot, workspace: Workspace) -> Workspace:
    is_fast = has_fast_solver(robot)
    largest = HANGING if is_fast else slow_positions(workspace, SLOW_HANGING)
    return replace(workspace, samples=min(workspace.samples, largest))


def _remedies(analysis: Analysis) -> Remedies | None:
    pose, survey, study = analysis.pose, analysis.workspace, analysis.study
    place = None if survey is None else survey.infeasible_pose
    if pose is not None and not pose.sizing.statics.is_solved:
        place = study.pose
    if place is None or analysis.free_motion is not None:
        return None
    built, at = analysis.built, place.flat
    robot, family = built.robot, built.material(study.material)

    def holds(robot: Robot, poses: Poses = at, strength: float = 1.0) -> BoolArray:
        material = replace(family, allowable_stress_Pa=strength * family.allowable_stress_Pa)
        return np.atleast_1d(size_poses(robot, poses, material).statics.is_solved)

    up = -robot.gravity_direction / np.linalg.norm(robot.gravity_direction)
    from_here_m = robot.exit_points_m - at.position_m[0]
    heights_m, middle_m = from_here_m @ up, from_here_m.mean(axis=0)
    size_m = float(np.ptp(robot.exit_points_m, axis=0).max())
    level_m = middle_m - (middle_m @ up) * up
    down_m = min(0.0, float(heights_m.max()) - _BELOW * size_m) * up
    moves_m = (_STEPS[:, None, None] * [level_m, level_m + down_m]).reshape(-1, 3)
    rotations = np.broadcast_to(at.rotations[0], (len(moves_m), 3, 3))
    moved = Poses(at.position_m[0] + moves_m, rotations)
    is_held = holds(robot, moved)
    rise = size_m * np.outer(heights_m > 0.0, up)
    higher = [replace(robot, exit_points_m=robot.exit_points_m + share * rise) for share in _RISES]
    raised = [k for k, with_rise in enumerate(higher) if rise.any() and holds(with_rise)]
    return Remedies(
        moved.position_m[is_held.argmax()] if is_held.any() else None,
        size_m * _RISES[raised[0]] if raised else None,
        next((factor for factor in _FACTORS if holds(robot, strength=factor)), None),
    )


def _unserved(survey: WorkspaceMap) -> Unserved | None:
    if survey.file is None or survey.is_feasible or survey.sampled is None:
        return None
    depth_m = inradius_m = 0.0
    lowest_m = np.inf
    with open_sweep(survey.file) as sweep:
        for start in range(0, sweep.sizes["sample"], _CHUNK):
            part = sweep.isel(sample=slice(start, start + _CHUNK))
            position = part["position"].values
            distance = survey.workspace.region.depth_m(position)
            if distance is None:
                return None
            unserved = ~np.isin(part["verdict"].values, survey.workspace.served)
            depth_m = max(depth_m, float(distance[unserved].max(initial=0.0)))
            inradius_m = max(inradius_m, float(distance.max(initial=0.0)))
            lowest_m = min(lowest_m, float(position[unserved, 2].min(initial=np.inf)))
    return Unserved(depth_m, inradius_m, lowest_m) if np.isfinite(lowest_m) else None
