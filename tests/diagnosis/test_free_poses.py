"""Rows without poses, or with poses in part: estimated from what was read, and diagnosed."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml
from report_parts import diagnosis_page
from scipy.spatial.transform import Rotation
from twins.dataset import DataSet, make, size_for
from twins.robots import FAST3, FIELD4, HALL8, YARD3, TwinRobot

from designer.diagnosis.case import Case, case_of
from designer.diagnosis.check import check
from designer.diagnosis.diagnose import diagnose
from designer.diagnosis.fit import Fit, fit
from designer.diagnosis.free_poses import ABSORBED, FreePredictor
from designer.diagnosis.problem import Problem
from designer.diagnosis.result import Diagnosis, rows_dict
from designer.errors import InputError
from designer.io.config import read_study
from designer.measured.read import read_measured
from designer.model.measurements import Noise

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


MASTS_M = np.array([[0.0, 0.0, 12.0], [20.0, 0.0, 11.0], [9.0, 17.0, 12.5]])
SCALE = 1.004
PAIRS = np.radians([[90, 90, 210, 210, 330, 330], [30, 150, 150, 270, 270, 30]])
EXITS_M = np.stack([4 * np.cos(PAIRS[0]), 4 * np.sin(PAIRS[0]), np.full(6, 6.0)], axis=1)
BODY_M = np.stack([1.5 * np.cos(PAIRS[1]), 1.5 * np.sin(PAIRS[1]), np.zeros(6)], axis=1)
"""Six cables from three corners to the three edges of a triangle, as in NIST's RoboCrane."""


def written_in_part(
    folder: Path, table: dict[str, np.ndarray], robot: dict, **measurements
) -> Path:
    """Write a log and a study of it; return the latter."""
    rows = zip(*table.values(), strict=True)
    cells = (["" if np.isnan(cell) else f"{cell:.7f}" for cell in row] for row in rows)
    text = [",".join(row) for row in (table, *cells)]
    (folder / "log.csv").write_text("\n".join(text) + "\n", encoding="utf-8")
    region = {"prism": "anchors", "inset": "1.5 m", "z": [1.0, 8.0]}
    if "attachments" in robot["platform"]:
        region = {"box": [[-0.8, 0.8], [-0.8, 0.8], [1.0, 3.0]]}
    config = {
        "name": "in part",
        "robot": robot,
        "cable": {"density": "1 g/cm^3", "youngs_modulus": "1 TPa", "allowable_stress": "1 GPa"},
        "effects": {"length_offset": {"offset_1_m": 0.0}},
        "workspace": {"region": region},
        "measurements": {
            "file": "log.csv",
            "cable": {"linear_mass": "0.02 kg/m", "axial_stiffness": "400 kN"},
            **measurements,
        },
    }
    path = folder / "part.yaml"
    path.write_text(yaml.safe_dump(config), encoding="utf-8")
    return path


def crane(folder: Path, unknown: list[str], seed: int, rows: int = 40, /, **measurements) -> Path:
    """A point under three masts, whose cables stretch and sag as parabolas do; z by a laser."""
    rng = np.random.default_rng(seed)
    weights = rng.dirichlet([3.0, 3.0, 3.0], rows)
    position_m = weights @ MASTS_M
    position_m[:, 2] = rng.uniform(1.5, 7.0, rows)
    span_m = MASTS_M - position_m[:, None]
    chord_m = np.linalg.norm(span_m, axis=2)
    along = np.swapaxes(span_m / chord_m[..., None], 1, 2)
    tension_N = np.linalg.solve(along, np.tile([[0.0], [0.0], [50 * 9.80665]], (rows, 1, 1)))[
        ..., 0
    ]
    across_N = 0.02 * 9.80665 * np.linalg.norm(span_m[..., :2], axis=2)
    length_m = chord_m * (1 + across_N**2 / (24 * tension_N**2)) / (1 + tension_N / 4e5)
    length_m *= [SCALE, 1.0, 1.0]
    length_m += rng.normal(0.0, 1e-3, length_m.shape)
    z_m = position_m[:, 2] + rng.normal(0.0, 2e-3, rows)
    z_m[::8] = np.nan
    columns = {f"length_{k}_m": column for k, column in enumerate(length_m.T, start=1)}
    robot = {"anchors": MASTS_M.tolist(), "platform": {"mass": "50 kg"}}
    noise = {"length": "1 mm", "position": "2 mm"}
    given = {"unknown": ["poses", *unknown], "noise": noise} | measurements
    return written_in_part(folder, columns | {"z_m": z_m}, robot, **given)


