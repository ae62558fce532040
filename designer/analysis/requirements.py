"""All that a study asks for, as one list: the answer, every page and every file follow from it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, cast

import numpy as np

from designer.analysis.findings import neighbours_utilisation
from designer.analysis.pose import PoseAnalysis
from designer.grades.grade import TRUST_MEANING
from designer.model.cable import Cable, Cables, Material
from designer.model.load_case import STATIC
from designer.model.robot import Robot
from designer.model.verdict import Answer, Requirement, State, Verdict
from designer.selection.assignment import Assignment, Qualities
from designer.selection.candidate import Candidate
from designer.selection.criteria import (
    CaseLoads,
    at_place,
    criteria_of,
    equilibrium_of,
    evaluate,
    extreme_lengths_m,
    rope_diameter_m,
)
from designer.selection.family import CaseNeed
from designer.selection.groups import GroupChoice
from designer.selection.reeving import drum_of, sheave_ratio_of, spooling_of
from designer.selection.result import SelectionResult
from designer.sizing.newton import size_poses
from designer.statics.free_motion import FreeMotion
from designer.study import Selection, Study
from designer.workspace.demand import tension_demand
from designer.workspace.sweep import WorkspaceMap

if TYPE_CHECKING:
    from designer.analysis.analyse import Analysis


@dataclass(frozen=True, slots=True)
class Condition:
    """What has to be certified of a rope before a yes stands, and why.

    ``neighbours`` are the sizes beside it in its table, ``by_neighbours`` what it is used to if it
    were as strong and as heavy as they are, over d²; NaN where there are none, and for groups.
    """

    what: str
    why: str
    neighbours: tuple[str, ...] = ()
    by_neighbours: float = math.nan

    @property
    def sentences(self) -> str:
        """Why, and what the neighbours say."""
        words = f"{self.why[:1].upper()}{self.why[1:]}."
        if not self.neighbours:
            return words
        beside = f"as strong and as heavy over d² as {' and '.join(self.neighbours)} beside it"
        excess = ", which is too much" if self.by_neighbours > 1.0 else ""
        return f"{words} Were it {beside}, it would be used to {self.by_neighbours:.1%}{excess}."


@dataclass(frozen=True, slots=True)
class Terms:
    """What an answer covers, what was not asked, and what a yes is subject to."""

    covers: str
    not_asked: tuple[str, ...]
    subject_to: tuple[Condition, ...] = ()

    def head(self, answer: Answer) -> str:
        """Return the answer in a line: what a yes is subject to, and what it covers."""
        if answer is not Answer.YES:
            return answer.value.capitalize()
        certificates = " and ".join(condition.what for condition in self.subject_to)
        subject = f", subject to {certificates}" if certificates else ""
        return f"Yes{subject}, for {self.covers}"

    def omissions(self, answer: Answer) -> str:
        """Return the sentence of what a yes does not cover; nothing for another answer."""
        if answer is not Answer.YES or not self.not_asked:
            return ""
        return f"Not asked: {', '.join(self.not_asked)}."


_FAMILY = "a cable of the configured family holds"


def requirements_of(analysis: Analysis) -> tuple[Requirement, ...]:
    """Return all that the study of an analysis asks for."""
    study, built = analysis.study, analysis.built
    pose, survey = analysis.pose, analysis.workspace
    assignment, needs, design = analysis.assignment, analysis.needs, analysis.qualities
    requirements: list[Requirement] = []
    if pose is not None:
        requirements.append(_pose(pose, analysis.free_motion))
    if needs:
        requirements += map(_need, needs)
    elif survey is not None:
        material = built.material(study.material)
        requirements.append(_workspace(built.robot, material, survey, analysis.free_motion))
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
        requirements += _of_design(analysis, design)
    return tuple(requirements)


def terms_of(analysis: Analysis) -> Terms:
    """Return what the answer covers and what it is subject to."""
    study, cases = analysis.study, analysis.study.load_cases
    moves = study.robot.platform.motion is not None
    covers = "one static case"
    if cases:
        covers = "one load case" if len(cases) == 1 else f"{len(cases)} load cases"
    elif moves or study.workspace is None:
        covers = "the motion along the path" if moves else "one pose at rest"
    subject_to = tuple(_conditions(analysis)) if analysis.answer is Answer.YES else ()
    return Terms(covers, tuple(_not_asked(study, moves)), subject_to)


def _not_asked(study: Study, moves: bool) -> Iterator[str]:
    """Yield which loads and losses of strength a study says nothing of."""
    cases, selection = study.load_cases, study.selection
    given = {entry.field for entry in study.source.entries if entry.given != "default"}
    loads = {
        "wind": any(case.wind is not None for case in cases),
        "dynamics": moves
        or any(case.dynamic_factor > 1.0 or case.acceleration_m_per_s2 for case in cases),
        "ice": any(case.ice is not None for case in cases),
        "loss of a cable": any(case.cable_lost for case in cases),
        "change of temperature": any(case.temperature_change_K for case in cases),
    }
    yield from (name for name, is_asked in loads.items() if not is_asked)
    if selection is None:
        return
    shares = {selection.termination_efficiency, *(case.termination_efficiency for case in cases)}
    if "selection.termination_efficiency" not in given and shares <= {None, 1.0}:
        yield "end fittings"
    if selection.sheave_diameter_m is None and study.robot.winches.reeving_efficiency == 1.0:
        yield "sheaves"


def _conditions(analysis: Analysis) -> Iterator[Condition]:
    """Yield what has to be certified of each rope that was chosen."""
    undecided = _undecided(analysis)
    for rope in analysis.assignment.products:
        grade, elasticity, doubt = rope.grade, rope.grade.elasticity, rope.size.doubt
        reasons = []
        if grade.trust == "C":
            reasons.append(f"its figures are of trust C, {TRUST_MEANING['C']}")
        if doubt:
            reasons.append(f"the catalogue doubts this size: {doubt}")
        if grade.maker is None:
            reasons.append(f"no maker is named, its table is of {grade.source.publisher}")
        certified = ["breaking load", "mass"] if reasons else []
        if undecided and elasticity.basis == "borrowed":
            within = f"borrowed, known to ±{elasticity.uncertainty:.0%}"
            titles = ", ".join(title.lower() for title in undecided)
            reasons.append(f"its modulus is {within}: at an end of that this fails: {titles}")
            certified.append("modulus")
        if reasons:
            alone = not analysis.assignment.has_groups
            beside, utilisation = neighbours_utilisation(rope) if alone else ([], math.nan)
            *first, last = certified
            figures = f"{', '.join(first)} and {last}" if first else last
            yield Condition(
                f"a certificate of {figures} of {rope.label}",
                "; ".join(reasons),
                tuple(size.id for size in beside),
                utilisation,
            )


def _undecided(analysis: Analysis) -> list[str]:
    """Return the titles of what fails at the ends of what is known of borrowed moduli.

    Each requirement where it comes nearest to failing.
    """
    study, assignment, design = analysis.study, analysis.assignment, analysis.qualities
    borrows = any(rope.grade.elasticity.basis == "borrowed" for rope in assignment.ropes)
    if not borrows or design is None:
        return []
    criteria = criteria_of(design.robot, design.workspace, study.selection)
    by_id, failing = {criterion.id: criterion for criterion in criteria}, {}
    for requirement in analysis.requirements:
        place, original = requirement.place, requirement.loaded
        if place is None or original is None:
            continue
        workspace = design.workspace.of_case(original.case)
        for sign in (-1.0, 1.0):
            loaded = replace(original, cable=_stretched(assignment, original.cable, sign))
            if requirement.id == "breaking_load":
                largest_N = tension_demand(loaded, "include", place[None])[0]
                fails = largest_N > loaded.cable.allowable_tension_N
            elif criterion := by_id.get(requirement.id):
                evaluated = at_place(criterion, loaded, workspace, place)
                fails = evaluated is not None and evaluated.state is State.FAILS
            else:
                continue
            if fails:
                failing[requirement.title] = True
    return [*failing]


def _stretched(assignment: Assignment, cable: Cable, sign: float) -> Cable:
    """Return a cable, or those of groups, at an end of what is known of a borrowed modulus."""

    def at_end(rope: Candidate, cable: Cable) -> Cable:
        elasticity = rope.grade.elasticity
        doubt = elasticity.uncertainty if elasticity.basis == "borrowed" else 0.0
        return replace(cable, axial_stiffness_N=(1.0 + sign * doubt) * cable.axial_stiffness_N)

    if isinstance(cable, Cables):
        ends = map(at_end, assignment.by_cable, cable.each)
        return cast(Cable, Cables(tuple(ends)))  # which has the same figures as arrays
    return at_end(assignment.ropes[0], cable)


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
    robot: Robot, material: Material, survey: WorkspaceMap, free: FreeMotion | None
) -> Requirement:
    state, remark, pose = State.HOLDS, "", survey.infeasible_pose
    if not survey.is_feasible:
        unserved = survey.workspace.not_served(survey.census.statuses)
        if not unserved and pose is not None:
            sizing = size_poses(robot, pose, material)
            unserved = [Verdict(int(sizing.statics.verdict))]
        state, remark = State.FAILS, "every pose is left out"
        if unserved:  # of these one that proves that a pose is not held
            worst = next((v for v in unserved if v.is_proved), unserved[0])
            state, remark = worst.state, worst.clause
        remark = remark if free is None else free.clause
    return Requirement(
        id="workspace",
        title="Configured family",
        formula=f"{_FAMILY} every pose of the workspace that counts",
        source="cable, workspace.region",
        state=state,
        load_case=STATIC.name,
        place=None if pose is None else pose.place,
        remark=remark,
    )


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


def _of_design(analysis: Analysis, design: Qualities) -> Iterator[Requirement]:
    """Yield what is required beside strength of groups of cables, or of the configured family."""
    selection, loads, drum = analysis.study.selection, analysis.loads, design.robot.winches.drum
    criteria = criteria_of(design.robot, design.workspace, selection)
    with analysis.reporter.task("requirements", len(loads)) as advance:
        for evaluation in evaluate(loads, criteria, advance):
            yield evaluation.requirement
    has_capacity = selection is not None and selection.limits.drum_capacity_m is not None
    if has_capacity or drum is not None:
        ends = [
            extreme_lengths_m(CaseLoads(of_case.workspace, (direction,)))
            for of_case in loads
            for direction in of_case.directions
        ]
        longest, shortest = zip(*ends, strict=True)
        lengths = np.fmax.reduce(longest), np.fmin.reduce(shortest)
        yield from drum_of(*lengths, selection)
        rope_m = np.broadcast_to(rope_diameter_m(design.cable.cable), lengths[0].shape)
        yield from spooling_of(drum, *lengths, rope_m.tolist())
