"""Drift as a rival: its filter against whole matrices, and what a gain is in noise that drifts."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter

from designer.diagnosis.drift import _innovations, _shared_innovations, linear_gain_in_drift

ROWS, CHANNELS = 60, 4


def noise(rng: np.random.Generator, decay: float) -> np.ndarray:
    white = rng.normal(size=(ROWS, CHANNELS))
    white[1:] *= np.sqrt(1.0 - decay**2)
    return np.asarray(lfilter([1.0], [1.0, -decay], white, axis=0))


def gain_of(noise: np.ndarray, effect: np.ndarray) -> float:
    """Return the gain of an effect of one parameter that is fitted by least squares."""
    size = np.sum(noise * effect) / np.sum(effect**2)
    slopes = -effect[..., None]
    return linear_gain_in_drift(noise, noise - size * effect, slopes, np.array([True]))


@pytest.mark.parametrize(("decay", "share"), [(0.9, 0.4), (0.995, 1.0), (0.0, 0.0)])
def test_the_filter_makes_white_what_the_whole_covariance_does(decay: float, share: float) -> None:
    rng = np.random.default_rng(0)
    columns = rng.normal(size=(30, 1, 2))
    is_read = rng.random((30, 1)) > 0.3
    columns[~is_read] = 0.0
    steps = list(_innovations(columns, is_read, np.array([decay]), np.array([share])))
    white = np.concatenate([step for step, _ in steps])
    rows = np.flatnonzero(is_read[:, 0])
    covariance = share * decay ** np.abs(rows[:, None] - rows) + (1.0 - share) * np.eye(len(rows))
    seen = columns[rows, 0]
    assert white.T @ white == pytest.approx(seen.T @ np.linalg.solve(covariance, seen))
    assert sum(log.sum() for _, log in steps) == pytest.approx(np.linalg.slogdet(covariance)[1])


@pytest.mark.slow
@pytest.mark.parametrize("decay", [0.9, 0.97])
def test_a_constant_gains_nothing_in_noise_that_lasts(decay: float) -> None:
    rng = np.random.default_rng(1)
    effect = np.ones((ROWS, 1)) * [1.0, 0.0, 0.0, 0.0]
    gains = np.array([gain_of(noise(rng, decay), effect) for _ in range(200)])
    # By independent rows a gain of 20 comes once in 130 000 times.
    assert np.sum(gains > 20.0) == 0


def test_an_effect_is_told_from_noise_by_a_shape_that_no_drift_has() -> None:
    rng = np.random.default_rng(2)
    effect = rng.normal(size=(ROWS, CHANNELS))
    for decay in (0.0, 0.97):
        alone = gain_of(noise(rng, decay), effect)
        assert alone < 12.0
        assert gain_of(noise(rng, decay) + 0.5 * effect, effect) > alone + 25.0


def test_a_constant_is_found_in_white_noise() -> None:
    rng = np.random.default_rng(3)
    effect = np.ones((ROWS, CHANNELS))
    assert gain_of(noise(rng, 0.0) + effect, effect) > 40.0


def left_of_errors(rng: np.random.Generator, is_read: np.ndarray) -> np.ndarray:
    """Return what is left of errors where each row takes one number from its own readings."""
    along = rng.normal(size=(ROWS, CHANNELS, 1)) * is_read[..., None]
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-9)
    left = np.eye(CHANNELS) * is_read[:, None, :]  # what was not read has no error
    return np.asarray(left - along @ np.swapaxes(along, 1, 2))


def test_errors_that_a_row_mixes_are_made_white_as_by_the_whole_covariance() -> None:
    rng = np.random.default_rng(4)
    decay, share, variance = np.array([[0.97, 0.9, 0.995, 0.0], [1.0, 0.4, 0.9, 0.0], [2, 1, 3, 1]])
    is_read = rng.random((ROWS, CHANNELS)) > 0.2
    shares = left_of_errors(rng, is_read)
    columns = shares @ rng.normal(size=(ROWS, CHANNELS, 2))
    white = _shared_innovations(columns, is_read, shares, (decay, share, variance))
    lags = np.abs(np.subtract.outer(np.arange(ROWS), np.arange(ROWS)))[..., None]
    alike = share * decay**lags + (1.0 - share) * (lags == 0)
    sensors = np.einsum("rsc,cd->rcsd", alike * variance, np.eye(CHANNELS))
    whole = np.einsum("rac,rcsd,sbd->rasb", shares, sensors, shares).reshape([ROWS * CHANNELS] * 2)
    seen = columns.reshape(-1, 2)
    expected = seen.T @ np.linalg.pinv(whole, rcond=1e-9, hermitian=True) @ seen
    flat = white.reshape(-1, 2)
    assert flat.T @ flat == pytest.approx(expected, rel=1e-6)


@pytest.mark.slow
def test_zeros_gain_nothing_in_sensors_that_drift_however_rows_mix_them() -> None:
    rng = np.random.default_rng(5)
    every, is_read = np.ones(CHANNELS, dtype=np.bool_), np.ones((ROWS, CHANNELS), dtype=np.bool_)
    known, unknown = [], []
    for _ in range(100):
        shares = left_of_errors(rng, is_read)
        left = np.einsum("rcd,rd->rc", shares, 5.0 * noise(rng, 0.97))
        zeros = np.linalg.lstsq(shares.reshape(-1, CHANNELS), left.ravel(), rcond=None)[0]
        after = left - shares @ zeros
        known.append(linear_gain_in_drift(left, after, -shares, every, shares=shares))
        unknown.append(linear_gain_in_drift(left, after, -shares, every))
    # By chance 27 is exceeded once in 50 000 times.
    assert max(known) < 27.0
    assert np.median(unknown) > 27.0  # what the mixing is known for
