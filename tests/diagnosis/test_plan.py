"""Which poses to measure, and whether the deviations that are promised come true."""

from __future__ import annotations

import csv
import json
from dataclasses import replace

import numpy as np
import pytest
import yaml
from test_cli import designer
from twins.dataset import make
from twins.robots import HALL6, HALL8, YARD3

from designer.diagnosis.calibration import identifiability_of
from designer.diagnosis.fit import fit
from designer.diagnosis.plan import candidates, exchanged, plan, slopes_at
from designer.io.config import read_study
from designer.measured.rows import FEWEST_ROWS
from designer.model.cable import Cable
from designer.model.robot import Poses

__all__ = ["designer"]


def config(folder, robot=YARD3, unknown=("anchors",), **noise):
    """Return a config without its log: only the noise of what will be read is known."""
    path = make(robot, {}, rows=8, seed=1).write(folder)
    content = yaml.safe_load(path.read_text())
    measurements = content["measurements"]
    measurements |= {"file": "to-come.csv", "unknown": list(unknown)}
    measurements["noise"] = noise or {"length": "2 mm"}
    content["effects"] = {}
    path.write_text(yaml.safe_dump(content))
    return path


@pytest.mark.slow
def test_promised_deviations_are_those_of_a_hundred_campaigns(tmp_path) -> None:
    study = read_study(config(tmp_path, unknown=("anchors", "length_offset")))
    cable = study.measurements.cable()
    problem, effects, _, places = candidates(study, study.measurements, cable)
    answer = plan(study, study.measurements, cable, 12)
    chosen = exchanged(slopes_at(problem, effects, study), 12)
    assert {*map(tuple, places[chosen])} == {*map(tuple, answer.places)}
    taken = problem.measured
    rows = replace(
        taken,
        poses=Poses.at(places[chosen]),
        length_m=taken.length_m[chosen],
        tension_N=taken.tension_N[chosen],
        row_numbers=np.arange(1, 13),
    )
    rng = np.random.default_rng(7)
    fitted = []
    for _ in range(100):
        noisy = rows.length_m + rng.normal(0.0, 0.002, rows.length_m.shape)
        measured = replace(rows, length_m=noisy)
        campaign = replace(problem, measured=measured, predict=problem.predict.at(measured))
        fitted.append(fit(campaign, effects, np.ones(12, dtype=bool), thorough=True).vector)
    ratio = np.std(fitted, axis=0) / [e.std for e in answer.expected]
    assert np.all(np.abs(np.log(ratio)) < 0.3)  # of one: 0.07 of a hundred
    assert np.sqrt(np.mean(ratio**2)) == pytest.approx(1.0, abs=0.1)
    assert all(e.std < e.std_random for e in answer.expected)
    assert answer.is_positive


def test_no_single_exchange_tells_more() -> None:
    slopes = np.random.default_rng(3).normal(size=(30, 2, 5))

    def determinant(poses):
        return np.linalg.slogdet(np.einsum("rcp,rcq->pq", slopes[poses], slopes[poses]))[1]

    chosen = exchanged(slopes, 6)
    assert len({*chosen}) == 6
    others = [k for k in range(30) if k not in chosen]
    swaps = [np.where(chosen == out, k, chosen) for out in chosen for k in others]
    assert max(map(determinant, swaps)) <= determinant(chosen) + 1e-6


def test_deviations_of_slopes_are_those_of_the_normal_equations() -> None:
    slopes = np.random.default_rng(4).normal(size=(9, 2, 4))
    told = identifiability_of(slopes, 9)
    inverse = np.linalg.inv(np.einsum("rcp,rcq->pq", slopes, slopes))
    assert told.std == pytest.approx(np.sqrt(np.diag(inverse)))
    twins = np.concatenate([slopes, slopes[..., :1]], axis=-1)
    assert list(identifiability_of(twins, 9).is_settled) == [False, True, True, True, False]


