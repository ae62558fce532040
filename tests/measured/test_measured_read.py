"""What a log becomes."""

from __future__ import annotations

import numpy as np
import pytest
from measured_log import Log
from scipy.spatial.transform import Rotation

from designer.measured import rows

RISING = [f"{value:.2f}" for value in np.linspace(15.0, 25.0, 30)]


def test_standard_columns_are_taken_as_they_are(log: Log) -> None:
    found = log.read()
    assert found.n_rows == 30
    assert found.settled
    np.testing.assert_array_equal(found.time_s, np.arange(0.0, 300.0, 10.0))
    position = np.stack([log.numbers(name) for name in ("x_m", "y_m", "z_m")], axis=1)
    np.testing.assert_array_equal(found.poses.position_m, position)
    np.testing.assert_array_equal(found.poses.rotation, np.eye(3))
    np.testing.assert_array_equal(found.length_m[:, 1], log.numbers("length_2_m"))
    np.testing.assert_array_equal(found.tension_N[:, 2], log.numbers("tension_3_N"))
    np.testing.assert_array_equal(found.row_numbers, np.arange(1, 31))
    assert found.temperature_C is None
    assert found.wind_m_per_s is None
    assert found.covariates == {}
    assert found.notes == ()
    assert found.columns == {"time"}


def test_arrays_are_read_only(log: Log) -> None:
    log.add("battery_V", RISING)
    found = log.read()
    assert found.time_s is not None
    floats = (found.length_m, found.tension_N, found.time_s, found.covariates["battery_V"])
    for array in (*floats, found.row_numbers):
        assert not array.flags.writeable


def test_the_order_of_the_columns_does_not_matter(log: Log) -> None:
    before = log.read()
    log.names.reverse()
    for row in log.rows:
        row.reverse()
    np.testing.assert_array_equal(log.read().length_m, before.length_m)


@pytest.mark.parametrize("kind", ["length", "tension"])
def test_lengths_or_tensions_alone_are_enough(log: Log, kind: str) -> None:
    unit = {"length": "m", "tension": "N"}[kind]
    log.drop(*(f"{kind}_{cable}_{unit}" for cable in (1, 2, 3)))
    found = log.read()
    absent, present = found.length_m, found.tension_N
    if kind == "tension":
        absent, present = present, absent
    assert absent.shape == present.shape == (30, 3)
    assert np.isnan(absent).all()
    assert np.isfinite(present).all()


@pytest.mark.parametrize("cell", ["", " ", "nan", "NaN", "NA", "-nan"])
def test_a_missing_reading_is_nan(log: Log, cell: str) -> None:
    log.set(4, "length_2_m", cell)
    found = log.read()
    assert np.isnan(found.length_m[3, 1])
    assert np.isnan(found.length_m).sum() == 1
    assert found.notes == ()


def test_a_load_cell_that_never_reads_is_noted(log: Log) -> None:
    for row in range(1, 31):
        log.set(row, "tension_2_N", "")
    found = log.read()
    assert np.isnan(found.tension_N[:, 1]).all()
    assert found.notes == ("tension_2_N has no reading",)


def test_rows_without_pose_or_reading_are_left_out_and_noted(log: Log) -> None:
    for name in ("x_m", "y_m", "z_m"):
        for row in (3, 4, 5, 9):
            log.set(row, name, "")
    for name in log.names[4:]:
        log.set(7, name, "NA")
    found = log.read()
    assert found.n_rows == 25
    assert found.row_numbers[:5].tolist() == [1, 2, 6, 8, 10]
    assert found.length_m[2, 0] == float(log.cell(6, "length_1_m"))
    assert found.notes == (
        "rows 3 to 5, 9 without a pose left out",
        "row 7 without any reading left out",
    )


