"""The test for structure: its level on noise, what it goes with, events, what a fit gives up."""

from __future__ import annotations

import math
import statistics
from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lfilter
from twins.logs import write_printer

from designer.diagnosis.case import case_of
from designer.diagnosis.diagnose import diagnose
from designer.diagnosis.result import DiagnosisVerdict
from designer.diagnosis.structure import (
    Event,
    Structure,
    channels_of,
    find_common,
    find_events,
    find_spreading,
    find_structure,
    find_swapped,
    smooth_correction,
    with_gross_errors,
    wrong_poses,
)
from designer.effects.effect import frame_size_m
from designer.io.config import read_study
from designer.measured.read import read_measured

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


N_ROWS, CABLES = 100, 3
NUMBERS = np.arange(1, N_ROWS + 1)
LENGTHS_M = np.random.default_rng(9).uniform(3.0, 9.0, (N_ROWS, CABLES))


def readings(seed: int = 0) -> tuple[np.ndarray, np.ndarray, dict[str, np.ndarray]]:
    """Residual and prediction in units of noise, and covariates."""
    rng = np.random.default_rng(seed)
    predicted = rng.uniform(-50.0, 50.0, (N_ROWS, 2 * CABLES))
    covariates = {f"tension_{k + 1}_N": predicted[:, CABLES + k] for k in range(CABLES)}
    covariates |= {"row": NUMBERS.astype(float), "x_m": rng.uniform(0.0, 1.0, N_ROWS)}
    return rng.normal(size=(N_ROWS, 2 * CABLES)), predicted, covariates


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
    slow_m = 6.0 + 3.0 * np.sin(np.outer(np.arange(N_ROWS) / 8.0, [1.0, 1.1, 1.2]))
    for seed in range(10):
        white = np.random.default_rng(seed).normal(size=(N_ROWS, 2 * CABLES))
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
    residual[:, 1] += np.linspace(-8.0, 8.0, N_ROWS)
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
    rows = np.arange(N_ROWS)[:, None]
    growing = rng.normal(size=(N_ROWS, 2 * CABLES)) * (0.5 + 3.0 * rows / N_ROWS)
    event = find_spreading(growing)
    assert event is not None
    assert event.text.startswith("scatter that changes as the rows go on, from ")
    assert event.place == "scatter"
    assert find_spreading(growing[:20]) is None  # too few to tell
    for seed in range(20):
        noise = np.random.default_rng(seed).normal(size=(N_ROWS, 2 * CABLES))
        assert find_spreading(noise) is None
        assert find_spreading(noise + 0.2 * rows) is None


@pytest.mark.filterwarnings("error")
def test_a_covariate_that_stands_still_in_the_fitted_rows_corrects_by_their_mean() -> None:
    rng = np.random.default_rng(0)
    residual = rng.normal(2.0, 0.1, (24, 2))
    heldout = np.arange(24) >= 16
    covariate = np.where(heldout, np.arange(24.0), 5.0)
    found = smooth_correction(residual, "time_s", covariate, heldout)
    assert found.heldout_before > 1.8
    assert found.heldout_after < 0.3


NOTHING = Structure((), 1.0)


def texts(residual: np.ndarray, unfitted: np.ndarray | None = None) -> list[str]:
    rows = np.arange(1, len(residual) + 1)
    before = 10.0 * residual if unfitted is None else unfitted
    return [e.text for e in with_gross_errors(NOTHING, residual, before, rows).events]


def noise(rows: int = 40) -> np.ndarray:
    residual = np.random.default_rng(0).normal(size=(rows, 6))
    residual[:, 4] = np.nan
    return residual


def test_readings_of_a_cable_far_off_are_named_with_their_rows() -> None:
    residual = noise()
    residual[6, 1], residual[9, 1] = 424.0, -155.0
    (text,) = texts(residual)
    assert (
        text == "cable 2, off by 155 to 424 times the noise in rows 7, 10: its winch or its sensors"
    )


