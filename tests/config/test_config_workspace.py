"""Which poses a config asks for, how the platform is turned there, and what poses have to keep."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from designer.errors import Fault, InputError
from designer.io.config import read_study
from designer.io.config.schema import PathSection
from designer.io.poses import poses_in, read_poses
from designer.model.region import Rectangle
from designer.model.robot import Poses
from designer.model.space import FILLING, ListedOrientations, OrientationTable, Toward
from designer.model.workspace import Workspace
from designer.resources import example_file
from designer.sizing.newton import size_poses
from designer.study import Study, as_built_by
from designer.workspace.best_orientations import BestOrientations
from designer.workspace.refine import refine

BODY_PLACES = """\
robot:
  anchors: [[8, 0, 9], [4, 7, 9], [-4, 7, 9], [-8, 0, 9], [-4, -7, 9], [4, -7, 9]]
  platform:
    mass: 100
    attachments: [[1, 0.2, 0], [1, 0.3, 0], [-0.6, 0.9, 0], [-0.6, 0.7, 0], [-0.5, -1, 0],
      [-0.4, -0.9, 0]]
cable: {density: 7800, youngs_modulus: 100 GPa, allowable_stress: 180 MPa}
workspace:
  WHERE
"""
BOX = "region: {box: [[-2, 2], [-2, 2], [1, 4]]}"
POSES = "x_m,y_m,z_m,rx_rad,ry_rad,rz_rad,load_case\n"
StudyOf = Callable[..., Study]


@pytest.fixture
def study_at(tmp_path: Path) -> StudyOf:
    def read(where: str, **files: str) -> Study:
        for name, text in files.items():
            (tmp_path / f"{name}.csv").write_text(text)
        path = tmp_path / "body.yaml"
        path.write_text(BODY_PLACES.replace("WHERE", where))
        return read_study(path)

    return read


def test_an_axis_points_at_its_point() -> None:
    rng = np.random.default_rng(0)
    point, axis, positions = rng.normal(size=3), rng.normal(size=3), rng.normal(size=(50, 3))
    turns = Toward(point, axis).turns_rad(positions)[:, 0]
    along = Rotation.from_rotvec(turns).apply(axis / np.linalg.norm(axis))
    to_point = point - positions
    assert along == pytest.approx(to_point / np.linalg.norm(to_point, axis=1, keepdims=True))
    assert turns @ axis == pytest.approx(0.0, abs=1e-12)  # the shortest turn: none about the axis
    ends = Toward(point, axis).turns_rad(np.array([point, point - axis, point + axis]))[:, 0]
    assert np.abs(ends[:2]).max() < 1e-12
    assert Rotation.from_rotvec(ends[2]).apply(axis) == pytest.approx(-axis)


def test_a_table_has_its_rows_and_is_linear_on_a_line() -> None:
    rng = np.random.default_rng(1)
    positions, turns = rng.normal(size=(30, 3)), rng.normal(size=(30, 3))
    table = OrientationTable(positions, turns)
    assert table.turns_rad(positions)[:, 0] == pytest.approx(turns)
    anywhere = table.turns_rad(rng.normal(size=(500, 3)) * 5.0)
    assert (anywhere <= turns.max(axis=0)).all()
    assert (anywhere >= turns.min(axis=0)).all()
    knots, height = np.array([0.0, 1.0, 4.0]), np.array([0.1, 0.5, -0.2])
    on_x, about_z = (
        np.outer(values, axis) for values, axis in ((knots, [1, 0, 0]), (height, [0, 0, 1]))
    )
    between = np.linspace(0.0, 4.0, 9)
    found = OrientationTable(on_x, about_z).turns_rad(np.outer(between, [1, 0, 0]))[:, 0, 2]
    assert found == pytest.approx(np.interp(between, knots, height))


def test_each_pose_of_a_list_keeps_its_orientations() -> None:
    positions = np.array([[0, 0, 1], [2, 0, 1], [0, 0, 1]], dtype=float)
    turns = np.array([[0.1, 0, 0], [0.2, 0, 0], [0.3, 0, 0]])
    law = ListedOrientations.of(positions, turns)
    at = law.turns_rad(positions[:2])[:, :, 0]
    assert sorted(at[0]) == [0.1, 0.3]
    assert list(at[1]) == [0.2, 0.2]


def test_a_list_is_all_that_is_asked_for(study_at: StudyOf) -> None:
    rows = ["0,0,2,0,0,0,", "1,0,2,0.1,0,0,lift", "1,0,2,-0.1,0,0,", "-1,1,3,0,0.2,0,wind"]
    cases = "\nload_cases: [{name: lift, mass: 200}, {name: wind, mass: 90}]"
    study = study_at(f"poses: list.csv{cases}", list=POSES + "\n".join(rows))
    assert study.workspace is not None
    want = {tuple(np.array(row.split(",")[:6], float)) for row in rows}
    assert {tuple(place) for place in np.concatenate([*study.workspace.places()])} == want
    of_lift = study.workspace.of_case(study.load_cases[0])
    assert {tuple(place) for place in np.concatenate([*of_lift.places()])} == {
        tuple(np.array(row.split(",")[:6], float)) for row in rows[:3]
    }
    assert study.workspace.space.is_discrete


def test_a_search_keeps_to_the_law(study_at: StudyOf) -> None:
    study = study_at(f"{BOX}\n  orientation: {{toward: [0, 0, 30], axis: [0, 0.1, 1]}}")
    assert study.workspace is not None
    space, law = study.workspace.space, study.workspace.orientations.law
    assert law is not None
    seen = []

    def demand(places: np.ndarray) -> np.ndarray:
        seen.append(places)
        return np.asarray(places[:, 0] - 0.3 * (places[:, 1] - 0.7) ** 2 + 5.0 * places[:, 4])

    start = space.places(np.array([[0.0, 0.0, 2.0]]))
    (worst,) = refine(space, demand, start)
    tried = np.concatenate(seen)
    assert tried[:, 3:] == pytest.approx(law.turns_rad(tried[:, :3])[:, 0], abs=1e-12)
    dense = space.places(np.random.default_rng(3).uniform([-2, -2, 1], [2, 2, 4], (200_000, 3)))
    assert worst.demand >= demand(dense).max() - 1e-12


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_a_free_orientation_is_as_good_as_brute_force(seed: int, study_at: StudyOf) -> None:
    rng = np.random.default_rng(seed)
    free = f"{BOX}\n  orientation_free: {{rx: [-15 deg, 15 deg], ry: [-10 deg, 20 deg]}}"
    study = study_at(free)
    assert study.workspace is not None
    law = study.workspace.orientations.law
    assert isinstance(law, BestOrientations)
    positions = rng.uniform([-2, -2, 1], [2, 2, 4], (12, 3))
    low, high = law.range_rad
    grid = np.stack(np.meshgrid(*np.linspace(low[:2], high[:2], 41).T), axis=-1).reshape(-1, 2)
    turns = np.column_stack([grid, np.zeros(len(grid))])
    places = np.hstack([np.repeat(positions, len(turns), axis=0), np.tile(turns, (12, 1))])
    sizing = size_poses(study.robot, Poses.at(places), study.material)
    brute = np.where(sizing.statics.is_solved, sizing.diameter_m, np.inf).reshape(12, -1)
    assert (law.best(positions)[1] <= brute.min(axis=1) * 1.01).all()
    nodes = study.workspace.space.places(law.rows[0])
    held = size_poses(study.robot, Poses.at(nodes), study.material)
    assert held.diameter_m.max() <= law.best(law.rows[0])[1].max() * 1.0001


@pytest.mark.slow
@pytest.mark.parametrize(("half_m", "is_held"), [(0.8, True), (2.0, False)])
def test_what_a_free_orientation_costs_between(
    half_m: float, is_held: bool, study_at: StudyOf
) -> None:
    """Near the rim few orientations leave all cables taut, and the law misses them at places."""
    box = f"region: {{box: [[-{half_m}, {half_m}], [-{half_m}, {half_m}], [1, 4]]}}"
    free = "orientation_free: {rx: [-15 deg, 15 deg], ry: [-10 deg, 20 deg]}"
    study = study_at(f"{box}\n  {free}")
    assert study.workspace is not None
    law = study.workspace.orientations.law
    assert isinstance(law, BestOrientations)
    positions = np.random.default_rng(0).uniform(
        [-half_m, -half_m, 1], [half_m, half_m, 4], (90, 3)
    )
    along = size_poses(
        study.robot, Poses.at(study.workspace.space.places(positions)), study.material
    )
    least_m = law.best(positions)[1]
    is_possible = np.isfinite(least_m)
    assert along.statics.is_solved[is_possible].all() == is_held
    if not is_held:
        assert law.excess == np.inf
        return
    assert is_possible.all()
    assert (along.diameter_m >= least_m * 0.999).all()
    assert 0.0 <= law.excess < 0.1
    assert along.diameter_m.max() < 1.1 * least_m.max()
    assert f"{law.excess:.1%} thicker" in law.words


@pytest.mark.slow
def test_a_long_list_is_free_between_some_of_its_poses(study_at: StudyOf) -> None:
    positions = np.random.default_rng(5).uniform([-2, -2, 1], [2, 2, 4], (900, 3))
    rows = "\n".join(",".join(f"{x:.3f}" for x in position) for position in positions)
    free = "poses: list.csv\n  orientation_free: {rx: [-10 deg, 10 deg]}"
    study = study_at(free, list="x_m,y_m,z_m\n" + rows)
    assert study.workspace is not None
    law = study.workspace.orientations.law
    assert isinstance(law, BestOrientations)
    assert len(law.table.positions_m) <= 256
    assert "64 others" in law.words
    assert len(np.concatenate([*study.workspace.places()])) == 900


def test_what_a_study_was_read_with_is_told(study_at: StudyOf) -> None:
    text = POSES + "0,0,2,0,0,0,"
    digests = {study_at("poses: list.csv", list=text + end).source.tables for end in ("", "\n")}
    assert {name for ((name, _),) in digests} == {"list.csv"}
    assert len(digests) == 2
    assert study_at(BOX).source.tables == ()


def test_lengths_are_asked_for_as_the_workspace_turns_the_platform(
    study_at: StudyOf, tmp_path: Path
) -> None:
    study = study_at(f"{BOX}\n  orientation: {{toward: [0, 0, 30]}}")
    assert study.workspace is not None
    (tmp_path / "asked.csv").write_text("x_m,y_m,z_m\n1,1,2\n")
    table = read_poses(tmp_path / "asked.csv", study.robot)
    law = Toward(np.array([0.0, 0.0, 30.0]))
    (place,) = poses_in(study.workspace, table).place
    assert place[3:] == pytest.approx(law.turns_rad(np.array([[1.0, 1.0, 2.0]]))[0, 0])
    several = study_at(f"{BOX}\n  orientations: [[0, 0, 0], [0, 0.1, 0]]").workspace
    assert not poses_in(several, table).place[:, 3:].any()


WRONG = [
    ("poses: list.csv", "", r"body.yaml:9: workspace.poses: .*list.csv: "),
    ("poses: list.csv\n  region: {box: [[0, 1], [0, 1], [0, 1]]}", POSES, "has region and poses"),
    (
        "samples: 100",
        "",
        r"workspace: there is nothing to serve \(expected region, poses or path\)",
    ),
    ("poses: list.csv", POSES + "0,0,2,0,0,0,lift", "poses for 'lift', which is no load case"),
    ("poses: list.csv\n  orientation: [0, 0, 1 deg]", POSES + "0,0,2,0,0,0,", "of its own"),
    ("poses: list.csv", POSES + "0,0,high,0,0,0,", r"list.csv:2: z_m: row 1 holds 'high'"),
    (f"{BOX}\n  orientation: {{table: list.csv}}", "x_m,y_m,z_m\n0,0,1", "has no orientations"),
    (
        f"{BOX}\n  orientation: {{table: list.csv}}",
        POSES + "0,0,1,0,0,0,\n0,0,1,0,0,1,",
        "two rows",
    ),
    (f"{BOX}\n  orientation: {{axis: [0, 0, 1]}}", "", "the axis has nothing to face"),
    (f"{BOX}\n  orientation: {{toward: [0, 0, 9], table: a}}", "", "toward and table"),
    (f"{BOX}\n  orientation_free: {{rx: [1 deg, 1 deg]}}", "", "is not below the upper"),
    (
        f"{BOX}\n  orientation_free: {{rx: [0, 1 deg]}}\n  orientation: [0, 0, 0]",
        "",
        "orientation and orientation_free",
    ),
    (
        "poses: list.csv\nload_cases: [{name: a, region: {points: [[0, 0, 1]]}}]",
        POSES + "0,0,2,0,0,0,a",
        r"load_cases\[0\].region: the list of workspace.poses says where",
    ),
    (
        "poses: list.csv\nload_cases: [{name: a, region: {points: [[0, 0, 1]]}}]",
        POSES + "0,0,2,0,0.1,0,",
        r"load_cases\[0\].region: the list of workspace.poses says where",
    ),
    (
        "poses: list.csv\nload_cases: [{name: a}, {name: b}]",
        POSES + "0,0,2,0,0,0,a",
        "has no pose for load case 'b'",
    ),
]


@pytest.mark.parametrize(("where", "table", "message"), WRONG)
def test_each_mistake_has_its_line(where: str, table: str, message: str, study_at: StudyOf) -> None:
    with pytest.raises(InputError) as error:
        study_at(where, **({"list": table} if table else {}))
    assert len(error.value.faults) == 1
    assert re.search(message, str(error.value))


BODY_PATH = """\
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