def test_surroundings(log: Log) -> None:
    log.add("temperature_C", RISING)
    log.add("wind_x_m_per_s", RISING)
    log.add("wind_y_m_per_s", "2")
    log.add("wind_z_m_per_s", "0")
    found = log.read()
    np.testing.assert_allclose(found.temperature_C, np.linspace(15, 25, 30), atol=0.005)
    assert found.wind_m_per_s is not None
    np.testing.assert_array_equal(found.wind_m_per_s[:, 0], found.temperature_C)
    assert set(found.wind_m_per_s[:, 1]) == {2.0}
    assert found.columns == {"time", "temperature", "wind"}
    assert found.notes == ()


def test_what_is_the_same_in_all_rows_tells_nothing_and_is_noted(log: Log) -> None:
    log.drop("time_s")
    log.add("time_s", "7")
    log.add("temperature_C", "20")
    for axis in "xyz":
        log.add(f"wind_{axis}_m_per_s", "1")
    log.add("battery_V", "12")
    log.add("rate_Hz", "4")
    found = log.read()
    assert found.columns == frozenset()
    assert found.covariates == {}
    assert found.notes == (
        "time_s left out, the same in all rows",
        "temperature_C left out, the same in all rows",
        "wind_x_m_per_s, wind_y_m_per_s, wind_z_m_per_s left out, the same in all rows",
        "left out, since they are the same in all rows: battery_V, rate_Hz",
    )


def test_constancy_is_judged_on_the_rows_that_are_used(log: Log) -> None:
    log.add("mode", ["1"] * 29 + ["2"])
    for name in ("x_m", "y_m", "z_m"):
        log.set(30, name, "")
    assert log.read().covariates == {}


def test_gaps_in_the_temperature_are_bridged_in_time_and_noted(log: Log) -> None:
    log.add("temperature_C", [20.0 + row for row in range(30)])
    log.set(11, "time_s", "91")
    for row in (1, 11):
        log.set(row, "temperature_C", "")
    found = log.read()
    assert found.temperature_C is not None
    assert found.temperature_C[0] == 21.0
    assert found.temperature_C[10] == pytest.approx(29.0 + 2.0 * 1.0 / 20.0)
    assert found.notes == ("temperature_C is missing in 2 rows and taken from those around",)


def test_a_wind_without_its_vertical_component_is_horizontal(log: Log) -> None:
    log.add("wind_x_m_per_s", RISING)
    log.add("wind_y_m_per_s", RISING)
    found = log.read()
    assert found.wind_m_per_s is not None
    assert not found.wind_m_per_s[:, 2].any()
    assert found.notes == ("the wind is taken as horizontal: there is no wind_z_m_per_s",)


def test_half_a_wind_is_a_covariate(log: Log) -> None:
    log.add("wind_y_m_per_s", RISING)
    found = log.read()
    assert found.wind_m_per_s is None
    assert list(found.covariates) == ["wind_y_m_per_s"]
    assert found.notes == ("the wind is not used as such: there is no wind_x_m_per_s",)


def test_a_wind_with_an_empty_component_is_left_out(log: Log) -> None:
    log.add("wind_x_m_per_s", RISING)
    log.add("wind_y_m_per_s", "")
    found = log.read()
    assert found.wind_m_per_s is None
    assert found.notes[-1] == "wind_x_m_per_s, wind_y_m_per_s left out, one is empty"


def test_every_other_numeric_column_is_a_covariate(log: Log) -> None:
    log.add("battery V", RISING)
    log.add("Längengeber", ["" if row % 2 else str(row) for row in range(30)])
    log.add("source", "camera")
    log.add("remark", "")
    log.add("", [f"note {row}" for row in range(30)])
    found = log.read()
    assert list(found.covariates) == ["battery V", "Längengeber"]
    assert np.isnan(found.covariates["Längengeber"]).sum() == 15
    assert found.notes == (
        "column 15 has no name and was left out",
        "left out, since they hold text: source",
        "left out, since they are empty: remark",
    )


