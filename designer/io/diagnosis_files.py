"""Files of a diagnosis: ``diagnosis.json``, and the config with what was found."""

from __future__ import annotations

import io
import json
import math
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from designer import __version__
from designer.analysis.selection_json import finite
from designer.diagnosis.check import Check, Left, Model
from designer.diagnosis.design import declared_by
from designer.diagnosis.result import (
    Choice,
    Diagnosis,
    Error,
    Finding,
    Foretold,
    Interval,
    Outlier,
    Proposal,
    Use,
    Withdrawn,
)
from designer.diagnosis.structure import Structure
from designer.documents.formats import DIAGNOSIS_FORMAT
from designer.model.measured_data import Measured
from designer.study import DeclaredEffect, Study

Json = dict[str, Any]


def diagnosis_dict(diagnosis: Diagnosis) -> Json:
    """Return everything that ``diagnosis.json`` holds; a missing number is None."""
    return {
        "format": DIAGNOSIS_FORMAT,
        "name": diagnosis.study.name,
        "verdict": diagnosis.verdict.value,
        "rows": _rows(diagnosis),
        "effects": [_finding(finding) for finding in diagnosis.findings],
        "withdrawn": [_withdrawn(one) for one in diagnosis.withdrawn],
        "left_out": list(diagnosis.study.known_effects.problems),
        "skipped": [{"id": key, "reason": reason} for key, reason in diagnosis.skipped],
        "unknown": [
            {"id": s.effect.id, "cable": s.effect.cable, "values": dict(s.values)}
            for s in diagnosis.given
        ],
        "not_plausible": list(diagnosis.doubts),
        "unexplained": {**_structure(diagnosis.structure_after), **_where(diagnosis)},
        "scatter": {"present": diagnosis.is_scattered, **diagnosis.scatter},
        "error": _errors(diagnosis),
        "forward": {
            "before": _foretold(diagnosis.foretold_before),
            "after": _foretold(diagnosis.foretold_after),
        },
        "noise": {"source": diagnosis.noise.source},
        "stages": [
            {"label": s.label, "length_m": _error(s.length_m), "tension_N": _error(s.tension_N)}
            for s in diagnosis.stages
        ],
        "search": {
            "is_complete": not diagnosis.not_tried,
            "not_tried": list(diagnosis.not_tried),
        },
        "balance": _balance(diagnosis),
        "proposals": [_proposal(one) for one in diagnosis.proposals],
        "design": {
            "before": _choice(diagnosis.design_before),
            "after": _choice(diagnosis.design_after),
            "kept": _use(diagnosis.kept),
            "mounted": {
                "before": _use(diagnosis.mounted_before),
                "after": _use(diagnosis.mounted_after),
            },
        },
        "provenance": _provenance(diagnosis.study, diagnosis.measured),
    }


def check_dict(check: Check) -> Json:
    """Return what ``diagnosis.json`` holds of a check; a missing number is None."""
    models = {"without": check.without, "with": check.declared, "unknowns_fitted": check.fitted}
    return {
        "format": DIAGNOSIS_FORMAT,
        "name": check.study.name,
        "rows": {
            "all": check.measured.n_rows,
            "compared": check.n_compared,
            "not_held": {name: model.n_not_held for name, model in models.items() if model},
            "outliers": [_outlier(one) for one in check.outliers],
            "notes": list(check.measured.notes),
        },
        "check": {
            "length_m": _by_model(models, lambda model: _left(model.length_m)),
            "tension_N": _by_model(models, lambda model: _left(model.tension_N)),
            "forward": _by_model(models, lambda model: _foretold(model.foretold)),
            "helps": check.helps,
            "stands": check.is_positive,
        },
        "effects": effects_table(check.study.effects),
        "idle": [{"id": key, "reason": reason} for key, reason in check.idle],
        "unexplained": _structure(check.structure),
        "noise": {
            "length_m": check.noise.length_m,
            "tension_N": check.noise.tension_N,
            "source": check.noise.source,
        },
        "provenance": _provenance(check.study, check.measured),
    }


def json_text(answer: Json) -> str:
    """Return the text of ``diagnosis.json``."""
    return json.dumps(finite(answer), indent=1, allow_nan=False) + "\n"


def diagnosis_text(diagnosis: Diagnosis) -> str:
    """Return `diagnosis_dict` as JSON text."""
    return json_text(diagnosis_dict(diagnosis))


