"""Files of a diagnosis: ``diagnosis.json``, and the config with what was found."""

from __future__ import annotations

import io
import json
import math
import os
from pathlib import Path
from typing import Any

import numpy as np

from designer import __version__
from designer.diagnosis.design import declared_by
from designer.diagnosis.result import (
    Choice,
    Diagnosis,
    Error,
    Finding,
    Foretold,
    Interval,
    Proposal,
    Withdrawn,
)
from designer.formats import DIAGNOSIS_FORMAT
from designer.selection_json import finite
from designer.study import DeclaredEffect

Json = dict[str, Any]


def diagnosis_dict(diagnosis: Diagnosis) -> Json:
    """Return everything that ``diagnosis.json`` holds; a missing number is None."""
    return {
        "format": DIAGNOSIS_FORMAT,
        "name": diagnosis.study.name,
        "rows": _rows(diagnosis),
        "effects": [_finding(finding) for finding in diagnosis.findings],
        "withdrawn": [_withdrawn(one) for one in diagnosis.withdrawn],
        "left_out": list(diagnosis.study.known_effects.problems),
        "skipped": [{"id": key, "reason": reason} for key, reason in diagnosis.skipped],
        "unknown": [
            {"id": s.effect.id, "cable": s.effect.cable, "values": dict(s.values)}
            for s in diagnosis.given
        ],
        "unexplained": _unexplained(diagnosis),
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
        },
        "provenance": {"version": __version__, "config_sha256": diagnosis.study.source.sha256},
    }


def diagnosis_text(diagnosis: Diagnosis) -> str:
    """Return `diagnosis_dict` as JSON text."""
    return json.dumps(finite(diagnosis_dict(diagnosis)), indent=1, allow_nan=False) + "\n"


def diagnosed_config(diagnosis: Diagnosis, folder: Path) -> str:
    """Return the text of the config with the found effects under ``effects``.

    Comments and order are kept. Paths in it, which are relative to the config, are rewritten for
    a config that lies in ``folder``.
    """
    from ruamel.yaml import YAML

    source = diagnosis.study.source.path
    yaml = YAML()
    yaml.width = 100
    document = yaml.load(source.read_text(encoding="utf-8-sig"))
    document["effects"] = effects_table(declared_by(diagnosis))
    _move_paths(document, source.parent, folder)
    text = io.StringIO()
    yaml.dump(document, text)
    return text.getvalue()


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

    if "file" in (document.get("measurements") or {}):
        document["measurements"]["file"] = moved(document["measurements"]["file"])
    if document.get("catalogues"):
        document["catalogues"] = [moved(path) for path in document["catalogues"]]


def _rows(diagnosis: Diagnosis) -> Json:
    return {
        "fit": int((~diagnosis.heldout).sum()),
        "heldout": int(diagnosis.heldout.sum()),
        "outliers": [
            {"row": o.row, "reading": o.channel, "size": _number(o.size)}
            for o in diagnosis.outliers
        ],
        "notes": list(diagnosis.measured.notes),
    }


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
        "covariate": withdrawn.covariate or None,
        "variation": _number(withdrawn.variation),
    }


def _unexplained(diagnosis: Diagnosis) -> Json:
    carriers = diagnosis.structure_after.carriers
    strongest = carriers[0] if carriers else None
    return {
        "present": diagnosis.is_unexplained,
        "strongest_covariate": strongest.name if strongest else None,
        "fraction_of_variance": _number(strongest.fraction_of_variance) if strongest else None,
        "chance": _number(strongest.chance) if strongest else None,
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
    }


def _number(value: float) -> float | None:
    return value if math.isfinite(value) else None
