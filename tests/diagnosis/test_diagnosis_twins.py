"""The closed loop on data whose physics shares nothing with the model."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from report_parts import diagnosis_page
from shared_data import needs_shared, shared
from twins import physics
from twins.dataset import DataSet, make, size_for
from twins.robots import FAST3, HALL6, YARD3, TwinRobot
from twins.troubles import NO_EFFECT, noisy

from designer.diagnosis.case import Case, case_of
from designer.diagnosis.design import with_design
from designer.diagnosis.diagnose import diagnose
from designer.diagnosis.result import Diagnosis
from designer.diagnosis.statistics import heldout_rows
from designer.diagnosis.study import diagnosed_config
from designer.errors import InputError
from designer.grades.registry import load_catalogue
from designer.io.config import read_study
from designer.measured.read import read_measured
from designer.model.robot import Poses
from designer.statics.inverse import solve_sagging
from designer.study import Study, as_built_by

pytestmark = pytest.mark.slow

TWINS = ("measured", "simulated-twins")


def study_of(dataset: DataSet, folder: Path) -> Study:
    dataset.write(folder)
    return read_study(folder / "config.yaml")


def case_in(study: Study) -> Case:
    assert study.measurements is not None
    return case_of(study, study.measurements, read_measured(study))


def twin(robot: TwinRobot, effect: str, over_noise: float, seed: int = 0) -> DataSet:
    settled = effect != "clock_offset"
    size = size_for(robot, effect, over_noise, seed, settled=settled)
    return make(robot, {effect: robot.draw(effect, size, seed)}, seed=seed, settled=settled)


Twins = Callable[[str, str], tuple[DataSet, Diagnosis]]
"""Makes the twin of a robot with one effect and diagnoses it, once for all tests that ask."""


@pytest.fixture(scope="module")
def twins(tmp_path_factory: pytest.TempPathFactory) -> Twins:
    @cache
    def diagnosed(robot: str, effect: str) -> tuple[DataSet, Diagnosis]:
        dataset = twin({one.name: one for one in (YARD3, HALL6)}[robot], effect, 10.0)
        folder = tmp_path_factory.mktemp(effect)
        return dataset, diagnose(case_in(study_of(dataset, folder)))

    return diagnosed


@pytest.mark.parametrize(
    ("robot", "effect"),
    [
        (YARD3, "pulley_radius"),
        (YARD3, "elastic_modulus"),
        (YARD3, "linear_mass"),
        (YARD3, "platform_mass"),
        (YARD3, "anchor_offset"),
        (YARD3, "length_offset"),
        (YARD3, "creep"),
        (YARD3, "pulley_friction"),
        (YARD3, "wind_drag"),
        (YARD3, "base_tilt"),
        (YARD3, "tension_gain"),
        (YARD3, "tension_scale"),
        (HALL6, "centre_of_mass_offset"),
        (HALL6, "tension_bias"),
        (YARD3, "mast_compliance"),
        (YARD3, "tension_length"),
    ],
    ids=lambda value: getattr(value, "name", value),
)
def test_a_single_effect_is_found_first_with_its_size(robot, effect, twins) -> None:
    dataset, found = twins(robot.name, effect)
    assert [finding.effect.id for finding in found.findings] == [effect]
    assert not found.is_unexplained
    truth = dict(dataset.effects[effect])
    assert found.findings[0].effect.cable == truth.pop("cable", None)
    for name, value in truth.items():
        estimate = found.findings[0].parameters[name]
        assert abs(estimate.value - value) < 4.0 * estimate.std
    before, after = found.stages[0], found.final
    assert after.length_m is not None
    assert after.tension_N is not None
    assert before.length_m is not None
    assert after.length_m.heldout.value < 1.2 * found.noise.length_m
    assert after.tension_N.heldout.value < 1.2 * found.noise.tension_N
    assert after.length_m.heldout.low < after.length_m.heldout.value < after.length_m.heldout.high


@pytest.mark.slow
def test_noise_that_lasts_is_no_set_of_effects(tmp_path) -> None:
    data = noisy(FAST3, NO_EFFECT["AR0.97"], 702, 60)
    assert not diagnose(case_in(study_of(data, tmp_path))).findings


def test_two_effects_are_found_together(tmp_path) -> None:
    sizes = {
        e: YARD3.draw(e, size_for(YARD3, e, 10.0), 0) for e in ("pulley_radius", "platform_mass")
    }
    found = diagnose(case_in(study_of(make(YARD3, sizes), tmp_path)))
    # A gain of the tension sensors is as good as the mass here (losses of 572.7 and 572.5), and an
    # error of setting up comes first.
    rivals = {finding.effect.id: finding.rivals for finding in found.findings}
    assert rivals == {"pulley_radius": (), "tension_scale": ("platform_mass", "platform_force")}
    assert {effect.id for effect in found.steps[0].instead} == set(rivals)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("robot", "beside"), [(FAST3, "tension_hysteresis"), (YARD3, "tension_bias")]
)
def test_a_frame_that_is_only_shifted_is_not_turned(robot, beside, tmp_path) -> None:
    sizes = {e: robot.draw(e, size_for(robot, e, 15.0), 0) for e in ("pose_shift", beside)}
    found = diagnose(case_in(study_of(make(robot, sizes), tmp_path)))
    assert {finding.effect.id for finding in found.findings} == {"pose_shift", beside}
    estimates = next(f for f in found.findings if f.effect.id == "pose_shift").parameters
    for name, value in sizes["pose_shift"].items():
        assert abs(estimates[name].value - value) < 4.0 * estimates[name].std


@pytest.mark.parametrize("seed", range(4))
def test_nothing_is_found_where_nothing_is(seed, tmp_path) -> None:
    found = diagnose(case_in(study_of(make(YARD3, seed=seed), tmp_path)))
    assert found.findings == ()
    assert not found.is_unexplained
    assert len(found.stages) == 1


def test_mass_that_drifts_is_unexplained_and_goes_with_time(tmp_path) -> None:
    drift = {"cable_mass_drift": {"gain": 0.15, "period_s": 40000.0}}
    found = diagnose(case_in(study_of(make(YARD3, drift, seed=1), tmp_path)))
    assert found.is_unexplained
    # The day's temperature goes with time as well, so either may come first.
    strong = {c.name for c in found.structure_after.carriers if c.chance < 0.01}
    assert "time_s" in strong
    assert "linear_mass" not in {finding.effect.id for finding in found.findings}
    assert found.correction is not None


def test_rows_held_out_change_no_finding(twins, tmp_path) -> None:
    """Spoiling what no fit may see leaves every fitted number as it is."""
    dataset, clean = twins(YARD3.name, "elastic_modulus")
    case = case_in(study_of(dataset, tmp_path))
    unseen = heldout_rows(case.measured.n_rows)
    length = np.array(case.measured.length_m)
    length[unseen] += np.random.default_rng(0).normal(0, 0.003, length[unseen].shape)
    spoilt = diagnose(replace(case, measured=replace(case.measured, length_m=length)))
    assert clean.findings[0].parameters == spoilt.findings[0].parameters
    assert spoilt.final.length_m.heldout.value > 2 * clean.final.length_m.heldout.value


def test_outliers_are_shown_and_do_little_harm(tmp_path) -> None:
    effect = {"platform_mass": YARD3.draw("platform_mass", size_for(YARD3, "platform_mass", 10.0))}
    dataset = make(YARD3, effect, outliers=0.03, missing=0.05, seed=2)
    found = diagnose(case_in(study_of(dataset, tmp_path)))
    assert [finding.effect.id for finding in found.findings] == ["platform_mass"]
    planted = int(dataset.outlier_length.sum() + dataset.outlier_tension.sum())
    assert 0.6 * planted <= len(found.outliers) <= planted
    true = effect["platform_mass"]["offset_kg"]
    assert found.findings[0].parameters["offset_kg"].value == pytest.approx(true, rel=0.05)


def test_poses_that_no_cables_can_hold_are_refused(tmp_path) -> None:
    case = case_in(study_of(make(YARD3), tmp_path))
    high = case.measured.poses.position_m + np.array([0.0, 0.0, 40.0])
    with pytest.raises(InputError, match="can hold 0 of 120 poses"):
        diagnose(replace(case, measured=replace(case.measured, poses=Poses.at(high))))


def test_effects_without_their_columns_are_skipped_and_said(tmp_path) -> None:
    case = case_in(study_of(make(YARD3), tmp_path))
    assert case.study.measurements is not None
    bare = replace(case.measured, temperature_C=None, wind_m_per_s=None)
    skipped = dict(case_of(case.study, case.study.measurements, bare).skipped)
    assert "temperature_C" in skipped["thermal_expansion"]
    assert "wind" in skipped["wind_drag"]
    assert "settled: false" in skipped["clock_offset"]


def test_unknowns_from_the_start_are_fitted_and_no_finding(tmp_path) -> None:
    offsets = YARD3.draw("length_offset", 0.05)
    study = study_of(make(YARD3, {"length_offset": offsets}), tmp_path)
    assert study.measurements is not None
    study = replace(study, measurements=replace(study.measurements, unknown=("length_offset",)))
    found = diagnose(case_in(study))
    assert found.findings == ()
    values = {name: value for setting in found.given for name, value in setting.values.items()}
    assert values == pytest.approx(offsets, abs=1e-3)


def written(found: Diagnosis, folder: Path) -> Study:
    """Return the study read back from the config that a diagnosis writes."""
    better = folder / "config.diagnosed.yaml"
    better.write_text(diagnosed_config(found, folder))
    return read_study(better)


@pytest.mark.parametrize("effect", ["pulley_radius", "elastic_modulus", "linear_mass"])
def test_the_design_follows_what_was_found(effect, twins, tmp_path) -> None:
    """The diagnosed config gives the tensions that the other physics gives with the effect.

    What was found of the rope is of the rope on the machine; a rope of the catalogue is as its
    data sheet says.
    """
    _, found = twins(YARD3.name, effect)
    better = written(found, tmp_path)
    assert [one.id for one in better.effects] == [effect]
    assert read_measured(better).n_rows == found.measured.n_rows
    built = as_built_by(better, mounted=True)
    grade = load_catalogue(with_plugins=False).grade("unirope-7x19-galvanised")
    sheet = grade.cable(grade.sizes[4], 5.0)
    cable = built.cable(sheet)
    assert as_built_by(better).cable(sheet) == sheet
    assert as_built_by(better).of_products.cable(sheet) == sheet
    pose = np.array([[13.0, 9.0, 6.0]])
    ours = solve_sagging(built.robot, Poses.at(pose), cable)
    values = found.settings[0].values
    machine = replace(
        YARD3.machine(),
        linear_mass=np.full((1, 3), grade.sizes[4].linear_density_kg_per_m),
        stiffness_N=np.full((1, 3), grade.axial_stiffness_N(grade.sizes[4])),
    )
    if effect == "pulley_radius":
        machine = replace(machine, pulley_radius_m=values["radius_m"])
    elif effect == "elastic_modulus":
        machine = replace(machine, stiffness_N=machine.stiffness_N * values["scale"])
    else:
        machine = replace(machine, linear_mass=machine.linear_mass * values["scale"])
    other = physics.solve(machine, pose, np.eye(3)[None])
    assert ours.exit_tension_N == pytest.approx(other.exit_tension_N, rel=1e-6)
    assert ours.length_m == pytest.approx(other.length_m, rel=1e-6)


def told_of(found: Diagnosis) -> Diagnosis:
    assert found.study.measurements is not None
    rope = replace(found.study.measurements, minimum_breaking_load_N=40e3)
    study = replace(found.study, measurements=rope)
    grades = load_catalogue(with_plugins=False).grades[:3]
    return with_design(replace(found, study=study), grades)


def test_a_heavy_rope_on_the_machine_changes_no_other_rope(twins) -> None:
    """It was found of that rope: a new one, and the configured family, are not heavier."""
    told = told_of(twins(YARD3.name, "linear_mass")[1])
    assert told.design_before is not None
    assert told.design_after == told.design_before
    assert told.mounted_before is not None
    assert told.mounted_after is not None
    assert told.mounted_after.max_tension_N > told.mounted_before.max_tension_N
    assert "Linear_mass belongs to the rope on the machine" in diagnosis_page(told).design[0]
    assert json.dumps(told.to_dict(), allow_nan=False)


def test_what_is_found_of_the_machine_changes_the_design(twins, tmp_path) -> None:
    _, found = twins(YARD3.name, "platform_mass")
    told = told_of(found)
    assert told.design_before is not None
    assert told.design_after is not None
    heavier = found.settings[0].values["offset_kg"] > 0.0
    assert (told.design_after.optimum_m > told.design_before.optimum_m) is heavier
    again = told_of(replace(found, study=written(found, tmp_path), findings=(), given=()))
    assert told.design_after == again.design_before


@needs_shared(*TWINS)
@pytest.mark.parametrize(
    "folder", sorted(shared(*TWINS).glob("*/truth.json")), ids=lambda path: path.parent.name
)
def test_shared_twins(folder) -> None:
    folder = folder.parent
    truth = json.loads((folder / "truth.json").read_text())
    found = diagnose(case_in(read_study(folder / "config.yaml")))
    wanted = [effect for effect in truth["effects"] if not effect.startswith("unexplained")]
    assert [finding.effect.id for finding in found.findings] == wanted
    assert found.is_unexplained == (len(wanted) < len(truth["effects"]))
    if found.is_unexplained:
        assert truth["effects"] == [f"unexplained:{found.structure_after.carriers[0].name}"]
    for finding in found.findings:
        for parameter, value in truth["parameters"].items():
            estimate = finding.parameters[parameter]
            assert abs(estimate.value - value) < 3.0 * estimate.std
            assert estimate.value == pytest.approx(value, rel=0.05)
    assert found.final.length_m.heldout.value < 1.2 * found.noise.length_m
    assert found.final.tension_N.heldout.value < 1.2 * found.noise.tension_N
