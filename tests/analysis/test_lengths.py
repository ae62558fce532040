"""`designer lengths`: from a table of poses to lengths and tensions with the chosen rope."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import numpy as np
import pytest
from test_cli import STUDY, WORKSPACE, designer

import designer as door
from designer.analysis.analyse import Analysis
from designer.analysis.lengths import FoundPoses, lengths_of, poses_of
from designer.errors import InputError
from designer.io.poses import read_poses
from designer.model.cable import Material
from designer.model.robot import Poses
from designer.selection.assignment import DesignCable
from designer.statics.fixed_length import cables_of_length

__all__ = ["designer"]

POSES = "x_m,y_m,z_m,time_s\n250,200,-100,0\n240,100,-70,1.5\n250,150,-65,\n"


def study(tmp_path: Path, text: str = STUDY + WORKSPACE) -> Path:
    path = tmp_path / "crane.yaml"
    path.write_text(text)
    return path


def poses(tmp_path: Path, text: str = POSES) -> Path:
    path = tmp_path / "poses.csv"
    path.write_text(text)
    return path


@pytest.mark.slow
def test_the_chosen_rope_at_each_pose(tmp_path, designer) -> None:
    found = designer("lengths", str(study(tmp_path)), "--poses", str(poses(tmp_path)))
    assert found.status == 0, found.err
    rows = list(csv.DictReader(io.StringIO((tmp_path / "crane-lengths.csv").read_text())))
    assert [row["time_s"] for row in rows] == ["0.0", "1.5", ""]
    assert {row["verdict"] for row in rows} == {"solved"}
    analysis = door.analyse(door.read_study(study(tmp_path)))
    assert analysis.selection is not None
    assert analysis.selection.chosen is not None
    assert analysis.selection.chosen.size.id in found.out
    # Forces and stretched arcs close: eq. (7) of the paper by plain quadrature.
    rope, exits = analysis.selection.chosen.cable, analysis.study.robot.exit_points_m
    lengths = lengths_of(analysis, read_poses(poses(tmp_path), analysis.study.robot).poses)
    assert lengths is not None
    for row, place, statics in zip(rows, ([250, 200, -100], [240, 100, -70], [250, 150, -65]),
                                   range(3), strict=True):  # fmt: skip
        for k in range(3):
            length = float(row[f"length_{k + 1}_m"])
            force_x, force_z = (
                getattr(lengths.statics, name)[statics, k] for name in ("force_x_N", "force_z_N")
            )
            s = np.linspace(0.0, length, 200_001)
            pull_z = force_z + rope.weight_N_per_m * (s - length)
            tension = np.hypot(force_x, pull_z)
            stretch = 1.0 + tension / rope.axial_stiffness_N
            run = np.trapezoid(force_x / tension * stretch, s)
            plan = np.asarray(place[:2]) - exits[k][:2]
            assert run == pytest.approx(np.linalg.norm(plan), rel=1e-8)
            assert float(row[f"tension_{k + 1}_N"]) == pytest.approx(tension[0], rel=1e-8)


@pytest.mark.slow
def test_at_the_worst_pose_it_is_the_reports_tension(tmp_path) -> None:
    analysis = door.analyse(door.read_study(study(tmp_path)))
    assert analysis.selection is not None
    assert analysis.selection.chosen is not None
    met = analysis.selection.chosen.verification
    lengths = lengths_of(analysis, door.Poses.at(met.worst_place[None]))
    assert lengths is not None
    assert lengths.statics.cable_tension_N.max() == pytest.approx(met.max_tension_N, rel=1e-9)
    assert lengths.utilisation.max() == pytest.approx(met.utilisation, rel=1e-9)
    assert (lengths.statics.length_m[0] <= met.longest_m * (1 + 1e-9)).all()


@pytest.mark.slow
def test_a_pose_that_is_not_held_is_a_negative_answer(tmp_path, designer) -> None:
    file = poses(tmp_path, "x_m,y_m,z_m\n250,200,-100\n250,-5,-100\n")
    found = designer("lengths", str(study(tmp_path)), "--poses", str(file), "-o", "out.csv")
    assert found.status == 1
    assert "1 of 2 poses not held, see the verdict: row 2" in found.out
    assert "1 of 2 poses outside the region that the study asks for: row 2" in found.out
    assert (tmp_path / "out.csv").read_text().splitlines()[
        2
    ] == "250.0,-5.0,-100.0,,,,,,,outside_hull"


def test_without_a_workspace_the_pose_sizes_the_cable(tmp_path, designer) -> None:
    file = poses(tmp_path, "x_m,y_m,z_m\n250,200,-50\n250,200,-40\n")
    found = designer("lengths", str(study(tmp_path, STUDY)), "--poses", str(file))
    assert found.status == 1
    assert "of the configured family" in found.out
    assert "1 of 2 poses beyond the allowable tension" in found.out
    assert ": row 2" in found.out


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("x_m,y_m\n1,2\n", ":1: z_m: there is no such column"),
        ("x_m,y_m,z_m\n", ":1: there is no pose"),
        ("x_m,y_m,z_m\n1,2,high\n", ":2: z_m: row 1 holds 'high'"),
        ("x_m,y_m,z_m\n1,2,\n", ":2: z_m: row 1 holds nothing"),
        ("x_m,y_m,z_m\n1,2,inf\n", ":2: z_m: row 1 holds inf"),
        ("x_m,y_m,z_m\n1,2,1e9\n", ":2: z_m: row 1 holds 1e+09"),
        ("x_m,y_m,z_m\n1,2,3,4\n", ":2: row 1 has 4 values"),
        ("x_m,y_m,z_m,rx_rad\n1,2,3,0\n", ":1: ry_rad: there is no such column"),
        ("x_m,y_m,z_m,rx_rad,ry_rad,rz_rad\n1,2,3,0,0,0.1\n", ":2: rx_rad: row 1 turns a point"),
        ("x_m;y_m;z_m\nmm;m;m\n1;2;3\n", ":2: x_m: the row of units says 'mm'"),
    ],
)
def test_faulty_tables(tmp_path, designer, text, line) -> None:
    file = poses(tmp_path, text)
    found = designer("lengths", str(study(tmp_path)), "--poses", str(file))
    assert found.status == 2
    assert f"{file}{line}" in found.err
    assert not (tmp_path / "crane-lengths.csv").exists()


def test_a_table_that_is_not_there(tmp_path, designer) -> None:
    found = designer("lengths", str(study(tmp_path)), "--poses", "nowhere.csv")
    assert (found.status, found.out) == (2, "")
    assert "nowhere.csv: no such file or directory" in found.err


def test_a_planar_robot_stays_in_its_plane(tmp_path) -> None:
    robot = door.read_study(door.example_file("facade")).robot
    middle = robot.exit_points_m.mean(axis=0)
    across = robot.upright[1]
    good, off = middle, middle + 0.1 * across
    axis = 0.1 * across
    rows = [[*good, *axis], [*off, 0, 0, 0], [*good, *(0.1 * robot.upright[0])]]
    text = "x_m,y_m,z_m,rx_rad,ry_rad,rz_rad\n" + "\n".join(",".join(map(str, r)) for r in rows)
    with pytest.raises(InputError) as caught:
        read_poses(poses(tmp_path, text), robot)
    first, second = str(caught.value).splitlines()
    assert ":3: x_m: row 2 leaves the plane of the robot by 0.1 m" in first
    assert ":4: rx_rad: row 3 turns the platform out of its plane" in second


@pytest.mark.slow
def test_load_cases_are_said_to_be_left_out(tmp_path, designer) -> None:
    cases = "load_cases: [{name: hoisting, dynamic_factor: 1.1}]\n"
    text = STUDY + WORKSPACE.replace("samples: 300", "samples: 50") + cases
    found = designer("lengths", str(study(tmp_path, text)), "--poses", str(poses(tmp_path)))
    assert found.status == 0, found.err
    assert "at rest, without the load cases" in found.out
    assert (
        "without the load cases"
        not in designer("lengths", str(study(tmp_path)), "--poses", str(poses(tmp_path))).out
    )


@pytest.mark.slow
def test_effects_that_are_not_in_the_lengths_are_named(tmp_path, designer) -> None:
    effects = (
        "effects:\n"
        "  winch_scale: {cable: 2, scale: 2.0}\n"
        "  pose_shift: {z_m: 0.1}\n"
        "  elastic_modulus: {scale: 0.9}\n"
    )
    found = designer(
        "lengths",
        str(study(tmp_path, STUDY + WORKSPACE + effects)),
        "--poses",
        str(poses(tmp_path)),
    )
    told = " ".join(found.out.split())
    assert "winch_scale of cable 2" in told
    assert "pose_shift" in told
    assert "elastic_modulus" not in told
    assert "do not reach a design, and are not in them" in told


PATH = "time_s,x_m,y_m,z_m\n0,250,200,-100\n60,240,180,-90\n"
ALONG = "workspace: {path: path.csv}\nselection: {}\n"


@pytest.mark.slow
def test_set_points_along_the_path_of_the_study(tmp_path, designer) -> None:
    (tmp_path / "path.csv").write_text(PATH)
    file = study(tmp_path, STUDY + ALONG)
    found = designer("lengths", str(file))
    assert found.status == 0, found.err
    rows = list(csv.DictReader(io.StringIO((tmp_path / "crane-lengths.csv").read_text())))
    analysis = door.analyse(door.read_study(file))
    assert analysis.path is not None
    (case,) = analysis.path.cases
    assert [float(row["time_s"]) for row in rows] == case.motion.time_s.tolist()
    lengths = np.array([[float(row[f"length_{k}_m"]) for k in (1, 2, 3)] for row in rows])
    assert lengths == pytest.approx(case.statics.length_m)
    # Poses of a file are taken at rest, also where the path has one.
    at_rest = lengths_of(analysis, door.Poses.at(case.motion.positions_m))
    assert at_rest is not None
    tension, moving = at_rest.statics.exit_tension_N, case.tension_N
    assert np.abs(tension / moving - 1.0).max() > 1e-4


def test_without_poses_and_path(tmp_path, designer) -> None:
    found = designer("lengths", str(study(tmp_path)))
    assert found.status == 2
    assert "--poses: is missing, and the study has no workspace.path" in found.err


FRAME = """
robot:
  anchors: [[0, 0, 8], [0, 0, 8], [10, 0, 8], [10, 0, 8], [5, 9, 8], [5, 9, 8]]
  platform:
    mass: 200 kg
    attachments: [[-1, 0.6, 0], [-0.6, -1, 0], [0.6, -1, 0], [1, 0.6, 0], [0.4, 1, 0], [-0.4, 1, 0]]
