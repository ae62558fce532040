"""Finds out which column of a table is what to us, by the names that columns go by.

Also what columns say of the platform's orientation, and of poses that were measured in part.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from designer.arrays import BoolArray, FloatArray, frozen_array
from designer.documents.columns import (
    COVARIATE,
    IGNORE,
    POSITION,
    QUATERNION,
    ROTATION_VECTOR,
    WIND,
    cable_of,
    dimension_of,
    is_rotation,
    length_names,
    rotation_form,
    standard_names,
    tension_names,
    unit_fault,
    unit_faults,
)
from designer.documents.table import LogTable, RawColumn
from designer.errors import Fault
from designer.model.measurements import POSES, Coordinates, LogColumn, Measurements
from designer.spelling import did_you_mean
from designer.study import Study
from designer.units import NUMBER, QuantityError, unit_conversion

_MAP = "measurements.columns"
_IN_PART = f"; or 'unknown: [{POSES}]' with noise: {{position: …, rotation: …}} for poses in part"


@dataclass(frozen=True, slots=True, eq=False)
class Assigned:
    """The columns of a table by what they are to us."""

    table: LogTable  #: the whole of it
    #: columns that we have a name for, by that name, in its unit
    ours: dict[str, RawColumn] = field(default_factory=dict)
    #: all other columns with a name, by that
    covariates: dict[str, RawColumn] = field(default_factory=dict)
    #: our names of columns that the config's map looks for in vain
    awaited: set[str] = field(default_factory=set)
    #: columns that are missing, or that stand for the wrong thing
    faults: list[Fault] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)  #: columns that were left out, and why

    def present(self, names: tuple[str, ...]) -> list[RawColumn]:
        """Return those of our columns that there are."""
        return [self.ours[name] for name in names if name in self.ours]

    @property
    def rotation(self) -> tuple[str, ...]:
        """Names of the columns that give the orientation; empty for none."""
        return next((rotation_form(name) for name in self.ours if is_rotation(name)), ())


def assign(
    tables: Sequence[LogTable], study: Study, measurements: Measurements
) -> tuple[Assigned, ...]:
    """Return each table with its columns assigned by the config's map and by their names.

    ``winches.time`` in the map is the column ``time`` of the file ``winches.csv`` alone.
    """
    parts = tuple(Assigned(table) for table in tables)
    mapped = {entry.name: entry for entry in measurements.columns}
    present: set[str] = set()
    used: set[str] = set()
    for part in parts:
        file, named = Path(part.table.name).stem, _named(part)
        present |= named.keys()
        entries = {name: mapped.get(f"{file}.{name}", mapped.get(name)) for name in named}
        for name, entry in entries.items():
            if entry is not None:
                used.add(entry.name)
                _assign_mapped(part, named[name], entry)
        for name, entry in entries.items():
            if entry is None:
                _assign_by_name(part, named[name], study)
    for name, entry in reversed(mapped.items()):
        if name not in used:
            parts[0].awaited.add(entry.target)
            problem = f"there is no such column in {' or '.join(table.name for table in tables)}"
            expected = f"a name in its first line{did_you_mean(name, sorted(present))}"
            parts[0].faults.insert(0, study.source.fault(f"{_MAP}.{name}", problem, expected))
    return parts


def _named(part: Assigned) -> dict[str, RawColumn]:
    """Return the columns by their names, the first of each; note those without."""
    named: dict[str, RawColumn] = {}
    for place, column in enumerate(part.table.columns, start=1):
        if column.name:
            named.setdefault(column.name, column)
        elif not column.is_empty:
            part.notes.append(f"column {place} has no name and was left out")
    return named


def complete(assigned: Assigned, study: Study, measurements: Measurements) -> None:
    """Set aside half a wind, and tell what is missing.

    The table has the columns of all files.
    """
    # Take a wind without its horizontal components as covariates.
    present = [name for name in WIND if name in assigned.ours]
    missing = [name for name in WIND[:2] if name not in assigned.ours]
    if present and missing:
        assigned.notes.append(
            f"the wind is not used as such: there is no {' and no '.join(missing)}"
        )
        for name in present:
            assigned.covariates[name] = assigned.ours.pop(name)
    assigned.faults.extend(_missing(assigned, study, has_poses=measurements.has_poses))


def _assign_mapped(assigned: Assigned, column: RawColumn, entry: LogColumn) -> None:
    if entry.target == COVARIATE:
        assigned.covariates[entry.name] = column
    elif entry.target in assigned.ours:
        problem = f"another column of this file is mapped onto {entry.target}"
        assigned.faults.append(assigned.table.fault(None, column.name, problem, "one of them"))
    elif entry.target != IGNORE:
        values = column.values
        if column.unit and not entry.has_unit:
            try:
                scale, zero = unit_conversion(column.unit, dimension_of(entry.target) or NUMBER)
                values = values * scale + zero
            except QuantityError as error:
                assigned.faults.append(unit_fault(assigned.table, column, error.expected))
        values = values * entry.scale + entry.offset
        assigned.ours[entry.target] = replace(column, values=values)


def _assign_by_name(assigned: Assigned, column: RawColumn, study: Study) -> None:
    name, robot = column.name, study.robot
    if name in assigned.ours:
        problem = f"another column is mapped onto {name}, and this has the name already"
        expected = f"'{name}: {IGNORE}' or '{name}: {COVARIATE}' in {_MAP}"
        assigned.faults.append(assigned.table.fault(None, name, problem, expected))
    elif is_rotation(name) and name in ROTATION_VECTOR and robot.is_point_mass:
        assigned.notes.append(f"{name} was left out: a point mass has no orientation")
    elif name in standard_names(robot.n_cables):
        assigned.ours[name] = column
        hint = f"; or {{to: {name}, unit: {column.unit}}} in {_MAP}"
        assigned.faults.extend(unit_faults(assigned.table, column, hint))
    elif cable_of(name) is not None:
        problem = f"there is no such cable, the robot has {robot.n_cables}"
        expected = f"cables 1 to {robot.n_cables}; or '{name}: {IGNORE}' in {_MAP}"
        assigned.faults.append(assigned.table.fault(None, name, problem, expected))
    else:
        assigned.covariates[name] = column


def _missing(assigned: Assigned, study: Study, *, has_poses: bool) -> Iterator[Fault]:
    lengths, tensions = (names(study.robot.n_cables) for names in (length_names, tension_names))
    present = {*assigned.ours, *assigned.awaited}
    if not has_poses:
        pass
    elif present.isdisjoint(POSITION):
        problem = (
            "there is no measured pose; the diagnosis holds readings against the pose of each row, "
            "which has to be measured by other means than the winches"
        )
        expected = (
            f"columns {', '.join(POSITION)}, or others mapped onto them in {_MAP}; or, with "
            f"lengths and tensions or with cables to spare, 'unknown: [{POSES}]'"
        )
        hint = did_you_mean(POSITION[0], assigned.covariates)
        yield assigned.table.fault(None, ", ".join(POSITION), problem, expected + hint)
    else:
        yield from _missing_of(assigned, POSITION, _IN_PART)
        rotations = [name for name in (*assigned.ours, *assigned.awaited) if is_rotation(name)]
        forms = {rotation_form(name): name for name in rotations}
        if not study.robot.is_point_mass and len(forms) > 1:
            problem = f"the orientation is given in two forms, with {' and '.join(forms.values())}"
            yield assigned.table.fault(None, "", problem, "one; the columns of the other ignored")
        elif not study.robot.is_point_mass:
            yield from _missing_of(assigned, next(iter(forms), ROTATION_VECTOR), _IN_PART)
    if present.isdisjoint(lengths + tensions):
        expected = f"{lengths[0]} … {lengths[-1]}, or {tensions[0]} … {tensions[-1]}, or both"
        problem = "there is neither a column for lengths nor one for tensions"
        yield assigned.table.fault(
            None, "", problem, f"{expected}; {_MAP} says which columns they are"
        )
    for names in (lengths, tensions):
        if not present.isdisjoint(names):
            yield from _missing_of(assigned, names, ", with empty cells where nothing is read")


def _missing_of(assigned: Assigned, names: tuple[str, ...], instead: str = "") -> Iterator[Fault]:
    for name in names:
        if name not in assigned.ours and name not in assigned.awaited:
            hint = did_you_mean(name, assigned.covariates)
            expected = f"a column of this name, or one mapped onto it in {_MAP}{instead}{hint}"
            yield assigned.table.fault(None, name, "is missing", expected)


# Orientation.


def euler_axes(columns: tuple[str, ...]) -> str:
    """Return the axes of Euler angles as SciPy has them; empty for other columns."""
    if not columns or columns in (ROTATION_VECTOR, QUATERNION):
        return ""
    _, sense, axes, _ = columns[0].split("_")
    return axes.upper() if sense == "intrinsic" else axes


def orientation(columns: tuple[str, ...], values: FloatArray) -> FloatArray:
    """Return rotations from body to world (n_rows, 3, 3).

    Parameters
    ----------
    columns : tuple of str
        Our names of the columns: a rotation vector, a quaternion, or Euler angles, whose names say
        the axes and whether these turn with the body (``intrinsic``) or not (``extrinsic``).
    values : array (n_rows, 3 or 4)
        The columns; angles in radians. Quaternions are scaled to unit length.
    """
    if columns == ROTATION_VECTOR:
        rotation = Rotation.from_rotvec(values)
    elif columns == QUATERNION:
        rotation = Rotation.from_quat(np.roll(values, -1, axis=1))  # SciPy has w last
    else:
        rotation = Rotation.from_euler(euler_axes(columns), values)
    return np.asarray(rotation.as_matrix(), dtype=np.float64)


# Poses that were measured in part.

_LEVEL_AXES, _LEVEL_NAMES = "xyz", tuple(f"euler_extrinsic_xyz_{k}" for k in (1, 2, 3))
"""Whole orientations are compared by these, which have no singular place near level."""


def exclude_coordinates(assigned: Assigned, measurements: Measurements) -> Iterator[Fault]:
    """Take coordinates without a declared noise out of a log whose poses are unknown.

    Yields what the others lack.
    """
    names = [
        name
        for name in assigned.ours
        if (name in POSITION and measurements.position_noise_m is None)
        or (is_rotation(name) and measurements.rotation_noise_rad is None)
    ]
    for name in names:
        del assigned.ours[name]
    if names:
        assigned.notes.append(f"{', '.join(names)} left out: {POSES} are said to be unknown")
    rotations = [name for name in assigned.ours if is_rotation(name)]
    for kind, noise, present, example in (
        ("position", measurements.position_noise_m, assigned.present(POSITION), POSITION[2]),
        ("rotation", measurements.rotation_noise_rad, rotations, "euler_intrinsic_zyx_2"),
    ):
        if noise is not None and not present:
            problem = f"has no coordinate that measurements.noise.{kind} is the noise of"
            expected = f"a column such as {example}, or one mapped onto it; or no such noise"
            yield assigned.table.fault(None, "", problem, expected)
    form = assigned.rotation
    if set(rotations) - set(form):
        problem = f"the orientation is given in two forms, with {' and '.join(rotations)}"
        yield assigned.table.fault(None, "", problem, "one; the columns of the other ignored")
    elif form and not _may_be_in_part(form):
        yield from _half_orientations(assigned, form)


def coordinates_of(
    assigned: Assigned, measurements: Measurements, mask: BoolArray
) -> Coordinates | None:
    """Return what was measured of poses in part, in some rows (n_rows,); None for nothing."""
    form = assigned.rotation
    if assigned.ours.keys().isdisjoint((*POSITION, *form)):
        return None
    position, angles = _side_by_side(assigned, POSITION, mask), _side_by_side(assigned, form, mask)
    axes, names = euler_axes(form), form
    if not _may_be_in_part(form):
        angles, axes, names = _level_angles(form, angles), _LEVEL_AXES, _LEVEL_NAMES
    noise = [measurements.position_noise_m or 1.0] * 3
    noise += [measurements.rotation_noise_rad or 1.0] * 3
    values = frozen_array(np.hstack([position, angles]))
    return Coordinates((*POSITION, *names), values, axes, frozen_array(noise))


def _may_be_in_part(form: tuple[str, ...]) -> bool:
    """Tell whether each angle means something alone: about three different axes."""
    return len(set(euler_axes(form))) == 3


def _half_orientations(assigned: Assigned, form: tuple[str, ...]) -> Iterator[Fault]:
    table = assigned.table
    expected = "all of it, or angles that count alone, such as euler_intrinsic_zyx_2 and …_3"
    missing = [name for name in form if name not in assigned.ours]
    for name in missing:
        yield table.fault(None, name, "is missing", expected)
    empty = np.isnan(_side_by_side(assigned, form, np.ones(table.n_rows, dtype=np.bool_)))
    rows = np.flatnonzero(empty.any(axis=1) & ~empty.all(axis=1))
    if not missing:
        halves = (
            table.fault(int(row), form[0], "has half an orientation", expected) for row in rows
        )
        yield from table.first_few(halves, len(rows), "half orientations")


def _side_by_side(assigned: Assigned, names: tuple[str, ...], mask: BoolArray) -> FloatArray:
    """Return columns side by side (n_kept, n_names), at least three; NaN where there is none."""
    values = np.full((assigned.table.n_rows, max(len(names), 3)), np.nan)
    for k, name in enumerate(names):
        if name in assigned.ours:
            values[:, k] = assigned.ours[name].values
    return values[mask]


def _level_angles(form: tuple[str, ...], values: FloatArray) -> FloatArray:
    angles = np.full((len(values), 3), np.nan)
    whole = ~np.isnan(values).any(axis=1)
    if whole.any():
        rotation = Rotation.from_matrix(orientation(form, values[whole]))
        angles[whole] = rotation.as_euler(_LEVEL_AXES)
    return angles
