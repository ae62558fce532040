"""Fits: readings that are alike, times of steps, slopes and deviations at the edge."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import lfilter
from twins.dataset import make
from twins.robots import YARD3
from twins.troubles import troubled

from designer.diagnosis.calibration import calibration_of
from designer.diagnosis.case import case_of
from designer.diagnosis.command import _estimated
from designer.diagnosis.fit import fit, jacobian, step_time
from designer.diagnosis.problem import Predictor, Problem, SlopeCache, readings_of
from designer.diagnosis.result import Estimate
from designer.diagnosis.statistics import Lasting, is_outlier, lasting, score_covariances
from designer.effects.effect import Effect, Parameter, Setting, Size
from designer.io.config import read_study
from designer.measured.read import read_measured
from designer.model.measurements import Noise
from designer.model.robot import Poses
from designer.units import LENGTH

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


def test_a_clear_step_lies_midway_between_two_rows() -> None:
    time_s = np.cumsum(np.random.default_rng(1).uniform(60.0, 300.0, 40))
    late = np.arange(40) >= 23
    found = step_time(time_s, np.where(late, 1e3, 0.0), np.where(late, 0.0, 1e3), 1.0)
    assert found is not None
    gap_s = time_s[23] - time_s[22]
    assert found.time_s == pytest.approx(time_s[22] + 0.5 * gap_s)
    assert found.std_s == pytest.approx(gap_s / np.sqrt(12.0))


def test_the_order_of_the_rows_does_not_matter() -> None:
    rng = np.random.default_rng(2)
    time_s, before, after = rng.uniform(0.0, 1e4, 60), *rng.chisquare(2.0, (2, 60))
    order = rng.permutation(60)
    shuffled = step_time(time_s[order], before[order], after[order], 1.0)
    assert shuffled == pytest.approx(step_time(time_s, before, after, 1.0))


def test_the_deviation_is_that_of_the_times_found() -> None:
    rng = np.random.default_rng(3)
    off = []
    for _ in range(500):
        time_s = np.cumsum(rng.uniform(0.5, 1.5, 60))
        true_s = rng.uniform(time_s[20], time_s[40])
        reading = 1.5 * (time_s >= true_s) + rng.normal(size=60)
        found = step_time(time_s, reading**2, (reading - 1.5) ** 2, 1.0)
        assert found is not None
        off.append((found.time_s - true_s) / found.std_s)
    assert np.sqrt(np.mean(np.square(off))) == pytest.approx(1.0, abs=0.15)


@pytest.mark.parametrize("n_rows", [9, 40])
def test_too_few_rows_show_no_time(n_rows: int) -> None:
    losses = np.ones((2, n_rows))
    losses[1, :9] = 0.0  # the others are the same with the step and without it
    assert step_time(np.arange(n_rows, dtype=float), *losses, 1.0) is None


def test_a_fit_finds_the_time_from_a_wrong_one(tmp_path) -> None:
    troubled(YARD3, "step", 3).write(tmp_path)
    study = read_study(tmp_path / "config.yaml")
    assert study.measurements is not None
    case = case_of(study, study.measurements, read_measured(study))
    noise = Noise(YARD3.noise_m, YARD3.noise_N, "declared")
    problem = Problem(case.measured, Predictor(case.machine, case.measured), noise)
    (effect,) = (e for e in case.candidates if e.id == "load_step")
    rows, time_s = np.ones(case.measured.n_rows, dtype=np.bool_), case.measured.time_s
    found = fit(problem, [effect], rows, thorough=True)
    for wrong in (8, -8):
        start = Setting(effect, {**found.settings[0].values, "time_s": float(time_s[wrong])})
        again = fit(problem, [effect], rows, [start], thorough=True)
        assert again.vector == pytest.approx(found.vector, rel=1e-3)
    gap = np.searchsorted(time_s, found.vector[1])
    assert found.std == pytest.approx([found.std[0], np.ptp(time_s[gap - 1 : gap + 1]) / 12**0.5])
    assert found.covariance[1, 1] == pytest.approx(found.std[1] ** 2)


def test_no_infinite_deviation_is_printed() -> None:
    assert _estimated(Estimate(11.5, 0.25)) == "11.5 ± 0.25"
    assert _estimated(Estimate(11.5, np.inf)) == "11.5 (not determined by these rows)"


STRETCH = Effect(
    id="stretch",
    summary="each length is so many times the value",
    law="length is slope times value",
    source="made for this test",
    parameters=(Parameter("x_m", LENGTH, Size(0.1, (-2.0, 2.0), (-2.0, 2.0))),),
    on_readings=lambda readings, values, measured: readings,
)


def in_noise(settings):
    (setting,) = settings
    x = setting.values["x_m"]
    rows = np.array([[3.0 * x, 0.0], [5.0 * x, 0.0], [7.0 * x, 0.0], [9.0 * x, 0.0]])
    rows[1, x > 1.0] = np.nan  # held up to 1
    rows[2, x < 1.0] = np.nan  # held from 1 on
    rows[3] = np.nan
    return rows / [0.5, 1.0]


def test_a_row_tells_its_slope_from_the_side_on_which_it_is_held():
    readings = np.array([[0.0, np.nan]] * 4)
    problem = SimpleNamespace(
        noise=None,
        measured=SimpleNamespace(is_read=~np.isnan(readings)),
        in_noise=in_noise,
        predicted=in_noise,
        predict=SimpleNamespace(
            slopes=SlopeCache(), distrust=lambda settings, noise: (1.0, 1.0), row_unknowns=0
        ),
    )
    slopes = jacobian(problem, [STRETCH], np.array([1.0]))
    # A residual is (measured - predicted) / noise; a row that is held on neither side has no slope.
    assert np.allclose(slopes[:, 0, 0], [-6.0, -10.0, -14.0, 0.0])
    assert np.isnan(slopes[:, 1]).all()


EDGE = 7
"""Place of the row next to the line between two exit points, where the third cable hangs slack."""


def calibrated(folder, *, y_m):
    """Return the calibration of the scale of poses, by exact poses and lengths to 1 mm."""
    make(YARD3, {}, rows=32, seed=5).write(folder)
    study = read_study(folder / "config.yaml")
    case = case_of(study, study.measurements, read_measured(study))
    position = case.measured.poses.position_m.copy()
    position[EDGE] = [15.0, y_m, 5.0]
    true = readings_of(case.machine, Poses.at(position))
    length = true.length_m + 0.001 * np.random.default_rng(4).normal(size=position.shape)
    unread = np.full_like(length, np.nan)
    measured = replace(
        case.measured, poses=Poses.at(position), length_m=length, tension_N=unread, settled=True
    )
    case = replace(case, measured=measured)
    problem = Problem(measured, case.predictor(), Noise(0.001, 4.0, "declared"))
    (scale,) = (e for e in case.candidates if e.id == "pose_scale")
    fitted = fit(problem, [scale], np.ones(32, dtype=np.bool_), thorough=True)
    return calibration_of(problem, fitted)


def test_a_slack_cable_does_not_make_the_scale_more_certain_than_poses_are(tmp_path):
    at_the_edge, within = (calibrated(tmp_path, y_m=y_m) for y_m in (0.03, 6.0))
    assert at_the_edge.edge_rows == (EDGE + 1,)
    assert within.edge_rows == ()
    (scale_there,), (scale_within,) = at_the_edge.parameters, within.parameters
    assert abs(scale_within.value - 1.0) < 3.0 * scale_within.std
    assert scale_there.std == pytest.approx(scale_within.std, rel=0.3)
