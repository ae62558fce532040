"""What is taken back of a finding: without gain on unseen rows, or going with a covariate."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from twins.dataset import DataSet, make
from twins.robots import FAST3, HALL6, HALL8, YARD3, TwinRobot
from twins.troubles import troubled

from designer.arrays import frozen_array
from designer.diagnosis.case import Case, case_of
from designer.diagnosis.diagnose import diagnose
from designer.diagnosis.hold import Gain, _no_step, _weights
from designer.diagnosis.report import verdict
from designer.diagnosis.result import Diagnosis, DiagnosisVerdict, Reason
from designer.diagnosis.statistics import heldout_rows, orthonormal
from designer.diagnosis.structure import Carrier, Structure, covariates_of
from designer.effects.effect import Readings
from designer.io.config import read_study
from designer.measured.read import read_measured


def test_a_basis_spans_all_columns_whatever_their_sizes() -> None:
    rng = np.random.default_rng(20261125)
    columns = rng.normal(size=(40, 5)) * 10.0 ** np.array([-9.0, -4.0, 0.0, 4.0, 9.0])
    basis = orthonormal(np.column_stack([columns, 3.0 * columns[:, 0], np.zeros(40)]))
    assert basis.shape == (40, 5)
    assert basis.T @ basis == pytest.approx(np.eye(5), abs=1e-12)
    scaled = columns / np.linalg.norm(columns, axis=0)
    assert basis @ (basis.T @ scaled) == pytest.approx(scaled, abs=1e-9)


@pytest.mark.parametrize(
    ("carriers", "is_withdrawn"),
    [((), False), (("x_m",), False), (("row",), True), (("x_m", "row"), True)],
)
def test_what_begins_at_a_time_is_taken_back_where_the_rest_goes_with_time(
    carriers: tuple[str, ...], is_withdrawn: bool
) -> None:
    steps = SimpleNamespace(key="load_step", starts_from=lambda *_: [], needs={"time"})
    lasting = SimpleNamespace(key="creep", starts_from=None, needs={"time"})
    present = tuple(Carrier(name, 0.5, 1e-6) for name in carriers)
    for effects, counts in (((lasting, steps), is_withdrawn), ((lasting,), False)):
        outcome: Any = SimpleNamespace(found=effects, structure=SimpleNamespace(present=present))
        withdrawn = _no_step(outcome)
        assert (withdrawn is not None) == counts
        if withdrawn is not None:
            assert (withdrawn.effect, withdrawn.reason) == ("load_step", Reason.NO_STEP)


def case_in(dataset: DataSet, folder) -> Case:
    dataset.write(folder)
    study = read_study(folder / "config.yaml")
    assert study.measurements is not None
    return case_of(study, study.measurements, read_measured(study))


def diagnosed(kind: str, seed: int, folder, robot: TwinRobot = YARD3) -> Diagnosis:
    return diagnose(case_in(troubled(robot, kind, seed), folder))


def test_a_gain_is_clear_of_zero_by_its_deviation() -> None:
    assert Gain(0.05, 0.03).is_clear
    assert not Gain(0.05, 0.06).is_clear
    assert not Gain(0.005, 0.0001).is_clear
    assert not Gain(-0.1, 0.01).is_clear


@pytest.mark.slow
@pytest.mark.parametrize(
    ("robot", "seed"), [(YARD3, 1), (YARD3, 7), (FAST3, 930045), (HALL6, 910014)]
)
def test_noise_that_lasts_is_no_effect(robot, seed, tmp_path) -> None:
    found = diagnosed("serial noise", seed, tmp_path, robot)
    assert found.findings == ()
    assert found.verdict is DiagnosisVerdict.NOTHING
    assert found.structure_after.lasting.rows > 5.0


@pytest.mark.slow
def test_a_load_cell_at_the_end_of_its_range_has_no_wrong_gain(tmp_path) -> None:
    found = diagnosed("saturation", 2, tmp_path)
    assert found.findings == ()
    assert found.structure_after.events[0].text == "the upper end of the range of tension 3"
    assert "the upper end of the range of tension 3" in verdict(found).text


@pytest.mark.slow
def test_poses_measured_badly_are_scatter(tmp_path) -> None:
    found = diagnosed("pose noise", 0, tmp_path)
    assert found.findings == ()
    assert found.verdict is DiagnosisVerdict.SCATTER
    assert verdict(found).title == "Scatter larger than the sensors explain"


@pytest.mark.slow
@pytest.mark.parametrize("robot", [YARD3, HALL8], ids=lambda robot: robot.name)
def test_rows_held_out_decide_nothing_before_the_last_check(robot, tmp_path) -> None:
    """Noise that is estimated, search and fit are the same whatever is read in those rows."""
    effect = {"length_offset": robot.draw("length_offset", 20 * robot.noise_m)}
    case = case_in(make(robot, effect, rows=48), tmp_path)
    silent = replace(case.measurements, length_noise_m=None, tension_noise_N=None)
    kept = {"length_offset", "drum_scale", "tension_bias"}
    candidates = tuple(e for e in case.candidates if e.id in kept)
    case = replace(case, measurements=silent, candidates=candidates)
    unseen = heldout_rows(case.measured.n_rows)
    rng = np.random.default_rng(0)
    length, tension = case.measured.length_m.copy(), case.measured.tension_N.copy()
    length[unseen] += rng.normal(0.0, 5 * robot.noise_m, length[unseen].shape)
    tension[unseen] += rng.normal(0.0, 5 * robot.noise_N, tension[unseen].shape)
    spoilt = replace(case.measured, length_m=length, tension_N=tension)
    one, other = diagnose(case), diagnose(replace(case, measured=spoilt))
    assert one.noise == other.noise
    assert one.findings
    kept_by_both = {f.effect.key for f in one.findings} & {f.effect.key for f in other.findings}
    assert kept_by_both
    ours, theirs = ({f.effect.key: f for f in d.findings} for d in (one, other))
    for key in kept_by_both:
        assert ours[key].parameters == theirs[key].parameters


@pytest.mark.slow
def test_an_unknown_far_off_is_not_plausible(tmp_path) -> None:
    """A mechanical advantage that is wrong in the config moves the exit points by metres."""
    case = case_in(make(YARD3, seed=3), tmp_path)
    wrong = case.measured.length_m.copy()
    wrong[:, 1] *= 2.0
    anchors = tuple(e for e in case.candidates if e.id == "anchor_offset" and e.cable == 2)
    others = tuple(e for e in case.candidates if e.id == "platform_mass")
    measured = replace(case.measured, length_m=wrong)
    found = diagnose(replace(case, measured=measured, given=anchors, candidates=others))
    assert found.doubts
    assert "anchor_offset of cable 2" in found.doubts[0]
    assert found.verdict in (DiagnosisVerdict.IMPLAUSIBLE, DiagnosisVerdict.UNEXPLAINED)
    assert "cannot be" in verdict(found).text


@pytest.mark.slow
def test_an_effect_with_values_that_are_not_plausible_is_never_found(tmp_path) -> None:
    case = case_in(make(YARD3, {"drum_scale": {"scale": 0.9}}, rows=48), tmp_path)
    kept = tuple(e for e in case.candidates if e.id in {"drum_scale", "platform_mass"})
    found = diagnose(replace(case, candidates=kept))
    assert "drum_scale" not in {f.effect.id for f in found.findings}
    (gone,) = [one for one in found.withdrawn if one.effect == "drum_scale"]
    assert gone.reason is Reason.IMPLAUSIBLE
    assert gone.detail.startswith("scale = 0.9")
    assert found.verdict is not DiagnosisVerdict.FOUND
    assert found.verdict is not DiagnosisVerdict.NOTHING


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
