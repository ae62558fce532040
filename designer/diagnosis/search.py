"""Which effects the data ask for: add the best while it earns its place, exchange, prune.

Effects that are added one by one may start with one that suits the average of two, and need others
to mend it. Slopes of all candidates at one place tell of every set of a few at little cost: which
few effects promise most together.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise, product

import numpy as np

from designer.arrays import BoolArray, FloatArray
from designer.diagnosis.drift import gain_in_drift
from designer.diagnosis.fit import (
    HUBER,
    Fit,
    LinearTrial,
    StartingPoint,
    fit,
    huber,
    jacobian,
    linear_trial,
    with_places,
)
from designer.diagnosis.problem import Problem
from designer.diagnosis.statistics import SIGNIFICANCE, folds, orthonormal, outside_span
from designer.effects.effect import Effect, Setting
from designer.progress import Pace

RIVAL_MARGIN = 9.0
"""Difference of penalised loss below which two effects count as equally good."""
_PENALTY = 2.0
"""For each parameter, in units of the variance that is left: Akaike's information criterion."""
_PROMISE_SHARE = 0.25
"""Share of the best promise below which a candidate is not fitted: a linear step foretells the gain
of a fit to some tens of per cent."""
_MIN_TRIALS = 3
"""Candidates that are fitted, whatever they promise: a report shows them."""
_MAX_SETS = 6
"""Sets of effects that are fitted of those that promise most."""
_MAX_TOGETHER = 3
"""Cables whose effects are tried together: what is off with more of them has a cause in common."""
_TIE = 0.5
"""Difference of penalised loss that is none: laws that are one, seen from two sides."""
_SIGNIFICANT_STD = 3.3
"""Standard deviations from doing nothing that one number in a thousand gets to by chance."""


@dataclass(frozen=True, slots=True, eq=False)
class EffectTrial:
    """One candidate added to the present model."""

    effect: Effect  #: the candidate
    fit: Fit  #: the model with it
    #: what it takes off the robust loss over the rows for fitting, in units of the variance left,
    #: and for as many independent readings as there are
    gain: float
    chance: float  #: probability of such a gain by chance in any of the candidates of this round
    #: the same gain summed over parts of the rows that each fit has not seen; NaN if not tried
    heldout_gain: float
    #: whether a drift of the readings explains it as well; gain and chance are then beside that
    is_drift: bool = False

    def score(self, variance: float) -> float:
        """Return how good the model is against others of its round, in one unit for all.

        Minus the loss over the variance of the best, less the penalty of the effect.
        """
        return -self.fit.loss / variance - _penalty(self.effect)

    def may_precede(self, scores: Sequence[float], variance: float) -> bool:
        """Whether it is an error of setting up, and as good as the best, nearly."""
        margin = RIVAL_MARGIN * self.fit.inflation[self.effect.key]
        return self.effect.cause == "setting_up" and self.score(variance) > max(scores) - margin

    @property
    def earns_its_place(self) -> bool:
        """Whether it is no accident, and predicts rows that it has not seen."""
        return self.chance < SIGNIFICANCE and self.heldout_gain > 0.0

    @property
    def may_be_added(self) -> bool:
        """Whether it earns its place with values that an engineer would believe."""
        return self.earns_its_place and self.fit.is_plausible(self.effect)


@dataclass(frozen=True, slots=True, eq=False)
class Step:
    """One round of the search."""

    trials: tuple[EffectTrial, ...]  #: all candidates that were fitted, best first
    added: Effect | None  #: the one that earned its place
    is_complete: bool = True  #: whether there was time to try all
    #: candidates that were not fitted, with the gain that one linear step promised, best first
    passed_over: Mapping[str, float] = field(default_factory=dict)
    #: what takes the place of all that was found, this round's as well, as it does better together;
    #: mostly empty
    instead: tuple[Effect, ...] = ()


