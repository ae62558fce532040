"""One log in all the formats that labs write."""

from __future__ import annotations

import importlib
import random
import re
import zipfile
from collections.abc import Callable
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from measured_log import COLUMNS_LINE, Log
from openpyxl import Workbook
from pyarrow import parquet
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from designer.documents import table
from designer.errors import Fault, InputError
from designer.model.measurements import Measured


def same(found: Measured, before: Measured) -> None:
    np.testing.assert_array_equal(found.time_s, before.time_s)
    np.testing.assert_array_equal(found.poses.position_m, before.poses.position_m)
    np.testing.assert_array_equal(found.length_m, before.length_m)
    np.testing.assert_array_equal(found.tension_N, before.tension_N)


@pytest.mark.parametrize("mark", [";", "\t"])
@pytest.mark.parametrize("decimal", [".", ","])
def test_semicolons_tabs_and_decimal_commas(log: Log, mark: str, decimal: str) -> None:
    before = log.read()
    text = log.text().replace(",", mark).replace(".", decimal)
    same(log.read(text.encode()), before)
    same(log.read(("\n\n" + text).encode("utf-8-sig")), before)


@pytest.mark.parametrize("cell", ["n/a", "N/A", "null", "-", "#N/A", "None"])
def test_words_for_nothing(log: Log, cell: str) -> None:
    log.set(4, "length_2_m", cell)
    assert np.argwhere(np.isnan(log.read().length_m)).tolist() == [[3, 1]]


def test_a_row_of_units(log: Log) -> None:
    before = log.read()
    log.add("temperature_C", [20 + row % 5 for row in range(30)])
    log.rows.insert(0, ["s", "m", "m", "m", "m", "m", "m", "N", "N", "kN", "C"])
    log.rename("tension_3_N", "cell 3")
    log.rename("z_m", "z")
    log.rows[0][log.names.index("z")] = "[mm]"
    log.columns = "{cell 3: tension_3_N, z: {to: z_m, scale: 1}}"
    found = log.read()
    np.testing.assert_allclose(found.tension_N[:, 2], 1e3 * before.tension_N[:, 2])
    np.testing.assert_array_equal(found.poses.position_m, before.poses.position_m)
    np.testing.assert_array_equal(found.row_numbers, np.arange(1, 31))
    log.columns = "{cell 3: tension_3_N, z: z_m}"
    np.testing.assert_allclose(
        log.read().poses.position_m[:, 2], 1e-3 * found.poses.position_m[:, 2]
    )


@pytest.mark.parametrize(
    "form",
    [
        "2026-05-03T10:{minute:02}:{second:02}",
        "2026-05-03 10:{minute:02}:{second:02}.000000000Z",
        "2026-05-03T12:{minute:02}:{second:02}+02:00",
    ],
)
def test_iso_times_count_from_the_first_row(log: Log, form: str) -> None:
    before = log.read()
    for row in range(1, 31):
        minute, second = divmod(10 * (row - 1), 60)
        log.set(row, "time_s", form.format(minute=minute, second=second))
    found = log.read()
    same(found, before)
    assert found.notes == ("time_s is counted from 2026-05-03T10:00:00Z",)


@pytest.mark.parametrize(("unit", "factor"), [("s", 1), ("ms", 10**3), ("ns", 10**9)])
def test_times_since_1970_count_from_the_first_row(log: Log, unit: str, factor: int) -> None:
    before = log.read()
    log.rename("time_s", "stamp")
    log.columns = f"{{stamp: {{to: time_s, unit: {unit}}}}}"
    for row in range(1, 31):
        log.set(row, "stamp", (1_700_000_000 + 10 * (row - 1)) * factor)
    found = log.read()
    np.testing.assert_allclose(found.time_s, before.time_s, atol=1e-6)
    assert found.notes == ("stamp is counted from 2023-11-14T22:13:20Z",)


def test_times_of_a_machine_that_runs_already_stay(log: Log) -> None:
    for row in range(1, 31):
        log.set(row, "time_s", 86400 + row)
    found = log.read()
    assert found.time_s is not None
    assert found.time_s[0] == 86401.0


def test_other_times_are_no_covariate(log: Log) -> None:
    log.add("written", [f"2026-05-03T10:00:{row:02}" for row in range(30)])
    found = log.read()
    assert found.covariates == {}
    assert found.notes == ("left out, since they hold times: written",)


START = datetime(2026, 5, 3, 10)


