"""Readings that are alike tell less than as many independent ones."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter

from designer.diagnosis.statistics import Lasting, is_outlier, lasting, score_covariances

ROWS, CHANNELS = 120, 6


def serial(rng: np.random.Generator, decay: float) -> np.ndarray:
    white = np.sqrt(1 - decay**2) * rng.normal(size=(ROWS + 100, CHANNELS))
    return np.asarray(lfilter([1.0], [1.0, -decay], white, axis=0))[100:]


def test_noise_that_lasts_is_told_from_noise_that_does_not() -> None:
    rng = np.random.default_rng(0)
    white = [lasting(rng.normal(size=(ROWS, CHANNELS))).share for _ in range(40)]
    assert sum(share > 0.0 for share in white) <= 2
    found = [lasting(serial(rng, 0.9)) for _ in range(20)]
    assert np.median([one.share * one.decay for one in found]) == pytest.approx(0.9, abs=0.05)
    # A mean over rows with correlation 0.9ᵏ tells as little as one of 19 rows.
    assert np.median([one.rows for one in found]) == pytest.approx(19.0, rel=0.15)


def test_channels_that_share_an_error_count_once() -> None:
    rng = np.random.default_rng(1)
    shared = np.repeat(rng.normal(size=(ROWS, 1)), CHANNELS, axis=1)
    of_rows, _, of_both = score_covariances(np.ones((ROWS, CHANNELS, 1)), shared)
    for found in (of_rows, of_both):
        assert found[0, 0] == pytest.approx(ROWS * CHANNELS**2, rel=0.35)


def test_an_outlier_stands_off_by_five_spreads_and_by_five_times_the_noise() -> None:
    bulk = np.linspace(-1.0, 1.0, 41)  # its spread is 0.74
    quiet, loud = np.append(0.1 * bulk, [4.0, 6.0]), np.append(4.0 * bulk, [10.0, 20.0])
    residual = np.column_stack([quiet, loud])
    found = is_outlier(residual)
    assert found[-1].all()
    assert not found[:-1].any()


def test_deviation_of_an_offset_under_lasting_noise() -> None:
    """The offset of one channel, estimated by its mean over many sets, against what is stated."""
    rng = np.random.default_rng(2)
    slopes = np.zeros((ROWS, CHANNELS, 1))
    slopes[:, 0, 0] = 1.0
    means, stated = [], []
    for _ in range(60):
        noise = serial(rng, 0.9)
        means.append(noise[:, 0].mean())
        left = noise - noise.mean(axis=0)
        stated.append(np.sqrt(max(one[0, 0] for one in score_covariances(slopes, left))) / ROWS)
    assert np.median(stated) == pytest.approx(np.std(means), rel=0.35)
    assert np.std(means) > 3.0 / np.sqrt(ROWS)  # three times what independent rows would have


def test_a_correlation_between_rows_is_applied_and_drawn_without_its_matrix() -> None:
    lasts = Lasting(0.6, 0.9)
    apart = np.abs(np.subtract.outer(np.arange(40), np.arange(40)))
    matrix = np.where(apart == 0, 1.0, 0.6 * 0.9**apart)
    rng = np.random.default_rng(3)
    columns = rng.normal(size=(40, 5))
    assert lasts.correlated(columns) == pytest.approx(matrix @ columns, rel=1e-12)
    drawn = lasts.draw(rng, (40, 20_000))
    assert np.cov(drawn) == pytest.approx(matrix, abs=0.05)


def test_rows_whose_square_fills_no_memory() -> None:
    """Of 200 000 rows a matrix between all of them would take 320 GB."""
    noise = np.random.default_rng(4).normal(size=(200_000, 2))
    noise = np.asarray(lfilter([1.0], [1.0, -0.9], noise, axis=0))
    *_, found = score_covariances(np.ones((len(noise), 2, 1)), noise)
    assert found[0, 0] == pytest.approx(2 * len(noise) / (1.0 - 0.9) ** 2, rel=0.1)