def _best(trials: Sequence[EffectTrial], order: Sequence[Effect]) -> list[EffectTrial]:
    """Of the best that earn their place, and those nearly as good, return those to name.

    First an error of setting up where there is one, then the one with fewest numbers of all.
    """
    good = [t for t in trials if t.may_be_added]
    variance = _best_variance(good)
    best = max(good, key=lambda t: t.score(variance), default=None)
    if best is None:
        return []
    # By the fit that has more to tell: what the best explains lasts in what a worse one leaves.
    inflation = best.fit.inflation[best.effect.key]
    close = [
        t
        for t in good
        if t.score(variance)
        >= best.score(variance) - RIVAL_MARGIN * min(inflation, t.fit.inflation[t.effect.key])
    ]
    # Of equal ones, the one that acts first.
    place = {effect.key: k for k, effect in enumerate(order)}
    close.sort(key=lambda t: (-round(t.score(variance) / _TIE), place[t.effect.key]))
    by_numbers = sorted(close, key=lambda t: len(t.effect.parameters))
    set_up = [t for t in by_numbers if t.effect.cause == "setting_up"]
    return list(dict.fromkeys([*set_up[:1], *by_numbers[:1]]))


def _penalty(effect: Effect) -> float:
    """Return what an effect has to gain by chance: the best of many looks gains the more."""
    return _PENALTY * len(effect.parameters) + 2.0 * math.log(effect.looks)


def _chance(gain: float, effect: Effect, looks: int) -> float:
    """Return how probable a gain is by chance in any of so many candidates."""
    from scipy.stats import chi2

    chance = float(chi2.sf(max(gain, 0.0), len(effect.parameters)))
    return min(chance * looks * effect.looks, 1.0)


def without(effects: Sequence[Effect], *keys: str) -> list[Effect]:
    """Return the effects whose keys are not among those given."""
    return [effect for effect in effects if effect.key not in keys]


def _best_variance(trials: Sequence[EffectTrial]) -> float:
    return min((t.fit.variance for t in trials), default=1.0)


