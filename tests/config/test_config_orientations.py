"""How a file asks for orientations, gravity and loads."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from designer.errors import Fault
from designer.model.region import Rectangle
from designer.model.space import FILLING
from designer.model.workspace import Workspace
from designer.study import Study

BODY = """\
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
    robot = study_of(BODY).robot
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
    orientations = workspace_of(study_of(f"{BODY}  {text}\n")).orientations
    np.testing.assert_allclose(orientations.turns_rad, turns, atol=1e-15)
    assert orientations.range_rad is None


def test_orientation_range(study_of: Callable[[str], Study]) -> None:
    text = f"{BODY}  orientation_range: {{rx: [-10 deg, 10 deg], rz: [0, 0.3]}}\n"
    orientations = workspace_of(study_of(text)).orientations
    assert orientations.count == 5 + FILLING
    limit = np.radians(10.0)
    np.testing.assert_allclose(orientations.range_rad, [[-limit, 0, 0], [limit, 0, 0.3]])


def test_a_list_of_orientations_stands_in_the_table_of_inputs(
    study_of: Callable[[str], Study],
) -> None:
    study = study_of(f"{BODY}  orientations: [[0, 0, 0], [0, 10 deg, 0]]\n")
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
    (fault,) = faults_of(f"{BODY}  orientation_range: {{}}\n")
    assert (fault.field, fault.problem) == ("workspace.orientation_range", "the range is empty")


def test_a_rectangle_over_one_point(faults_of: Callable[[str], list[Fault]]) -> None:
    faults = faults_of(PLANAR.replace("anchors, inset: 1", "[[1.5, 2], [1.5, 2]]"))
    (fault,) = [one for one in faults if one.field == "workspace.region.rectangle"]
    assert fault.problem == "begins and ends at one point"
