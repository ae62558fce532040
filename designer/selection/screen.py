"""Which candidates meet what a study asks for beside strength.

The best candidate is evaluated in full. Where it comes nearest to failing, the others are evaluated
as well: that is quick, and what fails there is rejected for good.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from designer.model.requirement import Requirement, State
from designer.progress import Reporter
from designer.selection.candidate import Candidate
from designer.selection.criteria import Criterion
from designer.selection.requirements import (
    Evaluation,
    drum_of,
    evaluate,
    loads_of,
    sheave_ratio_of,
    strength_of,
)
from designer.study import Selection


@dataclass(frozen=True, slots=True)
class Screen:
    """What all candidates are held against; keeps the evaluations of those that were best."""

    criteria: Sequence[Criterion]
    selection: Selection
    reporter: Reporter
    _evaluations: dict[int, tuple[Evaluation, ...]] = field(default_factory=dict)

    def reject_by_table(self, candidates: Sequence[Candidate]) -> None:
        """Reject what the sheave alone decides."""
        for candidate in candidates:
            ratios = sheave_ratio_of(candidate.grade, candidate.size, self.selection)
            candidate.rejected_by = next((each for each in ratios if not each.holds), None)

    def rejects_any(
        self, best: Candidate, front: Sequence[Candidate], others: Sequence[Candidate]
    ) -> bool:
        """Evaluate the best candidate in full, and others where it comes nearest to failing.

        All ``others`` at the places where it fails; where it fails nowhere, those of the ``front``
        at all places. Tells whether any was rejected.
        """
        requirements = self.evaluated(best)
        best.rejected_by = next((each for each in requirements if not each.holds), None)
        evaluations = self._evaluations[id(best.size)]
        failing = [each for each in evaluations if each.requirement.state is State.FAILS]
        tried = others if best.rejected_by is not None else front
        for candidate in tried:
            if candidate.rejected_by is None and candidate.verification.holds:
                which = failing if best.rejected_by is not None else evaluations
                candidate.rejected_by = next(self._failures(candidate, which), None)
        return any(candidate.rejected_by is not None for candidate in (best, *tried))

    def _failures(self, candidate: Candidate, where: Sequence[Evaluation]) -> Iterator[Requirement]:
        verification = candidate.verification
        for each in drum_of(verification.longest_m, verification.shortest_m, self.selection):
            if not each.holds:
                yield each
        for evaluation in where:
            case = evaluation.loads.case
            other = next((found.loaded for found in candidate.cases if found.case is case), None)
            there = None if other is None else evaluation.on(*other.bare)
            if there is not None and there.state is State.FAILS:
                yield there

    def evaluated(self, candidate: Candidate) -> tuple[Requirement, ...]:
        """Return what a candidate comes to beside strength and sheave, evaluated in full once."""
        if id(candidate.size) not in self._evaluations:
            loads = loads_of(candidate.cases)
            with self.reporter.task("requirements", len(loads)) as advance:
                self._evaluations[id(candidate.size)] = evaluate(loads, self.criteria, advance)
        lengths = candidate.verification.longest_m, candidate.verification.shortest_m
        evaluations = self._evaluations[id(candidate.size)]
        return (
            *(each.requirement for each in evaluations),
            *drum_of(*lengths, self.selection),
        )

    def requirements(self, candidate: Candidate) -> tuple[Requirement, ...]:
        """Return all that the study asks of a candidate; nothing where it was not evaluated."""
        if id(candidate.size) not in self._evaluations:
            return ()
        return (
            *strength_of(candidate.cases, self.selection),
            *sheave_ratio_of(candidate.grade, candidate.size, self.selection),
            *self.evaluated(candidate),
        )
