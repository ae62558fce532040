"""How surely, how separately and on which rows the data settle what is fitted."""

from __future__ import annotations

import csv
import io
from dataclasses import replace

import numpy as np
import pytest
import yaml
from twins.dataset import make
from twins.robots import HALL6, YARD3

from designer.diagnosis.calibration import calibration_of
from designer.diagnosis.case import case_of
from designer.diagnosis.diagnose import diagnose
from designer.diagnosis.fit import fit
from designer.diagnosis.problem import Problem
from designer.diagnosis.report import write_diagnosis
from designer.diagnosis.study import diagnosed_config
from designer.io.config import read_study
from designer.measured.read import read_measured
from designer.model.measurements import Noise


def case(folder, robot, unknown, *, rows=32, seed=5, more=None):
    """Return a twin's data without any effect, and what of the model is unknown."""
    path = make(robot, {}, rows=rows, seed=seed).write(folder)
    config = yaml.safe_load(path.read_text()) | (more or {})
    config["measurements"]["unknown"] = list(unknown)
    config["effects"] = {}
    path.write_text(yaml.safe_dump(config))
    study = read_study(path)
    return replace(case_of(study, study.measurements, read_measured(study)), candidates=())


def fitted(case, *, without=None, noise=None):
    """Return the problem and its fit, one of its rows left out."""
    problem = Problem(case.measured, case.predictor(), noise or Noise(0.001, 4.0, "declared"))
    rows = np.ones(case.measured.n_rows, dtype=bool)
    if without is not None:
        rows[without] = False
    return problem, fit(problem, case.given, rows, thorough=True)


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize(
    ("robot", "unknown"),
    [(YARD3, ("length_offset", "drum_scale")), (HALL6, ("anchors",))],
    ids=["point", "platform"],
)
def test_the_largest_change_without_a_row_is_that_of_a_fit_without_it(
    robot, unknown, tmp_path
) -> None:
    given = case(tmp_path, robot, unknown, rows=24)
    problem, whole = fitted(given)
    found = calibration_of(problem, whole)
    assert found is not None
    for k in range(0, len(found.parameters), 4):
        parameter = found.parameters[k]
        row = int(np.flatnonzero(given.measured.row_numbers == parameter.influence_row)[0])
        _, other = fitted(given, without=row)
        change = abs(other.vector[k] - whole.vector[k]) / parameter.std
        assert parameter.influence == pytest.approx(change, rel=0.1, abs=0.02)


@pytest.mark.slow
def test_standard_deviations_and_correlations_are_those_of_many_logs(tmp_path) -> None:
    fits = []
    for seed in range(40):
        folder = tmp_path / str(seed)
        folder.mkdir()
        fits.append(fitted(case(folder, YARD3, ("length_offset", "drum_scale"), seed=seed)))
    vectors = np.array([each.vector for _, each in fits])
    told = np.mean([each.covariance for _, each in fits], axis=0)
    np.testing.assert_allclose(np.sqrt(np.diag(told)), vectors.std(axis=0), rtol=0.4)
    std = np.sqrt(np.diag(told))
    np.testing.assert_allclose(told / np.outer(std, std), np.corrcoef(vectors.T), atol=0.15)
    np.testing.assert_allclose(np.diag(fits[0][1].covariance), fits[0][1].std ** 2)
    found = calibration_of(*fits[0])
    assert found is not None
    first, second, correlation = next(found.correlated)
    assert {first.effect.id, second.effect.id} == {"length_offset", "drum_scale"}
    assert correlation < -0.9


def test_observability_counts_in_noise_and_not_in_rows(tmp_path) -> None:
    given = case(tmp_path, YARD3, ("length_offset", "drum_scale"))
    coarse = calibration_of(*fitted(given))
    fine = calibration_of(*fitted(given, noise=Noise(0.0005, 2.0, "declared")))
    assert coarse is not None
    assert fine is not None
    # Huber's weights differ a little; the residual is twice as large in units of noise.
    assert fine.observability == pytest.approx(2.0 * coarse.observability, rel=0.05)
    assert fine.condition == pytest.approx(coarse.condition, rel=0.05)
    assert coarse.condition > 3.0


