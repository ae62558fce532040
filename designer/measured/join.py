"""Files of one machine, each with its own rate, as one table: joined by their times."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from designer.arrays import FloatArray
from designer.errors import Fault
from designer.measured.assign import POSITION, TIME_NAME, Assigned, is_rotation
from designer.measured.rows import time_faults

_REACH, _GAP = 0.75, 10.0
"""How far a sample is used, in usual steps of its file: at rest, when the next should have come
before; in motion, between two that are not too far apart to go straight from one to the other."""


def joined(parts: Sequence[Assigned], *, settled: bool) -> Assigned:
    """Return the table of the file with the positions, with the columns of the others.

    Of poses at rest, the nearest sample in time, since the platform moves between them; of a
    motion, the straight line between the samples before and after.
    """
    first = next((part for part in parts if not part.ours.keys().isdisjoint(POSITION)), parts[0])
    others = [part for part in parts if part is not first]
    if not others:
        return first
    for part in parts:
        first.faults.extend(_time_faults(part))
    if first.faults or any(part.faults or part.table.faults for part in others):
        first.faults.extend(
            fault for part in others for fault in (*part.table.faults, *part.faults)
        )
        first.awaited.update(name for part in others for name in (*part.ours, *part.awaited))
        return first
    for part in others:
        _take(first, part, settled=settled)
    digests = "".join(part.table.sha256 for part in parts)
    sha256 = hashlib.sha256(digests.encode()).hexdigest()
    return replace(first, table=replace(first.table, sha256=sha256))


def _time_faults(part: Assigned) -> Iterator[Fault]:
    time = part.ours.get(TIME_NAME)
    if time is None:
        expected = "one in each file, or a column mapped onto it in measurements.columns"
        yield part.table.fault(None, TIME_NAME, "is missing, and joins the files", expected)
    else:
        every_row = np.ones(part.table.n_rows, dtype=np.bool_)
        yield from time_faults(part.table, time, every_row, settled=True)


def _take(first: Assigned, part: Assigned, *, settled: bool) -> None:
    """Give the columns of another file to the first, at its times."""
    first.notes.extend(part.notes)
    time, own = first.ours[TIME_NAME].values, part.ours[TIME_NAME].values
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
            values = _at(time, own, column.values, settled=settled)
            first.ours[name] = replace(column, values=values)
            if np.isnan(values).all() and not column.is_empty:
                problem = f"has no time near those of {first.table.name}"
                expected = "times of one clock in all files"
                first.faults.append(part.table.fault(None, TIME_NAME, problem, expected))
                first.awaited.update(part.ours)
                return
    for name, column in part.covariates.items():
        unique = f"{Path(part.table.name).stem}.{name}" if name in names else name
        values = _at(time, own, column.values, settled=settled)
        first.covariates[unique] = replace(column, name=unique, values=values)
    how = "nearest sample" if settled else "straight line between samples"
    first.notes.append(f"{part.table.name} joined by time, each row with its {how}")


def _at(time: FloatArray, own: FloatArray, values: FloatArray, *, settled: bool) -> FloatArray:
    """Return values, which a file has at its own times, at other times; NaN where none is near."""
    is_there = np.isfinite(own) & ~np.isnan(values)
    own, values = own[is_there], values[is_there]
    if len(own) < 2:
        return np.full(len(time), np.nan)
    step = float(np.median(np.diff(own)))
    after = np.clip(np.searchsorted(own, time), 1, len(own) - 1)
    nearest = after - (time - own[after - 1] < own[after] - time)
    distance = np.abs(own[nearest] - time)
    if settled:
        return np.where(distance <= _REACH * step, values[nearest], np.nan)
    between = np.interp(time, own, values, left=np.nan, right=np.nan)
    return np.where((np.diff(own)[after - 1] <= _GAP * step) | (distance == 0.0), between, np.nan)
