"""Data measured on the built machine: what the study says of them, and their rows in SI units."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from designer import checked
from designer.arrays import BoolArray, FloatArray, IntArray
from designer.errors import InputError
from designer.model.cable import Cable
from designer.model.robot import Poses

Reading = Literal["length", "tension"]
POSES = "poses"
"""What ``unknown`` calls the poses of all rows."""


@dataclass(frozen=True, slots=True)
class LogColumn:
    """What one column of a log is to us: ``scale`` · reading + ``offset``."""

    name: str  #: Its name in the log
    #: Our name for it, see `designer.documents.columns`; ``ignore`` or ``covariate`` for none
    target: str
    #: From the log's numbers to ours, in the unit that our name ends in
    scale: float = 1.0
    offset: float = 0.0
    has_unit: bool = False  #: Whether the scale is said; else a row of units in the log tells it


@dataclass(frozen=True, slots=True)
class LogSession:
    """One of several times at which a machine was measured: its files, and what is its own."""

    file: Path  #: Table of measured poses, lengths and tensions
    #: Tables of the same rows at other times, which are joined to it
    more_files: tuple[Path, ...] = ()
    unknown: tuple[str, ...] = ()  #: Ids of what is fitted for this session alone

    @property
    def file_names(self) -> str:
        """What the tables are called, without their folders."""
        return ", ".join(path.name for path in (self.file, *self.more_files))


@checked.reports_field
@dataclass(frozen=True, slots=True)
class Measurements(checked.Value):
    """Data measured on the built machine, and what is known about it.

    Parameters
    ----------
    file : Path
        Table of measured poses, lengths and tensions.
    more_files : tuple of Path
        Tables of the same rows at other times, which are joined to it.
    linear_density_kg_per_m : float
        Mass per length of the cable on the machine [kg/m].
    axial_stiffness_N : float
        EA of the cable on the machine [N].
    columns : tuple of LogColumn
        Columns of the file that are not as our names and units say.
    settled : bool
        Whether the rows are poses at rest; False for samples of a slow motion.
    unknown : tuple of str
        Ids of what is fitted from the start and not counted as a finding; `POSES` as well.
    plausible_m : tuple of (str, float)
        How far from the drawing what is unknown may be, by its name in ``unknown`` [m]; the
        diagnosis has ranges of its own for the rest.
    length_noise_m : float or None
        Standard deviation of a measured length [m]; None where not given.
    tension_noise_N : float or None
        Standard deviation of a measured tension [N]; None where not given.
    position_noise_m, rotation_noise_rad : float or None
        Standard deviation of a measured coordinate [m] and angle [rad] of poses that are estimated;
        None where such are not used.
    sessions : tuple of LogSession
        Where the machine was measured several times, those, two at least; ``file`` is then that of
        the first, and all else is of all of them.
    place : str
        Where the study names the file.
    diameter_m : float or None
        Diameter of the cable, for effects of plugins that ask for it, and for bending [m].
    minimum_breaking_load_N : float or None
        Of the cable on the machine [N]; None where not given.
    estimated_noise : tuple of str
        Readings whose noise a diagnosis has estimated; the next one estimates it anew.
    search_time_s : float
        What the search for effects may take [s].
    """

    file: Path
    linear_density_kg_per_m: checked.Positive
    axial_stiffness_N: checked.Positive
    columns: tuple[LogColumn, ...] = ()
    settled: bool = True
    unknown: tuple[str, ...] = ()
    plausible_m: tuple[tuple[str, float], ...] = ()
    length_noise_m: checked.Positive | None = None
    tension_noise_N: checked.Positive | None = None
    diameter_m: checked.Positive | None = None
    minimum_breaking_load_N: checked.Positive | None = None
    estimated_noise: tuple[Reading, ...] = ()
    search_time_s: checked.NotNegative = 600.0
    more_files: tuple[Path, ...] = ()
    position_noise_m: checked.Positive | None = None
    rotation_noise_rad: checked.Positive | None = None
    sessions: tuple[LogSession, ...] = ()
    place: str = "measurements.file"

    @property
    def files(self) -> tuple[Path, ...]:
        """All tables."""
        of_sessions = [
            path for session in self.sessions for path in (session.file, *session.more_files)
        ]
        return tuple(of_sessions) or (self.file, *self.more_files)

    def of_file(self, file: Path) -> Measurements:
        """Return them with other data.

        Raises
        ------
        InputError
            If the data are of several sessions.
        """
        if self.sessions:
            problem = "cannot stand for the files of measurements.sessions"
            raise InputError.at(file, problem, "a study whose measurements name one file")
        return replace(self, file=file, more_files=())

    def of_session(self, session: int) -> Measurements:
        """Return those of one session, from 1, as if there were no other."""
        own = self.sessions[session - 1]
        return replace(
            self,
            file=own.file,
            more_files=own.more_files,
            unknown=(*self.unknown, *own.unknown),
            sessions=(),
            place=f"measurements.sessions[{session - 1}].file",
        )

    @property
    def with_nothing_unknown(self) -> Measurements:
        """The same, as if all were known."""
        sessions = tuple(replace(each, unknown=()) for each in self.sessions)
        return replace(self, unknown=(), sessions=sessions)

    @property
    def all_unknown(self) -> tuple[str, ...]:
        """What is unknown of the machine, and of any session."""
        every = (*self.unknown, *(name for each in self.sessions for name in each.unknown))
        return tuple(dict.fromkeys(every))

    @property
    def file_names(self) -> str:
        """What the tables are called, without their folders."""
        return ", ".join(path.name for path in self.files)

    def cable(self, allowable_tension_N: float = math.inf) -> Cable:
        """Return the cable on the machine; its diameter is NaN where it is not given."""
        return Cable(
            diameter_m=self.diameter_m or math.nan,
            linear_density_kg_per_m=self.linear_density_kg_per_m,
            axial_stiffness_N=self.axial_stiffness_N,
            allowable_tension_N=allowable_tension_N,
        )

    @property
    def declared_noise(self) -> dict[str, float]:
        """Standard deviations that are given, of ``length`` [m] and ``tension`` [N]."""
        given = {"length": self.length_noise_m, "tension": self.tension_noise_N}
        return {kind: size for kind, size in given.items() if size is not None}

    @property
    def has_poses(self) -> bool:
        """Whether poses were measured; else each row's own readings have to tell its pose."""
        return POSES not in self.unknown