@pytest.fixture
def along(tmp_path: Path) -> StudyOf:
    def read(
        rows: str, path: str = "path: path.csv", more: str = "", inertia: str = KNOWN
    ) -> Study:
        (tmp_path / "path.csv").write_text(rows)
        text = BODY_PATH.replace("PATH", path).replace("MORE", more).replace("INERTIA", inertia)
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


PLATFORM_ORIENTATION = """\
robot:
  anchors: [[0, 0, 9], [9, 0, 9], [9, 9, 9], [0, 9, 9], [4, 0, 9], [4, 9, 9]]
  platform:
    mass: 100
    attachments: [[1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 1, 0], [0, 0, 0], [0, 0, 0]]
cable: {density: 7800, youngs_modulus: 200 GPa, allowable_stress: 180 MPa}
pose: {position: [4, 4, 2], %s}
"""


def about(axis: str, degrees: float) -> np.ndarray:
    return np.asarray(Rotation.from_euler(axis, degrees, degrees=True).as_matrix())


@pytest.mark.parametrize(
    ("orientation", "expected"),
    [
        ("rotation_vector: [0, 0, 90 deg]", about("z", 90)),
        ("quaternion: [1, 0, 0, 0]", np.eye(3)),
        ("quaternion: [0.70711, 0, 0, 0.70711]", about("z", 90)),
        ("quaternion: [-0.70711, 0, 0, -0.70711]", about("z", 90)),
        (
            "euler: {convention: XYZ, angles: [10 deg, 20 deg, 30 deg]}",
            about("x", 10) @ about("y", 20) @ about("z", 30),
        ),
        (
            "euler: {convention: xyz, angles: [10 deg, 20 deg, 30 deg]}",
            about("z", 30) @ about("y", 20) @ about("x", 10),
        ),
        (
            "euler: {convention: ZXZ, angles: [0.1, 0.2, 0.3]}",
            about("z", np.degrees(0.1)) @ about("x", np.degrees(0.2)) @ about("z", np.degrees(0.3)),
        ),
    ],
)
def test_forms(study_of: Callable[[str], Study], orientation: str, expected: np.ndarray) -> None:
    pose = study_of(PLATFORM_ORIENTATION % orientation).pose
    assert pose is not None
    np.testing.assert_allclose(pose.rotation, expected, atol=1e-14)


