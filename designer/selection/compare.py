"""Which of the candidates counts: holds, is not dominated, decides; and why the others do not."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from designer.arrays import BoolArray, FloatArray
from designer.grades.grade import Grade, Size
from designer.model.cable import Cable
from designer.model.load_case import STATIC
from designer.model.requirement import Requirement
from designer.selection.cases import CaseFound, governing
from designer.selection.objectives import MEANINGS, Figures
from designer.selection.result import Standing
from designer.selection.verify import Sampled, Verification
from designer.study import Objective


@dataclass(slots=True, eq=False)
class Entry:
    """A candidate on its way, see `designer.selection.result.Candidate`: what is known grows.

    ``verification`` is what it meets over the samples, until it has been searched between them;
    ``cases`` the same in each direction of each load case; ``rejected_by`` a requirement beside
    strength that it is known to fail.
    """

    grade: Grade
    size: Size
    cable: Cable
    efficiency: float
    cases: tuple[CaseFound, ...]
    verification: Verification
    figures: Figures
    rejected_by: Requirement | None = None

    @property
    def sampled(self) -> Sampled:
        """What it meets over the samples in the load case that governs."""
        return governing(self.cases).sampled

    @property
    def in_case(self) -> str:
        """That case, as it ends a sentence; empty where the study has none."""
        case = governing(self.cases).case
        return "" if case is STATIC else f" in the load case '{case.name}'"

    @property
    def name(self) -> str:
        return f"{self.size.id} of {self.grade.id}"

    def key(self, objectives: Sequence[Objective]) -> tuple[float, ...]:
        """Sort by the objective that decides; then by the others, in their order."""
        return (*(self.figures.burden(o) for o in objectives), self.figures.mass_kg)


Search = Callable[[Entry], Verification]
"""Searches between the samples."""


def settle(
    entries: Sequence[Entry], objectives: Sequence[Objective], search: Search
) -> list[Entry]:
    """Return the Pareto set, the best first, each member searched between the samples.

    The search can only raise tensions and lengths, and what it raises is compared again. Searched
    are the members of the set, the best of each grade, and whoever is near its limit; for the
    others the samples are enough, since nothing depends on them.
    """
    pending = True
    while pending:
        holding = [e for e in entries if may_win(e, objectives)]
        front = [holding[k] for k in np.flatnonzero(is_undominated(burdens(holding, objectives)))]
        pending = _search_all(front, search)
    for grade in dict.fromkeys(entry.grade for entry in entries):
        best_of([e for e in entries if e.grade is grade], objectives, search)
    held = (e for e in entries if e.verification.holds)
    near_limit = [e for e in held if e.verification.utilisation > 0.9]
    _search_all(near_limit, search)
    return sorted(front, key=lambda e: e.key(objectives))


def best_of(
    entries: Sequence[Entry], objectives: Sequence[Objective], search: Search
) -> Entry | None:
    """Return the best entry that holds between the samples as well."""
    while True:
        holding = [e for e in entries if may_win(e, objectives)]
        best = min(holding, key=lambda e: e.key(objectives), default=None)
        if best is None or not _search_all([best], search):
            return best


def burdens(entries: Sequence[Entry], objectives: Sequence[Objective]) -> FloatArray:
    """Return what is compared (n, n_objectives); less is better."""
    values = [[e.figures.burden(o) for o in objectives] for e in entries]
    return np.array(values, dtype=np.float64).reshape(len(entries), len(objectives))


def is_undominated(burdens: FloatArray) -> BoolArray:
    """Tell which rows (n,) of burdens (n, n_objectives) no other row dominates.

    A row dominates another one if it is nowhere greater and somewhere less; less is better.
    """
    return np.array([dominator_of(row, burdens) is None for row in burdens], dtype=np.bool_)


def dominator_of(row: FloatArray, others: FloatArray) -> int | None:
    """Return the row of ``others`` (n, n_objectives) that dominates, None where none does.

    Of several, the one that is best in the first objective.
    """
    dominates = np.all(others <= row, axis=1) & np.any(others < row, axis=1)
    at = np.flatnonzero(dominates)
    return int(at[np.argmin(others[at, 0])]) if len(at) else None


def standing_of(
    entry: Entry, front: Sequence[Entry], objectives: Sequence[Objective]
) -> tuple[Standing, str]:
    """Return what became of an entry, and why."""
    found, best = entry.verification, front[0] if front else None
    worst = f"({', '.join(f'{x:.4g}' for x in found.worst_place[:3])}) m{entry.in_case}"
    if entry.sampled.not_held or np.isinf(found.utilisation):
        why = "in every sample a cable hangs below the platform"
        return "not_held", f"no equilibrium was found at {worst}" if entry.sampled.not_held else why
    if not found.holds:
        least = "" if entry.sampled.is_complete else "at least "
        percent = f"{least}{100.0 * found.utilisation:.4g} %"
        return "too_thin", f"meets {percent} of its allowable tension at {worst}"
    failed = None if entry.rejected_by is None else failure_words(entry.rejected_by)
    if failed is not None and entry is not best:
        return "rejected", failed
    if not may_win(entry, objectives):
        return "not_comparable", f"its {MEANINGS[objectives[0]].word} is not known"
    if best is not None and entry in front:
        return _standing_in_front(entry, best, objectives, failed)
    number = dominator_of(burdens([entry], objectives)[0], burdens(front, objectives))
    assert number is not None  # else it would be in the set
    at = "the samples" if all(one.is_whole for one in entry.cases) else "the samples tried first"
    unsearched = "" if found.is_refined else f"; holds at {at}, not searched between them"
    return "dominated", f"dominated by {front[number].name}{unsearched}"


def _standing_in_front(
    entry: Entry, best: Entry, objectives: Sequence[Objective], failed: str | None
) -> tuple[Standing, str]:
    if entry is best:
        words = f"best in {MEANINGS[objectives[0]].title}"
        return "chosen", words if failed is None else f"{words} of what is strong enough; {failed}"
    ours, theirs = entry.figures, best.figures
    better = [MEANINGS[o].title for o in objectives if ours.burden(o) < theirs.burden(o)]
    than = f"better than the chosen one in {' and '.join(better)}"
    return "undominated", than if better else "as good as the chosen one"


def failure_words(requirement: Requirement) -> str:
    """Return which requirement a candidate fails and by how much, for the reader of a report."""
    case = "" if requirement.load_case in ("all", STATIC.name) else f" in '{requirement.load_case}'"
    return f"{requirement.title.lower()}{case} {requirement.words}"


def may_win(entry: Entry, objectives: Sequence[Objective]) -> bool:
    """Tell whether an entry holds and has the figure by which candidates are compared."""
    return entry.verification.holds and np.isfinite(entry.figures.burden(objectives[0]))


def _search_all(entries: Sequence[Entry], search: Search) -> bool:
    """Search for all that were not searched for yet; tell whether there were any."""
    fresh = [e for e in entries if not e.verification.is_refined]
    for entry in fresh:
        before_m = entry.verification.longest_m.sum()
        entry.verification = found = search(entry)
        longer = found.longest_m.sum() / before_m
        entry.figures = replace(
            entry.figures,
            mass_kg=entry.figures.mass_kg * longer,
            cost=entry.figures.cost * longer,
            max_tension_N=found.max_tension_N,
        )
    return bool(fresh)
