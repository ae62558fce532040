"""Is an effect that was found the same over all rows, or bent to fit something that drifts?"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from designer.arrays import BoolArray, FloatArray
from designer.diagnosis.fit import Fit, jacobian
from designer.diagnosis.problem import Problem
from designer.diagnosis.result import Withdrawn
from designer.diagnosis.structure import SIGNIFICANCE, Structure
from designer.effects.effect import Effect

_CHANCE = 1e-5
_VARIATION = 0.15
_CLIP = 4.0
_MOST_CARRIERS = 4


def drifting(
    problem: Problem,
    model: Fit,
    found: Sequence[Effect],
    structure: Structure,
    covariates: Mapping[str, FloatArray],
    rows: BoolArray,
) -> Withdrawn | None:
    """Return the found effect that drifts most with a covariate that the residual goes with.

    Each parameter is allowed to change in proportion to the covariate. That it does is held
    against the effect if it is no accident and the change is a good part of the effect itself: a
    constant that only suits the average of something else.
    """
    carriers = [c.name for c in structure.carriers[:_MOST_CARRIERS] if c.chance < SIGNIFICANCE]
    if not found:
        return None
    found_keys = {effect.key for effect in found}
    worst: Withdrawn | None = None
    slopes = jacobian(problem, [s.effect for s in model.settings], model.vector)
    residual = problem.residual(model.settings)
    limit = _CLIP * np.sqrt(model.variance)
    residual = np.clip(residual, -limit, limit)
    taken = rows[:, None] & ~np.isnan(residual)
    for carrier in carriers:
        z = covariates[carrier]
        z = np.nan_to_num((z - np.nanmean(z)) / np.nanstd(z))
        at = 0
        for setting in model.settings:
            width = len(setting.effect.parameters)
            if setting.effect.key in found_keys:
                moved = slopes[..., at : at + width] * z[:, None, None]
                variation = _variation(
                    setting.effect, model, at, slopes[taken], moved[taken], residual[taken]
                )
                if variation > max(_VARIATION, worst.variation if worst else 0.0):
                    worst = Withdrawn(setting.effect.key, carrier, variation)
            at += width
    return worst


def _variation(
    effect: Effect,
    model: Fit,
    at: int,
    slopes: FloatArray,
    moved: FloatArray,
    residual: FloatArray,
) -> float:
    """Return the drift per standard deviation of the covariate over the effect; 0 if chance."""
    from scipy.stats import chi2

    width = moved.shape[1]
    both = np.hstack([slopes, moved])
    scale = np.linalg.norm(both, axis=0)
    scale[scale == 0.0] = 1.0
    answer = np.linalg.lstsq(both / scale, -residual, rcond=1e-12)[0] / scale
    alone = np.linalg.lstsq(slopes / scale[:-width], -residual, rcond=1e-12)[0] / scale[:-width]
    gain = np.sum((residual + slopes @ alone) ** 2) - np.sum((residual + both @ answer) ** 2)
    if chi2.sf(gain / model.variance, width) > _CHANCE:
        return 0.0
    change = answer[-width:]
    size = model.vector[at : at + width] - [p.neutral for p in effect.parameters]
    typical = np.array([p.typical for p in effect.parameters])
    return float(np.linalg.norm(change / typical) / (np.linalg.norm(size / typical) + 1e-12))
