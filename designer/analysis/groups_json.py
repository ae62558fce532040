"""What the choice for groups of cables came to, for scripts: part of ``result.json``."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

from designer.model.space import turn_of
from designer.selection.groups.result import Assigned, GroupChoice, Proposal

Json = dict[str, Any]


def groups_dict(choice: GroupChoice | None) -> Json:
    """Return ``groups`` and ``group_choice``; empty and None where a study has no groups."""
    if choice is None:
        return {"groups": [], "group_choice": None}
    return {
        "groups": [] if choice.chosen is None else _groups(choice, choice.chosen),
        "group_choice": _choice(choice),
    }


def _groups(choice: GroupChoice, chosen: Assigned) -> list[Json]:
    found = chosen.verification
    return [
        {
            "name": group.name,
            "cables": list(group.cables),
            "grade": product.grade.id,
            "size_id": product.size.id,
            "diameter_m": product.size.diameter_m,
            "utilisation": _number(found.utilisation[k]),
            "allowable_tension_N": product.cable.allowable_tension_N,
            "linear_mass_kg_per_m": product.size.linear_density_kg_per_m,
            "axial_stiffness_N": product.cable.axial_stiffness_N,
            "longest_m": _numbers(found.longest_m[[c - 1 for c in group.cables]]),
            "worst_pose": _numbers(found.worst_place[k][:3]),
            "worst_rotation_vector": _numbers(turn_of(found.worst_place[k])),
        }
        for k, (group, product) in enumerate(zip(choice.groups, chosen.products, strict=True))
    ]


def _choice(choice: GroupChoice) -> Json:
    is_mass = choice.objective == "mass"
    chosen, single = choice.chosen, choice.single
    return {
        "objective": choice.objective,
        "unit": choice.unit,
        "max_distinct_products": choice.most_distinct,
        "total_mass_kg": None if chosen is None else _number(chosen.total_mass_kg),
        "total": None if chosen is None else _number(chosen.total),
        "bound_kg": _number(choice.bound) if is_mass else None,
        "bound": _number(choice.bound),
        "gap": None if choice.gap is None else _number(choice.gap),
        "proof": choice.proof,
        "proof_sentence": choice.proof_sentence,
        "single_product_mass_kg": None if single is None else _number(single.total_mass_kg),
        "saving_kg": None if choice.saving_kg is None else _number(choice.saving_kg),
        "offered": choice.offered,
        "trials": choice.trials,
        "proposals": [_proposal(choice, one) for one in choice.proposals],
    }


def _proposal(choice: GroupChoice, one: Proposal) -> Json:
    return {
        "products": [{"grade": p.grade.id, "size_id": p.size.id} for p in one.products],
        "bound": _number(one.bound),
        "total": None if one.total is None else _number(one.total),
        "outcome": one.outcome,
        "group": None if one.group is None else choice.groups[one.group].name,
        "utilisation": None if one.utilisation is None else _number(one.utilisation),
        "pose": None if one.place is None else _numbers(one.place),
        "excluded": one.excluded,
        "guided": one.guided,
    }


def _number(value: Any) -> float | None:
    number = float(value)
    return number if math.isfinite(number) else None


def _numbers(values: Iterable[Any]) -> list[float | None]:
    return [_number(value) for value in values]
