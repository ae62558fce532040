"""What the chosen product meets in each load case, for scripts: part of ``result.json``."""

from __future__ import annotations

from typing import Any

from designer.documents.plain import finite
from designer.model.space import turn_of
from designer.selection.cases import CaseFound
from designer.selection.result import Candidate
from designer.statics.cable_loss import Fate

Json = dict[str, Any]


def load_cases_list(chosen: Candidate | None) -> list[Json]:
    """Return each load case with what the chosen product meets in it; empty if none is chosen."""
    return [] if chosen is None else [_case(one) for one in chosen.cases]


def _case(found: CaseFound) -> Json:
    met, loaded, loss = found.verification, found.loaded, found.loss()
    place = met.worst_position_m
    after = {
        "fate": None if loss is None else Fate(int(loss.fate[0])).label,
        "rest": None if loss is None else loss.rest.position_m[0],
        "moved_m": None if loss is None else loss.moved_m[0],
    }
    asked = {
        "name": found.case.name,
        "holds": met.holds,
        "utilisation": met.utilisation,
        "max_tension_N": met.max_tension_N,
        "allowable_tension_N": loaded.cable.allowable_tension_N,
        "cable": found.most_used(),
        "pose": place[:3],
        "rotation_vector": turn_of(place),
        "lost_cable": loaded.lost_cable,
        "wind_direction": loaded.wind,
        "inertia_direction": loaded.inertia,
        "refined": met.is_refined,
    }
    plain: Json = finite(asked | after)
    return plain
