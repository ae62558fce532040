"""The load cases: what each changes, and what the chosen rope meets in it, for the template."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from designer.analysis.analyse import Analysis
from designer.report.phrases import warmer
from designer.selection.candidate import Candidate
from designer.selection.samples import FEW_SAMPLES
from designer.statics.cable_loss import Fate
from designer.study import Study


def load_cases(analysis: Analysis) -> Mapping[str, object] | None:
    """What the chosen rope meets in each load case; None where the study has none."""
    study, selection = analysis.study, analysis.selection
    needs = analysis.needs
    if not needs and (not study.load_cases or selection is None):
        return None
    chosen = None if selection is None or needs else selection.chosen
    return {
        "needs": needs,
        "chosen": chosen,
        "leaves_out": study.workspace is not None and study.workspace.hangs_below == "exclude",
        "losses": [] if chosen is None else [*_losses(chosen)],
        "few_samples": FEW_SAMPLES,
        "temperature_change_K": _largest_change_K(study),
        "expansion": None if chosen is None else _expansion(study, chosen),
    }


def _largest_change_K(study: Study) -> float:
    return max((abs(case.temperature_change_K or 0.0) for case in study.load_cases), default=0.0)


def _losses(chosen: Candidate) -> Iterator[Mapping[str, object]]:
    """Yield what becomes of the platform at the worst pose of each case that keeps lengths."""
    for found in chosen.cases:
        loss = found.loss
        if loss is None:
            continue
        fate, is_lost = Fate(int(loss.fate[0])), found.loaded.lost_cable is not None
        moves = fate is Fate.RESTS_ELSEWHERE or (fate is Fate.HOLDS and not is_lost)
        yield {
            "case": found.case.name,
            "cable": found.loaded.lost_cable,
            "warmer": warmer(found.case) if found.case.temperature_change_K else "",
            "fate": (Fate.RESTS_ELSEWHERE if moves else fate).words,
            "moved_m": float(loss.moved_m[0]) if moves else None,
            "rest_m": loss.rest.position_m[0],
        }


def _expansion(study: Study, chosen: Candidate) -> Mapping[str, object] | None:
    """Return how the cables grow, by which source; None where no temperature changes."""
    cases = [case for case in study.load_cases if case.temperature_change_K]
    if not cases:
        return None
    cable, given = chosen.cable, cases[0].expansion_per_K
    per_K = cable.expansion_per_K if given is None else given
    source = "steel" if chosen.grade.thermal_expansion is None else "table"
    longest_m = float(chosen.verification.longest_m.max())
    return {
        "per_K": per_K,
        "source": source if given is None else "study",
        "is_fibre": chosen.grade.material_class == "fibre",
        "paid_out_m": abs(per_K) * _largest_change_K(study) * longest_m,
    }
