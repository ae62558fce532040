"""Drift as a rival: its filter against whole matrices, and what a gain is in noise that drifts."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter

from designer.diagnosis.drift import _innovations, gain_beside_drift

ROWS, CHANNELS = 60, 4


def noise(rng: np.random.Generator, decay: float) -> np.ndarray:
    white = rng.normal(size=(ROWS, CHANNELS))
    white[1:] *= np.sqrt(1.0 - decay**2)
    return np.asarray(lfilter([1.0], [1.0, -decay], white, axis=0))


def gain_of(noise: np.ndarray, effect: np.ndarray) -> float:
    """Return the gain of an effect of one parameter that is fitted by least squares."""
    size = np.sum(noise * effect) / np.sum(effect**2)
    slopes = -effect[..., None]
    return gain_beside_drift(noise, noise - size * effect, slopes, np.array([True]))


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
