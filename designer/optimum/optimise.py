"""From a plan to the optimum: searched, verified in full, compared with the study as it is.

A search sees few samples, so that the designs it likes best may fail by a little, and all alike.
Designs are verified in full, each once, to find the best that holds in few verifications: their
ranks are doubled until a design holds, and bisected between the last that fails and that one; then
whatever still looks better is verified, the furthest from all that was first, as far as the budget
goes. At last the way from the best to the nearest that fails is bisected.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from designer import __version__, checked
from designer.analysis.analyse import Analysis, analyse
from designer.analysis.comparison import Comparison, ComparisonLine, compare
from designer.analysis.result_json import result_part
from designer.documents import edits
from designer.documents.document import document_of
from designer.documents.plain import Json, csv_text, finite, json_text
from designer.errors import DesignerError, InputError
from designer.grades.registry import Catalogue
from designer.optimum.measures import promising
from designer.optimum.plan import Limit, OptimisationPlan, Values, Variable, read_optimisation
from designer.optimum.search import LINE, Examiner, Searched, Stop, Trial, search
from designer.progress import SILENT, Advance, Reporter
from designer.study import Study
from designer.sweeps.plan import why_not

_NEAR = 0.02
"""Of each range: two designs that are no further apart are the same place."""
_SAME = 1e-4
"""Relative: what changes the objective by less is no better."""
_WORSE_SIGNS = {
    "workspace.stiffness.largest_displacement_m_per_N": 1,
    "workspace.interference.min_distance_m": -1,
    "selection.chosen.max_tension_N": 1,
}
"""What nobody asked for may be paid with: 1 where more is worse, -1 where less is."""
_NOTABLE = 0.05
"""Relative change of such a result from which on it is reported."""
_MAX_PROFILES = 8
MOST_VERIFIED, FEW_VERIFIED = 24, 8
"""Designs that are verified in full, at most; and where the search was asked to end."""
_BETWEEN = 4
"""Of these, on the way from the best that holds to the nearest that looks better and fails."""
_SAME_PLACE = 0.01
"""Of each range: what is no further from a design that was verified is not verified by itself."""


@dataclass(frozen=True, slots=True)
class Profile:
    """The objective along one variable through the optimum, all others as they are there.

    ``objective`` is NaN where the design does not hold [SI].
    """

    values: tuple[float, ...]
    objective: tuple[float, ...]


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Optimum(checked.Shown):
    """What an optimisation found.

    Parameters
    ----------
    plan : OptimisationPlan
        What was asked.
    searched : Searched
        All designs that were tried.
    best : Trial
        The design that is answered, as the search saw it.
    given, optimised : Analysis
        The study as it is, and with the design's values: in full.
    before, after : float or None
        The verified objective of both [SI]; None where there is none.
    breaches : tuple of Limit
        What the verified design breaks.
    rejected : tuple of Trial
        Designs that looked better in the search, and do not hold in full.
    unverified : int
        How many others looked better than it, when the budget of verifications was used up.
    comparison : Comparison
        Both results side by side.
    text : str
        The study with the design's values, as it is to lie where the study does.
    profiles : tuple of Profile
        One for each variable.
    """

    plan: OptimisationPlan
    searched: Searched
    best: Trial
    given: Analysis
    optimised: Analysis
    before: float | None
    after: float | None
    breaches: tuple[Limit, ...]
    rejected: tuple[Trial, ...]
    comparison: Comparison
    text: str
    profiles: tuple[Profile, ...] = ()
    unverified: int = 0

    @property
    def holds(self) -> bool:
        """Whether the design holds as asked, verified."""
        return self.optimised.is_positive and self.after is not None and not self.breaches

    @property
    def given_holds(self) -> bool:
        """Whether the study as it is holds as asked."""
        result = self.comparison.a
        return self.given.is_positive and not any(
            limit.is_broken_by(result) for limit in self.plan.limits
        )

    @property
    def is_better(self) -> bool:
        """Whether a design was found that holds, and is better than the study as it is."""
        if not self.holds or self.after is None:
            return False
        if self.before is None or not self.given_holds:
            return True
        sign = self.plan.objective.sign
        return sign * self.after < sign * self.before - _SAME * abs(self.before)

    @property
    def gain(self) -> float | None:
        """Relative change of the objective; None where the study as it is has none."""
        if self.before is None or self.after is None or not self.before:
            return None
        return (self.after - self.before) / abs(self.before)

    @property
    def worsened(self) -> list[ComparisonLine]:
        """What got notably worse by it, of what is not asked for: give, and clearance."""
        lines = (line for line in self.comparison.answers if line.path in _WORSE_SIGNS)
        return [
            line for line in lines if (line.relative or 0.0) * _WORSE_SIGNS[line.path] > _NOTABLE
        ]

    @property
    def demands(self) -> tuple[str, ...]:
        """What each variable asks for beside the study, see `Variable.asks_for`."""
        pairs = zip(self.plan.variables, self.best.values, strict=True)
        return tuple(variable.asks_for(value) for variable, value in pairs)

    @property
    def off(self) -> float | None:
        """Verified value over that of the search, less one; None without either."""
        if self.after is None or not self.best.value or math.isnan(self.best.value):
            return None
        return (self.after - self.best.value) / abs(self.best.value)

    @property
    def starts(self) -> tuple[Trial | None, ...]:
        """The best design of each start; None where it found none that holds."""
        sign = self.plan.objective.sign
        return tuple(self.searched.best_of(k + 1, sign) for k in range(self.plan.starts))

    def agrees(self, trial: Trial | None) -> bool:
        """Tell whether a start came to the place of the answer, within some of each range."""
        if trial is None:
            return False
        distances = self.plan.shares(trial.values) - self.plan.shares(self.best.values)
        return bool((np.abs(distances) <= _NEAR).all())

    @property
    def agreeing(self) -> int:
        """How many starts came to the place of the answer."""
        return sum(map(self.agrees, self.starts))

    @property
    def range_of_starts(self) -> float:
        """Largest objective of a start over the smallest, less one; NaN where that says nothing."""
        values = [trial.value for trial in self.starts if trial is not None]
        return max(values) / min(values) - 1.0 if values[1:] and min(values) > 0.0 else math.nan

    @property
    def out_of_bounds(self) -> list[Variable]:
        """The variables whose value in the study as it is lies outside the bounds."""
        return [
            variable
            for variable in self.plan.variables
            if variable.given is not None and not variable.is_within(variable.given)
        ]

    @property
    def at_bounds(self) -> list[tuple[Variable, str]]:
        """The variables that stand at a bound, each with which one."""
        pairs = zip(self.plan.variables, self.best.values, strict=True)
        return [
            (variable, bound) for variable, value in pairs if (bound := variable.bound_at(value))
        ]

    @property
    def reasons(self) -> list[tuple[str, int]]:
        """Why designs that were tried do not hold, and how many for each, most first."""
        return Counter(t.reason for t in self.searched.trials[1:] if not t.holds).most_common()

    def to_dict(self) -> Json:
        """Return what ``optimise.json`` holds."""
        plan, searched = self.plan, self.searched
        objective = plan.objective
        return {
            "format": 1,
            "name": plan.name,
            "study": plan.document.name,
            "better": self.is_better,
            "holds": self.holds,
            "proved": False,
            "objective": {
                "name": objective.name,
                "path": objective.path,
                "unit": objective.dimension.unit,
                "goal": "minimise" if objective.sign > 0 else "maximise",
                "before": self.before,
                "after": self.after,
                "relative": self.gain,
                "in_search": finite(self.best.value),
                "in_search_before": finite(searched.trials[0].value),
            },
            "variables": [self._variable(k) for k in range(len(plan.variables))],
            "constraints": [
                {
                    "name": limit.measure.name,
                    limit.words.replace(" ", "_"): limit.value,
                    "value": limit.measure.value(self.comparison.b),
                    "holds": limit not in self.breaches,
                }
                for limit in plan.limits
            ],
            "starts": [
                {
                    "seed": plan.seed + k,
                    "best": None if trial is None else finite(trial.value),
                    "values": None if trial is None else list(trial.values),
                    "same_place": self.agrees(trial),
                    "spread": None if k >= len(searched.spreads) else finite(searched.spreads[k]),
                }
                for k, trial in enumerate(self.starts)
            ],
            "search": {
                "evaluations": len(searched.trials) - 1,
                "ended": searched.ended,
                "elapsed_s": searched.elapsed_s,
                "samples": plan.samples,
                "region_stays": plan.region_stays,
                "not_held": [{"reason": why, "designs": count} for why, count in self.reasons],
                "rejected": [list(trial.values) for trial in self.rejected],
                "unverified": self.unverified,
            },
            "convergence": [
                {"design": k, "best": finite(value)} for k, value in enumerate(self.best_so_far)
            ],
            "provenance": {
                "version": __version__,
                "study_sha256": plan.document.sha256,
                "created": self.optimised.provenance.created.isoformat(timespec="seconds"),
            },
        }

    def _variable(self, k: int) -> Json:
        variable, value = self.plan.variables[k], self.best.values[k]
        return {
            "name": variable.name,
            "fields": list(variable.fields),
            "unit": variable.unit,
            "is_offset": variable.is_offset,
            "bounds": [variable.low, variable.high],
            "before": variable.given,
            "after": value,
            "at_bound": variable.bound_at(value) or None,
            "asks_for": self.demands[k] or None,
        }

    @property
    def best_so_far(self) -> list[float]:
        """The objective of the best design that holds up to each one that was tried [SI]."""
        sign, best, values = self.plan.objective.sign, math.nan, []
        for trial in self.searched.trials:
            if trial.holds and not sign * trial.value >= sign * best:
                best = trial.value
            values.append(best)
        return values

    def to_json(self) -> str:
        """Return what ``optimise.json`` holds, as text."""
        return json_text(self.to_dict())

    def to_csv(self) -> str:
        """Return every design that was tried, one a row."""
        names = [f"{v.name} [{v.unit}]" if v.unit else v.name for v in self.plan.variables]
        rows: list[list[Any]] = [["start", "turn", *names, self.plan.objective.name, "reason"]]
        for trial in self.searched.trials:
            value = "" if math.isnan(trial.value) else f"{trial.value:.10g}"
            values = trial.values or [""] * len(names)
            rows.append([trial.start, trial.round, *values, value, trial.reason])
        return csv_text(rows)


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
    plan, sign = examiner.plan, examiner.plan.objective.sign
    designs = {t.values: t for t in searched.trials if t.values and plan.is_within(t.values)}
    ranked = sorted(
        designs.values(), key=lambda t: (t.violation, sign * t.value if t.holds else math.inf)
    )
    if not ranked:
        raise DesignerError("the search was ended before it had tried a design")

    def in_full(trial: Trial) -> float | None:
        """Return the objective of a design that holds between samples as well; else None."""
        keep = ("positive", *plan.base.keep)
        result = result_part(Analysis.begin(_study_of(plan, trial), catalogue, keep=keep))
        holds = result["positive"] and not any(limit.is_broken_by(result) for limit in plan.limits)
        return plan.objective.value(result) if holds else None

    holding = [trial for trial in ranked if trial.holds]
    n_verified = FEW_VERIFIED if searched.ended in ("asked", "time") else MOST_VERIFIED
    with reporter.task("verification", n_verified) as advance:
        verifier = Verifier(plan, in_full, advance, n_verified)
        verifier.verify(holding, examiner.trial)
    best = verifier.best or ranked[0]
    analysis = analyse(_study_of(plan, best), catalogue, reporter=reporter)
    before, after = original.to_dict(), analysis.to_dict()
    return Optimum(
        plan=plan,
        searched=searched,
        best=best,
        given=original,
        optimised=analysis,
        before=plan.objective.value(before),
        after=plan.objective.value(after),
        breaches=tuple(limit for limit in plan.limits if limit.is_broken_by(after)),
        rejected=tuple(trial for trial in verifier.failed if trial is not best),
        comparison=compare(before, after),
        text=optimised_text(plan, best.values),
        profiles=_profiles(examiner, best),
        unverified=len(verifier.unverified(holding)),
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
    for k, variable in enumerate(examiner.plan.variables[:_MAX_PROFILES]):
        values = {variable.at(float(x)) for x in np.linspace(0.0, 1.0, LINE)} | {best.values[k]}
        line = tuple(sorted(values))
        trials = [examiner.trial((*best.values[:k], x, *best.values[k + 1 :])) for x in line]
        profiles.append(Profile(line, tuple(t.value if t.holds else math.nan for t in trials)))
    return tuple(profiles)


@dataclass(slots=True)
class Verifier:
    """Verifies designs of a plan, each once, to find the best that holds in full."""

    plan: OptimisationPlan
    #: returns the objective of a design that holds in full [SI], else None
    in_full: Callable[[Trial], float | None]
    advance: Advance  #: is told of each verification
    most: int = MOST_VERIFIED  #: how many designs are verified at most
    #: what came out, by the values of the designs
    verified: dict[Values, float | None] = field(default_factory=dict)
    failed: list[Trial] = field(default_factory=list)  #: designs that do not hold in full
    best: Trial | None = None  #: the best that holds in full

    def verify(self, ranked: Sequence[Trial], try_design: Callable[[Values], Trial]) -> None:
        """Find the best of designs that hold in the search, given the best of it first."""
        # Double the rank until a design holds, and bisect between that and the last that fails.
        low, high, end = -1, 0, len(ranked)
        while high < end and self._left > _BETWEEN and not self._holds(ranked[high]):
            low, high = high, end if high == end - 1 else min(2 * high + 1, end - 1)
        while self.best is not None and high - low > 1 and self._left > _BETWEEN:
            middle = (low + high) // 2
            low, high = (low, middle) if self._holds(ranked[middle]) else (middle, high)
        while (trials := self.unverified(ranked)) and self._left > _BETWEEN:
            self._holds(max(trials, key=self._distance))
        self._bisect_to_better(try_design)

    @property
    def _left(self) -> int:
        return self.most - len(self.verified)

    def _bisect_to_better(self, try_design: Callable[[Values], Trial]) -> None:
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
