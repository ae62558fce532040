"""A path in the config: what is read, and each mistake in one line."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from designer.errors import InputError
from designer.io.config import read_study
from designer.io.config.schema import PathSection
from designer.study import Study

BODY = """\
robot:
  anchors: [[8, 0, 9], [4, 7, 9], [-4, 7, 9], [-8, 0, 9], [-4, -7, 9], [4, -7, 9]]
  platform:
    mass: 100
    INERTIA
    attachments: [[1, 0.2, 0], [1, 0.3, 0], [-0.6, 0.9, 0], [-0.6, 0.7, 0], [-0.5, -1, 0],
      [-0.4, -0.9, 0]]
cable: {density: 7800, youngs_modulus: 100 GPa, allowable_stress: 180 MPa}
workspace:
  PATH
MORE
"""
KNOWN = "inertia: [10, 10, 20]"
TIMED = "time_s,x_m,y_m,z_m\n0,0,0,2\n1,1,0,2\n3,1,1,3\n"
UNTIMED = "x_m,y_m,z_m\n0,0,2\n1,0,2\n1,1,3\n"
TURNED = "time_s,x_m,y_m,z_m,rx_rad,ry_rad,rz_rad\n0,0,0,2,0,0,0\n1,1,0,2,0,0.1,0\n"
LIMITED = "path: {file: path.csv, speed_max: 2 m/s, acceleration_max: 0.5 m/s^2}"
StudyOf = Callable[..., Study]


@pytest.fixture
def along(tmp_path: Path) -> StudyOf:
    def read(
        rows: str, path: str = "path: path.csv", more: str = "", inertia: str = KNOWN
    ) -> Study:
        (tmp_path / "path.csv").write_text(rows)
        text = BODY.replace("PATH", path).replace("MORE", more).replace("INERTIA", inertia)
        file = tmp_path / "body.yaml"
        file.write_text(text)
        return read_study(file)

    return read


def test_times_of_the_file(along: StudyOf) -> None:
    study = along(TIMED)
    motion, workspace = study.robot.platform.motion, study.workspace
    assert motion is not None
    assert workspace is not None
    assert motion.time_s[[0, -1]].tolist() == [0.0, 3.0]
    assert {0.0, 1.0, 3.0} <= {*motion.time_s.tolist()}
    assert workspace.sample_count == len(motion.time_s)
    assert workspace.proof_s == 0.0
    assert motion.velocity[0] == pytest.approx(0.0, abs=1e-12)
    assert study.source.tables[0][0] == "path.csv"
    assert any(entry.field == "workspace.path.file" for entry in study.source.entries)
    moving = along(TIMED, "path: {file: path.csv, ends: moving}").robot.platform.motion
    assert moving is not None
    assert np.abs(moving.velocity[0]).max() > 0.1


def test_limits_instead_of_times(along: StudyOf) -> None:
    motion = along(UNTIMED, LIMITED).robot.platform.motion
    assert motion is not None
    assert np.linalg.norm(motion.velocity[:, :3], axis=1).max() <= 2.0
    gain = np.linalg.norm(motion.acceleration[:, :3], axis=1).max()
    assert 0.2 < gain <= 0.5 * (1.0 + 1e-6)


def test_one_orientation_all_along(along: StudyOf) -> None:
    study = along(TIMED, "path: path.csv\n  orientation: [0, 0.1, 0]", inertia="")
    motion = study.robot.platform.motion
    assert motion is not None
    assert motion.rotation_vectors_rad == pytest.approx(
        np.tile([0.0, 0.1, 0.0], (401, 1)), abs=1e-9
    )
    assert not motion.turns


@pytest.mark.parametrize(
    ("rows", "path", "line", "field", "problem"),
    [
        (TIMED.replace("3,1,1", "1,1,1"), "", 4, "time_s", "row 3 has the time 1 s after 1 s"),
        (TIMED.replace("3,1,1", "0.5,1,1"), "", 4, "time_s", "0.5 s after 1 s"),
        (TIMED.replace("3,1,1", ",1,1"), "", 4, "time_s", "row 3 holds nothing"),
        (TIMED.replace("time_s", "time"), "", 1, "time", "is no name of a column"),
        (TIMED.replace("y_m", "why"), "", 1, "y_m", "there is no such column"),
        ("time_s,x_m,y_m,z_m\n0,0,0,2\n", "", None, "", "1 row"),
        (TIMED.replace("1,0,2", "1,zero,2"), "", 3, "y_m", "holds 'zero'"),
        ("time_s,x_m,y_m,z_m\n0,0,0,2\n1,0,0,2\n", "", None, "", "stays where it is"),
        (UNTIMED + "1,1,3\n", LIMITED, 5, "x_m", "is the place of the row before"),
        (TIMED.replace("z_m", "z_m,load_case"), "", None, "load_case", "all load cases follow"),
    ],
)  # fmt: skip
def test_mistakes_in_the_file(
    along: StudyOf, rows: str, path: str, line: int | None, field: str, problem: str
) -> None:
    if "load_case" in rows:
        rows = "\n".join(f"{row},a" if k else row for k, row in enumerate(rows.split("\n")[:-1]))
    with pytest.raises(InputError) as caught:
        along(rows, path or "path: path.csv")
    fault = caught.value.faults[0]
    assert Path(fault.file).name == "path.csv"
    assert fault.field == field
    assert problem in fault.problem
    if line is not None:
        assert fault.line == line


ONE = "uncertainty: {payload: {uniform: 0.1}}\nselection: {}"
WINCHES = "robot.winches"


@pytest.mark.parametrize(
    ("rows", "path", "more", "field", "problem"),
    [
        (UNTIMED, "path: path.csv", "", "workspace.path", "speed_max is missing"),
        (UNTIMED, "path: {file: path.csv, speed_max: 1}", "", "workspace.path",
         "acceleration_max is missing"),
        (UNTIMED, LIMITED[:-1] + ", ends: moving}", "", "workspace.path.ends", "no column time_s"),
        (TIMED, LIMITED, "", "workspace.path.speed_max", "has times of its own"),
        (TIMED, "path: {file: path.csv, speed_max: -1}", "", "workspace.path.speed_max",
         "out of range"),
        (TIMED, "path: {file: path.csv, ends: open}", "", "workspace.path.ends", "open"),
        (TIMED, "path: {speed_max: 1}", "", "workspace.path.file", "missing"),
        (TIMED, "path: other.csv", "", "workspace.path.file", "other.csv"),
        (TIMED, "path: path.csv\n  poses: path.csv", "", "workspace", "has poses and path"),
        (TIMED, "path: path.csv\n  proof: 5 s", "", "workspace.proof", "nothing is proved"),
        (TIMED, "path: path.csv\n  orientations: [[0, 0, 0]]", "", "workspace.orientations",
         "moves along path.csv"),
        (TIMED, "path: path.csv\n  orientation: {toward: [0, 0, 9]}", "", "workspace.orientation",
         "moves along path.csv"),
        (TURNED, "path: path.csv\n  orientation: [0, 0, 0]", "", "workspace.orientation",
         "orientations of its own"),
        (TURNED, "path: path.csv", "load_cases: [{name: a, mass: 90}]", "load_cases[0].mass",
         "no inertia beside it"),
        (TIMED, "path: path.csv", "load_cases: [{name: a, acceleration: 1}]",
         "load_cases[0].acceleration", "accelerations itself"),
        (TIMED, "path: path.csv", "load_cases: [{name: a, temperature_change: 9}]",
         "load_cases[0].temperature_change", "braked winches"),
        (TIMED, "path: path.csv", "load_cases: [{name: a, region: {points: [[0, 0, 2]]}}]",
         "load_cases[0].region", "follows workspace.path"),
        (TIMED, "path: path.csv", ONE, "uncertainty", "along a path"),
        (TIMED, "path: path.csv", "selection: {groups: {a: [1, 2, 3], b: [4, 5, 6]}}",
         "selection.groups", "along a path"),
    ],
)  # fmt: skip
def test_mistakes_in_the_study(
    along: StudyOf, rows: str, path: str, more: str, field: str, problem: str
) -> None:
    with pytest.raises(InputError) as caught:
        along(rows, path, more)
    (fault,) = caught.value.faults
    assert fault.field == field
    assert problem in fault.problem
    assert fault.line is not None


def test_a_turn_needs_the_inertia(along: StudyOf) -> None:
    with pytest.raises(InputError) as caught:
        along(TURNED, inertia="")
    (fault,) = caught.value.faults
    assert (fault.field, fault.line) == ("robot.platform", 3)
    assert "inertia is missing" in fault.problem


def test_speeds_of_winches_need_a_path(along: StudyOf, tmp_path: Path) -> None:
    along(TIMED)
    file = tmp_path / "body.yaml"
    text = file.read_text().replace("path: path.csv", "region: {points: [[0, 0, 2]]}")
    file.write_text(text.replace("  platform:\n", "  winches: {speed_max: 1}\n  platform:\n"))
    with pytest.raises(InputError) as caught:
        read_study(file)
    (fault,) = caught.value.faults
    assert fault.field == "robot.winches.speed_max"
    assert "nothing moves" in fault.problem


def test_a_name_alone_is_the_file() -> None:
    assert PathSection.model_validate("a.csv").file == "a.csv"


@pytest.mark.parametrize(
    ("given", "asked", "told"),
    [
        ("", "sheave_diameter: 0.3\n  rope_life: {CONSTANTS}", "no path along which ropes bend"),
        ("path: path.csv", "rope_life: {CONSTANTS}", "the sheaves' diameter is not given"),
        (
            "path: path.csv",
            "sheave_diameter: 0.3\n  rope_life: {CONSTANTS, days_min: 9}",
            "selection.rope_life.runs_per_day",
        ),
        ("path: path.csv", "sheave_diameter: 0.3\n  rope_life: {b0: 1}", "selection.rope_life"),
    ],
)
def test_the_life_of_a_rope_needs_its_path_sheave_and_source(
    along: StudyOf, given: str, asked: str, told: str
) -> None:
    constants = "b0: 1, b1: -2, b2: 5, b3: -1, wire_strength: 1770 MPa, source: a book"
    more = "selection:\n  " + asked.replace("CONSTANTS", constants)
    with pytest.raises(InputError, match=told):
        along(TIMED, given or "region: {points: [[0, 0, 2]]}", more)
    if told.startswith("no path"):
        life = along(TIMED, "path: path.csv", more).selection
        assert life is not None
        assert life.rope_life is not None
        assert life.rope_life.source == "a book"
