"""``result.json`` and ``candidates.csv``: the results for scripts, under stable names.

A missing number is null, or an empty cell.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from designer import __version__
from designer.analysis.analyse import Analysis
from designer.analysis.lengths import spooled_of
from designer.analysis.pose import PoseAnalysis
from designer.analysis.sensitivity import sensitivity_dict
from designer.arrays import FloatArray
from designer.documents.plain import RESULT_FORMAT, Json, csv_text, is_requested, plain, record
from designer.model.space import named_place, rotation_vector_of
from designer.model.verdict import Verdict
from designer.proof.prove import Proof
from designer.selection.assignment import Assignment
from designer.selection.candidate import Candidate
from designer.selection.cases import CaseResult
from designer.selection.groups import GroupChoice
from designer.selection.result import GradeOutcome, SelectionResult
from designer.statics.cable_loss import Fate
from designer.study import Study
from designer.workspace.clearance import Interference

_OF_THE_CHOICE = ("stiffness", "interference", "hanging")
"""Of ``workspace``: of the chosen rope, so that it has to be chosen."""
_OF_SENSITIVITY = ("sensitivities", "reserve", "sizes_beside", "first_failures")


def result_dict(analysis: Analysis) -> Json:
    """Return everything that ``result.json`` holds; a part without results is None.

    What changes no answer and takes its time is computed where it is read, and empty elsewhere.
    """
    study, selection, is_read = analysis.study, analysis.selection, analysis.is_read
    with_sensitivity = any(map(is_read, _OF_SENSITIVITY))
    modes = analysis.modes if is_read("modes") or is_read("modes_at") else None
    path = analysis.path if is_read("path") else None
    uncertainty = analysis.uncertainty if is_read("uncertainty") else None
    return plain(
        {
            "format": RESULT_FORMAT,
            "name": study.name,
            "positive": analysis.is_positive,
            "answer": _answer(analysis),
            "inputs": {entry.field: entry.value_SI for entry in study.source.entries},
            "pose": _pose(study, analysis.pose, is_read("pose.rest")),
            "workspace": _workspace(analysis),
            "selection": selection_dict(selection, analysis.groups, analysis.own_material),
            **load_cases_dict(analysis),
            **sensitivity_dict(
                analysis.sensitivity if with_sensitivity else None,
                analysis.group_slopes if with_sensitivity else (),
            ),
            "uncertainty": uncertainty and uncertainty.to_dict(),
            "modes": modes.modes if modes else [],
            "modes_at": modes,
            "path": path and path.to_dict(),
            "reactions": analysis.reactions if is_read("reactions") else [],
            "winches": spooled_of(analysis) if is_read("winches") else [],
            "findings": analysis.findings if is_read("findings") else None,
            "proof": (selection and selection.proof) or Proof("off"),
            "verification": analysis.verification if is_read("verification") else [],
            "provenance": {
                **_origin(study),
                "catalogues": analysis.catalogue.sources,
                "problems": analysis.left_out,
                "libraries": dict(analysis.provenance.libraries),
                "system": analysis.provenance.system,
                "created": analysis.provenance.created.isoformat(timespec="seconds"),
                "seed": None if study.workspace is None else study.workspace.seed,
            },
        }
    )


def result_part(analysis: Analysis) -> Json:
    """Return as much of `result_dict` as is read; no more is computed.

    Where that takes no answer there are only the name, the pose and the workspace.
    """
    if analysis.keep is None or evaluates_answer(analysis.keep):
        return result_dict(analysis)
    part: Json = {"format": RESULT_FORMAT, "name": analysis.study.name}
    if analysis.is_read("pose"):
        part["pose"] = _pose(analysis.study, analysis.pose, analysis.is_read("pose.rest"))
    if analysis.is_read("workspace"):
        part["workspace"] = _workspace(analysis)
    return plain(part)


def evaluates_answer(keep: Iterable[str]) -> bool:
    """Tell whether what is kept takes the answer of a study, and not a part of it alone."""
    paths = [name.split(".") for name in keep]
    of_the_choice = any(path[1:2] == [quality] for path in paths for quality in _OF_THE_CHOICE)
    return of_the_choice or not {path[0] for path in paths} <= {"pose", "workspace", "name"}


def size_dict(study: Study, pose: PoseAnalysis, keep: Sequence[str] | None = None) -> Json:
    """Return what ``designer size --json`` prints: the pose alone, under the same names.

    Of ``keep``, the paths that will be read; all if left out.
    """
    with_rest = is_requested("pose.rest", keep)
    pose_alone = {"pose": _pose(study, pose, with_rest), "provenance": _origin(study)}
    return plain({"format": RESULT_FORMAT, "name": study.name, **pose_alone})


def _origin(study: Study) -> Json:
    return {"version": __version__, "config_sha256": study.source.sha256}


def _answer(analysis: Analysis) -> Json:
    """Return the verdict, what it rests on where it is not yes, and the products to use."""
    reasons = [
        {"id": requirement.id, "load_case": requirement.load_case, "state": requirement.state.value}
        for requirement in analysis.unmet
    ]
    assignment = analysis.assignment
    products = [  # one rope for all has no name
        {"name": group.name or None, "cables": group.cables, **rope.ids}
        for group, rope in zip(assignment.groups, assignment.ropes, strict=True)
    ]
    return {
        "verdict": analysis.answer.value,
        "covers": analysis.terms.covers,
        "not_asked": analysis.terms.not_asked,
        "subject_to": analysis.terms.subject_to,
        "reasons": reasons,
        "products": products,
        "total_mass_kg": assignment.total_mass_kg,
    }


def _pose(study: Study, pose: PoseAnalysis | None, with_rest: bool) -> Json | None:
    if pose is None:
        return None
    statics, sizing = pose.sizing.statics, pose.sizing
    diameter, is_solved = sizing.diameter_m, bool(statics.is_solved)
    evidence = "proved" if sizing.is_thinnest else "found"  # that no thinner cable holds it
    return {
        "position_m": statics.poses.position_m,
        "in_workspace": None if study.workspace is None else not study.pose_outside,
        "limit_ratio": pose.limit_ratio,
        "sagging": {
            "diameter_m": diameter,
            "max_tension_N": statics.largest_tension_N,
            "lengths_m": statics.length_m,
            "tensions_N": statics.exit_tension_N,
            "platform_tensions_N": statics.platform_tension_N,
            "forces_x_N": statics.force_x_N,
            "forces_z_N": statics.force_z_N,
            "hangs_below": bool(statics.hangs_below) if is_solved else None,
            "closure_residual_m": statics.closure_residual_m().max(),
            "equilibrium_residual_N": abs(statics.equilibrium_residual_N()).max(),
            "status": Verdict(int(statics.verdict)).label,
            "thinnest": evidence if is_solved else None,
        },
        "massless": {
            "diameter_m": sizing.massless_diameter_m,
            "max_tension_N": pose.massless.largest_tension_N,
        },
        "loop": {
            "converged": pose.loop.has_converged,
            "diverged": pose.loop.has_diverged,
            "iterates": [
                {"diameter_m": i.diameter_m, "max_tension_N": i.max_tension_N}
                for i in pose.loop.iterates
            ],
        },
        "optimum": {"diameter_m": diameter},
        "rest": pose.rest if with_rest else None,
    }


def _workspace(analysis: Analysis) -> Json | None:
    if analysis.workspace is None:
        return None
    qualities: Json = dict.fromkeys(_OF_THE_CHOICE)  # None where they were not looked at
    for name in _OF_THE_CHOICE:
        if analysis.is_read(f"workspace.{name}") and analysis.qualities is not None:
            qualities[name] = getattr(analysis.qualities, name)
    survey = qualities["interference"]
    return {
        **record(analysis.workspace),
        "orientations": _orientations(analysis.study),
        "section_m": analysis.section_m,
        "servable": analysis.servable if analysis.is_read("workspace.servable") else None,
        **qualities,
        "interference": survey and _interference(survey),
    }


def _orientations(study: Study) -> Json | None:
    """Return which orientations were tried at each position; None of a point mass."""
    if study.workspace is None or study.robot.is_point_mass:
        return None
    orientations = study.workspace.orientations
    law = orientations.law
    return {
        "rotation_vectors": orientations.turns_rad if law is None else None,
        "range": orientations.range_rad,
        "law": None if law is None else law.words,
        "table": None if law is None or law.rows is None else np.hstack(law.rows),
    }


def _interference(survey: Interference) -> Json:
    worst = survey.worst
    return {
        "clearance_m": survey.clearance_m,
        "min_distance_m": None if worst is None else worst.distance_m,
        "error_m": None if worst is None else worst.error_m,
        "pair": None if worst is None else worst.names,
        "pose": None if worst is None else worst.place[:3],
        "samples": survey.samples,
        "violating": survey.violating,
        "violated": survey.is_violated,
    }


def load_cases_dict(analysis: Analysis) -> Json:
    """Return each load case, each requirement, and the governing pose, None where no rope is."""
    study, chosen = analysis.study, analysis.chosen
    checks = analysis.requirements
    if chosen is None or study.selection is None:
        needs = [
            _case(case.governing) | {"diameter_m": case.diameter_m, "holds": case.is_held}
            for case in analysis.needs
        ]
        return {"load_cases": needs, "checks": checks, "governing": None}
    return {
        "load_cases": [_case(case) for case in chosen.cases],
        "checks": checks,
        "governing": analysis.governing,
    }


def _case(case: CaseResult) -> Json:
    verification, loaded, loss = case.verification, case.loaded, case.loss
    place = verification.worst_place
    after = {
        "fate": None if loss is None else Fate(int(loss.fate[0])).label,
        "rest": None if loss is None else loss.rest.position_m[0],
        "moved_m": None if loss is None else loss.moved_m[0],
    }
    figures = {
        "name": case.case.name,
        "holds": verification.holds,
        "utilisation": verification.utilisation,
        "max_tension_N": verification.max_tension_N,
        "allowable_tension_N": loaded.cable.allowable_tension_N,
        "axial_stiffness_N": loaded.cable.axial_stiffness_N,
        "cable": case.most_used,
        **named_place(place),
        "lost_cable": loaded.lost_cable,
        "temperature_change_K": case.case.temperature_change_K,
        "wind_direction": loaded.wind,
        "inertia_direction": loaded.inertia,
        "wrench_N": loaded.wrench_N,
        "refined": verification.is_refined,
    }
    return figures | after


_LISTS = {
    "longest_m": "longest_{}_m",
    "shortest_m": "shortest_{}_m",
    "worst_pose": "worst_pose_{}_m",
    "worst_rotation_vector": "worst_rotation_vector_{}_rad",
}
"""Columns of ``candidates.csv`` that one key becomes, numbered from 1."""


def selection_dict(
    selection: SelectionResult | None, choice: GroupChoice | None, own_material: str | None
) -> Json | None:
    """Return everything that ``result.json`` holds of a choice; None where none was to be made."""
    if selection is None:
        return None
    rows = {
        c: candidate_dict(c, o)
        for o in (*selection.outcomes, *selection.alternatives)
        for c in o.candidates
    }
    chosen, usable, untrusted = selection.chosen, selection.usable, selection.untrusted
    prices, rival = selection.price_list, chosen and chosen.preferred_to
    return {
        "objectives": selection.objectives,
        "preference": {
            "units": selection.prefer,
            "instead_of": rival and rows[rival],
            "why": selection.preference or None,
        },
        "currency": selection.currency,
        "price_estimate": selection.price_estimate,
        "price_list": prices
        and {
            "file": prices.name,
            "currency": prices.currency,
            "dates": prices.dates,
            "prices": len(prices.offers),
        },
        "chosen": None if chosen is None else rows[chosen],
        "reason": selection.reason,
        "best_of_materials": [
            {"material": c.grade.material} | rows[c]
            for c in selection.best_of_materials(own_material)
        ],
        "untrusted": untrusted
        and {**untrusted.ids, "total_mass_kg": untrusted.total_mass_kg}
        | {"cost": untrusted.figures.cost},
        "pareto": [rows[c] for c in selection.front],
        "candidates": [rows[c] for c in selection.candidates],
        "not_tried": selection.not_tried,
        "exclusions": selection.exclusions,
        "grades": selection.outcomes,
        "alternatives": [rows[o.best] for o in selection.alternatives if o.best],
        "usable": [record(size) | {"grade": usable.grade.id} for size in usable.sizes]
        if usable
        else [],
        "groups": [] if choice is None else list(_groups(choice.chosen)),
        "group_choice": choice,
    }


def candidate_dict(candidate: Candidate, outcome: GradeOutcome) -> Json:
    """Return one candidate under the names that scripts rely on."""
    verification, size, cable = candidate.verification, candidate.size, candidate.cable
    return {
        **candidate.ids,
        "diameter_m": size.diameter_m,
        "continuous_diameter_m": outcome.continuous_diameter_m,
        "max_tension_N": verification.max_tension_N,
        "utilisation": verification.utilisation,
        "minimum_breaking_load_N": size.minimum_breaking_load_N,
        "efficiency": candidate.efficiency,
        "allowable_tension_N": cable.allowable_tension_N,
        "linear_mass_kg_per_m": size.linear_density_kg_per_m,
        "as_built_linear_mass_kg_per_m": cable.mean_density_kg_per_m,
        "axial_stiffness_N": cable.axial_stiffness_N,
        "total_mass_kg": candidate.total_mass_kg,
        "drum_diameter_m": candidate.figures.drum_diameter_m,
        "cost": candidate.figures.cost,
        "stiffness_N_per_m": candidate.figures.stiffness_N_per_m,
        "longest_m": verification.longest_m,
        "shortest_m": verification.shortest_m,
        **_place(verification.worst_place),
        "verified": candidate.verified,
        "refined": verification.is_refined,
        "standing": candidate.standing,
        "why": candidate.reason,
        "outcome": outcome.outcome,
        "trust": candidate.grade.trust,
        "doubt": size.doubt,
    }


def _place(place: FloatArray) -> Json:
    return {"worst_pose": place[:3], "worst_rotation_vector": rotation_vector_of(place)}


def _groups(chosen: Assignment) -> Iterator[Json]:
    verification = chosen.verification
    for k, (group, rope) in enumerate(zip(chosen.groups, chosen.ropes, strict=True)):
        yield {
            "name": group.name,
            "cables": group.cables,
            **rope.ids,
            "diameter_m": rope.size.diameter_m,
            "allowable_tension_N": rope.cable.allowable_tension_N,
            "linear_mass_kg_per_m": rope.size.linear_density_kg_per_m,
            "axial_stiffness_N": rope.cable.axial_stiffness_N,
            "utilisation": verification.utilisation[k],
            "longest_m": verification.longest_m[[c - 1 for c in group.cables]],
            **_place(verification.worst_place[k]),
        }


def candidates_csv(selection: SelectionResult) -> str:
    """Return every candidate as a row of a CSV table; a missing number is an empty cell."""
    rows = []
    for candidate, outcome in ((c, o) for o in selection.outcomes for c in o.candidates):
        row: Json = {}
        for name, value in plain(candidate_dict(candidate, outcome)).items():
            parts = enumerate(value, start=1) if name in _LISTS else [(0, value)]
            row |= {_LISTS.get(name, name).format(k): part for k, part in parts}
        rows.append(row)
    rows += [
        {"grade": left.grade.id, "size_id": size.id, "diameter_m": size.diameter_m}
        | {"standing": "not_tried", "why": left.reason, "trust": left.grade.trust}
        for left in selection.not_tried
        for size in left.sizes
    ]
    names = list(rows[0]) if rows else ["grade", "size_id"]
    return csv_text([names, *([row.get(name) for name in names] for row in rows)])
