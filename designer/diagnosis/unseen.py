"""What was found must help on rows that no fit has seen: the only use that is made of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from designer.arrays import BoolArray, FloatArray
from designer.diagnosis.blocks import block_of
from designer.diagnosis.errors_of import thirds_of, without_outliers
from designer.diagnosis.fit import Fit
from designer.diagnosis.hold import Outcome, implausible, structure_left, without
from designer.diagnosis.pace import Pace
from designer.diagnosis.problem import Problem
from designer.diagnosis.result import Reason, Withdrawn
from designer.diagnosis.search import SIGNIFICANCE, Search, Searcher
from designer.diagnosis.structure import Structure
from designer.effects.effect import Effect

_CLEAR, _ENOUGH = 2.0, 6
_LEAST = 0.01


@dataclass(frozen=True, slots=True)
class Gain:
    """Share of the held-out mean square that goes with an effect, and its standard deviation."""

    share: float
    std: float

    @property
    def is_clear(self) -> bool:
        """Whether it is at least 1 %, and two standard deviations above zero."""
        return self.share >= max(_LEAST, _CLEAR * self.std)


def keep_what_helps(
    outcome: Outcome, whole: Problem, heldout: BoolArray, progress: Pace
) -> tuple[Outcome, dict[str, Gain]]:
    """Withdraw what has no clear gain on held-out rows, least clear first; fit the rest anew.

    Parameters
    ----------
    outcome : Outcome
        Of a search to which the readings of held-out rows were not shown.
    whole : Problem
        The same problem with all readings.
    heldout : array (n_rows,) of bool
        The rows to foretell.

    Returns
    -------
    Outcome
        With what is kept; its structure is that of all rows.
    dict of str to Gain
        Gain of each effect that is kept.
    """
    found, model, searcher = list(outcome.search.found), outcome.search.fit, outcome.searcher
    withdrawn = list(outcome.withdrawn)
    everywhere = np.ones_like(heldout)
    while True:
        gains, structure = dict[str, Gain](), outcome.structure
        gone = implausible(model, found) or _faint(model, found)
        if gone is None:
            gains = _gains(searcher, whole, model, found, heldout)
            gone = _unclear(gains)
        if gone is None:
            structure = structure_left(whole, model.settings, everywhere)
            gone = _no_step(structure, found)
        if gone is None:
            break
        progress(f"{gone.effect} withdrawn")
        withdrawn.append(gone)
        found = without(found, [gone.effect])
        model = searcher.fit(found, model, thorough=True)
    search = Search(outcome.search.steps, model, tuple(found))
    return (
        replace(outcome, search=search, withdrawn=tuple(withdrawn), structure=structure),
        gains,
    )


def _gains(
    searcher: Searcher, whole: Problem, model: Fit, found: Sequence[Effect], heldout: BoolArray
) -> dict[str, Gain]:
    """Return what each effect gains on held-out rows, the others fitted anew without it."""
    left = whole.residual(model.settings)[heldout]
    gains = {}
    for effect in found:
        rest = searcher.fit(without(found, [effect.key]), model)
        gains[effect.key] = _gain(whole.residual(rest.settings)[heldout], left, heldout)
    return gains


def _unclear(gains: Mapping[str, Gain]) -> Withdrawn | None:
    """Return the least clear effect; None where all are clear."""
    if all(gain.is_clear for gain in gains.values()):
        return None
    least = min(gains, key=lambda key: gains[key].share - _CLEAR * gains[key].std)
    gain = gains[least]
    return Withdrawn(least, reason=Reason.UNSEEN, gain=gain.share, gain_std=gain.std)


def _faint(model: Fit, found: Sequence[Effect]) -> Withdrawn | None:
    """Return the first effect that may as well do nothing, by its clustered covariance.

    All its values together: those of a moved exit point are each in doubt through the others.
    """
    from scipy.stats import chi2

    for effect in found:
        if chi2.sf(model.wald[effect.key], len(effect.parameters)) > SIGNIFICANCE:
            return Withdrawn(effect.key, reason=Reason.FAINT)
    return None


def _no_step(structure: Structure, found: Sequence[Effect]) -> Withdrawn | None:
    """Return an effect that begins at a time, if what is left goes with time all the same."""
    steps = [effect for effect in found if effect.starts_from is not None]
    if steps and any(carrier.name in ("time_s", "row") for carrier in structure.present):
        return Withdrawn(steps[0].key, reason=Reason.NO_STEP)
    return None


def _gain(before: FloatArray, after: FloatArray, heldout: BoolArray) -> Gain:
    """Return the gain between two residuals of held-out rows, readings that suit neither left out.

    With δ = before - after, before² - after² = δ² + 2 δ · after: the first term is what the effect
    does, the second is in doubt by the scatter that is left, over blocks and over their thirds.
    Where there are enough blocks, the scatter of their gains is a measure of the doubt as well.
    """
    suits = ~(np.isnan(without_outliers(before)) & np.isnan(without_outliers(after)))
    before, after = (np.where(suits, one, 0.0) for one in (before, after))
    total = float(np.sum(before**2))
    if total == 0.0:
        return Gain(0.0, 0.0)
    change = before - after
    cross = 2.0 * np.sum(change * after, axis=1)
    block = block_of(len(heldout))[heldout]
    doubts = []
    for part in (block, thirds_of(block)):
        sums = np.array([cross[part == k].sum() for k in np.unique(part)])
        doubts.append(np.sum(sums**2) * len(sums) / max(len(sums) - 1, 1))
    share, doubt = 1.0 - float(np.sum(after**2)) / total, max(doubts)
    gains = np.array([np.sum((before**2 - after**2)[block == k]) for k in np.unique(block)])
    if len(gains) >= _ENOUGH:
        doubt = min(doubt, len(gains) * float(np.var(gains, ddof=1)))
    return Gain(share, float(np.sqrt(doubt)) / total)
