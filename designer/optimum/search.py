"""The search: differential evolution from several populations, then a look about the best.

That is a simplex, and each variable by itself over its range, alternating until neither gains.

Results of a study have kinks wherever another cable, pose or rope governs, and holes where no
rope holds, so nothing that takes derivatives will do; SciPy's differential evolution asks for
values alone, asks for those of a generation at once, and is there with the library already.

References
----------
Storn and Price, J. Global Optimization 11 (1997): differential evolution. Gao and Han,
Computational Optimization and Applications 51 (2012): the simplex. Deb, Computer Methods in
Applied Mechanics and Engineering 186 (2000): a design that holds beats any that does not.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache, partial

import numpy as np

from designer.arrays import FloatArray
from designer.documents.plain import Json
from designer.grades.grade import Grade
from designer.model.verdict import State, Verdict
from designer.optimum.measures import Measure, NotHeldError, Quick, shortfall
from designer.optimum.plan import Limit, OptimisationPlan, Values
from designer.progress import Advance
from designer.study import Study, require_enough_cables
from designer.sweeps.plan import why_negative, why_not

NO_STUDY = 3.0
"""Violation of a design that is no valid study: worse than one that holds nothing."""
LINE = 9
"""Values of each variable that are tried by themselves about the best."""
_POLISH_SHARE = 0.3
"""Of the budget, for what comes after the populations."""
_MIN_DESIGNS, _MAX_DESIGNS, _DESIGNS_PER_VARIABLE = 10, 40, 5
"""Of a population."""
_FAR = 1e6
"""Above what any design that holds is rated."""
_SETTLED = 1e-5
"""Relative spread of a population's objectives at which it has nothing more to find."""
_SIMPLEX = 0.05
"""Side of the first simplex, over the ranges."""
Stop = Callable[[], bool]


@dataclass(frozen=True, slots=True)
class Trial:
    """A design that was tried."""

    values: Values  #: of the variables
    value: float  #: of the objective [SI]; NaN where there is none
    #: 0 where the design holds as asked; else how far it is from that, see
    #: `designer.optimum.measures.NotHeldError`
    violation: float
    reason: str  #: what is wrong with it; empty for nothing
    start: int = 0  #: search that tried it; 0 for the study as it is
    round: int = 0  #: iteration of that search

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
            value, violation, reason = self._evaluate(self.plan.base.study(changes))
        except NotHeldError as error:
            violation, reason = error.violation, error.reason
        except Exception as error:  # whatever a plugin or a library may raise
            reason = why_not(error)
        return Trial(values or self.plan.given or (), value, violation, reason)

    def _evaluate(self, study: Study) -> tuple[float, float, str]:
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
    share_held = float(workspace["statuses"][Verdict.SOLVED.label])
    not_held: float = 1.0 - share_held / workspace["samples"]
    if not_held:
        return 1.0 + not_held
    shortfalls = []
    for check in result["checks"]:
        if check["state"] != State.HOLDS:
            figures = (check[name] for name in ("demand", "capacity", "utilisation"))
            shortfalls.append(shortfall(*(math.nan if x is None else x for x in figures)))
    return float(max(shortfalls, default=1.0))


class _OverError(Exception):
    """The budget is used up, or somebody has asked for an end."""


@dataclass(frozen=True, slots=True, eq=False)
class Searched:
    """What a search found."""

    #: all designs, in the order in which they were tried; the study as it is comes first
    trials: tuple[Trial, ...]
    #: (n_variables,) of the last population of each start: standard deviation over the range
    spreads: tuple[FloatArray, ...]
    ended: str  #: ``settled``, ``evaluations``, ``time`` or ``asked``: why it ended
    elapsed_s: float  #: how long it took [s]

    def best_of(self, start: int | None, sign: int) -> Trial | None:
        """Return the best design that holds of a start, or of all; None where none does."""
        holding = [t for t in self.trials if t.holds and start in (None, t.start)]
        return min(holding, key=lambda trial: sign * trial.value, default=None)


def search(examiner: Examiner, advance: Advance, stop: Stop) -> Searched:
    """Search for the best design within the budget.

    ``stop`` is asked before each design whether to end.
    """
    run = _Run(examiner, advance, stop)
    try:
        run.all()
    except _OverError as over:
        run.ended = str(over)
    elapsed_s = time.monotonic() - run.began_s
    return Searched(tuple(run.trials), tuple(run.spreads), run.ended, elapsed_s)


