"""What a study has and a file does not is named, whatever it is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from designer.exports.caspr import to_caspr
from designer.exports.gltf import to_gltf
from designer.exports.moordyn import to_moordyn
from designer.exports.mujoco import to_mujoco
from designer.exports.robot import ExportedRobot, inertia_of, lost_by_all
from designer.model.cable import Attached, Material
from designer.model.load_case import LoadCase
from designer.model.point_list import PointList
from designer.model.prism import Prism
from designer.model.robot import Platform, Poses, Robot
from designer.model.winches import Winches
from designer.model.workspace import Workspace
from designer.study import Study

ANCHORS = np.array([[0.0, 0.0, 9.0], [12.0, 0.0, 9.0], [6.0, 9.0, 9.0]])
CRANE = Robot(ANCHORS, Platform(300.0))
BOX = Prism.box((5.0, 7.0), (2.0, 4.0), (1.0, 5.0))
ASKING = Workspace(BOX, clearance_m=0.1, floor_m=0.0)
WINCHES = Winches(positions_m=ANCHORS, efficiency=0.9)
STUDY = Study(
    "crane",
    CRANE,
    Material(5290.0, 62.7e9, 198e6),
    pose=Poses.at([6.0, 3.0, 3.0]),
    workspace=Workspace(BOX),
)


def test_a_plain_study_loses_nothing_for_all() -> None:
    assert lost_by_all(STUDY) == []


@pytest.mark.parametrize(
    ("study", "words"),
    [
        (replace(STUDY, load_cases=(LoadCase("gale"),)), "load cases (gale)"),
        (replace(STUDY, workspace=ASKING), "clearance, floor"),
        (replace(STUDY, workspace=Workspace(PointList(BOX.bounds_m))), "the listed poses"),
        (
            replace(STUDY, robot=replace(CRANE, winches=WINCHES)),
            "winches: positions_m, efficiency",
        ),
    ],
    ids=["cases", "asked", "poses", "winches"],
)
def test_it_is_named(study: Study, words: str) -> None:
    assert [words in line for line in lost_by_all(study)] == [True]


def test_what_the_winches_bear_is_in_a_caspr_model_alone() -> None:
    study = replace(STUDY, robot=replace(CRANE, winches=Winches(tension_max_N=4e4)))
    assert "tension_max_N" in lost_by_all(study)[0]
    made = to_caspr(ExportedRobot.of(study), "crane")
    assert "<force_max>40000.0</force_max>" in made.files["crane_cables.xml"].decode()
    assert not any("tension_max_N" in line for line in made.lost)


@pytest.mark.parametrize("write", [to_moordyn, to_mujoco, to_gltf])
def test_what_hangs_along_the_cables_is_named(write) -> None:
    robot = replace(CRANE, attached=(Attached(0.3, 0.02),))
    exported = ExportedRobot.of(replace(STUDY, robot=robot, workspace=None))
    made = write(exported, "crane")
    assert any("attached along cables" in line for line in made.lost)
    assert exported.design is not None
    assert f"Cables: {exported.design.name}".encode() in next(iter(made.files.values()))


def test_a_box_stands_in_for_moments_of_inertia() -> None:
    corners = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 2.0) for z in (0.0, 3.0)])
    assert np.allclose(inertia_of(Platform(12.0, corners)), np.diag([13.0, 10.0, 5.0]))
    flat = inertia_of(Platform(12.0, corners * [1.0, 1.0, 0.0]))
    assert np.linalg.eigvalsh(flat)[0] > 0.0
