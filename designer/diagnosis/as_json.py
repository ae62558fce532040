"""What ``diagnosis.json`` holds of a diagnosis, and of a check."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from designer import __version__
from designer.arrays import FloatArray
from designer.diagnosis.errors_of import Error, Outlier
from designer.documents.formats import DIAGNOSIS_FORMAT
from designer.documents.plain import plain, record
from designer.model.measured_data import Measured
from designer.study import DeclaredEffect, Study

if TYPE_CHECKING:
    from designer.diagnosis.check import Check
    from designer.diagnosis.result import Diagnosis
    from designer.diagnosis.structure import Structure

Json = dict[str, Any]


def diagnosis_dict(diagnosis: Diagnosis) -> Json:
    """Return everything that ``diagnosis.json`` holds; a missing number is None."""
    left_in, noise = diagnosis.left_in, diagnosis.noise
    before, after = diagnosis.stages[0], diagnosis.final
    answer = {
        "verdict": diagnosis.verdict,
        "rows": {
            "fit": int((~diagnosis.heldout).sum()),
            "heldout": int(diagnosis.heldout.sum()),
            **_rows(diagnosis.outliers, diagnosis.measured),
        },
        "effects": diagnosis.findings,
        "withdrawn": diagnosis.withdrawn,
        "left_out": diagnosis.study.known_effects.problems,
        "skipped": _reasons(diagnosis.skipped),
        "unknown": diagnosis.given,
        "not_plausible": diagnosis.doubts,
        "unexplained": {
            **_structure(diagnosis.structure_after),
            "reading": left_in and left_in.reading,
            "rows": left_in.rows if left_in else [],
        },
        "scatter": {"present": diagnosis.is_scattered, **diagnosis.scatter},
        "error": {
            "length_m": _before_after(before.length_m, after.length_m, noise.length_m),
            "tension_N": _before_after(before.tension_N, after.tension_N, noise.tension_N),
        },
        "forward": {"before": diagnosis.foretold_before, "after": diagnosis.foretold_after},
        "noise": {"source": noise.source},
        "stages": diagnosis.stages,
        "search": {"is_complete": not diagnosis.not_tried, "not_tried": diagnosis.not_tried},
        "balance": _balance(diagnosis.imbalance),
        "proposals": diagnosis.proposals,
        "design": {
            "before": diagnosis.design_before,
            "after": diagnosis.design_after,
            "kept": diagnosis.kept,
            "mounted": {"before": diagnosis.mounted_before, "after": diagnosis.mounted_after},
        },
    }
    return _framed(answer, diagnosis.study, diagnosis.measured)


def check_dict(check: Check) -> Json:
    """Return what ``diagnosis.json`` holds of a check; a missing number is None."""
    names = {"without": check.without, "with": check.declared, "unknowns_fitted": check.fitted}
    models = {name: model for name, model in names.items() if model is not None}

    def of_each(attribute: str) -> Json | None:
        values = {name: getattr(model, attribute) for name, model in models.items()}
        return values if any(value is not None for value in values.values()) else None

    answer = {
        "rows": {
            "all": check.measured.n_rows,
            "compared": check.n_compared,
            "not_held": of_each("n_not_held"),
            **_rows(check.outliers, check.measured),
        },
        "check": {
            "length_m": of_each("length_m"),
            "tension_N": of_each("tension_N"),
            "forward": of_each("foretold"),
            "helps": check.helps,
            "stands": check.is_positive,
        },
        "effects": effects_table(check.study.effects),
        "idle": _reasons(check.idle),
        "unexplained": _structure(check.structure),
        "noise": check.noise,
    }
    return _framed(answer, check.study, check.measured)


def effects_table(declared: Sequence[DeclaredEffect]) -> Json:
    """Return the table ``effects`` of a config: by id; those of single cables become lists."""
    answer: Json = {}
    for effect in declared:
        values: Json = {name: float(value) for name, value in effect.parameters.items()}
        if effect.cable is None:
            answer[effect.id] = values
        else:
            answer.setdefault(effect.id, []).append({"cable": effect.cable, **values})
    return answer


def _framed(answer: Json, study: Study, measured: Measured) -> Json:
    """Return an answer between what every such file begins and ends with."""
    provenance = {
        "version": __version__,
        "config_sha256": study.source.sha256,
        "data_sha256": measured.sha256,
    }
    head = {"format": DIAGNOSIS_FORMAT, "name": study.name}
    return plain({**head, **answer, "provenance": provenance})


def _rows(outliers: Sequence[Outlier], measured: Measured) -> Json:
    poses = "measured" if measured.has_poses else "estimated"
    return {"outliers": outliers, "notes": measured.notes, "poses": poses}


def _structure(structure: Structure) -> Json:
    return {"present": structure.is_present, **record(structure)}


def _reasons(effects: Sequence[tuple[str, str]]) -> list[Json]:
    return [{"id": key, "reason": reason} for key, reason in effects]


def _before_after(before: Error | None, after: Error | None, noise: float) -> Json | None:
    if before is None or after is None:
        return None
    return {"before": before, "after": after, "noise": noise}


def _balance(imbalance: FloatArray | None) -> Json | None:
    """Return how far poses are from balance, over the weight, where cables let them sway."""
    if imbalance is None:
        return None
    held = imbalance[~np.isnan(imbalance)]
    return {
        "left_median": np.median(held) if held.size else None,
        "left_largest": held.max() if held.size else None,
        "rows_not_held": imbalance.size - held.size,
    }
