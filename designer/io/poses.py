"""Poses from a table: where a robot is to go."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np

from designer.arrays import FloatArray
from designer.documents.bounds import BOUNDS
from designer.documents.columns import (
    POSITION,
    ROTATION_VECTOR,
    cable_of,
    length_names,
    unit_faults,
)
from designer.documents.opened import open_input, reason
from designer.documents.table import LogTable, RawColumn, read_table
from designer.errors import Fault, InputError
from designer.model.robot import Poses, Robot
from designer.model.workspace import Workspace
from designer.study import Study

_OFF_PLANE = 1e-6
"""What counts as out of a planar robot's plane, over the extent of its exit points, or [rad]."""
_OURS = (*POSITION, *ROTATION_VECTOR)
_SHORTEST_M = 1e-3
_LOAD_CASE = "load_case"
TIME = "time_s"
_LATEST_S = 1e7
MAX_PATH_ROWS = 5000
"""Of a path: each takes poses of its own."""
ErrorOf = Callable[[str, str], InputError]
_OF_OPTION: ErrorOf = partial(InputError.at, "--poses")
MOST_POSES = 50_000


@dataclass(frozen=True, slots=True, eq=False)
class PoseTable:
    """Poses of a file."""

    names: tuple[str, ...]  #: Its columns of numbers, in the order of the file
    #: (n_poses, n_names): What stands there; NaN for nothing in columns that are none of ours
    values: FloatArray
    #: (n_poses, 3 or 6): Positions, and rotation vectors where the file has them [m, rad]
    places: FloatArray
    #: The load case that each pose is for, empty for all; none without that column
    load_cases: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()  #: Columns that hold texts
    sha256: str = ""  #: Digest of the file's bytes
    log: LogTable | None = None  #: As it was read, which tells the line of a fault

    @property
    def poses(self) -> Poses:
        """The poses (n_poses)."""
        return Poses.at(self.places)


def read_poses(path: Path, robot: Robot, error_of: ErrorOf = _OF_OPTION) -> PoseTable:
    """Return the poses in a CSV file for a robot.

    Its columns are ``x_m, y_m, z_m``, and ``rx_rad, ry_rad, rz_rad`` (a rotation vector) for a
    platform that turns; ``load_case`` may name the load case that a pose is for; others are
    carried along. ``error_of`` makes the error where the file cannot be opened.

    Raises
    ------
    InputError
        If it cannot be read, lacks a column or a value, has no row, or asks for what the robot
        cannot do: a point mass that turns, a planar robot out of its plane.
    """
    table, columns = _read(path, _OURS, _column_faults, error_of)
    turns = ROTATION_VECTOR if ROTATION_VECTOR[0] in columns else ()
    place = np.stack([columns[name].values for name in (*POSITION, *turns)], axis=1)
    faults = list(_robot_faults(table, robot, place))
    if faults:
        raise InputError(table.first_few(faults, len(faults), "of this kind"))
    return PoseTable(
        *_numbers(table),
        place,
        _load_cases(columns[_LOAD_CASE], table.n_rows) if _LOAD_CASE in columns else (),
        tuple(c.name for c in table.columns if c.n_texts and c.name != _LOAD_CASE),
        table.sha256,
        table,
    )


@dataclass(frozen=True, slots=True, eq=False)
class LengthTable:
    """Lengths of a file: its columns of numbers as in `PoseTable`, and ours of them."""

    names: tuple[str, ...]
    values: FloatArray
    length_m: FloatArray  # (n_rows, n_cables), unstrained
    left_out: tuple[str, ...]


