"""Measured poses, lengths and tensions, in SI units."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from designer.arrays import BoolArray, FloatArray, IntArray
from designer.model.coordinates import Coordinates
from designer.model.robot import Poses


class ReadingKind(NamedTuple):
    """A kind of reading: its name, its SI unit, the unit that it is shown in, the scale to that."""

    name: str
    unit_SI: str
    unit: str
    scale: float

    def of(self, values: Any) -> Any:
        """Return what stages, data and the like have of this kind, as ``length_m``."""
        return getattr(values, f"{self.name}_{self.unit_SI}")


KINDS = (ReadingKind("length", "m", "mm", 1e3), ReadingKind("tension", "N", "N", 1.0))


@dataclass(frozen=True, slots=True, eq=False)
class Measured:
    """Rows of measured data, in the order in which the poses were visited.

    Parameters
    ----------
    poses : Poses
        Poses (n_rows,): measured, or estimated; NaN before that.
    length_m : array (n_rows, n_cables)
        Unstrained lengths by the winches' own scales [m]; NaN where missing.
    tension_N : array (n_rows, n_cables)
        Tensions at the winches [N]; NaN where missing.
    settled : bool
        Whether each row is a pose at rest; False for samples of a slow motion.
    time_s, temperature_C : array (n_rows,) or None
        Time [s] and temperature [°C], where there is such a column.
    wind_m_per_s : array (n_rows, 3) or None
        Wind velocity, base frame [m/s].
    covariates : mapping of str to array (n_rows,)
        Every other numeric column, by its own name.
    row_numbers : array (n_rows,)
        Number of each row in the file, the first row below the head being 1.
    notes : tuple of str
        What the reader of a report should know: columns that were left out, and why.
    thinned : str
        Which rows of a long log these are, in words; empty where they are all.
    sha256 : str
        Digest of the file's bytes; empty where there is no file.
    has_poses : bool
        Whether poses were measured; else each row's own readings have to tell its pose.
    coordinates : Coordinates or None
        What was measured of those poses, where they were in part.
    session : array (n_rows,) or None
        Number of the session of each row, from 1; None where all are of one.
    """

    poses: Poses
    length_m: FloatArray
    tension_N: FloatArray
    settled: bool
    time_s: FloatArray | None = None
    temperature_C: FloatArray | None = None
    wind_m_per_s: FloatArray | None = None
    covariates: Mapping[str, FloatArray] = field(default_factory=dict)
    row_numbers: IntArray = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    notes: tuple[str, ...] = ()
    thinned: str = ""
    sha256: str = ""
    has_poses: bool = True
    coordinates: Coordinates | None = None
    session: IntArray | None = None

    @property
    def n_rows(self) -> int:
        """Number of rows."""
        return len(self.length_m)

    @property
    def readings(self) -> FloatArray:
        """Lengths [m], then tensions [N] (n_rows, 2 n_cables); NaN where missing."""
        return np.hstack([self.length_m, self.tension_N])

    @property
    def is_read(self) -> BoolArray:
        """Which lengths, tensions, and coordinates of poses in part, there are (n_rows, …)."""
        readings = np.isfinite(self.readings)
        return (
            readings
            if self.coordinates is None
            else np.hstack([readings, self.coordinates.is_read])
        )

    @property
    def n_readings(self) -> IntArray:
        """Number of readings in each row (n_rows,), coordinates of poses in part among them."""
        return np.asarray(self.is_read.sum(axis=1))

    @property
    def origin_of_poses(self) -> str:
        """Where the poses come from, in a sentence; empty where they were measured."""
        if self.has_poses:
            return ""
        if self.coordinates is None:
            return "No pose was measured; each is estimated from the row's own readings."
        counts = (f"{name} in {n}" for name, n in self.coordinates.counts.items())
        return (
            f"Poses were measured in part: of {self.n_rows} rows {', '.join(counts)}. The rest of "
            "each is estimated from the row's own readings."
        )

    @property
    def columns(self) -> frozenset[str]:
        """Kinds of surroundings that were recorded: ``time``, ``temperature``, ``wind``."""
        found = {"time": self.time_s, "temperature": self.temperature_C, "wind": self.wind_m_per_s}
        return frozenset(name for name, values in found.items() if values is not None)

    def part(self, rows: BoolArray) -> Measured:
        """Return some of the rows (n_rows,), of measured poses, as rows of one session."""

        def of(values: FloatArray | None) -> FloatArray | None:
            return None if values is None else values[rows]

        return replace(
            self,
            poses=self.poses.part(np.flatnonzero(rows)),
            length_m=self.length_m[rows],
            tension_N=self.tension_N[rows],
            time_s=of(self.time_s),
            temperature_C=of(self.temperature_C),
            wind_m_per_s=of(self.wind_m_per_s),
            covariates={name: values[rows] for name, values in self.covariates.items()},
            row_numbers=self.row_numbers[rows],
            session=None,
        )

    def without_readings(self, rows: BoolArray) -> Measured:
        """Return the same rows, with no reading in some of them (n_rows,)."""
        hidden = rows[:, None]
        return replace(
            self,
            length_m=np.where(hidden, np.nan, self.length_m),
            tension_N=np.where(hidden, np.nan, self.tension_N),
            coordinates=self.coordinates and self.coordinates.without(rows),
        )


@dataclass(frozen=True, slots=True)
class Noise:
    """Standard deviation of one reading.

    Parameters
    ----------
    length_m, tension_N : float
        Of a length [m] and of a tension [N].
    source : str
        ``declared``, or how it was estimated.
    """

    length_m: float
    tension_N: float
    source: str

    def of_channels(self, n_cables: int) -> FloatArray:
        """Return it for each channel: lengths [m], then tensions [N] (2 n_cables,)."""
        return np.repeat([self.length_m, self.tension_N], n_cables)


EVEN = Noise(1.0, 1.0, "none")
"""A metre and a newton alike: before anything is known of the noise."""
