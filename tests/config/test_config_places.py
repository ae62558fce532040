"""Lists of poses, and orientations that follow the position."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from designer.errors import InputError
from designer.io.config import read_study
from designer.io.poses import poses_in, read_poses
from designer.model.robot import Poses
from designer.model.space import ListedOrientations, OrientationTable, Toward
from designer.sizing.newton import size_poses
from designer.study import Study
from designer.workspace.best_orientations import BestOrientations
from designer.workspace.refine import refine

BODY = """\
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
def study_of(tmp_path: Path) -> StudyOf:
    def read(where: str, **files: str) -> Study:
        for name, text in files.items():
            (tmp_path / f"{name}.csv").write_text(text)
        path = tmp_path / "body.yaml"
        path.write_text(BODY.replace("WHERE", where))
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


def test_a_list_is_all_that_is_asked_for(study_of: StudyOf) -> None:
    rows = ["0,0,2,0,0,0,", "1,0,2,0.1,0,0,lift", "1,0,2,-0.1,0,0,", "-1,1,3,0,0.2,0,wind"]
    cases = "\nload_cases: [{name: lift, mass: 200}, {name: wind, mass: 90}]"
    study = study_of(f"poses: list.csv{cases}", list=POSES + "\n".join(rows))
    assert study.workspace is not None
    want = {tuple(np.array(row.split(",")[:6], float)) for row in rows}
    assert {tuple(place) for place in np.concatenate([*study.workspace.places()])} == want
    of_lift = study.workspace.of_case(study.load_cases[0])
    assert {tuple(place) for place in np.concatenate([*of_lift.places()])} == {
        tuple(np.array(row.split(",")[:6], float)) for row in rows[:3]
    }
    assert study.workspace.space.is_discrete


def test_a_search_keeps_to_the_law(study_of: StudyOf) -> None:
    study = study_of(f"{BOX}\n  orientation: {{toward: [0, 0, 30], axis: [0, 0.1, 1]}}")
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
def test_a_free_orientation_is_as_good_as_brute_force(seed: int, study_of: StudyOf) -> None:
    rng = np.random.default_rng(seed)
    free = f"{BOX}\n  orientation_free: {{rx: [-15 deg, 15 deg], ry: [-10 deg, 20 deg]}}"
    study = study_of(free)
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
    half_m: float, is_held: bool, study_of: StudyOf
) -> None:
    """Near the rim few orientations leave all cables taut, and the law misses them at places."""
    box = f"region: {{box: [[-{half_m}, {half_m}], [-{half_m}, {half_m}], [1, 4]]}}"
    free = "orientation_free: {rx: [-15 deg, 15 deg], ry: [-10 deg, 20 deg]}"
    study = study_of(f"{box}\n  {free}")
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
def test_a_long_list_is_free_between_some_of_its_poses(study_of: StudyOf) -> None:
    positions = np.random.default_rng(5).uniform([-2, -2, 1], [2, 2, 4], (900, 3))
    rows = "\n".join(",".join(f"{x:.3f}" for x in position) for position in positions)
    free = "poses: list.csv\n  orientation_free: {rx: [-10 deg, 10 deg]}"
    study = study_of(free, list="x_m,y_m,z_m\n" + rows)
    assert study.workspace is not None
    law = study.workspace.orientations.law
    assert isinstance(law, BestOrientations)
    assert len(law.table.positions_m) <= 256
    assert "at 64 others" in law.words
    assert len(np.concatenate([*study.workspace.places()])) == 900


def test_what_a_study_was_read_with_is_told(study_of: StudyOf) -> None:
    text = POSES + "0,0,2,0,0,0,"
    digests = {study_of("poses: list.csv", list=text + end).source.tables for end in ("", "\n")}
    assert {name for ((name, _),) in digests} == {"list.csv"}
    assert len(digests) == 2
    assert study_of(BOX).source.tables == ()


def test_lengths_are_asked_for_as_the_workspace_turns_the_platform(
    study_of: StudyOf, tmp_path: Path
) -> None:
    study = study_of(f"{BOX}\n  orientation: {{toward: [0, 0, 30]}}")
    assert study.workspace is not None
    (tmp_path / "asked.csv").write_text("x_m,y_m,z_m\n1,1,2\n")
    table = read_poses(tmp_path / "asked.csv", study.robot)
    law = Toward(np.array([0.0, 0.0, 30.0]))
    (place,) = poses_in(study.workspace, table).place
    assert place[3:] == pytest.approx(law.turns_rad(np.array([[1.0, 1.0, 2.0]]))[0, 0])
    several = study_of(f"{BOX}\n  orientations: [[0, 0, 0], [0, 0.1, 0]]").workspace
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
def test_each_mistake_has_its_line(where: str, table: str, message: str, study_of: StudyOf) -> None:
    with pytest.raises(InputError) as error:
        study_of(where, **({"list": table} if table else {}))
    assert len(error.value.faults) == 1
    assert re.search(message, str(error.value))
