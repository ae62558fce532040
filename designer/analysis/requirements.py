"""All that a study asks for, as one list: the answer, every page and every file follow from it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, cast

import numpy as np

from designer.analysis.pose import PoseAnalysis
from designer.effects.design import AsBuilt
from designer.model.cable import Cable
from designer.model.load_case import STATIC, Loaded
from designer.model.requirement import Requirement, State
from designer.model.verdict import Verdict
from designer.progress import Reporter
from designer.selection.assignment import Assignment
from designer.selection.criteria import criteria_of, rope_diameter_m
from designer.selection.family_need import CaseNeed
from designer.selection.groups.result import GroupChoice
from designer.selection.qualities import DesignCable
from designer.selection.requirements import (
    CaseLoads,
    drum_of,
    equilibrium_of,
    evaluate,
    extreme_lengths_m,
    sheave_ratio_of,
)
from designer.selection.result import SelectionResult
from designer.selection.spooling import spooling_of
from designer.sizing.newton import size_poses
from designer.statics.free_motion import FreeMotion
from designer.study import Selection, Study
from designer.workspace.result import WorkspaceMap

if TYPE_CHECKING:
    from designer.analysis.analyse import Analysis

_FAMILY = "a cable of the configured family holds"


def requirements_of(analysis: Analysis) -> tuple[Requirement, ...]:
    """Return all that the study of an analysis asks for."""
    study, built = analysis.study, analysis.built
    pose, workspace = analysis.pose, analysis.workspace
    assignment, needs = analysis.assignment, analysis.needs
    design = None if analysis.qualities is None else analysis.qualities.cable
    requirements: list[Requirement] = []
    if pose is not None:
        requirements.append(_pose(pose, analysis.free_motion))
    if needs:
        requirements += map(_need, needs)
    elif workspace is not None:
        requirements.append(_workspace(study, built, workspace, analysis.free_motion))
    if assignment.rope is not None:
        requirements += assignment.rope.requirements
    elif study.selection is not None and assignment.has_groups:
        requirements += _of_groups(study.selection, assignment)
    elif analysis.groups is not None:
        requirements.append(_no_ropes(analysis.groups))
    elif analysis.selection is not None:
        requirements.append(_no_rope(analysis.selection))
    # A rope for all cables brings its own; where there is none, the design is one of the family.
    if design is not None and (study.selection is None or assignment.has_groups):
        requirements += _of_design(study, built, design, analysis.reporter)
    return tuple(requirements)


def _pose(pose: PoseAnalysis, free: FreeMotion | None) -> Requirement:
    statics = pose.sizing.statics
    verdict = Verdict(int(statics.verdict))
    return Requirement(
        id="pose",
        title="Configured pose",
        formula=f"{_FAMILY} the configured pose",
        source="pose",
        state=verdict.state,
        load_case=STATIC.name,
        place=statics.poses.place,
        remark="" if statics.is_solved else verdict.clause if free is None else free.clause,
    )


def _workspace(
    study: Study, built: AsBuilt, workspace: WorkspaceMap, free: FreeMotion | None
) -> Requirement:
    state, remark, place = State.HOLDS, "", None
    if not workspace.is_feasible:
        state, remark = _why_not_feasible(study, built, workspace)
        remark = remark if free is None else free.clause
        place = None if workspace.infeasible_pose is None else workspace.infeasible_pose.place
    return Requirement(
        id="workspace",
        title="Configured family",
        formula=f"{_FAMILY} every pose of the workspace that counts",
        source="cable, workspace.region",
        state=state,
        load_case=STATIC.name,
        place=place,
        remark=remark,
    )


def _why_not_feasible(study: Study, built: AsBuilt, workspace: WorkspaceMap) -> tuple[State, str]:
    """Return whether it is proved that a pose is not held, and what is known of it."""
    assert study.workspace is not None
    unserved = study.workspace.not_served(workspace.census.statuses)
    if not unserved:
        if workspace.infeasible_pose is None:
            return State.FAILS, "every pose is left out"
        sizing = size_poses(built.robot, workspace.infeasible_pose, built.material(study.material))
        unserved = [Verdict(int(sizing.statics.verdict))]
    worst = next((v for v in unserved if v.is_proved), unserved[0])
    return worst.state, worst.clause


def _need(need: CaseNeed) -> Requirement:
    case = need.governing
    state, remark = State.HOLDS, ""
    if not need.is_held:
        equilibrium = equilibrium_of(case)
        # A cable that is in balance there and too weak, at every diameter that was tried.
        state = State.FAILS if equilibrium.holds else equilibrium.state
        remark = equilibrium.remark or "no diameter of the configured family is strong enough there"
    return Requirement(
        id="workspace",
        title="Configured family",
        formula=f"{_FAMILY} every pose that counts in the load case",
        source="cable, load_cases",
        state=state,
        load_case=case.case.name,
        cable=case.most_used if need.is_held else None,
        place=case.verification.worst_place,
        loaded=case.loaded,
        remark=remark,
    )


def _no_rope(selection: SelectionResult) -> Requirement:
    """Return that no rope was found: it fails where one is in balance and too weak everywhere."""
    nearest = min(
        (c for c in selection.candidates),
        key=lambda c: (-len(c.cases), c.verification.utilisation),
        default=None,
    )
    state = State.FAILS
    if nearest is not None and not math.isfinite(nearest.verification.utilisation):
        state = equilibrium_of(nearest.governing).state
    return Requirement(
        id="rope",
        title="Rope",
        formula="a rope of the allowed grades holds every pose that counts in every load case",
        source="selection.grades, selection.safety_factor",
        state=state,
        load_case="all",
        remark=selection.reason or "",
    )


def _no_ropes(groups: GroupChoice) -> Requirement:
    """Return that no ropes for the groups were found."""
    return Requirement(
        id="rope",
        title="Rope",
        formula="ropes of the allowed grades for the groups hold every pose that counts",
        source="selection.groups, selection.grades, selection.safety_factor",
        state=State.FAILS if groups.proof == "infeasible" else State.OPEN,
        load_case="all",
        remark=groups.proof_sentence,
    )


def _of_groups(selection: Selection, assignment: Assignment) -> Iterator[Requirement]:
    """Yield what groups of cables are used to."""
    verification = assignment.verification
    for group, rope, used, place in zip(
        assignment.groups,
        assignment.ropes,
        verification.utilisation,
        verification.worst_place,
        strict=True,
    ):
        allowable_N = rope.cable.allowable_tension_N
        yield Requirement(
            id="breaking_load",
            title=f"Breaking load, {group.name}",
            formula=f"T ≤ η F / S; S = {selection.safety_factor:g}",
            source=f"Noble Denton 0027/ND, 7.6 to 7.8; {selection.factor_source}",
            state=State.HOLDS if used <= 1.0 else State.FAILS,
            load_case=STATIC.name,
            demand=float(used) * allowable_N,
            capacity=allowable_N,
            unit="N",
            utilisation=float(used),
            place=place,
        )
        yield from sheave_ratio_of(rope.grade, rope.size, selection)


def _of_design(
    study: Study, built: AsBuilt, design: DesignCable, reporter: Reporter
) -> Iterator[Requirement]:
    """Yield what is asked beside strength of groups of cables, or of the configured family."""
    workspace = study.workspace
    assert workspace is not None
    criteria = criteria_of(built.robot, workspace, study.selection)
    loads = design_loads(study, built, design)
    with reporter.task("requirements", len(loads)) as advance:
        for evaluation in evaluate(loads, criteria, advance):
            yield evaluation.requirement
    has_capacity = (
        study.selection is not None and study.selection.limits.drum_capacity_m is not None
    )
    drum = built.robot.winches.drum
    if has_capacity or drum is not None:
        each = [
            extreme_lengths_m(CaseLoads(of_case.workspace, (direction,)))
            for of_case in loads
            for direction in of_case.directions
        ]
        longest, shortest = zip(*each, strict=True)
        lengths = np.fmax.reduce(longest), np.fmin.reduce(shortest)
        yield from drum_of(*lengths, study.selection)
        rope_m = np.broadcast_to(rope_diameter_m(design.cable), lengths[0].shape)
        yield from spooling_of(drum, *lengths, rope_m.tolist())


def design_loads(study: Study, built: AsBuilt, design: DesignCable) -> list[CaseLoads]:
    """Return the load cases with the cables of the design, each in all its directions."""
    workspace, robot = study.workspace, built.robot
    assert workspace is not None
    cable = cast(Cable, design.cable)  # or `Cables`, which have the same figures as arrays
    if not study.load_cases:
        return [CaseLoads(workspace, (Loaded(STATIC, (robot, cable), robot, cable),))]
    return [
        CaseLoads(workspace.of_case(case), tuple(case.on(robot, cable)))
        for case in study.load_cases
    ]
