"""From a plan to the optimum: searched, verified in full, compared with the study as it is."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from designer.analysis.analyse import Analysis, analyse
from designer.analysis.comparison import compare
from designer.analysis.result_json import result_part
from designer.documents import edits
from designer.documents.document import document_of
from designer.errors import DesignerError, InputError
from designer.grades.registry import Catalogue
from designer.optimum.measures import promising
from designer.optimum.plan import OptimisationPlan, Values, read_optimisation
from designer.optimum.result import Optimum, Profile
from designer.optimum.search import LINE, Searched, Stop, search
from designer.optimum.trial import Examiner, Trial
from designer.progress import SILENT, Advance, Reporter
from designer.study import Study
from designer.sweeps.point import why_not

_MOST_PROFILES = 8
MOST_VERIFIED, FEW_VERIFIED = 24, 8
"""Designs that are verified in full, at most; and where the search was asked to end."""
_BETWEEN = 4
"""Of these, on the way from the best that holds to the nearest that looks better and fails."""
_SAME_PLACE = 0.01
"""Of each range: what is no further from a design that was verified is not verified by itself."""


def optimise(
    path: Path | str, *, with_plugins: bool = True, reporter: Reporter = SILENT
) -> Optimum:
    """Find the values of a study's fields that make a result of it as good as can be found.

    Parameters
    ----------
    path : Path or str
        A YAML file with ``study``, ``variables`` and ``objective``, as for `designer optimise`.
    with_plugins : bool
        False leaves out what plugins bring, for the same answer on every machine.
    reporter : Reporter
        Shows progress.

    Returns
    -------
    Optimum
        The design with the study as it is, both analysed in full. Found, not proved the best.

    Raises
    ------
    InputError
        If anything is wrong with the file, or with its study.
    """
    return optimum_of(read_optimisation(Path(path), with_plugins), reporter)


def optimum_of(
    plan: OptimisationPlan, reporter: Reporter = SILENT, stop: Stop = lambda: False
) -> Optimum:
    """Search for the best design of a plan, and verify it.

    ``stop`` is asked before each design; once it says so, the best so far is the answer.
    """
    given_study = replace(plan.base, document=plan.document).study()
    catalogue = plan.base.catalogue()
    catalogue.require_grades_of(given_study)
    examiner = Examiner(plan, promising(given_study, catalogue.grades))
    with reporter.task("optimise", plan.evaluations) as advance:
        searched = search(examiner, advance, stop)
    analysis = analyse(given_study, catalogue, reporter=reporter)
    return _verified(examiner, catalogue, searched, analysis, reporter)


def _verified(
    examiner: Examiner,
    catalogue: Catalogue,
    searched: Searched,
    original: Analysis,
    reporter: Reporter,
) -> Optimum:
    """Return the best design that holds in full, or the one that looked best where none does."""
    plan = examiner.plan
    ranked = _ranked(plan, searched)
    if not ranked:
        raise DesignerError("the search was ended before it had tried a design")
    holding = [trial for trial in ranked if trial.holds]
    n_verified = FEW_VERIFIED if searched.ended in ("asked", "time") else MOST_VERIFIED
    with reporter.task("verification", n_verified) as advance:
        verifier = Verifier(
            plan, lambda trial: _in_full(plan, catalogue, trial), advance, n_verified
        )
        verifier.verify(holding, examiner.trial)
    best = verifier.best or ranked[0]
    return replace(
        _analysed(plan, catalogue, searched, original, best, reporter),
        rejected=tuple(trial for trial in verifier.failed if trial is not best),
        unverified=len(verifier.unverified(holding)),
        profiles=_profiles(examiner, best),
    )


def _ranked(plan: OptimisationPlan, searched: Searched) -> list[Trial]:
    """Return the designs within the bounds, each once, the best first."""
    sign = plan.objective.sign
    designs = {t.values: t for t in searched.trials if t.values and plan.is_within(t.values)}
    return sorted(
        designs.values(), key=lambda t: (t.violation, sign * t.value if t.holds else math.inf)
    )


def _in_full(plan: OptimisationPlan, catalogue: Catalogue, trial: Trial) -> float | None:
    """Return the objective of a design that holds over all samples and between them; else None."""
    study = _study_of(plan, trial)
    keep = ("positive", *plan.base.keep)
    result = result_part(Analysis.begin(study, catalogue, keep=keep))
    holds = result["positive"] and not any(limit.is_broken_by(result) for limit in plan.limits)
    return plan.objective.value(result) if holds else None


def _analysed(
    plan: OptimisationPlan,
    catalogue: Catalogue,
    searched: Searched,
    original: Analysis,
    trial: Trial,
    reporter: Reporter,
) -> Optimum:
    analysis = analyse(_study_of(plan, trial), catalogue, reporter=reporter)
    before, after = original.to_dict(), analysis.to_dict()
    values = plan.objective.value(before), plan.objective.value(after)
    breaches = tuple(limit for limit in plan.limits if limit.is_broken_by(after))
    comparison = compare(before, after)
    text = optimised_text(plan, trial.values)
    return Optimum(
        plan, searched, trial, original, analysis, *values, breaches, (), comparison, text
    )


def _study_of(plan: OptimisationPlan, trial: Trial) -> Study:
    document = document_of(optimised_text(plan, trial.values).encode(), plan.document.name)
    try:
        return replace(plan.base, document=document).study()
    except InputError as error:  # its lines are those of no file of the user's
        why = f"no design that was tried makes a valid study: {why_not(error)}"
        raise DesignerError(f"{plan.name}: variables: {why}") from None


def optimised_text(plan: OptimisationPlan, values: Values) -> str:
    """Return the text of the study with a design's values, comments kept."""
    text = plan.text
    for keys, node in plan.changes(values):
        text = edits.with_value(text, keys, node.as_written())
    return text


