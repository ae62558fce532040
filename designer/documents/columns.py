"""The names that columns of tables go by, each with its unit, and what they are to us."""

from __future__ import annotations

import re
from collections.abc import Iterator

from designer.documents.table import LogTable, RawColumn
from designer.errors import Fault
from designer.spelling import did_you_mean
from designer.units import (
    ANGLE,
    FORCE,
    LENGTH,
    NUMBER,
    SPEED,
    TEMPERATURE,
    TIME,
    Dimension,
    QuantityError,
    describe,
    unit_conversion,
)

TIME_NAME = "time_s"
TEMPERATURE_NAME = "temperature_C"
POSITION = ("x_m", "y_m", "z_m")
ROTATION_VECTOR = ("rx_rad", "ry_rad", "rz_rad")
QUATERNION = ("quaternion_w", "quaternion_x", "quaternion_y", "quaternion_z")
WIND = ("wind_x_m_per_s", "wind_y_m_per_s", "wind_z_m_per_s")

IGNORE = "ignore"
COVARIATE = "covariate"
"""What a log's column may be that is none of ours."""


_DIMENSIONS: dict[str, Dimension] = {
    TIME_NAME: TIME,
    TEMPERATURE_NAME: TEMPERATURE,
    **dict.fromkeys(POSITION, LENGTH),
    **dict.fromkeys(ROTATION_VECTOR, ANGLE),
    **dict.fromkeys(QUATERNION, NUMBER),
    **dict.fromkeys(WIND, SPEED),
}


def length_names(n_cables: int) -> tuple[str, ...]:
    """Return the names of the length columns of so many cables."""
    return tuple(f"length_{cable}_m" for cable in range(1, n_cables + 1))


def tension_names(n_cables: int) -> tuple[str, ...]:
    """Return the names of the tension columns of so many cables."""
    return tuple(f"tension_{cable}_N" for cable in range(1, n_cables + 1))


def standard_names(n_cables: int) -> frozenset[str]:
    """Return the names that a column has without any map."""
    fixed = (TIME_NAME, TEMPERATURE_NAME, *POSITION, *ROTATION_VECTOR, *WIND)
    return frozenset((*fixed, *length_names(n_cables), *tension_names(n_cables)))


def cable_of(name: str) -> int | None:
    """Return the number of the cable that a length or tension belongs to; None for others."""
    match = re.fullmatch(r"length_([0-9]{1,9})_m|tension_([0-9]{1,9})_N", name)
    return None if match is None else int(match[1] or match[2])


def is_rotation(name: str) -> bool:
    """Return whether a column of ours is part of the platform's orientation."""
    return name in ROTATION_VECTOR or name in QUATERNION or name.startswith("euler_")


def rotation_form(name: str) -> tuple[str, ...]:
    """Return the columns that give an orientation together with this one."""
    if name in QUATERNION:
        return QUATERNION
    if name in ROTATION_VECTOR:
        return ROTATION_VECTOR
    return tuple(f"{name[:-1]}{number}" for number in (1, 2, 3))


def dimension_of(name: str) -> Dimension | None:
    """Return what kind of quantity a column of ours holds; None where there is no such column."""
    if name in _DIMENSIONS:
        return _DIMENSIONS[name]
    cable = cable_of(name)
    if cable is not None and str(cable) == name.split("_")[1] and cable > 0:
        return LENGTH if name.startswith("length") else FORCE
    # A turn about the same axis twice in a row is one.
    euler = re.fullmatch(
        r"euler_(?:intrinsic|extrinsic)_([xyz])(?!\1)([xyz])(?!\2)[xyz]_[123]", name
    )
    return ANGLE if euler else None


def column_hint(name: str) -> str:
    """Return a hint at the column of ours whose name is most like this one."""
    readings = (*length_names(64), *tension_names(64))
    common_euler = (
        f"euler_{sense}_{axes}_{number}"
        for sense in ("intrinsic", "extrinsic")
        for axes in ("xyz", "zyx", "zxz", "zyz")
        for number in (1, 2, 3)
    )
    return did_you_mean(name, (*_DIMENSIONS, *readings, *common_euler, IGNORE, COVARIATE))


def unit_faults(table: LogTable, column: RawColumn, hint: str = "") -> Iterator[Fault]:
    """Yield the fault of a column of ours whose unit in the file is not that of its name."""
    dimension = dimension_of(column.name) or NUMBER
    if not column.unit or column.name.endswith(f"_{column.unit}"):  # as temperature_C does
        return
    try:
        if unit_conversion(column.unit, dimension) != (1.0, 0.0):
            yield unit_fault(table, column, f"{dimension.unit}, as its name says{hint}")
    except QuantityError as error:
        yield unit_fault(table, column, error.expected)


def unit_fault(table: LogTable, column: RawColumn, expected: str) -> Fault:
    """Return the fault of a column whose unit in the file is another than expected."""
    problem = f"the row of units says {describe(column.unit)}"
    return Fault(table.name, table.units_line, column.name, problem, expected)
