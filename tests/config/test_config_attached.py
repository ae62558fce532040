"""What is attached along the cables, in the config."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from designer.errors import Fault
from designer.model.cable import NOTHING_ATTACHED, Attached
from designer.study import Study

STUDY = """\
robot: {anchors: [[0, 0, 9], [9, 0, 9], [4, 9, 9]], platform: {mass: 100}%s}
cable: {density: 7800, youngs_modulus: 200 GPa, allowable_stress: 180 MPa}
pose: [4, 4, 2]
"""


def test_attached_with_units(study_of: Callable[[str], Study]) -> None:
    study = study_of(STUDY % ", attached: {linear_mass: 400 g/m, diameter: 12 mm}")
    assert study.robot.attached == Attached(0.4, 0.012)
    assert study_of(STUDY % "").robot.attached == NOTHING_ATTACHED


@pytest.mark.parametrize(
    ("given", "field", "problem"),
    [
        ("{linear_mass: 0.4}", "robot.attached.diameter", "is missing"),
        ("{linear_mass: 0, diameter: 0.02}", "robot.attached.linear_mass", "0 is out of range"),
        ("{linear_mass: 0.4 kg, diameter: 0.02}", "robot.attached.linear_mass", "has the unit"),
        ("{linear_mass: 0.4, diameter: -1 mm}", "robot.attached.diameter", "is out of range"),
        ("{linear_mass: 1, diameter: 0.02, cables: 1}", "robot.attached.cables", "unknown field"),
        ("[{linear_mass: 0.4, diameter: 0.02}]", "robot.attached", "a list"),
        ("0.4", "robot.attached", "0.4"),
    ],
)
def test_mistakes(
    faults_of: Callable[[str], list[Fault]], given: str, field: str, problem: str
) -> None:
    (fault,) = faults_of(STUDY % f", attached: {given}")
    assert (fault.line, fault.field) == (1, field)
    assert problem in fault.problem