def test_labels_with_digits_are_text_not_numbers(log: Log) -> None:
    log.add("label", [f"1_{row}" for row in range(30)])
    found = log.read()
    assert found.covariates == {}
    assert found.notes == ("left out, since they hold text: label",)


def test_settled_poses_may_have_the_same_time(log: Log) -> None:
    log.set(5, "time_s", "30")
    assert log.read().n_rows == 30


def test_a_moving_robot(log: Log) -> None:
    log.settled = False
    assert not log.read().settled


def test_the_map_gives_other_names_and_units(log: Log) -> None:
    reference = log.read()
    for row in range(1, 31):
        log.set(row, "x_m", 1000.0 * float(log.cell(row, "x_m")))
        log.set(row, "length_2_m", (float(log.cell(row, "length_2_m")) - 1.5) / 2e-4)
        log.set(row, "time_s", float(log.cell(row, "time_s")) / 60.0)
    log.rename("x_m", "camera x")
    log.rename("length_2_m", "motor")
    log.columns = (
        "{camera x: {to: x_m, unit: mm}, motor: {to: length_2_m, scale: 2e-4, offset: 150 cm}, "
        "time_s: {to: time_s, unit: min}}"
    )
    found = log.read()
    np.testing.assert_allclose(found.poses.position_m, reference.poses.position_m, rtol=1e-12)
    np.testing.assert_allclose(found.length_m, reference.length_m, rtol=1e-12)
    np.testing.assert_allclose(found.time_s, reference.time_s, rtol=1e-12)
    assert found.covariates == {}


def test_a_column_can_be_ignored_or_made_a_covariate(log: Log) -> None:
    log.add("camera x", [row + 0.5 for row in range(30)])
    log.add("length_9_m", RISING)
    log.columns = "{camera x: x_m, x_m: covariate, length_9_m: ignore}"
    found = log.read()
    np.testing.assert_array_equal(found.poses.position_m[:, 0], np.arange(30) + 0.5)
    np.testing.assert_array_equal(found.covariates["x_m"], log.numbers("x_m"))
    assert list(found.covariates) == ["x_m"]


def test_an_orientation_of_a_point_mass_is_left_out(log: Log) -> None:
    log.add("rx_rad", RISING)
    assert log.read().notes == ("rx_rad was left out: a point mass has no orientation",)


ANGLES = np.random.default_rng(2).uniform(-1.2, 1.2, (30, 3))
TURNS = Rotation.from_rotvec(ANGLES)


def about(axis: str, angle: float) -> np.ndarray:
    """Return the rotation about one axis, from its definition."""
    c, s = np.cos(angle), np.sin(angle)
    return {
        "x": np.array([[1, 0, 0], [0, c, -s], [0, s, c]]),
        "y": np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]),
        "z": np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]),
    }[axis]


def test_rotation_vectors(body: Log) -> None:
    for axis, angles in zip("xyz", ANGLES.T, strict=True):
        body.add(f"r{axis}_rad", list(angles))
    found = body.read()
    np.testing.assert_allclose(found.poses.rotation, TURNS.as_matrix(), atol=1e-14)
    assert found.length_m.shape == (30, 4)
    assert np.isnan(found.tension_N).all()


@pytest.mark.parametrize("size", [1.0, -1.0, 0.991, 1.009])
def test_quaternions_of_about_unit_length(body: Log, size: float) -> None:
    quaternions = size * TURNS.as_quat()
    for part, values in zip("xyzw", quaternions.T, strict=True):
        body.add(f"q{part}", list(values))
    body.columns = "{qw: quaternion_w, qx: quaternion_x, qy: quaternion_y, qz: quaternion_z}"
    np.testing.assert_allclose(body.read().poses.rotation, TURNS.as_matrix(), atol=1e-14)