def read_lengths(path: Path, n_cables: int) -> LengthTable:
    """Return the unstrained lengths in a CSV file, ``length_1_m`` and so on.

    Raises
    ------
    InputError
        If it cannot be read, lacks a column or a value, or has no row.
    """
    names = length_names(n_cables)

    def faults_of(table: LogTable, columns: dict[str, RawColumn]) -> Iterator[Fault]:
        for name in names:
            if name not in columns:
                yield table.fault(
                    None, name, "there is no such column", f"{names[0]} to {names[-1]}"
                )
        extra = [name for name in columns if name.startswith("length_") and cable_of(name)]
        for name in extra:
            if name not in names:
                yield table.fault(None, name, "is of no cable", f"{n_cables} cables")
        if not table.n_rows:
            yield table.fault(None, "", "there is no row", "lengths in each row")

    table, columns = _read(path, names, faults_of, partial(InputError.at, "--lengths"))
    lengths = np.stack([columns[name].values for name in names], axis=1)
    left_out = tuple(column.name for column in table.columns if column.n_texts)
    return LengthTable(*_numbers(table), lengths, left_out)


def _read(
    path: Path,
    names: tuple[str, ...],
    faults_of: Callable[[LogTable, dict[str, RawColumn]], Iterator[Fault]],
    error_of: ErrorOf,
) -> tuple[LogTable, dict[str, RawColumn]]:
    """Return a table and its columns by name, those called ``names`` with a number in each cell."""
    try:
        file = open_input(path)
    except (OSError, ValueError) as error:
        expected = f"a CSV file with columns {', '.join(names[:3])}"
        raise error_of(f"{path}: {reason(error)}", expected) from None
    with file:
        table = read_table(file, str(path), MOST_POSES)
    columns = {column.name: column for column in table.columns}
    faults = [*table.faults, *faults_of(table, columns)]
    for name in names:
        faults += unit_faults(table, columns[name]) if name in columns else ()
    if not faults:
        faults = [*_cell_faults(table, [columns[name] for name in names if name in columns])]
    if not faults and table.n_rows > MOST_POSES:
        faults.append(table.fault(None, "", f"{table.n_rows} rows", f"at most {MOST_POSES}"))
    if faults:
        raise InputError(faults)
    return table, columns


def _numbers(table: LogTable) -> tuple[tuple[str, ...], FloatArray]:
    """Return the names of the columns that hold numbers alone, and what stands there."""
    columns = [column for column in table.columns if column.name and not column.n_texts]
    values = np.stack([column.values for column in columns], axis=1)
    return tuple(column.name for column in columns), values


def along_path(study: Study) -> PoseTable:
    """Return the instants of the path of a study, with their times.

    Raises
    ------
    InputError
        If it has none.
    """
    motion = study.robot.platform.motion
    if motion is None:
        raise _OF_OPTION("is missing, and the study has no workspace.path", "--poses CSV")
    names = (TIME, *POSITION, *(() if study.robot.is_point_mass else ROTATION_VECTOR))
    values = np.column_stack([motion.time_s, motion.places])[:, : len(names)]
    return PoseTable(names, values, values[:, 1:])


def poses_in(workspace: Workspace | None, table: PoseTable) -> Poses:
    """Return the poses of a table; without orientations turned as the workspace has it there.

    That is where it asks for one orientation, fixed or by a law; else they are level.
    """
    if workspace is None or workspace.orientations.count > 1 or table.places.shape[1] == 6:
        return table.poses
    return Poses.at(workspace.space.places(table.places))


def path_faults(table: PoseTable, *, has_limits: bool) -> Iterator[Fault]:
    """Yield what is wrong with a table as a path: too few rows, times that do not rise.

    Where it has no times, rows that repeat the one before; there it ``has_limits``, or is at fault
    elsewhere.
    """
    log = table.log
    assert log is not None
    if table.load_cases:
        problem = "is a column of a list of poses: all load cases follow the path"
        yield log.fault(None, _LOAD_CASE, problem, "no such column")
    for name in ("time", "t", "t_s"):
        if name in table.names and TIME not in table.names:
            yield log.fault(None, name, "is no name of a column of a path", TIME)
    if not 2 <= len(table.places) <= MAX_PATH_ROWS:
        problem = f"{len(table.places)} {'row' if len(table.places) == 1 else 'rows'}"
        yield log.fault(None, "", problem, f"2 to {MAX_PATH_ROWS} rows of a path")
        return
    if TIME in table.left_out:
        yield log.fault(None, TIME, "holds texts", "a number in each row")
    elif TIME in table.names:
        times = table.values[:, table.names.index(TIME)]
        for row in np.flatnonzero(~(np.abs(times) <= _LATEST_S)).tolist()[:1]:
            value = "nothing" if np.isnan(times[row]) else f"{times[row]:g}"
            yield log.fault(row, TIME, f"holds {value}", f"a number up to {_LATEST_S:g} s")
            return
        for row in np.flatnonzero(np.diff(times) <= 0.0).tolist()[:1]:
            problem = f"has the time {times[row + 1]:g} s after {times[row]:g} s"
            yield log.fault(row + 1, TIME, problem, "times that rise from row to row")
        if not np.ptp(table.places, axis=0).any():
            yield log.fault(None, "", "the platform stays where it is", "two places at least")
    elif has_limits:
        still = ~np.diff(table.places, axis=0).any(axis=1)
        for row in np.flatnonzero(still).tolist()[:1]:
            problem = "is the place of the row before"
            yield log.fault(row + 1, "x_m", problem, f"another place, or a column {TIME}")


