"""What an optimisation found, and how far it is to be believed."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import dataclass
from typing import Any

import numpy as np

from designer import __version__, checked
from designer.analysis.analyse import Analysis
from designer.analysis.comparison import Comparison, ComparisonLine
from designer.documents.plain import Json, csv_text, finite, json_text
from designer.optimum.plan import Limit, OptimisationPlan
from designer.optimum.search import Searched
from designer.optimum.trial import Trial
from designer.optimum.variables import Variable

_NEAR = 0.02
"""Of each range: two designs that are no further apart are the same place."""
_SAME = 1e-4
"""Relative: what changes the objective by less is no better."""
_WORSE = {
    "workspace.stiffness.largest_displacement_m_per_N": 1,
    "workspace.interference.min_distance_m": -1,
    "selection.chosen.max_tension_N": 1,
}
"""What nobody asked for may be paid with: 1 where more is worse, -1 where less is."""
_NOTABLE = 0.05


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
        lines = (line for line in self.comparison.answers if line.path in _WORSE)
        return [line for line in lines if (line.relative or 0.0) * _WORSE[line.path] > _NOTABLE]

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
