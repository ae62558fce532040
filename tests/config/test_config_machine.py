"""Winches, drums, what is attached to cables, and load cases in the config."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from designer.errors import Fault
from designer.model.cable import Attached
from designer.model.load_case import AIR_DENSITY_KG_PER_M3
from designer.model.region import Prism
from designer.model.robot import Poses
from designer.model.winches import Drum, Winches
from designer.statics.geometry import load_wrench_N
from designer.study import Study

STUDY_WINCHES = """\
robot: {anchors: [[0, 0, 9], [9, 0, 9], [4, 9, 9]], platform: {mass: 100}, winches: {%s}}
cable: {density: 7800, youngs_modulus: 200 GPa, allowable_stress: 180 MPa}
"""
WORKSPACE = "workspace: {region: {box: [[3, 4], [3, 4], [1, 2]]}}\n"


def test_winches_with_units(study_of: Callable[[str], Study]) -> None:
    winches = study_of(STUDY_WINCHES % "tension_max: 5 kN" + WORKSPACE).robot.winches
    assert winches.tension_max_N == pytest.approx(5000.0)


def test_largest_tension_of_each_winch(study_of: Callable[[str], Study]) -> None:
    robot = study_of(STUDY_WINCHES % "tension_max: [5 kN, null, 4000]" + WORKSPACE).robot
    assert np.array_equal(robot.winches.tension_max_N, [5000.0, np.inf, 4000.0])
    assert np.array_equal(robot.without_cable(1).winches.tension_max_N, [np.inf, 4000.0])
    alike = study_of(STUDY_WINCHES % "tension_max: [5 kN, 5000, 5 kN]" + WORKSPACE).robot.winches
    assert alike.tension_max_N == 5000.0
    none = study_of(STUDY_WINCHES % "tension_max: [null, null, null]" + WORKSPACE).robot.winches
    assert none.tension_max_N is None
    with pytest.raises(ValueError, match="2 largest tensions of 3 winches"):
        replace(robot, winches=replace(robot.winches, tension_max_N=np.array([1.0, 2.0])))
    with pytest.raises(ValueError, match="tension_max_N must be above 0"):
        Winches(tension_max_N=np.array([1.0, -2.0, np.inf]))


def test_winches_need_a_workspace(faults_of: Callable[[str], list[Fault]]) -> None:
    (fault,) = faults_of(STUDY_WINCHES % "tension_max: 5 kN" + "pose: [4, 4, 2]\n")
    assert (fault.line, fault.field) == (1, "robot.winches")
    assert "no workspace" in fault.problem


@pytest.mark.parametrize(
    ("given", "field", "problem"),
    [
        ("tension_max: 0", "tension_max", "0 is out of range"),
        ("tension_max: 3 m", "tension_max", "has the unit meter"),
        ("tension_max: [1 kN, 2 kN]", "tension_max", "2 tensions for 3 anchors"),
        ("tension_max: [1 kN]", "tension_max", "1 value"),
        ("tension_max: [1 kN, 0, 2 kN]", "tension_max[1]", "0 is out of range"),
        ("tension_max: [1 kN, 2 kN, 3 m]", "tension_max[2]", "has the unit meter"),
        ("tension_max: {1: 1 kN}", "tension_max", "a mapping"),
        ("sheave_efficiency: 0", "sheave_efficiency", "0 is out of range"),
        ("sheave_efficiency: 1.02", "sheave_efficiency", "1.02 is out of range"),
        ("sheave_efficiency: 0.96 m", "sheave_efficiency", "has the unit meter"),
        ("sheave_efficiency: 96 %", "sheave_efficiency", "has the unit percent"),
        ("sheave_efficiency: .nan", "sheave_efficiency", "nan"),
        ("sheave_efficiency: [0.96]", "sheave_efficiency", "a list is not a number"),
        ("sheave_efficiency: 0.96, sheaves: 0", "sheaves", "0"),
        ("sheave_efficiency: 0.96, sheaves: 21", "sheaves", "21"),
        ("sheave_efficiency: 0.96, sheaves: 1.5", "sheaves", "1.5"),
        ("sheaves: 2", "sheaves", "nothing is lost on them"),
    ],
)
def test_winches_mistakes(
    faults_of: Callable[[str], list[Fault]], given: str, field: str, problem: str
) -> None:
    (fault,) = faults_of(STUDY_WINCHES % given + WORKSPACE)
    assert fault.field == f"robot.winches.{field}"
    assert problem in fault.problem


AT_FEET = "positions: [[0, 0, 1], [9, 0, 1], [4, 9, 1]]"


def test_positions(study_of: Callable[[str], Study]) -> None:
    robot = study_of(STUDY_WINCHES % AT_FEET + WORKSPACE).robot
    assert robot.winches.positions_m is not None
    assert robot.winches.positions_m[2].tolist() == [4.0, 9.0, 1.0]
    without = robot.without_cable(1).winches.positions_m
    assert without is not None
    assert without.tolist() == [[9.0, 0.0, 1.0], [4.0, 9.0, 1.0]]


@pytest.mark.parametrize(
    ("given", "more", "field", "problem"),
    [
        ("positions: [[0, 0, 1], [9, 0, 1]]", "", "", "2 positions for 3 anchors"),
        (AT_FEET.replace("[9, 0, 1]", "[9, 0, 9]"), "", "[1]", "0 m from robot.anchors[1]"),
        (AT_FEET.replace("[9, 0, 1]", "[9, 0, 1e6]"), "", "[1]", "1e+06 m from"),
        (AT_FEET, "effects: {pulley_radius: {radius_m: 0.1}}", "", "from straight below"),
    ],
)
def test_positions_that_do_not_fit(
    faults_of: Callable[[str], list[Fault]], given: str, more: str, field: str, problem: str
) -> None:
    (fault,) = faults_of(STUDY_WINCHES % given + WORKSPACE + more)
    assert fault.field == f"robot.winches.positions{field}"
    assert problem in fault.problem


DRIVEN = "drum_diameter: 60 cm, layers: 2, gear_ratio: 50, efficiency: 0.8, motor: {torque: 1 kN*m}"


def test_drum_gear_and_motor(study_of: Callable[[str], Study]) -> None:
    winches = study_of(STUDY_WINCHES % DRIVEN + WORKSPACE).robot.winches
    assert winches.torque_Nm(8000.0, 0.01) == pytest.approx(8000.0 * (0.3 + 0.015) / 50 / 0.8)
    assert winches.motor_torque_Nm == pytest.approx(1000.0)


@pytest.mark.parametrize(
    ("given", "field", "problem"),
    [
        ("layers: 2", "layers", "no motor"),
        ("drum_diameter: 60 cm", "drum_diameter", "no motor"),
        ("motor: {torque: 5 N*m}", "motor", "no drum"),
        ("drum_diameter: 1 m, motor: {torque: 0}", "motor.torque", "out of range"),
        ("drum_diameter: 1 m, motor: {}", "motor.torque", "missing"),
        ("drum_diameter: 1 m, gear_ratio: 0, motor: {torque: 1}", "gear_ratio", "out of range"),
    ],
)
def test_winches_that_do_not_fit(
    faults_of: Callable[[str], list[Fault]], given: str, field: str, problem: str
) -> None:
    (fault,) = faults_of(STUDY_WINCHES % given + WORKSPACE)
    assert fault.field == f"robot.winches.{field}"
    assert problem in fault.problem


@pytest.mark.parametrize(
    ("given", "kept"),
    [
        ("sheave_efficiency: 0.96", 0.96),
        ("sheave_efficiency: 0.9, sheaves: 3", 0.729),
        ("sheave_efficiency: 1, sheaves: 4", 1.0),
        ("tension_max: 5 kN", 1.0),
    ],
)
def test_sheaves(study_of: Callable[[str], Study], given: str, kept: float) -> None:
    study = study_of(STUDY_WINCHES % given + WORKSPACE)
    assert study.robot.winches.reeving_efficiency == pytest.approx(kept)
    assert study.material.allowable_stress_Pa == pytest.approx(180e6 * kept)


STUDY_DRUM = """\
robot: {anchors: [[0, 0, 9], [9, 0, 9], [4, 9, 9]], platform: {mass: 100}, winches: {%s}}
cable: {density: 7800, youngs_modulus: 200 GPa, allowable_stress: 180 MPa}
workspace: {region: {box: [[3, 4], [3, 4], [1, 2]]}}
"""


def test_drum_with_units(study_of: Callable[[str], Study]) -> None:
    given = (
        "drum_diameter: 300 mm, layers: 2, drum: {length: 50 cm, groove_pitch: 9 mm, dead_turns: 4,"
        " sheave_distance: 12 m, fleet_angle_max: 1.5 deg}"
    )
    drum = study_of(STUDY_DRUM % given).robot.winches.drum
    assert drum is not None
    figures = drum.diameter_m, drum.length_m, drum.groove_pitch_m, drum.sheave_distance_m
    assert figures == pytest.approx((0.3, 0.5, 0.009, 12.0))
    assert (drum.layers, drum.dead_turns) == (2, 4)
    assert drum.fleet_angle_max_rad == pytest.approx(math.radians(1.5))
    smooth = study_of(STUDY_DRUM % "drum_diameter: 0.3, drum: {length: 0.5}").robot.winches.drum
    assert smooth == Drum(0.3, 0.5, rope_oversize=0.05)
    exact = study_of(STUDY_DRUM % "drum_diameter: 0.3, drum: {length: 0.5, rope_oversize: 2 %}")
    assert exact.robot.winches.drum == Drum(0.3, 0.5, rope_oversize=0.02)


@pytest.mark.parametrize(
    ("given", "field", "problem"),
    [
        ("drum: {length: 0.5}", "drum", "its diameter is not given"),
        ("drum_diameter: 0.3", "drum_diameter", "no motor to drive it, and no length"),
        ("layers: 2", "layers", "no motor to drive it, and no length"),
        ("drum_diameter: 0.3, drum: {}", "drum.length", "is missing"),
        ("drum_diameter: 0.3, drum: 0.5", "drum", "0.5"),
        ("drum_diameter: 0.3, drum: {length: 0}", "drum.length", "out of range"),
        ("drum_diameter: 0.3, drum: {length: 1, dead_turns: 2.5}", "drum.dead_turns", "2.5"),
        ("drum_diameter: 0.3, drum: {length: 1, groove_pitch: 1 kg}", "drum.groove_pitch", "unit"),
        (
            "drum_diameter: 0.3, drum: {length: 1, fleet_angle_max: 2 deg}",
            "drum.fleet_angle_max",
            "there is no sheave",
        ),
        (
            "drum_diameter: 0.3, drum: {length: 1, sheave_distance: 9}",
            "drum.sheave_distance",
            "no angle is asked for",
        ),
        (
            "drum_diameter: 0.3, drum: {length: 1, sheave_distance: 9, fleet_angle_max: 2}",
            "drum.fleet_angle_max",
            "out of range",
        ),
    ],
)
def test_drum_mistakes(
    faults_of: Callable[[str], list[Fault]], given: str, field: str, problem: str
) -> None:
    (fault,) = faults_of(STUDY_DRUM % given)
    assert (fault.line, fault.field) == (1, f"robot.winches.{field}")
    assert problem in fault.problem


STUDY_ATTACHED = """\
robot: {anchors: [[0, 0, 9], [9, 0, 9], [4, 9, 9]], platform: {mass: 100}%s}
cable: {density: 7800, youngs_modulus: 200 GPa, allowable_stress: 180 MPa}
pose: [4, 4, 2]
"""


def test_attached_with_units(study_of: Callable[[str], Study]) -> None:
    study = study_of(STUDY_ATTACHED % ", attached: {linear_mass: 400 g/m, diameter: 12 mm}")
    assert study.robot.attached == (Attached(0.4, 0.012),)
    assert study_of(STUDY_ATTACHED % "").robot.attached == ()


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
    study = study_of(STUDY_ATTACHED % f", attached: {given}")
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
def test_attached_mistakes(
    faults_of: Callable[[str], list[Fault]], given: str, field: str, problem: str
) -> None:
    (fault,) = faults_of(STUDY_ATTACHED % f", attached: {given}")
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
    text = STUDY_ATTACHED % f", attached: [{LINE}, null, null]"
    text = text.replace("mass: 100", "mass: 100, drag: {area: 1, coefficient: 1}")
    text = text.replace("180 MPa", "180 MPa, drag_coefficient: 1.2")
    text += f"workspace: {{region: {{points: [[4, 4, 2]]}}}}\n{beside}\n"
    (fault,) = faults_of(text)
    assert (fault.line, fault.field) == (5, field)
    assert problem in fault.problem


StudyOf = Callable[[str], Study]
FaultsOf = Callable[[str], list[Fault]]

DRAG = "    drag: {area: 1.2 m^2, coefficient: 1.1}\ncable:\n  drag_coefficient: 1.2\n"
CASES = """
load_cases:
  - name: static
  - {name: hoisting, mass: 250 kg, dynamic_factor: 1.3, acceleration: 0.5 m/s^2}
  - name: storm
    wind: {speed: 36 km/h, directions: 12}
    ice: {thickness: 10 mm}
    safety_factor: 3
    termination_efficiency: 0.9
    region: {box: [[1, 2], [3, 4], [5, 6]]}
  - {name: gust, wind: {speed: 10 m/s, direction: [0, 2, 0]}, wrench: {force: [0, 0, -1 kN]}}
  - {name: one lost, cable_lost: each}
  - {name: third lost, cable_lost: 3}
