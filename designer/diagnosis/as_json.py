"""What ``diagnosis.json`` holds of a diagnosis, and of a check."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict
from typing import TYPE_CHECKING, Any

import numpy as np

from designer import __version__
from designer.diagnosis.errors_of import Error, Interval, Outlier
from designer.documents.formats import DIAGNOSIS_FORMAT
from designer.documents.plain import finite
from designer.model.measured_data import Measured
from designer.study import DeclaredEffect, Study

if TYPE_CHECKING:
    from designer.diagnosis.check import Check, Left, Model
    from designer.diagnosis.errors_of import Foretold
    from designer.diagnosis.result import Diagnosis, Finding, Use
    from designer.diagnosis.structure import Structure

Json = dict[str, Any]


def diagnosis_dict(diagnosis: Diagnosis) -> Json:
    """Return everything that ``diagnosis.json`` holds; a missing number is None."""
    left_in = diagnosis.left_in
    answer = {
        "format": DIAGNOSIS_FORMAT,
        "name": diagnosis.study.name,
        "verdict": diagnosis.verdict.value,
        "rows": {
            "fit": int((~diagnosis.heldout).sum()),
            "heldout": int(diagnosis.heldout.sum()),
            **_rows(diagnosis.outliers, diagnosis.measured),
        },
        "effects": [_finding(finding) for finding in diagnosis.findings],
        "withdrawn": diagnosis.withdrawn,
        "left_out": diagnosis.study.known_effects.problems,
        "skipped": _reasons(diagnosis.skipped),
        "unknown": [
            {"id": s.effect.id, "cable": s.effect.cable, "values": dict(s.values)}
            for s in diagnosis.given
        ],
        "not_plausible": diagnosis.doubts,
        "unexplained": {
            **_structure(diagnosis.structure_after),
            "reading": left_in and left_in.reading,
            "rows": left_in.rows if left_in else [],
        },
        "scatter": {"present": diagnosis.is_scattered, **diagnosis.scatter},
        **_errors(diagnosis),
        "search": {"is_complete": not diagnosis.not_tried, "not_tried": diagnosis.not_tried},
        "balance": _balance(diagnosis),
        "proposals": diagnosis.proposals,
        "design": {
            "before": diagnosis.design_before,
            "after": diagnosis.design_after,
            "kept": _use(diagnosis.kept),
            "mounted": {
                "before": _use(diagnosis.mounted_before),
                "after": _use(diagnosis.mounted_after),
            },
        },
        "provenance": _provenance(diagnosis.study, diagnosis.measured),
    }
    plain: Json = finite(answer)
    return plain


def check_dict(check: Check) -> Json:
    """Return what ``diagnosis.json`` holds of a check; a missing number is None."""
    models = {"without": check.without, "with": check.declared, "unknowns_fitted": check.fitted}
    noise = check.noise
    answer = {
        "format": DIAGNOSIS_FORMAT,
        "name": check.study.name,
        "rows": {
            "all": check.measured.n_rows,
            "compared": check.n_compared,
            "not_held": {name: model.n_not_held for name, model in models.items() if model},
            **_rows(check.outliers, check.measured),
        },
        "check": {
            "length_m": _by_model(models, lambda model: _left(model.length_m)),
            "tension_N": _by_model(models, lambda model: _left(model.tension_N)),
            "forward": _by_model(models, lambda model: _foretold(model.foretold)),
            "helps": check.helps,
            "stands": check.is_positive,
        },
        "effects": effects_table(check.study.effects),
        "idle": _reasons(check.idle),
        "unexplained": _structure(check.structure),
        "noise": {"length_m": noise.length_m, "tension_N": noise.tension_N, "source": noise.source},
        "provenance": _provenance(check.study, check.measured),
    }
    plain: Json = finite(answer)
    return plain


def effects_table(declared: tuple[DeclaredEffect, ...]) -> Json:
    """Return the table ``effects`` of a config: by id; those of single cables become lists."""
    answer: Json = {}
    for effect in declared:
        values: Json = {name: float(value) for name, value in effect.parameters.items()}
        if effect.cable is None:
            answer[effect.id] = values
        else:
            answer.setdefault(effect.id, []).append({"cable": effect.cable, **values})
    return answer


def _by_model(
    models: Mapping[str, Model | None], function: Callable[[Model], Json | None]
) -> Json | None:
    """Return one thing of each model; None where it was not measured."""
    values = {name: function(model) for name, model in models.items() if model is not None}
    return None if all(value is None for value in values.values()) else values


def _rows(outliers: tuple[Outlier, ...], measured: Measured) -> Json:
    poses = "measured" if measured.has_poses else "estimated"
    return {"outliers": outliers, "notes": measured.notes, "poses": poses}


def _reasons(effects: tuple[tuple[str, str], ...]) -> list[Json]:
    return [{"id": key, "reason": reason} for key, reason in effects]


def _left(deviation: Left | None) -> Json | None:
    return None if deviation is None else {**_interval(deviation.rms), "median": deviation.median}


def _provenance(study: Study, measured: Measured) -> Json:
    return {
        "version": __version__,
        "config_sha256": study.source.sha256,
        "data_sha256": measured.sha256,
    }


def _balance(diagnosis: Diagnosis) -> Json | None:
    """Return how far poses are from balance, over the weight, where cables let them sway."""
    imbalance = diagnosis.imbalance
    if imbalance is None:
        return None
    finite_values = imbalance[~np.isnan(imbalance)]
    return {
        "left_median": float(np.median(finite_values)) if finite_values.size else None,
        "left_largest": float(finite_values.max()) if finite_values.size else None,
        "rows_not_held": int(imbalance.size - finite_values.size),
    }


def _structure(structure: Structure) -> Json:
    strongest = structure.carriers[0] if structure.carriers else None
    return {
        "present": structure.is_present,
        "strongest_covariate": strongest and strongest.name,
        "fraction_of_variance": strongest and strongest.fraction_of_variance,
        "chance": strongest and strongest.chance,
        "events": [
            {"text": e.text, "fraction_of_variance": e.fraction_of_variance}
            for e in structure.events
        ],
        "rows_alike": structure.lasting.rows,
    }


def _finding(finding: Finding) -> Json:
    return {
        "id": finding.effect.id,
        "cable": finding.effect.cable,
        "summary": finding.effect.summary,
        "parameters": {
            name: {"value": estimate.value, "std": estimate.std}
            for name, estimate in finding.parameters.items()
        },
        "rivals": list(dict.fromkeys(rival.split(" of cable ")[0] for rival in finding.rivals)),
        "rival_keys": finding.rivals,
        "heldout_gain": finding.heldout_gain,
        "heldout_gain_std": finding.heldout_gain_std,
        "warnings": finding.warnings,
    }


def _errors(diagnosis: Diagnosis) -> Json:
    noise, before, after = diagnosis.noise, diagnosis.stages[0], diagnosis.final
    return {
        "error": {
            "length_m": _before_after(before.length_m, after.length_m, noise.length_m),
            "tension_N": _before_after(before.tension_N, after.tension_N, noise.tension_N),
        },
        "forward": {
            "before": _foretold(diagnosis.foretold_before),
            "after": _foretold(diagnosis.foretold_after),
        },
        "noise": {"source": noise.source},
        "stages": [
            {"label": s.label, "length_m": _error(s.length_m), "tension_N": _error(s.tension_N)}
            for s in diagnosis.stages
        ],
    }


def _before_after(before: Error | None, after: Error | None, noise: float) -> Json | None:
    if before is None or after is None:
        return None
    return {"before": _error(before), "after": _error(after), "noise": noise}


def _error(error: Error | None) -> Json | None:
    if error is None:
        return None
    return {
        "rms": error.rms,
        "heldout_rms": error.heldout.value,
        "heldout_interval": [error.heldout.low, error.heldout.high],
        "heldout_rms_of_cable": error.heldout_of_cable.tolist(),
    }


def _foretold(foretold: Foretold | None) -> Json | None:
    if foretold is None:
        return None
    return {
        "rows": foretold.n_rows,
        "solved": foretold.n_solved,
        "position_m": _interval(foretold.position_m),
        "turn_rad": foretold.turn_rad and _interval(foretold.turn_rad),
        "tension_N": foretold.tension_N and _interval(foretold.tension_N),
    }


def _interval(interval: Interval) -> Json:
    return {"rms": interval.value, "interval": [interval.low, interval.high]}


def _use(use: Use | None) -> Json | None:
    return None if use is None else {**asdict(use), "holds": use.utilisation <= 1.0}