@pytest.mark.parametrize(
    ("orientation", "field", "problem", "expected"),
    [
        ("quaternion: [1, 0, 0]", "pose.quaternion", "has 3 values", "[w, x, y, z]"),
        ("quaternion: [1, 1, 0, 0]", "pose.quaternion", "has length 1.41421", "length 1"),
        ("quaternion: [0, 0, 0, 0]", "pose.quaternion", "has length 0", "length 1"),
        ("quaternion: [1, 0, 0, up]", "pose.quaternion[3]", "'up' is not a number", "number"),
        ("euler: {convention: XYZ}", "pose.euler.angles", "is missing", "three angles"),
        ("euler: {angles: [0, 0, 0]}", "pose.euler.convention", "is missing", "XYZ"),
        ("euler: {convention: XYZ, angles: [1, 2]}", "pose.euler.angles", "has 2 values", "angles"),
        (
            "euler: {convention: XYZ, angles: [1, 2, 3 m]}",
            "pose.euler.angles[2]",
            "the unit meter",
            "an angle",
        ),
        *(
            (
                f"euler: {{convention: {axes}, angles: [0, 0, 0]}}",
                "pose.euler.convention",
                "is no order of axes",
                "turn with the body",
            )
            for axes in ("XYy", "XXZ", "roll", "XY", "5", "[X, Y, Z]")
        ),
        ("euler: [1, 2, 3]", "pose.euler", "a list is not a mapping", "convention, angles"),
        (
            "quaternion: [1, 0, 0, 0], rotation_vector: [0, 0, 0]",
            "pose",
            "has rotation_vector and quaternion",
            "one of",
        ),
        ("quaternoin: [1, 0, 0, 0]", "pose.quaternoin", "unknown field", "'quaternion'?"),
    ],
)
def test_orientation_mistakes(
    faults_of: Callable[[str], list[Fault]],
    orientation: str,
    field: str,
    problem: str,
    expected: str,
) -> None:
    faults = faults_of(PLATFORM_ORIENTATION % orientation)
    assert len(faults) == 1, faults
    assert faults[0].line == 7
    assert faults[0].field == field
    assert problem in faults[0].problem
    assert expected in faults[0].expected


