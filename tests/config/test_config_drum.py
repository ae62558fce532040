"""The drums of the winches in the config."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest

from designer.errors import Fault
from designer.model.winches import Drum
from designer.study import Study

STUDY = """\
robot: {anchors: [[0, 0, 9], [9, 0, 9], [4, 9, 9]], platform: {mass: 100}, winches: {%s}}
cable: {density: 7800, youngs_modulus: 200 GPa, allowable_stress: 180 MPa}
workspace: {region: {box: [[3, 4], [3, 4], [1, 2]]}}
"""


def test_drum_with_units(study_of: Callable[[str], Study]) -> None:
    given = (
        "drum_diameter: 300 mm, layers: 2, drum: {length: 50 cm, groove_pitch: 9 mm, dead_turns: 4,"
        " sheave_distance: 12 m, fleet_angle_max: 1.5 deg}"
    )
    drum = study_of(STUDY % given).robot.winches.drum
    assert drum is not None
    figures = drum.diameter_m, drum.length_m, drum.groove_pitch_m, drum.sheave_distance_m
    assert figures == pytest.approx((0.3, 0.5, 0.009, 12.0))
    assert (drum.layers, drum.dead_turns) == (2, 4)
    assert drum.fleet_angle_max_rad == pytest.approx(math.radians(1.5))
    smooth = study_of(STUDY % "drum_diameter: 0.3, drum: {length: 0.5}").robot.winches.drum
    assert smooth == Drum(0.3, 0.5, rope_oversize=0.05)
    exact = study_of(STUDY % "drum_diameter: 0.3, drum: {length: 0.5, rope_oversize: 2 %}")
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
def test_mistakes(
    faults_of: Callable[[str], list[Fault]], given: str, field: str, problem: str
) -> None:
    (fault,) = faults_of(STUDY % given)
    assert (fault.line, fault.field) == (1, f"robot.winches.{field}")
    assert problem in fault.problem
