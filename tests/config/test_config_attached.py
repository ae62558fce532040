"""What is attached along the cables, in the config."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from designer.errors import Fault
from designer.model.cable import Attached
from designer.study import Study

STUDY = """\
robot: {anchors: [[0, 0, 9], [9, 0, 9], [4, 9, 9]], platform: {mass: 100}%s}
cable: {density: 7800, youngs_modulus: 200 GPa, allowable_stress: 180 MPa}
pose: [4, 4, 2]
"""


def test_attached_with_units(study_of: Callable[[str], Study]) -> None:
    study = study_of(STUDY % ", attached: {linear_mass: 400 g/m, diameter: 12 mm}")
    assert study.robot.attached == (Attached(0.4, 0.012),)
    assert study_of(STUDY % "").robot.attached == ()


LINE = "{linear_mass: 400 g/m, diameter: 12 mm}"


@pytest.mark.parametrize(
    ("given", "attached"),
    [
        (f"[{LINE}, null, {LINE}]", (Attached(0.4, 0.012), Attached(), Attached(0.4, 0.012))),
        (f"[{LINE}, {LINE}, {LINE}]", (Attached(0.4, 0.012),)),
        ("[null, null, null]", ()),
    ],
)
def test_one_for_each_cable(
    study_of: Callable[[str], Study], given: str, attached: tuple[Attached, ...]
) -> None:
    study = study_of(STUDY % f", attached: {given}")
    assert study.robot.attached == attached
    given_as = {entry.field: entry.value_SI for entry in study.source.entries}
    assert all(f"robot.attached[{cable}]" in given_as for cable in range(3)) == bool(attached)


@pytest.mark.parametrize(
    ("given", "field", "problem"),
    [
        ("{linear_mass: 0.4}", "robot.attached.diameter", "is missing"),
        ("{linear_mass: 0, diameter: 0.02}", "robot.attached.linear_mass", "0 is out of range"),
        ("{linear_mass: 0.4 kg, diameter: 0.02}", "robot.attached.linear_mass", "has the unit"),
        ("{linear_mass: 0.4, diameter: -1 mm}", "robot.attached.diameter", "is out of range"),
        ("{linear_mass: 1, diameter: 0.02, cables: 1}", "robot.attached.cables", "unknown field"),
        ("[{linear_mass: 0.4, diameter: 0.02}]", "robot.attached", "1 value"),
        (f"[{LINE}, null]", "robot.attached", "2 entries for 3 anchors"),
        (f"[{LINE}, null, 3]", "robot.attached[2]", "3 is not a mapping"),
        ("[null, {linear_mass: 1}, null]", "robot.attached[1].diameter", "is missing"),
        ("0.4", "robot.attached", "0.4"),
    ],
)
def test_mistakes(
    faults_of: Callable[[str], list[Fault]], given: str, field: str, problem: str
) -> None:
    (fault,) = faults_of(STUDY % f", attached: {given}")
    assert (fault.line, fault.field) == (1, field)
    assert problem in fault.problem


@pytest.mark.parametrize(
    ("beside", "field", "problem"),
    [
        ("load_cases: [{name: gale, wind: {speed: 20}}]", "load_cases[0].wind", "directions"),
        (
            "selection: {safety_factor: 4, groups: {a: [1, 2], b: [3]}}",
            "selection.groups",
            "the same is attached to all",
        ),
    ],
)
def test_lines_that_differ_stand_not_beside(
    faults_of: Callable[[str], list[Fault]], beside: str, field: str, problem: str
) -> None:
    text = STUDY % f", attached: [{LINE}, null, null]"
    text = text.replace("mass: 100", "mass: 100, drag: {area: 1, coefficient: 1}")
    text = text.replace("180 MPa", "180 MPa, drag_coefficient: 1.2")
    text += f"workspace: {{region: {{points: [[4, 4, 2]]}}}}\n{beside}\n"
    (fault,) = faults_of(text)
    assert (fault.line, fault.field) == (5, field)
    assert problem in fault.problem
