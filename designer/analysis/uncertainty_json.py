"""How likely a size is enough, for scripts: part of ``result.json``."""

from __future__ import annotations

from typing import Any

import numpy as np

from designer.analysis.uncertainty.uncertainty import CONFIDENCE, SizeOdds, UncertaintyAnalysis
from designer.model.uncertainty import Input, Normal

Json = dict[str, Any]

_PERCENTILES = {"p05": 5.0, "median": 50.0, "p95": 95.0}


def uncertainty_dict(found: UncertaintyAnalysis | None) -> Json | None:
    """Return probability, utilisation, sizes and shares; None where no input is uncertain."""
    if found is None:
        return None
    return {
        "asked": found.is_asked,
        "requirements": ["breaking_load"],  # of all that the study asks for, these are drawn
        "probability": found.chosen.probability,
        "confidence": _confidence(found.chosen),
        "not_held": found.chosen.not_held,
        "utilisation": _utilisation(found),
        "inputs": [_input(found, name) for name in found.spreads],
        "shares": found.shares,
        "shares_reason": found.why_no_shares or None,
        "sizes": [_size(one) for one in found.sizes],
        "samples": found.samples,
        "share_points": found.points,
        "seed": found.seed,
        "poses": found.poses,
        "searched": found.checked,
    }


def _confidence(one: SizeOdds) -> Json:
    low, high = one.probability_95
    return {"level": CONFIDENCE, "low": low, "high": high}


def _size(one: SizeOdds) -> Json:
    return {
        "grade": one.candidate.grade.id,
        "size_id": one.candidate.size.id,
        "probability": one.probability,
        "confidence": _confidence(one),
        "not_held": one.not_held,
    }


def _utilisation(found: UncertaintyAnalysis) -> Json:
    """Return what is stated, and of the draws what they have in common; infinite where not held."""
    used = found.chosen.utilisation
    held = used[np.isfinite(used)]
    return {
        "stated": found.chosen.candidate.verification.utilisation,
        "mean": held.mean() if len(held) else np.nan,
        "standard_deviation": held.std() if len(held) else np.nan,
        **{name: np.percentile(used, at, method="higher") for name, at in _PERCENTILES.items()},
        "largest": used.max(),
    }


def _input(found: UncertaintyAnalysis, name: Input) -> Json:
    spread = found.spreads[name]
    if isinstance(spread, Normal):
        shape: Json = {"distribution": "normal", "standard_deviation": spread.standard_deviation}
    else:
        shape = {"distribution": "uniform", "low": spread.low, "high": spread.high}
    of_grade = name == "modulus" and found.is_modulus_of_grade
    unit = "m" if name == "exit_points" else ""
    return {"input": name, **shape, "unit": unit, "from": "grade" if of_grade else "study"}