def platform(folder: Path, seed: int, angles: tuple[str, ...], /, **measurements) -> Path:
    """Write what six cables under a triangle, which stretch, and an inclinometer would show."""
    rng = np.random.default_rng(seed)
    position_m = rng.uniform([-0.8, -0.8, 1.0], [0.8, 0.8, 3.0], (30, 3))
    euler = rng.normal(0.0, 0.04, (30, 3))  # about z, y, x of the body
    arm_m = np.einsum("rij,kj->rki", Rotation.from_euler("ZYX", euler).as_matrix(), BODY_M)
    span_m = EXITS_M - position_m[:, None] - arm_m
    chord_m = np.linalg.norm(span_m, axis=2)
    pull = span_m / chord_m[..., None]
    wrench = np.concatenate([pull, np.cross(arm_m, pull)], axis=2)
    load = np.tile([[0.0], [0.0], [80 * 9.80665], [0.0], [0.0], [0.0]], (30, 1, 1))
    tension_N = np.linalg.solve(np.swapaxes(wrench, 1, 2), load)[..., 0]
    assert tension_N.min() > 20.0
    across_N = 0.02 * 9.80665 * np.linalg.norm(span_m[..., :2], axis=2)
    length_m = chord_m * (1 + across_N**2 / (24 * tension_N**2)) / (1 + tension_N / 4e5)
    length_m *= [SCALE, *[1.0] * 5]
    length_m += rng.normal(0.0, 1e-3, length_m.shape)
    columns = {f"length_{k}_m": column for k, column in enumerate(length_m.T, start=1)}
    read = euler + rng.normal(0.0, 1e-3, euler.shape)
    columns |= {name: read[:, int(name[-1]) - 1] for name in angles}
    robot = {
        "anchors": EXITS_M.tolist(),
        "platform": {"mass": "80 kg", "attachments": BODY_M.tolist()},
    }
    given = {
        "unknown": ["poses", "winch_scale of cable 1"],
        "noise": {"length": "1 mm", "rotation": "1 mrad"},
        "columns": {name: name for name in angles if name.startswith("euler")},
    }
    return written_in_part(folder, columns, robot, **given | measurements)


def fitted(case: Case) -> tuple[Fit, float]:
    """Return what is unknown, fitted to all rows, and the loss over its degrees of freedom."""
    problem = Problem(case.measured, case.predictor(), Noise(1e-3, 1.0, "declared"))
    model = fit(problem, case.given, np.ones(case.measured.n_rows, dtype=np.bool_), thorough=True)
    return model, model.loss / (model.n_data - len(model.vector))


@pytest.mark.slow
@pytest.mark.parametrize("seed", [5101, 5102])
def test_a_height_in_most_rows_tells_a_winch(seed, tmp_path) -> None:
    case = case_in(crane(tmp_path, ["winch_scale of cable 1"], seed))
    assert case.measured.coordinates is not None
    assert case.measured.coordinates.counts == {"z_m": 35}
    assert "z_m in 35" in case.measured.origin_of_poses
    model, loss = fitted(case)
    assert model.n_data == 35  # rows without a height have nothing to spare
    assert abs(model.vector[0] - SCALE) < 3.5 * model.std[0] < 2e-3
    assert loss == pytest.approx(1.0, abs=0.6)


def test_what_a_height_leaves_of_the_frame_is_named(tmp_path) -> None:
    case = case_in(crane(tmp_path, ["anchors"], 5103))
    (note,) = (note for note in case.measured.notes if "frame" in note)
    assert note.endswith("nothing read tells x, y, the turn about z")
    assert note.count("exit point") == 3
    assert "z of exit point" not in note


def test_what_is_left_of_coordinates_is_in_units_of_their_noise(tmp_path) -> None:
    case = case_in(crane(tmp_path, [], 5104))
    noise = Noise(1e-3, 1.0, "declared")
    predict = case.predictor()
    off = predict((), noise).coordinates_off
    assert off is not None
    assert (off[:, [0, 1, 3, 4, 5]] == 0.0).all()
    told = rows_dict((), case.measured)
    assert told["poses"] == "measured in part"
    assert told["coordinates"]["z_m"]["rows"] == 35


@pytest.mark.slow
def test_an_inclinometer_beside_six_lengths_tells_a_winch(tmp_path) -> None:
    angles = ("euler_intrinsic_zyx_2", "euler_intrinsic_zyx_3")
    case = case_in(platform(tmp_path, 5105, angles))
    assert case.measured.coordinates is not None
    assert case.measured.coordinates.counts == dict.fromkeys(angles, 30)
    model, loss = fitted(case)
    assert model.n_data == 60
    assert abs(model.vector[0] - SCALE) < 3.5 * model.std[0] < 2e-3
    assert loss == pytest.approx(1.0, abs=0.5)


@pytest.mark.parametrize(
    ("measurements", "told"),
    [
        ({"unknown": ["anchors"]}, "noise.position: has no use where poses are taken as they were"),
        (
            {"noise": {"length": "1 mm", "rotation": "1 deg"}},
            "has no coordinate that measurements.noise.rotation",
        ),
    ],
)
def test_noise_that_has_no_use_is_refused(measurements, told, tmp_path) -> None:
    assert told in faults_of(crane(tmp_path, [], 5106, 12, **measurements))


def test_angles_that_are_not_there_or_mean_nothing_alone_are_refused(tmp_path) -> None:
    assert "has no coordinate that measurements.noise.rotation" in faults_of(
        platform(tmp_path, 5107, ())
    )
    told = faults_of(platform(tmp_path, 5107, ("rx_rad_1",), columns={"rx_rad_1": "rx_rad"}))
    assert "ry_rad: is missing (expected all of it, or angles that count alone" in told


def test_half_a_pose_is_told_how_it_could_be_used(tmp_path) -> None:
    told = faults_of(crane(tmp_path, [], 5108, 12, unknown=["anchors"], noise={}))
    assert "'unknown: [poses]' with noise: {position: …, rotation: …} for poses in part" in told
