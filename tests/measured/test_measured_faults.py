"""Every mistake in a log gives its own line; all of them come out together."""

from __future__ import annotations

import random

import pytest
from measured_log import COLUMNS_LINE, Log

from designer.documents import table
from designer.errors import Fault, InputError
from designer.io.config import read_study
from designer.measured.read import read_measured


def only(faults: list[Fault]) -> Fault:
    (fault,) = faults
    return fault


@pytest.mark.parametrize(
    ("raw", "line", "problem"),
    [
        (b"", None, "the file is empty"),
        (b"\n\n  \n", None, "the file is empty"),
        (b"a,b\n\x00\x01", 2, "this is a binary file"),
        (b"PK\x03\x04", None, "this is no Excel workbook that can be read"),
        (b"a,b\n1,2\n\xe9,3\n", 3, "this is not text in UTF-8"),
        ("a,b\n1,2".encode("utf-16"), 1, "this is not text in UTF-8"),
        (b"1,2\n3,4\n", 1, "the first line holds numbers"),
        (b"x_m;y_m\n1,5;2.5\n", 2, "line 2 has a decimal comma, line 2 a decimal point"),
        (b"x_m\ty_m\n1\t2.5\n3\t1,5\n", 3, "line 3 has a decimal comma, line 2 a decimal"),
        (b"x_m y_m\n1 2\n", 1, "the columns are separated by spaces"),
        (b"# a log\nx_m,y_m\n1,2\n", 1, "the first line is a comment"),
        (b"x_m,y_m\r1,2\r", 1, "the lines end with carriage returns alone"),
        (b"x_m\n" + b"1" * 200_000, 2, "this is not valid CSV"),
        (b"x_m\n" + b"1," * 600_000, 2, "this line is too long"),
    ],
)
def test_what_is_no_table(log: Log, raw: bytes, line: int | None, problem: str) -> None:
    fault = only(log.faults(raw))
    assert (fault.file, fault.line) == (str(log.path), line)
    assert fault.problem.startswith(problem)


