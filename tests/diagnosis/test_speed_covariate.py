"""What goes with a cable's speed is seen, and is not held against effects that are constant."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from twins.dataset import make
from twins.robots import YARD3

from designer.arrays import frozen_array
from designer.diagnosis.case import case_of
from designer.diagnosis.diagnose import diagnose
from designer.diagnosis.hold import _weights
from designer.diagnosis.structure import Carrier, Structure, covariates_of
from designer.effects.effect import Readings
from designer.io.config import read_study
from designer.measured.read import read_measured

LAG_S = 0.05


def test_one_winch_that_lags_goes_with_the_speed_of_its_cable(tmp_path) -> None:
    study = read_study(make(YARD3, seed=6, settled=False).write(tmp_path))
    measured = read_measured(study)
    length = np.array(measured.length_m)
    length[:, 2] -= LAG_S * np.gradient(length[:, 2], measured.time_s)
    lagging = replace(measured, length_m=frozen_array(length))
    case = case_of(study, study.measurements, lagging)
    found = diagnose(replace(case, candidates=()))
    assert found.structure_after.carriers[0].name == "speed_3_m_per_s"
    assert found.left_in is not None
    assert found.left_in.reading == "length 3"


def test_poses_at_rest_have_no_speed(tmp_path) -> None:
    measured = read_measured(read_study(make(YARD3).write(tmp_path)))
    names = covariates_of(measured, Readings(measured.length_m, measured.tension_N))
    assert not any(name.startswith("speed") for name in names)


def test_no_effect_drifts_with_a_speed() -> None:
    carriers = (Carrier("speed_1_m_per_s", 0.5, 0.0005), Carrier("z_m", 0.4, 0.0005))
    values = np.random.default_rng(0).normal(size=(20, 3))
    covariates = {carrier.name: values[:, 0] for carrier in carriers}
    rows = np.ones(20, dtype=np.bool_)
    told = _weights(Structure(carriers, 2.0), covariates, Readings(values, values), rows)
    names = [name for name, _ in told]
    assert names == ["z_m", "the cable's own tension", "the cable's own length"]


def test_what_goes_with_speeds_alone_casts_no_doubt_on_constants() -> None:
    speed, height = Carrier("speed_1_m_per_s", 0.5, 0.0005), Carrier("z_m", 0.4, 0.0005)
    assert Structure((speed, Carrier("z_m", 0.1, 0.4)), 2.0).is_present
    assert not Structure((speed, Carrier("z_m", 0.1, 0.4)), 2.0).may_bend
    assert Structure((speed, height), 2.0).may_bend
