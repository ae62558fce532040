"""The first page: the numbers of the answer, what it rests on, and what to do where it is no."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from designer.analysis.analyse import Analysis
from designer.analysis.findings import Findings, Unserved
from designer.effects.effect import Effect
from designer.effects.registry import SHIPPED
from designer.grades.grade import TRUST_MEANING, Grade, Size
from designer.model.robot import SAG_AT_MOST
from designer.model.verdict import Requirement, State, Verdict
from designer.report import format as fmt
from designer.report.phrases import orientation_words
from designer.selection.candidate import MEANINGS, Candidate
from designer.selection.reeving import Allowance
from designer.statics.task import LONG
from designer.study import Study, rope_effects

Context = Mapping[str, object]

_TIGHT = 0.97
"""A utilisation beyond which there is hardly any reserve."""
_MOST_NAMES = 4
"""As many grades as a piece of advice names."""
_STRIP = 0.5  # of the inradius: what reaches deeper is no strip along the sides
_LAYER = 0.1  # of the height: what reaches lower is no layer at the top


@dataclass(frozen=True, slots=True)
class Unmet:
    """A requirement that does not hold in the load cases ``cases``, for sentences about it."""

    cases: tuple[Requirement, ...]

    @property
    def requirement(self) -> Requirement:
        """That of the load case where it is furthest from holding."""
        return max(self.cases, key=lambda case: float(np.nan_to_num(case.utilisation)))

    @property
    def title(self) -> str:
        """What is required."""
        return self.cases[0].title

    @property
    def state_words(self) -> str:
        """Whether it fails, or is open."""
        is_open = self.cases[0].state is State.OPEN
        return "is not known to hold" if is_open else "does not hold"

    @property
    def tone(self) -> str:
        """The colour of a statement about it."""
        return "doubt" if self.cases[0].state is State.OPEN else "bad"

    @property
    def load_cases(self) -> list[str]:
        """The load cases, quoted; none where there is none but the static load."""
        from designer.model.load_case import STATIC

        names = dict.fromkeys(f"'{case.load_case}'" for case in self.cases)
        return [] if names.keys() <= {"'all'", f"'{STATIC.name}'"} else [*names]

    @property
    def other_load_cases(self) -> list[str]:
        """All but that of `requirement`, quoted."""
        names = dict.fromkeys(f"'{case.load_case}'" for case in self.cases)
        return [name for name in names if name != f"'{self.requirement.load_case}'"]


@dataclass(frozen=True, slots=True)
class PoseOutside:
    """The configured pose where it is not one of the workspace.

    Parameters
    ----------
    reason : str
        Where it lies.
    cable : str
        The cable that it was solved with; empty where it was not.
    utilisation : float
        Its utilisation there; infinite where no equilibrium was found.
    """

    reason: str
    cable: str = ""
    utilisation: float = math.nan

    @property
    def tone(self) -> str:
        """The colour of the statement."""
        return "bad" if self.cable and self.utilisation > 1.0 else "doubt"


def outside_pose(analysis: Analysis) -> PoseOutside | None:
    """Return where the configured pose lies outside the workspace, and what holds there."""
    outside, statics, qualities = analysis.study.pose_outside, analysis.outside, analysis.qualities
    if not outside:
        return None
    if statics is None or qualities is None:
        return PoseOutside(outside)
    cable = qualities.cable.cable
    largest = math.inf
    if statics.is_solved:
        largest = float((statics.cable_tension_N / cable.allowable_tension_N).max())
    return PoseOutside(outside, qualities.cable.name, largest)


def first_page(analysis: Analysis) -> Context:
    """Return what the templates of the first page get."""
    findings, selection = analysis.findings, analysis.selection
    return {
        "answer": analysis.answer.value,
        "unmet": [Unmet(tuple(cases)) for cases in unmet_by_title(analysis.unmet)],
        "chosen": analysis.assignment.rope,
        "need": analysis.governing_need,
        "groups": analysis.groups,
        "untrusted": selection and selection.untrusted,
        "deciding": selection and MEANINGS[selection.objectives[0]],
        "tight": _TIGHT,
        **_card(analysis),
        **_advice(analysis, findings),
        **_sureness(analysis, findings),
        "weight": _weight(analysis),
        "massless": None if analysis.ropes is None else findings.massless_choice,
        "beside_fibre": _beside_fibre(analysis),
    }


def by_title(requirements: Iterable[Requirement]) -> list[list[Requirement]]:
    """Return the same requirement of all load cases together, in the order of the first."""
    groups: dict[str, list[Requirement]] = {}
    for requirement in requirements:
        groups.setdefault(requirement.title, []).append(requirement)
    return list(groups.values())


def unmet_by_title(requirements: Iterable[Requirement]) -> list[list[Requirement]]:
    """Return what does not hold, together by title: first what fails, then what is not known."""
    unmet = list(requirements)
    return [
        same
        for state in (State.FAILS, State.OPEN)
        for same in by_title(each for each in unmet if each.state is state)
    ]


def _beside_fibre(analysis: Analysis) -> Context | None:
    """Return the best rope of steel beside a chosen one of fibre; None where there is no need."""
    selection, chosen = analysis.selection, analysis.assignment.rope
    if selection is None or chosen is None:
        return None
    solved = [o for o in selection.outcomes if "steel" in o.grade.material_class]  # any kind
    if chosen.grade.material_class != "fibre" or not solved:
        return None
    objective = selection.objectives[0]
    holding = [outcome.best for outcome in solved if outcome.best is not None]
    best = min(holding, key=lambda candidate: candidate.figures.burden(objective), default=None)
    meaning = MEANINGS[objective]
    return {
        "best": best,
        "kind": "" if best is None else best.grade.material_class,
        "extreme": "largest" if meaning.more_is_better else "least",
        "word": meaning.word,
    }


def _card(analysis: Analysis) -> Context:
    assignment, chosen = analysis.assignment, analysis.assignment.rope
    if assignment.has_groups:
        longest_m = assignment.verification.longest_m
        each = [longest_m[[cable - 1 for cable in group.cables]] for group in assignment.groups]
        return {"longest_m": each, "diameter": None}
    if chosen is not None:
        return {"strength": _strength(analysis, chosen), "diameter": None}
    return {"diameter": None if analysis.governing_need is not None else _diameter(analysis)}


def _strength(analysis: Analysis, chosen: Candidate) -> Context:
    """Return how the allowable tension of the load case that governs comes about."""
    assert analysis.study.selection is not None
    size, case = chosen.size, chosen.governing.case
    allowable_N = chosen.governing.loaded.cable.allowable_tension_N
    required = case.safety_factor or analysis.study.selection.safety_factor
    efficiency = chosen.efficiency
    if case.termination_efficiency is not None:
        efficiency = allowable_N * required / size.minimum_breaking_load_N
    built, table = chosen.cable.rope_density_kg_per_m, size.linear_density_kg_per_m
    strength_N = efficiency * size.minimum_breaking_load_N
    return {
        "allowable_N": allowable_N,
        "required": required,
        "efficiency": efficiency,
        "safety_factor": strength_N / chosen.verification.max_tension_N,
        "is_bare": math.isclose(built, table, rel_tol=1e-9),
    }


def _diameter(analysis: Analysis) -> Context | None:
    """Return the diameter that workspace or pose needs; None where none holds."""
    workspace, pose = analysis.workspace, analysis.pose
    if workspace is not None:
        worst = workspace.sagging
        if worst is None:
            return None
        return {
            "of": "workspace",
            "value_m": worst.diameter_m,
            "tension_N": worst.max_tension_N,
            "place": worst.place,
            "is_thinnest": is_thinnest(analysis, "workspace"),
        }
    if pose is None or not pose.sizing.statics.is_solved:
        return None
    return {
        "of": "pose",
        "value_m": float(pose.sizing.diameter_m),
        "tension_N": float(pose.sizing.statics.largest_tension_N),
        "place": pose.sizing.statics.poses.position_m,
        "is_thinnest": is_thinnest(analysis, "pose"),
    }


def is_thinnest(analysis: Analysis, what: str) -> bool:
    """Tell whether no thinner cable is proved to hold the pose or the workspace."""
    sizing = analysis.pose.sizing if analysis.pose is not None else None
    if what == "workspace" and analysis.worst_sizing is not None:
        sizing = analysis.worst_sizing
    return sizing is not None and bool(sizing.is_thinnest)


def _advice(analysis: Analysis, findings: Findings) -> Context:
    unserved, workspace = findings.unserved, analysis.workspace
    outcomes = [] if analysis.selection is None else analysis.selection.outcomes
    pose = analysis.pose
    weight = _weight(analysis)
    return {
        "other_grades": [] if findings.equilibrium_losses else _other_grades(analysis),
        "pose_fails": pose is not None and not pose.sizing.statics.is_solved,
        "some_served": workspace is not None and workspace.sampled is not None,
        "lacks_strength": not analysis.assignment.is_found
        and any(outcome.outcome == "too_thin" for outcome in outcomes),
        "sag_at_most": SAG_AT_MOST,
        "hangs_by_weight": weight is not None
        and not weight["is_held_straight"]
        and any(requirement.id == "sag" for requirement in analysis.unmet),
        "unbalanced_cases": [loss.loaded.case.name for loss in findings.equilibrium_losses],
        "is_layer": unserved is not None and _is_layer(analysis, unserved),
        "is_strip": unserved is not None and unserved.depth_m < _STRIP * unserved.inradius_m,
        "not_served": [] if workspace is None else _verdicts_not_served(analysis),
    }


def _verdicts_not_served(analysis: Analysis) -> list[Verdict]:
    assert analysis.study.workspace is not None
    assert analysis.workspace is not None
    return analysis.study.workspace.not_served(analysis.workspace.census.statuses)


def _is_layer(analysis: Analysis, unserved: Unserved) -> bool:
    assert analysis.study.workspace is not None
    low, high = analysis.study.workspace.region.bounds_m[:, 2]
    return bool(unserved.lowest_z_m > low + _LAYER * (high - low))


def _other_grades(analysis: Analysis) -> list[str]:
    """Return the grades that the study does not allow, but that would hold, the lightest first."""
    if analysis.selection is None or analysis.assignment.is_found:
        return []
    fitting = [o.best for o in analysis.selection.alternatives if o.best is not None]
    fitting.sort(key=lambda candidate: candidate.total_mass_kg)
    names = [f"{c.grade.id} ({c.size.id})" for c in fitting[:_MOST_NAMES]]
    more = len(fitting) - _MOST_NAMES
    return [*names, fmt.plural(more, "other")] if more > 0 else names


def _sureness(analysis: Analysis, findings: Findings) -> Context:
    study, selection = analysis.study, analysis.selection
    ropes = _ropes(analysis)
    ids = dict.fromkeys(effect.id for effect in study.effects)
    idle = {effect.id for effect in study.known_effects.effects if _is_of_data(effect)}
    modulus = findings.modulus_utilisation
    return {
        "pose_outside": outside_pose(analysis),
        "acting_effects": [name for name in ids if name not in idle],
        "idle_effects": [name for name in ids if name in idle],
        "rope_effects": rope_effects(study),
        "margin": _margin(analysis, findings),
        "proved": None if selection is None else selection.proof,
        "orientation": orientation_words(study),
        "long": LONG,
        "bending": _bending(study, ropes),
        "ropes": ropes,
        "grades": [*{grade.id: grade for grade, _ in ropes}.values()],
        "trust_meaning": TRUST_MEANING,
        "modulus": None if modulus is None else sorted(modulus),
    }


def _ropes(analysis: Analysis) -> list[tuple[Grade, Size]]:
    """Return grade and size of each rope in use, once."""
    ropes = analysis.assignment.ropes
    return [*{(rope.grade.id, rope.size.id): (rope.grade, rope.size) for rope in ropes}.values()]


def _bending(study: Study, ropes: Iterable[tuple[Grade, Size]]) -> list[str]:
    """Return what bending over the sheave leaves of each rope."""
    if study.selection is None or study.selection.sheave_diameter_m is None:
        return []
    kept, sheave_m = (
        Allowance.of(study.selection, study.robot.winches).bending_efficiency,
        study.selection.sheave_diameter_m,
    )
    return [
        f"{fmt.percent(kept(grade, size.diameter_m))} for {size.id} "
        f"(D/d {fmt.trimmed(sheave_m / size.diameter_m, 3)})"
        for grade, size in ropes
    ]


def _is_of_data(effect: Effect) -> bool:
    """Tell whether an effect belongs to measured data, and no design is computed with it.

    A plugin need not say of one on the machine whether it reaches the design.
    """
    return not effect.reaches_design and (effect.on_machine is None or effect in SHIPPED.effects)


def _margin(analysis: Analysis, findings: Findings) -> Context | None:
    """Return the self-weight ratio, at which pose, and of what; None where it is not known."""
    ratio = None if analysis.assignment.has_groups else findings.chosen_limit_ratio
    workspace, pose = analysis.workspace, analysis.pose
    if ratio is not None:
        return {"place": "worst", "of": "the chosen grade", "ratio": ratio}
    family: dict[str, object] = {"of": "the configured family"}
    if workspace is not None and workspace.sagging is not None:
        return family | {"place": "worst", "ratio": workspace.limit_ratio}
    if workspace is None and pose is not None and pose.sizing.statics.is_solved:
        return family | {"place": "configured", "ratio": pose.limit_ratio}
    return None


def _weight(analysis: Analysis) -> Context | None:
    """Compare with and without the weight of the cables: of the chosen ropes at their worst pose.

    Without a rope of the configured family at the worst pose, or the configured one; None where
    nothing compares.
    """
    rope = analysis.ropes
    if rope is None:
        return _at_the_worst_poses(analysis) or _at_the_configured_pose(analysis)
    statics, straight_N = rope.worst, rope.straight.tension_N
    if not statics.is_solved or not (straight_N >= 0.0).all():
        return {"is_held_straight": False}
    straight = float((straight_N / rope.cable.allowable_tension_N).max())
    return {
        "is_held_straight": True,
        "rope": rope.name,
        "tensions_N": (float(straight_N.max()), float(statics.largest_tension_N)),
        "utilisations": (straight, float(rope.utilisation(statics))),
    }


def _at_the_worst_poses(analysis: Analysis) -> Context | None:
    workspace = analysis.workspace
    if workspace is None or workspace.sagging is None or workspace.massless is None:
        return None
    sagging, massless = workspace.sagging, workspace.massless
    return {
        "is_held_straight": True,
        "rope": "",
        "place": "each at its own worst pose" + (", at rest" if analysis.study.load_cases else ""),
        "diameters_m": (massless.diameter_m, sagging.diameter_m),
        "tensions_N": (massless.max_tension_N, sagging.max_tension_N),
    }


def _at_the_configured_pose(analysis: Analysis) -> Context | None:
    pose = analysis.pose
    if pose is None or not pose.sizing.statics.is_solved:
        return None
    sizing, massless_N = pose.sizing, float(pose.massless.largest_tension_N)
    if not math.isfinite(massless_N):
        return None
    return {
        "is_held_straight": True,
        "rope": "",
        "place": "at the configured pose",
        "diameters_m": (float(sizing.massless_diameter_m), float(sizing.diameter_m)),
        "tensions_N": (massless_N, float(sizing.statics.largest_tension_N)),
    }