@pytest.mark.parametrize("axes", ["xyz", "zyx", "zxz"])
@pytest.mark.parametrize("way", ["intrinsic", "extrinsic"])
def test_euler_angles_turn_about_the_axes_that_their_names_say(
    body: Log, axes: str, way: str
) -> None:
    for number, angles in enumerate(np.degrees(ANGLES).T, start=1):
        body.add(f"angle{number}", list(angles))
    entries = (f"angle{k}: {{to: euler_{way}_{axes}_{k}, unit: deg}}" for k in (1, 2, 3))
    body.columns = f"{{{', '.join(entries)}}}"
    found = body.read()
    for rotation, angles in zip(found.poses.rotation, ANGLES, strict=True):
        first, second, third = (about(*turn) for turn in zip(axes, angles, strict=True))
        # about axes that turn along, later turns stand to the right
        expected = first @ second @ third if way == "intrinsic" else third @ second @ first
        np.testing.assert_allclose(rotation, expected, atol=1e-14)


def test_a_body_that_only_turns_is_not_at_one_pose(body: Log) -> None:
    for axis, angles in zip("xyz", ANGLES.T, strict=True):
        body.add(f"r{axis}_rad", list(angles))
        for row in range(1, 31):
            body.set(row, f"{axis}_m", "1")
    assert body.read().n_rows == 30


@pytest.mark.parametrize(
    "change",
    [
        lambda raw: b"\xef\xbb\xbf" + raw,
        lambda raw: raw.replace(b"\n", b"\r\n"),
        lambda raw: raw.replace(b",", b" , "),
        lambda raw: raw.replace(b"\n", b"\n\n"),
        lambda raw: raw.rstrip(b"\n"),
        lambda raw: raw.replace(b"x_m", b'"x_m"'),
    ],
)
def test_ways_to_write_the_file(log: Log, change) -> None:  # type: ignore[no-untyped-def]
    expected = log.read()
    found = log.read(change(log.text().encode()))
    np.testing.assert_array_equal(found.length_m, expected.length_m)
    np.testing.assert_array_equal(found.row_numbers, expected.row_numbers)


def test_many_rows_are_read_in_blocks(log: Log) -> None:
    one = log.rows[0][1:]
    log.rows = [[str(row), str(row), *one[1:]] for row in range(10_000)]
    log.set(9_000, "length_1_m", "")
    found = log.read()
    np.testing.assert_array_equal(found.poses.position_m[:, 0], np.arange(10_000.0))
    assert np.flatnonzero(np.isnan(found.length_m[:, 0])).tolist() == [8_999]


@pytest.mark.parametrize("settled", [True, False])
def test_of_a_long_log_rows_from_all_over_it_are_used(
    log: Log, monkeypatch: pytest.MonkeyPatch, settled: bool
) -> None:
    monkeypatch.setattr(rows, "MOST_ROWS", 10)
    monkeypatch.setattr(rows, "_RUN", 2)
    log.settled = settled
    log.set(2, "x_m", "")
    log.set(2, "y_m", "")
    log.set(2, "z_m", "")
    measured = log.read()
    if settled:  # neighbours, of the 29 that have a pose
        among = np.delete(np.arange(1, 31), 1).tolist()
        at = [among.index(row) for row in measured.row_numbers]
        assert all(second == first + 1 for first, second in zip(at[::2], at[1::2], strict=False))
        assert [first // 6 for first in at[::2]] == [0, 1, 2, 3, 4][: len(at[::2])]
        assert f"{len(at)} of 29 rows are used, 2 rows of each 6" in measured.thinned
    else:
        assert measured.row_numbers.tolist() == [1, *range(5, 31, 3)]
        assert measured.thinned.startswith("10 of 29 rows are used, one row of each 3")
    assert measured.thinned in measured.notes
    assert measured.length_m[:, 0] == pytest.approx(
        log.numbers("length_1_m")[measured.row_numbers - 1]
    )


def test_rows_that_are_not_used_are_checked(log: Log, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rows, "MOST_ROWS", 10)
    log.settled = False
    log.set(3, "length_1_m", "wide")
    (fault,) = log.faults()
    assert fault.line == 4