cable: {grade: unirope-6x36-iwrc-1960, safety_factor: 5}
pose: [5, 3, 2]
"""


def test_lengths_lead_back_to_the_pose(tmp_path, designer) -> None:
    config = str(study(tmp_path, FRAME))
    table = poses(tmp_path, "x_m,y_m,z_m,point\n5,3,2,1\n5.1,3.1,1.8,2\n")
    designer("lengths", config, "--poses", str(table), "-o", "winches.csv")
    outcome = designer("pose", config, "--lengths", "winches.csv")
    rows = list(csv.DictReader(io.StringIO((tmp_path / "crane-poses.csv").read_text())))
    for point, place in (("1.0", [5, 3, 2, 0, 0, 0]), ("2.0", [5.1, 3.1, 1.8, 0, 0, 0])):
        same = [row for row in rows if row["point"] == point]
        assert [row["solution"] for row in same] == [str(k + 1) for k in range(len(same))]
        names = "x_m", "y_m", "z_m", "rx_rad", "ry_rad", "rz_rad"
        offsets = [
            np.abs([float(row[name]) for name in names] - np.array(place)).max() for row in same
        ]
        assert min(offsets) < 1e-6
        assert same[int(np.argmin(offsets))]["is_stable"] == "true"
    states = [row["is_stable"] for row in rows]
    assert "false" in states  # between two places to rest there is one where it does not stay
    assert outcome.status == 1
    assert "have several stable poses" in outcome.out


def test_found_poses_are_equilibria(tmp_path) -> None:
    """Catenaries of the given lengths, built anew at each pose, hold the platform."""
    given = door.read_study(study(tmp_path, FRAME))
    analysis = Analysis.begin(given)
    there = lengths_of(analysis, Poses.at([[5.0, 3.0, 2.0]]))
    assert there is not None
    found = poses_of(analysis, there.statics.length_m)
    assert found is not None
    cable, ones = found.cable.cable, np.ones((len(found.row), 1))
    length_m = np.repeat(there.statics.length_m, len(found.row), axis=0)
    statics = cables_of_length(
        given.robot, Poses.at(found.place), length_m,
        cable.axial_stiffness_N * ones, cable.weight_N_per_m * ones,
    )  # fmt: skip
    left = np.abs(statics.equilibrium_residual_N()).max(axis=1)
    assert (left < 1e-5 * statics.largest_tension_N).all()
    gaps = found.place[:, None] - found.place[None]
    assert (np.abs(gaps).max(axis=-1) > 1e-4).sum() == len(gaps) * (len(gaps) - 1)


def test_rows_without_a_pose_stand_in_the_table() -> None:
    nothing = np.empty(0)
    found = FoundPoses(
        DesignCable(Material(7800.0, 200e9, 180e6).cable(0.01), "10 mm"), 1,
        nothing.astype(int), np.empty((0, 6)), np.empty((0, 3)), nothing > 0, nothing > 0,
    )  # fmt: skip
    head, row = found.to_csv(("length_1_m",), np.array([[3.0]])).splitlines()
    assert row == "3.0" + "," * 10 + ",0"
    assert head.endswith(",tension_3_N,is_stable,solution")


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("length_1_m,length_2_m\n3,4\n", "length_3_m: there is no such column"),
        ("length_1_m,length_2_m,length_3_m\n3,4,\n", "w.csv:2: length_3_m: row 1 holds nothing"),
        ("length_1_m,length_2_m,length_3_m\n3,-4,5\n", "w.csv:2: length_2_m: row 1 holds -4"),
        ("length_1_m,length_2_m,length_3_m,length_4_m\n3,4,5,6\n", "length_4_m: is of no cable"),
        ("length_1_m,length_2_m,length_3_m\n", "there is no row"),
        (None, "--lengths: w.csv: "),
    ],
)
def test_wrong_lengths_are_refused(tmp_path, designer, text: str | None, fault: str) -> None:
    if text is not None:
        (tmp_path / "w.csv").write_text(text)
    outcome = designer("pose", str(study(tmp_path)), "--lengths", "w.csv")
    assert outcome.status == 2
    assert fault in outcome.err
    assert not (tmp_path / "crane-poses.csv").exists()