@dataclass(frozen=True, slots=True, eq=False)
class Coordinates:
    """Some coordinates of each row's pose, in the robot's frame."""

    names: tuple[str, ...]  #: Of the columns of ``values``, as in a log
    #: (n_rows, 6): Position [m], then three Euler angles [rad]; NaN where not measured
    values: FloatArray
    #: Axes of the angles as SciPy has them: small letters for axes that stand still, capitals for
    #: such as turn with the body
    axes: str
    noise: FloatArray  #: (6,): Standard deviations [m, rad]

    @property
    def is_read(self) -> BoolArray:
        """Which were measured (n_rows, 6)."""
        return np.isfinite(self.values)

    @property
    def counts(self) -> dict[str, int]:
        """In how many rows each was measured, of those that were in any."""
        counts = self.is_read.sum(axis=0).tolist()
        return {name: n for name, n in zip(self.names, counts, strict=True) if n}

    def scaled_residuals(self, poses: Poses) -> FloatArray:
        """Return measured less those of poses (n_rows,), over the noise; 0 where not measured."""
        angles = np.zeros((len(self.values), 3))
        if self.is_read[:, 3:].any():
            angles = Rotation.from_matrix(poses.rotations).as_euler(self.axes)
        residual = self.values - np.hstack([poses.position_m, angles])
        residual[:, 3:] = (residual[:, 3:] + np.pi) % (2.0 * np.pi) - np.pi
        return np.nan_to_num(residual / self.noise)

    def rms_residuals(self, poses: Poses) -> dict[str, dict[str, float]]:
        """Return, the rows of each that was measured, and the root mean square of its residuals."""
        square = np.sum(self.scaled_residuals(poses) ** 2, axis=0)
        rms = dict(zip(self.names, square.tolist(), strict=True))
        return {
            name: {"rows": n, "rms_over_noise": float(np.sqrt(rms[name] / n))}
            for name, n in self.counts.items()
        }

    def imposed_on(self, poses: Poses) -> Poses:
        """Return poses (n_rows,) with what was measured instead; angles that were not are 0."""
        position = np.where(self.is_read[:, :3], self.values[:, :3], poses.position_m)
        if not self.is_read[:, 3:].any():
            return Poses(position, poses.rotation)
        turn = Rotation.from_euler(self.axes, np.nan_to_num(self.values[:, 3:]))
        return Poses(position, turn.as_matrix())

    def without(self, rows: BoolArray) -> Coordinates:
        """Return them with nothing measured in some rows (n_rows,)."""
        return replace(self, values=np.where(rows[:, None], np.nan, self.values))


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
    """Rows of measured data, in the order in which the poses were visited."""

    poses: Poses  #: Poses (n_rows,): measured, or estimated; NaN before that
    #: (n_rows, n_cables): Unstrained lengths by the winches' own scales [m]; NaN where missing
    length_m: FloatArray
    tension_N: FloatArray  #: (n_rows, n_cables): Tensions at the winches [N]; NaN where missing
    settled: bool  #: Whether each row is a pose at rest; False for samples of a slow motion
    #: (n_rows,): Time [s] and temperature [°C], where there is such a column
    time_s: FloatArray | None = None
    temperature_C: FloatArray | None = None
    wind_m_per_s: FloatArray | None = None  #: (n_rows, 3): Wind velocity, base frame [m/s]
    #: Every other numeric column, by its own name
    covariates: Mapping[str, FloatArray] = field(default_factory=dict)
    #: (n_rows,): Number of each row in the file, the first row below the head being 1
    row_numbers: IntArray = field(default_factory=lambda: np.empty(0, dtype=np.int64))
    #: What the reader of a report should know: columns that were left out, and why
    notes: tuple[str, ...] = ()
    thinned: str = ""  #: Which rows of a long log these are, in words; empty where they are all
    sha256: str = ""  #: Digest of the file's bytes; empty where there is no file
    #: Whether poses were measured; else each row's own readings have to tell its pose
    has_poses: bool = True
    #: What was measured of those poses, where they were in part
    coordinates: Coordinates | None = None
    #: (n_rows,): Number of the session of each row, from 1; None where all are of one
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
        recorded = {
            "time": self.time_s,
            "temperature": self.temperature_C,
            "wind": self.wind_m_per_s,
        }
        return frozenset(name for name, values in recorded.items() if values is not None)

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
    """Standard deviation of one reading."""

    #: Of a length [m] and of a tension [N]
    length_m: float
    tension_N: float
    source: str  #: ``declared``, or how it was estimated

    def of_channels(self, n_cables: int) -> FloatArray:
        """Return it for each channel: lengths [m], then tensions [N] (2 n_cables,)."""
        return np.repeat([self.length_m, self.tension_N], n_cables)


UNIT_NOISE = Noise(1.0, 1.0, "none")
"""A metre and a newton alike: before anything is known of the noise."""
