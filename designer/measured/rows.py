"""Which rows of a table can be used, what is wrong in the others, and rows of several files as one.

Files of one machine, each with its own rate, are joined by their times.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from designer.arrays import BoolArray, FloatArray, IntArray
from designer.documents.columns import (
    POSITION,
    TIME_NAME,
    dimension_of,
    is_rotation,
    length_names,
    tension_names,
)
from designer.documents.table import MOST_ALIKE, LogTable, RawColumn, is_number
from designer.errors import Fault
from designer.measured.assign import Assigned
from designer.model.measurements import POSES, Measurements
from designer.spelling import in_runs
from designer.units import ANGLE, FORCE, LENGTH, NUMBER, SPEED, TEMPERATURE, describe

FEWEST_ROWS = 8
"""A quarter is held out from every fit, and what is left has to show more than its noise."""
MOST_ROWS = 10_000
"""As many are diagnosed: more would tell no more of an effect, and take time and memory."""
_RUN = 50
"""Poses at rest that follow one another: in which direction a cable has moved shows between two."""
_LARGEST_NUMBER = 1e30
EPOCH_S = 1e8
"""Times from here on are counted from 1970: no log counts three years from its own start."""
_LONGEST_LOG_S = 3.2e8
_DATES_S = (-62_135_596_800.0, 253_402_300_799.0)  # from the year 1 to the end of 9999
_SMALL_UNITS = {
    "ms": ("milliseconds", 1e3),
    "us": ("microseconds", 1e6),
    "ns": ("nanoseconds", 1e9),
}
_MAP = "measurements.columns"
_BOUNDS = {
    LENGTH: (-1e7, 1e7),  # these three as in the config
    FORCE: (-1e20, 1e20),
    ANGLE: (-2.0 * math.pi, 2.0 * math.pi),
    TEMPERATURE: (-273.15, 1e4),
    SPEED: (-1e3, 1e3),
}


@dataclass(frozen=True, slots=True, eq=False)
class Rows:
    """The rows of a table that can be used."""

    kept: BoolArray  #: (n_rows,): those with a pose and at least one reading
    faults: list[Fault]  #: rows with half a pose, without their time, or out of order; too few rows
    notes: list[str]  #: rows that were left out, and why
    thinned: str = ""  #: which of a long log are used, in words; empty where all are


def is_numeric(column: RawColumn) -> bool:
    """Return whether a column holds numbers in the main."""
    return column.n_numbers > 0 and column.n_numbers >= column.n_texts


def cell_faults(assigned: Assigned) -> list[Fault]:
    """Return what is wrong in single cells: texts and numbers beyond all bounds."""
    numeric = [("", column) for column in assigned.covariates.values() if is_numeric(column)]
    columns = [*assigned.ours.items(), *numeric]
    faults: list[Fault] = []
    total = 0
    for name, column in columns:
        dimension = dimension_of(name) or NUMBER  # a covariate has no name of ours
        low, high = _BOUNDS.get(dimension, (-_LARGEST_NUMBER, _LARGEST_NUMBER))
        rows = np.flatnonzero((column.values < low) | (column.values > high))
        total += len(rows)
        for row in rows[:MOST_ALIKE]:
            value = float(column.values[row])
            expected = f"{low:g} to {high:g} {dimension.unit}; units go into measurements.columns"
            if abs(value) > _LARGEST_NUMBER:
                expected = "a finite number, or nothing where there is none"
            problem = f"has the value {value:g}"
            faults.append(assigned.table.fault(int(row), column.name, problem, expected))
    wild = assigned.table.first_few(faults, total, "values out of all bounds")
    wild += [
        assigned.table.fault(
            cell.row, column.name, f"has the time {describe(cell.text)}", "a number"
        )
        for name, column in assigned.ours.items()
        if name != TIME_NAME and (cell := column.first_time)
    ]
    return [*_text_faults(assigned, [column for _, column in columns]), *wild]


def usable_rows(assigned: Assigned, n_cables: int, measurements: Measurements) -> Rows:
    """Return which rows have a pose and a reading.

    Columns that are missing are not told again.
    """
    every_row = np.ones(assigned.table.n_rows, dtype=np.bool_)
    has_pose, faults = _with_pose(assigned) if measurements.has_poses else (every_row, [])
    has_reading = np.ones_like(has_pose)
    if readings := assigned.present(length_names(n_cables) + tension_names(n_cables)):
        has_reading = ~np.all([np.isnan(column.values) for column in readings], axis=0)
    is_usable = has_pose & has_reading
    notes = [
        f"{_row_list(np.flatnonzero(left_out) + 1)} without {lack} left out"
        for left_out, lack in ((~has_pose, "a pose"), (has_pose & ~has_reading, "any reading"))
        if left_out.any()
    ]
    if time := assigned.ours.get(TIME_NAME):
        faults += time_faults(assigned.table, time, is_usable, settled=measurements.settled)
    if is_usable.sum() < FEWEST_ROWS:
        total = assigned.table.n_rows
        problem = f"{is_usable.sum()} of {total} rows have a pose and a reading"
        problem = problem if total else "there are no rows"
        expected = f"at least {FEWEST_ROWS} rows"
        faults.append(Fault(assigned.table.name, None, "", problem, expected))
    return Rows(is_usable, faults, notes)


def thinned(rows: Rows, *, settled: bool) -> Rows:
    """Return about `MOST_ROWS` of the rows, from all over the log.

    Samples of a motion: evenly apart. Poses at rest: runs of neighbours, one somewhere in each of
    equal stretches, so that no programme that is driven again and again hides the rest of it.
    """
    usable = np.flatnonzero(rows.kept)
    every = -(-len(usable) // MOST_ROWS)
    if every == 1:
        return rows
    run = _RUN if settled else 1
    stretch, turn = np.divmod(np.arange(len(usable)) // run, every)
    chosen = np.random.default_rng(0).integers(every if settled else 1, size=stretch[-1] + 1)
    used = usable[turn == chosen[stretch]]
    mask = np.zeros_like(rows.kept)
    mask[used] = True
    which = f"{run} rows of each {run * every}" if settled else f"one row of each {every}"
    text = f"{len(used)} of {len(usable)} rows are used, {which}: so many tell as much"
    return replace(rows, kept=mask, notes=[*rows.notes, text], thinned=text)


def _text_faults(assigned: Assigned, columns: list[RawColumn]) -> list[Fault]:
    with_text = [column for column in columns if column.n_texts]
    faults = []
    for column in with_text:
        for cell in column.texts:
            expected = "a number, or nothing where there is none"
            if column is assigned.ours.get(TIME_NAME):
                expected = "a number, or a time such as 2026-05-03T10:00:00.5Z"
            if "," in cell.text and is_number(cell.text.replace(",", "")):
                expected = "a number with a decimal point and without commas"
            problem = f"has the text {describe(cell.text)}"
            faults.append(assigned.table.fault(cell.row, column.name, problem, expected))
    total = sum(column.n_texts for column in columns)
    return assigned.table.first_few(faults, total, "cells with a text")


def _with_pose(assigned: Assigned) -> tuple[BoolArray, list[Fault]]:
    """Return which rows have a pose, and the faults of those that have half of one."""
    table = assigned.table
    columns = assigned.present((*POSITION, *assigned.rotation)) if table.n_rows else []
    empty = [column for column in columns if column.is_empty]
    faults = [table.fault(None, column.name, "is empty", "a pose in each row") for column in empty]
    filled = [column for column in columns if not column.is_empty and not column.n_texts]
    if not filled:
        return np.ones(table.n_rows, dtype=np.bool_), faults
    missing = np.array([np.isnan(column.values) for column in filled])
    has_pose = np.asarray(~missing.all(axis=0))
    places = np.argwhere(missing & has_pose)
    problem = "has half a pose, this is missing"
    expected = (
        f"all of it, or nothing; or 'unknown: [{POSES}]' with noise: {{position: …, rotation: …}}, "
        "which estimates what is missing"
    )
    halves = (table.fault(int(row), filled[k].name, problem, expected) for k, row in places)
    return has_pose, faults + table.first_few(halves, len(places), "missing values")


def time_faults(
    table: LogTable, time: RawColumn, mask: BoolArray, *, settled: bool
) -> Iterator[Fault]:
    """Yield rows without their time, another unit than seconds, and rows out of order."""
    if not (time.is_empty or time.n_texts):
        rows = np.flatnonzero(np.isnan(time.values) & mask)
        expected = "a time in each row, or in none"
        missing = (table.fault(int(row), time.name, "has no time", expected) for row in rows)
        yield from table.first_few(missing, len(rows), "rows without a time")
    rows = np.flatnonzero(mask & np.isfinite(time.values))
    values = time.values[rows]
    for unit, (called, factor) in _SMALL_UNITS.items():
        if len(rows) and EPOCH_S <= values[0] / factor < 100.0 * EPOCH_S:
            problem = f"has {values[0]:.4g} s, as if it were {called} since 1970"
            expected = f"seconds, or {{to: {TIME_NAME}, unit: {unit}}}"
            yield table.fault(int(rows[0]), time.name, problem, f"{expected} in {_MAP}")
            return
    if len(rows) and np.ptp(values) > _LONGEST_LOG_S:
        problem = f"spans {np.ptp(values):.4g} s, which is more than ten years"
        expected = f"seconds, or another unit as {{to: {TIME_NAME}, unit: ns}} in {_MAP}"
        yield table.fault(None, time.name, problem, expected)
        return
    beyond = np.flatnonzero((values < _DATES_S[0]) | (values > _DATES_S[1]))
    if len(beyond) and (values[0] >= EPOCH_S or time.first_time):
        problem = f"has {values[beyond[0]]:.4g} s since 1970, which is no date"
        expected = f"the years 1 to 9999, or another unit as {{to: {TIME_NAME}, unit: ns}}"
        yield table.fault(int(rows[beyond[0]]), time.name, problem, f"{expected} in {_MAP}")
        return
    if not settled and len(rows) and np.ptp(values) == 0.0:
        expected = "a time that grows, or no such column"
        yield table.fault(None, time.name, "is the same in all rows", expected)
        return
    faults = []
    places = np.flatnonzero(np.diff(values) < 0.0 if settled else np.diff(values) <= 0.0)
    for place in places[:MOST_ALIKE]:
        earlier, at = values[place : place + 2]
        how = "the same time as" if at == earlier else "before"
        problem = f"has {_written(at, time)}, {how} row {rows[place] + 1}"
        if at != earlier:
            problem += f" with {_written(earlier, time)}"
        expected = "rows in the order of their time"
        faults.append(table.fault(int(rows[place + 1]), time.name, problem, expected))
    yield from table.first_few(faults, len(places), "rows out of order")


def _written(time_s: float, column: RawColumn) -> str:
    """Return a time as the column has it."""
    return utc(time_s) if column.first_time else f"{time_s:.15g} s"


def utc(time_s: float) -> str:
    """Return a time in seconds since 1970 as ISO 8601 has it."""
    return datetime.fromtimestamp(time_s, UTC).isoformat().replace("+00:00", "Z")


def _row_list(rows: IntArray) -> str:
    """Return row numbers in words, neighbours together: ``row 3``, ``rows 1 to 4, 9``."""
    runs = in_runs(rows)
    more = ["…"] * (len(runs) > MOST_ALIKE)
    return f"row{'s' * (len(rows) != 1)} {', '.join(runs[:MOST_ALIKE] + more)}"


# Files joined by their times.

_REACH, _GAP = 0.75, 10.0
"""How far a sample is used, in usual steps of its file: at rest, when the next should have come
before; in motion, between two that are not too far apart to go straight from one to the other."""


def joined(parts: Sequence[Assigned], *, settled: bool) -> Assigned:
    """Return the table of the file with the positions, with the columns of the others.

    Of poses at rest, the nearest sample in time, since the platform moves between them; of a
    motion, the straight line between the samples before and after.
    """
    first = next((part for part in parts if not part.ours.keys().isdisjoint(POSITION)), parts[0])
    further = [part for part in parts if part is not first]
    if not further:
        return first
    for part in parts:
        time = part.ours.get(TIME_NAME)
        if time is None:
            expected = "one in each file, or a column mapped onto it in measurements.columns"
            problem = "is missing, and joins the files"
            first.faults.append(part.table.fault(None, TIME_NAME, problem, expected))
        else:
            every_row = np.ones(part.table.n_rows, dtype=np.bool_)
            first.faults.extend(time_faults(part.table, time, every_row, settled=True))
    if first.faults or any(part.faults or part.table.faults for part in further):
        first.faults.extend(
            fault for part in further for fault in (*part.table.faults, *part.faults)
        )
        first.awaited.update(name for part in further for name in (*part.ours, *part.awaited))
        return first
    for part in further:
        _join_columns(first, part, settled=settled)
    digests = "".join(part.table.sha256 for part in parts)
    sha256 = hashlib.sha256(digests.encode()).hexdigest()
    return replace(first, table=replace(first.table, sha256=sha256))


def _join_columns(first: Assigned, part: Assigned, *, settled: bool) -> None:
    """Give the columns of another file to the first, at its times."""
    first.notes.extend(part.notes)
    time, part_time = first.ours[TIME_NAME].values, part.ours[TIME_NAME].values
    names = {column.name for column in first.table.columns}
    for name, column in part.ours.items():
        if name == TIME_NAME:
            continue
        if name in first.ours:
            problem = f"{first.table.name} has {name} as well"
            first.faults.append(part.table.fault(None, column.name, problem, "it in one file"))
        elif is_rotation(name) and not settled:
            problem = f"is an orientation, and the positions are in {first.table.name}"
            expected = "both in one file: angles are not interpolated"
            first.faults.append(part.table.fault(None, column.name, problem, expected))
        else:
            values = _sampled_at(time, part_time, column.values, settled=settled)
            first.ours[name] = replace(column, values=values)
            if np.isnan(values).all() and not column.is_empty:
                problem = f"has no time near those of {first.table.name}"
                expected = "times of one clock in all files"
                first.faults.append(part.table.fault(None, TIME_NAME, problem, expected))
                first.awaited.update(part.ours)
                return
    for name, column in part.covariates.items():
        unique = f"{Path(part.table.name).stem}.{name}" if name in names else name
        values = _sampled_at(time, part_time, column.values, settled=settled)
        first.covariates[unique] = replace(column, name=unique, values=values)
    how = "nearest sample" if settled else "straight line between samples"
    first.notes.append(f"{part.table.name} joined by time, each row with its {how}")


def _sampled_at(
    time: FloatArray, file_time: FloatArray, values: FloatArray, *, settled: bool
) -> FloatArray:
    """Return values, which a file has at its own times, at other times; NaN where none is near."""
    is_there = np.isfinite(file_time) & ~np.isnan(values)
    file_time, values = file_time[is_there], values[is_there]
    if len(file_time) < 2:
        return np.full(len(time), np.nan)
    step = float(np.median(np.diff(file_time)))
    after = np.clip(np.searchsorted(file_time, time), 1, len(file_time) - 1)
    nearest = after - (time - file_time[after - 1] < file_time[after] - time)
    distance = np.abs(file_time[nearest] - time)
    if settled:
        return np.where(distance <= _REACH * step, values[nearest], np.nan)
    between = np.interp(time, file_time, values, left=np.nan, right=np.nan)
    return np.where(
        (np.diff(file_time)[after - 1] <= _GAP * step) | (distance == 0.0), between, np.nan
    )
