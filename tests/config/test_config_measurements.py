"""Columns and sessions of measured data in the config."""

from __future__ import annotations

import math
from collections.abc import Callable

import pytest

from designer.errors import Fault
from designer.model.measurements import LogColumn
from designer.study import Entry, Study

FaultsOf = Callable[[str], list[Fault]]
StudyOf = Callable[[str], Study]

BODY = """\
robot:
  anchors: [[0, 0, 9], [9, 0, 9], [9, 9, 9], [0, 9, 9]]
  platform: {mass: 100, attachments: [[1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 1, 1]]}
cable: {density: 7800, youngs_modulus: 200 GPa, allowable_stress: 180 MPa}
"""


def measurements(columns: str = "{}", unknown: str = "[]") -> str:
    return (
        "measurements:\n  file: a.csv\n  cable: {linear_mass: 1, axial_stiffness: 9}\n"
        f"  unknown: {unknown}\n  columns: {columns}\n"
    )


# one entry of the map, and what becomes of a reading of 100
MEANINGS = [
    ("time_s", "time_s", 100.0),
    ("{to: x_m}", "x_m", 100.0),
    ("{to: x_m, unit: mm}", "x_m", 0.1),
    ("{to: length_1_m, scale: 1.2e-5, offset: 1597 mm}", "length_1_m", 1.5982),
    ("{to: length_3_m, unit: ft, offset: -1}", "length_3_m", 29.48),
    ("{to: tension_2_N, unit: kgf}", "tension_2_N", 980.665),
    ("{to: tension_2_N, scale: -2}", "tension_2_N", -200.0),
    ("{to: time_s, unit: ms}", "time_s", 0.1),
    ("{to: temperature_C, unit: degF}", "temperature_C", 37.7777777778),
    ("{to: temperature_C, unit: K, offset: 0.5}", "temperature_C", -172.65),
    ("{to: wind_x_m_per_s, unit: km/h}", "wind_x_m_per_s", 27.7777777778),
    ("ignore", "ignore", 100.0),
    ("covariate", "covariate", 100.0),
]


@pytest.mark.parametrize(("entry", "target", "value"), MEANINGS)
def test_what_becomes_of_a_reading(
    valid: str, study_of: StudyOf, entry: str, target: str, value: float
) -> None:
    found = study_of(valid + measurements(f"{{'a b': {entry}}}")).measurements
    assert found is not None
    (column,) = found.columns
    assert (column.name, column.target) == ("a b", target)
    assert column.scale * 100.0 + column.offset == pytest.approx(value, rel=1e-9)


@pytest.mark.parametrize(
    ("entry", "target", "scale"),
    [
        ("{to: rx_rad, unit: deg}", "rx_rad", math.pi / 180.0),
        ("quaternion_w", "quaternion_w", 1.0),
        ("{to: euler_intrinsic_zyx_1, unit: deg}", "euler_intrinsic_zyx_1", math.pi / 180.0),
        ("euler_extrinsic_xyx_3", "euler_extrinsic_xyx_3", 1.0),
    ],
)
def test_orientations_of_a_body(study_of: StudyOf, entry: str, target: str, scale: float) -> None:
    found = study_of(BODY + measurements(f"{{r: {entry}}}")).measurements
    assert found is not None
    (column,) = found.columns
    assert column == LogColumn("r", target, pytest.approx(scale), 0.0, has_unit="unit" in entry)


def test_entries_show_what_becomes_of_a_reading(valid: str, study_of: StudyOf) -> None:
    columns = "{t: time_s, L: {to: length_1_m, scale: 1e-3, offset: 2 mm}, m: {to: x_m, unit: mm}}"
    entries = study_of(valid + measurements(columns)).source.entries
    assert [entry for entry in entries if "columns" in entry.field] == [
        Entry("measurements.columns.t", "time_s", "time_s"),
        Entry(
            "measurements.columns.L",
            "{to: length_1_m, scale: 1e-3, offset: 2 mm}",
            "length_1_m = 0.001 · reading + 0.002",
        ),
        Entry("measurements.columns.m", "{to: x_m, unit: mm}", "x_m = 0.001 · reading"),
    ]