@pytest.mark.parametrize(
    ("orientation", "field"),
    [
        ("quaternion: [0, 1, 0, 0]", "pose.quaternion"),
        ("euler: {convention: XYZ, angles: [0, 0, 1]}", "pose.euler.angles"),
    ],
)
def test_a_point_mass_does_not_turn(
    valid: str, faults_of: Callable[[str], list[Fault]], orientation: str, field: str
) -> None:
    text = valid.replace("[15, 9, 4]", f"{{position: [15, 9, 4], {orientation}}}")
    (fault,) = faults_of(text)
    assert fault.field == field
    assert "has no meaning for a point mass" in fault.problem


def test_a_point_mass_may_say_that_it_does_not_turn(
    valid: str, study_of: Callable[[str], Study]
) -> None:
    text = valid.replace("[15, 9, 4]", "{position: [15, 9, 4], quaternion: [1, 0, 0, 0]}")
    assert study_of(text).pose is not None


BODY_ORIENTATIONS = """\
robot:
  anchors: [[0, 0, 9], [9, 0, 9], [9, 9, 9], [0, 9, 9], [4, 0, 9], [4, 9, 9], [9, 4, 9]]
  platform:
    mass: 100
    attachments: [[1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 1, 0], [0, 0, 0], [0, 0, 0], [1, 0, 1]]
    wrench: {force: [1 kN, 0, -50 N], moment: [0, 0, 2 N*m]}
  gravity: [0, 3, -4]
  tension_min: 0.2 kN
cable: {density: 7800, youngs_modulus: 200 GPa, allowable_stress: 180 MPa}
workspace:
  region: {box: [[3, 6], [3, 6], [1, 5]]}
"""
PLANAR = """\
robot:
  planar: true
  anchors: [[0, 0, 9], [3, 4, 9]]
  platform: {mass: 100}
cable: {density: 7800, youngs_modulus: 200 GPa, allowable_stress: 180 MPa}
workspace:
  region: {rectangle: anchors, inset: 1, z: [1, 5]}
"""


