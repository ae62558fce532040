"""From columns of a log to rotations."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

from designer.arrays import FloatArray
from designer.measured.assign import QUATERNION, ROTATION_VECTOR


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
