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
from designer.grades.grade import NOT_NAMED, Grade, Size
from designer.model.load_case import STATIC, LoadCase
from designer.model.robot import Robot
from designer.model.workspace import Workspace
from designer.progress import SILENT, Reporter
from designer.proof.prove import Budget, Proof
from designer.selection.candidate import (
    MEANINGS,
    Candidate,
    CandidateFigures,
    candidates_of,
    common_currency,
    cost,
    offered,
    with_prices,
)
from designer.selection.cases import (
    CaseResult,
    Cases,
    envelope,
    governing,
    governing_directions,
    prove_governing,
    refine_all,
    refine_governing,
    resettled,
    with_stiffness_of,
)
from designer.selection.compare import Screen, best_of, may_win, settle, standing_of
from designer.selection.criteria import criteria_of
from designer.selection.family import ContinuousOptimum, continuous_optima
from designer.selection.reeving import Allowance, sheave_ratio_of, why_not_bent
from designer.selection.result import (
    GradeOutcome,
    NotTried,
    Outcome,
    SelectionResult,
    SizeCoverage,
    serves,
    usable,
)
from designer.selection.verify import Verification, verify_sizes
from designer.statics.sizes import has_fast_solver
from designer.study import Selection
from designer.workspace.effort import GUESS
from designer.workspace.stiffness import smallest_stiffness_N_per_m


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
    explains: bool = True,
) -> SelectionResult:
    """Choose the best product among the grades that the study allows.

    ``grades`` is the whole catalogue, which ``selection.grades`` narrows; ``built`` tells by how
    much cables on this machine differ from their data sheet. A product holds that holds in every
    load case; without any it is the static one. It is tried for ``proof_s`` to prove that the best
    holds in all poses [s]. Without ``explains`` it is not told what a grade comes to (its optimum
    and its best size), why nothing is chosen and what would hold then, nor what share the sizes
    serve.
    """
    grades, price_estimate = with_prices(grades, selection)
    excluded = [(g, why) for g in grades if (why := g.why_excluded(selection))]
    allowed = [g for g in grades if g.why_excluded(selection) is None]
    cases = Cases(robot, workspace, tuple(load_cases) or (STATIC,)).with_coarse_sampling()
    run = _SelectionRun(
        cases, selection, built or AsBuilt(robot), allowed, reporter or SILENT, proof_s, explains
    )
    outcomes, not_tried = run.outcomes(allowed)
    not_tried += [NotTried(g, None, why) for g, why in excluded if why != NOT_NAMED]
    chosen = next((c for o in outcomes for c in o.candidates if c.standing == "chosen"), None)
    alternatives: list[GradeOutcome] = []
    if chosen is None and explains:
        anything = replace(selection, grades=None, materials=(), trust="C")
        more = [g for g, _ in excluded if g.why_excluded(anything) is None]
        wider = replace(run, selection=anything)
        alternatives = wider.outcomes(more, only_fitting=True)[0] if more else []
    return SelectionResult(
        outcomes=tuple(outcomes),
        chosen=chosen,
        reason=_reason(outcomes, not_tried, selection) if explains and chosen is None else None,
        alternatives=tuple(alternatives),
        objectives=selection.objectives,
        prefer=selection.prefer,
        currency=run.currency,
        price_estimate=price_estimate,
        price_list=selection.price_list,
        not_tried=tuple(not_tried),
        usable=_usable(robot, workspace, outcomes, chosen) if explains else None,
        proof=None if chosen is None else run.proofs.get(chosen),
        untrusted=run.better_untrusted(grades, chosen) if explains and chosen is not None else None,
    )


def best_product(
    robot: Robot,
    workspace: Workspace,
    selection: Selection,
    grades: Sequence[Grade],
    *,
    built: AsBuilt | None = None,
    load_cases: Sequence[LoadCase] = (),
) -> Candidate | None:
    """Return the product that `select` would choose, without what becomes of the others.

    None where nothing holds.
    """
    allowed = offered(grades, selection)
    cases = Cases(robot, workspace, tuple(load_cases) or (STATIC,)).with_coarse_sampling()
    run = _SelectionRun(cases, selection, built or AsBuilt(robot), allowed, explains=False)
    front, _ = run.choose(run.sampled(allowed))
    return front[0] if front else None