def workspace_of(study: Study) -> Workspace:
    assert study.workspace is not None
    return study.workspace


def test_loads(study_of: Callable[[str], Study]) -> None:
    robot = study_of(BODY_ORIENTATIONS).robot
    np.testing.assert_array_equal(robot.platform.wrench_N, [1000, 0, -50, 0, 0, 2])
    np.testing.assert_array_equal(robot.gravity_direction, [0, 3, -4])
    assert robot.tension_min_N == 200.0
    assert not robot.is_upright
    np.testing.assert_allclose(robot.upright @ [0, 0.6, -0.8], [0, 0, -1], atol=1e-15)


@pytest.mark.parametrize(
    ("text", "turns"),
    [
        ("", [[0, 0, 0]]),
        ("orientation: [0, 0, 90 deg]", [[0, 0, np.pi / 2]]),
        ("orientation: {quaternion: [0, 1, 0, 0]}", [[np.pi, 0, 0]]),
        ("orientation: {euler: {convention: XYZ, angles: [0, 0.1, 0]}}", [[0, 0.1, 0]]),
        (
            "orientations: [[0, 0, 0], {rotation_vector: [0, 0.2, 0]}]",
            [[0, 0, 0], [0, 0.2, 0]],
        ),
    ],
)
def test_orientations(study_of: Callable[[str], Study], text: str, turns: list) -> None:
    orientations = workspace_of(study_of(f"{BODY_ORIENTATIONS}  {text}\n")).orientations
    np.testing.assert_allclose(orientations.turns_rad, turns, atol=1e-15)
    assert orientations.range_rad is None


