"""Rows without poses: estimated from what was read, and diagnosed from what is to spare."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml
from report_parts import diagnosis_page
from twins.dataset import DataSet, make, size_for
from twins.robots import FAST3, FIELD4, HALL8, YARD3, TwinRobot

from designer.diagnosis.case import Case, case_of
from designer.diagnosis.check import check
from designer.diagnosis.diagnose import diagnose
from designer.diagnosis.fit import fit
from designer.diagnosis.free_poses import ABSORBED, FreePredictor
from designer.diagnosis.problem import Problem
from designer.diagnosis.result import Diagnosis
from designer.errors import InputError
from designer.io.config import read_study
from designer.measured.read import read_measured
from designer.model.measured_data import Noise

BOTH = ("length", "tension")


def written(dataset: DataSet, folder: Path, quantities=BOTH, **measurements: object) -> Path:
    """Write a data set without poses; return its config."""
    path = dataset.write(folder, quantities)
    table = dataset.columns(quantities)
    kept = [name for name in table if name[:2] not in ("x_", "y_", "z_", "rx", "ry", "rz")]
    rows = zip(*(table[name] for name in kept), strict=True)
    text = "\n".join([",".join(kept), *map(",".join, rows)])
    (folder / "measured.csv").write_text(f"{text}\n", encoding="utf-8")
    config = yaml.safe_load(path.read_text(encoding="utf-8"))
    config["measurements"] |= {"unknown": ["poses"], **measurements}
    path.write_text(yaml.safe_dump(config), encoding="utf-8")
    return path


def case_in(config: Path) -> Case:
    study = read_study(config)
    assert study.measurements is not None
    return case_of(study, study.measurements, read_measured(study))


def drawn(robot: TwinRobot, effect: str, over_noise: float, seed: int) -> dict:
    return {effect: robot.draw(effect, size_for(robot, effect, over_noise, seed), seed)}


def diagnosed(
    robot: TwinRobot, effects: dict, seed: int, folder: Path, rows: int = 40
) -> Diagnosis:
    return diagnose(case_in(written(make(robot, effects, rows=rows, seed=seed), folder)))


def faults_of(config: Path) -> str:
    with pytest.raises(InputError) as refused:
        case_in(config)
    return str(refused.value)


@pytest.mark.parametrize(
    "robot",
    [YARD3, FAST3, pytest.param(HALL8, marks=pytest.mark.slow)],
    ids=["yard3", "fast3", "hall8"],
)
def test_poses_are_where_they_were(robot, tmp_path) -> None:
    dataset = make(robot, rows=40, seed=3301)
    case = case_in(written(dataset, tmp_path))
    predictor = case.predictor()
    assert isinstance(predictor, FreePredictor)
    noise = Noise(robot.noise_m, robot.noise_N, "declared")
    off_m = predictor.poses((), noise).position_m - dataset.scene.position_m
    assert np.linalg.norm(off_m, axis=1).max() < 10.0 * robot.noise_m
    shown = predictor((), noise)
    left = np.hstack(
        [
            (case.measured.length_m - shown.length_m) / noise.length_m,
            (case.measured.tension_N - shown.tension_N) / noise.tension_N,
        ]
    )
    # As many readings of a row as cables went into its pose and internal forces.
    assert np.sum(left**2) / (40 * robot.cables) == pytest.approx(1.0, abs=0.25)


@pytest.mark.slow
def test_nothing_is_found_where_nothing_is(tmp_path) -> None:
    found = diagnosed(YARD3, {}, 3302, tmp_path)
    assert found.verdict.value == "nothing_to_find"
    assert found.foretold_after is None


@pytest.mark.slow
def test_an_effect_shows_in_what_is_to_spare(tmp_path) -> None:
    seed = 3303
    truth = drawn(YARD3, "tension_gain", 10.0, seed)["tension_gain"]
    found = diagnosed(YARD3, {"tension_gain": truth}, seed, tmp_path)
    (finding,) = found.findings
    assert finding.effect.key == f"tension_gain of cable {truth['cable']:.0f}"
    gain = finding.parameters["gain"]
    assert abs(gain.value - truth["gain"]) < 4.0 * gain.std
    assert np.isfinite(found.measured.poses.position_m).all()
    told = found.to_dict()
    assert told["rows"]["poses"] == "estimated"
    assert "Poses estimated" in {s.title for s in diagnosis_page(found).sureness}


@pytest.mark.slow
def test_what_poses_take_up_is_named_and_never_found(tmp_path) -> None:
    """Warm cables look like a lower platform, unless load cells are fine enough to tell."""
    coarse = replace(YARD3, noise_N=80.0, noise_m=0.0004)
    warm = drawn(coarse, "thermal_expansion", 5.0, 3305)
    dataset = make(coarse, warm, rows=40, seed=3305)
    known = diagnose(case_in(dataset.write(tmp_path / "known")))
    assert [finding.effect.id for finding in known.findings] == ["thermal_expansion"]
    found = diagnose(case_in(written(dataset, tmp_path / "free")))
    assert found.findings == ()
    assert dict(found.skipped)["thermal_expansion"].startswith(ABSORBED)
    (told,) = (s for s in diagnosis_page(found).sureness if s.title == "Poses estimated")
    assert "thermal_expansion" in told.text


@pytest.mark.slow
def test_eight_cables(tmp_path) -> None:
    """Every kind of effect is tried, those of single cables on two of eight."""
    truth = drawn(HALL8, "elastic_modulus", 10.0, 3306)
    case = case_in(written(make(HALL8, truth, rows=24, seed=3306), tmp_path))
    some = tuple(effect for effect in case.candidates if effect.cable in (None, 1, 6))
    found = diagnose(replace(case, candidates=some))
    (finding,) = found.findings
    assert finding.effect.id == "elastic_modulus"
    scale = finding.parameters["scale"]
    assert abs(scale.value - truth["elastic_modulus"]["scale"]) < 4.0 * scale.std


def test_a_diagnosed_model_is_checked_without_poses(tmp_path) -> None:
    truth = drawn(YARD3, "platform_mass", 10.0, 3307)
    config = written(make(YARD3, truth, rows=40, seed=3307), tmp_path)
    study = read_study(config)
    measured = read_measured(study)
    bare = check(study, measured)
    declared = yaml.safe_load(config.read_text(encoding="utf-8")) | {"effects": truth}
    config.write_text(yaml.safe_dump(declared), encoding="utf-8")
    study = read_study(config)
    helped = check(study, measured)
    assert helped.is_positive
    assert helped.declared.tension_N.rms.value < 0.5 * bare.declared.tension_N.rms.value
    assert json.loads(helped.to_json())["rows"]["poses"] == "estimated"


def test_lengths_alone_of_as_many_cables_as_degrees_of_freedom_are_refused(tmp_path) -> None:
    told = faults_of(written(make(YARD3, rows=12, seed=3308), tmp_path, ("length",)))
    assert "rows have at most 3 readings, for 3 unknowns: 3 of the pose" in told


SCALES = (1.003, 0.9985)
DRAWN_M = np.array([[0.0, 0.0, 2.4], [3.6, 0.0, 2.4], [3.6, 0.0, 0.0], [0.0, 0.0, 0.0]])


def router(folder: Path, exit_m: np.ndarray, unknown: list[str], seed: int) -> Path:
    """Write the log of a wall router with four belts, of lengths alone; return its config.

    Its lower belts are held at 20 N; belts sag as parabolas do, and stretch. Where exit points are
    not unknown, the zeros of the winches are declared.
    """
    rng = np.random.default_rng(seed)
    position_m = np.stack([rng.uniform(0.4, 3.2, 60), np.zeros(60), rng.uniform(0.25, 2.0, 60)], -1)
    span_m = exit_m - position_m[:, None]
    chord_m = np.linalg.norm(span_m, axis=2)
    along = np.moveaxis((span_m / chord_m[..., None])[..., [0, 2]], 1, 2)
    tension_N = np.full((60, 4), 20.0)
    load_N = 20.0 * along[..., 2:].sum(axis=2) - [0.0, 12.0 * 9.80665]
    tension_N[:, :2] = np.linalg.solve(along[..., :2], -load_N[..., None])[..., 0]
    across_N = 0.03 * 9.80665 * np.abs(span_m[..., 0])
    arc_m = chord_m * (1.0 + across_N**2 / (24.0 * tension_N**2))
    length_m = arc_m / (1.0 + tension_N / 1e5) * [*SCALES, 1.0, 1.0]
    length_m += rng.normal(0.0, 1e-3, length_m.shape)
    head = "length_1_m,length_2_m,length_3_m,length_4_m"
    np.savetxt(folder / "log.csv", length_m, delimiter=",", header=head, comments="", fmt="%.6f")
    config = {
        "name": "router",
        "robot": {
            "planar": True,
            "anchors": DRAWN_M.tolist(),
            "platform": {"mass": "12 kg"},
            "tension_min": "20 N",
        },
        "cable": {
            "density": "1500 kg/m^3",
            "youngs_modulus": "10 GPa",
            "allowable_stress": "100 MPa",
        },
        "effects": {} if "anchors" in unknown else {"length_offset": {"offset_1_m": 0.0}},
        "workspace": {"region": {"rectangle": [[0.4, 0], [3.2, 0]], "z": [0.3, 2.0]}},
        "measurements": {
            "file": "log.csv",
            "unknown": ["poses", *unknown],
            "noise": {"length": "1 mm"},
            "cable": {"linear_mass": "0.03 kg/m", "axial_stiffness": "100 kN"},
        },
    }
    path = folder / "router.yaml"
    path.write_text(yaml.safe_dump(config), encoding="utf-8")
    return path


def scales_in(case: Case) -> tuple[list[float], list[float], float]:
    """Return fitted scales of the upper belts, their deviations, and the loss over its count."""
    noise = Noise(1e-3, 1.0, "declared")
    problem = Problem(case.measured, case.predictor(), noise)
    rows = np.ones(case.measured.n_rows, dtype=np.bool_)
    model = fit(problem, case.given, rows, thorough=True)
    names = [(s.effect.id, name) for s in model.settings for name in s.values]
    places = [k for k, name in enumerate(names) if name == ("winch_scale", "scale")]
    spare = model.n_data - len(model.vector)
    return model.vector[places].tolist(), model.std[places].tolist(), model.loss / spare


TOP = ["winch_scale of cable 1", "winch_scale of cable 2"]


@pytest.mark.slow
@pytest.mark.parametrize("seed", [3320, 3321, 3322])
def test_lengths_alone_tell_the_scales_of_two_of_four_belts(seed, tmp_path) -> None:
    case = case_in(router(tmp_path, DRAWN_M, TOP, seed))
    assert [effect.key for effect in case.given] == TOP
    scale, std, loss = scales_in(case)
    assert np.abs(np.subtract(scale, SCALES)).max() < 3.0 * max(std)
    assert max(std) < 1.5e-4
    assert loss == pytest.approx(1.0, abs=0.4)


@pytest.mark.slow
def test_exit_points_are_told_in_a_frame_that_some_of_them_hold(tmp_path) -> None:
    off_m = np.random.default_rng(3323).normal(0.0, 0.015, (4, 3)) * [1.0, 0.0, 1.0]
    case = case_in(router(tmp_path, DRAWN_M + off_m, ["anchors", *TOP], 3323))
    (note,) = (note for note in case.measured.notes if "frame" in note)
    assert note.startswith("the frame is held by")
    assert note.count("exit point") == 3
    fitted = [p.name for e in case.given if e.id == "anchor_offset" for p in e.parameters]
    assert len(fitted) == 5
    assert "y_m" not in fitted
    scale, std, loss = scales_in(case)
    assert np.abs(np.subtract(scale, SCALES)).max() < 4.0 * max(std)
    assert max(std) < 1e-3
    assert loss == pytest.approx(1.0, abs=0.4)


def test_scales_of_all_winches_let_the_frame_grow(tmp_path) -> None:
    case = case_in(router(tmp_path, DRAWN_M, ["anchors", "winch_scale"], 3324))
    (note,) = (note for note in case.measured.notes if "frame" in note)
    assert note.count("exit point") == 4


def test_a_swaying_platform_is_refused(tmp_path) -> None:
    told = faults_of(written(make(FIELD4, rows=12, seed=3309), tmp_path))
    assert "fewer cables than degrees of freedom" in told


def test_what_the_config_has_to_say(tmp_path) -> None:
    dataset = make(YARD3, rows=12, seed=3310)
    noisy = {"noise": {"length": "1 mm"}, "unknown": ["poses", "base_tilt"]}
    path = written(dataset, tmp_path, **noisy)
    config = yaml.safe_load(path.read_text(encoding="utf-8"))
    del config["workspace"]
    path.write_text(yaml.safe_dump(config), encoding="utf-8")
    told = faults_of(path)
    assert "workspace.region: is missing" in told
    assert "'base_tilt' and 'poses' are both unknown" in told


def test_the_noise_of_both_kinds_of_readings_weighs_them(tmp_path) -> None:
    told = faults_of(written(make(YARD3, rows=12, seed=3310), tmp_path, noise={"length": "1 mm"}))
    assert "measurements.noise.tension: is missing" in told


def test_given_poses_that_are_said_to_be_unknown_are_left_out(tmp_path) -> None:
    dataset = make(YARD3, rows=12, seed=3311)
    path = written(dataset, tmp_path)
    dataset.write(tmp_path / "whole")
    config = yaml.safe_load(path.read_text(encoding="utf-8"))
    config["measurements"]["file"] = "whole/measured.csv"
    path.write_text(yaml.safe_dump(config), encoding="utf-8")
    measured = read_measured(read_study(path))
    assert "x_m, y_m, z_m left out: poses are said to be unknown" in measured.notes
    assert not measured.has_poses


def test_winches_that_were_homed_anywhere(tmp_path) -> None:
    """Tensions tell roughly where the platform is, and many rows then where the winches began."""
    true_m = {"offset_1_m": 0.4, "offset_2_m": -0.3, "offset_3_m": 0.25}
    dataset = make(YARD3, {"length_offset": true_m}, rows=40, seed=3312)
    case = case_in(written(dataset, tmp_path, unknown=["poses", "length_offset"]))
    noise = Noise(YARD3.noise_m, YARD3.noise_N, "declared")
    problem = Problem(case.measured, case.predictor(), noise)
    found = fit(problem, case.given, np.ones(40, dtype=np.bool_), thorough=True)
    assert np.abs(found.vector - list(true_m.values())).max() < 0.02
    assert (np.abs(found.vector - list(true_m.values())) < 4.0 * found.std).all()