@dataclass(eq=False)
class Searcher:
    """Searches one data set."""

    problem: Problem  #: data, model, noise
    candidates: Sequence[Effect]  #: in the order in which effects act
    given: Sequence[Effect]  #: unknown from the start: always fitted, and never a finding
    rows: BoolArray  #: (n_rows,): rows for fitting
    #: told what is being tried; where the time is spent, the search ends
    progress: Pace = field(default_factory=Pace)
    _unseen: dict[tuple[frozenset[str], str], float] = field(default_factory=dict)
    _views: tuple[StartingPoint, ...] = ()  # of all candidates, without any other

    def run(self) -> tuple[tuple[Step, ...], Fit, tuple[Effect, ...]]:
        """Add, exchange and prune until nothing changes, or a set of effects comes again.

        Returns the rounds, the final model, refitted jointly, and its effects without those given.
        """
        effects: list[Effect] = []
        steps: list[Step] = []
        present = base_fit = self.fit(effects)
        visited: list[set[Effect]] = []
        while set(effects) not in visited:
            visited.append(set(effects))
            # What earned its place before may hide behind what was named instead.
            earned = [t.effect for step in steps for t in step.trials if t.earns_its_place]
            part = f"round {len(steps) + 1}"
            trials, passed_over = self.trials(effects, present, part, earned)
            is_over = self.progress.is_over
            best = [] if is_over else _best(trials, self.candidates)
            # More that a machine lacks at once are not to be told apart by one log.
            extended = [self._extended(effects, t, trials) for t in best * (len(effects) < 5)]
            # Physics that makes more of the others superfluous is the simpler cause.
            fewest = min(range(len(extended)), key=lambda k: len(extended[k]), default=0)
            added = best[fewest].effect if best else None
            if extended:
                effects = extended[fewest]
                present = self.fit(effects, best[fewest].fit)
            before = effects
            if extended or not effects:  # else it was done when they were found
                effects, present = self._with_better_set(effects, present, base_fit)
            if trials:
                instead = () if effects is before else tuple(effects)
                steps.append(Step(tuple(trials), added, not is_over, passed_over, instead))
        effects = self._with_better_members(effects, present, steps)
        effects = self._split_into_parts(effects, present)
        effects = self._without_useless(effects, present)
        return tuple(steps), self.fit(effects, present, thorough=True), tuple(effects)

    def _with_better_set(
        self, effects: list[Effect], present: Fit, base_fit: Fit
    ) -> tuple[list[Effect], Fit]:
        """Return other effects, no more than these or two, that together do better by a margin.

        Not where these leave nothing and have few numbers. Of those about as good, errors of
        setting up come before physics, and few numbers before many.
        """
        excess = present.loss - present.n_data
        is_explained = excess < _SIGNIFICANT_STD * math.sqrt(2.0 * present.n_data)
        has_few_numbers = sum(map(_penalty, effects)) < RIVAL_MARGIN
        if is_explained and has_few_numbers:
            return effects, present
        better = self._better_sets(effects, present, base_fit)
        if not better:
            return effects, present
        best = min(better, key=self._penalised)
        least = self._penalised(best) + RIVAL_MARGIN * best.variance

        def simplicity(model: Fit) -> tuple[int, int]:
            return sum(s.effect.cause == "physics" for s in model.settings), len(model.vector)

        model = min((m for m in better if self._penalised(m) <= least), key=simplicity)
        together = [s.effect for s in model.settings if s.effect not in self.given]
        if self._unseen_loss(together, model) >= self._unseen_loss(effects, present):
            return effects, present
        # What was found before comes first, in the order in which it was.
        together.sort(key=lambda e: effects.index(e) if e in effects else len(effects))
        pruned = self._pruned(together)
        model = self.fit(pruned, model)
        is_better = self._penalised(model) < self._penalised(present)
        if is_better and self._earn_their_places(pruned, effects, model):
            return pruned, model
        return effects, present

    def _earn_their_places(
        self, together: Sequence[Effect], effects: Sequence[Effect], model: Fit
    ) -> bool:
        """Tell whether all of a set that are not among these effects do, beside the others."""
        looks = len(self.candidates) ** 2
        for effect in without(together, *(effect.key for effect in effects)):
            rest = without(together, effect.key)
            present = self.fit(rest, model)
            gain = (present.loss - model.loss) / (model.variance * model.inflation[effect.key])
            trial = EffectTrial(effect, model, gain, _chance(gain, effect, looks), float("nan"))
            if not self._validated(rest, present, [trial], looks)[0].may_be_added:
                return False
        return True

    def _better_sets(self, effects: Sequence[Effect], present: Fit, base_fit: Fit) -> list[Fit]:
        """Return fits of the sets that promise most, where they are better than the present one."""
        part = f"instead of {' and '.join(effect.key for effect in effects) or 'nothing'}"
        better = []
        is_used = self.problem.used(self.rows)
        off, now = (self.problem.misfit(model.settings)[is_used] for model in (base_fit, present))
        given_slopes = np.empty((len(off), 0))
        if self.given:
            given_slopes = jacobian(self.problem, self.given, base_fit.vector, nearly=True)[is_used]
        weight = HUBER / np.maximum(np.abs(now), HUBER)
        linear = LinearModel(self._views, off, given_slopes, weight)
        for promise in best_sets(linear, _penalty, effects, max(2, len(effects)), _MAX_SETS):
            together = [setting.effect for setting in promise]
            if self.progress.is_over:
                break
            self.progress(f"{part}: {' and '.join(effect.key for effect in together)}")
            every = self._sorted([*self.given, *together])
            model = fit(self.problem, every, self.rows, (*base_fit.settings, *promise), anew=True)
            margin = RIVAL_MARGIN * max(model.inflation[effect.key] for effect in together)
            gain = (self._penalised(present) - self._penalised(model)) / model.variance
            is_sure = all(model.is_plausible(e) and not model.is_faint(e) for e in together)
            if gain > margin and is_sure:
                better.append(model)
        return better

    def _extended(
        self, effects: Sequence[Effect], trial: EffectTrial, trials: Sequence[EffectTrial]
    ) -> list[Effect]:
        """Return the effects with one more, exchanged and pruned."""
        self.progress(f"found {trial.effect.key}")
        extended = [*effects, trial.effect]
        present = self.fit(extended, trial.fit)
        # Greed errs at times: a member goes where an outsider is clearly better in its place. The
        # newest was chosen among all; what is worse alone is seldom better in the place of another.
        for k in range(len(effects)):
            for outsider in trials[:8]:
                extended, present = self._swapped(
                    extended, present, k, outsider.effect, RIVAL_MARGIN
                )
        return self._pruned(extended)

    def fit(
        self,
        effects_found: Sequence[Effect],
        start: Fit | None = None,
        *,
        thorough: bool = False,
        anew: bool = False,
    ) -> Fit:
        """Fit the given effects and the found ones together."""
        effects = self._sorted([*self.given, *effects_found])
        settings = start.settings if start else ()
        return fit(self.problem, effects, self.rows, settings, thorough=thorough, anew=anew)

    def trials(
        self, effects: Sequence[Effect], present: Fit, part: str, earned: Sequence[Effect] = ()
    ) -> tuple[list[EffectTrial], dict[str, float]]:
        """Try the other candidates in addition, best first, and return those passed over.

        Fitted are those of which one linear step promises a good part of what it promises of the
        best, and those that ``earned`` a place before; where none of them earns it now, all whose
        promise may be no accident.
        """
        promised = self._promised(effects, present, part)
        looks, least = len(promised), _PROMISE_SHARE * max(promised.values(), default=0.0)
        clear = [
            e for e in promised if _chance(promised[e] / _PROMISE_SHARE, e, looks) < SIGNIFICANCE
        ]
        promising = {e for e in clear if promised[e] >= least}
        shortlist = [
            e for k, e in enumerate(promised) if k < _MIN_TRIALS or e in promising or e in earned
        ]
        # What nothing is expected of is only shown: it is not looked for in far valleys.
        hopeful = {*clear, *earned}
        trials = self._tried(effects, shortlist, present, part, looks, hopeful)
        trials = self._validated(effects, present, trials, looks)
        rest = without([*promised], *(e.key for e in shortlist))
        if not (self.progress.is_over or any(trial.may_be_added for trial in trials)):
            further = [e for e in rest if e in clear]
            if further:
                more = self._tried(effects, further, present, f"{part}, further", looks, hopeful)
                trials = self._validated(effects, present, [*trials, *more], looks)
                rest = without(rest, *(e.key for e in further))
        return trials, {e.key: promised[e] for e in rest}

    def _promised(self, effects: Sequence[Effect], present: Fit, part: str) -> dict[Effect, float]:
        """Return the gain that one linear step promises of each other candidate, best first.

        Of those that come too late, none.
        """
        reaches = {}
        for effect in self._others(effects):
            self.progress(f"{part}: {effect.key} at first sight")
            is_late = self.progress.is_over
            late = LinearTrial(present.loss, present.loss)
            reaches[effect] = late if is_late else self._in_reach(effects, effect, present)
        if not effects:
            self._views = tuple(view for reach in reaches.values() for view in reach.views)
        least = min((reach.loss for reach in reaches.values()), default=0.0)
        variance = max(1.0, least / max(present.n_data - len(present.vector), 1))
        promised = {effect: reach.gain / variance for effect, reach in reaches.items()}
        return dict(sorted(promised.items(), key=lambda e: _penalty(e[0]) - e[1]))

    def _in_reach(self, effects: Sequence[Effect], effect: Effect, present: Fit) -> LinearTrial:
        every = self._sorted([*self.given, *effects, effect])
        return linear_trial(self.problem, every, self.rows, present, effect)

    def _tried(
        self,
        effects: Sequence[Effect],
        candidates: Sequence[Effect],
        present: Fit,
        part: str,
        looks: int,
        hopeful: Collection[Effect],
    ) -> list[EffectTrial]:
        """Fit each of the candidates in addition; ``looks`` is how many there are in all."""
        trials = []
        for effect in self.progress.each(part, candidates):
            model = self.fit([*effects, effect], present, anew=effect in hopeful)
            gain = (present.loss - model.loss) / (model.variance * model.inflation[effect.key])
            chance = _chance(gain, effect, looks)
            trials.append(EffectTrial(effect, model, gain, chance, heldout_gain=float("nan")))
        return trials

    def _validated(
        self, effects: Sequence[Effect], present: Fit, trials: Sequence[EffectTrial], looks: int
    ) -> list[EffectTrial]:
        """Cross-validate trials from the best down, until one earns its place; best first."""
        variance = _best_variance(trials)
        answer: list[EffectTrial] = []
        ordered = sorted(trials, key=lambda trial: -trial.score(variance))
        for count, trial in enumerate(ordered):
            # Three are, whatever comes of it: a report shows them.
            good = [t.score(variance) for t in answer if t.may_be_added]
            settled = len(answer) >= 3 and bool(good) and not trial.may_precede(good, variance)
            if self.progress.is_over and not settled and trial.chance < SIGNIFICANCE:
                self.progress.leave_out(f"{trial.effect.key} and below on rows not seen")
                return answer + ordered[count:]
            is_known = not np.isnan(trial.heldout_gain)
            if settled or is_known or trial.chance >= SIGNIFICANCE:  # needs no proof
                answer.append(trial)
                continue
            tested, gain = (
                trial,
                gain_in_drift(self.problem, present, trial.fit, trial.effect, self.rows),
            )
            if gain < trial.gain:  # no more than a drift of the readings leaves it
                chance = _chance(gain, trial.effect, looks)
                is_drift = chance >= SIGNIFICANCE
                tested = replace(trial, gain=gain, chance=chance, is_drift=is_drift)
            if tested.chance < SIGNIFICANCE:
                gain = self._unseen_loss(effects, present)
                gain -= self._unseen_loss([*effects, trial.effect], trial.fit)
                tested = replace(tested, heldout_gain=gain / trial.fit.variance)
            answer.append(tested)
        return answer

    def rivals(
        self, effects: Sequence[Effect], effect: Effect, present: Fit, steps: Sequence[Step]
    ) -> list[tuple[Effect, ...]]:
        """Return the effects that the data cannot reject in place of one that was found.

        Each is fitted from the present model, and from where the first and the last round left
        it, unless a round has fitted it beside the same effects. It stays a rival if the fitted
        rows suit it about as well, with a penalty for its parameters or without one; or if it
        predicted unseen rows at least half as well when ``effect`` was added, and predicts them
        about as well in its place. What at first sight does less than half of what ``effect`` does
        is not fitted.
        """
        rest = without(effects, effect.key)
        scale = present.variance * present.inflation[effect.key]
        added = [step for step in steps if step.added is not None and step.added.key == effect.key]
        gains = {t.effect.key: t.heldout_gain for step in added[-1:] for t in step.trials}
        good = {key for key, gain in gains.items() if gain >= 0.5 * gains[effect.key]}
        lost = self.fit(rest, present, anew=True)
        gain = lost.loss - present.loss
        least = min(0.5 * gain, gain - 3.0 * RIVAL_MARGIN * scale)
        answer: list[tuple[Effect, ...]] = []
        for rival in self.progress.each(f"rivals of {effect.key}", self._others(effects)):
            if effect.is_part_of(rival):  # which can do all that it does
                continue
            outside_span = without(rest, *rival.parts)  # it stands for all of them
            is_hopeful = rival.key in good or len(outside_span) < len(rest)
            if not is_hopeful and self._in_reach(rest, rival, lost).gain < least:
                continue
            trials = [t.fit for step in steps for t in step.trials if t.effect.key == rival.key]
            with_rest = {e.key for e in (*self.given, *outside_span, rival)}
            fits = [m for m in trials if {s.effect.key for s in m.settings} == with_rest]
            if not fits:
                last = dict.fromkeys([*trials[:1], *trials[-1:]])
                fits = [self.fit([*outside_span, rival], present, anew=True)]
                fits += [self.fit([*outside_span, rival], start) for start in last]
            swapped = min(fits, key=lambda model: model.loss)
            if not swapped.is_plausible(rival):
                continue
            suits = self._gap(swapped, present) / scale < RIVAL_MARGIN
            if not suits and rival.key in good:
                gap = self._unseen_loss([*outside_span, rival], swapped)
                gap -= self._unseen_loss(effects, present)
                suits = gap / scale < RIVAL_MARGIN
            if suits:
                answer.append((rival,))
        for group in self._groups(effect, present):
            part = f"rivals of {effect.key}: {group[0].id} of several cables"
            if self.progress.is_over:
                self.progress.leave_out(part)
                break
            self.progress(part)
            if sum(self._in_reach(rest, rival, lost).gain for rival in group) < least:
                continue
            swapped = self.fit([*rest, *group], present, anew=True)
            suits = self._gap(swapped, present) / scale < RIVAL_MARGIN
            if suits and all(map(swapped.is_plausible, group)):
                answer.append(group)
        return answer

    def _groups(self, effect: Effect, present: Fit) -> list[tuple[Effect, ...]]:
        """Return effects, kind by kind, of the few cables that one for all cables acts on."""
        ((setting, at),) = (p for p in with_places(present.settings) if p[0].effect is effect)
        numbers = zip(effect.parameters, present.std[at].tolist(), strict=True)
        acting = [  # cables, from 1, whose own numbers do something for sure
            cable
            for cable, (p, std) in enumerate(numbers, start=1)
            if f"_{cable}_" in p.name
            if abs(setting.values[p.name] - p.neutral) > _SIGNIFICANT_STD * std
        ]
        if not 2 <= len(acting) <= min(_MAX_TOGETHER, len(effect.parameters) - 1):
            return []
        candidates = [
            e
            for e in self._others([s.effect for s in present.settings])
            if e.cable in acting and e.session == effect.session
            if not any(effect.id in p.part_of for p in e.parameters)  # which has the same number
        ]
        kinds = dict.fromkeys(e.id for e in candidates)
        groups = (tuple(e for e in candidates if e.id == kind) for kind in kinds)
        return [group for group in groups if len(group) == len(acting)]

    def _gap(self, swapped: Fit, present: Fit) -> float:
        """Return by how much a model is worse, with a penalty for its parameters or without."""
        return min(swapped.loss - present.loss, self._penalised(swapped) - self._penalised(present))

    def _others(self, effects_found: Sequence[Effect]) -> list[Effect]:
        return without(self.candidates, *(e.key for e in (*effects_found, *self.given)))

    def _unseen_loss(self, effects_found: Sequence[Effect], start: Fit) -> float:
        """Return the loss over each part of the rows, fitted to the other parts.

        Remembered by the effects, and by the loss of the start, which tells in which valley it is.
        """
        effects = self._sorted([*self.given, *effects_found])
        key = frozenset(effect.key for effect in effects), f"{start.loss:.3g}"
        if key not in self._unseen:
            loss = 0.0
            for part in folds(self.rows):
                model = fit(self.problem, effects, self.rows & ~part, start.settings)
                loss += float(huber(self.problem.misfit(model.settings)[part]).sum())
            self._unseen[key] = loss
        return self._unseen[key]

    def _swapped(
        self,
        effects: list[Effect],
        present: Fit,
        k: int,
        outsider: Effect,
        margin: float,
        *,
        anew: bool = False,
    ) -> tuple[list[Effect], Fit]:
        """Return effects and their fit with an outsider as member k, if better by a margin.

        With ``anew`` that fit starts far from the present one as well, which takes longer.
        """
        if outsider not in self._others(effects) or self.progress.is_over:
            return effects, present
        swapped = [*effects[:k], outsider, *effects[k + 1 :]]
        model = self.fit(swapped, present, anew=anew)
        better = (self._penalised(present) - self._penalised(model)) / model.variance
        return (swapped, model) if better > margin else (effects, present)

    def _with_better_members(
        self, effects: list[Effect], present: Fit, steps: Sequence[Step]
    ) -> list[Effect]:
        """Replace a member by what was as good when it was added, and is better beside them all.

        Or about as good, with fewer numbers; or one that acts before it, of laws that are one.
        """
        if len(effects) == 1:
            return effects
        place = self.candidates.index
        members = [
            (step, member)
            for step in steps
            for member in step.trials
            if member.effect in (step.instead or [step.added])
        ]
        for step, member in members:
            variance = _best_variance(step.trials)
            least = member.score(variance) - RIVAL_MARGIN * member.fit.inflation[member.effect.key]
            for trial in step.trials:
                # An error of setting up is thought of before physics.
                is_later = member.effect.cause == "setting_up" and trial.effect.cause == "physics"
                is_as_good = trial.may_be_added and trial.score(variance) >= least
                if member.effect in effects and is_as_good and not is_later:
                    k = effects.index(member.effect)
                    less = len(member.effect.parameters) - len(trial.effect.parameters)
                    is_first = place(trial.effect) < place(member.effect)
                    margin = -RIVAL_MARGIN if less > 0 else -_TIE if is_first and not less else _TIE
                    effects, present = self._swapped(
                        effects, present, k, trial.effect, margin, anew=True
                    )
        return effects

    def _split_into_parts(self, effects: list[Effect], present: Fit) -> list[Effect]:
        """Name the parts of a member in its place, if they do about as well together.

        Where they do better, also with values that are not plausible: then it is none of them.
        """
        for member in list(effects):
            parts = [e for e in self._others(effects) if e.id in member.parts]
            several = [*without(effects, member.key), *parts]
            model = self.fit(several, present, anew=True) if parts else present
            loss = (self._penalised(model) - self._penalised(present)) / present.variance
            margin = RIVAL_MARGIN if all(map(model.is_plausible, parts)) else -RIVAL_MARGIN
            if parts and loss < margin:
                effects, present = self._pruned(several), model
        return effects

    def _pruned(self, effects: list[Effect]) -> list[Effect]:
        """Leave out what the others have made superfluous."""
        if len(effects) == 1:
            return effects
        present = self.fit(effects)
        for effect in list(effects):
            if len(effects) == 1:
                break
            rest = without(effects, effect.key)
            fewer = self.fit(rest, present)
            scale = present.variance * present.inflation[effect.key]
            gain = (fewer.loss - present.loss) / scale
            if _chance(gain, effect, len(self.candidates)) > SIGNIFICANCE:
                effects, present = rest, fewer
        return effects

    def _without_useless(self, effects: list[Effect], present: Fit) -> list[Effect]:
        """Leave out what no longer helps to predict rows that a fit has not seen."""
        loss = self._unseen_loss(effects, present) if len(effects) > 1 else 0.0
        for effect in list(effects):
            if len(effects) == 1:
                break
            rest = without(effects, effect.key)
            loss_of_rest = self._unseen_loss(rest, present)
            if loss_of_rest <= loss:
                effects, loss = rest, loss_of_rest
        return effects

    def _penalised(self, model: Fit) -> float:
        return model.loss + model.variance * sum(_penalty(s.effect) for s in model.settings)

    def _sorted(self, effects: Sequence[Effect]) -> list[Effect]:
        place = {effect.key: k for k, effect in enumerate(self.candidates)}
        return sorted(effects, key=lambda effect: place.get(effect.key, -1))


