"""What a study says of the data measured on the built machine."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

from designer import checked
from designer.errors import InputError
from designer.model.cable import Cable

Reading = Literal["length", "tension"]
POSES = "poses"
"""What ``unknown`` calls the poses of all rows."""


@dataclass(frozen=True, slots=True)
class LogColumn:
    """What one column of a log is to us: ``scale`` · reading + ``offset``.

    Parameters
    ----------
    name : str
        Its name in the log.
    target : str
        Our name for it, see `designer.measured.assign`; ``ignore`` or ``covariate`` for none.
    scale, offset : float
        From the log's numbers to ours, in the unit that our name ends in.
    has_unit : bool
        Whether the scale is said; else a row of units in the log tells it.
    """

    name: str
    target: str
    scale: float = 1.0
    offset: float = 0.0
    has_unit: bool = False


@dataclass(frozen=True, slots=True)
class LogSession:
    """One of several times at which a machine was measured: its files, and what is its own.

    Parameters
    ----------
    file : Path
        Table of measured poses, lengths and tensions.
    more_files : tuple of Path
        Tables of the same rows at other times, which are joined to it.
    unknown : tuple of str
        Ids of what is fitted for this session alone.
    """

    file: Path
    more_files: tuple[Path, ...] = ()
    unknown: tuple[str, ...] = ()

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
        of_sessions = [path for each in self.sessions for path in (each.file, *each.more_files)]
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
