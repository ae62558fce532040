"""Which of the designs that a search tried is the best that holds in full, in few verifications.

A search sees few samples, so that the designs it likes best may fail by a little, and all alike.
The ranks are doubled until a design holds, and bisected between the last that fails and that one;
then whatever still looks better is verified, the furthest from all that was first, as far as the
budget goes. At last the way from the best to the nearest that fails is bisected.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from designer.optimum.plan import OptimisationPlan, Values
from designer.optimum.trial import Trial
from designer.progress import Advance

MOST_VERIFIED, FEW_VERIFIED = 24, 8
"""Designs that are verified in full, at most; and where the search was asked to end."""
_BETWEEN = 4
"""Of these, on the way from the best that holds to the nearest that looks better and fails."""
_SAME_PLACE = 0.01
"""Of each range: what is no further from a design that was verified is not verified by itself."""


@dataclass(slots=True)
class Verifier:
    """Verifies designs of a plan, each once.

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
