"""The forms in which a pose may give its orientation."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from designer.errors import Fault
from designer.study import Study

PLATFORM = """\
robot:
  anchors: [[0, 0, 9], [9, 0, 9], [9, 9, 9], [0, 9, 9], [4, 0, 9], [4, 9, 9]]
  platform:
    mass: 100
    attachments: [[1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 1, 0], [0, 0, 0], [0, 0, 0]]
cable: {density: 7800, youngs_modulus: 200 GPa, allowable_stress: 180 MPa}
pose: {position: [4, 4, 2], %s}
"""


def about(axis: str, degrees: float) -> np.ndarray:
    return np.asarray(Rotation.from_euler(axis, degrees, degrees=True).as_matrix())


@pytest.mark.parametrize(
    ("orientation", "expected"),
    [
        ("rotation_vector: [0, 0, 90 deg]", about("z", 90)),
        ("quaternion: [1, 0, 0, 0]", np.eye(3)),
        ("quaternion: [0.70711, 0, 0, 0.70711]", about("z", 90)),
        ("quaternion: [-0.70711, 0, 0, -0.70711]", about("z", 90)),
        (
            "euler: {convention: XYZ, angles: [10 deg, 20 deg, 30 deg]}",
            about("x", 10) @ about("y", 20) @ about("z", 30),
        ),
        (
            "euler: {convention: xyz, angles: [10 deg, 20 deg, 30 deg]}",
            about("z", 30) @ about("y", 20) @ about("x", 10),
        ),
        (
            "euler: {convention: ZXZ, angles: [0.1, 0.2, 0.3]}",
            about("z", np.degrees(0.1)) @ about("x", np.degrees(0.2)) @ about("z", np.degrees(0.3)),
        ),
    ],
)
def test_forms(study_of: Callable[[str], Study], orientation: str, expected: np.ndarray) -> None:
    pose = study_of(PLATFORM % orientation).pose
    assert pose is not None
    np.testing.assert_allclose(pose.rotation, expected, atol=1e-14)


@pytest.mark.parametrize(
    ("orientation", "field", "problem", "expected"),
    [
        ("quaternion: [1, 0, 0]", "pose.quaternion", "has 3 values", "[w, x, y, z]"),
        ("quaternion: [1, 1, 0, 0]", "pose.quaternion", "has length 1.41421", "length 1"),
        ("quaternion: [0, 0, 0, 0]", "pose.quaternion", "has length 0", "length 1"),
        ("quaternion: [1, 0, 0, up]", "pose.quaternion[3]", "'up' is not a number", "number"),
        ("euler: {convention: XYZ}", "pose.euler.angles", "is missing", "three angles"),
        ("euler: {angles: [0, 0, 0]}", "pose.euler.convention", "is missing", "XYZ"),
        ("euler: {convention: XYZ, angles: [1, 2]}", "pose.euler.angles", "has 2 values", "angles"),
        (
            "euler: {convention: XYZ, angles: [1, 2, 3 m]}",
            "pose.euler.angles[2]",
            "the unit meter",
            "an angle",
        ),
        *(
            (
                f"euler: {{convention: {axes}, angles: [0, 0, 0]}}",
                "pose.euler.convention",
                "is no order of axes",
                "turn with the body",
            )
            for axes in ("XYy", "XXZ", "roll", "XY", "5", "[X, Y, Z]")
        ),
        ("euler: [1, 2, 3]", "pose.euler", "a list is not a mapping", "convention, angles"),
        (
            "quaternion: [1, 0, 0, 0], rotation_vector: [0, 0, 0]",
            "pose",
            "has rotation_vector and quaternion",
            "one of",
        ),
        ("quaternoin: [1, 0, 0, 0]", "pose.quaternoin", "unknown field", "'quaternion'?"),
    ],
)
def test_mistakes(
    faults_of: Callable[[str], list[Fault]],
    orientation: str,
    field: str,
    problem: str,
    expected: str,
) -> None:
    faults = faults_of(PLATFORM % orientation)
    assert len(faults) == 1, faults
    assert faults[0].line == 7
    assert faults[0].field == field
    assert problem in faults[0].problem
    assert expected in faults[0].expected


@pytest.mark.parametrize(
    ("orientation", "field"),
    [
        ("quaternion: [0, 1, 0, 0]", "pose.quaternion"),
        ("euler: {convention: XYZ, angles: [0, 0, 1]}", "pose.euler.angles"),
    ],
)
def test_a_point_mass_does_not_turn(
    valid: str, faults_of: Callable[[str], list[Fault]], orientation: str, field: str
) -> None:
    text = valid.replace("[15, 9, 4]", f"{{position: [15, 9, 4], {orientation}}}")
    (fault,) = faults_of(text)
    assert fault.field == field
    assert "has no meaning for a point mass" in fault.problem


def test_a_point_mass_may_say_that_it_does_not_turn(
    valid: str, study_of: Callable[[str], Study]
) -> None:
    text = valid.replace("[15, 9, 4]", "{position: [15, 9, 4], quaternion: [1, 0, 0, 0]}")
    assert study_of(text).pose is not None
