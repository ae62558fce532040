"""Steps, sensors at the end of their range, exchanged sensors, and outliers with a cause."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter

from designer.diagnosis.structure import (
    find_common,
    find_events,
    find_spreading,
    find_structure,
    find_swapped,
)

ROWS, CABLES = 100, 3
NUMBERS = np.arange(1, ROWS + 1)
LENGTHS_M = np.random.default_rng(9).uniform(3.0, 9.0, (ROWS, CABLES))


def readings(seed: int = 0) -> tuple[np.ndarray, np.ndarray, dict[str, np.ndarray]]:
    """Residual and prediction in units of noise, and covariates."""
    rng = np.random.default_rng(seed)
    predicted = rng.uniform(-50.0, 50.0, (ROWS, 2 * CABLES))
    covariates = {f"tension_{k + 1}_N": predicted[:, CABLES + k] for k in range(CABLES)}
    covariates |= {"row": NUMBERS.astype(float), "x_m": rng.uniform(0.0, 1.0, ROWS)}
    return rng.normal(size=(ROWS, 2 * CABLES)), predicted, covariates


def events_in(residual: np.ndarray, predicted: np.ndarray, covariates) -> list[str]:
    structure = find_structure(residual, covariates, settled=True)
    events = find_events(residual, predicted, LENGTHS_M, structure, NUMBERS)
    return [event.text for event in events]


def test_a_wave_in_its_own_length_is_a_drum_off_centre() -> None:
    residual, predicted, covariates = readings()
    residual[:, 1] += 2.0 * np.sin(2.0 * np.pi * LENGTHS_M[:, 1] / 0.47)
    (text,) = events_in(residual, predicted, covariates)
    assert text.startswith("a wave in length 2, 0.471 m long and 2 times")


@pytest.mark.slow
def test_noise_that_lasts_is_no_wave_in_a_length_that_moves_slowly() -> None:
    _, predicted, covariates = readings()
    slow_m = 6.0 + 3.0 * np.sin(np.outer(np.arange(ROWS) / 8.0, [1.0, 1.1, 1.2]))
    for seed in range(10):
        white = np.random.default_rng(seed).normal(size=(ROWS, 2 * CABLES))
        residual = lfilter([0.3], [1.0, -0.95], white, axis=0)
        structure = find_structure(residual, covariates, settled=False)
        events = find_events(residual, predicted, slow_m, structure, NUMBERS)
        assert not [event for event in events if "wave" in event.text]


def test_noise_has_no_events() -> None:
    for seed in range(6):
        residual, predicted, covariates = readings(seed)
        assert events_in(residual, predicted, covariates) == []
        assert find_swapped(residual, predicted, NUMBERS) is None
        assert find_common(residual, covariates, NUMBERS) is None


def test_a_step_is_told_with_its_row() -> None:
    residual, predicted, covariates = readings()
    residual[60:, 1] += 8.0
    assert events_in(residual, predicted, covariates) == ["a step at row 61"]


def test_a_trend_is_no_step() -> None:
    residual, predicted, covariates = readings()
    residual[:, 1] += np.linspace(-8.0, 8.0, ROWS)
    assert events_in(residual, predicted, covariates) == []


def test_a_sensor_at_the_end_of_its_range_is_told_and_a_gain_is_not() -> None:
    residual, predicted, covariates = readings()
    gain = residual.copy()
    gain[:, 4] -= 0.1 * predicted[:, 4]
    assert events_in(gain, predicted, covariates) == []
    residual[:, 4] -= np.maximum(predicted[:, 4] - 30.0, 0.0)
    assert events_in(residual, predicted, covariates) == ["the upper end of the range of tension 2"]


def test_exchanged_sensors_are_told() -> None:
    residual, predicted, _ = readings()
    read = predicted + residual
    read[:, [3, 5]] = read[:, [5, 3]]
    found = find_swapped(read - predicted, predicted, NUMBERS)
    assert found is not None
    assert found.text == "tension 1 and tension 3 exchanged with each other"
    read[:, [0, 1, 2]] = read[:, [2, 0, 1]]
    found = find_swapped(read - predicted, predicted, NUMBERS)
    assert found is not None
    assert found.text == (
        "length 1, length 2 and length 3 exchanged in a ring, "
        "tension 1 and tension 3 exchanged with each other"
    )
    unread = read - predicted
    unread[:, 1] = np.nan
    found = find_swapped(unread, predicted, NUMBERS)
    assert found is not None
    assert "ring" not in found.text
    biased = residual + 40.0
    assert find_swapped(biased, predicted, NUMBERS) is None


def test_readings_that_stand_off_together_have_something_in_common() -> None:
    residual, _, covariates = readings()
    rng = np.random.default_rng(1)
    scattered = residual + np.where(rng.random(residual.shape) < 0.03, 40.0, 0.0)
    assert find_common(scattered, covariates, NUMBERS) is None
    residual[70:90, 2] += 25.0
    found = find_common(residual, covariates, NUMBERS)
    assert found is not None
    assert found.text.startswith("the 20 readings that stand off: 20 are of length 3, ")
    assert "20 of 20 rows from 71 to 90" in found.text


def test_many_readings_that_stand_off_are_looked_at_in_flat_memory() -> None:
    """Of 100 000 rows that stand off all pairs would take 40 GB."""
    rng = np.random.default_rng(5)
    rows = 300_000
    residual = rng.normal(size=(rows, 2 * CABLES))
    residual[50_000:150_000, 1] += 40.0
    event = find_common(residual, {"x_m": rng.uniform(0.0, 1.0, rows)}, np.arange(1, rows + 1))
    assert event is not None
    assert "100000 rows from 50001 to 150000" in event.text
    assert "quarter of x_m" not in event.text


def test_two_cables_exchanged_from_a_row_on_are_told_with_it() -> None:
    residual, predicted, _ = readings()
    read = residual + predicted
    read[40:, [0, 2]] = read[40:, [2, 0]]
    read[40:, [3, 5]] = read[40:, [5, 3]]
    event = find_swapped(read - predicted, predicted, NUMBERS)
    assert event is not None
    assert event.text == (
        "length 1 and length 3 exchanged with each other from row 41 on, "
        "tension 1 and tension 3 exchanged with each other from row 41 on"
    )
    read[10:14] += 500.0  # a few that are wrong otherwise
    event = find_swapped(read - predicted, predicted, NUMBERS)
    assert event is not None
    assert "from row 41 on" in event.text


def test_scatter_that_grows_is_told_and_a_drift_is_none() -> None:
    rng = np.random.default_rng(3)
    rows = np.arange(ROWS)[:, None]
    growing = rng.normal(size=(ROWS, 2 * CABLES)) * (0.5 + 3.0 * rows / ROWS)
    event = find_spreading(growing)
    assert event is not None
    assert event.text.startswith("scatter that changes as the rows go on, from ")
    assert event.place == "scatter"
    assert find_spreading(growing[:20]) is None  # too few to tell
    for seed in range(20):
        noise = np.random.default_rng(seed).normal(size=(ROWS, 2 * CABLES))
        assert find_spreading(noise) is None
        assert find_spreading(noise + 0.2 * rows) is None
