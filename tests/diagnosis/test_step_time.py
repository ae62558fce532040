"""When a step sets in: between which rows, how surely, and in a fit that starts at a wrong time."""

from __future__ import annotations

import numpy as np
import pytest
from twins.robots import YARD3
from twins.troubles import troubled

from designer.cli.tables import _estimated
from designer.diagnosis.case import case_of
from designer.diagnosis.fit import fit, step_time
from designer.diagnosis.problem import Predictor, Problem
from designer.diagnosis.result import Estimate
from designer.effects.effect import Setting
from designer.io.config import read_study
from designer.measured.read import read_measured
from designer.model.measured_data import Noise


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
