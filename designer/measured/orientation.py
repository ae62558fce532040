"""Orientations from the forms in which logs give them."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from designer.arrays import BoolArray, FloatArray
from designer.errors import Fault
from designer.measured.assign import Assigned
from designer.measured.names import QUATERNION, ROTATION_VECTOR

_LARGEST_NORM_ERROR = 0.01


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
        _, way, axes, _ = columns[0].split("_")
        rotation = Rotation.from_euler(axes.upper() if way == "intrinsic" else axes, values)
    return np.asarray(rotation.as_matrix(), dtype=np.float64)


def quaternion_faults(found: Assigned, kept: BoolArray) -> list[Fault]:
    """Return the rows whose quaternion is not of unit length within a hundredth."""
    columns = found.present(QUATERNION)
    if len(columns) < len(QUATERNION):
        return []
    norm = np.sqrt(sum(column.values**2 for column in columns))
    rows = np.flatnonzero(kept & np.isfinite(norm) & (np.abs(norm - 1.0) > _LARGEST_NORM_ERROR))
    faults = (
        found.table.fault(
            int(row), columns[0].name, f"has a quaternion of length {norm[row]:.4g}", "1 within 1 %"
        )
        for row in rows
    )
    return found.table.first_few(faults, len(rows), "such quaternions")