def at_samples(
    workspace: Workspace,
    selection: Selection,
    grades: Sequence[Grade],
    built: AsBuilt,
    load_cases: Sequence[LoadCase],
) -> list[Candidate]:
    """Return every product that a study allows with what it meets at the samples alone.

    Nothing is searched between them; stiffness, which takes long, is not known.
    """
    allowed = offered(grades, selection)
    quick = tuple(o for o in selection.objectives if o != "stiffness")
    selection = replace(selection, objectives=quick or ("mass",))
    cases = Cases(built.robot, workspace, tuple(load_cases) or (STATIC,))
    return _SelectionRun(cases, selection, built, allowed).sampled(allowed)


@dataclass(frozen=True)
class _SelectionRun:
    """What all candidates have in common."""

    cases: Cases
    selection: Selection
    built: AsBuilt
    allowed: Sequence[Grade]  # By the study
    reporter: Reporter = SILENT
    proof_s: float = 0.0
    explains: bool = True
    proofs: dict[Candidate, Proof] = field(default_factory=dict)

    @cached_property
    def currency(self) -> str | None:
        """Of the costs; None where nothing has a price."""
        return common_currency(self.allowed)

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
        candidates = self.sampled(grades)
        solved = {id(candidate.size) for candidate in candidates}
        not_tried = [
            NotTried(g, size, g.why_excluded(self.selection, size) or why_not_bent(g))
            for g in grades
            for size in g.sizes
            if id(size) not in solved
        ]
        front, allowed = self.choose(candidates)
        tried: list[tuple[Grade, list[Candidate], Candidate | None]] = []
        for grade in grades:
            of_grade = [c for c in candidates if c.grade is grade]
            fitting = [c for c in of_grade if c in allowed]
            its_best = best_of(fitting, self.selection.objectives)
            fits = its_best is not None and its_best.rejected_by is None
            if fits or (of_grade and not only_fitting):
                tried.append((grade, of_grade, its_best))
        with self.reporter.task("grades", len(tried)) as advance:
            optima = self._continuous_optima([(grade, of_grade) for grade, of_grade, _ in tried])
            outcomes = []
            for (grade, of_grade, its_best), optimum in zip(tried, optima, strict=True):
                outcomes.append(self._outcome(grade, of_grade, front, its_best, optimum))
                advance(1)
        return outcomes, not_tried

    def better_untrusted(self, grades: Sequence[Grade], chosen: Candidate) -> Candidate | None:
        """Return the best of what is excluded for its trust alone; None unless it is better."""
        trusting, decides = replace(self.selection, trust="C"), self.selection.objectives[0]

        def lacks_trust(grade: Grade, size: Size) -> bool:
            excluded, anyway = (grade.why_excluded(s, size) for s in (self.selection, trusting))
            return excluded is not None and anyway is None

        trimmed = [
            replace(grade, sizes=sizes)
            for grade in grades
            if (sizes := tuple(size for size in grade.sizes if lacks_trust(grade, size)))
        ]
        if not trimmed:
            return None
        run = replace(self, selection=trusting, explains=False, proof_s=0.0)
        front, _ = run.choose(run.sampled(trimmed))
        best = next((c for c in front[:1] if c.rejected_by is None), None)
        is_better = best and best.figures.burden(decides) < chosen.figures.burden(decides)
        return best if is_better else None

    def _continuous_optima(
        self, grades: Sequence[tuple[Grade, Sequence[Candidate]]]
    ) -> list[ContinuousOptimum]:
        """Return the continuous optimum of each grade with candidates."""
        of_grades = [grade for grade, _ in grades]
        allowance = Allowance.of(self.selection, self.built.robot.winches)
        if not self.explains:
            unbent = replace(allowance, sheave_diameter_m=None)
            families = [unbent.family(g, g.thickest.diameter_m) for g in of_grades]
            return [ContinuousOptimum(family, math.nan) for family in families]
        workspace = self.cases.workspace
        worst_places = []
        for _, candidates in grades:
            cases = [case for c in candidates for case in c.cases if case.case.region is None]
            cases = [case for case in cases if np.isfinite(case.verification.worst_place).all()]
            cases.sort(key=lambda case: not case.sampled.not_held)  # no member may hold there
            places = dict.fromkeys(tuple(case.verification.worst_place) for case in cases)
            worst_places.append(np.reshape(list(places), (-1, workspace.space.n_coordinates)))
        return continuous_optima(workspace, of_grades, allowance, self.built, worst_places)

    def choose(self, candidates: Sequence[Candidate]) -> tuple[list[Candidate], set[Candidate]]:
        """Return the Pareto set, the best first, and what it was chosen from.

        The best is searched in every load case, proved as far as that goes, and meets every
        requirement. Where no candidate meets all, it is the best of those that are strong enough.
        """
        objectives = self.selection.objectives
        with self.reporter.task("search", len(candidates)) as advance:
            thorough: set[Candidate] = set()

            def search(candidates: Sequence[Candidate]) -> list[Verification]:
                verifications = self.searched(candidates, thorough)
                advance(len(candidates))
                return verifications

            while True:
                meeting = [c for c in candidates if c.rejected_by is None]
                meets_all = any(may_win(c, objectives) for c in meeting)
                allowed = meeting if meets_all else candidates
                prefer = self.selection.prefer if meets_all else "none"
                front = settle(
                    allowed, objectives, search, prefer=prefer, searches_others=self.explains
                )
                if not front:
                    break
                best = front[0]
                if best not in thorough and len(best.cases) > 1:
                    thorough.add(best)
                    best.verification = replace(best.verification, is_refined=False)
                elif meets_all and self.screen.rejects_any(best, front, meeting):
                    continue
                elif not self._proves(best):
                    self.screen.evaluated(best)
                    front = front if meets_all else [best]
                    break
        return front, set(allowed)

    def _proves(self, candidate: Candidate) -> bool:
        """Prove that a candidate holds in all poses; tell whether a worse pose was found."""
        if self.proof_s == 0.0 or candidate in self.proofs:
            return False
        with self.reporter.task("proof", 100) as advance:
            proof, cases = prove_governing(candidate.cases, Budget(self.proof_s), advance)
            # A proof is of one stiffness: where a worse pose changes it, that is proved anew.
            while (settled := tuple(map(resettled, cases))) != cases:
                proof, cases = prove_governing(settled, Budget(self.proof_s), lambda _: None)
            candidate.cases = cases
        self.proofs[candidate] = proof
        candidate.cable = with_stiffness_of(candidate.cable, governing(candidate.cases))
        candidate.verification = envelope(candidate.cases)
        tension_N = candidate.verification.max_tension_N
        candidate.figures = replace(candidate.figures, max_tension_N=tension_N)
        return proof.worst is not None

    def searched(
        self, candidates: Sequence[Candidate], thorough: set[Candidate]
    ) -> list[Verification]:
        """Search for the extremes of candidates between the samples.

        Where each governs and near there; of those in ``thorough`` in every load case.
        """
        in_batch = [c for c in candidates if c not in thorough]
        cases = dict(zip(in_batch, refine_governing([c.cases for c in in_batch]), strict=True))
        for candidate in candidates:
            candidate.cases = cases.get(candidate) or refine_all(candidate.cases)
            candidate.cable = with_stiffness_of(candidate.cable, governing(candidate.cases))
            if "stiffness" in self.selection.objectives:
                self._add_stiffness(candidate, searched=True)
        return [envelope(candidate.cases) for candidate in candidates]

    def sampled(self, grades: Sequence[Grade]) -> list[Candidate]:
        """Solve all samples with all sizes that the sheave allows."""
        candidates = candidates_of(self.selection, grades, self.built)
        cables = [
            [c.cable for c in candidates_of(self.selection.under(case), grades, self.built)]
            for case in self.cases.load_cases
        ]
        count = self.cases.sample_count * self.cases.passes(cables)
        with self.reporter.task("sizes", count) as advance:
            sampled = self.cases.sampled(cables, advance)
        for candidate, cases in zip(candidates, sampled, strict=True):
            self._meets(candidate, cases)
        if "stiffness" in self.selection.objectives:
            holding = [c for c in candidates if c.verification.holds]
            with self.reporter.task("stiffness", len(holding)) as advance:
                for candidate in holding:
                    self._add_stiffness(candidate, searched=False)
                    advance(1)
        return candidates

    def _meets(self, candidate: Candidate, cases: tuple[CaseResult, ...]) -> None:
        """Note what a candidate meets over the samples, its figures, whether the sheave fits."""
        verification = envelope(cases)
        if not math.isfinite(verification.utilisation):  # lengths of other poses mean nothing
            verification = replace(
                verification, longest_m=np.full_like(verification.longest_m, np.nan)
            )
        length_m, ratio = float(verification.longest_m.sum()), candidate.grade.sheave_ratio
        candidate.cases, candidate.verification = cases, verification
        candidate.cable = with_stiffness_of(candidate.cable, governing(cases))
        candidate.figures = CandidateFigures(
            mass_kg=candidate.cable.rope_density_kg_per_m * length_m,
            cost=cost(candidate, length_m, self.currency),
            drum_diameter_m=ratio.suggested * candidate.size.diameter_m if ratio else math.nan,
            max_tension_N=verification.max_tension_N,
        )
        ratios = sheave_ratio_of(candidate.grade, candidate.size, self.selection)
        candidate.rejected_by = next((ratio for ratio in ratios if not ratio.holds), None)

    def _add_stiffness(self, candidate: Candidate, *, searched: bool) -> None:
        robot, workspace = self.cases.robot, self.cases.workspace
        smallest = smallest_stiffness_N_per_m(robot, workspace, candidate.cable, searched=searched)
        candidate.figures = replace(candidate.figures, stiffness_N_per_m=smallest)

    def _outcome(
        self,
        grade: Grade,
        candidates: Sequence[Candidate],
        front: Sequence[Candidate],
        best: Candidate | None,
        optimum: ContinuousOptimum,
    ) -> GradeOutcome:
        """Return what became of a grade, and of each of its sizes."""
        for candidate in candidates:
            standing = standing_of(candidate, front, self.selection.objectives)
            candidate.standing, candidate.reason = standing
            candidate.requirements = self.screen.requirements(candidate)
            candidate.cases = governing_directions(candidate.cases)
        outcome: Outcome = "fits"
        if best is None or best.rejected_by is not None:
            is_proved = optimum.verdict is not None and optimum.verdict.is_proved
            outcome = "no_finite_cable" if is_proved else "open"
            if any(candidate.verification.holds for candidate in candidates):
                outcome = "rejected"
            elif math.isfinite(optimum.diameter_m):
                outcome = "too_thin"
        return GradeOutcome(
            grade=grade,
            family=optimum.family,
            continuous_diameter_m=optimum.diameter_m,
            candidates=tuple(candidates),
            outcome=outcome,
            best=best,
            verdict=optimum.verdict,
        )


