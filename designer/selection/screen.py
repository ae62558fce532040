"""Which candidates meet what a study asks for beside strength.

The best candidate is evaluated in full. Where it comes nearest to failing, the others are evaluated
as well: that is quick, and what fails there is rejected for good.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from designer.model.verdict import Requirement, State
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
from designer.selection.spooling import spooling_of
from designer.study import Selection


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
