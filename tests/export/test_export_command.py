"""`designer export`: whole files or none, refusals in one line; what a file lacks is named."""

from __future__ import annotations

import csv
import io
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from test_cli import STUDY, WORKSPACE, designer

from designer.cli.export import Target
from designer.exports.caspr import to_caspr
from designer.exports.formats import FORMATS
from designer.exports.gltf import to_gltf
from designer.exports.moordyn import to_moordyn
from designer.exports.mujoco import to_mujoco
from designer.exports.robot import ExportedRobot, inertia_of, lost_by_all
from designer.io.config import read_study
from designer.model.cable import Attached, Material
from designer.model.load_case import LoadCase
from designer.model.point_list import PointList
from designer.model.prism import Prism
from designer.model.robot import Platform, Poses, Robot
from designer.model.winches import Winches
from designer.model.workspace import Workspace
from designer.study import Study

__all__ = ["designer"]

DRUM = (
    "  winches: {drum_diameter: 600 mm, layers: 3, positions: [[0, 0, -9], [500, 0, -9], "
    "[250, 433.01, -9]], drum: {length: 900 mm, groove_pitch: 40 mm, dead_turns: 2}}\n"
)


def test_the_command_offers_every_format() -> None:
    assert {target.value for target in Target} == FORMATS.keys()


def test_files_appear_where_they_are_asked_for(designer, tmp_path) -> None:
    Path("crane.yaml").write_text(STUDY)
    told = designer("export", "crane.yaml", "--to", "caspr")
    assert (told.status, told.out.split()[::2]) == (0, ["crane_bodies.xml", "crane_cables.xml"])
    assert "Not in it: mass, sag and stretch" in told.err
    named = tmp_path / "new" / "a_bodies.xml"
    assert designer("export", "crane.yaml", "--to", "caspr", "-o", str(named)).status == 0
    assert sorted(file.name for file in named.parent.iterdir()) == ["a_bodies.xml", "a_cables.xml"]
    assert named.read_bytes() == Path("crane_bodies.xml").read_bytes()
    back = designer("import", str(named), "--grade", "unirope-7x19-galvanised", "-o", "b.yaml")
    assert (back.status, back.err) == (0, "")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--to", "caspr", "-o", "a.xml"), "ends in _bodies.xml"),
        (("--to", "csv"), "selection: is missing"),
        (("--to", "dxf"), "dxf"),
        ((), "--to"),
    ],
)
def test_wrong_input_writes_nothing(designer, arguments, words: str) -> None:
    Path("crane.yaml").write_text(STUDY)
    told = designer("export", "crane.yaml", *arguments)
    assert told.status == 2
    assert words in told.err
    assert [file.name for file in Path().iterdir()] == ["crane.yaml"]


@pytest.mark.slow
def test_no_cable_is_a_negative_answer(designer) -> None:
    Path("crane.yaml").write_text(STUDY.replace("[250, 200, -50]", "[-10, 0, -50]"))
    assert ExportedRobot.of(read_study(Path("crane.yaml"))).design is None