def _usable(
    robot: Robot,
    workspace: Workspace,
    outcomes: Sequence[GradeOutcome],
    chosen: Candidate | None,
) -> SizeCoverage | None:
    """Return what the sizes of the chosen grade serve, or of the one whose best serves most.

    The latter at a few poses only where each takes long.
    """
    sized = [o for o in outcomes if o.candidates]
    if chosen is not None:
        sized = [o for o in sized if o.grade is chosen.grade]
    if not sized:
        return None
    places = workspace.thinned(GUESS)

    def most_served(outcome: GradeOutcome) -> float:
        cables = [c.cable for c in outcome.candidates]
        if not has_fast_solver(robot):
            return max(float(serves(robot, workspace, c, places).mean()) for c in cables)
        return max(s.served for s in verify_sizes(robot, workspace, cables, gives_up=False))

    outcome = sized[0] if len(sized) == 1 else max(sized, key=most_served)
    sizes = [(candidate.size, candidate.cable) for candidate in outcome.candidates]
    return usable(robot, workspace, outcome.grade, sizes)


def _reason(
    outcomes: Sequence[GradeOutcome], not_tried: Sequence[NotTried], selection: Selection
) -> str:
    if not outcomes and not_tried:
        return f"no size could be tried: {not_tried[0].reason}"
    if not outcomes:
        return "the catalogue has none of the grades that the study names"
    if any(c.standing == "not_comparable" for o in outcomes for c in o.candidates):
        word = MEANINGS[selection.objectives[0]].word
        return f"some ropes hold, but the {word} of none of them is known"
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