@pytest.mark.parametrize(
    "off", [[], [(3, 1)], [(3, 1), (5, 2)], [(3, 1), (5, 1), (8, 0), (9, 2), (20, 5)]]
)
def test_accidents_here_and_there_are_none(off: list[tuple[int, int]]) -> None:
    residual = noise()
    for place in off:
        residual[place] = 60.0
    assert texts(residual) == []


def test_rows_in_which_all_cables_stand_off_have_wrong_poses() -> None:
    residual = noise()
    residual[[4, 20, 21], :4] = 90.0
    residual[9, 5] = 300.0  # one cell
    residual[12, [3, 5]] = 50.0  # a load that all cells feel
    assert np.flatnonzero(wrong_poses(residual)).tolist() == [4, 20, 21]
    (text,) = texts(residual)
    assert text == (
        "15 of 200 readings that stand off, by up to 300 times the noise, "
        "of rows with wrong poses: 5, 21 to 22"
    )
    tensions = np.where(np.arange(6) < 3, np.nan, noise(40))
    tensions[7, [3, 5]] = 40.0  # the only readings
    assert np.flatnonzero(wrong_poses(tensions)).tolist() == [7]


def test_plugs_that_are_exchanged_are_told_alone() -> None:
    exchanged = Structure((), 1.0, events=(Event("length 1 and …", 1.0, 0.0, "mistake"),))
    residual = noise()
    residual[:, 1] = 500.0
    structure = with_gross_errors(exchanged, residual, residual, np.arange(1, 41))
    assert structure is exchanged


def test_a_fit_that_makes_all_rows_together_worse_is_told() -> None:
    residual = noise()
    residual[3, 1], residual[5, 2] = 60.0, 60.0
    better = np.where(np.abs(residual) > 50.0, 40.0, 3.0 * residual)
    assert texts(residual, better)[0].endswith("all that was fitted helps nothing")


def doubled(folder, factor: float):
    """Return the case of a printer whose fourth line moves by a multiple of what is counted."""
    path = write_printer(folder, drum_scale=1.0, rows=22, seed=1)
    lines = (folder / "log.csv").read_text().splitlines()
    cells = [line.split(",") for line in lines]
    at = cells[0].index("motorD_deg")
    heights = [float(row[3]) for row in cells[1:-2]]
    # Nearly all poses are on the bed, as in that log: two alone tell.
    low = sorted(range(len(heights)), key=heights.__getitem__)
    for row in cells[1:]:
        row[at] = str(factor * float(row[at]))
    kept = [cells[0], *(cells[1 + k] for k in sorted([*low[:14], *low[-2:]]))]
    (folder / "log.csv").write_text("\n".join(map(",".join, kept)) + "\n")
    text = path.read_text().replace("[length_offset]", "[anchors, length_offset]")
    path.write_text(text)
    study = read_study(path)
    assert study.measurements is not None
    return case_of(study, study.measurements, read_measured(study))


@pytest.mark.slow
def test_a_line_of_double_advantage_is_no_agreement(tmp_path) -> None:
    case = doubled(tmp_path, 2.0)
    found = diagnose(replace(case, candidates=()))
    assert not found.is_positive
    assert found.verdict in (DiagnosisVerdict.UNEXPLAINED, DiagnosisVerdict.IMPLAUSIBLE)
    told = " ".join([*found.doubts, *(e.text for e in found.structure_after.events)])
    assert "cable 4" in told


def test_what_is_plausible_of_unknowns(tmp_path) -> None:
    """A tenth of the frame and 0.1 m, or what the study says."""
    case = doubled(tmp_path, 1.0)
    limit = 0.1 * frame_size_m(case.machine) + 0.1
    for effect in case.given:
        assert {p.plausible for p in effect.parameters} == {(-limit, limit)}
    path = tmp_path / "study.yaml"
    own = "[anchors, length_offset]\n  plausible: {anchors: 30 cm, length_offset: 2 m}"
    path.write_text(path.read_text().replace("[anchors, length_offset]", own))
    study = read_study(path)
    assert study.measurements is not None
    given = case_of(study, study.measurements, read_measured(study)).given
    ends = {(e.id, p.plausible[1]) for e in given for p in e.parameters}
    assert ends == {("anchor_offset", 0.3), ("length_offset", 2.0)}