def test_orientation_range(study_of: Callable[[str], Study]) -> None:
    text = f"{BODY_ORIENTATIONS}  orientation_range: {{rx: [-10 deg, 10 deg], rz: [0, 0.3]}}\n"
    orientations = workspace_of(study_of(text)).orientations
    assert orientations.count == 5 + FILLING
    limit = np.radians(10.0)
    np.testing.assert_allclose(orientations.range_rad, [[-limit, 0, 0], [limit, 0, 0.3]])


def test_a_list_of_orientations_stands_in_the_table_of_inputs(
    study_of: Callable[[str], Study],
) -> None:
    study = study_of(f"{BODY_ORIENTATIONS}  orientations: [[0, 0, 0], [0, 10 deg, 0]]\n")
    entry = next(e for e in study.source.entries if e.field == "workspace.orientations[1]")
    assert entry.given == "[0, 10 deg, 0]"
    assert entry.value_SI == "[0, 0.174533, 0] rad"


def test_planar(study_of: Callable[[str], Study]) -> None:
    study = study_of(PLANAR)
    assert study.robot.is_planar
    assert study.robot.degrees_of_freedom == study.robot.n_cables == 2
    region = workspace_of(study).region
    assert isinstance(region, Rectangle)
    np.testing.assert_allclose(region.size_m, [3.0, 4.0])
    np.testing.assert_allclose(sorted(region.ends_m[:, 0]), [0.6, 2.4])


def test_an_empty_range_is_no_range(faults_of: Callable[[str], list[Fault]]) -> None:
    (fault,) = faults_of(f"{BODY_ORIENTATIONS}  orientation_range: {{}}\n")
    assert (fault.field, fault.problem) == ("workspace.orientation_range", "the range is empty")


def test_a_rectangle_over_one_point(faults_of: Callable[[str], list[Fault]]) -> None:
    faults = faults_of(PLANAR.replace("anchors, inset: 1", "[[1.5, 2], [1.5, 2]]"))
    (fault,) = [one for one in faults if one.field == "workspace.region.rectangle"]
    assert fault.problem == "begins and ends at one point"


PLATFORM_CLEARANCE = """\
robot:
  anchors: [[0, 0, 9], [9, 0, 9], [9, 9, 9], [0, 9, 9], [4, 0, 9], [4, 9, 9]]
  platform:
    mass: 100
    attachments: [[1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 1, 0], [0, 0, 0], [0, 0, 0]]
    hull: %s
cable: {density: 7800, youngs_modulus: 200 GPa, allowable_stress: 180 MPa}
workspace: {region: {box: [[3, 4], [3, 4], [1, 2]]}, clearance: %s}
"""


