"""Does a log make sense? Units, signs, the order of the cables, told by straight cables."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from designer.arrays import FloatArray
from designer.documents.columns import POSITION, TEMPERATURE_NAME, length_names, tension_names
from designer.documents.table import LogTable
from designer.errors import Fault
from designer.model.measurements import Measured
from designer.model.robot import Poses, Robot
from designer.statics.geometry import cable_geometry

FEWEST_POSES = 5
"""Several are held out from every fit, and an exit point alone has three unknowns."""

_UNITS = {"millimetres": 1e3, "centimetres": 1e2, "feet": 1.0 / 0.3048, "inches": 1.0 / 0.0254}
_ALIKE, _UNLIKE = 0.99, 0.9
"""Correlation of a length with a distance: sag leaves more than the former, noise than the latter;
between them nothing is told."""
_MAP = "measurements.columns"
_METRES = f"metres, or the unit in {_MAP}"


@dataclass(frozen=True, slots=True)
class _LengthRatio:
    """Measured lengths of one cable over straight distances, by level and by spread over rows."""

    level: float
    spread: float

    @property
    def unit(self) -> str | None:
        """The unit that the lengths seem to be in; None for metres, or where nothing is told."""
        for unit, factor in _UNITS.items():
            # Sag and stretch are less of a straight distance.
            if _is_near(self.level, factor, 1.1):
                return unit
            # Spreads over the rows follow the geometry so loosely that they tell only units that
            # are far off.
            if factor > 30.0 and _is_near(self.spread, factor, 2.0):
                return unit
        return None


def unit_faults(robot: Robot, measured: Measured, file: str, *, is_homed: bool) -> list[Fault]:
    """Return lengths or positions that seem to be in another unit than metres.

    Where ``is_homed`` the winches' offsets are known, so that the level of the lengths means
    something; their spread over the rows always does.
    """
    chord = cable_geometry(robot, measured.poses).chord_m
    ratios = [
        _length_ratio(length, distance, is_homed=is_homed)
        for length, distance in zip(measured.length_m.T, chord.T, strict=True)
    ]
    spreads = [ratio.spread for ratio in ratios if not math.isnan(ratio.spread)]
    # Positions in millimetres; nobody measures lengths in kilometres.
    if spreads and _is_near(float(np.median(spreads)), 1e-3, 3.0):
        problem = (
            f"the lengths change about {_about(spreads)} times as much as the positions ask for, "
            "as if these were in millimetres"
        )
        return [Fault(file, 1, ", ".join(POSITION), problem, _METRES)]
    names, units = length_names(len(ratios)), [ratio.unit for ratio in ratios]
    faults = []
    for unit in dict.fromkeys(unit for unit in units if unit):
        cables = [k for k, unit_of_cable in enumerate(units) if unit_of_cable == unit]
        problem = (
            f"lengths change about {_about([ratios[k].spread for k in cables])} times as much as "
            f"the poses ask for, as if they were in {unit}"
        )
        faults.append(Fault(file, 1, ", ".join(names[k] for k in cables), problem, _METRES))
    return faults


def sense_faults(
    robot: Robot, measured: Measured, table: LogTable, *, is_homed: bool
) -> list[Fault]:
    """Return what cannot be so, whatever effects the model may lack.

    Where ``is_homed`` the winches' offsets are known, so that lengths are positive.
    """
    faults = []
    poses = measured.poses
    rotation = poses.rotations.reshape(-1, 9)
    places = np.round(np.hstack([poses.position_m, rotation]) / 1e-6)  # nearer is the same
    if (count := len(np.unique(places, axis=0))) < FEWEST_POSES:
        problem = f"the rows are at {count} different poses"
        faults.append(Fault(table.name, None, "", problem, f"at least {FEWEST_POSES}"))
    # No machine is as hot in °C as 150, or as cold in kelvin.
    temperature_C = measured.temperature_C
    if temperature_C is not None and (middle := float(np.median(temperature_C))) > 150.0:
        problem = f"the temperature is about {middle:.4g}, as if it were in kelvin"
        expected = f"°C, or {{to: {TEMPERATURE_NAME}, unit: K}} in {_MAP}"
        faults.append(table.fault(None, TEMPERATURE_NAME, problem, expected))
    faults += [*_cable_faults(robot, measured, table), *_compression_faults(robot, measured, table)]
    if not faults and is_homed:
        names = length_names(robot.n_cables)
        negative = np.argwhere(measured.length_m.T <= 0.0)
        expected = (
            "more than 0; or 'unknown: [length_offset]' for lengths that are counted from home"
        )
        not_positive = (
            table.fault(
                int(measured.row_numbers[row]) - 1,
                names[cable],
                f"has the length {measured.length_m[row, cable]:g} m",
                expected,
            )
            for cable, row in negative
        )
        faults += table.first_few(not_positive, len(negative), "lengths that are not positive")
    return faults or list(_underweight_faults(robot, measured, table))


def _length_ratio(length_m: FloatArray, chord_m: FloatArray, *, is_homed: bool) -> _LengthRatio:
    seen = ~np.isnan(length_m)
    if not seen.any() or np.ptp(chord_m[seen]) == 0.0:
        return _LengthRatio(math.nan, math.nan)
    length, chord = length_m[seen], chord_m[seen]
    level = float(np.median(length / chord)) if is_homed else math.nan
    return _LengthRatio(level, float(np.std(length) / np.std(chord)))


def _is_near(value: float, factor: float, tolerance: float) -> bool:
    return factor / tolerance < value < factor * tolerance


def _about(values: Sequence[float]) -> str:
    return f"{float(f'{np.median(values):.2g}'):g}"


def _cable_faults(robot: Robot, measured: Measured, table: LogTable) -> list[Fault]:
    """Tell lengths that shrink as the distance grows, or that follow another cable's distance.

    Where all follow their own in a mirrored frame, that is told instead; of two cables only where
    it suits them better, since on a symmetrical robot their plugs may as well be exchanged.
    """
    names, faults = length_names(robot.n_cables), []
    alike = _correlations(robot, measured)
    likest = alike.max(axis=1)
    for cable, best in enumerate(np.argmax(alike, axis=1)):
        if alike[cable, cable] < _UNLIKE and likest[cable] > _ALIKE:
            problem = f"follows the distance to exit point {best + 1}, not to {cable + 1}"
            expected = f"numbers in the order of robot.anchors, or names in {_MAP}"
            faults.append(table.fault(None, names[cable], problem, expected))
        elif alike[cable, cable] < -_UNLIKE:
            problem = "falls as the distance to its exit point grows"
            expected = f"lengths, or 'scale: -1' in {_MAP}"
            faults.append(table.fault(None, names[cable], problem, expected))
    if not faults:
        return faults
    read = np.isfinite(measured.length_m).any(axis=0)
    for text, view in left_handed(robot, measured):
        agreement = np.diag(_correlations(robot, view))[read]
        better = len(faults) > 2 or np.mean(1.0 - agreement) < 0.5 * np.mean(1.0 - likest[read])
        if agreement.min() > _ALIKE and better:
            problem = f"suit the lengths with {text}: the frame of the poses is mirrored"
            expected = f"a right-handed frame, as by 'scale: -1' or other names in {_MAP}"
            return [Fault(table.name, 1, ", ".join(POSITION), problem, expected)]
    return faults


def _correlations(robot: Robot, measured: Measured) -> FloatArray:
    """Return how each length goes with the distance to each exit point (n_cables, n_cables)."""
    chord_m = cable_geometry(robot, measured.poses).chord_m
    return np.array(
        [
            [_correlation(length_m, distance_m) for distance_m in chord_m.T]
            for length_m in measured.length_m.T
        ]
    )


def _correlation(reading: FloatArray, prediction: FloatArray) -> float:
    seen = ~np.isnan(reading)
    if seen.sum() < FEWEST_POSES or np.ptp(reading[seen]) == 0.0 or np.ptp(prediction[seen]) == 0.0:
        return 0.0
    return float(np.corrcoef(reading[seen], prediction[seen])[0, 1])


def _compression_faults(robot: Robot, measured: Measured, table: LogTable) -> Iterator[Fault]:
    """Tell load cells that read a push most of the time."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # a column without any reading
        middle_N = np.nanmedian(measured.tension_N, axis=0)
    for name, tension_N in zip(tension_names(robot.n_cables), middle_N, strict=True):
        # A load cell that is only off reads less of a push.
        if tension_N < -0.01 * _pull_N(robot):
            problem = f"is {tension_N:.4g} N in the middle, but no cable can push"
            yield table.fault(None, name, problem, f"a pull, or 'scale: -1' in {_MAP}")


