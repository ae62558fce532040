"""The choice of a rope: what the template gets of what was chosen, and of all that was tried."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence

from designer.analysis.analyse import Analysis
from designer.grades.grade import TRUST_MEANING
from designer.report import format as fmt
from designer.report.document import MOST_ROWS
from designer.report.figures.charts_selection import rank
from designer.selection.candidate import Candidate, Standing
from designer.selection.objectives import MEANINGS
from designer.selection.result import GradeOutcome, SelectionResult

Context = Mapping[str, object]

_MOST_NAMES = 3
_EXCLUDED: tuple[Standing, ...] = ("dominated", "too_thin", "not_held", "not_comparable")


def selection(analysis: Analysis) -> Context | None:
    """What was chosen and tried; None if the study asks for no rope."""
    result = analysis.selection
    if result is None:
        return None
    tried, meanings = result.candidates, [MEANINGS[o] for o in result.objectives]
    best, alternatives = _best(result, result.outcomes), _best(result, result.alternatives)
    of_materials = result.best_of_materials(analysis.own_material)
    trusts = {outcome.grade.trust for outcome in result.outcomes}
    return {
        "selection": result,
        "titles": [meaning.title for meaning in meanings],
        "first": meanings[0],
        "less_is_better": not any(meaning.more_is_better for meaning in meanings),
        "fitting": sum(outcome.outcome == "fits" for outcome in result.outcomes),
        "holding": sum(c.verification.holds for c in tried),
        "at_first": max(
            (
                case.sampled.samples
                for c in tried
                for case in c.cases
                if c.verification.holds and not case.sampled.is_complete
            ),
            default=None,
        ),
        "trust_meaning": TRUST_MEANING,
        "trusts": [letter for letter in TRUST_MEANING if letter in trusts],
        "front_form": _form(result.front),
        "has_cases": any(
            len({case.case.name for case in c.cases}) > 1 for c in result.front[:MOST_ROWS]
        ),
        "best": best,
        "best_form": _form(best),
        "of_materials": of_materials,
        "of_materials_form": _form(of_materials),
        "alternatives": alternatives,
        "alternatives_form": _form(alternatives),
        "thin": [outcome for outcome in rank(result.outcomes) if outcome.best is None],
        "excluded": list(_excluded(result)),
        "not_tried": list(_not_tried(result)),
        "dominating": _dominating(result),
        "most_names": _MOST_NAMES,
        "searched": sum(c.verification.is_refined for c in tried),
    }


def _best(result: SelectionResult, outcomes: Sequence[GradeOutcome]) -> list[Candidate]:
    """Return the best size of each grade that holds, the chosen one and then the best first."""
    best = [outcome.best for outcome in outcomes if outcome.best is not None]
    objective = result.objectives[0]
    return sorted(best, key=lambda c: (c.standing != "chosen", c.figures.burden(objective)))


def _form(candidates: Sequence[Candidate]) -> Context:
    """Return the unit of forces and the decimals of numbers in a table of the first of these."""
    shown = candidates[:MOST_ROWS]
    smallest_N = min((c.verification.max_tension_N for c in shown), default=0.0)
    unit, scale = fmt.force_unit(smallest_N)
    return {
        "unit": unit,
        "scale": scale,
        "tension": fmt.decimals([smallest_N / scale], 4),
        "force": fmt.decimals(c.cable.allowable_tension_N / scale for c in shown),
        "mass": fmt.decimals(c.total_mass_kg for c in shown),
    }


def _excluded(result: SelectionResult) -> Iterator[tuple[Standing, int, int, Candidate]]:
    """Yield why sizes were excluded, how many, of how many grades, and the nearest of them."""
    for standing in _EXCLUDED:
        excluded = [c for c in result.candidates if c.standing == standing]
        if excluded:
            nearest = min(excluded, key=lambda c: c.verification.utilisation)
            yield standing, len(excluded), len({c.grade.id for c in excluded}), nearest


def _not_tried(result: SelectionResult) -> Iterator[tuple[str, int, int, str]]:
    """Yield why sizes were not solved, how many, of how many grades, and one of these."""
    for reason in dict.fromkeys(left.reason for left in result.not_tried):
        same = [left for left in result.not_tried if left.reason == reason]
        sizes = sum(1 if left.size else len(left.grade.sizes) for left in same)
        names = [*dict.fromkeys(left.grade.id for left in same)]
        yield reason, sizes, len(names), names[0]


def _dominating(result: SelectionResult) -> list[tuple[str, int]]:
    """Return who beats how many of the dominated sizes, the most first."""
    dominated = (c for c in result.candidates if c.standing == "dominated")
    names = (c.reason.split(";")[0].removeprefix("dominated by ") for c in dominated)
    return Counter(names).most_common()