def _by_model(
    models: Mapping[str, Model | None], shown: Callable[[Model], Json | None]
) -> Json | None:
    """Return one thing of each model; None where it was not measured."""
    found = {name: shown(model) for name, model in models.items() if model is not None}
    return None if all(one is None for one in found.values()) else found


def _left(left: Left | None) -> Json | None:
    if left is None:
        return None
    return {
        "rms": _number(left.rms.value),
        "interval": [_number(left.rms.low), _number(left.rms.high)],
        "median": _number(left.median),
    }


def _provenance(study: Study, measured: Measured) -> Json:
    return {
        "version": __version__,
        "config_sha256": study.source.sha256,
        "data_sha256": measured.sha256,
    }


def diagnosed_config(diagnosis: Diagnosis, folder: Path) -> str:
    """Return the text of the config with the whole model in it.

    What was fitted and what was found go under ``effects``, noise that was estimated under
    ``measurements.noise``. Comments and order are kept. Paths in it, which are relative to the
    config, are rewritten for a config that lies in ``folder``.
    """
    from ruamel.yaml import YAML

    source = diagnosis.study.source.path
    yaml = YAML()
    yaml.width = 100
    document = yaml.load(source.read_text(encoding="utf-8-sig"))
    document["effects"] = effects_table(declared_by(diagnosis))
    document.yaml_set_comment_before_after_key("effects", before=_origin(diagnosis))
    if estimated := _estimated_noise(diagnosis):
        noise = document["measurements"].setdefault("noise", {})
        noise.update({**estimated, "estimated": list(estimated)})
    _move_paths(document, source.parent, folder)
    assert diagnosis.study.measurements is not None
    data = diagnosis.study.measurements.file.resolve()  # not always the one that the config names
    document["measurements"]["file"] = Path(os.path.relpath(data, folder.resolve())).as_posix()
    text = io.StringIO()
    yaml.dump(document, text)
    return text.getvalue()


def _origin(diagnosis: Diagnosis) -> str:
    """Return where the effects come from, for whoever reads the config later."""
    measured = diagnosis.study.measurements
    assert measured is not None
    told = [f"From the diagnosis of {measured.file.name}, SHA-256 {diagnosis.measured.sha256[:16]}"]
    for kind, scale, unit in (("length", 1e3, "mm"), ("tension", 1.0, "N")):
        first, last = (
            stage.length_m if kind == "length" else stage.tension_N
            for stage in (diagnosis.stages[0], diagnosis.final)
        )
        if first is not None and last is not None:
            was, now = scale * first.heldout.value, scale * last.heldout.value
            told.append(f"{kind} error on unseen rows {was:.3g} -> {now:.3g} {unit}")
    return "; ".join(told)


def _estimated_noise(diagnosis: Diagnosis) -> dict[str, float]:
    """Return the noise that nobody declared, of readings that there are."""
    declared, measured, noise = diagnosis.study.measurements, diagnosis.measured, diagnosis.noise
    assert declared is not None
    kinds = {
        "length": (declared.length_noise_m, measured.length_m, noise.length_m),
        "tension": (declared.tension_noise_N, measured.tension_N, noise.tension_N),
    }
    return {
        kind: float(size)
        for kind, (given, readings, size) in kinds.items()
        if (given is None or kind in declared.estimated_noise) and np.isfinite(readings).any()
    }


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


def _move_paths(document: Any, old: Path, new: Path) -> None:
    def moved(path: str) -> str:
        return Path(os.path.relpath((old / path).resolve(), new.resolve())).as_posix()

    if document.get("catalogues"):
        document["catalogues"] = [moved(path) for path in document["catalogues"]]


def _rows(diagnosis: Diagnosis) -> Json:
    return {
        "fit": int((~diagnosis.heldout).sum()),
        "heldout": int(diagnosis.heldout.sum()),
        "outliers": [_outlier(one) for one in diagnosis.outliers],
        "notes": list(diagnosis.measured.notes),
    }


def _outlier(outlier: Outlier) -> Json:
    return {"row": outlier.row, "reading": outlier.channel, "size": _number(outlier.size)}


def _balance(diagnosis: Diagnosis) -> Json | None:
    """Return how far poses are from balance, over the weight, where cables let them sway."""
    left = diagnosis.imbalance
    if left is None:
        return None
    held = left[~np.isnan(left)]
    return {
        "left_median": _number(float(np.median(held))) if held.size else None,
        "left_largest": _number(float(held.max())) if held.size else None,
        "rows_not_held": int(left.size - held.size),
    }