def _load_cases(column: RawColumn, n_rows: int) -> tuple[str, ...]:
    """Return what stands in each cell, a number as it is written shortest."""
    texts = {cell.row: cell.text for cell in column.texts}
    numbers = ("" if np.isnan(value) else f"{value:g}" for value in column.values)
    return tuple(texts.get(row, number) for row, number in zip(range(n_rows), numbers, strict=True))


def _column_faults(table: LogTable, columns: dict[str, RawColumn]) -> Iterator[Fault]:
    for name in POSITION:
        if name not in columns:
            yield table.fault(None, name, "there is no such column", "x_m, y_m and z_m")
    turns = [name for name in ROTATION_VECTOR if name in columns]
    if 0 < len(turns) < 3:
        missing = next(name for name in ROTATION_VECTOR if name not in columns)
        expected = "rx_rad, ry_rad and rz_rad, or none of them"
        yield table.fault(None, missing, "there is no such column", expected)
    if not table.n_rows:
        yield table.fault(None, "", "there is no pose", "a row for each pose")


def _cell_faults(table: LogTable, columns: list[RawColumn]) -> list[Fault]:
    largest_m = BOUNDS["distance"].most
    faults = []
    for column in columns:
        texts = {cell.row: cell.text for cell in column.texts}
        limit = 2.0 * np.pi if column.name in ROTATION_VECTOR else largest_m
        least = _SHORTEST_M if cable_of(column.name) else -limit
        unit = column.name.rpartition("_")[2]
        is_within = (column.values >= least) & (column.values <= limit)
        for row in np.flatnonzero(~is_within).tolist():
            value = repr(texts[row]) if row in texts else f"{column.values[row]:g}"
            value = "nothing" if value == "nan" else value
            expected = f"a number between {least:.6g} and {limit:.6g} {unit}"
            faults.append(table.fault(row, column.name, f"holds {value}", expected))
    return table.first_few(faults, len(faults), "of this kind")


def _robot_faults(table: LogTable, robot: Robot, place: FloatArray) -> Iterator[Fault]:
    turn = place[:, 3:] if place.shape[1] == 6 else np.zeros((len(place), 3))
    if robot.is_point_mass:
        for row in np.flatnonzero(turn.any(axis=1)).tolist():
            yield table.fault(row, "rx_rad", "turns a point mass", "zeros, or no such columns")
    elif robot.is_planar:
        exits = robot.exit_points_m
        off_m = (place[:, :3] - exits[0]) @ robot.upright[1]
        out = turn @ robot.upright[[0, 2]].T
        size = float(np.linalg.norm(np.ptp(exits, axis=0)))
        for row in np.flatnonzero(np.abs(off_m) > _OFF_PLANE * size).tolist():
            problem = f"leaves the plane of the robot by {abs(off_m[row]):.3g} m"
            yield table.fault(row, "x_m", problem, "a position in the plane of the exit points")
        for row in np.flatnonzero(np.abs(out).max(axis=1) > _OFF_PLANE).tolist():
            yield table.fault(row, "rx_rad", "turns the platform out of its plane", "a turn in it")