def test_hull_and_clearance(study_of: Callable[[str], Study]) -> None:
    study = study_of(PLATFORM_CLEARANCE % ("[[0, 1 m], [0, 1], [-50 cm, 0]]", "100 mm"))
    hull = study.robot.platform.hull_m
    assert hull is not None
    assert hull.shape == (8, 3)
    np.testing.assert_array_equal(hull.min(axis=0), [0, 0, -0.5])
    np.testing.assert_array_equal(hull.max(axis=0), [1, 1, 0])
    assert study.workspace is not None
    assert study.workspace.clearance_m == pytest.approx(0.1)


@pytest.mark.parametrize(
    ("hull", "clearance", "field", "problem"),
    [
        ("[[0, 1], [0, 1]]", "0.1", "robot.platform.hull", "has 2 values"),
        ("[[-9, 9], [0, 1], [0, 1]]", "0.1", "robot.platform.hull", "18.1 m from corner to"),
        ("[[0, 1], [0, 1], [1, 0]]", "0.1", "robot.platform.hull[2]", "is not below the upper"),
        ("[[0, 1], [0, 1], [0, 1]]", "0", "workspace.clearance", "0 is out of range"),
        ("[[0, 1], [0, 1], [0, 1]]", "2 kg", "workspace.clearance", "has the unit kilogram"),
    ],
)
def test_clearance_mistakes(
    faults_of: Callable[[str], list[Fault]], hull: str, clearance: str, field: str, problem: str
) -> None:
    (fault,) = faults_of(PLATFORM_CLEARANCE % (hull, clearance))
    assert fault.field == field
    assert problem in fault.problem


def test_a_point_mass_has_no_hull(valid: str, faults_of: Callable[[str], list[Fault]]) -> None:
    text = valid.replace("mass: 180 kg", "mass: 180 kg\n    hull: [[0, 1], [0, 1], [0, 1]]")
    (fault,) = faults_of(text)
    assert fault.field == "robot.platform.hull"


STUDY = """\
robot:
  anchors: [[0, 0, 9], [9, 0, 9], [9, 9, 9], [0, 9, 9]]
  platform: {mass: 100}
cable: {density: 7800, youngs_modulus: 200 GPa, allowable_stress: 180 MPa}
workspace: {region: {box: [[3, 4], [3, 4], [1, 2]]}%s}
"""
ROPES = "selection: {grades: all}\n"


@pytest.mark.parametrize(
    ("given", "limit"),
    [("", 0.2), (", sag: 20 %", 0.2), (", sag: 0.05", 0.05), (", sag: 50 %", 0.5)],
)
def test_sag_limits_products_and_the_family(
    study_of: Callable[[str], Study], given: str, limit: float
) -> None:
    for selection in ("", ROPES):
        study = study_of(STUDY % given + selection)
        assert study.workspace is not None
        assert study.workspace.sag_max == as_built_by(study).robot.sag_max == limit


@pytest.mark.parametrize(
    ("given", "problem"),
    [("0", "out of range"), ("51 %", "out of range"), ("2 m", "has the unit"), ("none", "is not")],
)
def test_what_is_no_sag_is_refused(
    faults_of: Callable[[str], list[Fault]], given: str, problem: str
) -> None:
    (fault,) = faults_of(STUDY % f", sag: {given}")
    assert fault.field == "workspace.sag"
    assert problem in fault.problem


def _read(folder: Path, line: str) -> float:
    text = example_file("yard").read_text(encoding="utf-8")
    file = folder / "yard.yaml"
    file.write_text(text.replace("workspace:\n", f"workspace:\n{line}"), encoding="utf-8")
    workspace = read_study(file).workspace
    assert workspace is not None
    return workspace.proof_s


@pytest.mark.parametrize(("line", "time_s"), [("  proof: 0 s\n", 0.0), ("  proof: 2 min\n", 120.0)])
def test_the_time_is_read(tmp_path: Path, line: str, time_s: float) -> None:
    assert _read(tmp_path, line) == time_s


@pytest.mark.parametrize(
    ("given", "problem"),
    [("-1 s", "'-1 s' is out of range (expected at least 0 s"), ("5 m", "5 m"), ("soon", "soon")],
)
def test_what_is_no_time_is_refused(tmp_path: Path, given: str, problem: str) -> None:
    with pytest.raises(InputError, match=r"workspace\.proof") as caught:
        _read(tmp_path, f"  proof: {given}\n")
    assert problem in str(caught.value)