# one entry of the map for a column 'to', and the fault: where below it, problem, expected
MISTAKES = [
    ("lenght_1_m", "", "'lenght_1_m' is no column of ours", "did you mean 'length_1_m'?"),
    ("LENGTH_1_M", "", "is no column of ours", "did you mean 'length_1_m'?"),
    ("length_01_m", "", "is no column of ours", "did you mean"),
    ("length_0_m", "", "is no column of ours", "did you mean"),
    ("euler_intrinsic_zzx_1", "", "is no column of ours", "did you mean 'euler_intrinsic_z"),
    ("colour", "", "is no column of ours", "or 'covariate'"),
    ("", "", "an empty value is not a name", "{to: …, unit: …}"),
    ("[x_m]", "", "a list is not a name", "such as 'length_1_m'"),
    ("5", "", "5 is not a name", "such as 'length_1_m'"),
    ("{}", ".to", "is missing", "such as 'length_1_m'"),
    ("{to: 5}", ".to", "5 is not a name", "such as 'length_1_m'"),
    ("{to: x_n}", ".to", "'x_n' is no column of ours", "did you mean 'x_m'?"),
    ("{to: x_m, units: mm}", ".units", "unknown field 'units'", "did you mean 'unit'?"),
    ("{to: x_m, unit: mmm}", "", "'mmm' is no unit of a length", "did you mean 'mm'?"),
    ("{to: x_m, unit: kg}", "", "'kg' is no unit of a length", "a unit as in '2 mm'"),
    ("{to: x_m, unit: 10 mm}", "", "'10 mm' is no unit of a length", "a unit as in '2 mm'"),
    ("{to: x_m, unit: 5}", ".unit", "5 is not a text", "a text"),
    ("{to: x_m, unit: mm, scale: 2}", "", "both a unit and a scale", "one of the two"),
    ("{to: x_m, scale: 0}", "", "the scale is zero", "a factor"),
    ("{to: x_m, scale: 2 mm}", ".scale", "unit millimeter", "a plain number"),
    ("{to: x_m, offset: 2 kg}", "", "the offset '2 kg' has the unit kilogram", "a length"),
    ("{to: temperature_C, offset: 2 K}", "", "the offset '2 K' has the unit", "a plain number"),
    ("{to: ignore, unit: m}", "", "'ignore' takes no unit", "'ignore' alone"),
    ("length_4_m", "", "length_4_m: the robot has 3 cables", "from 1 to 3"),
    ("tension_10_N", "", "tension_10_N: the robot has 3 cables", "from 1 to 3"),
    ("rz_rad", "", "rz_rad has no meaning for a point mass", "robot.platform.attachments"),
    ("quaternion_w", "", "has no meaning for a point mass", "or 'ignore'"),
    ("time_s", "", "time_s is already the column 't'", "another name of ours"),
]


@pytest.mark.parametrize("name", ["to", "unit", "L.1 [m]"])
@pytest.mark.parametrize(("entry", "where", "problem", "expected"), MISTAKES)
def test_one_mistake_is_one_line(
    valid: str,
    faults_of: FaultsOf,
    name: str,
    entry: str,
    where: str,
    problem: str,
    expected: str,
) -> None:
    columns = f"\n    t: time_s\n    '{name}': {entry}"
    (fault,) = faults_of(valid + measurements(columns))
    assert fault.field == f"measurements.columns.{name}{where}"
    assert fault.line == len(valid.splitlines()) + 7
    assert problem in fault.problem
    assert expected in fault.expected


def test_a_unit_of_a_quaternion(faults_of: FaultsOf) -> None:
    (fault,) = faults_of(BODY + measurements("{q: {to: quaternion_w, unit: deg}}"))
    assert fault.problem == "'deg' is no unit of a plain number"
    assert fault.expected == "none"


def test_all_that_may_be_unknown(valid: str, study_of: StudyOf) -> None:
    found = study_of(valid + measurements(unknown="[anchors, length_offset, creep]")).measurements
    assert found is not None
    assert found.unknown == ("anchors", "length_offset", "creep")


@pytest.mark.parametrize(
    ("unknown", "place", "problem", "expected"),
    [
        ("[creep, anchor]", "[1]", "'anchor' is not known", "did you mean 'anchors'?"),
        (
            "[length]",
            "[0]",
            "'length' is not known",
            "anchors, attachments, poses, or an effect: pose_shift",
        ),
        ("[5]", "[0]", "5 is not a text", "a text"),
        ("anchors", "", "'anchors' is not a list", "a list"),
        ("[creep, creep]", "[1]", "'creep' is given twice", "once"),
    ],
)
def test_what_cannot_be_unknown(
    valid: str, faults_of: FaultsOf, unknown: str, place: str, problem: str, expected: str
) -> None:
    (fault,) = faults_of(valid + measurements(unknown=unknown))
    assert fault.field == f"measurements.unknown{place}"
    assert fault.line == len(valid.splitlines()) + 4
    assert problem in fault.problem
    assert expected in fault.expected


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
