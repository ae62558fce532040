"""What winches and sensors do by the turn, by the direction of motion and by where they sit."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml
from twins.dataset import DataSet, make
from twins.effects import Parameters
from twins.robots import HALL6, YARD3, TwinRobot

from designer.diagnosis.case import case_of
from designer.diagnosis.check import check
from designer.diagnosis.diagnose import diagnose
from designer.diagnosis.result import Diagnosis
from designer.diagnosis.study import diagnosed_config
from designer.effects.winches import best_wave
from designer.io.config import read_study
from designer.measured.read import read_measured

WAVE = {"cable": 2, "amplitude_m": 0.006, "circumference_m": 0.53, "phase_rad": 0.4}
CASES = [
    (YARD3, "drum_eccentricity", WAVE),
    (YARD3, "backlash", {"play_1_m": 0.006, "play_2_m": 0.004, "play_3_m": -0.007}),
    (YARD3, "encoder_on_rope", {"share": 1.0}),
    (YARD3, "cell_at_platform", {"share": 1.0}),
    (HALL6, "tension_hysteresis", {f"width_{k}_N": 10.0 + 2.0 * k for k in range(1, 7)}),
]


def diagnosed(path: Path) -> Diagnosis:
    study = read_study(path)
    assert study.measurements is not None
    return diagnose(case_of(study, study.measurements, read_measured(study)))


def declaring(dataset: DataSet, folder: Path, **effects: Parameters) -> Path:
    path = dataset.write(folder)
    config = yaml.safe_load(path.read_text(encoding="utf-8")) | {"effects": effects}
    path.write_text(yaml.safe_dump(config), encoding="utf-8")
    return path


@pytest.mark.slow
@pytest.mark.parametrize(("robot", "effect", "true"), CASES, ids=[e for _, e, _ in CASES])
def test_it_is_named_alone_with_its_numbers(
    robot: TwinRobot, effect: str, true: Parameters, tmp_path: Path
) -> None:
    found = diagnosed(make(robot, {effect: true}, rows=100, seed=8801).write(tmp_path))
    assert [finding.effect.id for finding in found.findings] == [effect]
    assert not found.is_unexplained
    (finding,) = found.findings
    assert finding.effect.cable == true.get("cable")
    for name, estimate in finding.parameters.items():
        off = estimate.value - true.get(name, estimate.value)
        if name == "phase_rad":
            off = (off + np.pi) % (2.0 * np.pi) - np.pi
        assert abs(off) < 4.0 * estimate.std


@pytest.mark.slow
def test_an_inclined_pulley_is_found_and_carried_to_the_next_study(tmp_path: Path) -> None:
    pulleys = {"radius_m": 0.15}
    tilt = {"cable": 2, "rx_rad": 0.1, "ry_rad": -0.06}
    dataset = make(YARD3, {"pulley_radius": pulleys, "pulley_inclination": tilt}, seed=8802)
    path = declaring(dataset, tmp_path, pulley_radius=pulleys)
    found = diagnosed(path)
    assert [finding.effect.key for finding in found.findings] == ["pulley_inclination of cable 2"]
    for name, estimate in found.findings[0].parameters.items():
        assert abs(estimate.value - tilt[name]) < 4.0 * estimate.std
    later = tmp_path / "later.yaml"
    later.write_text(diagnosed_config(found, tmp_path), encoding="utf-8")
    study = read_study(later)
    assert study.measurements is not None
    checked = check(study, read_measured(study))
    assert checked.declared.length_m is not None
    assert checked.declared.length_m.rms.value < 1.2 * YARD3.noise_m


def test_rows_that_never_turn_round_show_no_play(tmp_path: Path) -> None:
    dataset = make(YARD3, rows=40, seed=8803)
    one_way_m = np.linspace([9.0, 5.0, 2.0], [12.0, 6.0, 8.0], 40)
    dataset = replace(dataset, scene=replace(dataset.scene, position_m=one_way_m))
    study = read_study(dataset.write(tmp_path))
    assert study.measurements is not None
    skipped = dict(case_of(study, study.measurements, read_measured(study)).skipped)
    assert {skipped[name] for name in ("backlash", "tension_hysteresis")} == {
        "needs cables that pay out and haul in, row after row"
    }
    assert skipped["pulley_inclination of cable 1"] == "needs declared pulleys"


def test_what_is_unknown_may_be_anything_from_nothing_on(tmp_path: Path) -> None:
    study = read_study(make(YARD3, rows=30, seed=8805).write(tmp_path))
    assert study.measurements is not None
    measurements = replace(study.measurements, unknown=("cell_at_platform",))
    (given,) = case_of(study, measurements, read_measured(study)).given
    assert all(given.parameters[0].is_plausible(share) for share in (0.0, 1.0))


@pytest.mark.parametrize("round_m", [0.07, 0.4, 2.1])
def test_the_best_of_thousands_of_waves_is_that_of_least_squares(round_m: float) -> None:
    rng = np.random.default_rng(8804)
    length_m = rng.uniform(20.0, 65.0, 90)
    column = 2.0 * np.cos(2 * np.pi * length_m / round_m) + rng.normal(size=90)
    column -= column.mean()
    wave = best_wave(length_m, column)
    assert wave is not None
    # Waves stand a quarter of one over the span apart.
    assert 1.0 / wave.length_m == pytest.approx(1.0 / round_m, abs=0.2 / np.ptp(length_m))
    turns = 2 * np.pi / wave.length_m * length_m
    basis = np.stack([np.cos(turns), np.sin(turns), np.ones(90)], axis=1)
    rest = np.linalg.lstsq(basis, column, rcond=None)[1][0]
    assert wave.share == pytest.approx(1.0 - rest / (column @ column), rel=1e-9)
    assert best_wave(length_m[:19], column[:19]) is None
    assert best_wave(np.full(90, 3.0), column) is None