def _profiles(examiner: Examiner, best: Trial) -> tuple[Profile, ...]:
    """Return what each variable does by itself about the optimum."""
    profiles = []
    for k, variable in enumerate(examiner.plan.variables[:_MOST_PROFILES]):
        values = {variable.at(float(x)) for x in np.linspace(0.0, 1.0, LINE)} | {best.values[k]}
        line = tuple(sorted(values))
        trials = [examiner.trial((*best.values[:k], x, *best.values[k + 1 :])) for x in line]
        profiles.append(Profile(line, tuple(t.value if t.holds else math.nan for t in trials)))
    return tuple(profiles)


@dataclass(slots=True)
class Verifier:
    """Verifies designs of a plan, each once, to find the best that holds in full in few of them.

    A search sees few samples, so that the designs it likes best may fail by a little, and all
    alike. The ranks are doubled until a design holds, and bisected between the last that fails and
    that one; then whatever still looks better is verified, the furthest from all that was first, as
    far as the budget goes. At last the way from the best to the nearest that fails is bisected.

    Parameters
    ----------
    plan : OptimisationPlan
        What is asked.
    in_full : callable
        Returns the objective of a design that holds in full [SI], else None.
    advance : callable
        Is told of each verification.
    most : int
        How many designs are verified at most.
    verified : dict
        What came out, by the values of the designs.
    failed : list of Trial
        Designs that do not hold in full.
    best : Trial or None
        The best that holds in full.
    """

    plan: OptimisationPlan
    in_full: Callable[[Trial], float | None]
    advance: Advance
    most: int = MOST_VERIFIED
    verified: dict[Values, float | None] = field(default_factory=dict)
    failed: list[Trial] = field(default_factory=list)
    best: Trial | None = None

    def verify(self, ranked: Sequence[Trial], try_design: Callable[[Values], Trial]) -> None:
        """Find the best of designs that hold in the search, given the best of it first."""
        self._verify_by_rank(ranked)
        while (trials := self.unverified(ranked)) and self._left > _BETWEEN:
            self._holds(max(trials, key=self._distance))
        self._go_towards_better(try_design)

    @property
    def _left(self) -> int:
        return self.most - len(self.verified)

    def _verify_by_rank(self, ranked: Sequence[Trial]) -> None:
        """Double the rank until a design holds, and bisect between that and the last that fails."""
        low, high, end = -1, 0, len(ranked)
        while high < end and self._left > _BETWEEN and not self._holds(ranked[high]):
            low, high = high, end if high == end - 1 else min(2 * high + 1, end - 1)
        while self.best is not None and high - low > 1 and self._left > _BETWEEN:
            middle = (low + high) // 2
            low, high = (low, middle) if self._holds(ranked[middle]) else (middle, high)

    def _go_towards_better(self, try_design: Callable[[Values], Trial]) -> None:
        """Bisect the way from the best design to the nearest that looks better and fails."""
        better = [trial for trial in self.failed if self._is_better(trial.value)]
        if self.best is None or not better:
            return
        holds = self.plan.shares(self.best.values)
        fails = min(
            (self.plan.shares(t.values) for t in better), key=lambda x: np.abs(x - holds).max()
        )
        for _ in range(min(_BETWEEN, self._left)):
            middle = 0.5 * (holds + fails)
            trial = try_design(self.plan.values(middle))
            if trial.values in self.verified:
                return
            if self._holds(trial):
                holds = middle
            else:
                fails = middle

    def unverified(self, ranked: Sequence[Trial]) -> list[Trial]:
        """Return what looks better in the search than the best in full, and was not verified."""
        return [
            trial
            for trial in ranked
            if self._is_better(trial.value) and self._distance(trial) > _SAME_PLACE
        ]

    def _distance(self, trial: Trial) -> float:
        """Return how far the nearest verified design is, over the ranges."""
        at = self.plan.shares(trial.values)
        distances = (np.abs(self.plan.shares(values) - at).max() for values in self.verified)
        return min(map(float, distances), default=math.inf)

    def _is_better(self, looks: float) -> bool:
        value = None if self.best is None else self.verified[self.best.values]
        sign = self.plan.objective.sign
        return value is None or sign * looks < sign * value

    def _holds(self, trial: Trial) -> bool:
        value = self.verified[trial.values] = self.in_full(trial)
        self.advance(1)
        if value is None:
            self.failed.append(trial)
        elif self._is_better(value):
            self.best = trial
        return value is not None
