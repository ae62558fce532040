"""All ropes that the study allows, and what becomes of each: at once at samples, or in full."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from designer.analysis.analyse import Analysis
from designer.analysis.requirements import Terms
from designer.arrays import FloatArray
from designer.explore.question import Question, Rope, RopePerCable
from designer.grades.grade import Grade, Size
from designer.model.verdict import Answer, Requirement
from designer.progress import SILENT, Reporter
from designer.proof.prove import Proof
from designer.selection.candidate import Candidate
from designer.selection.compare import burdens, is_undominated, rejection_words
from designer.selection.groups.result import GroupChoice
from designer.selection.objectives import UNKNOWN, CandidateFigures
from designer.selection.result import SelectionResult
from designer.selection.select import at_samples
from designer.selection.verify import NOT_TRIED, Verification

_QUICK_SAMPLES = 1500


@dataclass(frozen=True, slots=True, eq=False)
class RopeRow:
    """One size of one grade, and what became of it.

    Parameters
    ----------
    grade, size
        As the catalogue has them.
    reason : str
        Why it is the best, or falls out.
    standing : str
        As `designer.selection.result.Standing`, or ``not_tried``.
    allowable_tension_N : float
        With end fittings, bending and safety factor; NaN where it was not tried.
    verification, figures
        What it meets over the workspace, and what ropes are compared by.
    is_rejected : bool
        Whether it is known to fail a requirement beside strength.
    """

    grade: Grade
    size: Size
    reason: str
    standing: str = "not_tried"
    allowable_tension_N: float = math.nan
    verification: Verification = NOT_TRIED
    figures: CandidateFigures = UNKNOWN
    is_rejected: bool = False

    @property
    def rope(self) -> Rope:
        """Its names, by which it is chosen."""
        return Rope(self.grade.id, self.size.id)

    @property
    def holds(self) -> bool:
        """Whether it is strong enough and fails nothing else, as far as it was looked at."""
        return self.verification.holds and not self.is_rejected

    @property
    def place(self) -> FloatArray | None:
        """Where it is used most (6,) [m, rad]; None where that is not known."""
        place = self.verification.worst_place
        return np.pad(place, (0, 6 - len(place))) if np.isfinite(place).all() else None


@dataclass(frozen=True, slots=True, eq=False)
class Ropes:
    """All ropes; of the full selection with the answer to the study.

    Parameters
    ----------
    rows : tuple of RopeRow
        In the order of the catalogue.
    best : Rope or None
        The best by the study's objectives.
    reason : str
        Why none is.
    is_final : bool
        Whether this is the full selection, as in the report; else what a part of the samples tells,
        which is no proof.
    groups : GroupChoice or None
        What groups of cables get, where the study has some and the selection is full.
    problems : tuple of str
        What plugins and grade files gave that could not be used, one line each.
    proof : Proof or None
        What is proved of the best, as in the report; None until the full selection, or for groups.
    requirements : tuple of Requirement
        All that the study asks for, as in the report; none until the full selection.
    answer : Answer or None
        What follows from them; None until the full selection.
    terms : Terms or None
        What the answer covers and is subject to; None until the full selection.
    """

    rows: tuple[RopeRow, ...]
    best: Rope | None
    reason: str
    is_final: bool
    groups: GroupChoice | None = None
    problems: tuple[str, ...] = ()
    proof: Proof | None = None
    requirements: tuple[Requirement, ...] = ()
    answer: Answer | None = None
    terms: Terms | None = None

    def row(self, rope: Rope | RopePerCable | None) -> RopeRow | None:
        """Return the row of a rope; None where there is none."""
        return next((row for row in self.rows if row.rope == rope), None)

    @property
    def assignment(self) -> RopePerCable | None:
        """The rope of each cable by its group, to be looked at; None where none was found."""
        if self.groups is None or not self.groups.chosen.is_found:
            return None
        ropes = self.groups.chosen.by_cable
        return RopePerCable(tuple(Rope(rope.grade.id, rope.size.id) for rope in ropes))

    @property
    def makers(self) -> tuple[str, ...]:
        """All makers, sorted."""
        return tuple(sorted({row.grade.manufacturer for row in self.rows}))

    @property
    def materials(self) -> tuple[str, ...]:
        """All materials, sorted."""
        return tuple(sorted({row.grade.material for row in self.rows if row.grade.material}))


def quick_ropes(question: Question) -> Ropes | None:
    """Return what a part of the samples tells of all ropes; None without a workspace."""
    workspace, selection = question.workspace, question.selection
    if workspace is None:
        return None
    few = replace(workspace, samples=min(workspace.samples, _QUICK_SAMPLES))
    grades, load_cases = question.catalogue.grades, question.study.load_cases
    candidates = at_samples(few, selection, grades, question.built, load_cases)
    objectives = [o for o in selection.objectives if o != "stiffness"]
    best = None
    holding = [e for e in candidates if e.verification.holds and e.rejected_by is None]
    if objectives and selection.objectives[0] != "stiffness":
        comparable = [e for e in holding if np.isfinite(e.figures.burden(objectives[0]))]
        best = min(comparable, key=lambda e: e.key(objectives), default=None)
        is_in = is_undominated(burdens(holding, objectives))
        front = {id(e) for e, wins in zip(holding, is_in, strict=True) if wins}
    else:
        front = {id(e) for e in holding}
    rows = tuple(
        _quick_row(candidate, candidate is best, id(candidate) in front) for candidate in candidates
    )
    reason = "" if best else "none holds at the samples" if not holding else "needs the full search"
    chosen = None if best is None else Rope(best.grade.id, best.size.id)
    problems = question.catalogue.problems
    return Ropes(rows, chosen, reason, is_final=False, problems=problems)


def _quick_row(candidate: Candidate, is_best: bool, is_in_front: bool) -> RopeRow:
    verification = candidate.verification
    if is_best:
        standing, reason = "chosen", "best at the samples"
    elif np.isinf(verification.utilisation):
        standing, reason = "not_held", "no equilibrium was found in some pose"
    elif not verification.holds:
        standing, reason = "too_thin", "beyond its allowable tension in some pose"
    elif (rejection := rejection_words(candidate)) is not None:
        standing, reason = "rejected", rejection
    elif is_in_front:
        standing, reason = "undominated", "holds at the samples, and no other beats it there"
    else:
        standing, reason = "dominated", "holds at the samples, and another one beats it there"
    return _row(candidate, standing, reason)


def _row(candidate: Candidate, standing: str, reason: str) -> RopeRow:
    allowable_tension_N = candidate.cable.allowable_tension_N
    met = candidate.verification, candidate.figures, candidate.rejected_by is not None
    return RopeRow(candidate.grade, candidate.size, reason, standing, allowable_tension_N, *met)


def full_ropes(question: Question, reporter: Reporter = SILENT) -> Ropes:
    """Answer the study, choose among all ropes, and prove the best, by the pipeline of the report.

    Where the study asks for no rope, ropes are chosen as usual, and the answer is without them. No
    rows without a workspace.
    """
    study, catalogue = question.study, question.catalogue
    analysis = of_ropes = Analysis.begin(study, catalogue, reporter=reporter)
    if study.workspace is not None and study.selection is None:
        asking = replace(study, selection=question.selection)
        of_ropes = Analysis.begin(asking, catalogue, reporter=reporter)
    ropes = Ropes((), None, "", is_final=True)
    if of_ropes.selection is not None:
        ropes = ropes_of(of_ropes.selection, of_ropes.groups)
    return _answered(replace(ropes, problems=catalogue.problems), analysis)


def asked_alone(question: Question) -> Ropes:
    """Answer a study that asks for no rope; no rows."""
    analysis = Analysis.begin(question.study, question.catalogue)
    return _answered(Ropes((), None, "", is_final=True), analysis)


def _answered(ropes: Ropes, analysis: Analysis) -> Ropes:
    """Return the ropes with the answer to the study, and what it covers."""
    answer, terms = analysis.answer, analysis.terms
    return replace(ropes, requirements=analysis.requirements, answer=answer, terms=terms)


def ropes_of(selection: SelectionResult, groups: GroupChoice | None = None) -> Ropes:
    """Return the rows of a selection that was made in full."""
    chosen = selection.chosen
    rows = [_row(c, c.standing, c.reason) for c in selection.candidates]
    rows += [
        RopeRow(omitted.grade, size, omitted.reason)
        for omitted in selection.not_tried
        for size in omitted.sizes
    ]
    return Ropes(
        rows=tuple(rows),
        best=None if chosen is None else Rope(chosen.grade.id, chosen.size.id),
        reason=selection.reason or "",
        is_final=True,
        groups=groups,
        proof=selection.proof,
    )