# Sets of effects that promise most together.

_BEAM_WIDTH = 20
"""Sets of each size that another effect is added to. Of pairs all are looked at."""


class LinearModel:
    r"""How a residual changes with any set of effects, to first order.

    With r the residual without any of them, r_v that with effect v at its start, J the slopes and W
    the weights, a set leaves min over x of \|√W (r + Σ (r_v - r) + J x)\|², beside what is known.

    Views are all effects at all starts, over the same n readings; ``known`` (n, p) are slopes of
    what is in the model anyway, and ``weight`` (n,) is that of each reading's square.
    """

    def __init__(
        self,
        views: Sequence[StartingPoint],
        residual: FloatArray,
        known: FloatArray,
        weight: FloatArray,
    ) -> None:
        self.views = views
        root = np.sqrt(weight)[:, None]
        sizes = [np.maximum(np.linalg.norm(view.slopes, axis=0), 1e-300) for view in views]
        slopes = [view.slopes / size for view, size in zip(views, sizes, strict=True)]
        shifts = [residual, *(view.residual - residual for view in views)]
        columns = root * np.column_stack([*shifts, *slopes])
        columns = outside_span(orthonormal(root * known), columns)
        self._products = columns.T @ columns
        ends = len(shifts) + np.cumsum([0, *map(len, sizes)])
        self._places = [np.arange(first, end) for first, end in pairwise(ends)]
        self._sizes = sizes

    @property
    def nothing(self) -> float:
        """What is left without any effect."""
        return float(self._products[0, 0])

    def step(self, members: Sequence[int]) -> tuple[float, FloatArray]:
        """Return what a set of views leaves at least, and the step to there, as scaled inside."""
        at = np.concatenate([self._places[k] for k in members])
        shifted = np.array([0, *(1 + k for k in members)])
        square = self._products[np.ix_(at, at)]
        square.flat[:: len(at) + 1] += 1e-9 * (np.trace(square) + 1e-9)
        pull = self._products[np.ix_(at, shifted)].sum(axis=1)
        step = -np.linalg.solve(square, pull)
        return float(self._products[np.ix_(shifted, shifted)].sum() + pull @ step), step

    def settings(self, members: Sequence[int]) -> tuple[Setting, ...]:
        """Return the values to which the step leads."""
        ends = np.cumsum([len(self._sizes[k]) for k in members])[:-1]
        pairs = zip(members, np.split(self.step(members)[1], ends), strict=True)
        return tuple(self.views[k].moved(step / self._sizes[k]) for k, step in pairs)


