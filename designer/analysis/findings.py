"""What a reviewer asks next: a few small extra solves about the answer.

What would ignoring sag have led to? How much does the doubt about the rope's modulus matter? How
near is the chosen rope to the boundary of what any section can hold? What changes if poses with a
cable below the platform count, or not? How wide is the strip that cannot be served?
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from statistics import mean
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from designer.analysis.adrift import Adrift, adrift_in
from designer.arrays import BoolArray, FloatArray
from designer.grades.grade import Size
from designer.model.robot import Poses, Robot
from designer.model.workspace import HangsBelow, Workspace
from designer.selection.candidate import Candidate
from designer.selection.result import GradeOutcome
from designer.selection.verify import Verification, verify
from designer.sizing.newton import limit_ratio, size_poses
from designer.statics.free_motion import FreeMotion
from designer.statics.inverse import solve_sagging
from designer.statics.sizes import has_fast_solver
from designer.workspace.demand import is_left_out
from designer.workspace.sweep import WorkspaceMap, map_workspace, open_sweep

if TYPE_CHECKING:
    from designer.analysis.analyse import Analysis

_MOST_SAMPLES = 20_000
_FEW_PLACES, _FEW_POSITIONS = 2000, 100  # of robots that are slow to solve
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
    """The size of the chosen grade that a design without sag would have picked.

    It is the thinnest whose allowable tension covers the massless one; ``verification`` tells what
    it really meets in the workspace.
    """

    candidate: Candidate = field(metadata={"json": lambda rope: rope.ids})
    verification: Verification = field(
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
    """Where the samples lie that no cable of the configured family can serve.

    Parameters
    ----------
    depth_m : float
        Largest distance of any of them from the sides of the region [m].
    inradius_m : float
        Largest distance of any sample from the sides [m].
    lowest_z_m : float
        Smallest z of any of them [m].
    """

    depth_m: float
    inradius_m: float
    lowest_z_m: float


@dataclass(frozen=True, slots=True, eq=False)
class Remedies:
    """What was tried on a pose that the configured family does not hold, and holds it.

    Parameters
    ----------
    position_m : array (3,) or None
        The nearest one that is held, of some toward the middle below the exit points [m].
    raised_m : float or None
        By how much the exit points above the pose are raised for it [m].
    stronger : float or None
        How many times as strong the cable is for its weight.
    """

    position_m: FloatArray | None
    raised_m: float | None
    stronger: float | None


@dataclass(frozen=True, slots=True, eq=False)
class Findings:
    """Answers to the questions of this module; None where a question does not arise.

    Parameters
    ----------
    chosen_outcome : GradeOutcome or None
        The grade of the chosen product.
    chosen_limit_ratio : float or None
        Stress at infinite section over allowable stress, in that grade's family, at the worst
        pose of the chosen product.
    massless_choice : MasslessChoice or None
        None also where the grade has no size thick enough for the massless tension.
    modulus_utilisation : tuple of float or None
        Utilisation at the worst pose with the lowest and the highest modulus that is possible.
    other_policy : OtherPolicy or None
        None where no cable hangs below the platform.
    hanging : float or None
        Share of the samples in which a cable hangs below the platform: with the chosen rope, or
        those of groups, where there is one, else with what the configured family needs. None
        without a workspace.
    unserved : Unserved or None
        None where every sample is served, or none is, and for a list of points.
    adrift : tuple of Adrift
        Load cases that carry the platform away somewhere.
    free_motion : FreeMotion or None
        A motion of the platform that no cable resists in any pose.
    remedies : Remedies or None
        Of the configured pose if that is not held, else of one of the workspace; None where all
        are.
    """

    chosen_outcome: GradeOutcome | None = field(default=None, metadata={"json": None})
    chosen_limit_ratio: float | None = None
    massless_choice: MasslessChoice | None = field(
        default=None, metadata={"json": "without_cable_weight"}
    )
    modulus_utilisation: tuple[float, float] | None = None
    other_policy: OtherPolicy | None = field(default=None, metadata={"json": "other_hangs_below"})
    hanging: float | None = field(default=None, metadata={"json": "hanging_share"})
    unserved: Unserved | None = None
    adrift: tuple[Adrift, ...] = field(default=(), metadata={"json": "not_in_equilibrium"})
    free_motion: FreeMotion | None = None
    remedies: Remedies | None = None


def find(analysis: Analysis) -> Findings:
    """Answer the questions of this module."""
    findings = Findings(
        other_policy=_other_policy(analysis),
        hanging=_hanging(analysis),
        unserved=_unserved(analysis),
        adrift=_adrift(analysis),
        free_motion=analysis.free_motion,
        remedies=_remedies(analysis),
    )
    chosen = analysis.chosen
    if chosen is None or analysis.selection is None:
        return findings
    outcome = next(o for o in analysis.selection.outcomes if o.best is chosen)
    robot = analysis.built.robot
    worst = Poses.at(chosen.verification.worst_place)
    return replace(
        findings,
        chosen_outcome=outcome,
        chosen_limit_ratio=float(limit_ratio(robot, worst, outcome.family)),
        massless_choice=_massless_choice(analysis, outcome),
        modulus_utilisation=modulus_utilisation(chosen),
    )


def _adrift(analysis: Analysis) -> tuple[Adrift, ...]:
    study, built = analysis.study, analysis.built
    if study.workspace is None:
        return ()
    thin = built.material(study.material).cable(_THIN_M)  # straight cables are of any thickness
    return tuple(adrift_in(built.robot, study.workspace, study.load_cases, thin))


def modulus_utilisation(candidate: Candidate) -> tuple[float, float]:
    """Return the utilisation at the worst pose with the lowest and the highest modulus."""
    governing, doubt = candidate.governing, candidate.grade.elasticity.uncertainty
    loaded, cable = governing.loaded, governing.loaded.cable

    def at(scale: float) -> float:
        stretched = replace(cable, axial_stiffness_N=scale * cable.axial_stiffness_N)
        return governing.tension_N(replace(loaded, cable=stretched)) / cable.allowable_tension_N

    return at(1.0 - doubt), at(1.0 + doubt)


def neighbours_utilisation(candidate: Candidate) -> tuple[list[Size], float]:
    """Return the sizes beside one in its table, and what it is used to if it were as they are.

    With their breaking load and mass over d², at its worst pose. A size that the catalogue doubts
    is no neighbour.
    """
    size, governing, sizes = candidate.size, candidate.governing, candidate.grade.sizes
    thinner = [s for s in sizes if s.diameter_m < size.diameter_m and not s.doubt][-1:]
    beside = thinner + [s for s in sizes if s.diameter_m > size.diameter_m and not s.doubt][:1]
    if not beside:
        return [], math.nan
    strength = mean(s.breaking_stress_Pa for s in beside) / size.breaking_stress_Pa
    mass = mean(s.density_kg_per_m3 for s in beside) / size.density_kg_per_m3
    robot, cable = governing.loaded.bare
    allowable_N = strength * cable.allowable_tension_N
    alike = replace(cable.with_rope_scaled(mass), allowable_tension_N=allowable_N)
    loaded = governing.loaded.on(robot, alike)
    return beside, governing.tension_N(loaded) / loaded.cable.allowable_tension_N


def _massless_choice(analysis: Analysis, outcome: GradeOutcome) -> MasslessChoice | None:
    workspace, survey = analysis.study.workspace, analysis.workspace
    if workspace is None or survey is None or survey.massless is None:
        return None
    if analysis.study.load_cases or analysis.assignment.has_groups:
        return None
    needed_N = survey.massless.max_tension_N
    for candidate in outcome.candidates:
        if candidate.cable.allowable_tension_N >= needed_N:
            proved = candidate.verification
            if not proved.is_refined:
                proved = verify(analysis.built.robot, workspace, candidate.cable)
            return MasslessChoice(candidate, proved)
    return None


def _other_policy(analysis: Analysis) -> OtherPolicy | None:
    workspace, survey, built = analysis.study.workspace, analysis.workspace, analysis.built
    if workspace is None or survey is None or survey.census.hangs_below == 0:
        return None
    policy: HangsBelow = "exclude" if workspace.hangs_below == "include" else "include"
    changed = replace(_few(built.robot, workspace), hangs_below=policy)
    material = built.material(analysis.study.material)
    return OtherPolicy(policy, map_workspace(built.robot, changed, material, with_massless=False))


def _hanging(analysis: Analysis) -> float | None:
    workspace, survey = analysis.study.workspace, analysis.workspace
    if workspace is None or survey is None:
        return None
    if analysis.qualities is None or not analysis.assignment.is_found:
        return survey.census.hangs_below / survey.census.samples
    robot, cable = analysis.built.robot, analysis.qualities.cable.cable
    hangs = [
        is_left_out(solve_sagging(robot, Poses.at(positions), cable), "exclude")
        for positions in _few(robot, workspace).places()
    ]
    return float(np.concatenate(hangs).mean())


def _few(robot: Robot, workspace: Workspace) -> Workspace:
    """Return the same with fewer positions where each pose takes long."""
    if has_fast_solver(robot):
        largest = _MOST_SAMPLES
    else:
        largest = max(_FEW_PLACES // workspace.orientations.count, _FEW_POSITIONS)
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


def _unserved(analysis: Analysis) -> Unserved | None:
    workspace, survey = analysis.study.workspace, analysis.workspace
    if workspace is None or survey is None or analysis.sweep_file is None:
        return None
    region = workspace.region
    if survey.is_feasible or survey.sampled is None:
        return None
    depth_m = inradius_m = 0.0
    lowest_m = np.inf
    with open_sweep(analysis.sweep_file) as sweep:
        for start in range(0, sweep.sizes["sample"], _CHUNK):
            part = sweep.isel(sample=slice(start, start + _CHUNK))
            position = part["position"].values
            distance = region.depth_m(position)
            if distance is None:
                return None
            unserved = ~np.isin(part["verdict"].values, workspace.served)
            depth_m = max(depth_m, float(distance[unserved].max(initial=0.0)))
            inradius_m = max(inradius_m, float(distance.max(initial=0.0)))
            lowest_m = min(lowest_m, float(position[unserved, 2].min(initial=np.inf)))
    return Unserved(depth_m, inradius_m, lowest_m) if np.isfinite(lowest_m) else None