def cells(log: Log) -> dict[str, list[Any]]:
    """Return the columns of a log, the times as such."""
    values: dict[str, list[Any]] = {name: list(log.numbers(name)) for name in log.names}
    values["time_s"] = [START + timedelta(seconds=time) for time in values["time_s"]]
    return values


def read_as(log: Log, name: str, more: str = "") -> Measured:
    """Return what a config finds that names such files."""
    log.config.write_text(log.config.read_text().replace("log.csv", f"{name}{more}"))
    return log.read_config_as_it_is()


def faults_as(log: Log, name: str) -> list[Fault]:
    with pytest.raises(InputError) as caught:
        read_as(log, name)
    return list(caught.value.faults)


def write_workbook(
    path: Path, columns: dict[str, list[Any]], units: list[str] | None = None
) -> None:
    book = Workbook()
    sheet = book.active
    assert sheet is not None
    sheet.append([])  # the table begins in the third row
    sheet.append([None])
    sheet.append(list(columns))
    if units:
        sheet.append(units)
    for row in zip(*columns.values(), strict=True):
        sheet.append(row)
    book.save(path)


def test_excel(log: Log) -> None:
    before = log.read()
    write_workbook(log.folder / "log.xlsx", cells(log), ["", *["m"] * 6, *["N"] * 3])
    found = read_as(log, "log.xlsx")
    same(found, before)
    assert found.notes == ("time_s is counted from 2026-05-03T10:00:00Z",)
    assert len(found.sha256) == 64


def test_a_text_in_excel_has_its_row(log: Log) -> None:
    log.read()
    columns = cells(log)
    columns["y_m"][4] = "abc"
    columns["z_m"][5] = None
    write_workbook(log.folder / "log.xlsx", columns)
    text, half = faults_as(log, "log.xlsx")
    assert (text.line, text.field, text.problem) == (8, "y_m", "row 5 has the text 'abc'")
    assert (half.line, half.field) == (9, "z_m")


@pytest.mark.parametrize("unit", ["us", "ns"])
def test_parquet(log: Log, unit: str) -> None:
    before = log.read()
    columns = cells(log)
    columns["length_2_m"][3] = None
    table = pa.table({**columns, "time_s": pa.array(columns["time_s"], pa.timestamp(unit))})
    parquet.write_table(table, log.folder / "log.parquet")
    found = read_as(log, "log.parquet")
    assert np.isnan(found.length_m[3, 1])
    np.testing.assert_array_equal(found.tension_N, before.tension_N)
    np.testing.assert_array_equal(found.time_s, before.time_s)


def test_a_text_in_parquet_has_its_row(log: Log) -> None:
    log.read()
    columns = {name: list(map(str, values)) for name, values in cells(log).items()}
    columns["y_m"][4] = "abc"
    parquet.write_table(pa.table(columns), log.folder / "log.parquet")
    (fault,) = faults_as(log, "log.parquet")
    assert (fault.line, fault.field, fault.problem) == (None, "y_m", "row 5 has the text 'abc'")


@pytest.mark.parametrize("start", [b"PAR1", b"PK\x03\x04"])
def test_damaged_binary_files(log: Log, start: bytes) -> None:
    (fault,) = log.faults(start + bytes(300))
    assert fault.line is None
    assert "that can be read" in fault.problem


@pytest.mark.parametrize("start", [b"PAR1", b"PK\x03\x04"])
def test_a_library_that_is_missing(log: Log, start: bytes, monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(name: str) -> None:
        raise ImportError(name)

    monkeypatch.setattr(importlib, "import_module", missing)
    (fault,) = log.faults(start)
    assert "which reads such, is missing" in fault.problem
    assert fault.expected.startswith("pip install 'cdpr-designer[")


def change_sheet(path: Path, change: Callable[[bytes], bytes]) -> None:
    """Change the sheet of a workbook as a faulty writer might."""
    with zipfile.ZipFile(path) as book:
        parts = {name: book.read(name) for name in book.namelist()}
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as book:
        for name, content in parts.items():
            book.writestr(name, change(content) if name.endswith("sheet1.xml") else content)


@pytest.mark.parametrize("dimension", [b'<dimension ref="A3:C9"/>', b'<dimension ref="B5"/>', b""])
def test_all_rows_of_a_sheet_are_read_whatever_it_says_of_them(log: Log, dimension: bytes) -> None:
    before = log.read()
    write_workbook(log.folder / "log.xlsx", cells(log))
    change_sheet(
        log.folder / "log.xlsx", lambda sheet: re.sub(rb"<dimension [^>]*/>", dimension, sheet)
    )
    same(read_as(log, "log.xlsx"), before)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        (b'<row r="9"', b'<row r="8"'),
        (b'<row r="9"', b'<row r="5"'),
        (b'<row r="9"', b'<row r="999999999999"'),
        (b'<c r="B9"', b'<c r="C9"'),
    ],
)
def test_no_cell_of_a_sheet_is_dropped(log: Log, old: bytes, new: bytes) -> None:
    log.read()
    write_workbook(log.folder / "log.xlsx", cells(log))
    change_sheet(log.folder / "log.xlsx", lambda sheet: sheet.replace(old, new))
    (fault,) = faults_as(log, "log.xlsx")
    assert re.search(r"row \d+ follows row \d+, or has a cell twice", fault.problem)