def test_nothing_fitted_needs_no_calibration(tmp_path) -> None:
    assert calibration_of(*fitted(case(tmp_path, YARD3, ()))) is None


@pytest.fixture(scope="module")
def diagnosis(tmp_path_factory):
    folder = tmp_path_factory.mktemp("log")
    stated = {"uncertainty": {"exit_points": {"uniform": "50 mm"}, "samples": 300}}
    return diagnose(case(folder, YARD3, ("anchors", "platform_mass"), more=stated))


def test_files_have_deviations_of_unknowns_too(diagnosis) -> None:
    answer = diagnosis.to_dict()
    calibration = answer["calibration"]
    assert len(calibration["parameters"]) == len(calibration["covariance"]) == 10
    assert calibration["observability"]["value"] > 0.0
    masses = [each for each in answer["unknown"] if each["id"] == "platform_mass"]
    told = [each for each in calibration["parameters"] if each["name"] == "offset_kg"]
    assert masses[0]["std"] == {"offset_kg": told[0]["std"]}


def test_residuals_as_a_table(diagnosis) -> None:
    rows = list(csv.DictReader(io.StringIO(diagnosis.residuals_csv())))
    assert len(rows) == 3 * diagnosis.measured.n_rows
    assert (rows[4]["row"], rows[4]["cable"]) == ("2", "2")
    assert float(rows[4]["length_m"]) == diagnosis.measured.length_m[1, 1]
    assert float(rows[4]["tension_after_N"]) == diagnosis.predicted.tension_N[1, 1]
    off = float(rows[4]["length_before_m"]) - float(rows[4]["length_m"])
    assert abs(off) == pytest.approx(abs(diagnosis.residual_before[1, 1]) * 0.001, rel=1e-6)
    assert sum(row["heldout"] == "1" for row in rows) == 3 * diagnosis.heldout.sum()


def test_deviations_stand_in_the_diagnosed_study(diagnosis, tmp_path) -> None:
    target = tmp_path / "diagnosed.yaml"
    target.write_text(diagnosed_config(diagnosis, tmp_path))
    stated = read_study(target).uncertainty
    assert stated is not None
    assert stated.samples == 300
    std = {each.label: each.std for each in diagnosis.calibration.parameters}
    mass_std = std["offset of platform_mass"]
    assert stated.payload.standard_deviation == pytest.approx(mass_std / 180.0, rel=0.01)
    points = [size for label, size in std.items() if "anchor_offset" in label]
    rms = np.sqrt(np.mean(np.square(points)))
    assert stated.exit_points_m.standard_deviation == pytest.approx(rms, rel=0.01)


def test_what_no_reading_tells_apart_has_no_deviation(tmp_path) -> None:
    found = calibration_of(*fitted(case(tmp_path, YARD3, ("anchors", "pose_frame"))))
    assert found is not None
    settled = {each.label for each in found.parameters if each.is_settled}
    assert found.condition > 1e6
    # All exit points and the frame of the poses moved alike leave the readings as they are.
    assert not {label for label in settled if label.startswith(("x of", "y of", "z of"))}
    for each in found.parameters:
        assert np.isnan(each.influence) == (not each.is_settled)


@pytest.mark.slow
def test_a_page_tells_what_is_not_settled(tmp_path) -> None:
    found = diagnose(case(tmp_path, YARD3, ("anchors", "pose_frame")))
    write_diagnosis(found, tmp_path)
    page = (tmp_path / "diagnosis.html").read_text(encoding="utf-8")
    assert "These data settle no single value of" in page
    unknown = found.to_dict()["unknown"]
    assert any(std is None for each in unknown for std in each["std"].values())