def best_sets(
    model: LinearModel,
    penalty: Callable[[Effect], float],
    present: Collection[Effect],
    max_size: int,
    count: int,
) -> list[tuple[Setting, ...]]:
    """Return the sets of effects of which a linear step promises most.

    Best first, after that step; without those present, and those that add one effect to them, which
    is what a search tries anyway. Of the present ones a step may promise what no fit reaches.

    A set of at most ``max_size`` effects is to be better by ``penalty`` for each; ``count`` sets
    are returned at most.
    """
    effects = [view.setting.effect for view in model.views]
    present_keys = frozenset(effect.key for effect in present)
    best: dict[frozenset[str], tuple[float, tuple[int, ...]]] = {}
    starts: list[tuple[int, ...]] = [()]
    for size in range(1, max_size + 1):
        reached: dict[tuple[int, ...], float] = {}
        for members, k in product(starts, range(len(effects))):
            keys = frozenset(effects[m].key for m in members)
            more = tuple(sorted((*members, k)))
            if effects[k].key in keys or more in reached:
                continue
            score = model.step(more)[0] + sum(penalty(effects[m]) for m in more)
            reached[more] = score
            name = keys | {effects[k].key}
            best[name] = min((score, more), best.get(name, (np.inf, ())))
        starts = sorted(reached, key=reached.__getitem__)[: None if size == 1 else _BEAM_WIDTH]
    alternatives = [
        promise
        for name, promise in best.items()
        if promise[0] < model.nothing
        and not (present_keys <= name and len(name) <= len(present_keys) + 1)
    ]
    return [model.settings(members) for _, members in sorted(alternatives)[:count]]
