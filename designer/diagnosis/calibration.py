"""What a calibration needs to know of its fit: how surely, how separately, and on which rows.

Condition number and observability are those of the Jacobian of the residuals in units of noise, by
parameters in units of their typical change, so that neither depends on metres or newtons. With its
singular values σ, n rows and m parameters, the observability index is O1 = (σ1 … σm)^(1/m) / √n
(Borm and Menq, Int. J. Robotics Research 10 (1991) 51, doi:10.1177/027836499101000106).
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from designer.arrays import BoolArray, FloatArray
from designer.diagnosis.fit import HUBER, Fit, jacobian, steepness
from designer.diagnosis.problem import Problem
from designer.effects.effect import Effect, Parameter

_NO_SLOPE = 1e-6
"""Of the largest singular value: slopes are differences, and no more accurate."""
_SHARE = 1e-3
"""Squared part of a parameter in a direction from which on the direction concerns it."""
STRONG = 0.9
"""Correlation from which on two values are named."""


@dataclass(frozen=True, slots=True, eq=False)
class Calibrated:
    """A fitted parameter."""

    effect: Effect = field(metadata={"json": Effect.identified})  #: which it is
    parameter: Parameter = field(metadata={"json": lambda p: {"name": p.name, "unit": p.unit}})
    value: float  #: what was fitted, and its standard deviation; inf where the data settle no value
    std: float
    #: its largest change where one row is left out, in standard deviations; NaN where no row has a
    #: slope in it
    influence: float
    influence_row: int  #: that row, as numbered in the file

    @property
    def is_settled(self) -> bool:
        """Whether the data settle its value, rather than a combination with others alone."""
        return math.isfinite(self.std)

    @property
    def label(self) -> str:
        """What it is called among those of all effects."""
        return f"{self.parameter.label} of {self.effect.key}"


class Correlated(NamedTuple):
    """Two parameters that these data tell badly from one another."""

    first: Calibrated
    second: Calibrated
    correlation: float


@dataclass(frozen=True, slots=True, eq=False)
class Calibration:
    """How well the data settle what was fitted, unknowns from the start included."""

    parameters: tuple[Calibrated, ...]  #: in the order in which the effects act
    #: (n_parameters, n_parameters): in that order, in SI units; NaN where the data settle no value
    covariance: FloatArray
    condition: float  #: condition number of the scaled Jacobian
    observability: float  #: Borm and Menq's O1 of it
    #: rows, as numbered in the file, at the edge of what the cables hold; see
    #: `designer.diagnosis.fit.steepness`
    edge_rows: tuple[int, ...] = ()

    @property
    def correlated(self) -> Iterator[Correlated]:
        """The pairs beyond `STRONG`, the strongest first."""
        std = np.array([parameter.std for parameter in self.parameters])
        with np.errstate(invalid="ignore"):
            correlation = np.triu(self.covariance / np.outer(std, std), 1)
        correlation = np.nan_to_num(correlation, nan=0.0)
        for place in np.argsort(-np.abs(correlation), axis=None):
            i, k = np.unravel_index(place, correlation.shape)
            if abs(correlation[i, k]) <= STRONG:
                return
            yield Correlated(self.parameters[i], self.parameters[k], float(correlation[i, k]))


def calibration_of(problem: Problem, fit: Fit) -> Calibration | None:
    """Return how well the data of a fit settle it; None where nothing was fitted."""
    if not fit.settings:
        return None
    effects = [setting.effect for setting in fit.settings]
    pairs = [(effect, parameter) for effect in effects for parameter in effect.parameters]
    typical = np.array([parameter.typical for _, parameter in pairs])
    residual = problem.misfit(fit.settings)
    # Huber's weights, as in the fit: outliers settle nothing.
    limit = HUBER * math.sqrt(fit.variance)
    doubt = steepness(problem, fit.settings)
    weight = np.sqrt(limit / np.maximum(np.abs(residual), limit)) / doubt
    slopes = np.nan_to_num(weight[..., None] * jacobian(problem, effects, fit.vector) * typical)
    has_slope = slopes.any(axis=(0, 1))  # the time of a step has none
    slopes = slopes[..., has_slope]
    change = np.full((len(residual), len(pairs)), np.nan)
    change[:, has_slope] = _changes(slopes, np.nan_to_num(weight * residual))
    n_rows = int(np.isfinite(residual).any(axis=1).sum())
    identifiability = identifiability_of(slopes, n_rows)
    std = fit.std.copy()
    std[has_slope] = np.where(identifiability.is_settled, std[has_slope], np.inf)
    covariance = np.where(np.isfinite(np.outer(std, std)), fit.covariance, np.nan)
    sizes = np.abs(np.nan_to_num(change * typical / std))
    row, is_moved = np.argmax(sizes, axis=0), has_slope & np.isfinite(std)
    return Calibration(
        tuple(
            Calibrated(
                *pair,
                value=float(fit.vector[k]),
                std=float(std[k]),
                influence=float(sizes[row[k], k]) if is_moved[k] else math.nan,
                influence_row=int(problem.measured.row_numbers[row[k]]),
            )
            for k, pair in enumerate(pairs)
        ),
        covariance,
        identifiability.condition,
        identifiability.observability,
        tuple(problem.measured.row_numbers[(doubt > 1.0).any(axis=1)].tolist()),
    )


class Identifiability(NamedTuple):
    """What slopes tell of parameters; condition and observability as in `Calibration`."""

    is_settled: BoolArray  #: (n_parameters,): which have a value of their own
    #: (n_parameters,): standard deviations, in units of their typical changes; inf where not
    #: settled
    std: FloatArray
    condition: float
    observability: float


def identifiability_of(slopes: FloatArray, n_rows: int) -> Identifiability:
    """Return what slopes (…, n_parameters), in units of noise per typical change, tell."""
    triangle = np.linalg.qr(slopes.reshape(-1, slopes.shape[-1]), mode="r")
    _, singular, directions = np.linalg.svd(triangle)
    singular = np.pad(singular, (0, len(directions) - len(singular)))
    # Along these no reading changes: a fit stays where it came to, and its deviation means nothing.
    is_free = singular <= _NO_SLOPE * singular[0]
    is_settled = (directions[is_free] ** 2).sum(axis=0) <= _SHARE
    std = np.linalg.norm(directions[~is_free] / singular[~is_free, None], axis=0)
    with np.errstate(divide="ignore"):
        mean = float(np.exp(np.mean(np.log(singular))))
    condition = float(singular[0] / singular[-1]) if singular[-1] > 0.0 else math.inf
    settled = np.where(is_settled, std, np.inf)
    return Identifiability(is_settled, settled, condition, mean / math.sqrt(n_rows))


def _changes(slopes: FloatArray, residual: FloatArray) -> FloatArray:
    """Return by how much the fit moves without each row (n_rows, n_parameters): one Newton step.

    Without the slopes J of a row and its residual r it moves by (A - JᵀJ)⁻¹ Jᵀ r, where A sums JᵀJ
    over all rows; that is A⁻¹ Jᵀ (1 - J A⁻¹ Jᵀ)⁻¹ r. A row that alone settles a parameter has no
    such step, and a huge one is returned.
    """
    bread = np.linalg.pinv(np.einsum("rcp,rcq->pq", slopes, slopes), rcond=1e-12, hermitian=True)
    leaning = slopes @ bread
    leverage = leaning @ slopes.transpose(0, 2, 1)
    rest = (1.0 + 1e-9) * np.eye(slopes.shape[1]) - leverage
    step = np.linalg.solve(rest, residual[..., None])[..., 0]
    return np.asarray(np.einsum("rcp,rc->rp", leaning, step))