def test_cells_of_a_sheet_stand_in_any_order(log: Log) -> None:
    before = log.read()
    write_workbook(log.folder / "log.xlsx", cells(log))

    def reverse(row: re.Match[bytes]) -> bytes:
        return row[1] + b"".join(reversed(re.findall(rb"<c .*?(?:</c>|/>)", row[2]))) + b"</row>"

    change_sheet(
        log.folder / "log.xlsx",
        lambda sheet: re.sub(rb"(<row [^>]*>)(.*?)</row>", reverse, sheet),
    )
    same(read_as(log, "log.xlsx"), before)


@pytest.mark.parametrize(
    "rows",
    [
        b"<row><c><v>1</v></c></row>" * 200_000,
        b"<row/>" * 1_000_000,
        b"".join(b'<row><c r="XFD%d"><v>1</v></c></row>' % k for k in range(40, 4_000)),
    ],
    ids=["rows", "nothing", "columns"],
)
def test_a_small_workbook_that_unpacks_to_a_huge_one(
    log: Log, monkeypatch: pytest.MonkeyPatch, rows: bytes
) -> None:
    monkeypatch.setattr(table, "_MOST_CELLS", 50_000_000 // 10)
    log.read()
    write_workbook(log.folder / "log.xlsx", cells(log))
    change_sheet(
        log.folder / "log.xlsx",
        lambda sheet: sheet.replace(b"</sheetData>", rows + b"</sheetData>"),
    )
    (fault,) = faults_as(log, "log.xlsx")
    assert "it unpacks to more than" in fault.problem


@pytest.mark.parametrize(("n_rows", "n_columns"), [(200_000, 10), (10_200_000, 1)])
def test_a_small_parquet_file_that_unpacks_to_a_huge_table(
    log: Log, n_rows: int, n_columns: int
) -> None:
    log.read()
    zeros = pa.chunked_array([pa.array(np.zeros(200_000))] * (n_rows // 200_000))
    table = pa.table(dict.fromkeys(log.names[:n_columns], zeros))
    path = log.folder / "log.parquet"
    parquet.write_table(table, path, row_group_size=n_rows, compression="zstd")
    assert path.stat().st_size < 1_000_000
    (fault,) = faults_as(log, "log.parquet")
    assert "it unpacks to more than" in fault.problem


def test_a_log_that_hardly_changes_is_read(log: Log) -> None:
    log.read()
    names = [*log.names, "flag"]
    rows = [[*map(float, row), 1.0] for row in log.rows] * 120
    path = log.folder / "log.xlsx"
    write_workbook(path, dict(zip(names, zip(*rows, strict=True), strict=True)))
    unpacked = sum(part.file_size for part in zipfile.ZipFile(path).infolist())
    assert unpacked > 1_000_000
    with path.open("rb") as file:
        assert table.read_table(file, "log.xlsx").n_rows == 3_600


def split(log: Log, lag_s: float = 0.0) -> None:
    """Write the poses and the lengths into two files."""
    log.read()
    for name, names in (("poses", log.names[1:4]), ("winches", log.names[4:])):
        shift_s = lag_s if name == "winches" else 0.0
        rows = [
            [f"{float(row[0]) + shift_s}", *(row[log.names.index(each)] for each in names)]
            for row in log.rows
        ]
        text = "".join(",".join(row) + "\n" for row in (["time_s", *names], *rows))
        (log.folder / f"{name}.csv").write_text(text)


@pytest.mark.parametrize("files", ["[poses.csv, winches.csv]", "[winches.csv, poses.csv]"])
@pytest.mark.parametrize("settled", [True, False])
def test_two_files_are_joined_by_time(log: Log, files: str, settled: bool) -> None:
    log.settled = settled
    before = log.read()
    split(log)
    found = read_as(log, files)
    same(found, before)
    (note,) = found.notes
    assert "winches.csv joined by time, each row with its " in note
    assert ("nearest sample" in note) == settled


def test_a_motion_takes_the_straight_line_and_rest_the_nearest_sample(log: Log) -> None:
    before = log.read()
    split(log, lag_s=2.5)
    at_rest = read_as(log, "[poses.csv, winches.csv]")
    np.testing.assert_array_equal(at_rest.length_m, before.length_m)
    log.settled = False
    split(log, lag_s=2.5)
    moving = read_as(log, "[poses.csv, winches.csv]")
    expected = 0.25 * before.length_m[:-1] + 0.75 * before.length_m[1:]
    np.testing.assert_allclose(moving.length_m, expected)
    assert moving.row_numbers.tolist() == list(range(2, 31))


def test_a_row_whose_reading_was_not_written_has_none(log: Log) -> None:
    split(log)
    path = log.folder / "winches.csv"
    lines = path.read_text().splitlines(keepends=True)
    path.write_text("".join(lines[:9] + lines[10:]))
    found = read_as(log, "[poses.csv, winches.csv]")
    assert 9 not in found.row_numbers
    assert found.n_rows == 29


def test_names_that_two_files_share(log: Log) -> None:
    split(log)
    for name in ("poses", "winches"):
        path = log.folder / f"{name}.csv"
        head, *rows = path.read_text().splitlines()
        rows = [f"{row},{k % 7}" for k, row in enumerate(rows)]
        path.write_text("\n".join([f"{head},status", *rows]))
    assert read_as(log, "[poses.csv, winches.csv]").covariates.keys() == {
        "status",
        "winches.status",
    }


def test_each_file_has_a_time_of_its_own_name_and_unit(log: Log) -> None:
    before = log.read()
    split(log)
    spoil(log, "poses", "time_s", "stamp")
    path = log.folder / "winches.csv"
    head, *rows = path.read_text().splitlines()
    cells = [row.partition(",") for row in rows]
    rows = [f"{1000.0 * float(time)},{rest}" for time, _, rest in cells]
    path.write_text("\n".join([head.replace("time_s", "t"), *rows]))
    for columns in (
        "{stamp: time_s, t: {to: time_s, unit: ms}}",
        "{poses.stamp: time_s, winches.t: {to: time_s, unit: ms}}",
    ):
        log.columns = columns
        log.write_config()
        same(read_as(log, "[poses.csv, winches.csv]"), before)
    spoil(log, "poses", "stamp,x_m", "stamp,t")
    log.columns = "{stamp: time_s, t: time_s}"
    log.write_config()
    fault = faults_as(log, "[poses.csv, winches.csv]")[0]
    assert (fault.line, fault.field) == (1, "t")
    assert fault.problem == "another column of this file is mapped onto time_s"


def test_a_map_of_one_file_alone(log: Log) -> None:
    before = log.read()
    split(log)
    spoil(log, "poses", "x_m", "length_1_m")
    log.columns = "{poses.length_1_m: x_m}"
    log.write_config()
    same(read_as(log, "[poses.csv, winches.csv]"), before)


def spoil(log: Log, name: str, old: str, new: str) -> None:
    path = log.folder / f"{name}.csv"
    path.write_text(path.read_text().replace(old, new, 1))


@pytest.mark.parametrize(
    ("old", "new", "line", "field", "problem"),
    [
        ("time_s", "t", 1, "time_s", "is missing, and joins the files"),
        ("\n30.0,", "\n5.0,", 5, "time_s", "row 4 has 5 s, before row 3 with 20 s"),
        ("\n30.0,", "\nabc,", 5, "time_s", "row 4 has the text 'abc'"),
        ("length_2_m", "x_m", 1, "x_m", "{folder}/poses.csv has x_m as well"),
    ],
)
def test_faults_of_a_second_file_have_its_line(
    log: Log, old: str, new: str, line: int, field: str, problem: str
) -> None:
    split(log)
    spoil(log, "winches", old, new)
    fault = faults_as(log, "[poses.csv, winches.csv]")[0]
    assert (fault.file, fault.line, fault.field) == (str(log.folder / "winches.csv"), line, field)
    assert fault.problem == problem.format(folder=log.folder)


def test_files_of_two_clocks(log: Log) -> None:
    split(log, lag_s=1.7e9)
    (fault,) = faults_as(log, "[poses.csv, winches.csv]")
    assert (fault.field, fault.expected) == ("time_s", "times of one clock in all files")


def test_a_second_file_that_is_not_there(log: Log) -> None:
    split(log)
    (fault,) = faults_as(log, "[poses.csv, nowhere.csv]")
    assert (fault.file, fault.field) == (str(log.config), "measurements.file")
    assert "nowhere.csv" in fault.problem


def write_bag(log: Log, *, plugin: StoragePlugin = StoragePlugin.MCAP) -> Path:
    """Write the log as a bag of two topics, the winches twice as often as the poses."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    types = store.types
    path = log.folder / "run"
    pose_type, joint_type = "geometry_msgs/msg/PointStamped", "sensor_msgs/msg/JointState"
    with Writer(path, version=9, storage_plugin=plugin) as writer:
        poses = writer.add_connection("/camera", pose_type, typestore=store)
        winches = writer.add_connection("/winches", joint_type, typestore=store)
        texts = writer.add_connection("/log", "std_msgs/msg/String", typestore=store)
        for row in range(len(log.rows)):
            stamp_ns = 1_700_000_000_000_000_000 + 10_000_000_000 * row
            time = types["builtin_interfaces/msg/Time"](stamp_ns // 10**9, stamp_ns % 10**9)
            header = types["std_msgs/msg/Header"](time, "base")
            numbers = {name: float(log.cell(row + 1, name)) for name in log.names}
            point = types["geometry_msgs/msg/Point"](*(numbers[f"{axis}_m"] for axis in "xyz"))
            message: Any = types[pose_type](header, point)
            late_ns = stamp_ns + 3_000_000_000  # recorded late, measured at its stamp
            writer.write(poses, late_ns, store.serialize_cdr(message, pose_type))
            text = types["std_msgs/msg/String"]("hello")
            writer.write(texts, late_ns, store.serialize_cdr(text, "std_msgs/msg/String"))
            lengths, tensions = (
                np.array([numbers[f"{kind}_{cable}_{unit}"] for cable in (1, 2, 3)])
                for kind, unit in (("length", "m"), ("tension", "N"))
            )
            message = types[joint_type](header, [], lengths, np.zeros(0), tensions)
            writer.write(winches, late_ns, store.serialize_cdr(message, joint_type))
    return path


BAG_COLUMNS = ", ".join(
    [
        *(f"/camera.point.{axis}: {axis}_m" for axis in "xyz"),
        *(f"'/winches.position[{cable - 1}]': length_{cable}_m" for cable in (1, 2, 3)),
        *(f"'/winches.effort[{cable - 1}]': tension_{cable}_N" for cable in (1, 2, 3)),
    ]
)


@pytest.mark.parametrize("plugin", list(StoragePlugin))
def test_a_bag_of_ros(log: Log, plugin: StoragePlugin) -> None:
    log.columns = f"{{{BAG_COLUMNS}}}"
    before = Log(log.folder).read()
    write_bag(log, plugin=plugin)
    log.write_config()
    found = read_as(log, "run")
    same(found, before)
    assert found.notes[-1] == "time_s is counted from 2023-11-14T22:13:20Z"


def test_faults_of_a_bag(log: Log) -> None:
    log.read()
    path = write_bag(log)
    (fault,) = faults_as(log, "run")
    assert fault.problem == "none of its topics is used: /camera, /log, /winches"
    log.columns = f"{{{BAG_COLUMNS.replace('point.x', 'point.q')}}}"
    log.write_config()
    fault = faults_as(log, "run")[0]
    assert (fault.file, fault.line) == (str(log.config), COLUMNS_LINE)
    assert "did you mean '/camera.point." in fault.expected
    next(path.glob("*.mcap")).write_bytes(b"nothing")
    (fault,) = faults_as(log, "run")
    assert fault.problem.startswith("this is no bag that can be read: ")


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize("name", ["log.xlsx", "log.parquet"])
def test_no_spoilt_file_escapes_as_another_error(log: Log, name: str) -> None:
    log.read()
    if name == "log.xlsx":
        write_workbook(log.folder / name, cells(log))
    else:
        parquet.write_table(pa.table(cells(log)), log.folder / name)
    read_as(log, name)
    good = (log.folder / name).read_bytes()
    rng = random.Random(3)
    refused = 0
    for _ in range(40):
        raw = bytearray(good)
        for _ in range(rng.choice([1, 3, 20])):
            start = rng.randrange(len(raw))
            raw[start : start + rng.choice([0, 1, 30])] = rng.randbytes(rng.choice([0, 1, 4]))
        (log.folder / name).write_bytes(raw)
        try:
            log.read_config_as_it_is()
        except InputError as error:
            refused += 1
            assert "\n" not in error.faults[0].problem
    assert refused > 20
