"""Which of the candidates counts: holds, is not dominated, decides; and why the others do not.

Beside strength the best candidate is evaluated in full. Where it comes nearest to failing, the
others are evaluated as well: that is quick, and what fails there is rejected for good.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from designer.arrays import BoolArray, FloatArray
from designer.model.cable import Preference
from designer.model.load_case import STATIC
from designer.model.verdict import Requirement, State
from designer.progress import Reporter
from designer.selection.candidate import MEANINGS, Candidate, Standing
from designer.selection.criteria import Criterion, Evaluation, evaluate, loads_of, strength_of
from designer.selection.reeving import drum_of, sheave_ratio_of, spooling_of
from designer.selection.verify import Verification
from designer.spelling import digits, position
from designer.study import Objective, Selection

Search = Callable[[Sequence[Candidate]], Sequence[Verification]]
"""Searches several candidates between the samples."""

AS_GOOD = 0.02
"""By how much a size may be worse in anything compared and still be as good: less than EN 12385-4
lets the diameter of a rope, and with it its mass, differ from the nominal one (0 to 5 %)."""
_VISIBLE = 5e-4  # Change of a figure that shows with one decimal of a percent
_ROUNDING_MM = 1e-6
NEAR_LIMIT = 0.9
"""Utilisation over the samples from where a search between them may well pass the limit."""


def settle(
    candidates: Sequence[Candidate],
    objectives: Sequence[Objective],
    search: Search,
    *,
    prefer: Preference = "none",
    searches_others: bool = True,
) -> list[Candidate]:
    """Return the Pareto set, the best first, each member searched between the samples.

    A size in the units to ``prefer``, of the set or not, comes first if it is worse than the
    best by `AS_GOOD` at most in each objective.

    The search can only raise tensions and lengths, and what it raises is compared again. With
    ``searches_others`` the best of each grade are searched as well, and whoever is near its limit;
    for the rest the samples are enough, since nothing depends on them.
    """
    pending = True
    while pending:
        holding = [c for c in candidates if may_win(c, objectives)]
        front = [holding[k] for k in np.flatnonzero(is_undominated(burdens(holding, objectives)))]
        pending = _search_all(front, search)
    front.sort(key=lambda candidate: candidate.key(objectives))
    while (as_good := _preferred(candidates, front, objectives, prefer)) is not None:
        if not _search_all([as_good], search):
            front = [as_good, *(c for c in front if c is not as_good)]
            break
    if not searches_others:
        return front
    of_grades = [
        [candidate for candidate in candidates if candidate.grade is grade]
        for grade in dict.fromkeys(candidate.grade for candidate in candidates)
    ]
    while _search_all([b for c in of_grades if (b := best_of(c, objectives))], search):
        pass
    holding = [c for c in candidates if c.verification.holds]
    near_limit = [c for c in holding if c.verification.utilisation > NEAR_LIMIT]
    _search_all(near_limit, search)
    return front


def _preferred(
    candidates: Sequence[Candidate],
    front: Sequence[Candidate],
    objectives: Sequence[Objective],
    prefer: Preference,
) -> Candidate | None:
    """Return the best size in these units that is as good as the best one in others, if any."""
    if not front or prefer in ("none", front[0].units):
        return None
    best = burdens(front[:1], objectives)
    in_units = [c for c in candidates if c.units == prefer and may_win(c, objectives)]
    is_as_good = (burdens(in_units, objectives) <= best + AS_GOOD * np.abs(best)).all(axis=1)
    as_good = [in_units[k] for k in np.flatnonzero(is_as_good)]
    return min(as_good, key=lambda candidate: candidate.key(objectives), default=None)


def preference_words(candidate: Candidate, objectives: Sequence[Objective]) -> str:
    """Return what a size is chosen instead of for its units, and what that costs; empty if not."""
    rival = candidate.preferred_to
    if rival is None:
        return ""
    changes = changed_figures(candidate, rival, objectives)
    return (
        f"{candidate.size.id} instead of {rival.label}{_in_mm(rival)}, as {candidate.units} sizes "
        f"are preferred: {changes}"
    )


def changed_figures(candidate: Candidate, rival: Candidate, objectives: Sequence[Objective]) -> str:
    """Return by how much a size differs from another in what is compared, in mass and in price."""
    others: set[Objective] = {"mass", "cost"}
    changes = []
    for objective in (*objectives, *sorted(others - {*objectives})):
        change = candidate.figures.value(objective) / rival.figures.value(objective) - 1.0
        if abs(change) >= _VISIBLE:
            percent = f"{100.0 * change:+.{1 if abs(change) < 1.0 else 0}f}"
            percent = percent.replace("-", "\N{MINUS SIGN}")
            changes.append(f"{percent} % {MEANINGS[objective].word}")
    return ", ".join(changes) or "no difference"


def _in_mm(candidate: Candidate) -> str:
    is_metric = candidate.units == "metric"
    return "" if is_metric else f" ({1e3 * candidate.size.diameter_m:.4g} mm)"


def best_of(candidates: Sequence[Candidate], objectives: Sequence[Objective]) -> Candidate | None:
    """Return the best candidate that holds, as far as each was searched."""
    holding = [c for c in candidates if may_win(c, objectives)]
    return min(holding, key=lambda candidate: candidate.key(objectives), default=None)


def burdens(candidates: Sequence[Candidate], objectives: Sequence[Objective]) -> FloatArray:
    """Return what is compared (n, n_objectives); less is better."""
    values = [[c.figures.burden(o) for o in objectives] for c in candidates]
    return np.array(values, dtype=np.float64).reshape(len(candidates), len(objectives))


def is_undominated(burdens: FloatArray) -> BoolArray:
    """Tell which rows (n,) of burdens (n, n_objectives) no other row dominates.

    A row dominates another one if it is nowhere greater and somewhere less; less is better.
    """
    return np.array([dominator_of(row, burdens) is None for row in burdens], dtype=np.bool_)


def dominator_of(row: FloatArray, rivals: FloatArray) -> int | None:
    """Return the row of ``rivals`` (n, n_objectives) that dominates, None where none does.

    Of several, the one that is best in the first objective.
    """
    dominates = np.all(rivals <= row, axis=1) & np.any(rivals < row, axis=1)
    at = np.flatnonzero(dominates)
    return int(at[np.argmin(rivals[at, 0])]) if len(at) else None


def standing_of(
    candidate: Candidate, front: Sequence[Candidate], objectives: Sequence[Objective]
) -> tuple[Standing, str]:
    """Return what became of a candidate, and why, for all pages and files."""
    verification, best = candidate.verification, front[0] if front else None
    worst = f"{position(verification.worst_place[:3])}{candidate.in_case}"
    if candidate.sampled.not_held or np.isinf(verification.utilisation):
        why = "in every sample a cable hangs below the platform"
        return "not_held", (
            f"no equilibrium was found at {worst}" if candidate.sampled.not_held else why
        )
    if not verification.holds:
        least = "" if candidate.sampled.is_complete else "at least "
        percent = f"{least}{digits(100.0 * verification.utilisation)} %"
        return "too_thin", f"reaches {percent} of its allowable tension at {worst}"
    failed = rejection_words(candidate)
    if failed is not None and candidate is not best:
        return "rejected", failed
    if not may_win(candidate, objectives):
        return "not_comparable", f"its {MEANINGS[objectives[0]].word} is not known"
    if candidate in front:
        return _standing_in_front(candidate, front, objectives, failed)
    number = dominator_of(burdens([candidate], objectives)[0], burdens(front, objectives))
    assert number is not None  # else it would be in the set
    candidate.dominated_by = front[number]
    is_complete = all(case.sampled.is_complete for case in candidate.cases)
    at = "the samples" if is_complete else "the samples tried first"
    unsearched = "" if verification.is_refined else f"; holds at {at}, not searched between them"
    return "dominated", f"dominated by {front[number].label}{unsearched}"


def _standing_in_front(
    candidate: Candidate,
    front: Sequence[Candidate],
    objectives: Sequence[Objective],
    failed: str | None,
) -> tuple[Standing, str]:
    best = front[0]
    if candidate is best:
        first = min(front, key=lambda c: c.key(objectives))
        best.preferred_to = None if first is best else first
        if best.preferred_to is not None:
            return "chosen", preference_words(best, objectives)
        words = f"best in {MEANINGS[objectives[0]].title}"
        return "chosen", words if failed is None else f"{words} of what is strong enough; {failed}"
    ours, theirs = candidate.figures, best.figures
    better = [MEANINGS[o].title for o in objectives if ours.burden(o) < theirs.burden(o)]
    than = f"better than the chosen one in {' and '.join(better)}"
    return "undominated", than if better else "as good as the chosen one"


def rejection_words(candidate: Candidate) -> str | None:
    """Return which requirement a candidate fails, by how much, and what would help if known."""
    failed = candidate.rejected_by
    if failed is None:
        return None
    case = "" if failed.load_case in ("all", STATIC.name) else f" in '{failed.load_case}'"
    words = f"{failed.title.lower()}{case} {failed.words}"
    if failed.id != "sheave_ratio":
        return words
    least_mm = math.ceil(1e3 * failed.demand * candidate.size.diameter_m - _ROUNDING_MM)
    return f"{words}; it would hold on sheaves of {least_mm} mm and more"


def may_win(candidate: Candidate, objectives: Sequence[Objective]) -> bool:
    """Tell whether a candidate holds and has the figure by which candidates are compared."""
    return candidate.verification.holds and math.isfinite(candidate.figures.burden(objectives[0]))


def _search_all(candidates: Sequence[Candidate], search: Search) -> bool:
    """Search for all that were not searched for yet; tell whether there were any."""
    fresh = [c for c in candidates if not c.verification.is_refined]
    for candidate, verification in zip(fresh, search(fresh) if fresh else (), strict=True):
        before_m = candidate.verification.longest_m.sum()
        candidate.verification = verification
        longer = verification.longest_m.sum() / before_m
        candidate.figures = replace(
            candidate.figures,
            mass_kg=candidate.figures.mass_kg * longer,
            cost=candidate.figures.cost * longer,
            max_tension_N=verification.max_tension_N,
        )
    return bool(fresh)


@dataclass(frozen=True, slots=True)
class Screen:
    """What all candidates are held against; keeps the evaluations of those that were best."""

    criteria: Sequence[Criterion]
    selection: Selection
    reporter: Reporter
    _evaluations: dict[Candidate, tuple[Evaluation, ...]] = field(default_factory=dict)

    def rejects_any(
        self, best: Candidate, front: Sequence[Candidate], meeting: Sequence[Candidate]
    ) -> bool:
        """Evaluate the best candidate in full, and others where it comes nearest to failing.

        All ``meeting`` at the places where it fails; where it fails nowhere, those of the ``front``
        at all places. Tells whether any was rejected.
        """
        requirements = self.evaluated(best)
        best.rejected_by = next((r for r in requirements if not r.holds), None)
        evaluations = self._evaluations[best]
        failing = [e for e in evaluations if e.requirement.state is State.FAILS]
        evaluated_at = meeting if best.rejected_by is not None else front
        for candidate in evaluated_at:
            if candidate.rejected_by is None and candidate.verification.holds:
                which = failing if best.rejected_by is not None else evaluations
                candidate.rejected_by = next(self._failures(candidate, which), None)
        return any(candidate.rejected_by is not None for candidate in (best, *evaluated_at))

    def _failures(
        self, candidate: Candidate, evaluations: Sequence[Evaluation]
    ) -> Iterator[Requirement]:
        for drum in self._drums(candidate):
            if not drum.holds:
                yield drum
        for evaluation in evaluations:
            case = evaluation.loads.case
            loaded = next(
                (result.loaded for result in candidate.cases if result.case is case), None
            )
            at_place = None if loaded is None else evaluation.on(*loaded.bare)
            if at_place is not None and at_place.state is State.FAILS:
                yield at_place

    def _drums(self, candidate: Candidate) -> Iterator[Requirement]:
        lengths = candidate.verification.longest_m, candidate.verification.shortest_m
        drum = candidate.governing.loaded.robot.winches.drum
        yield from drum_of(*lengths, self.selection)
        yield from spooling_of(drum, *lengths, [candidate.size.diameter_m] * len(lengths[0]))

    def evaluated(self, candidate: Candidate) -> tuple[Requirement, ...]:
        """Return what a candidate comes to beside strength and sheave, evaluated in full once."""
        if candidate not in self._evaluations:
            loads = loads_of(candidate.cases)
            with self.reporter.task("requirements", len(loads)) as advance:
                self._evaluations[candidate] = evaluate(loads, self.criteria, advance)
        evaluations = self._evaluations[candidate]
        return (
            *(evaluation.requirement for evaluation in evaluations),
            *self._drums(candidate),
        )

    def requirements(self, candidate: Candidate) -> tuple[Requirement, ...]:
        """Return all that the study asks of a candidate; nothing where it was not evaluated."""
        if candidate not in self._evaluations:
            return ()
        return (
            *strength_of(candidate.cases, self.selection),
            *sheave_ratio_of(candidate.grade, candidate.size, self.selection),
            *self.evaluated(candidate),
        )
