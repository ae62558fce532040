"""Search, and keep only the effects that hold.

An effect with values that nobody would believe is none. Structure that is left says that the model
is not the whole truth. Effects of the list are then bent to fit what is not in the list: as
constants they suit its average, or several together its shape. Those are withdrawn, weakest first,
and the rest is fitted anew; so is an effect that is not the same over all rows, but bent to fit
what drifts. What is left must help on rows that no fit has seen: the only use that is made of them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from designer.arrays import BoolArray, FloatArray
from designer.diagnosis.accuracy import thirds_of
from designer.diagnosis.fit import Fit, jacobian, with_places
from designer.diagnosis.problem import Problem
from designer.diagnosis.result import MOST_SCATTER, Reason, RejectedEffect
from designer.diagnosis.search import Searcher, Step, without
from designer.diagnosis.statistics import (
    SIGNIFICANCE,
    block_of,
    orthonormal,
    outside_span,
    rms,
    without_outliers,
)
from designer.diagnosis.structure import Structure, covariates_of, find_mistake, structure_left
from designer.effects.effect import Effect, Readings
from designer.effects.platform_loads import PLATFORM_FORCE
from designer.progress import Pace

_MOST_CARRIERS = 4
"""Covariates that are tried: weaker ones go with these."""


def _drifting(outcome: Outcome) -> RejectedEffect | None:
    r"""Return the found effect that drifts most with a covariate that the residual goes with.

    Each effect is allowed to change in proportion to the covariate, all others being fitted anew.
    That it does is held against it if the gain is no accident, and a good part of what the effect
    itself gains or most of what is left: a constant that only suits the average of something else.
    The variation is √(gain of the change / gain of the effect), both linearised: for an effect of
    one parameter, its change over one standard deviation of the covariate, relative to its size.
    """
    from scipy.stats import chi2

    problem, model, structure = outcome.problem, outcome.fit, outcome.structure
    rows, keys = outcome.rows, {effect.key for effect in outcome.found}
    limit = 4.0 * np.sqrt(model.variance)  # so that no outlier makes a drift
    unclipped = problem.misfit(model.settings)
    residual = np.clip(unclipped, -limit, limit)
    is_used = problem.used(rows)
    slopes = jacobian(problem, [s.effect for s in model.settings], model.vector)
    spanned = orthonormal(slopes[is_used])
    remainder = outside_span(spanned, residual[is_used])
    unexplained = model.loss - model.n_data
    predicted = problem.surroundings(model.settings)
    covariates = covariates_of(problem.measured, predicted)
    worst: RejectedEffect | None = None
    for setting, columns in with_places(model.settings):
        if setting.effect.key not in keys:
            continue
        # What the effect takes off the sum of squares that the others, fitted anew, leave.
        rest = [s for s in model.settings if s is not setting]
        change = problem.misfit(rest)[is_used] - unclipped[is_used]
        other_slopes = orthonormal(np.delete(slopes, columns, axis=-1)[is_used])
        size = np.sqrt(max(np.sum(outside_span(other_slopes, change) ** 2), model.variance))
        for name, z in _weights(structure, covariates, predicted, rows):
            moved = (slopes[..., columns] * z[..., None])[is_used]
            further = orthonormal(outside_span(spanned, moved))
            gain = float(np.sum((further.T @ remainder) ** 2))
            # With six covariates for each of up to five effects, the chance of any is below 0.001.
            drift = gain if chi2.sf(gain / model.variance, moved.shape[1]) < 1e-5 else 0.0
            variation = float(np.sqrt(drift) / size)
            # What varies by less than a fifth of itself, over one standard deviation of a
            # covariate, counts as the constant that it is in the model; a twentieth will do where
            # it explains most of what is left.
            least = 0.05 if drift > 0.5 * unexplained > 0.0 else 0.2
            if variation > max(least, worst.variation if worst else 0.0):
                worst = RejectedEffect(setting.effect.key, name, variation)
    return worst


def _weights(
    structure: Structure,
    covariates: Mapping[str, FloatArray],
    predicted: Readings,
    rows: BoolArray,
) -> Iterator[tuple[str, FloatArray]]:
    """Yield standardised covariates: of the row (n_rows, 1), or each cable's own (…, 2 n_cables).

    The latter tell what differs between cables in one pose, such as a stiffness that rises with
    tension. Not speeds: an exit point in proportion to its cable's speed is but a lag.
    """
    for carrier in structure.carriers[:_MOST_CARRIERS]:
        if carrier.chance < SIGNIFICANCE and not carrier.is_speed:
            yield carrier.name, _standard(covariates[carrier.name], rows)[:, None]
    for name, per_cable in (
        ("the cable's own tension", predicted.tension_N),
        ("the cable's own length", predicted.length_m),
    ):
        yield name, np.tile(_standard(per_cable, rows), 2)


def _standard(values: FloatArray, rows: BoolArray) -> FloatArray:
    seen = values[rows]
    return np.nan_to_num((values - np.nanmean(seen)) / (np.nanstd(seen) or 1.0))


_SMALL = 0.5
"""Of the loss that stays unexplained: with less, an effect may be bent to fit a part of that."""
_CLEAR = 1.0
"""Standard deviations of a gain above zero: one in six gets there by chance, and each effect has
passed the search before, by less than one in a thousand."""
_LEAST = 0.01
"""Share of the held-out mean square below which a gain is of no use to anyone."""
_HARM = -0.1
"""Share of the mean square of lengths, or of tensions, that may come with an effect by accident."""


@dataclass(frozen=True, eq=False)
class Outcome:
    """A search, and what of it holds."""

    searcher: Searcher  #: knows no effect that was withdrawn while it searched
    problem: Problem  #: what the tests may see: what was searched, or all readings
    rows: BoolArray  #: (n_rows,): rows in which structure is tested
    steps: tuple[Step, ...]  #: the search, round by round
    fit: Fit  #: joint fit of the effects that hold
    found: tuple[Effect, ...]  #: those, without what was unknown from the start
    withdrawn: tuple[RejectedEffect, ...] = ()  #: what was found and does not hold

    @cached_property
    def structure(self) -> Structure:
        """Test of what is left."""
        return structure_left(self.problem, self.fit.settings, self.rows)

    def fit_without(self, effect: Effect) -> Fit:
        """Fit the other effects, from the values that they have."""
        return self.searcher.fit(without(self.found, effect.key), self.fit, thorough=True)

    def holding(
        self, tests: Sequence[Callable[[Outcome], RejectedEffect | None]], progress: Pace
    ) -> Outcome:
        """Withdraw what the first test objects to, fit the rest anew, until all are content.

        With what a test puts in its place, if anything.
        """
        gone = next((gone for test in tests if (gone := test(self))), None)
        if gone is None:
            return self
        progress(f"{gone.effect} withdrawn")
        rest = tuple(dict.fromkeys([*without(self.found, gone.effect), *gone.instead]))
        model = self.searcher.fit(rest, self.fit, thorough=True)
        less = replace(self, fit=model, found=rest, withdrawn=(*self.withdrawn, gone))
        return less.holding(tests, progress)


@dataclass(frozen=True, slots=True)
class Gain:
    """Share of the held-out mean square that goes with an effect, and its standard deviation."""

    share: float
    std: float

    @property
    def is_clear(self) -> bool:
        """Whether it is at least 1 %, and a standard deviation above zero."""
        return self.share >= max(_LEAST, _CLEAR * self.std)


def search_and_hold(
    problem: Problem,
    candidates: Sequence[Effect],
    effects: Sequence[Effect],
    rows: BoolArray,
    progress: Pace,
) -> Outcome:
    """Search; withdraw what does not hold, and fit the rest anew.

    Where poses are mirrored or sensors on each other's plugs there is nothing to search for.
    Parameters as for `Searcher`.
    """
    searcher = Searcher(problem, candidates, effects, rows, progress)
    unsearched = searcher.fit([], thorough=True)
    if find_mistake(problem, unsearched.settings, rows):
        return Outcome(searcher, problem, rows, (), unsearched, ())
    steps, model, effects_found = searcher.run()
    # The best of what would still earn its place, but with values that nobody would believe; and of
    # what would, did the readings not drift.
    last = [t for t in steps[-1].trials if t.effect not in effects_found] if steps else []
    good = [t for t in last if t.earns_its_place]
    wild = [gone for t in good if (gone := implausible(t.fit, [t.effect]))][:1]
    drift = [
        RejectedEffect(t.effect.key, reason=Reason.READINGS_DRIFT) for t in last if t.is_drift
    ][:1]
    outcome = Outcome(searcher, problem, rows, steps, model, effects_found, (*wild, *drift))
    outcome = outcome.holding((_implausible, _overfitted), progress)
    rest = without(candidates, *(withdrawal.effect for withdrawal in outcome.withdrawn))
    return replace(outcome, searcher=replace(searcher, candidates=rest))


def keep_what_helps(
    outcome: Outcome, problem: Problem, heldout: BoolArray, progress: Pace
) -> tuple[Outcome, dict[str, Gain]]:
    """Withdraw what has no clear gain on held-out rows, least clear first; fit the rest anew.

    Nor may it make one kind of reading worse there, whatever it does for the other.

    The search of the outcome was not shown the readings of held-out rows (n_rows,); ``problem`` has
    all readings. Returns what is kept, with the structure of all rows, and the gain of each effect
    that is kept.
    """
    gains: dict[str, Gain] = {}

    def unseen(outcome: Outcome) -> RejectedEffect | None:
        gains.clear()
        residual = problem.residual(outcome.fit.settings)[heldout]
        harm = {}
        for effect in outcome.found:
            before = problem.residual(outcome.fit_without(effect).settings)[heldout]
            gains[effect.key] = _gain(before, residual, heldout)
            halves = zip(np.hsplit(before, 2), np.hsplit(residual, 2), strict=True)
            harm[effect.key] = min(
                (_gain(*h, heldout).share for h in halves if rms(h[1]) > MOST_SCATTER), default=0.0
            )
        worst = min(harm, key=harm.__getitem__, default="")
        if worst and harm[worst] < _HARM:
            detail = f"their mean square grows by {-harm[worst]:.0%}"
            return RejectedEffect(worst, reason=Reason.WORSE, detail=detail)
        if all(gain.is_clear for gain in gains.values()):
            return None
        least = min(gains, key=lambda key: gains[key].share - _CLEAR * gains[key].std)
        gain = gains[least]
        return RejectedEffect(least, reason=Reason.UNSEEN, gain=gain.share, gain_std=gain.std)

    def bent_since(outcome: Outcome) -> RejectedEffect | None:
        return _overfitted(outcome) if len(outcome.withdrawn) > n_withdrawn else None

    n_withdrawn = len(outcome.withdrawn)
    outcome = replace(outcome, problem=problem, rows=np.ones_like(heldout))
    tests = (_implausible, _faint, unseen, _no_step, _unsteady, bent_since)
    return outcome.holding(tests, progress), gains


def _implausible(outcome: Outcome) -> RejectedEffect | None:
    return implausible(outcome.fit, outcome.found)


def _overfitted(outcome: Outcome) -> RejectedEffect | None:
    """Return the found effect that is most likely bent to fit what else is left; None for none."""
    structure, model = outcome.structure, outcome.fit
    if not outcome.found or not (structure.events or structure.may_bend):
        return None
    losses = {effect.key: outcome.fit_without(effect).loss for effect in outcome.found}
    least = min(losses, key=losses.__getitem__)
    if losses[least] - model.loss < _SMALL * (model.loss - model.n_data):
        return RejectedEffect(least, reason=Reason.SMALL)
    return _drifting(outcome)


def _unsteady(outcome: Outcome) -> RejectedEffect | None:
    """Return a tilt, if what is left scatters more as the rows go on: a wind does, no base."""
    withdrawn = [rejected.effect for rejected in outcome.withdrawn]
    force = tuple(
        e for e in without(outcome.searcher.candidates, *withdrawn) if e.id == PLATFORM_FORCE.id
    )
    is_found = "base_tilt" in [effect.key for effect in outcome.found]
    is_unsteady = any(event.place == "scatter" for event in outcome.structure.events)
    if not (is_found and is_unsteady and force):
        return None
    return RejectedEffect("base_tilt", reason=Reason.UNSTEADY, instead=force)


def _no_step(outcome: Outcome) -> RejectedEffect | None:
    """Return what begins at a time, if what is left goes with time all the same."""
    steps = [e.key for e in outcome.found if e.starts_from is not None and "time" in e.needs]
    if steps and any(carrier.is_order for carrier in outcome.structure.present):
        return RejectedEffect(steps[0], reason=Reason.NO_STEP)
    return None


def implausible(model: Fit, effects: Sequence[Effect]) -> RejectedEffect | None:
    """Return the first effect with a value that an engineer would not believe."""
    keys = {effect.key for effect in effects}
    for setting in model.settings:
        for p in setting.effect.parameters:
            value = setting.values[p.name]
            if setting.effect.key in keys and not p.is_plausible(value):
                figure = f"{p.name} = {value:.4g} {p.unit}".rstrip()
                detail = f"{figure} ({p.plausible[0]:.4g} to {p.plausible[1]:.4g} would be)"
                return RejectedEffect(setting.effect.key, reason=Reason.IMPLAUSIBLE, detail=detail)
    return None


def _faint(outcome: Outcome) -> RejectedEffect | None:
    """Return the first effect that may as well do nothing, by its clustered covariance.

    All its values together: those of a moved exit point are each in doubt through the others.
    """
    for effect in outcome.found:
        if outcome.fit.is_faint(effect):
            return RejectedEffect(effect.key, reason=Reason.FAINT)
    return None


def _gain(before: FloatArray, after: FloatArray, heldout: BoolArray) -> Gain:
    """Return the gain between two residuals of held-out rows, readings that suit neither left out.

    With δ = before - after, before² - after² = δ² + 2 δ · after: the first term is what the effect
    does, the second is in doubt by the scatter that is left, over blocks and over their thirds.
    Where there are enough blocks, the scatter of their gains is a measure of the doubt as well.
    """
    suits = ~(np.isnan(without_outliers(before)) & np.isnan(without_outliers(after)))
    before, after = (np.where(suits, losses, 0.0) for losses in (before, after))
    total = float(np.sum(before**2))
    if total == 0.0:
        return Gain(0.0, 0.0)
    cross = 2.0 * np.sum((before - after) * after, axis=1)
    block = block_of(len(heldout))[heldout]
    doubts = []
    for part in (block, thirds_of(block)):
        sums = np.array([cross[part == k].sum() for k in np.unique(part)])
        doubts.append(np.sum(sums**2) * len(sums) / max(len(sums) - 1, 1))
    share, doubt = 1.0 - float(np.sum(after**2)) / total, max(doubts)
    gains = np.array([np.sum((before**2 - after**2)[block == k]) for k in np.unique(block)])
    if len(gains) >= 6:  # their scatter is known to a third then
        doubt = min(doubt, len(gains) * float(np.var(gains, ddof=1)))
    return Gain(share, float(np.sqrt(doubt)) / total)