@pytest.mark.slow
def test_rows_for_the_workshop(designer) -> None:
    text = (STUDY + WORKSPACE).replace("robot:\n", f"robot:\n{DRUM}")
    Path("crane.yaml").write_text(text)
    told = designer("export", "crane.yaml", "--to", "csv")
    assert told.status == 0, told.err
    rows = list(csv.DictReader(io.StringIO(Path("crane.csv").read_text())))
    assert [row["cable"] for row in rows] == ["1", "2", "3"]
    for row in rows:
        number = {key: float(row[key]) for key in row if key.endswith(("_m", "_N")) and row[key]}
        turn_m = math.hypot(math.pi * (0.6 + number["rope_diameter_m"]), 0.04)
        least_m = number["longest_unstrained_m"] + 2 * turn_m
        assert least_m <= number["length_to_cut_m"] < least_m + 0.1 + 1e-9
        assert "2 dead turns" in row["length_to_cut_rule"]
        assert number["winch_to_exit_point_m"] == pytest.approx(9.0)
        assert (row["terminations"], row["termination_efficiency"]) == ("2", "1.0")
        assert (number["drum_diameter_m"], row["drum_is_from"]) == (0.6, "study")
        for pose in ("reference", "worst"):
            length_m = number[f"{pose}_unstrained_length_m"]
            ends = [number[f"{pose}_{axis}_m"] - number[f"exit_{axis}_m"] for axis in "xyz"]
            chord_m = math.hypot(*ends)
            assert 0.99 < length_m / chord_m < 1.2
            shortest_m, longest_m = number["shortest_unstrained_m"], number["longest_unstrained_m"]
            if pose == "worst":
                assert shortest_m - 1e-6 <= length_m <= longest_m + 1e-6
        # The ends of a cable differ by its weight times the height between them, and by its sag.
        drop_m = number["exit_z_m"] - number["reference_z_m"]
        weight_N_per_m = 9.81 * float(row["linear_density_kg_per_m"])
        difference_N = number["reference_exit_tension_N"] - number["reference_platform_tension_N"]
        assert difference_N == pytest.approx(weight_N_per_m * drop_m, rel=0.01)
        assert row["remarks"].startswith("small crane, exported by cdpr-designer")


ANCHORS = np.array([[0.0, 0.0, 9.0], [12.0, 0.0, 9.0], [6.0, 9.0, 9.0]])
CRANE = Robot(ANCHORS, Platform(300.0))
BOX = Prism.box((5.0, 7.0), (2.0, 4.0), (1.0, 5.0))
ASKING = Workspace(BOX, clearance_m=0.1, floor_m=0.0)
WINCHES = Winches(positions_m=ANCHORS, efficiency=0.9)
CRANE_STUDY = Study(
    "crane",
    CRANE,
    Material(5290.0, 62.7e9, 198e6),
    pose=Poses.at([6.0, 3.0, 3.0]),
    workspace=Workspace(BOX),
)


def test_a_plain_study_loses_nothing_for_all() -> None:
    assert lost_by_all(CRANE_STUDY) == []


@pytest.mark.parametrize(
    ("study", "words"),
    [
        (replace(CRANE_STUDY, load_cases=(LoadCase("gale"),)), "load cases (gale)"),
        (replace(CRANE_STUDY, workspace=ASKING), "clearance, floor"),
        (replace(CRANE_STUDY, workspace=Workspace(PointList(BOX.bounds_m))), "the listed poses"),
        (
            replace(CRANE_STUDY, robot=replace(CRANE, winches=WINCHES)),
            "winches: positions_m, efficiency",
        ),
    ],
    ids=["cases", "asked", "poses", "winches"],
)
def test_it_is_named(study: Study, words: str) -> None:
    assert [words in line for line in lost_by_all(study)] == [True]


def test_what_the_winches_bear_is_in_a_caspr_model_alone() -> None:
    study = replace(CRANE_STUDY, robot=replace(CRANE, winches=Winches(tension_max_N=4e4)))
    assert "tension_max_N" in lost_by_all(study)[0]
    made = to_caspr(ExportedRobot.of(study), "crane")
    assert "<force_max>40000.0</force_max>" in made.files["crane_cables.xml"].decode()
    assert not any("tension_max_N" in line for line in made.lost)


@pytest.mark.parametrize("write", [to_moordyn, to_mujoco, to_gltf])
def test_what_hangs_along_the_cables_is_named(write) -> None:
    robot = replace(CRANE, attached=(Attached(0.3, 0.02),))
    exported = ExportedRobot.of(replace(CRANE_STUDY, robot=robot, workspace=None))
    made = write(exported, "crane")
    assert any("attached along cables" in line for line in made.lost)
    assert exported.design is not None
    assert f"Cables: {exported.design.name}".encode() in next(iter(made.files.values()))


def test_a_box_stands_in_for_moments_of_inertia() -> None:
    corners = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 2.0) for z in (0.0, 3.0)])
    assert np.allclose(inertia_of(Platform(12.0, corners)), np.diag([13.0, 10.0, 5.0]))
    flat = inertia_of(Platform(12.0, corners * [1.0, 1.0, 0.0]))
    assert np.linalg.eigvalsh(flat)[0] > 0.0
