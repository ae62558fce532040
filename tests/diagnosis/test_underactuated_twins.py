"""Four heavy cables on a platform that sways: simulated by the quadrature, diagnosed by us."""

from __future__ import annotations

import numpy as np
import pytest
from twins.dataset import make
from twins.robots import FIELD4

from designer.diagnosis.case import Case, case_of
from designer.diagnosis.diagnose import diagnose
from designer.diagnosis.problem import Predictor
from designer.io.config import read_study
from designer.measured.read import read_measured


def case_with(effects, folder, quantities=("length", "tension"), noise: float = 1.0) -> Case:
    make(FIELD4, effects, rows=60, seed=1, noise=noise).write(folder, quantities)
    study = read_study(folder / "config.yaml")
    return case_of(study, study.measurements, read_measured(study))


@pytest.mark.slow  # no other quick test compiles these kernels
def test_readings_are_foretold(tmp_path) -> None:
    """Noise-free data of a measuring campaign, to the digits of its file."""
    case = case_with({}, tmp_path, noise=0.0)
    told = Predictor(case.machine, case.measured)(())
    assert np.abs(told.length_m - case.measured.length_m).max() < 2e-6
    assert np.abs(told.tension_N - case.measured.tension_N).max() < 1e-2


@pytest.mark.slow
@pytest.mark.parametrize("quantities", [("length",), ("length", "tension")])
def test_cables_of_the_platforms_weight_are_no_finding(quantities, tmp_path) -> None:
    found = diagnose(case_with({}, tmp_path, quantities))
    assert found.findings == ()
    assert not found.is_unexplained
    assert found.final.length_m.heldout.value < 1.2 * FIELD4.noise_m
    assert found.to_dict()["balance"]["left_median"] < 1e-4


@pytest.mark.slow
def test_a_heavier_platform_is_found_with_its_weight(tmp_path) -> None:
    found = diagnose(case_with({"platform_mass": {"offset_kg": 2.5}}, tmp_path))
    assert [finding.effect.key for finding in found.findings] == ["platform_mass"]
    estimate = found.findings[0].parameters["offset_kg"]
    assert estimate.value == pytest.approx(2.5, abs=4.0 * estimate.std)
    assert found.final.length_m.heldout.value < 1.2 * FIELD4.noise_m
