"""One design: its values put into the study, and what it comes to."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cache, partial

from designer.documents.plain import Json
from designer.grades.grade import Grade
from designer.model.requirement import State
from designer.model.verdict import Verdict
from designer.optimum.measures import Measure, NotHeldError, Quick, shortfall
from designer.optimum.plan import Limit, OptimisationPlan, Values
from designer.study import Study, require_enough_cables
from designer.sweeps.point import why_negative, why_not

NO_STUDY = 3.0
"""Violation of a design that is no valid study: worse than one that holds nothing."""


@dataclass(frozen=True, slots=True)
class Trial:
    """A design that was tried.

    Parameters
    ----------
    values : tuple of float
        Of the variables.
    value : float
        Of the objective [SI]; NaN where there is none.
    violation : float
        0 where the design holds as asked; else how far it is from that, see
        `designer.optimum.measures.NotHeldError`.
    reason : str
        What is wrong with it; empty for nothing.
    start, round : int
        Search that tried it, and which turn of it; 0 for the study as it is.
    """

    values: Values
    value: float
    violation: float
    reason: str
    start: int = 0
    round: int = 0

    @property
    def holds(self) -> bool:
        """Whether the design is as asked."""
        return self.violation == 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Examiner:
    """Tries designs of a plan; ``grades`` are those worth a try."""

    plan: OptimisationPlan
    grades: tuple[Grade, ...]

    def trial(self, values: Values | None) -> Trial:
        """Try a design; None for the study as it is. Never fails: a reason is a result."""
        changes = () if values is None else self.plan.changes(values)
        value, violation, reason = math.nan, NO_STUDY, ""
        try:
            value, violation, reason = self._met(self.plan.base.study(changes))
        except NotHeldError as error:
            violation, reason = error.violation, error.reason
        except Exception as error:  # whatever a plugin or a library may raise
            reason = why_not(error)
        return Trial(values or self.plan.given or (), value, violation, reason)

    def _met(self, study: Study) -> tuple[float, float, str]:
        """Return the objective, and the worst breach of a limit."""
        require_enough_cables(study)
        quick = Quick(study, self.grades, self.plan.samples)
        whole = cache(partial(self._whole, study, quick))

        def figure(measure: Measure) -> float:
            if measure.quick is None:
                value = measure.value(whole())
            else:
                quick.require()
                value = measure.quick(quick)
            if value is None or math.isnan(value):
                raise NotHeldError(1.0, f"there is no {measure.title}")
            return value

        value = figure(self.plan.objective)
        breaches = [(limit.excess(figure(limit.measure)), limit) for limit in self.plan.limits]
        excess, limit = max(breaches, key=lambda breach: breach[0], default=(0.0, None))
        if excess == 0.0 or limit is None:
            return value, 0.0, ""
        return value, excess / (1.0 + excess), broken(limit)

    def _whole(self, study: Study, quick: Quick) -> Json:
        """Return the result over few samples.

        Raises
        ------
        NotHeldError
            If it is no answer.
        """
        if study.workspace is not None:
            study = replace(study, workspace=quick.evenly)
        result = self.plan.base.result(study)
        reason = why_negative(result)
        if reason:
            raise NotHeldError(_violation(result), reason)
        return result


def broken(limit: Limit) -> str:
    """Return that a limit is broken, for the reader of a report."""
    bound = f"{limit.value:.6g} {limit.measure.dimension.unit}".rstrip()
    return f"{limit.measure.title} is not {limit.words} {bound}"


def _violation(result: Json) -> float:
    """Return how far a result is from a positive one, see `NotHeldError`."""
    workspace = result.get("workspace")
    if workspace is None:
        return 2.0
    not_held = 1.0 - float(workspace["statuses"][Verdict.SOLVED.label]) / workspace["samples"]
    unmet = [check for check in result["checks"] if check["state"] != State.HOLDS]
    far = max((_check_shortfall(check) for check in unmet), default=1.0)
    return 1.0 + not_held if not_held else far


def _check_shortfall(check: Json) -> float:
    figures = (check[name] for name in ("demand", "capacity", "utilisation"))
    return shortfall(*(math.nan if value is None else value for value in figures))
