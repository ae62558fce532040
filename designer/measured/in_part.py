"""Poses that were measured in part: which columns of a log are their coordinates."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.spatial.transform import Rotation

from designer.arrays import BoolArray, FloatArray, frozen_array
from designer.errors import Fault
from designer.measured.assign import POSITION, Assigned, is_rotation
from designer.measured.orientation import euler_axes, orientation
from designer.model.coordinates import Coordinates
from designer.model.measurements import POSES, Measurements

_LEVEL_AXES, _LEVEL_NAMES = "xyz", tuple(f"euler_extrinsic_xyz_{k}" for k in (1, 2, 3))
"""Whole orientations are compared by these, which have no singular place near level."""


def set_aside(assigned: Assigned, measurements: Measurements) -> Iterator[Fault]:
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
    position, angles = _values(assigned, POSITION, mask), _values(assigned, form, mask)
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
    empty = np.isnan(_values(assigned, form, np.ones(table.n_rows, dtype=np.bool_)))
    rows = np.flatnonzero(empty.any(axis=1) & ~empty.all(axis=1))
    if not missing:
        halves = (
            table.fault(int(row), form[0], "has half an orientation", expected) for row in rows
        )
        yield from table.first_few(halves, len(rows), "half orientations")


def _values(assigned: Assigned, names: tuple[str, ...], mask: BoolArray) -> FloatArray:
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
