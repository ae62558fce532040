"""What the chosen rope is checked against beyond its strength, in the config."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from designer.errors import Fault
from designer.study import RopeLimits, Study

STUDY = """\
robot: {anchors: [[0, 0, 9], [9, 0, 9], [4, 9, 9]], platform: {mass: 100}}
cable: {density: 7800, youngs_modulus: 200 GPa, allowable_stress: 180 MPa}
workspace: {region: {box: [[3, 4], [3, 4], [1, 2]]}}
selection: {limits: %s}
"""


def test_limits_with_units(study_of: Callable[[str], Study]) -> None:
    given = "{stiffness: 5 kN/m, excitation: [500 mHz, 3 Hz], drum_capacity: 60 m}"
    selection = study_of(STUDY % given).selection
    assert selection is not None
    limits = selection.limits
    assert limits.stiffness_N_per_m == pytest.approx(5000.0)
    assert limits.excitation_Hz == pytest.approx((0.5, 3.0))
    assert limits.drum_capacity_m == pytest.approx(60.0)


def test_left_out_nothing_is_asked_for(study_of: Callable[[str], Study]) -> None:
    selection = study_of(STUDY % "{}").selection
    assert selection is not None
    assert selection.limits == RopeLimits()


@pytest.mark.parametrize(
    ("limits", "field", "problem"),
    [
        ("{stiffness: 0}", "stiffness", "0 is out of range"),
        ("{stiffness: 5 kN}", "stiffness", "has the unit kilonewton"),
        ("{excitation: 2 Hz}", "excitation", "is not a list"),
        ("{excitation: [1 Hz]}", "excitation", "has 1 value"),
        ("{excitation: [3 Hz, 1 Hz]}", "excitation", "is not below the upper 1 Hz"),
        ("{excitation: [1 m, 3 Hz]}", "excitation[0]", "has the unit meter"),
        ("{platform_frequency: [1 Hz]}", "platform_frequency", "has 1 value"),
        ("{platform_frequency: [3 Hz, 1 Hz]}", "platform_frequency", "is not below the upper 1 Hz"),
        ("{platform_frequency: 2 m}", "platform_frequency", "has the unit meter"),
        ("{drum_capacity: -1 m}", "drum_capacity", "is out of range"),
        ("{drum: 60 m}", "drum", "unknown field"),
    ],
)
def test_mistakes(
    faults_of: Callable[[str], list[Fault]], limits: str, field: str, problem: str
) -> None:
    (fault,) = faults_of(STUDY % limits)
    assert fault.field == f"selection.limits.{field}"
    assert problem in fault.problem


def test_a_least_frequency_of_the_platform_or_a_band(study_of: Callable[[str], Study]) -> None:
    for given, read in (("500 mHz", (0.5,)), ("[0.5, 2 Hz]", (0.5, 2.0))):
        selection = study_of(STUDY % f"{{platform_frequency: {given}}}").selection
        assert selection is not None
        assert selection.limits.platform_frequency_Hz == pytest.approx(read)
    with pytest.raises(ValueError, match="platform_frequency_Hz"):
        RopeLimits(platform_frequency_Hz=(2.0, 1.0))


BODY = """\
robot:
  anchors: &a [[9, 0, 9], [9, 1, 9], [-4, 8, 9], [-5, 7, 9], [-4, -7, 9], [-5, -8, 9]]
  platform:
    mass: 100
    attachments: [[1, 0, 0], [1, 0.1, 0], [-1, 1, 0], [-1, 1.1, 0], [-1, -1, 0], [-1, -1.1, 0]]
    %s
cable: {density: 7800, youngs_modulus: 200 GPa, allowable_stress: 180 MPa}
workspace: {region: {points: [[0, 0, 3]]}}
selection: {%s}
load_cases: [{name: static}, {name: loaded, %s}]
"""
LIMIT = "limits: {platform_frequency: 1 Hz}"


def test_inertia_becomes_a_matrix(study_of: Callable[[str], Study]) -> None:
    study = study_of(
        BODY % ("inertia: [20, 30, 40, 1, 2, -3]", LIMIT, "mass: 90, inertia: [9, 9, 9]")
    )
    inertia = study.robot.platform.inertia_kg_m2
    assert inertia is not None and inertia.tolist() == [[20, 1, 2], [1, 30, -3], [2, -3, 40]]
    case = study.load_cases[1].inertia_kg_m2
    assert case is not None and case.tolist() == [[9, 0, 0], [0, 9, 0], [0, 0, 9]]


@pytest.mark.parametrize(
    ("inertia", "limits", "case", "field", "problem"),
    [
        ("", LIMIT, "", "selection.limits.platform_frequency", "inertia of the platform is not"),
        ("inertia: [9, 9, 9]", LIMIT, "mass: 90", "load_cases[1].mass", "with this mass is not"),
        ("inertia: [1, 1]", "", "", "robot.platform.inertia", "has 2 values"),
        ("inertia: [1, 1, 1, 0]", "", "", "robot.platform.inertia", "has 4 values"),
        ("inertia: [1, 1, 3]", "", "", "robot.platform.inertia", "no body has"),
        ("inertia: [1, 1, 0]", "", "", "robot.platform.inertia", "no body has"),
        ("inertia: [1, 1, 1, 2, 0, 0]", "", "", "robot.platform.inertia", "no body has"),
        ("inertia: [1 kg, 1, 1]", "", "", "robot.platform.inertia[0]", "has the unit kilogram"),
    ],
)
def test_mistakes_of_inertia(
    faults_of: Callable[[str], list[Fault]],
    inertia: str,
    limits: str,
    case: str,
    field: str,
    problem: str,
) -> None:
    (fault,) = faults_of(BODY % (inertia, limits, case))
    assert fault.field == field
    assert problem in fault.problem


def test_a_point_has_no_inertia(faults_of: Callable[[str], list[Fault]]) -> None:
    text = STUDY % "{}" + "load_cases: [{name: a, inertia: [1, 1, 1]}]\n"
    given = text.replace("mass: 100", "mass: 100, inertia: [1, 1, 1]")
    assert {fault.field for fault in faults_of(given)} == {
        "robot.platform.inertia",
        "load_cases[0].inertia",
    }


@pytest.mark.parametrize("band_Hz", [(0.0, 1.0), (2.0, 2.0), (3.0, 1.0)])
def test_no_band_in_python(band_Hz: tuple[float, float]) -> None:
    with pytest.raises(ValueError, match="excitation_Hz"):
        RopeLimits(excitation_Hz=band_Hz)
