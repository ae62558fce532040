"""Pose and tensions from lengths alone, on twins whose physics shares nothing with the model."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.stats
from scipy.spatial.transform import Rotation
from twins.dataset import make
from twins.robots import HALL6, HALL8, YARD3

from designer.diagnosis.accuracy import _turn_rad, bootstrap, forward_error, with_sound_lengths
from designer.diagnosis.case import case_of
from designer.diagnosis.problem import Predictor, Problem
from designer.diagnosis.statistics import heldout_rows
from designer.effects.effect import Setting
from designer.io.config import read_study
from designer.measured.read import read_measured
from designer.model.measurements import Noise
from designer.model.robot import Poses


def problem_and_case(robot, effects, folder, **how):
    make(robot, effects, rows=48, seed=3, **how).write(folder)
    study = read_study(folder / "config.yaml")
    measured = read_measured(study)
    case = case_of(study, study.measurements, measured)
    noise = Noise(robot.noise_m, robot.noise_N, "declared")
    return Problem(measured, Predictor(case.machine, measured), noise), case


@pytest.mark.parametrize("robot", [YARD3, HALL6, HALL8], ids=lambda robot: robot.name)
def test_lengths_without_noise_lead_to_the_pose(robot, tmp_path) -> None:
    truth = {
        "elastic_modulus": {"scale": 0.8},
        "cable_modulus": {"cable": 2, "scale": 0.7},
        "drum_scale": {"scale": 1.002},
    }
    problem, case = problem_and_case(robot, truth, tmp_path, noise=0.0)
    settings = [
        Setting(
            next(e for e in case.candidates if (e.id, e.cable) == (key, values.get("cable"))),
            {name: value for name, value in values.items() if name != "cable"},
        )
        for key, values in truth.items()
    ]
    heldout = heldout_rows(48)
    blind = forward_error(problem, (), heldout)
    found = forward_error(problem, settings, heldout)
    assert found.n_rows == found.n_solved == heldout.sum()
    # The table has six decimals of a metre.
    assert found.position_m.value < 1e-5
    assert found.position_m.value < 1e-3 * blind.position_m.value
    assert (found.turn_rad is None) == (robot is YARD3)
    if found.turn_rad is not None:
        assert found.turn_rad.value < 1e-5


def test_a_length_that_stands_off_is_left_out(tmp_path) -> None:
    problem, case = problem_and_case(YARD3, {}, tmp_path)
    heldout = heldout_rows(48)
    row = int(np.flatnonzero(heldout)[2])
    sound = heldout & with_sound_lengths(problem, ())
    clean = forward_error(problem, (), sound)
    length = problem.measured.length_m.copy()
    length[row, 0] += 1.0
    measured = replace(problem.measured, length_m=length)
    spoilt = Problem(measured, Predictor(case.machine, measured), problem.noise)
    wild = forward_error(spoilt, (), heldout & with_sound_lengths(spoilt, ()))
    assert wild.n_rows == clean.n_rows - 1
    assert wild.position_m.value < 1.5 * clean.position_m.value


def test_without_lengths_there_is_nothing_to_foretell(tmp_path) -> None:
    make(YARD3, {}, rows=48).write(tmp_path, ("tension",))
    study = read_study(tmp_path / "config.yaml")
    measured = read_measured(study)
    case = case_of(study, study.measurements, measured)
    noise = Noise(YARD3.noise_m, YARD3.noise_N, "declared")
    problem = Problem(measured, Predictor(case.machine, measured), noise)
    sound = with_sound_lengths(problem, ())
    assert not sound.any()
    assert forward_error(problem, (), sound) is None


@pytest.mark.parametrize("turn_deg", [0.0, 1e-4, 30.0, 120.0, 179.0])
def test_the_turn_between_poses_is_told_at_any_angle(turn_deg: float) -> None:
    axis = np.array([1.0, -2.0, 2.0]) / 3.0
    target = Rotation.from_euler("xyz", [10.0, 20.0, -30.0], degrees=True)
    turned = target * Rotation.from_rotvec(turn_deg * axis, degrees=True)
    poses, targets = (Poses(np.zeros((1, 3)), r.as_matrix()[None]) for r in (turned, target))
    assert np.degrees(_turn_rad(poses, targets)) == pytest.approx([turn_deg], rel=1e-7, abs=1e-9)


def test_an_interval_is_the_one_of_scipy() -> None:
    """Whole thirds of blocks drawn with replacement; both ends to a seventh of the half-width."""
    rng = np.random.default_rng(3)
    block = np.repeat(np.arange(12), 5)
    unseen = rng.normal(size=(60, 3)) * rng.uniform(0.5, 2.0, (60, 1))
    unseen[rng.random(unseen.shape) < 0.1] = np.nan
    number = (np.arange(60) * 36) // 60  # rows of each third of a block

    def rms_of(drawn: np.ndarray) -> float:
        rows = np.concatenate([unseen[number == k] for k in drawn.astype(int)])
        return float(np.sqrt(np.nansum(rows**2) / np.sum(np.isfinite(rows))))

    theirs = scipy.stats.bootstrap(
        (np.arange(36.0),), rms_of, n_resamples=4000, method="percentile", vectorized=False, rng=rng
    ).confidence_interval
    ours = bootstrap(unseen, block)
    half = 0.5 * (theirs.high - theirs.low)
    assert (ours.low, ours.high) == pytest.approx((theirs.low, theirs.high), abs=0.14 * half)
