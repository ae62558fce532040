r"""Noise that lasts over rows as a rival of every finding.

Of each reading, the residual is taken as ``r = J δ + x + e``: what the parameters do, a part that
keeps φ of itself from row to row (a random walk where φ is nearly 1), and a part that is each row's
own. Which φ, and which share of the variance the former has, is given by the restricted likelihood
(Patterson and Thompson, Biometrika 58, 1971), in which the parameters have no part. A short series
tells that badly, and rather too low than too high. So of what the likelihood does not exclude, and
what is no less likely than white noise, that is taken of which a mean over the rows is the most in
doubt. The gain of an effect is then counted by generalised least squares: what is left is made
white by a Kalman filter, which knows rows that are missing or held out, and that what a row's own
unknowns leave of its errors varies with the pose.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from designer.arrays import BoolArray, FloatArray
from designer.diagnosis.fit import HUBER, Fit, jacobian, with_places
from designer.diagnosis.problem import Problem
from designer.diagnosis.statistics import orthonormal, outside_span, without_outliers
from designer.effects.effect import Effect, Setting
from designer.effects.load_cells import TENSION_BIAS
from designer.effects.winches import LENGTH_OFFSET

_DECAYS = (0.5, 0.8, 0.9, 0.95, 0.98, 0.995)
"""The last keeps half of itself over 140 rows: to a log of some hundred, a random walk."""
_SHARES = (0.02, 0.05, 0.1, 0.2, 0.4, 0.7, 0.9, 1.0)
_NOT_EXCLUDED = 3.0
"""Logarithm of the likelihood's ratio to the best: one true noise in seventy is farther off."""
_LEAST_FREEDOM = 10
"""Readings beyond the parameters without which nothing is known of how noise lasts."""

_LEAST_LEFT = 0.1
"""Of an error; what a row's unknowns take up whole is left to the digits of a slope."""


def gain_in_drift(
    problem: Problem, rest: Fit, model: Fit, effect: Effect, rows: BoolArray
) -> float:
    """Return the gain of an effect in a noise that may drift, over rows (n_rows,) that were fitted.

    In units of the variance, and for as many independent readings as there are; ``rest`` is fitted
    without the effect. Readings that stand off from both models tell nothing.
    """
    mask = problem.used(rows)
    residuals = [
        np.where(mask, problem.misfit(fitted.settings), np.nan) for fitted in (rest, model)
    ]
    suits = np.any([np.isfinite(without_outliers(r)) for r in residuals], axis=0)
    before, after = (
        np.where(suits, np.clip(residual, -limit, limit), np.nan)
        for residual, fitted in zip(residuals, (rest, model), strict=True)
        if (limit := HUBER * np.sqrt(fitted.variance))
    )
    slopes = jacobian(problem, [setting.effect for setting in model.settings], model.vector)
    own = np.zeros(len(model.vector), dtype=np.bool_)
    for setting, columns in with_places(model.settings):
        own[columns] = setting.effect.key == effect.key
    free = problem.free_readings(mask) / max(mask.sum(), 1)
    # Where coordinates of poses are among the channels, how their errors are left is not known.
    is_mixed = problem.predict.row_unknowns and slopes.shape[1] == len(problem.sigma)
    shares = _shares_left(problem, model) if is_mixed else None
    return linear_gain_in_drift(before, after, slopes, own, free, shares)


