"""What a choice came to, for scripts: part of ``result.json``, and ``candidates.csv``."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterable
from typing import Any

from designer.model.space import turn_of
from designer.selection.result import Candidate, GradeOutcome, SelectionResult
from designer.selection.usable import Usable

Json = dict[str, Any]

_LISTS = {
    "longest_m": "longest_{}_m",
    "shortest_m": "shortest_{}_m",
    "worst_pose": "worst_pose_{}_m",
    "worst_rotation_vector": "worst_rotation_vector_{}_rad",
}


def selection_dict(selection: SelectionResult) -> Json:
    """Return everything that ``result.json`` holds of a choice; a missing number is None."""
    rows = {
        id(c): candidate_dict(c, o)
        for outcomes in (selection.outcomes, selection.alternatives)
        for o in outcomes
        for c in o.candidates
    }
    chosen, usable = selection.chosen, selection.usable
    return {
        "objectives": list(selection.objectives),
        "currency": selection.currency,
        "chosen": None if chosen is None else rows[id(chosen)],
        "reason": selection.reason,
        "pareto": [rows[id(c)] for c in selection.front],
        "candidates": [rows[id(c)] for c in selection.candidates],
        "not_tried": [
            {
                "grade": one.grade.id,
                "size_id": one.size.id if one.size else None,
                "reason": one.reason,
            }
            for one in selection.not_tried
        ],
        "grades": [
            {
                "grade": o.grade.id,
                "outcome": o.outcome,
                "sentence": o.sentence,
                "continuous_diameter_m": _number(o.continuous_diameter_m),
                "best_size_id": o.best.size.id if o.best else None,
            }
            for o in selection.outcomes
        ],
        "alternatives": [rows[id(o.best)] for o in selection.alternatives if o.best],
        "usable": [] if usable is None else _usable_list(usable),
    }


def _usable_list(usable: Usable) -> list[Json]:
    return [
        {
            "grade": usable.grade.id,
            "size_id": one.size.id,
            "diameter_m": one.size.diameter_m,
            "volume_m3": one.volume_m3,
            "fraction": one.fraction,
            "lost_fraction": one.lost_fraction,
        }
        for one in usable.sizes
    ]


def candidate_dict(candidate: Candidate, outcome: GradeOutcome) -> Json:
    """Return one candidate under the names that scripts rely on."""
    size, found, figures = candidate.size, candidate.verification, candidate.figures
    return {
        "grade": candidate.grade.id,
        "size_id": size.id,
        "diameter_m": size.diameter_m,
        "continuous_diameter_m": _number(candidate.continuous_diameter_m),
        "max_tension_N": _number(found.max_tension_N),
        "utilisation": _number(found.utilisation),
        "minimum_breaking_load_N": size.minimum_breaking_load_N,
        "efficiency": candidate.efficiency,
        "allowable_tension_N": candidate.cable.allowable_tension_N,
        "linear_mass_kg_per_m": size.linear_density_kg_per_m,
        "as_built_linear_mass_kg_per_m": candidate.cable.linear_density_kg_per_m,
        "axial_stiffness_N": candidate.cable.axial_stiffness_N,
        "total_mass_kg": _number(candidate.total_mass_kg),
        "drum_diameter_m": _number(figures.drum_diameter_m),
        "cost": _number(figures.cost),
        "stiffness_N_per_m": _number(figures.stiffness_N_per_m),
        "longest_m": _numbers(found.longest_m),
        "shortest_m": _numbers(found.shortest_m),
        "worst_pose": _numbers(found.worst_position_m[:3]),
        "worst_rotation_vector": _numbers(turn_of(found.worst_position_m)),
        "verified": candidate.verified,
        "refined": found.is_refined,
        "standing": candidate.standing,
        "why": candidate.reason,
        "outcome": outcome.outcome,
        "trust": candidate.grade.trust,
        "doubt": size.doubt,
    }


def finite(values: Any) -> Any:
    """Return the same with None for each number that is not finite, which JSON cannot hold."""
    if isinstance(values, dict):
        return {key: finite(value) for key, value in values.items()}
    if isinstance(values, list | tuple):
        return [finite(value) for value in values]
    return None if isinstance(values, float) and not math.isfinite(values) else values


def candidates_csv(selection: SelectionResult) -> str:
    """Return every candidate as a row of a CSV table.

    Lists become columns of their own, numbered from 1; a missing number is an empty cell.
    """
    rows = [_flat(candidate_dict(c, o)) for o in selection.outcomes for c in o.candidates]
    stream = io.StringIO()
    writer = csv.DictWriter(stream, fieldnames=list(rows[0]) if rows else ["grade", "size_id"])
    writer.writeheader()
    writer.writerows(rows)
    return stream.getvalue()


def _flat(row: Json) -> Json:
    flat: Json = {}
    for name, value in row.items():
        if name in _LISTS:
            flat |= {_LISTS[name].format(k): one for k, one in enumerate(value, start=1)}
        else:
            flat[name] = value
    return flat


def _number(value: Any) -> float | None:
    number = float(value)
    return number if math.isfinite(number) else None


def _numbers(values: Iterable[Any]) -> list[float | None]:
    return [_number(value) for value in values]
