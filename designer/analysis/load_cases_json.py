"""What the chosen product meets in each load case, for scripts: part of ``result.json``."""

from __future__ import annotations

from typing import Any

from designer.analysis.analyse import Analysis
from designer.model.space import named_place
from designer.selection.cases import CaseResult
from designer.statics.cable_loss import Fate

Json = dict[str, Any]


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
        "refined": verification.is_refined,
    }
    return figures | after
