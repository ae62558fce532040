"""What `designer diagnose` says of a log that is not as it should be, and what it writes."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from designer.arrays import frozen_array
from designer.cli.commands import main
from designer.model.cable import Cable
from designer.model.robot import Platform, Poses, Robot
from designer.statics.inverse import solve_sagging

CONFIG = """\
name: Yard
robot:
  anchors: [[0, 0, 12], [30, 0, 12.5], [14, 26, 11.5]]
  platform: {mass: 180 kg}
cable: {density: 7800, youngs_modulus: 200 GPa, allowable_stress: 180 MPa}
measurements:
  file: log.csv
  cable: {linear_mass: 0.142, axial_stiffness: 3.3 MN}
  noise: {length: 1 mm, tension: 4 N}
"""
NAMES = ("time_s", "x_m", "y_m", "z_m")
LENGTHS = ("length_1_m", "length_2_m", "length_3_m")
TENSIONS = ("tension_1_N", "tension_2_N", "tension_3_N")
N_ROWS = 32

Columns = dict[str, list[str]]
Spoil = Callable[[Columns], None]


@dataclass
class Outcome:
    """What a run of the command left."""

    status: int
    out: str
    err: str


@pytest.fixture(scope="module")
def good() -> Columns:
    """A log in which nothing is wrong: noise alone."""
    rng = np.random.default_rng(0)
    position = rng.uniform([9, 5, 2], [20, 15, 8], (N_ROWS, 3))
    anchors = [[0, 0, 12], [30, 0, 12.5], [14, 26, 11.5]]
    robot = Robot(frozen_array(anchors), Platform(180.0))
    cable = Cable(float("nan"), 0.142, 3.3e6, float("inf"))
    statics = solve_sagging(robot, Poses.at(position), cable)
    length = statics.length_m + rng.normal(0.0, 1e-3, (N_ROWS, 3))
    tension = statics.exit_tension_N + rng.normal(0.0, 4.0, (N_ROWS, 3))
    table = np.column_stack([60.0 * np.arange(N_ROWS), position, length, tension])
    names = (*NAMES, *LENGTHS, *TENSIONS)
    return {name: [f"{x:.6f}" for x in column] for name, column in zip(names, table.T, strict=True)}


@pytest.fixture
def diagnose(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> Callable[..., Outcome]:
    """Run the command in a folder with the study and this log."""
    monkeypatch.chdir(tmp_path)

    def run(raw: bytes, more: str = "") -> Outcome:
        Path("robot.yaml").write_text(CONFIG + more, encoding="utf-8")
        Path("log.csv").write_bytes(raw)
        monkeypatch.setattr(sys, "argv", ["designer", "diagnose", "robot.yaml", "--no-plugins"])
        try:
            main()
            status = 0
        except SystemExit as stop:
            status = int(stop.code or 0)
        captured = capsys.readouterr()
        return Outcome(status, captured.out, captured.err)

    return run


def text(columns: Columns) -> bytes:
    """Return the CSV file."""
    rows = zip(*columns.values(), strict=True)
    return "".join(",".join(row) + "\n" for row in (tuple(columns), *rows)).encode()


def scaled(columns: Columns, names: tuple[str, ...], factor: float) -> None:
    for name in names:
        columns[name] = [f"{factor * float(cell):.6f}" for cell in columns[name]]


def cell(name: str, row: int, content: str) -> Spoil:
    """Return what sets one cell, in a row counted from 1."""

    def spoil(columns: Columns) -> None:
        columns[name][row - 1] = content

    return spoil


def without(*names: str) -> Spoil:
    """Return what drops columns."""

    def spoil(columns: Columns) -> None:
        for name in names:
            del columns[name]

    return spoil


def rows(count: int, *dropped: str) -> Spoil:
    """Return what keeps the first rows alone."""

    def spoil(columns: Columns) -> None:
        without(*dropped)(columns)
        for name in columns:
            del columns[name][count:]

    return spoil


def one_pose(columns: Columns) -> None:
    for name in ("x_m", "y_m", "z_m"):
        columns[name] = columns[name][:1] * N_ROWS


def one_cable_more(columns: Columns) -> None:
    columns["length_4_m"] = columns["length_1_m"]


def in_millimetres(columns: Columns) -> None:
    scaled(columns, LENGTHS, 1e3)


def one_in_millimetres(columns: Columns) -> None:
    scaled(columns, LENGTHS[1:2], 1e3)


def positions_in_millimetres(columns: Columns) -> None:
    scaled(columns, ("x_m", "y_m", "z_m"), 1e3)


def in_another_frame(columns: Columns) -> None:
    columns["z_m"] = [f"{40.0 + float(z):.6f}" for z in columns["z_m"]]


def exchanged(columns: Columns) -> None:
    columns["length_1_m"], columns["length_3_m"] = columns["length_3_m"], columns["length_1_m"]


def backwards(columns: Columns) -> None:
    scaled(columns, LENGTHS[:1], -1.0)


def pushing(columns: Columns) -> None:
    scaled(columns, TENSIONS[1:2], -1.0)


def in_kilonewtons(columns: Columns) -> None:
    scaled(columns, TENSIONS, 1e-3)


def in_kelvin(columns: Columns) -> None:
    columns["temperature_C"] = [f"{290.0 + 0.1 * row:.2f}" for row in range(N_ROWS)]


def nothing_below(columns: Columns) -> None:
    for cells in columns.values():
        cells.clear()


_MANY = "  unknown: [anchors, length_offset, base_tilt, creep, drum_layering, drum_scale,\n"
_MANY += "    elastic_modulus, linear_mass, platform_mass, pulley_radius]\n"
_FINITE = "(expected a finite number, or nothing where there is none)"
_METRES = "(expected metres, or the unit in measurements.columns)"
_MAPPED = "is missing (expected a column of this name, or one mapped onto it in"


@pytest.mark.parametrize(
    ("spoil", "more", "lines"),
    [
        pytest.param(
            without("y_m", "length_2_m"),
            "",
            [f"log.csv:1: y_m: {_MAPPED}", f"log.csv:1: length_2_m: {_MAPPED}"],
            id="columns missing",
        ),
        pytest.param(
            cell("length_1_m", 7, "abc"),
            "",
            ["log.csv:8: length_1_m: row 7 has the text 'abc' (expected a number, or nothing"],
            id="text in a numeric column",
        ),
        pytest.param(
            rows(10, *TENSIONS),
            _MANY,
            ["log.csv: 24 readings to fit, after holding some out, for 25 unknowns"],
            id="fewer rows than parameters",
        ),
        pytest.param(
            rows(4),
            "",
            ["log.csv: 4 of 4 rows have a pose and a reading (expected at least 8 rows)"],
            id="few rows",
        ),
        pytest.param(
            one_pose,
            "",
            ["log.csv: all rows are at one pose, so nothing can be told apart (expected"],
            id="one pose",
        ),
        pytest.param(
            cell("time_s", 13, "100"),
            "",
            ["log.csv:14: time_s: row 13 has 100 s, before row 12 with 660 s (expected"],
            id="time backwards",
        ),
        pytest.param(
            in_millimetres,
            "",
            [
                "log.csv:1: length_1_m, length_2_m, length_3_m: lengths change about 1000 times",
                _METRES,
            ],
            id="lengths in millimetres",
        ),
        pytest.param(
            in_millimetres,
            "  unknown: [length_offset]\n",
            [
                "log.csv:1: length_1_m, length_2_m, length_3_m: lengths change about 1000 times",
                _METRES,
            ],
            id="lengths in millimetres, offsets unknown",
        ),
        pytest.param(
            one_in_millimetres,
            "",
            [
                "log.csv:1: length_2_m: lengths change about 1000 times",
                "were in millimetres",
                _METRES,
            ],
            id="one length in millimetres",
        ),
        pytest.param(
            positions_in_millimetres,
            "",
            ["log.csv:1: x_m, y_m, z_m: the lengths change about 0.0011 times as much", _METRES],
            id="positions in millimetres",
        ),
        pytest.param(
            in_another_frame,
            "",
            ["log.csv: the robot as declared can hold 0 of 32 poses (expected poses between"],
            id="another frame",
        ),
        pytest.param(
            one_cable_more,
            "",
            ["log.csv:1: length_4_m: there is no such cable, the robot has 3 (expected cables 1"],
            id="a cable too many",
        ),
        pytest.param(
            exchanged,
            "  unknown: [length_offset, drum_scale]\n",
            [
                "log.csv:1: length_1_m: follows the distance to exit point 3, not to 1 (expected",
                "log.csv:1: length_3_m: follows the distance to exit point 1, not to 3 (expected",
                "in the order of robot.anchors, or names in measurements.columns)",
            ],
            id="cables exchanged",
        ),
        pytest.param(
            backwards,
            "",
            ["log.csv:1: length_1_m: falls as the distance to its exit point grows (expected"],
            id="a length with the wrong sign",
        ),
        pytest.param(
            cell("length_2_m", 7, "-3"),
            "",
            ["log.csv:8: length_2_m: row 7 has the length -3 m (expected more than 0; or"],
            id="a negative length",
        ),
        pytest.param(
            pushing,
            "",
            ["log.csv:1: tension_2_N: is -", "but no cable can push (expected a pull, or"],
            id="a tension with the wrong sign",
        ),
        pytest.param(
            in_kilonewtons,
            "",
            [
                "log.csv:1: tension_1_N … tension_3_N: the tensions add up to ",
                "but hold a load of 1766 N (expected newtons, or the unit in",
            ],
            id="tensions in kilonewtons",
        ),
        pytest.param(
            in_kelvin,
            "",
            [
                "log.csv:1: temperature_C: the temperature is about 291.6, as if it were in kelvin",
                "(expected °C, or {to: temperature_C, unit: K} in measurements.columns)",
            ],
            id="temperature in kelvin",
        ),
        pytest.param(
            nothing_below,
            "",
            ["log.csv: there are no rows (expected at least 8 rows)"],
            id="head only",
        ),
        pytest.param(
            cell("length_1_m", 7, "inf"),
            "",
            [f"log.csv:8: length_1_m: row 7 has the value inf {_FINITE}"],
            id="infinite",
        ),
        pytest.param(
            cell("y_m", 7, "NaN"),
            "",
            ["log.csv:8: y_m: row 7 has half a pose, this is missing (expected all of it"],
            id="not a number in a pose",
        ),
    ],
)
def test_a_fault_is_one_line_and_nothing_is_written(
    spoil: Spoil,
    more: str,
    lines: list[str],
    good: Columns,
    diagnose: Callable[..., Outcome],
) -> None:
    columns = {name: list(cells) for name, cells in good.items()}
    spoil(columns)
    refused(diagnose(text(columns), more), lines)


def test_columns_with_one_name(good: Columns, diagnose: Callable[..., Outcome]) -> None:
    raw = b"\n".join(line + b",1" for line in text(good).splitlines()).replace(b"N,1", b"N,x_m", 1)
    wanted = ["log.csv:1: x_m: columns 2 and 11 have the same name (expected a name for each"]
    refused(diagnose(raw), wanted)


@pytest.mark.parametrize(
    ("raw", "line"),
    [
        (b"", "log.csv: the file is empty (expected a CSV file: names of columns in its first"),
        ("größe_m\n".encode("latin-1"), "log.csv:1: this is not text in UTF-8 (expected a CSV"),
    ],
    ids=["empty", "not UTF-8"],
)
def test_what_is_no_table(raw: bytes, line: str, diagnose: Callable[..., Outcome]) -> None:
    refused(diagnose(raw), [line])


def refused(told: Outcome, lines: list[str]) -> None:
    """Check that each text is in the message, in as many lines as start with the file's name."""
    assert told.status == 2
    assert told.out == ""
    assert "Traceback" not in told.err
    said = told.err.splitlines()
    assert len(said) == sum(line.startswith("log.csv") for line in lines), told.err
    assert all(line.startswith("log.csv") for line in said)
    for line in lines:
        assert line in told.err
    assert {path.name for path in Path().iterdir()} == {"robot.yaml", "log.csv"}


