"""The winches of a robot in the config."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from designer.errors import Fault
from designer.model.winches import Winches
from designer.study import Study

STUDY = """\
robot: {anchors: [[0, 0, 9], [9, 0, 9], [4, 9, 9]], platform: {mass: 100}, winches: {%s}}
cable: {density: 7800, youngs_modulus: 200 GPa, allowable_stress: 180 MPa}
"""
WORKSPACE = "workspace: {region: {box: [[3, 4], [3, 4], [1, 2]]}}\n"


def test_winches_with_units(study_of: Callable[[str], Study]) -> None:
    winches = study_of(STUDY % "tension_max: 5 kN" + WORKSPACE).robot.winches
    assert winches.tension_max_N == pytest.approx(5000.0)


def test_largest_tension_of_each_winch(study_of: Callable[[str], Study]) -> None:
    robot = study_of(STUDY % "tension_max: [5 kN, null, 4000]" + WORKSPACE).robot
    assert np.array_equal(robot.winches.tension_max_N, [5000.0, np.inf, 4000.0])
    assert np.array_equal(robot.without_cable(1).winches.tension_max_N, [np.inf, 4000.0])
    alike = study_of(STUDY % "tension_max: [5 kN, 5000, 5 kN]" + WORKSPACE).robot.winches
    assert alike.tension_max_N == 5000.0
    none = study_of(STUDY % "tension_max: [null, null, null]" + WORKSPACE).robot.winches
    assert none.tension_max_N is None
    with pytest.raises(ValueError, match="2 largest tensions of 3 winches"):
        replace(robot, winches=replace(robot.winches, tension_max_N=np.array([1.0, 2.0])))
    with pytest.raises(ValueError, match="tension_max_N must be above 0"):
        Winches(tension_max_N=np.array([1.0, -2.0, np.inf]))


def test_winches_need_a_workspace(faults_of: Callable[[str], list[Fault]]) -> None:
    (fault,) = faults_of(STUDY % "tension_max: 5 kN" + "pose: [4, 4, 2]\n")
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
def test_mistakes(
    faults_of: Callable[[str], list[Fault]], given: str, field: str, problem: str
) -> None:
    (fault,) = faults_of(STUDY % given + WORKSPACE)
    assert fault.field == f"robot.winches.{field}"
    assert problem in fault.problem


AT_FEET = "positions: [[0, 0, 1], [9, 0, 1], [4, 9, 1]]"


def test_positions(study_of: Callable[[str], Study]) -> None:
    robot = study_of(STUDY % AT_FEET + WORKSPACE).robot
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
    (fault,) = faults_of(STUDY % given + WORKSPACE + more)
    assert fault.field == f"robot.winches.positions{field}"
    assert problem in fault.problem


DRIVEN = "drum_diameter: 60 cm, layers: 2, gear_ratio: 50, efficiency: 0.8, motor: {torque: 1 kN*m}"


def test_drum_gear_and_motor(study_of: Callable[[str], Study]) -> None:
    winches = study_of(STUDY % DRIVEN + WORKSPACE).robot.winches
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
    (fault,) = faults_of(STUDY % given + WORKSPACE)
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
    study = study_of(STUDY % given + WORKSPACE)
    assert study.robot.winches.reeving_efficiency == pytest.approx(kept)
    assert study.material.allowable_stress_Pa == pytest.approx(180e6 * kept)
