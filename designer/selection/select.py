"""Every size of every allowed grade, proved with its own figures; the best by what the study names.

The pass over the samples comes first, all sizes at once. The candidates that matter are then
searched between the samples, and compared.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from designer.effects.design import AsBuilt
from designer.grades.grade import Grade
from designer.model.load_case import STATIC, LoadCase
from designer.model.robot import Robot
from designer.progress import Reporter, Silent
from designer.proof.prove import Budget
from designer.selection.cases import (
    Cases,
    as_stiff_as,
    governing,
    resettled,
    searched,
    searched_all,
    together,
    worst_of_each,
)
from designer.selection.compare import Entry, best_of, may_win, settle, standing_of
from designer.selection.continuous import ContinuousOptimum, continuous_optimum
from designer.selection.criteria import criteria_of
from designer.selection.efficiency import Allowance
from designer.selection.objectives import MEANINGS, Figures
from designer.selection.products import common_currency, cost, is_allowed, products_of
from designer.selection.proven import CaseProof, prove_governing
from designer.selection.result import Candidate, GradeOutcome, NotTried, Outcome, SelectionResult
from designer.selection.screen import Screen
from designer.selection.usable import Usable, serves, usable
from designer.selection.verify import Verification, verify_sizes
from designer.statics.sizes import is_quick
from designer.study import Objective, Selection, Workspace
from designer.workspace.stiffness import smallest_stiffness_N_per_m

_FEW = 16  # places that tell which grade serves most, where each pose takes long


def select(
    robot: Robot,
    workspace: Workspace,
    selection: Selection,
    grades: Sequence[Grade],
    *,
    built: AsBuilt | None = None,
    load_cases: Sequence[LoadCase] = (),
    reporter: Reporter | None = None,
    proof_s: float = 0.0,
) -> SelectionResult:
    """Choose the best product among the grades that the study allows.

    ``grades`` is the whole catalogue, which ``selection.grades`` narrows; ``built`` tells by how
    much cables on this machine differ from their data sheet. A product holds that holds in every
    load case; without any it is the static one. It is tried for ``proof_s`` to prove that the best
    holds in all poses [s].
    """
    built, reporter = built or AsBuilt(robot), reporter or Silent()
    cases = Cases(robot, workspace, tuple(load_cases) or (STATIC,)).hurried()
    named = selection.grades
    allowed = [g for g in grades if is_allowed(g, named)]
    trial = _Trial(cases, selection, built, reporter, common_currency(allowed), proof_s)
    outcomes, not_tried = trial.outcomes(allowed)
    if named is None:
        not_tried += [NotTried(g, None, g.why_only_by_name) for g in grades if g.why_only_by_name]
    chosen = next((c for o in outcomes for c in o.candidates if c.standing == "chosen"), None)
    alternatives: list[GradeOutcome] = []
    if chosen is None:
        others = [g for g in grades if g not in allowed and not g.why_only_by_name]
        alternatives = trial.outcomes(others, only_fitting=True)[0] if others else []
    return SelectionResult(
        outcomes=tuple(outcomes),
        chosen=chosen,
        reason=None if chosen else _reason(outcomes, not_tried, selection.objectives[0]),
        alternatives=tuple(alternatives),
        objectives=selection.objectives,
        currency=trial.currency,
        not_tried=tuple(not_tried),
        usable=_usable(robot, workspace, outcomes, chosen),
        proof=None if chosen is None else trial.proofs.get(id(chosen.size)),
    )


def best_product(
    robot: Robot,
    workspace: Workspace,
    selection: Selection,
    grades: Sequence[Grade],
    *,
    built: AsBuilt | None = None,
    load_cases: Sequence[LoadCase] = (),
) -> Entry | None:
    """Return the product that `select` would choose, without what becomes of the others.

    None where nothing holds.
    """
    allowed = [g for g in grades if is_allowed(g, selection.grades)]
    cases = Cases(robot, workspace, tuple(load_cases) or (STATIC,)).hurried()
    currency = common_currency(allowed)
    trial = _Trial(cases, selection, built or AsBuilt(robot), Silent(), currency)
    front, _ = trial.choose(trial.sampled(allowed))
    return front[0] if front else None


def at_samples(
    workspace: Workspace,
    selection: Selection,
    grades: Sequence[Grade],
    built: AsBuilt,
    load_cases: Sequence[LoadCase],
) -> list[Entry]:
    """Return every product that a study allows with what it meets at the samples alone.

    Nothing is searched between them; stiffness, which takes long, is not known.
    """
    allowed = [g for g in grades if is_allowed(g, selection.grades)]
    quick = tuple(o for o in selection.objectives if o != "stiffness")
    selection = replace(selection, objectives=quick or ("mass",))
    currency = common_currency(allowed)
    cases = Cases(built.robot, workspace, tuple(load_cases) or (STATIC,))
    trial = _Trial(cases, selection, built, Silent(), currency)
    return trial.sampled(allowed)


@dataclass(frozen=True)
class _Trial:
    """What all candidates have in common."""

    cases: Cases
    selection: Selection
    built: AsBuilt
    reporter: Reporter
    currency: str | None
    proof_s: float = 0.0
    proofs: dict[int, CaseProof] = field(default_factory=dict)

    @cached_property
    def screen(self) -> Screen:
        """What candidates are held against beside strength."""
        robot, workspace = self.cases.robot, self.cases.workspace
        criteria = criteria_of(robot, workspace, self.selection)
        return Screen(criteria, self.selection, self.reporter)

    def outcomes(
        self, grades: Sequence[Grade], *, only_fitting: bool = False
    ) -> tuple[list[GradeOutcome], list[NotTried]]:
        """Try all sizes of these grades; what became of them, or of those with one that holds."""
        entries = self.sampled(grades)
        tried = {id(entry.size) for entry in entries}
        why = "the sheave is thinner than the rope, or than a fibre rope may be bent over"
        not_tried = [
            NotTried(g, size, why) for g in grades for size in g.sizes if id(size) not in tried
        ]
        front, allowed = self.choose(entries)
        outcomes = []
        with self.reporter.task("grades", len(grades)) as advance:
            for grade in grades:
                own = [e for e in entries if e.grade is grade]
                fitting = [e for e in own if id(e) in allowed]
                its_best = best_of(fitting, self.selection.objectives, _nothing_left)
                if its_best is not None or (own and not only_fitting):
                    outcomes.append(self._outcome(grade, own, front, its_best))
                advance(1)
        return outcomes, not_tried

    def choose(self, entries: Sequence[Entry]) -> tuple[list[Entry], set[int]]:
        """Return the Pareto set, the best first, and by `id` the entries that it was chosen from.

        The best is searched in every load case, proved as far as that goes, and meets every
        requirement. Where no entry meets all, it is the best of those that are strong enough.
        """
        objectives = self.selection.objectives
        self.screen.reject_by_table(entries)
        with self.reporter.task("search", len(entries)) as advance:
            thorough: set[int] = set()

            def search(entry: Entry) -> Verification:
                advance(1)
                return self.searched(entry, in_all=id(entry) in thorough)

            while True:
                meeting = [e for e in entries if e.rejected_by is None]
                meets_all = any(may_win(e, objectives) for e in meeting)
                allowed = meeting if meets_all else entries
                front = settle(allowed, objectives, search)
                if not front:
                    break
                best = front[0]
                if id(best) not in thorough and len(best.cases) > 1:
                    thorough.add(id(best))
                    best.verification = replace(best.verification, is_refined=False)
                elif meets_all and self.screen.rejects_any(best, front, meeting):
                    continue
                elif not self._proves(best):
                    self.screen.evaluated(best)
                    front = front if meets_all else [best]
                    break
        return front, {id(e) for e in allowed}

    def _proves(self, entry: Entry) -> bool:
        """Prove that a candidate holds in all poses; tell whether a worse pose was found."""
        if self.proof_s == 0.0 or id(entry.size) in self.proofs:
            return False
        with self.reporter.task("proof", 100) as advance:
            proof, cases = prove_governing(entry.cases, Budget(self.proof_s), advance)
            # A proof is of one stiffness: where a worse pose changes it, that is proved anew.
            while (settled := tuple(map(resettled, cases))) != cases:
                proof, cases = prove_governing(settled, Budget(self.proof_s), lambda _: None)
            entry.cases = cases
        self.proofs[id(entry.size)] = proof
        entry.cable = as_stiff_as(entry.cable, governing(entry.cases))
        entry.verification = most = together(entry.cases)
        entry.figures = replace(entry.figures, max_tension_N=most.max_tension_N)
        return proof.found.worst is not None

    def searched(self, entry: Entry, *, in_all: bool = False) -> Verification:
        """Search for the extremes of a candidate between the samples.

        Where it governs and near there, or in every load case.
        """
        entry.cases = searched_all(entry.cases) if in_all else searched(entry.cases)
        entry.cable = as_stiff_as(entry.cable, governing(entry.cases))
        if "stiffness" in self.selection.objectives:
            self._add_stiffness(entry, searched=True)
        return together(entry.cases)

    def sampled(self, grades: Sequence[Grade]) -> list[Entry]:
        """Solve all samples with all sizes that the sheave allows."""
        products = products_of(self.selection, grades, self.built)
        cables = [
            [one.cable for one in products_of(self.selection.under(case), grades, self.built)]
            for case in self.cases.each
        ]
        count = self.cases.sample_count * self.cases.passes(cables)
        with self.reporter.task("sizes", count) as advance:
            sampled = self.cases.sampled(cables, advance)
        entries = []
        for product, cases in zip(products, sampled, strict=True):
            grade, size = product.grade, product.size
            cable = as_stiff_as(product.cable, governing(cases))
            found = together(cases)
            if not math.isfinite(found.utilisation):  # lengths of other poses mean nothing
                found = replace(found, longest_m=np.full_like(found.longest_m, np.nan))
            length, ratio = float(found.longest_m.sum()), grade.sheave_ratio
            figures = Figures(
                mass_kg=cable.linear_density_kg_per_m * length,
                cost=cost(product, length, self.currency),
                drum_diameter_m=ratio.suggested * size.diameter_m if ratio else math.nan,
                max_tension_N=found.max_tension_N,
                stiffness_N_per_m=math.nan,
            )
            entries.append(Entry(grade, size, cable, product.efficiency, cases, found, figures))
        if "stiffness" in self.selection.objectives:
            holding = [entry for entry in entries if entry.verification.holds]
            with self.reporter.task("stiffness", len(holding)) as advance:
                for entry in holding:
                    self._add_stiffness(entry, searched=False)
                    advance(1)
        return entries

    def _add_stiffness(self, entry: Entry, *, searched: bool) -> None:
        where = self.cases.robot, self.cases.workspace, entry.cable
        found = smallest_stiffness_N_per_m(*where, searched=searched)
        entry.figures = replace(entry.figures, stiffness_N_per_m=found)

    def _outcome(
        self, grade: Grade, entries: Sequence[Entry], front: Sequence[Entry], best: Entry | None
    ) -> GradeOutcome:
        allowance = Allowance.of(self.selection)
        not_held = [
            one.sampled.worst_places[:1]
            for entry in entries
            for one in entry.cases
            if one.sampled.not_held and one.case.region is None
        ]
        optimum = continuous_optimum(
            self.cases.workspace, grade, allowance, self.built, doubtful=not_held[:1]
        )
        objectives = self.selection.objectives
        candidates = {
            id(entry): Candidate(
                grade=grade,
                size=entry.size,
                cable=entry.cable,
                efficiency=entry.efficiency,
                continuous_diameter_m=optimum.diameter_m,
                verification=entry.verification,
                cases=worst_of_each(entry.cases),
                figures=entry.figures,
                standing=standing,
                reason=reason,
                requirements=self.screen.requirements(entry),
            )
            for entry in entries
            for standing, reason in [standing_of(entry, front, objectives)]
        }
        return GradeOutcome(
            grade=grade,
            family=optimum.family,
            continuous_diameter_m=optimum.diameter_m,
            candidates=tuple(candidates.values()),
            outcome=_outcome_of(entries, optimum) if best is None else "fits",
            best=None if best is None else candidates[id(best)],
            verdict=optimum.verdict,
        )


def _outcome_of(entries: Sequence[Entry], optimum: ContinuousOptimum) -> Outcome:
    """Return what became of a grade of which no size meets all that is asked."""
    if any(entry.verification.holds for entry in entries):
        return "rejected"
    if math.isfinite(optimum.diameter_m):
        return "too_thin"
    proved = optimum.verdict is not None and optimum.verdict.is_proved
    return "no_finite_cable" if proved else "open"


def _nothing_left(entry: Entry) -> Verification:
    raise AssertionError(f"{entry.name} is the best of its grade and was not searched")


def _usable(
    robot: Robot,
    workspace: Workspace,
    outcomes: Sequence[GradeOutcome],
    chosen: Candidate | None,
) -> Usable | None:
    """Return what the sizes of the chosen grade serve, or of the one whose best serves most.

    The latter at a few poses only where each takes long.
    """
    shown = [o for o in outcomes if o.candidates]
    if chosen is not None:
        shown = [o for o in shown if o.grade is chosen.grade]
    if not shown:
        return None
    few = workspace.thinned(_FEW)

    def most_served(outcome: GradeOutcome) -> float:
        cables = [c.cable for c in outcome.candidates]
        if not is_quick(robot):
            return max(float(serves(robot, workspace, c, few).mean()) for c in cables)
        return max(s.served for s in verify_sizes(robot, workspace, cables, gives_up=False))

    one = shown[0] if len(shown) == 1 else max(shown, key=most_served)
    return usable(robot, workspace, one.grade, [(c.size, c.cable) for c in one.candidates])


def _reason(
    outcomes: Sequence[GradeOutcome], not_tried: Sequence[NotTried], decides: Objective
) -> str:
    if not outcomes and not_tried:
        return f"no size could be tried: {not_tried[0].reason}"
    if not outcomes:
        return "the catalogue has none of the grades that the study names"
    if any(c.standing == "not_comparable" for o in outcomes for c in o.candidates):
        return f"some ropes hold, but the {MEANINGS[decides].word} of none of them is known"
    if all(outcome.outcome == "no_finite_cable" for outcome in outcomes):
        return "no section of any grade holds the whole workspace"
    thin = [outcome for outcome in outcomes if outcome.outcome == "too_thin"]
    if not thin:
        return f"no size was found that holds: {outcomes[0].grade.id} {outcomes[0].sentence}"
    nearest = min(thin, key=lambda o: o.continuous_diameter_m / o.grade.thickest.diameter_m)
    if nearest.fails_in:
        what = "no size holds in every load case"
    elif all(o.continuous_diameter_m > o.grade.thickest.diameter_m for o in thin):
        what = "the largest size sold of every grade is insufficient"
    else:
        what = "no size sold of any grade holds"
    return f"{what}; the nearest is {nearest.grade.id}, which {nearest.sentence}"
