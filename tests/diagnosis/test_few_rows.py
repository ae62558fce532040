"""A dozen rows, of which nine are fitted: what is found, and what it is not told from."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from twins.dataset import make, size_for
from twins.robots import FAST3, YARD3, TwinRobot

from designer.diagnosis.case import case_of
from designer.diagnosis.diagnose import diagnose
from designer.diagnosis.result import Diagnosis
from designer.io.config import read_study
from designer.measured.read import read_measured

ROWS = 12


def diagnosed(robot: TwinRobot, effect: str, seed: int, folder, unknown=()) -> Diagnosis:
    true = {effect: robot.draw(effect, size_for(robot, effect, 10.0, seed), seed)}
    make(robot, true, rows=ROWS, seed=seed).write(folder, ["length"])
    study = read_study(folder / "config.yaml")
    assert study.measurements is not None
    measurements = replace(study.measurements, unknown=unknown)
    study = replace(study, measurements=measurements)
    return diagnose(case_of(study, measurements, read_measured(study)))


def test_readings_with_gaps_show_an_effect_as_whole_ones_do(tmp_path) -> None:
    """One length that was not read is no reason to try nothing that lengths show."""
    true = {"drum_scale": YARD3.draw("drum_scale", size_for(YARD3, "drum_scale", 10.0, 1), 1)}
    make(YARD3, true, rows=ROWS, seed=1).write(tmp_path, ["length"])
    study = read_study(tmp_path / "config.yaml")
    assert study.measurements is not None
    measured = read_measured(study)
    length_m = measured.length_m.copy()
    length_m[3, 1] = np.nan
    whole, gappy = (
        case_of(study, study.measurements, each)
        for each in (measured, replace(measured, length_m=length_m))
    )
    assert dict(gappy.skipped) == dict(whole.skipped)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("robot", "seed", "unknown"),
    [(FAST3, 5103, ()), (YARD3, 5201, ("length_offset",))],
    ids=["lengths", "homed somewhere"],
)
def test_drums_that_grow_are_found_as_such(robot, seed, unknown, tmp_path) -> None:
    found = diagnosed(robot, "drum_layering", seed, tmp_path, unknown)
    assert [finding.effect.id for finding in found.findings] == ["drum_layering"]
    assert dict(found.skipped)["load_step"] == "needs more rows, or lengths that change more"


@pytest.mark.slow
def test_what_predicts_unseen_rows_as_well_is_a_rival(tmp_path) -> None:
    found = diagnosed(YARD3, "drum_scale", 5203, tmp_path, ("length_offset",))
    (finding,) = found.findings
    trials = {trial.effect.key: trial.heldout_gain for trial in found.steps[0].trials}
    least = 0.95 * trials[finding.effect.key]
    as_good = {key for key, gain in trials.items() if gain >= least}
    assert len(as_good) > 1
    assert as_good <= {finding.effect.key, *finding.rivals}