def test_a_plan_has_as_many_poses_as_its_diagnosis_asks_for(tmp_path) -> None:
    """Lengths and tensions tell nine unknowns in four poses; eight rows are read at least."""
    study = read_study(config(tmp_path, length="2 mm", tension="8 N"))
    answer = plan(study, study.measurements, study.measurements.cable())
    assert len(answer.places) == FEWEST_ROWS


def test_too_few_poses_leave_something_untold(tmp_path, designer) -> None:
    path = config(tmp_path, unknown=("anchors", "length_offset"))
    outcome = designer("diagnose", "--plan", str(path), "--poses", "2", "-o", "p")
    assert outcome.status == 1
    content = json.loads((tmp_path / "p" / "plan.json").read_text())
    assert not all(entry["told"] for entry in content["expected"])


@pytest.mark.slow
def test_poses_of_a_plan_are_held_within_strength(tmp_path) -> None:
    study = read_study(config(tmp_path, HALL6))
    strong, rope = study.measurements.cable(), study.measurements
    every = candidates(study, rope, strong)
    limit_N = float(np.median(every[2].cable_tension_N.max(axis=1)))
    weak = Cable(
        np.nan, rope.linear_density_kg_per_m, rope.axial_stiffness_N, allowable_tension_N=limit_N
    )
    answer = plan(study, rope, weak, 8)
    assert answer.n_candidates < len(every[3])
    assert (answer.statics.cable_tension_N <= limit_N).all()


@pytest.mark.slow
def test_spare_cables_of_unknown_strength_are_planned_for(tmp_path) -> None:
    study = read_study(config(tmp_path, HALL8))
    answer = plan(study, study.measurements, study.measurements.cable(), 8)
    assert answer.n_candidates > 100
    assert answer.is_positive


def test_table_for_the_controller(tmp_path, designer) -> None:
    path, table = config(tmp_path), tmp_path / "poses.csv"
    outcome = designer("diagnose", "--plan", str(path), "--poses", "7", "-o", str(table))
    assert outcome.status == 0, outcome.err
    assert "expected" in outcome.out
    rows = list(csv.DictReader(table.read_text().splitlines()))
    assert len(rows) == 7
    assert list(rows[0])[:4] == ["x_m", "y_m", "z_m", "length_1_m"]
    assert not (tmp_path / "plan.html").exists()


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (["--poses", "0"], "--poses: is 0 (expected a whole number"),
        (["--poses", "9999"], "--poses: is 9999 (expected at most"),
        (["--unknown", "anchor"], "--unknown: 'anchor' is not known"),
        (["--unknown", "backlash"], "'backlash' cannot be planned for: it depends on the way"),
        (["--unknown", "thermal_expansion"], "'thermal_expansion' cannot be planned for: needs"),
        (["--length-noise", "2 kg"], "--length-noise: "),
        (["--check"], "--plan: has no use for --check"),
    ],
)
def test_a_mistake_is_one_line(options, told, tmp_path, designer) -> None:
    path = config(tmp_path)
    before = sorted(tmp_path.iterdir())
    outcome = designer("diagnose", "--plan", str(path), *options)
    assert outcome.status == 2
    error = outcome.err.strip().splitlines()
    assert told in error[-1]
    assert sorted(tmp_path.iterdir()) == before


def test_options_of_a_plan_ask_for_it(tmp_path, designer) -> None:
    outcome = designer("diagnose", str(config(tmp_path)), "--poses", "3")
    assert outcome.status == 2
    assert "--plan beside them" in outcome.err


@pytest.mark.parametrize("part", ["workspace", "measurements"])
def test_a_study_without_a_part_that_a_plan_needs(part, tmp_path, designer) -> None:
    path = config(tmp_path)
    content = yaml.safe_load(path.read_text())
    content = {key: value for key, value in content.items() if key not in {part, "selection"}}
    path.write_text(yaml.safe_dump(content))
    outcome = designer("diagnose", "--plan", str(path))
    assert outcome.status == 2
    assert f"{part}: is missing" in outcome.err
