"""What has no gain on rows that no fit has seen is withdrawn; those rows decide nothing before."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from twins.dataset import DataSet, make
from twins.robots import FAST3, HALL6, HALL8, YARD3, TwinRobot
from twins.troubles import troubled

from designer.diagnosis.case import Case, case_of
from designer.diagnosis.diagnose import diagnose
from designer.diagnosis.hold import Gain
from designer.diagnosis.result import Diagnosis, DiagnosisVerdict, Reason
from designer.diagnosis.statistics import heldout_rows
from designer.io.config import read_study
from designer.measured.read import read_measured
from designer.report.diagnosis.report import verdict


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
