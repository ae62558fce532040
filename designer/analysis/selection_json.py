"""What a choice came to, for scripts: part of ``result.json``, and ``candidates.csv``."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from designer.documents.csv_text import csv_text
from designer.documents.plain import finite
from designer.model.space import turn_of
from designer.selection.candidate import Candidate
from designer.selection.groups.result import GroupChoice
from designer.selection.result import GradeOutcome, SelectionResult

Json = dict[str, Any]

_LISTS = {
    "longest_m": "longest_{}_m",
    "shortest_m": "shortest_{}_m",
    "worst_pose": "worst_pose_{}_m",
    "worst_rotation_vector": "worst_rotation_vector_{}_rad",
}
"""Columns of ``candidates.csv`` that one key becomes, numbered from 1."""
_CANDIDATE = {
    "grade": "grade.id",
    "size_id": "size.id",
    "diameter_m": "size.diameter_m",
    "continuous_diameter_m": "continuous_diameter_m",
    "max_tension_N": "verification.max_tension_N",
    "utilisation": "verification.utilisation",
    "minimum_breaking_load_N": "size.minimum_breaking_load_N",
    "efficiency": "efficiency",
    "allowable_tension_N": "cable.allowable_tension_N",
    "linear_mass_kg_per_m": "size.linear_density_kg_per_m",
    "as_built_linear_mass_kg_per_m": "cable.linear_density_kg_per_m",
    "axial_stiffness_N": "cable.axial_stiffness_N",
    "total_mass_kg": "total_mass_kg",
    "drum_diameter_m": "figures.drum_diameter_m",
    "cost": "figures.cost",
    "stiffness_N_per_m": "figures.stiffness_N_per_m",
    "longest_m": "verification.longest_m",
    "shortest_m": "verification.shortest_m",
    "worst_pose": "verification.worst_place",
    "worst_rotation_vector": "verification.worst_place",
    "verified": "verified",
    "refined": "verification.is_refined",
    "standing": "standing",
    "why": "reason",
}
"""Of each key where its value is found."""
_PRODUCT = ("grade", "size_id", "diameter_m", "allowable_tension_N", "linear_mass_kg_per_m")
_CHOICE = {
    "objective": "objective",
    "unit": "unit",
    "max_distinct_products": "most_distinct",
    "total_mass_kg": "chosen.total_mass_kg",
    "total": "total",
    "bound": "bound",
    "gap": "gap",
    "proof": "proof",
    "proof_sentence": "proof_sentence",
    "single_product_mass_kg": "single.total_mass_kg",
    "saving_kg": "saving_kg",
    "offered": "offered",
    "trials": "trials",
}


def _plain(result: object, table: Mapping[str, str]) -> Json:
    """Return the values that a table names, None for what belongs to a part that is None."""

    def value(path: str) -> Any:
        part: Any = result
        for name in path.split("."):
            part = None if part is None else getattr(part, name)
        return finite(part)

    return {key: value(path) for key, path in table.items()}


def selection_dict(selection: SelectionResult) -> Json:
    """Return everything that ``result.json`` holds of a choice; a missing number is None."""
    rows = {
        id(c): candidate_dict(c, o)
        for o in (*selection.outcomes, *selection.alternatives)
        for c in o.candidates
    }
    chosen, usable = selection.chosen, selection.usable
    grade_id, sizes = (usable.grade.id, usable.sizes) if usable else (None, ())
    grade = {
        "grade": "grade.id",
        "outcome": "outcome",
        "sentence": "sentence",
        "continuous_diameter_m": "continuous_diameter_m",
        "best_size_id": "best.size.id",
    }
    part = {"size_id": "size.id", "diameter_m": "size.diameter_m"}
    part |= {name: name for name in ("volume_m3", "fraction", "lost_fraction")}
    left_out = {"grade": "grade.id", "size_id": "size.id", "reason": "reason"}
    return {
        "objectives": list(selection.objectives),
        "currency": selection.currency,
        "chosen": None if chosen is None else rows[id(chosen)],
        "reason": selection.reason,
        "pareto": [rows[id(c)] for c in selection.front],
        "candidates": [rows[id(c)] for c in selection.candidates],
        "not_tried": [_plain(row, left_out) for row in selection.not_tried],
        "grades": [_plain(row, grade) for row in selection.outcomes],
        "alternatives": [rows[id(o.best)] for o in selection.alternatives if o.best],
        "usable": [_plain(row, part) | {"grade": grade_id} for row in sizes],
    }


def candidate_dict(candidate: Candidate, outcome: GradeOutcome) -> Json:
    """Return one candidate under the names that scripts rely on."""
    figures = _plain(candidate, _CANDIDATE) | _place(candidate.verification.worst_place)
    trust = {"trust": candidate.grade.trust, "doubt": candidate.size.doubt}
    return {**figures, "outcome": outcome.outcome, **trust}


def _place(place: Any) -> Json:
    return {
        "worst_pose": finite(place[:3]),
        "worst_rotation_vector": finite(turn_of(place)),
    }


def groups_dict(choice: GroupChoice | None) -> Json:
    """Return ``groups`` and ``group_choice``; empty and None where a study has no groups."""
    if choice is None:
        return {"groups": [], "group_choice": None}
    figures = _plain(choice, _CHOICE)
    figures["bound_kg"] = figures["bound"] if choice.objective == "mass" else None
    return {
        "groups": list(_groups(choice)),
        "group_choice": {**figures, "proposals": list(_proposals(choice))},
    }


def _groups(choice: GroupChoice) -> Iterator[Json]:
    chosen, verification = choice.chosen, choice.chosen.verification
    for k, (group, rope) in enumerate(zip(chosen.groups, chosen.ropes, strict=True)):
        yield {
            "name": group.name,
            "cables": list(group.cables),
            **_plain(rope, {key: _CANDIDATE[key] for key in (*_PRODUCT, "axial_stiffness_N")}),
            "utilisation": finite(verification.utilisation[k]),
            "longest_m": finite(verification.longest_m[[c - 1 for c in group.cables]]),
            **_place(verification.worst_place[k]),
        }


def _proposals(choice: GroupChoice) -> Iterator[Json]:
    names = ("bound", "total", "outcome", "utilisation", "excluded", "guided")
    for proposal in choice.proposals:
        yield {
            **_plain(proposal, {name: name for name in names}),
            "products": [{"grade": p.grade.id, "size_id": p.size.id} for p in proposal.products],
            "group": None if proposal.group is None else choice.groups[proposal.group].name,
            "pose": finite(proposal.place),
        }


def candidates_csv(selection: SelectionResult) -> str:
    """Return every candidate as a row of a CSV table; a missing number is an empty cell."""
    rows = []
    for candidate, outcome in ((c, o) for o in selection.outcomes for c in o.candidates):
        row: Json = {}
        for name, value in candidate_dict(candidate, outcome).items():
            parts = enumerate(value, start=1) if name in _LISTS else [(0, value)]
            row |= {_LISTS.get(name, name).format(k): part for k, part in parts}
        rows.append(row)
    names = list(rows[0]) if rows else ["grade", "size_id"]
    return csv_text([names, *([row[name] for name in names] for row in rows)])
