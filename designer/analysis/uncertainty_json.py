"""How likely a size is enough, for scripts: part of ``result.json``."""

from __future__ import annotations

from typing import Any

import numpy as np

from designer.analysis.uncertainty.uncertainty import UncertaintyAnalysis
from designer.documents.plain import record
from designer.model.uncertainty import Input, Normal

Json = dict[str, Any]

_PERCENTILES = {"p05": 5.0, "median": 50.0, "p95": 95.0}


def uncertainty_dict(uncertainty: UncertaintyAnalysis | None) -> Json | None:
    """Return probability, utilisation, sizes and shares; None where no input is uncertain."""
    if uncertainty is None:
        return None
    odds = record(uncertainty.chosen)
    return {
        "asked": uncertainty.is_asked,
        "requirements": ["breaking_load"],  # of all that the study asks for, these are drawn
        **{name: odds[name] for name in ("probability", "confidence", "not_held")},
        "utilisation": _utilisation(uncertainty),
        "inputs": [_input(uncertainty, name) for name in uncertainty.spreads],
        "shares": uncertainty.shares,
        "shares_reason": uncertainty.why_no_shares or None,
        "sizes": uncertainty.sizes,
        "samples": uncertainty.samples,
        "share_points": uncertainty.points,
        "seed": uncertainty.seed,
        "poses": uncertainty.poses,
        "searched": uncertainty.checked,
    }


def _utilisation(uncertainty: UncertaintyAnalysis) -> Json:
    """Return what is stated, and of the draws what they have in common; infinite where not held."""
    used = uncertainty.chosen.utilisation
    finite_values = used[np.isfinite(used)]
    return {
        "stated": uncertainty.chosen.candidate.verification.utilisation,
        "mean": finite_values.mean() if len(finite_values) else np.nan,
        "standard_deviation": finite_values.std() if len(finite_values) else np.nan,
        **{name: np.percentile(used, at, method="higher") for name, at in _PERCENTILES.items()},
        "largest": used.max(),
    }


def _input(uncertainty: UncertaintyAnalysis, name: Input) -> Json:
    spread = uncertainty.spreads[name]
    if isinstance(spread, Normal):
        shape: Json = {"distribution": "normal", "standard_deviation": spread.standard_deviation}
    else:
        shape = {"distribution": "uniform", "low": spread.low, "high": spread.high}
    of_grade = name == "modulus" and uncertainty.is_modulus_of_grade
    unit = "m" if name == "exit_points" else ""
    return {"input": name, **shape, "unit": unit, "from": "grade" if of_grade else "study"}
