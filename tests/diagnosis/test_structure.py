"""The test for structure: its level on noise, and what it finds in a planted dependence."""

from __future__ import annotations

import math
import statistics

import numpy as np
import pytest

from designer.diagnosis.structure import channels_of, find_structure

ROWS, CHANNELS = 80, 6


def covariates_for(rng: np.random.Generator) -> dict[str, np.ndarray]:
    return {name: rng.uniform(-1.0, 1.0, ROWS) for name in "abcdefgh"} | {
        "side": rng.choice([-1.0, 1.0], ROWS)
    }


@pytest.mark.slow
def test_noise_has_structure_as_seldom_as_the_level_says() -> None:
    rng = np.random.default_rng(0)
    covariates = covariates_for(rng)
    found = [
        find_structure(rng.normal(size=(ROWS, CHANNELS)), covariates, settled=True).is_present
        for _ in range(40)
    ]
    assert sum(found) <= 2  # at a level of 1 %, more than 2 of 40 comes once in 140 times


@pytest.mark.parametrize("shape", [lambda z: z, lambda z: z**2], ids=["slope", "parabola"])
def test_a_dependence_is_told_with_its_covariate_and_share(shape) -> None:
    rng = np.random.default_rng(1)
    covariates = covariates_for(rng)
    planted = shape(covariates["c"])
    residual = rng.normal(size=(ROWS, CHANNELS))
    residual[:, 4] += 1.5 * planted / planted.std()
    found = find_structure(residual, covariates, settled=True)
    assert found.is_present
    assert found.carriers[0].name == "c"
    # Of the variance 1 + 1.5² of that channel, 1.5² is planted.
    assert found.carriers[0].fraction_of_variance == pytest.approx(2.25 / 3.25, abs=0.1)


def test_a_covariate_of_two_values_has_no_parabola() -> None:
    rng = np.random.default_rng(2)
    covariates = covariates_for(rng)
    residual = rng.normal(size=(ROWS, CHANNELS)) + 2.0 * covariates["side"][:, None]
    found = find_structure(residual, covariates, settled=True)
    assert found.carriers[0].name == "side"
    assert 0.0 < found.carriers[0].fraction_of_variance <= 1.0


def test_channels_by_hand() -> None:
    """Median off, clipped at four spreads, gaps at zero, mean off; then the mean over cables."""
    rng = np.random.default_rng(5)
    residual = rng.normal([0.0, 30.0, -5.0, 0.0], [0.1, 20.0, 3.0, 1.0], (60, 4))
    residual[rng.random(residual.shape) < 0.2] = np.nan
    residual[7], residual[8] = 400.0, -9.0
    residual[:, 3] = np.nan  # a load cell that was never read
    expected = []
    for kind in (residual[:, :2], residual[:, 2:3]):
        of_kind = []
        for column in kind.T:
            read = [value for value in column if not np.isnan(value)]
            middle = statistics.median(read)
            spread = statistics.median(abs(value - middle) for value in read)
            most = 4.0 * max(1.4826 * spread, 1.0)
            filled = [0.0 if np.isnan(v) else min(max(v - middle, -most), most) for v in column]
            of_kind.append([value - sum(filled) / 60.0 for value in filled])
        both = [sum(values) / math.sqrt(2.0) for values in zip(*of_kind, strict=True)]
        expected += [*of_kind, both]
    assert channels_of(residual) == pytest.approx(np.transpose(expected), rel=1e-4, abs=1e-4)


def test_gaps_and_outliers_do_not_hide_it() -> None:
    rng = np.random.default_rng(3)
    covariates = covariates_for(rng)
    residual = rng.normal(size=(ROWS, CHANNELS)) + 1.5 * covariates["a"][:, None]
    residual[rng.random(residual.shape) < 0.1] = np.nan
    residual[3, 2] = 500.0
    assert find_structure(residual, covariates, settled=True).carriers[0].name == "a"


def test_nothing_measured_and_nothing_recorded() -> None:
    rng = np.random.default_rng(4)
    covariates = covariates_for(rng)
    nothing = np.full((ROWS, CHANNELS), np.nan)
    assert not find_structure(nothing, covariates, settled=True).is_present
    assert not find_structure(rng.normal(size=(ROWS, CHANNELS)), {}, settled=True).is_present
