"""Is an effect that was found the same over all rows, or bent to fit something that drifts?"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from designer.arrays import BoolArray, FloatArray
from designer.diagnosis.fit import Fit, jacobian, with_places
from designer.diagnosis.problem import Problem
from designer.diagnosis.result import Withdrawn
from designer.diagnosis.structure import SIGNIFICANCE, Structure, beside, covariates_of
from designer.effects.effect import Effect, Readings

_MOST_CARRIERS = 4
"""Covariates that are tried: weaker ones go with these."""


def drifting(
    problem: Problem,
    model: Fit,
    effects: Sequence[Effect],
    structure: Structure,
    rows: BoolArray,
) -> Withdrawn | None:
    r"""Return the found effect that drifts most with a covariate that the residual goes with.

    Each effect is allowed to change in proportion to the covariate, all others being fitted anew.
    That it does is held against it if the gain is no accident, and a good part of what the effect
    itself gains or most of what is left: a constant that only suits the average of something else.
    The variation is √(gain of the change / gain of the effect), both linearised: for an effect of
    one parameter, its change over one standard deviation of the covariate, relative to its size.
    """
    from scipy.stats import chi2

    keys = {effect.key for effect in effects}
    limit = 4.0 * np.sqrt(model.variance)  # so that no outlier makes a drift
    unclipped = problem.residual(model.settings)
    residual = np.clip(unclipped, -limit, limit)
    is_used = rows[:, None] & ~np.isnan(residual)
    slopes = jacobian(problem, [s.effect for s in model.settings], model.vector)
    orthonormal = _orthonormal(slopes[is_used])
    remainder = beside(orthonormal, residual[is_used])
    unexplained = model.loss - model.n_data
    predicted = problem.surroundings(model.settings)
    covariates = covariates_of(problem.measured, predicted)
    worst: Withdrawn | None = None
    for setting, columns in with_places(model.settings):
        if setting.effect.key not in keys:
            continue
        # What the effect takes off the sum of squares that the others, fitted anew, leave.
        rest = [s for s in model.settings if s.effect.key != setting.effect.key]
        change = problem.residual(rest)[is_used] - unclipped[is_used]
        other_slopes = _orthonormal(np.delete(slopes, columns, axis=-1)[is_used])
        size = np.sqrt(max(np.sum(beside(other_slopes, change) ** 2), model.variance))
        for name, z in _weights(structure, covariates, predicted, rows):
            moved = (slopes[..., columns] * z[..., None])[is_used]
            further = _orthonormal(beside(orthonormal, moved))
            gain = float(np.sum((further.T @ remainder) ** 2))
            # With six covariates for each of up to five effects, the chance of any is below 0.001.
            drift = gain if chi2.sf(gain / model.variance, moved.shape[1]) < 1e-5 else 0.0
            variation = float(np.sqrt(drift) / size)
            # What varies by less than a fifth of itself, over one standard deviation of a
            # covariate, counts as the constant that it is in the model; a twentieth will do where
            # it explains most of what is left.
            least = 0.05 if drift > 0.5 * unexplained > 0.0 else 0.2
            if variation > max(least, worst.variation if worst else 0.0):
                worst = Withdrawn(setting.effect.key, name, variation)
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


def _orthonormal(columns: FloatArray) -> FloatArray:
    """Return an orthonormal basis of the columns, those that are nearly dependent left out."""
    if columns.shape[1] == 0:
        return columns
    scale = np.linalg.norm(columns, axis=0)
    scale[scale == 0.0] = 1.0
    u, s, _ = np.linalg.svd(columns / scale, full_matrices=False)
    return np.asarray(u[:, s > 1e-6 * s[0]])
