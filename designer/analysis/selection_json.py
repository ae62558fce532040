"""What a choice came to, for scripts: part of ``result.json``, and ``candidates.csv``."""

from __future__ import annotations

from collections.abc import Iterator

from designer.arrays import FloatArray
from designer.documents.plain import Json, csv_text, plain, record
from designer.model.cable import PriceList
from designer.model.space import turn_of
from designer.selection.assignment import Assignment
from designer.selection.candidate import Candidate
from designer.selection.groups.result import GroupChoice
from designer.selection.result import GradeOutcome, SelectionResult

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
    rival = chosen and chosen.preferred_to
    return {
        "objectives": selection.objectives,
        "preference": {
            "units": selection.prefer,
            "instead_of": rival and rows[rival],
            "why": selection.preference or None,
        },
        "currency": selection.currency,
        "price_estimate": selection.price_estimate,
        "price_list": selection.price_list and _prices(selection.price_list),
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


def _prices(price_list: PriceList) -> Json:
    return {
        "file": price_list.name,
        "currency": price_list.currency,
        "dates": price_list.dates,
        "prices": len(price_list.offers),
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
    return {"worst_pose": place[:3], "worst_rotation_vector": turn_of(place)}


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
