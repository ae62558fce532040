"""The search: differential evolution from several populations, then a look about the best.

That is a simplex, and each variable by itself over its range, by turns until neither gains.

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

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from designer.arrays import FloatArray
from designer.optimum.plan import Values
from designer.optimum.trial import Examiner, Trial
from designer.progress import Advance

_TO_POLISH = 0.3
"""Share of the budget for what comes after the populations."""
LINE = 9
"""Values of each variable that are tried by themselves about the best."""
_LEAST, _MOST, _EACH = 10, 40, 5
"""Designs of a population: at least, at most, for each variable."""
_FAR = 1e6
"""Above what any design that holds is rated."""
_SETTLED = 1e-5
"""Relative spread of a population's objectives at which it has nothing more to find."""
_SIMPLEX = 0.05
Stop = Callable[[], bool]


class _OverError(Exception):
    """The budget is used up, or somebody has asked for an end."""


@dataclass(frozen=True, slots=True, eq=False)
class Searched:
    """What a search found.

    Parameters
    ----------
    trials : tuple of Trial
        All designs, in the order in which they were tried; the study as it is comes first.
    spreads : tuple of array (n_variables,)
        Of the last population of each start: standard deviation over the range.
    ended : str
        ``settled``, ``evaluations``, ``time`` or ``asked``: why it ended.
    elapsed_s : float
        How long it took [s].
    """

    trials: tuple[Trial, ...]
    spreads: tuple[FloatArray, ...]
    ended: str
    elapsed_s: float

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
        """Run every start, then the simplex; ends by `_OverError` where time is up."""
        total, starts = self._plan.evaluations, self._plan.starts
        for k in range(starts):
            self._start, self._round = k + 1, 0
            self._left = int((1.0 - _TO_POLISH) * total / starts)
            self._evolve(self._plan.seed + k)
        self._left = total - (len(self.trials) - 1)
        self._start = 0
        while True:
            before = self._polish()
            self._scan()
            if self._rated(self._best()) >= before:
                break

    def _evolve(self, seed: int) -> None:
        from scipy.optimize import differential_evolution
        from scipy.stats import qmc

        n = len(self._plan.variables)
        size = min(max(_EACH * n, _LEAST), _MOST, max(self._left // 3, 5))
        rng, spread = np.random.default_rng(seed), np.full(n, np.nan)
        population = qmc.LatinHypercube(n, rng=rng).random(
            size
        )  # one design in each part of a range

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

    def _scan(self) -> None:
        """Try each variable by itself over its range, about the best design."""
        for k, variable in enumerate(self._plan.variables):
            values = self._best().values
            for x in np.linspace(0.0, 1.0, LINE):
                self._rate((*values[:k], variable.at(float(x)), *values[k + 1 :]))

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
            self._check_budget()
            trial = replace(self._examiner.trial(values), start=self._start, round=self._round)
            self.trials.append(trial)
            self._known[values] = self._rated(trial)
            self._left -= 1
            self._advance(1)
        return self._known[values]

    def _check_budget(self) -> None:
        limit_s = self._plan.time_s
        if self._stop():
            raise _OverError("asked")
        if limit_s is not None and time.monotonic() - self.began_s > limit_s:
            raise _OverError("time")
        if self._left <= 0:
            raise _OverError("evaluations")

    def _rated(self, trial: Trial) -> float:
        if trial.holds:
            return self._plan.objective.sign * trial.value / self._unit
        return _FAR * (1.0 + trial.violation)
