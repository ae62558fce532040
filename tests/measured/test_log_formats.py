"""One log in all the formats that labs write."""

from __future__ import annotations

import numpy as np
import pytest
from measured_log import Log

from designer.model.measured_data import Measured


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
    log.rows.insert(0, ["s", "m", "m", "m", "m", "m", "m", "N", "N", "kN"])
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
