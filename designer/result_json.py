"""``result.json``: the results for scripts, under stable names; a missing number is null."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from designer import __version__
from designer.analysis import Analysis, PoseAnalysis
from designer.report.files import write_whole
from designer.selection.result import Candidate, GradeOutcome, SelectionResult
from designer.study import Study
from designer.verdict import Verdict
from designer.workspace.result import Extreme, WorkspaceMap

Json = dict[str, Any]


def result_dict(analysis: Analysis) -> Json:
    """Return everything that ``result.json`` holds; a part without results is None."""
    study = analysis.study
    return {
        "name": study.name,
        "positive": analysis.is_positive,
        "pose": None if analysis.pose is None else _pose(analysis.pose),
        "workspace": None if analysis.workspace is None else _workspace(analysis.workspace),
        "selection": None if analysis.selection is None else _selection(analysis.selection),
        "provenance": {
            **_origin(study),
            "catalogues": [
                {"name": source.name, "source": source.source, "grades": source.n_grades}
                for source in analysis.catalogue.sources
            ],
            "problems": list(analysis.catalogue.problems),
            "libraries": dict(analysis.provenance.libraries),
            "system": analysis.provenance.system,
            "created": analysis.provenance.created.isoformat(timespec="seconds"),
            "seed": None if study.workspace is None else study.workspace.seed,
        },
    }


def size_dict(study: Study, pose: PoseAnalysis) -> Json:
    """Return what ``designer size --json`` prints: the pose alone, under the same names."""
    return {"name": study.name, "pose": _pose(pose), "provenance": _origin(study)}


def size_text(study: Study, pose: PoseAnalysis) -> str:
    """Return `size_dict` as JSON text."""
    return _text(size_dict(study, pose))


def write_result(analysis: Analysis, path: Path) -> None:
    """Write ``result.json``, whole or not at all."""
    write_whole(path, f"{_text(result_dict(analysis))}\n".encode())


def _text(values: Mapping[str, Any]) -> str:
    return json.dumps(values, indent=2, ensure_ascii=False, allow_nan=False)


def _origin(study: Study) -> Json:
    return {"version": __version__, "config_sha256": study.source.sha256}


def _pose(pose: PoseAnalysis) -> Json:
    statics, sizing = pose.sizing.statics, pose.sizing
    diameter = _number(sizing.diameter_m)
    return {
        "position_m": _numbers(statics.poses.position_m),
        "limit_ratio": _number(pose.limit_ratio),
        "sagging": {
            "diameter_m": diameter,
            "max_tension_N": _number(statics.largest_tension_N),
            "lengths_m": _numbers(statics.length_m),
            "tensions_N": _numbers(statics.exit_tension_N),
            "platform_tensions_N": _numbers(statics.platform_tension_N),
            "forces_x_N": _numbers(statics.force_x_N),
            "forces_z_N": _numbers(statics.force_z_N),
            "hangs_below": bool(statics.hangs_below) if statics.is_solved else None,
            "closure_residual_m": _number(statics.closure_residual_m().max()),
            "equilibrium_residual_N": _number(abs(statics.equilibrium_residual_N()).max()),
            "status": Verdict(int(statics.verdict)).label,
        },
        "massless": {
            "diameter_m": _number(sizing.massless_diameter_m),
            "max_tension_N": _number(pose.massless.largest_tension_N),
        },
        "loop": {
            "converged": pose.loop.has_converged,
            "iterates": [
                {"diameter_m": i.diameter_m, "max_tension_N": i.max_tension_N}
                for i in pose.loop.iterates
            ],
        },
        "optimum": {"diameter_m": diameter},
    }


def _workspace(found: WorkspaceMap) -> Json:
    example, census = found.infeasible_example_m, found.census
    return {
        "samples": census.samples,
        "feasible": found.is_feasible,
        "reason": None if found.is_feasible else _why_infeasible(found),
        "statuses": dict(census.statuses),
        "hangs_below": census.hangs_below,
        "excluded": census.excluded,
        "fraction_no_finite_cable": census.fraction(Verdict.NO_FINITE_CABLE.label),
        "infeasible_example_m": None if example is None else _numbers(example),
        "limit_ratio": _number(found.limit_ratio),
        "sagging": _extreme(found.sagging),
        "sampled": _extreme(found.sampled),
        "massless": _extreme(found.massless),
    }


def _why_infeasible(found: WorkspaceMap) -> str:
    counts = found.census.statuses
    unserved = [v for v in Verdict if v is not Verdict.SOLVED and counts[v.label] > 0]
    if unserved:
        return " ".join(f"{counts[v.label]} samples: {v.sentence}" for v in unserved)
    if found.infeasible_example_m is None:
        return "Every pose is left out."
    return "The search between the samples met a pose without a finite cable."


def _extreme(extreme: Extreme | None) -> Json | None:
    if extreme is None:
        return None
    return {
        "diameter_m": _number(extreme.diameter_m),
        "max_tension_N": _number(extreme.max_tension_N),
        "pose": _numbers(extreme.position_m),
    }


def _selection(selection: SelectionResult) -> Json:
    fitting = [(o.best, o) for o in selection.alternatives]
    return {
        "chosen": next(
            (_candidate(c, o) for o in selection.outcomes for c in _chosen_of(selection, o)), None
        ),
        "reason": selection.reason,
        "candidates": [_candidate(c, o) for o in selection.outcomes for c in o.candidates],
        "grades": [
            {
                "grade": o.grade.id,
                "outcome": o.outcome,
                "sentence": o.sentence,
                "continuous_diameter_m": _number(o.continuous_diameter_m),
            }
            for o in selection.outcomes
        ],
        "alternatives": [_candidate(c, o) for c, o in fitting if c is not None],
    }


def _chosen_of(selection: SelectionResult, outcome: GradeOutcome) -> Iterable[Candidate]:
    return (c for c in outcome.candidates if c is selection.chosen)


def _candidate(candidate: Candidate, outcome: GradeOutcome) -> Json:
    size, found = candidate.size, candidate.verification
    return {
        "grade": candidate.grade.id,
        "size_id": size.id,
        "diameter_m": size.diameter_m,
        "continuous_diameter_m": _number(candidate.continuous_diameter_m),
        "max_tension_N": _number(found.max_tension_N),
        "utilisation": _number(found.utilisation),
        "minimum_breaking_load_N": size.minimum_breaking_load_N,
        "linear_mass_kg_per_m": size.linear_density_kg_per_m,
        "total_mass_kg": _number(candidate.total_mass_kg),
        "longest_m": _numbers(found.longest_m),
        "worst_pose": _numbers(found.worst_position_m),
        "verified": candidate.verified,
        "outcome": outcome.outcome,
        "trust": candidate.grade.trust,
        "doubt": size.doubt,
    }


def _number(value: Any) -> float | None:
    number = float(value)
    return number if math.isfinite(number) else None


def _numbers(values: Iterable[Any]) -> list[float | None]:
    return [_number(value) for value in values]
