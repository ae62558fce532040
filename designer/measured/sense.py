"""Does a log make sense? Signs, the order of the cables, and units of what is not a length."""

from __future__ import annotations

import warnings
from collections.abc import Iterator

import numpy as np

from designer.arrays import FloatArray
from designer.errors import Fault
from designer.measured.faults import first_few
from designer.measured.names import TEMPERATURE_NAME, length_names, tension_names
from designer.measured.table import Table
from designer.model.measured_data import Measured
from designer.model.robot import Robot
from designer.statics.geometry import cable_geometry

FEWEST_POSES = 5
"""Several are held out from every fit, and an exit point alone has three unknowns."""

_ALIKE = 0.99
_UNLIKE = 0.9
_SAME_M = 1e-6
_KELVIN_FROM = 150.0
_LIGHTEST = 0.5
"""Cables pull along themselves, so that their tensions add up to the weight at least; rest: doubt
about the weight."""
_MAP = "measurements.columns"


def sense_faults(robot: Robot, measured: Measured, table: Table, *, is_homed: bool) -> list[Fault]:
    """Return what cannot be so, whatever effects the model may lack.

    Parameters
    ----------
    robot, measured
        The robot as declared, and its log.
    table : Table
        The file, for messages.
    is_homed : bool
        Whether the winches' offsets are known, so that lengths are positive.
    """
    faults = [*_few_poses(measured, table), *_temperature(measured, table)]
    faults += [*_wrong_cable(robot, measured, table), *_pushing(robot, measured, table)]
    if not faults and is_homed:
        faults += _not_positive(measured, table)
    return faults or list(_too_light(robot, measured, table))


def _few_poses(measured: Measured, table: Table) -> Iterator[Fault]:
    poses = measured.poses
    rotation = np.broadcast_to(poses.rotation, (measured.n_rows, 3, 3)).reshape(-1, 9)
    places = np.round(np.hstack([poses.position_m, rotation]) / _SAME_M)
    count = len(np.unique(places, axis=0))
    if count < FEWEST_POSES:
        expected = f"at least {FEWEST_POSES}"
        yield Fault(table.name, None, "", f"the rows are at {count} different poses", expected)


def _temperature(measured: Measured, table: Table) -> Iterator[Fault]:
    if measured.temperature_C is None:
        return
    middle = float(np.median(measured.temperature_C))
    if middle > _KELVIN_FROM:
        problem = f"the temperature is about {middle:.4g}, as if it were in kelvin"
        expected = f"°C, or {{to: {TEMPERATURE_NAME}, unit: K}} in {_MAP}"
        yield table.fault(None, TEMPERATURE_NAME, problem, expected)


def _wrong_cable(robot: Robot, measured: Measured, table: Table) -> Iterator[Fault]:
    """Tell lengths that shrink as the distance grows, or that follow another cable's distance."""
    chord_m = cable_geometry(robot, measured.poses).chord_m
    names = length_names(robot.n_cables)
    for cable, length_m in enumerate(measured.length_m.T):
        alike = np.array([_correlation(length_m, other_m) for other_m in chord_m.T])
        best = int(np.argmax(alike))
        if alike[cable] < _UNLIKE and alike[best] > _ALIKE:
            problem = f"follows the distance to exit point {best + 1}, not to {cable + 1}"
            expected = "numbers in the order of robot.anchors"
            yield table.fault(None, names[cable], problem, f"{expected}, or names in {_MAP}")
        elif alike[cable] < -_UNLIKE:
            problem = "falls as the distance to its exit point grows"
            yield table.fault(None, names[cable], problem, f"lengths, or 'scale: -1' in {_MAP}")


def _correlation(first: FloatArray, second: FloatArray) -> float:
    seen = ~np.isnan(first)
    if seen.sum() < FEWEST_POSES or np.ptp(first[seen]) == 0.0 or np.ptp(second[seen]) == 0.0:
        return 0.0
    return float(np.corrcoef(first[seen], second[seen])[0, 1])


def _not_positive(measured: Measured, table: Table) -> list[Fault]:
    names = length_names(measured.length_m.shape[1])
    places = np.argwhere(measured.length_m.T <= 0.0)
    expected = "more than 0; or 'unknown: [length_offset]' for lengths that are counted from home"
    faults = (
        table.fault(
            int(measured.row_numbers[row]) - 1,
            names[cable],
            f"has the length {measured.length_m[row, cable]:g} m",
            expected,
        )
        for cable, row in places
    )
    return first_few(faults, len(places), table.name, "lengths that are not positive")


def _pushing(robot: Robot, measured: Measured, table: Table) -> Iterator[Fault]:
    """Tell load cells that read a push most of the time; one that is only off reads little."""
    limit_N = -0.01 * _pull_N(robot)
    for name, middle_N in zip(
        tension_names(robot.n_cables), _medians(measured.tension_N), strict=True
    ):
        if middle_N < limit_N:
            problem = f"is {middle_N:.4g} N in the middle, but no cable can push"
            yield table.fault(None, name, problem, f"a pull, or 'scale: -1' in {_MAP}")


def _too_light(robot: Robot, measured: Measured, table: Table) -> Iterator[Fault]:
    total_N = measured.tension_N.sum(axis=1)
    pull_N = _pull_N(robot)
    if np.isnan(total_N).all() or float(np.nanmedian(total_N)) >= _LIGHTEST * pull_N:
        return
    names = tension_names(robot.n_cables)
    problem = (
        f"the tensions add up to {float(np.nanmedian(total_N)):.3g} N in the middle, "
        f"but hold a load of {pull_N:.4g} N"
    )
    expected = f"newtons, or the unit in {_MAP}; and check robot.platform.mass"
    yield table.fault(None, f"{names[0]} … {names[-1]}", problem, expected)


def _pull_N(robot: Robot) -> float:
    return float(np.linalg.norm(robot.pull_N[:3]))


def _medians(values: FloatArray) -> FloatArray:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # a column without any reading
        return np.asarray(np.nanmedian(values, axis=0))