def _underweight_faults(robot: Robot, measured: Measured, table: LogTable) -> Iterator[Fault]:
    total_N = measured.tension_N.sum(axis=1)
    pull_N = _pull_N(robot)
    # Cables pull along themselves, so that their tensions add up to the weight at least; half of it
    # leaves doubt about the weight.
    if np.isnan(total_N).all() or float(np.nanmedian(total_N)) >= 0.5 * pull_N:
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


# Poses in a left-handed frame: one axis counted the other way, or two of them exchanged.


def left_handed(robot: Robot, measured: Measured) -> Iterator[tuple[str, Measured]]:
    """Yield each left-handed frame in words, with the rows as they are if it was the camera's.

    An axis may have been counted from the robot's zero, or from the middle of its exit points.
    """
    for text, mirror in _mirrors():
        for zero in (np.zeros(3), robot.exit_points_m.mean(axis=0)):
            poses = measured.poses
            position = zero + (poses.position_m - zero) @ mirror
            # Each axis of the body is mirrored as well, which leaves a rotation.
            rotation = mirror @ poses.rotation @ mirror
            yield text, replace(measured, poses=Poses(position, rotation))


def _mirrors() -> Iterator[tuple[str, FloatArray]]:
    for axis, name in enumerate("xyz"):
        yield f"{name} counted the other way", np.diag(np.where(np.arange(3) == axis, -1.0, 1.0))
    for order in ([1, 0, 2], [2, 1, 0], [0, 2, 1]):
        first, second = (name for name, k in zip("xyz", range(3), strict=True) if order[k] != k)
        yield f"{first} and {second} exchanged", np.eye(3)[order]