def _withdrawn(withdrawn: Withdrawn) -> Json:
    return {
        "id": withdrawn.effect,
        "reason": withdrawn.reason.name.lower(),
        "detail": withdrawn.detail,
        "covariate": withdrawn.covariate or None,
        "variation": _number(withdrawn.variation),
        "heldout_gain": _number(withdrawn.gain),
        "heldout_gain_std": _number(withdrawn.gain_std),
    }


def _where(diagnosis: Diagnosis) -> Json:
    place = diagnosis.left_in
    return {"reading": place and place.reading, "rows": list(place.rows) if place else []}


def _structure(structure: Structure) -> Json:
    strongest = structure.carriers[0] if structure.carriers else None
    return {
        "present": structure.is_present,
        "strongest_covariate": strongest.name if strongest else None,
        "fraction_of_variance": _number(strongest.fraction_of_variance) if strongest else None,
        "chance": _number(strongest.chance) if strongest else None,
        "events": [
            {"text": e.text, "fraction_of_variance": _number(e.fraction_of_variance)}
            for e in structure.events
        ],
        "rows_alike": structure.lasting.rows,
    }


def _errors(diagnosis: Diagnosis) -> Json:
    before, after, noise = diagnosis.stages[0], diagnosis.final, diagnosis.noise
    return {
        "length_m": _before_after(before.length_m, after.length_m, noise.length_m),
        "tension_N": _before_after(before.tension_N, after.tension_N, noise.tension_N),
    }


def _proposal(proposal: Proposal) -> Json:
    return {
        "found": proposal.found,
        "rival": proposal.rival,
        "poses": proposal.positions_m.tolist(),
        "separation": [_number(float(x)) for x in proposal.separation],
    }


def _finding(finding: Finding) -> Json:
    return {
        "id": finding.effect.id,
        "cable": finding.effect.cable,
        "summary": finding.effect.summary,
        "parameters": {
            name: {"value": _number(estimate.value), "std": _number(estimate.std)}
            for name, estimate in finding.parameters.items()
        },
        "rivals": list(dict.fromkeys(rival.split(" of cable ")[0] for rival in finding.rivals)),
        "rival_keys": list(finding.rivals),
        "heldout_gain": _number(finding.heldout_gain),
        "heldout_gain_std": _number(finding.heldout_gain_std),
        "warnings": list(finding.warnings),
    }


def _before_after(before: Error | None, after: Error | None, noise: float) -> Json | None:
    if before is None or after is None:
        return None
    return {"before": _error(before), "after": _error(after), "noise": _number(noise)}


def _error(error: Error | None) -> Json | None:
    if error is None:
        return None
    return {
        "rms": _number(error.rms),
        "heldout_rms": _number(error.heldout.value),
        "heldout_interval": [_number(error.heldout.low), _number(error.heldout.high)],
        "heldout_rms_of_cable": [_number(float(x)) for x in error.heldout_of_cable],
    }


def _foretold(foretold: Foretold | None) -> Json | None:
    if foretold is None:
        return None
    return {
        "rows": foretold.n_rows,
        "solved": foretold.n_solved,
        "position_m": _interval(foretold.position_m),
        "turn_rad": _interval(foretold.turn_rad),
        "tension_N": _interval(foretold.tension_N),
    }


def _interval(interval: Interval | None) -> Json | None:
    if interval is None:
        return None
    return {
        "rms": _number(interval.value),
        "interval": [_number(interval.low), _number(interval.high)],
    }


def _choice(choice: Choice | None) -> Json | None:
    if choice is None:
        return None
    return {
        "grade": choice.grade,
        "size_id": choice.size_id,
        "diameter_m": _number(choice.diameter_m),
        "max_tension_N": _number(choice.max_tension_N),
        "optimum_m": _number(choice.optimum_m),
        "optimum_tension_N": _number(choice.optimum_tension_N),
        "utilisation": _number(choice.utilisation),
    }


def _use(use: Use | None) -> Json | None:
    if use is None:
        return None
    return {
        "max_tension_N": _number(use.max_tension_N),
        "utilisation": _number(use.utilisation),
        "holds": use.utilisation <= 1.0,
    }


def _number(value: float) -> float | None:
    return value if math.isfinite(value) else None
