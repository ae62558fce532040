"""Poses of which some coordinates were measured: a height by a laser, angles by an inclinometer."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml
from scipy.spatial.transform import Rotation
from test_free_poses import case_in, faults_of

from designer.diagnosis.case import Case
from designer.diagnosis.fit import Fit, fit
from designer.diagnosis.problem import Problem
from designer.diagnosis.result import rows_dict
from designer.model.measured_data import Noise

MASTS_M = np.array([[0.0, 0.0, 12.0], [20.0, 0.0, 11.0], [9.0, 17.0, 12.5]])
SCALE = 1.004
PAIRS = np.radians([[90, 90, 210, 210, 330, 330], [30, 150, 150, 270, 270, 30]])
EXITS_M = np.stack([4 * np.cos(PAIRS[0]), 4 * np.sin(PAIRS[0]), np.full(6, 6.0)], axis=1)
BODY_M = np.stack([1.5 * np.cos(PAIRS[1]), 1.5 * np.sin(PAIRS[1]), np.zeros(6)], axis=1)
"""Six cables from three corners to the three edges of a triangle, as in NIST's RoboCrane."""


def written(folder: Path, table: dict[str, np.ndarray], robot: dict, **measurements) -> Path:
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
    return written(folder, columns | {"z_m": z_m}, robot, **given)


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
    return written(folder, columns, robot, **given | measurements)


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