"""


@pytest.fixture
def windy(valid: str) -> str:
    return valid.replace("cable:\n", DRAG)


BODY = """
robot:
  anchors: [[9, 0, 9], [9, 1, 9], [-4, 8, 9], [-5, 7, 9], [-4, -7, 9], [-5, -8, 9]]
  platform:
    mass: 100
    attachments: [[1, -.2, 0], [1, .2, 0], [-.3, 1, 0], [-.7, .8, 0], [-.7, -.8, 0], [-.3, -1, 0]]
    centre_of_mass: [0, 0, -0.2]
    drag: {area: 2, coefficient: 1.1%s}
cable: {density: 5290, youngs_modulus: 62.7 GPa, allowable_stress: 198 MPa, drag_coefficient: 0}
workspace: {region: {points: [[0, 0, 3]]}}
load_cases: [{name: wind, wind: {speed: 10, direction: [1, 0, 0]}}]
"""


@pytest.mark.parametrize(
    ("given", "height_m"),
    [("", -0.2), (", centre: [0, 0, 1.5 m]", 1.5), (", centre: [0, 0, 0]", 0)],
)
def test_wind_acts_at_its_centre_or_the_centre_of_mass(
    given: str, height_m: float, study_of: StudyOf
) -> None:
    study = study_of(BODY % given)
    robot, poses = study.robot, Poses.at([0.0, 0.0, 3.0], [0.3, 0.0, 0.0])
    (loaded,) = study.load_cases[0].on(robot, study.material.cable(0.006))
    moment = load_wrench_N(loaded.robot, poses)[3:] - load_wrench_N(robot, poses)[3:]
    force = 0.5 * AIR_DENSITY_KG_PER_M3 * 100.0 * 2.2
    lever = poses.rotation @ [0.0, 0.0, height_m]
    assert moment == pytest.approx(np.cross(lever, [force, 0.0, 0.0]))


def test_point_mass_has_no_centre_of_drag(windy: str, faults_of: FaultsOf) -> None:
    (fault,) = faults_of(windy.replace("coefficient: 1.1}", "coefficient: 1.1, centre: [0, 0, 1]}"))
    assert fault.field == "robot.platform.drag.centre"
    assert "no meaning for a point mass" in fault.problem


def test_what_they_become(windy: str, study_of: StudyOf) -> None:
    study = study_of(windy + CASES)
    assert study.robot.platform.drag_area_m2 == pytest.approx(1.32)
    static, hoisting, storm, gust, each, third = study.load_cases
    assert (static.dynamic_factor, static.wind, static.cable_lost) == (1.0, None, None)
    assert (hoisting.mass_kg, hoisting.acceleration_m_per_s2) == (250.0, 0.5)
    assert storm.wind is not None
    assert storm.ice is not None
    assert storm.wind.pressure_Pa == pytest.approx(62.5)
    assert (storm.wind.count, storm.wind.cable_drag_coefficient) == (12, 1.2)
    assert (storm.ice.thickness_m, storm.ice.density_kg_per_m3) == (0.01, 900.0)
    assert (storm.safety_factor, storm.termination_efficiency) == (3.0, 0.9)
    assert isinstance(storm.region, Prism)
    assert gust.wind is not None
    assert gust.wrench_N is not None
    np.testing.assert_array_equal(gust.wind.directions(study.robot), [[0, 1, 0]])
    np.testing.assert_array_equal(gust.wrench_N, [0, 0, -1000, 0, 0, 0])
    assert (each.cable_lost, third.cable_lost) == ("each", 3)


def test_the_table_of_inputs_has_them(windy: str, study_of: StudyOf) -> None:
    entries = {e.field: e.value_SI for e in study_of(windy + CASES).source.entries}
    assert (
        entries["load_cases[1]"]
        == "name hoisting, mass 250 kg, dynamic_factor 1.3, acceleration 0.5 m/s^2"
    )
    assert entries["load_cases[4]"].endswith(", cable_lost each")


def test_change_of_temperature(windy: str, study_of: StudyOf) -> None:
    cases = "load_cases: [{name: cold, temperature_change: -30 K}, {name: static}]\n"
    cold, static = study_of(windy + cases).load_cases
    assert (cold.temperature_change_K, cold.expansion_per_K) == (-30.0, None)
    assert static.temperature_change_K is None
    stainless = windy.replace("cable:\n", "cable:\n  thermal_expansion: 16e-6 /K\n")
    assert study_of(stainless + cases).load_cases[0].expansion_per_K == 16e-6


def test_none(valid: str, study_of: StudyOf) -> None:
    assert study_of(valid).load_cases == ()
    assert study_of(valid).robot.platform.drag_area_m2 is None


def test_directions_are_spread_from_x(windy: str, study_of: StudyOf) -> None:
    study = study_of(windy + "load_cases: [{name: a, wind: {speed: 1, directions: 4}}]\n")
    wind = study.load_cases[0].wind
    assert wind is not None
    np.testing.assert_allclose(
        wind.directions(study.robot), [[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]], atol=1e-15
    )


@pytest.mark.parametrize("given", ["", ", directions: all"])
def test_wind_comes_from_its_worst_direction(windy: str, study_of: StudyOf, given: str) -> None:
    study = study_of(windy + f"load_cases: [{{name: a, wind: {{speed: 1{given}}}}}]\n")
    assert study.load_cases[0].searches_wind(study.robot)


def test_given_directions_of_wind_are_kept(windy: str, study_of: StudyOf) -> None:
    for given in ("directions: 8", "direction: [1, 0, 0]"):
        study = study_of(windy + f"load_cases: [{{name: a, wind: {{speed: 1, {given}}}}}]\n")
        assert not study.load_cases[0].searches_wind(study.robot)


@pytest.mark.parametrize(
    ("case", "field", "problem"),
    [
        ("{name: a, winds: 3}", "load_cases[1].winds", "unknown field 'winds'"),
        ("{name: first}", "load_cases[1].name", "load_cases[0] has the name 'first' already"),
        ("{name: a, cable_lost: 4}", "load_cases[1].cable_lost", "there is no cable 4"),
        ("{name: a, cable_lost: all}", "load_cases[1].cable_lost", "'all' is not known"),
        ("{name: a, dynamic_factor: 0.9}", "load_cases[1].dynamic_factor", "0.9 is out of range"),
        ("{name: a, safety_factor: 0.5}", "load_cases[1].safety_factor", "0.5 is out of range"),
        (
            "{name: a, temperature_change: 30 degC}",
            "load_cases[1].temperature_change",
            "'30 degC' has the unit degree_Celsius, of which 0 is no change of 0 K",
        ),
        ("{name: a, ice: {density: 900}}", "load_cases[1].ice.thickness", "missing"),
        (
            "{name: a, wind: {speed: 1, directions: both}}",
            "load_cases[1].wind.directions",
            "'both' is not known",
        ),
        (
            "{name: a, wind: {speed: 1, direction: [1, 0, 0], directions: 2}}",
            "load_cases[1].wind",
            "the wind has directions and direction",
        ),
        (
            "{name: a, region: {prism: anchors, inset: 30, z: [1, 2]}}",
            "load_cases[1].region",
            "nothing is left",
        ),
        ("{name: a, wrench_set: []}", "load_cases[1].wrench_set", "the list has 0 values"),
        (
            "{name: a, wrench_set: {force: [[0, 2 kN], [0, 0], [1 N, 0]]}}",
            "load_cases[1].wrench_set.force[2]",
            "the lower end 1 N is above the upper 0 N",
        ),
        (
            "{name: a, wrench_set: {force: [[0, 1], 2, [0, 1]]}}",
            "load_cases[1].wrench_set.force[1]",
            "2 is not a list",
        ),
        (
            "{name: a, wrench_set: [{force: [0, 0, 1]}], wrench: {force: [0, 0, 1]}}",
            "load_cases[1]",
            "the load case has wrench and wrench_set",
        ),
        (
            "{name: a, wrench_set: {moment: [[0, 1], [0, 0], [0, 0]]}}",
            "load_cases[1].wrench_set",
            "a moment has no meaning for a point mass",
        ),
        (
            "{name: a, wrench: {moment: [1, 0, 0]}}",
            "load_cases[1].wrench",
            "a moment has no meaning for a point mass",
        ),
        (
            "{name: a, acceleration: 1, wind: {speed: 1}, "
            "wrench_set: {force: [[0, 1], [0, 1], [0, 1]]}}",
            "load_cases[1].wrench_set",
            "8 wrenches in 112 directions of wind, inertia and loss",
        ),
    ],
)
def test_load_cases_mistakes(
    windy: str, faults_of: FaultsOf, case: str, field: str, problem: str
) -> None:
    (fault,) = faults_of(f"{windy}load_cases:\n  - name: first\n  - {case}\n")
    assert fault.field == field
    assert problem in fault.problem
    assert fault.line == windy.count("\n") + 3


LINES = {
    "{name: a, winds: 3}": (
        "load_cases[1].winds: unknown field 'winds' (expected one of name, mass, inertia, "
        "wrench, wrench_set, dynamic_factor, acceleration, wind, ice, cable_lost, "
        "temperature_change, safety_factor, termination_efficiency, region; did you mean 'wind'?)"
    ),
    "{name: a, cable_lost: 4}": (
        "load_cases[1].cable_lost: there is no cable 4, the robot has 3 (expected 1 to 3 or each)"
    ),
    "{name: first}": (
        "load_cases[1].name: load_cases[0] has the name 'first' already (expected a name of its "
        "own)"
    ),
    "{name: a, dynamic_factor: 0.9}": (
        "load_cases[1].dynamic_factor: 0.9 is out of range (expected at least 1: 1 is at rest; a "
        "dropped load is another matter)"
    ),
    "{name: a, safety_factor: 0.9}": (
        "load_cases[1].safety_factor: 0.9 is out of range (expected at least 1: lifts of persons "
        "have 12)"
    ),
}


@pytest.mark.parametrize("case", LINES)
def test_the_line_that_is_printed(windy: str, faults_of: FaultsOf, case: str) -> None:
    (fault,) = faults_of(f"{windy}load_cases:\n  - name: first\n  - {case}\n")
    where = f"crane.yaml:{windy.count(chr(10)) + 3}: "
    assert str(fault).split(where, 1)[1] == LINES[case]


def test_the_line_of_wind_without_an_area(windy: str, faults_of: FaultsOf) -> None:
    still = windy.replace("    drag: {area: 1.2 m^2, coefficient: 1.1}\n", "")
    (fault,) = faults_of(f"{still}load_cases: [{{name: a, wind: {{speed: 20 m/s}}}}]\n")
    assert str(fault).endswith(
        "load_cases[0].wind: the platform has no area in the wind "
        "(expected robot.platform.drag: {area: …, coefficient: …})"
    )


def test_wind_needs_area_and_drag(valid: str, faults_of: FaultsOf) -> None:
    found = faults_of(f"{valid}load_cases: [{{name: a, wind: {{speed: 20 m/s}}}}]\n")
    assert [fault.problem for fault in found] == [
        "the platform has no area in the wind",
        "the drag of the cables is not given",
    ]


def test_groups_do_not_go_with_them(valid: str, faults_of: FaultsOf) -> None:
    grouped = valid.replace("safety_factor: 4", "groups: {a: [1], b: [2, 3]}")
    (fault,) = faults_of(grouped + "load_cases: [{name: a}]\n")
    assert "groups of cables are chosen for the static load alone" in fault.problem


def test_without_a_selection_they_ask_for_a_diameter(
    valid: str, study_of: StudyOf, faults_of: FaultsOf
) -> None:
    bare = valid.replace("selection:\n  safety_factor: 4\n", "")
    study = study_of(bare + "load_cases: [{name: a}]\n")
    assert study.selection is None
    assert [case.name for case in study.load_cases] == ["a"]
    (fault,) = faults_of(bare + "load_cases: [{name: a, safety_factor: 3}]\n")
    assert fault.field == "load_cases[0].safety_factor"
    assert "there is no selection" in fault.problem


def test_wind_across_a_plane(valid: str, faults_of: FaultsOf) -> None:
    flat = valid.replace("[15, 2600 cm, 12]", "[15, 0, 12]").replace(
        "prism: anchors, inset: 3 m,", "rectangle: anchors, inset: 3 m,"
    )
    flat = flat.replace("pose: [15, 9, 4]", "pose: [15, 0, 4]").replace(
        "  platform:", "  planar: true\n  platform:"
    )
    flat = flat.replace("cable:\n", DRAG)
    (fault,) = faults_of(flat + "load_cases: [{name: a, wind: {speed: 1, direction: [0, 1, 0]}}]\n")
    assert fault.field == "load_cases"
    assert "leaves that plane" in fault.problem
