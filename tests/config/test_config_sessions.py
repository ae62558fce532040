"""A machine that was measured several times, in the study."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from designer.errors import Fault
from designer.study import Study

FaultsOf = Callable[[str], list[Fault]]
StudyOf = Callable[[str], Study]

ROBOT = """\
robot:
  anchors: [[0, 0, 9], [9, 0, 9], [0, 9, 9]]
  platform: {mass: 100}
cable: {density: 7800, youngs_modulus: 200 GPa, allowable_stress: 180 MPa}
effects: {linear_mass: {scale: 1.1}}
"""
TWO = "[{file: a.csv, unknown: [length_offset]}, {file: [b.csv, c.csv]}]"
CABLE = "cable: {linear_mass: 1, axial_stiffness: 9}"


def study_text(sessions: str, more: str = "") -> str:
    return f"{ROBOT}measurements: {{sessions: {sessions}, {CABLE}{more}}}\n"


def test_each_session_has_files_unknowns_and_effects(study_of: StudyOf) -> None:
    own = "{file: d.csv, effects: {winch_zero: [{cable: 2, offset_m: 5 mm}]}}"
    study = study_of(study_text(TWO[:-1] + f", {own}]", ", unknown: [anchors]"))
    measurements = study.measurements
    assert measurements is not None
    assert [path.name for path in measurements.files] == ["a.csv", "b.csv", "c.csv", "d.csv"]
    assert measurements.of_session(1).unknown == ("anchors", "length_offset")
    assert measurements.of_session(2).file_names == "b.csv, c.csv"
    assert study.effects_of_session(1) == ()
    (declared,) = study.effects_of_session(3)
    assert (declared.id, declared.cable, declared.parameters) == (
        "winch_zero",
        2,
        {"offset_m": 0.005},
    )


@pytest.mark.parametrize(
    ("sessions", "more", "field", "problem"),
    [
        ("[{file: a.csv}]", "", "measurements.sessions", "the list has 1 value"),
        (TWO, ", file: d.csv", "measurements.file", "sessions as well"),
        ("[{file: a.csv}, {unknown: []}]", "", "measurements.sessions[1].file", "missing"),
        (
            "[{file: a.csv}, {file: b.csv, unknown: [lenght_offset]}]",
            "",
            "measurements.sessions[1].unknown[0]",
            "not known",
        ),
        (
            TWO,
            ", unknown: [length_offset]",
            "measurements.sessions[0].unknown[0]",
            "unknown of the machine",
        ),
        (
            "[{file: a.csv}, {file: b.csv, unknown: [poses]}]",
            "",
            "measurements.sessions[1].unknown[0]",
            "'poses'",
        ),
        (TWO, ", unknown: [poses]", "measurements.sessions", "'poses'"),
        (
            "[{file: a.csv}, {file: b.csv, effects: {linear_mass: {scale: 1.2}}}]",
            "",
            "measurements.sessions[1].effects.linear_mass",
            "declared of the machine",
        ),
        (
            "[{file: a.csv}, {file: b.csv, effects: {linear_mas: {scale: 1.2}}}]",
            "",
            "measurements.sessions[1].effects.linear_mas",
            "unknown effect",
        ),
        (
            "[{file: a.csv, noise: {length: 1 mm}}, {file: b.csv}]",
            "",
            "measurements.sessions[0].noise",
            "unknown field",
        ),
        ("[a.csv, b.csv]", "", "measurements.sessions[0]", "not a mapping"),
    ],
)
def test_what_sessions_cannot_have_is_refused_in_one_line(
    faults_of: FaultsOf, sessions: str, more: str, field: str, problem: str
) -> None:
    faults = faults_of(study_text(sessions, more))
    assert any(fault.field == field and problem in fault.problem for fault in faults), faults


def test_measurements_without_any_file_are_refused(faults_of: FaultsOf) -> None:
    (fault,) = faults_of(f"{ROBOT}measurements: {{{CABLE}}}\n")
    assert fault.field == "measurements.file"
    assert fault.problem == "is missing"
