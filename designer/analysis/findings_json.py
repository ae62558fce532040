"""What a reviewer asks next, for scripts: part of ``result.json``."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from designer.analysis.adrift import Adrift
from designer.analysis.findings import Findings, MasslessChoice, OtherPolicy
from designer.documents.plain import finite
from designer.model.space import turn_of

Json = dict[str, Any]


def findings_dict(findings: Findings) -> Json:
    """Return the answers; None where a question does not arise."""
    choice, other = findings.massless_choice, findings.other_policy
    plain: Json = finite(
        {
            "hanging_share": findings.hanging,
            "other_hangs_below": None if other is None else _other_policy(other),
            "unserved": None if findings.unserved is None else asdict(findings.unserved),
            "not_in_equilibrium": [_not_in_equilibrium(case) for case in findings.adrift],
            "without_cable_weight": None if choice is None else _massless_choice(choice),
            "chosen_limit_ratio": findings.chosen_limit_ratio,
            "modulus_utilisation": findings.modulus_utilisation,
        }
    )
    return plain


def _other_policy(other: OtherPolicy) -> Json:
    worst = other.map.sagging
    return {
        "policy": other.hangs_below,
        "samples": other.map.census.samples,
        "feasible": other.map.is_feasible,
        "diameter_m": None if worst is None else worst.diameter_m,
        "max_tension_N": None if worst is None else worst.max_tension_N,
        "pose": None if worst is None else worst.position_m,
    }


def _not_in_equilibrium(case: Adrift) -> Json:
    return {
        "load_case": case.loaded.case.name,
        "share": case.share,
        "pose": case.place[:3],
        "rotation_vector": turn_of(case.place),
        "wind_direction": case.loaded.wind,
        "inertia_direction": case.loaded.inertia,
        "force_N": case.push_N,
    }


def _massless_choice(choice: MasslessChoice) -> Json:
    return {
        "grade": choice.candidate.grade.id,
        "size_id": choice.size.id,
        "max_tension_N": choice.verification.max_tension_N,
        "utilisation": choice.verification.utilisation,
        "safety_factor": choice.safety_factor,
    }