def linear_gain_in_drift(
    before: FloatArray,
    after: FloatArray,
    slopes: FloatArray,
    own: BoolArray,
    free: float = 1.0,
    shares: FloatArray | None = None,
) -> float:
    """Return what an effect takes off the sum of squares, in a noise that may drift.

    Parameters
    ----------
    before, after : array (n_rows, n_channels)
        Residuals without and with the effect, in rows as they were visited; NaN where not fitted.
    slopes : array (n_rows, n_channels, n_parameters)
        Of the latter, in all parameters of the model.
    own : array (n_parameters,) of bool
        Which of them are the effect's.
    free : float
        Share of the readings that are left to test the model.
    shares : array (n_rows, n_channels, n_channels), optional
        What is left in each channel of an error of each, where rows have unknowns of their own;
        all of it, and in its own channel, if not given.
    """
    is_read = np.isfinite(before) & np.isfinite(after)
    slopes = np.where(is_read[..., None], slopes, 0.0)
    scale = np.linalg.norm(slopes, axis=(0, 1))
    slopes = slopes / np.where(scale > 0.0, scale, 1.0)
    residuals = np.where(is_read[..., None], np.stack([after, before], axis=-1), 0.0)
    left_of = np.full(is_read.shape[1], free)
    if shares is not None:  # of the variance, in rows that were fitted
        squares = np.sum(shares[np.flatnonzero(is_read.any(axis=1))] ** 2, axis=-1)
        left_of = np.maximum(squares.mean(axis=0), _LEAST_LEFT)
    decay, share, variance = noise = _noise_of(residuals[..., 0], slopes, is_read, left_of)
    columns = np.concatenate([residuals, slopes], axis=-1)
    if shares is None:
        steps = _innovations(columns, is_read, decay, share)
        white = np.stack([step / np.sqrt(variance)[:, None] for step, _ in steps])
    else:
        white = _shared_innovations(columns, is_read, shares, noise)
    flat = white.reshape(-1, columns.shape[-1])
    basis = orthonormal(flat[:, 2:][:, ~own])
    after_white, before_white, *_ = outside_span(basis, flat).T
    further = orthonormal(outside_span(basis, flat[:, 2:][:, own]))
    unexplained = outside_span(further, after_white)
    gain = float(before_white @ before_white) - float(unexplained @ unexplained)
    # Readings of one row share the error of its pose: their sums tell the doubt (Liang and Zeger).
    scores = np.sum((further * unexplained[:, None]).reshape(*is_read.shape, -1), axis=1)
    inflation = np.sum(scores**2) / max(further.shape[1], 1)
    return gain / max(float(inflation), 1.0)


def _shares_left(problem: Problem, model: Fit) -> FloatArray:
    """Return what is left in each channel of an error of each (n_rows, n_channels, n_channels).

    What is unknown in a row takes up a part of the errors of its readings, another one in each
    pose: as if a sensor that drifts slowly were off by another amount in each.
    """
    machine, fitted = problem.predict.machine, [setting.effect for setting in model.settings]
    zeros = [e for zero in (LENGTH_OFFSET, TENSION_BIAS) for e in zero.on(machine)]
    further = [e for e in zeros if e not in fitted]
    effects = [*fitted, *further]
    at_zero = [e.neutral[p.name] for e in further for p in e.parameters]
    slopes = jacobian(problem, effects, np.concatenate([model.vector, at_zero]))
    places = {
        s.effect.key: place for s, place in with_places([Setting(e, e.neutral) for e in effects])
    }
    columns = np.concatenate([slopes[..., places[e.key]] for e in zeros], axis=-1)
    return np.asarray(np.nan_to_num(columns) * problem.sigma)


def _shared_innovations(
    columns: FloatArray,
    is_read: BoolArray,
    shares: FloatArray,
    noise: tuple[FloatArray, FloatArray, FloatArray],
) -> FloatArray:
    """Return what each row adds to those before it, made white, where it holds errors mixed.

    A Kalman filter whose state is the lasting error of each sensor. What is left of a row has fewer
    dimensions than channels; those that it lacks are 0.
    """
    decay, share, variance = noise
    stationary = share * variance
    expected, doubt = np.zeros(columns.shape[1:]), np.diag(stationary)
    white = np.zeros_like(columns)
    for k, (row, read) in enumerate(zip(columns, is_read, strict=True)):
        directions, size, _ = np.linalg.svd(np.where(read[:, None], shares[k], 0.0))
        basis = directions[:, size > _LEAST_LEFT]
        mixing = basis.T @ np.where(read[:, None], shares[k], 0.0)
        step = basis.T @ row - mixing @ expected
        covariance = mixing @ (doubt + np.diag((1.0 - share) * variance)) @ mixing.T
        white[k, : len(step)] = np.linalg.solve(np.linalg.cholesky(covariance), step)
        weight = np.linalg.solve(covariance, mixing @ doubt).T
        expected = decay[:, None] * (expected + weight @ step)
        doubt = decay[:, None] * (doubt - weight @ mixing @ doubt) * decay
        doubt += np.diag((1.0 - decay**2) * stationary)
    return white