@pytest.mark.slow
def test_what_is_left_out_is_said_in_page_and_json(
    good: Columns, diagnose: Callable[..., Outcome]
) -> None:
    """Constant columns, a gap, and effects that lack a column, are no faults but told."""
    columns = {name: list(cells) for name, cells in good.items()}
    columns["temperature_C"] = ["20"] * N_ROWS
    columns["battery_V"] = ["12.4"] * N_ROWS
    columns["length_1_m"][6] = "NaN"
    told = diagnose(text(columns))
    assert told.status == 0, told.err
    folder = Path("robot-diagnosis")
    answer = json.loads((folder / "diagnosis.json").read_text(encoding="utf-8"))
    page = " ".join((folder / "diagnosis.html").read_text(encoding="utf-8").split())
    notes = [
        "temperature_C left out, the same in all rows",
        "left out, since they are the same in all rows: battery_V",
    ]
    for note in notes:
        assert note in answer["rows"]["notes"]
        assert note in page
    skipped = {one["id"]: one["reason"] for one in answer["skipped"]}
    assert skipped["thermal_expansion"] == "needs a column temperature_C that varies"
    assert "wind_x_m_per_s" in skipped["wind_drag"]
    for name, reason in skipped.items():
        assert name in page
        assert reason in page
    assert answer["rows"]["fit"] + answer["rows"]["heldout"] == N_ROWS
    assert answer["effects"] == []
