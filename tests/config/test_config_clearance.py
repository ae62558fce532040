"""The platform's hull and the clearance of the workspace, in the config."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from designer.errors import Fault
from designer.study import Study

PLATFORM = """\
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
    study = study_of(PLATFORM % ("[[0, 1 m], [0, 1], [-50 cm, 0]]", "100 mm"))
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
def test_mistakes(
    faults_of: Callable[[str], list[Fault]], hull: str, clearance: str, field: str, problem: str
) -> None:
    (fault,) = faults_of(PLATFORM % (hull, clearance))
    assert fault.field == field
    assert problem in fault.problem


def test_a_point_mass_has_no_hull(valid: str, faults_of: Callable[[str], list[Fault]]) -> None:
    text = valid.replace("mass: 180 kg", "mass: 180 kg\n    hull: [[0, 1], [0, 1], [0, 1]]")
    (fault,) = faults_of(text)
    assert fault.field == "robot.platform.hull"