def _noise_of(
    residual: FloatArray, slopes: FloatArray, is_read: BoolArray, free: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return decay, lasting share and variance of the noise of each channel (n_channels,).

    ``free`` is the share of the variance that the row's unknowns left (n_channels,).
    """
    n_rows, n_channels, n_parameters = slopes.shape
    bases, is_used = np.zeros_like(slopes), np.zeros((n_channels, n_parameters), dtype=np.bool_)
    for channel in range(n_channels):
        basis = orthonormal(slopes[:, channel])
        bases[:, channel, : basis.shape[1]] = basis
        is_used[channel, : basis.shape[1]] = True
    pairs = np.array([(0.0, 0.0), *((d, s) for d in _DECAYS for s in _SHARES)])
    decay, share = pairs.T[..., None]
    columns = np.concatenate([residual[..., None], bases], axis=-1)
    products = np.zeros((len(pairs), n_channels, n_parameters + 1, n_parameters + 1))
    log_det = np.zeros((len(pairs), n_channels))
    for step, log_variance in _innovations(columns, is_read, decay, share):
        products += step[..., :, None] * step[..., None, :]
        log_det += log_variance
    inner = products[..., 1:, 1:] + np.eye(n_parameters) * ~is_used[:, :, None]
    mixed = products[..., 1:, :1]
    explained = np.sum(mixed * np.linalg.solve(inner, mixed), axis=(-2, -1))
    freedom = is_read.sum(axis=0) - is_used.sum(axis=1)
    variance = np.maximum(products[..., 0, 0] - explained, 1e-12) / np.maximum(freedom, 1)
    log_det += np.linalg.slogdet(inner)[1]
    likelihood = -0.5 * (freedom * np.log(variance) + log_det)
    apart = np.arange(n_rows)
    of_mean = variance * (
        1.0 + share * (decay**apart @ (1.0 - apart / n_rows) * 2.0 - 2.0)[:, None]
    )
    highest = likelihood.max(axis=0)
    above_white = highest - likelihood[0]
    # White noise is exceeded by less than 1 in each channel; by more in all, none of them is white.
    together = float(np.sum(np.minimum(above_white, _NOT_EXCLUDED) - 1.0))
    is_likely = likelihood >= highest - np.clip(together, above_white, _NOT_EXCLUDED)
    chosen = np.argmax(np.where(is_likely, of_mean, -np.inf), axis=0)
    chosen[freedom < _LEAST_FREEDOM] = 0
    of_chosen = variance[chosen, np.arange(n_channels)] / free
    return *pairs[chosen].T, np.maximum(of_chosen, 1.0)  # the sensors' noise is there in any case


def _innovations(
    columns: FloatArray, is_read: BoolArray, decay: FloatArray, share: FloatArray
) -> Iterator[tuple[FloatArray, FloatArray]]:
    """Yield what each row adds to those before it, over its deviation, and log of its variance.

    Parameters
    ----------
    columns : array (n_rows, n_channels, n_columns)
        0 where not read.
    is_read : array (n_rows, n_channels)
        What was read.
    decay, share : array (…, n_channels)
        Of noise of unit variance.
    """
    expected, doubt = np.zeros((*share.shape, columns.shape[-1])), share
    for row, read in zip(columns, is_read, strict=True):
        variance = doubt + 1.0 - share
        step = np.where(read[:, None], row - expected, 0.0)
        weight = np.where(read, doubt / variance, 0.0)
        yield step / np.sqrt(variance)[..., None], np.where(read, np.log(variance), 0.0)
        expected = decay[..., None] * (expected + weight[..., None] * step)
        doubt = decay**2 * (1.0 - weight) * doubt + (1.0 - decay**2) * share
