"""Are the numbers of a log in our units? Told by comparing it with straight cables."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from designer.arrays import FloatArray
from designer.errors import Fault
from designer.measured.names import POSITION, length_names
from designer.model.measured_data import Measured
from designer.model.robot import Robot
from designer.statics.geometry import cable_geometry

_UNITS = {"millimetres": 1e3, "centimetres": 1e2, "feet": 1.0 / 0.3048, "inches": 1.0 / 0.0254}
_LEVEL_TOLERANCE = 1.1
_SPREAD_TOLERANCE = 2.0
_FAR_OFF = 30.0
"""The spread follows the geometry loosely, so it tells only units that are as far off as this."""
_EXPECTED = "metres, or the unit in measurements.columns"


@dataclass(frozen=True, slots=True)
class _Ratio:
    """Measured lengths of one cable over straight distances, by level and by spread over rows."""

    level: float
    spread: float

    @property
    def unit(self) -> str | None:
        """The unit that the lengths seem to be in; None for metres, or where nothing is told."""
        for unit, factor in _UNITS.items():
            if _is_near(self.level, factor, _LEVEL_TOLERANCE):
                return unit
            if factor > _FAR_OFF and _is_near(self.spread, factor, _SPREAD_TOLERANCE):
                return unit
        return None


def unit_faults(robot: Robot, measured: Measured, file: str, *, is_homed: bool) -> list[Fault]:
    """Return lengths or positions that seem to be in another unit than metres.

    Parameters
    ----------
    robot, measured
        The robot as declared, and its log.
    file : str
        The log, for messages.
    is_homed : bool
        Whether the winches' offsets are known, so that the level of the lengths means something;
        their spread over the rows always does.
    """
    chord = cable_geometry(robot, measured.poses).chord_m
    ratios = [
        _ratio(length, distance, is_homed=is_homed)
        for length, distance in zip(measured.length_m.T, chord.T, strict=True)
    ]
    return _position_fault(ratios, file) or _length_faults(ratios, file)


def _ratio(length_m: FloatArray, chord_m: FloatArray, *, is_homed: bool) -> _Ratio:
    seen = ~np.isnan(length_m)
    if not seen.any() or np.ptp(chord_m[seen]) == 0.0:
        return _Ratio(math.nan, math.nan)
    length, chord = length_m[seen], chord_m[seen]
    level = float(np.median(length / chord)) if is_homed else math.nan
    return _Ratio(level, float(np.std(length) / np.std(chord)))


def _is_near(value: float, factor: float, tolerance: float) -> bool:
    return factor / tolerance < value < factor * tolerance


def _length_faults(ratios: Sequence[_Ratio], file: str) -> list[Fault]:
    names = length_names(len(ratios))
    units = [ratio.unit for ratio in ratios]
    faults = []
    for unit in dict.fromkeys(one for one in units if one):
        cables = [k for k, one in enumerate(units) if one == unit]
        spread = _about([ratios[k].spread for k in cables])
        problem = (
            f"lengths change about {spread} times as much as the poses ask for, "
            f"as if they were in {unit}"
        )
        faults.append(Fault(file, 1, ", ".join(names[k] for k in cables), problem, _EXPECTED))
    return faults


def _position_fault(ratios: Sequence[_Ratio], file: str) -> list[Fault]:
    """Tell positions in millimetres; nobody measures lengths in kilometres."""
    spreads = [ratio.spread for ratio in ratios if not math.isnan(ratio.spread)]
    if not spreads or not _is_near(float(np.median(spreads)), 1e-3, 3.0):
        return []
    problem = (
        f"the lengths change about {_about(spreads)} times as much as the positions ask for, "
        "as if these were in millimetres"
    )
    return [Fault(file, 1, ", ".join(POSITION), problem, _EXPECTED)]


def _about(values: Sequence[float]) -> str:
    return f"{float(f'{np.median(values):.2g}'):g}"