class _Run:
    def __init__(self, examiner: Examiner, advance: Advance, stop: Stop) -> None:
        self._examiner, self._advance, self._stop = examiner, advance, stop
        self._plan = plan = examiner.plan
        self.began_s = time.monotonic()
        self.trials = [examiner.trial(None)]
        self.spreads: list[FloatArray] = []
        self.ended = "settled"
        self._known: dict[Values, float] = {}
        trial = self.trials[0]
        self._unit = abs(trial.value) if trial.holds and trial.value else 1.0
        if plan.given is not None:
            self._known[plan.given] = self._rated(trial)
        self._start, self._round, self._left = 1, 0, 0

    def all(self) -> None:
        """Run every start, then simplex and lines; ends by `_OverError` where time is up."""
        total, starts = self._plan.evaluations, self._plan.starts
        for k in range(starts):
            self._start, self._round = k + 1, 0
            self._left = int((1.0 - _POLISH_SHARE) * total / starts)
            self._evolve(self._plan.seed + k)
        self._left = total - (len(self.trials) - 1)
        self._start = 0
        while True:
            before = self._polish()
            for k, variable in enumerate(self._plan.variables):
                values = self._best().values
                for x in np.linspace(0.0, 1.0, LINE):
                    self._rate((*values[:k], variable.at(float(x)), *values[k + 1 :]))
            if self._rated(self._best()) >= before:
                break

    def _evolve(self, seed: int) -> None:
        from scipy.optimize import differential_evolution
        from scipy.stats import qmc

        n = len(self._plan.variables)
        size = max(_DESIGNS_PER_VARIABLE * n, _MIN_DESIGNS)
        size = min(size, _MAX_DESIGNS, max(self._left // 3, 5))
        rng, spread = np.random.default_rng(seed), np.full(n, np.nan)
        # One design in each part of a range.
        population = qmc.LatinHypercube(n, rng=rng).random(size)

        def generation(intermediate_result: object) -> None:
            spread[:] = np.std(getattr(intermediate_result, "population"), axis=0)  # noqa: B009

        self.spreads.append(spread)
        original = self._plan.given if self._start == 1 else None
        try:
            differential_evolution(
                self._rate_all,
                [(0.0, 1.0)] * n,
                init=population,
                x0=None if original is None else np.clip(self._plan.shares(original), 0.0, 1.0),
                maxiter=max(self._left, 1),
                tol=_SETTLED,
                rng=rng,
                polish=False,
                vectorized=True,
                updating="deferred",
                callback=generation,
            )
        except _OverError as over:
            self.ended = str(over)
            if self.ended != "evaluations":
                raise

    def _best(self) -> Trial:
        within = self._plan.is_within
        return min(
            (trial for trial in self.trials if trial.values and within(trial.values)),
            key=self._rated,
        )

    def _polish(self) -> float:
        """Search about the best design by a simplex that knows only values; returns its rating."""
        from scipy.optimize import minimize

        at = np.clip(self._plan.shares(self._best().values), 0.0, 1.0)
        side = np.where(at + _SIMPLEX > 1.0, -_SIMPLEX, _SIMPLEX)
        minimize(
            lambda x: float(self._rate_all(x[:, None])[0]),
            at,
            method="Nelder-Mead",
            bounds=[(0.0, 1.0)] * len(at),
            options={
                "initial_simplex": at + np.vstack([np.zeros(len(at)), np.diag(side)]),
                "adaptive": True,
                "maxfev": max(self._left, 1),
                "xatol": 1e-3,
                "fatol": 1e-9,
            },
        )
        return self._rated(self._best())

    def _rate_all(self, shares: FloatArray) -> FloatArray:
        """Rate designs at shares of the ranges (n_variables, n_designs); less is better."""
        self._round += 1
        return np.array([self._rate(self._plan.values(column)) for column in shares.T])

    def _rate(self, values: Values) -> float:
        if values not in self._known:
            limit_s = self._plan.time_s
            if self._stop():
                raise _OverError("asked")
            if limit_s is not None and time.monotonic() - self.began_s > limit_s:
                raise _OverError("time")
            if self._left <= 0:
                raise _OverError("evaluations")
            trial = replace(self._examiner.trial(values), start=self._start, round=self._round)
            self.trials.append(trial)
            self._known[values] = self._rated(trial)
            self._left -= 1
            self._advance(1)
        return self._known[values]

    def _rated(self, trial: Trial) -> float:
        if trial.holds:
            return self._plan.objective.sign * trial.value / self._unit
        return _FAR * (1.0 + trial.violation)