def test_a_huge_file_is_read_to_the_limit_only(log: Log, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(table, "LARGEST_FILE_BYTES", 1000)
    fault = only(log.faults())
    assert fault.problem == "the file is too large"
    assert fault.expected == "at most 0.001 MB"


@pytest.mark.parametrize("is_folder", [False, True])
def test_a_file_that_cannot_be_opened_is_a_fault_of_the_config(log: Log, is_folder: bool) -> None:
    if is_folder:
        log.path.mkdir()
    with pytest.raises(InputError) as caught:
        log.read_config()
    fault = only(list(caught.value.faults))
    assert (fault.file, fault.field) == (str(log.config), "measurements.file")
    assert fault.line is not None
    assert str(log.path) in fault.problem
    assert ("cannot be read" if is_folder else "there is no file") in fault.problem


def test_a_config_without_measurements(log: Log) -> None:
    log.read()
    text = log.config.read_text()
    log.config.write_text(text[: text.index("measurements")])
    with pytest.raises(InputError, match="measurements: is missing"):
        read_measured(read_study(log.config))


def test_missing_columns_are_all_named(log: Log) -> None:
    log.rename("y_m", "Y_m")
    log.drop("z_m", "length_2_m", "tension_3_N")
    faults = log.faults()
    assert [fault.field for fault in faults] == ["y_m", "z_m", "length_2_m", "tension_3_N"]
    assert {fault.problem for fault in faults} == {"is missing"}
    assert {fault.line for fault in faults} == {1}
    assert faults[0].expected.endswith("did you mean 'Y_m'?")


def test_a_log_without_any_pose_is_told_in_one_line(body: Log) -> None:
    body.drop("x_m", "y_m", "z_m")
    fault = only(body.faults())
    assert fault.field == "x_m, y_m, z_m"
    assert "there is no measured pose" in fault.problem
    assert "by other means than the winches" in fault.problem


def test_neither_lengths_nor_tensions(log: Log) -> None:
    log.drop(*log.names[4:])
    fault = only(log.faults())
    assert "neither a column for lengths nor one for tensions" in fault.problem
    assert "length_1_m … length_3_m, or tension_1_N … tension_3_N" in fault.expected


def test_a_body_without_its_orientation(body: Log) -> None:
    assert [fault.field for fault in body.faults()] == ["rx_rad", "ry_rad", "rz_rad"]


def test_half_a_quaternion(body: Log) -> None:
    body.add("q0", "1")
    body.columns = "{q0: quaternion_w}"
    fields = [fault.field for fault in body.faults()]
    assert fields == ["quaternion_x", "quaternion_y", "quaternion_z"]


def test_an_orientation_in_two_forms(body: Log) -> None:
    body.add("rx_rad", "0")
    body.add("q0", "1")
    body.columns = "{q0: quaternion_w}"
    fault = only(body.faults())
    assert fault.problem == "the orientation is given in two forms, with quaternion_w and rx_rad"


@pytest.mark.parametrize("name", ["length_4_m", "tension_4_N", "length_0_m", "tension_01_N"])
def test_a_cable_that_the_robot_lacks(log: Log, name: str) -> None:
    log.add(name, "1")
    fault = only(log.faults())
    assert (fault.line, fault.field) == (1, name)
    assert fault.problem == "there is no such cable, the robot has 3"


def test_a_mapped_column_that_the_file_lacks(log: Log) -> None:
    log.rename("length_1_m", "L1_m")
    log.rename("x_m", "Camera.X")
    log.columns = "{L1 m: length_1_m, camera.X: {to: x_m, unit: mm}}"
    faults = log.faults()
    assert [fault.field for fault in faults] == [
        "measurements.columns.L1 m",
        "measurements.columns.camera.X",
    ]
    for fault, nearest in zip(faults, ("L1_m", "Camera.X"), strict=True):
        assert (fault.file, fault.line) == (str(log.config), COLUMNS_LINE)
        assert "there is no such column in" in fault.problem
        assert fault.expected.endswith(f"did you mean '{nearest}'?")


def test_a_column_mapped_onto_one_that_is_there_already(log: Log) -> None:
    log.add("camera", "1")
    log.columns = "{camera: x_m}"
    fault = only(log.faults())
    assert (fault.file, fault.line, fault.field) == (str(log.path), 1, "x_m")
    assert "another column is mapped onto x_m" in fault.problem
    assert "'x_m: ignore'" in fault.expected


def test_names_that_stand_twice(log: Log) -> None:
    log.add("x_m", "1")
    fault = only(log.faults())
    assert (fault.line, fault.field) == (1, "x_m")
    assert fault.problem == "columns 2 and 11 have the same name"


@pytest.mark.parametrize("name", ["time_s", "x_m", "length_3_m", "temperature_C", "battery"])
@pytest.mark.parametrize("cell", ["abc", "1 m", "1.2.3", "2026-05-33 10:00", "1_0"])
def test_text_in_a_numeric_column(log: Log, name: str, cell: str) -> None:
    for added in ("temperature_C", "battery"):
        log.add(added, [str(row) for row in range(30)])
    log.set(7, name, cell)
    fault = only(log.faults())
    assert (fault.line, fault.field) == (8, name)
    assert fault.problem == f"row 7 has the text '{cell}'"
    otherwise = "a time such as 2026-05-03T10:00:00.5Z" if name == "time_s" else "nothing"
    assert fault.expected.startswith(f"a number, or {otherwise}")


@pytest.mark.parametrize(
    ("unit", "expected"),
    [
        ("mm", "m, as its name says; or {to: x_m, unit: mm} in measurements.columns"),
        ("wobbles", "a length such as '2 mm'"),
        ("kg", "a length such as '2 mm'"),
    ],
)
def test_a_row_of_units_against_the_names(log: Log, unit: str, expected: str) -> None:
    log.rows.insert(0, ["[s]", unit, "m", "m", "m", "m", "m", "N", "N", "N"])
    fault = only(log.faults())
    assert (fault.line, fault.field) == (2, "x_m")
    assert fault.problem == f"the row of units says '{unit}'"
    assert fault.expected.startswith(expected)


def test_a_text_below_the_units(log: Log) -> None:
    log.rows.insert(0, ["s", *["m"] * 6, *["N"] * 3])
    log.set(4, "y_m", "abc")
    fault = only(log.faults())
    assert (fault.line, fault.problem) == (5, "row 3 has the text 'abc'")


@pytest.mark.parametrize("unit", ["ms", "us", "ns"])
def test_small_units_of_time_since_1970(log: Log, unit: str) -> None:
    factor = {"ms": 10**3, "us": 10**6, "ns": 10**9}[unit]
    for row in range(1, 31):
        log.set(row, "time_s", (1_700_000_000 + 10 * row) * factor)
    fault = only(log.faults())
    assert (fault.line, fault.field) == (2, "time_s")
    assert "seconds since 1970" in fault.problem
    assert fault.expected.startswith(f"seconds, or {{to: time_s, unit: {unit}}}")


def test_nanoseconds_from_the_start(log: Log) -> None:
    for row in range(1, 31):
        log.set(row, "time_s", row * 10**10)
    fault = only(log.faults())
    assert (fault.line, fault.field) == (1, "time_s")
    assert fault.problem == "spans 2.9e+11 s, which is more than ten years"


@pytest.mark.parametrize(
    ("form", "seconds"),
    [
        ("{:d}".format, "2e+13"),
        (lambda row: f"0001-01-01T00:00:{row % 60:02}+14:00", "-6.214e+10"),
    ],
    ids=["seconds", "the year 0"],
)
def test_times_that_no_calendar_has(log: Log, form, seconds: str) -> None:
    for row in range(1, 31):
        log.set(row, "time_s", form(2 * 10**13 + row))
    fault = log.faults()[0]
    assert (fault.line, fault.field) == (2, "time_s")
    assert fault.problem == f"row 1 has {seconds} s since 1970, which is no date"


def test_a_date_that_is_no_reading(log: Log) -> None:
    log.set(5, "tension_2_N", "2026-05-03T10:00:00")
    fault = only(log.faults())
    assert (fault.line, fault.field) == (6, "tension_2_N")
    assert fault.problem == "row 5 has the time '2026-05-03T10:00:00'"


def test_dates_out_of_order(log: Log) -> None:
    for row in range(1, 31):
        log.set(row, "time_s", f"2026-05-03 10:{59 - row}:00")
    fault = log.faults()[0]
    assert (fault.line, fault.field) == (3, "time_s")
    assert fault.problem.startswith("row 2 has 2026-05-03T10:57:00Z, before row 1 with 2026-05-03T")


@pytest.mark.parametrize("cell", ["3,25", "-1,276.4", "1,276,400"])
def test_commas_in_a_number_are_named(log: Log, cell: str) -> None:
    log.set(7, "tension_1_N", f'"{cell}"')
    assert only(log.faults()).expected == "a number with a decimal point and without commas"


@pytest.mark.parametrize(
    ("name", "cell", "expected"),
    [
        ("x_m", "1e29", "-1e+07 to 1e+07"),
        ("length_2_m", "-2e7", "-1e+07 to 1e+07"),
        ("tension_1_N", "1e29", "-1e+20 to 1e+20"),
        ("temperature_C", "-300", "-273.15 to"),
        ("wind_x_m_per_s", "5000", "-1000 to 1000"),
    ],
)
def test_values_that_nothing_can_have(log: Log, name: str, cell: str, expected: str) -> None:
    for added in ("temperature_C", "wind_x_m_per_s", "wind_y_m_per_s"):
        log.add(added, [str(row % 7) for row in range(30)])
    log.set(7, name, cell)
    fault = only(log.faults())
    assert (fault.line, fault.field) == (8, name)
    assert fault.problem.startswith("row 7 has the value ")
    assert fault.expected.startswith(expected)


def test_angles_in_degrees(body: Log) -> None:
    for name in ("rx_rad", "ry_rad", "rz_rad"):
        body.add(name, [str(row % 9) for row in range(30)])
    faults = body.faults()
    assert {fault.field for fault in faults[:-1]} == {"rx_rad", "ry_rad", "rz_rad"}
    assert faults[0].problem == "row 8 has the value 7"
    assert faults[0].expected == "-6.28319 to 6.28319 rad; units go into measurements.columns"


def test_much_text_is_told_in_few_lines(log: Log) -> None:
    for row in range(1, 31):
        log.set(row, "length_1_m", "x")
        log.set(row, "tension_2_N", "y")
    faults = log.faults()
    assert len(faults) == 21
    assert faults[-1].problem == "and 40 more cells with a text"


@pytest.mark.parametrize("cell", ["inf", "-inf", "Infinity", "1e999", "-1e300"])
@pytest.mark.parametrize("name", ["x_m", "time_s", "tension_1_N", "battery"])
def test_infinite_values(log: Log, name: str, cell: str) -> None:
    log.add("battery", [str(row) for row in range(30)])
    log.set(30, name, cell)
    fault = log.faults()[0]
    assert (fault.line, fault.field) == (31, name)
    assert fault.problem.startswith("row 30 has the value ")
    assert fault.expected.startswith("a finite number")


def test_half_a_pose(log: Log) -> None:
    log.set(3, "y_m", "nan")
    fault = only(log.faults())
    assert (fault.line, fault.field) == (4, "y_m")
    assert fault.problem == "row 3 has half a pose, this is missing"


def test_a_position_without_its_orientation(body: Log) -> None:
    for axis in "xyz":
        body.add(f"r{axis}_rad", ["" if row == 4 else "0.1" for row in range(30)])
    assert [(fault.line, fault.field) for fault in body.faults()] == [
        (6, "rx_rad"),
        (6, "ry_rad"),
        (6, "rz_rad"),
    ]


def test_a_pose_column_without_anything_in_it(log: Log) -> None:
    for row in range(1, 31):
        log.set(row, "z_m", "")
    fault = only(log.faults())
    assert (fault.line, fault.field, fault.problem) == (1, "z_m", "is empty")


def test_a_row_without_its_time(log: Log) -> None:
    log.set(12, "time_s", "NA")
    fault = only(log.faults())
    assert (fault.line, fault.field, fault.problem) == (13, "time_s", "row 12 has no time")


@pytest.mark.parametrize("settled", [True, False])
def test_time_going_backwards(log: Log, settled: bool) -> None:
    log.settled = settled
    log.set(12, "time_s", "95")
    fault = only(log.faults())
    assert (fault.line, fault.field) == (13, "time_s")
    assert fault.problem == "row 12 has 95 s, before row 11 with 100 s"


def test_equal_times_of_a_moving_robot(log: Log) -> None:
    log.settled = False
    log.set(12, "time_s", "100")
    assert only(log.faults()).problem == "row 12 has 100 s, the same time as row 11"
    for row in range(1, 31):
        log.set(row, "time_s", "100")
    assert only(log.faults()).problem == "is the same in all rows"


@pytest.mark.parametrize(("count", "problem"), [(7, "7 of 7 rows have"), (0, "there are no rows")])
def test_too_few_rows(log: Log, count: int, problem: str) -> None:
    del log.rows[count:]
    fault = only(log.faults())
    assert fault.problem.startswith(problem)
    assert fault.expected == "at least 8 rows"


def test_rows_that_are_left_out_do_not_count(log: Log) -> None:
    for name in log.names[4:]:
        for row in range(8, 31):
            log.set(row, name, "")
    assert only(log.faults()).problem == "7 of 30 rows have a pose and a reading"


def test_all_rows_at_one_pose(log: Log) -> None:
    for row in range(1, 31):
        for name in ("x_m", "y_m", "z_m"):
            log.set(row, name, 3 + 1e-8 * row)
    assert only(log.faults()).problem.startswith("all rows are at one pose")


def test_rows_at_few_poses(log: Log) -> None:
    for row in range(1, 31):
        for name in ("x_m", "y_m", "z_m"):
            log.set(row, name, 3 + row % 4)
    fault = only(log.faults())
    assert (fault.problem, fault.expected) == ("the rows are at 4 different poses", "at least 5")


def test_rows_of_another_width(log: Log) -> None:
    log.rows[3].append("7")
    del log.rows[8][5:]
    assert [(fault.line, fault.problem) for fault in log.faults()] == [
        (5, "row 4 has 11 values"),
        (10, "row 9 has 5 values"),
    ]


def test_a_quaternion_that_is_none(body: Log) -> None:
    for part in "wxyz":
        body.add(f"q{part}", "0.5")
    body.columns = "{qw: quaternion_w, qx: quaternion_x, qy: quaternion_y, qz: quaternion_z}"
    body.set(6, "qy", "0.55")
    fault = only(body.faults())
    assert (fault.line, fault.field) == (7, "qw")
    assert fault.problem.startswith("row 6 has a quaternion of length 1.02")
    assert fault.expected == "1 within 1 %"


def test_all_faults_come_out_at_once(log: Log) -> None:
    log.columns = "{nowhere: ignore}"
    log.add("length_4_m", "1")
    log.drop("y_m")
    log.set(2, "length_1_m", "abc")
    log.set(3, "length_1_m", "inf")
    log.set(4, "time_s", "0")
    log.set(5, "x_m", "")
    log.rows[6].append("1")
    assert [(fault.line, fault.field) for fault in log.faults()] == [
        (8, ""),
        (COLUMNS_LINE, "measurements.columns.nowhere"),
        (1, "length_4_m"),
        (1, "y_m"),
        (3, "length_1_m"),
        (4, "length_1_m"),
        (6, "x_m"),
        (5, "time_s"),
    ]


def test_the_line_reads_as_documented(log: Log) -> None:
    log.set(1, "length_1_m", "abc")
    assert str(only(log.faults())) == (
        f"{log.path}:2: length_1_m: row 1 has the text 'abc' "
        "(expected a number, or nothing where there is none)"
    )


JUNK = [b",", b"\n", b'"', b"\r", b"nan", b"1e308", b"1e999", b"-", b";", b"x", b"\xc3\xa9"]
JUNK += [b"\xff", b"\x00", b"  ", b"\n\n", b"NA", b"9" * 20, b"_", b""]


def test_no_spoilt_log_escapes_as_another_error(log: Log) -> None:
    rng = random.Random(7)
    log.read()
    study = read_study(log.config)
    good = log.text().encode()
    refused = 0
    for _ in range(300):
        raw = bytearray(good)
        for _ in range(rng.choice([1, 2, 9])):
            start = rng.randrange(len(raw))
            raw[start : start + rng.choice([0, 1, 3, 30])] = rng.choice(JUNK)
        log.path.write_bytes(raw)
        try:
            read_measured(study)
        except InputError as error:
            refused += 1
            assert len(error.faults) <= 100
            assert str(error).replace("\n", "").isprintable()
    assert 100 < refused < 300
