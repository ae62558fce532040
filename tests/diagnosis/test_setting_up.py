"""Errors of setting up come before physics: frames, attachments, single winches and cables."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from report_parts import diagnosis_page
from scipy.spatial.transform import Rotation
from twins.dataset import DataSet, make
from twins.robots import HALL6, HALL8, YARD3, TwinRobot

from designer.diagnosis.case import case_of
from designer.diagnosis.check import check
from designer.diagnosis.diagnose import diagnose
from designer.diagnosis.result import Diagnosis
from designer.diagnosis.study import diagnosed_config
from designer.errors import InputError
from designer.io.config import read_study
from designer.measured.read import read_measured

SPAN110 = replace(
    YARD3,
    name="span110",
    exit_m=((0, 0, 30), (110, 0, 31), (52, 95, 29)),
    pose_m=(54.0, 32.0, 12.0),
    box_m=((40, 68), (20, 45), (4, 16)),
    mass_kg=600.0,
    linear_mass=0.3,
    stiffness_N=8e6,
    noise_m=0.003,
    noise_N=8.0,
)
"""A robot of 110 m."""


ENDS = ("anchor_offset", "attachment_offset", "drum_eccentricity")


def diagnosed(dataset: DataSet, folder: Path, unknown: tuple[str, ...] = ()) -> Diagnosis:
    dataset.write(folder)
    study = read_study(folder / "config.yaml")
    assert study.measurements is not None
    measurements = replace(study.measurements, unknown=unknown)
    study = replace(study, measurements=measurements)
    return diagnose(case_of(study, measurements, read_measured(study)))


def assert_found_alone(found: Diagnosis, dataset: DataSet) -> None:
    """Name what is in the data, with its numbers; as a rival at most an end or drum of the cable.

    Over a small region, an end that moves along the cable is a homing error to first order, and a
    slow wave of its drum, which has four numbers, is much alike. A point mass does not turn: a
    marker beside it is a shift of all poses.
    """
    ((effect, true),) = dataset.effects.items()
    assert [finding.effect.id for finding in found.findings] == [effect]
    assert not found.is_unexplained
    (finding,) = found.findings
    ends = {f"{end} of cable {finding.effect.cable}" for end in ENDS}
    ends |= {"tool_point"} if effect == "pose_shift" else set()
    assert set(finding.rivals) <= ends
    assert finding.effect.cable == true.get("cable")
    for name, estimate in finding.parameters.items():
        if name in true:
            assert abs(estimate.value - true[name]) < 4.0 * estimate.std


CASES = [
    (SPAN110, "pose_shift", {"x_m": 0.1, "y_m": 0.0, "z_m": 0.0}),
    (SPAN110, "pose_shift", {"x_m": 0.0, "y_m": 0.0, "z_m": 0.1}),
    (SPAN110, "pose_shift", {"x_m": 0.22, "y_m": -0.24, "z_m": 0.14}),
    (YARD3, "pose_scale", {"scale": 1.003}),
    (HALL6, "pose_scale", {"scale": 1.003}),
    (HALL6, "attachment_offset", {"cable": 4, "x_m": 0.015, "y_m": -0.016, "z_m": 0.012}),
    (YARD3, "cable_modulus", {"cable": 2, "scale": 0.6}),
    (HALL6, "cable_modulus", {"cable": 5, "scale": 0.6}),
    (HALL6, "winch_scale", {"cable": 3, "scale": 2.0}),
    (YARD3, "winch_scale", {"cable": 1, "scale": 1.003}),
    (HALL6, "winch_zero", {"cable": 6, "offset_m": 0.02}),
    (YARD3, "cable_creep", {"cable": 2, "strain_per_decade": 1e-3, "onset_s": 600.0}),
    (YARD3, "cable_pulley_radius", {"cable": 2, "radius_m": 0.024}),
]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("robot", "effect", "true"),
    CASES,
    ids=[f"{r.name} {e} {k}" for k, (r, e, _) in enumerate(CASES)],
)
def test_an_error_of_setting_up_is_named_and_nothing_else(
    robot: TwinRobot, effect: str, true: dict[str, float], tmp_path: Path
) -> None:
    seed = 7100 + CASES.index((robot, effect, true))
    dataset = make(robot, {effect: {k: float(v) for k, v in true.items()}}, seed=seed)
    assert_found_alone(diagnosed(dataset, tmp_path), dataset)


@pytest.mark.slow
def test_a_drum_that_is_right_at_no_length_is_a_scale_of_its_winch(tmp_path: Path) -> None:
    dataset = make(YARD3, seed=7201)
    read = np.array(dataset.length_m)
    read[:, 1] *= 1.003
    found = diagnosed(replace(dataset, length_m=read), tmp_path)
    (finding,) = found.findings
    assert finding.effect.key == "winch_scale of cable 2"
    assert finding.parameters["scale"].value == pytest.approx(1.003, abs=2e-4)
    assert abs(finding.parameters["offset_m"].value) < 4.0 * finding.parameters["offset_m"].std


@pytest.mark.slow
@pytest.mark.parametrize("robot", [SPAN110, HALL6, HALL8], ids=lambda robot: robot.name)
def test_a_frame_is_one_cause_and_its_study_checks(robot: TwinRobot, tmp_path: Path) -> None:
    """The turn is that of the camera; what the config then says leaves noise on the same rows."""
    frame = {"x_m": 0.02, "y_m": -0.03, "z_m": 0.01, "rx_rad": 0.004, "ry_rad": -0.002}
    frame |= {"rz_rad": 0.006, "scale": 1.002}
    found = diagnosed(make(robot, {"pose_frame": frame}, seed=7301), tmp_path)
    (finding,) = found.findings
    assert finding.effect.key == "pose_frame"
    for name in ("rx_rad", "ry_rad", "rz_rad", "scale"):
        estimate = finding.parameters[name]
        assert abs(estimate.value - frame[name]) < 4.0 * estimate.std
    (tmp_path / "found.yaml").write_text(diagnosed_config(found, tmp_path))
    study = read_study(tmp_path / "found.yaml")
    assert study.measurements is not None
    checked = check(study, read_measured(study))
    assert checked.is_positive
    assert checked.declared.length_m is not None
    assert checked.declared.length_m.rms.value < 1.2 * robot.noise_m


@pytest.mark.slow
def test_a_pulley_is_a_pulley_all_the_same(tmp_path: Path) -> None:
    dataset = make(SPAN110, {"pulley_radius": {"radius_m": 0.06}}, seed=7401)
    assert_found_alone(diagnosed(dataset, tmp_path), dataset)


@pytest.mark.slow
def test_attachments_may_be_unknown(tmp_path: Path) -> None:
    at = {"cable": 2.0, "x_m": 0.012, "y_m": 0.009, "z_m": -0.02}
    found = diagnosed(
        make(HALL6, {"attachment_offset": at}, seed=7501), tmp_path, unknown=("attachments",)
    )
    assert found.findings == ()
    moved = next(s.values for s in found.given if s.effect.key == "attachment_offset of cable 2")
    assert [moved[name] for name in ("x_m", "y_m", "z_m")] == pytest.approx(
        [at[name] for name in ("x_m", "y_m", "z_m")], abs=0.004
    )


@pytest.mark.slow
def test_a_wrong_mechanical_advantage_is_told_where_exit_points_are_unknown(tmp_path: Path) -> None:
    """They would move by metres to make up for it."""
    dataset = make(YARD3, {"winch_scale": {"cable": 3.0, "scale": 2.0}}, seed=7502)
    found = diagnosed(dataset, tmp_path, unknown=("anchors", "length_offset"))
    (finding,) = found.findings
    assert finding.effect.key == "winch_scale of cable 3"
    assert list(finding.parameters) == ["scale"]  # its zero is unknown with all the others
    assert finding.parameters["scale"].value == pytest.approx(2.0, abs=3e-4)
    assert found.doubts == ()
    for given in found.given:
        if given.effect.id == "anchor_offset":
            assert np.abs(list(given.values.values())).max() < 0.02


@pytest.mark.slow
def test_physics_tells_which_error_of_setting_up_to_rule_out(tmp_path: Path) -> None:
    """Lengths alone, of few rows, tell the stretch of one cable badly from its homing."""
    dataset = make(YARD3, {"cable_modulus": {"cable": 1.0, "scale": 0.75}}, rows=40, seed=7503)
    found = diagnosed(replace(dataset, tension_N=np.full_like(dataset.tension_N, np.nan)), tmp_path)
    (finding,) = found.findings
    assert finding.effect.key == "cable_modulus of cable 1"
    assert finding.rule_out == ("length_offset",)
    (rivals,) = (s for s in diagnosis_page(found).sureness if s.title == "Rivals")
    assert "rule out length_offset first" in rivals.text


def mirrored(dataset: DataSet, mirror: np.ndarray) -> DataSet:
    """Return the data as a left-handed camera sees them."""
    turn = Rotation.from_rotvec(dataset.scene.rotation_vector_rad).as_matrix()
    turn = Rotation.from_matrix(mirror @ turn @ mirror.T).as_rotvec()
    position = dataset.scene.position_m @ mirror.T
    scene = replace(dataset.scene, position_m=position, rotation_vector_rad=turn)
    return replace(dataset, scene=scene)


EXCHANGED = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize(
    ("mirror", "text"),
    [(np.diag([1.0, -1.0, 1.0]), "y counted the other way"), (EXCHANGED, "x and y exchanged")],
    ids=["y", "x and y"],
)
def test_a_mirrored_frame_is_named_as_one(mirror, text: str, tmp_path: Path) -> None:
    found = diagnosed(mirrored(make(HALL6, seed=7601), mirror), tmp_path)
    assert found.findings == ()
    assert [event.text for event in found.structure_after.events] == [
        f"a mirrored frame of the poses: {text}"
    ]


@pytest.mark.parametrize("axis", [0, 1])
def test_a_mirrored_frame_is_no_order_of_the_cables(axis: int, tmp_path: Path) -> None:
    mirror = np.eye(3)
    mirror[axis, axis] = -1.0
    with pytest.raises(InputError) as refused:
        diagnosed(mirrored(make(HALL8, seed=7602), mirror), tmp_path)
    (fault,) = refused.value.faults
    assert f"{'xyz'[axis]} counted the other way: the frame of the poses is" in fault.problem
    assert fault.field == "x_m, y_m, z_m"


def test_poses_that_only_a_mirrored_robot_holds_are_told_so(tmp_path: Path) -> None:
    dataset = mirrored(make(YARD3, seed=7603), np.diag([-1.0, 1.0, 1.0]))
    unread = np.full_like(dataset.length_m, np.nan)
    with pytest.raises(InputError, match=r"with x counted the other way, it can hold 120"):
        diagnosed(replace(dataset, length_m=unread), tmp_path)


@pytest.mark.parametrize(
    ("unknown", "given", "still_tried"),
    [
        (
            ["winch_scale of cable 1"],
            {"winch_scale of cable 1": ["scale", "offset_m"]},
            ["winch_zero of cable 2", "winch_zero of cable 3"],
        ),
        (
            ["winch_scale of cable 1", "winch_zero of cable 1", "length_offset"],
            {
                "winch_scale of cable 1": ["scale"],
                "length_offset": ["offset_1_m", "offset_2_m", "offset_3_m"],
            },
            [],
        ),
    ],
)
def test_a_zero_is_unknown_once_and_of_its_own_winch(unknown, given, still_tried, tmp_path) -> None:
    make(YARD3, seed=7510, rows=20).write(tmp_path)
    study = read_study(tmp_path / "config.yaml")
    assert study.measurements is not None
    measurements = replace(study.measurements, unknown=tuple(unknown))
    case = case_of(study, measurements, read_measured(study))
    assert {e.key: [p.name for p in e.parameters] for e in case.given} == given
    assert [e.key for e in case.candidates if e.id == "winch_zero"] == still_tried
