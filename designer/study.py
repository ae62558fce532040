"""The whole problem as one frozen value, in SI units."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from designer.cable import Material
from designer.region import Region
from designer.robot import Poses, Robot

Sampling = Literal["low_discrepancy", "grid"]
HangsBelow = Literal["include", "exclude"]


@dataclass(frozen=True, slots=True)
class Workspace:
    """Which poses the cable must serve.

    Parameters
    ----------
    region : Region
        Prism or list of points, world frame.
    samples : int
        Number of poses to try (a list of points is taken whole).
    sampling : str
        ``low_discrepancy`` (Sobol) or ``grid``.
    seed : int
        Seed of the Sobol scrambling.
    hangs_below : str
        ``include`` or ``exclude`` poses in which a cable hangs below the platform.
    """

    region: Region
    samples: int = 20_000
    sampling: Sampling = "low_discrepancy"
    seed: int = 0
    hangs_below: HangsBelow = "include"


@dataclass(frozen=True, slots=True)
class Selection:
    """How a product is chosen.

    Parameters
    ----------
    grades : tuple of str or None
        Grade ids to consider; None for every grade in the catalogue.
    safety_factor : float
        Minimum breaking load over allowable tension.
    """

    grades: tuple[str, ...] | None = None
    safety_factor: float = 5.0


@dataclass(frozen=True, slots=True)
class Entry:
    """One value of the config, as written and as understood.

    Parameters
    ----------
    field : str
        Path into the document, such as ``robot.platform.mass``.
    given : str
        What the file says; ``default`` where it says nothing.
    value_SI : str
        The same in SI units, with the unit.
    """

    field: str
    given: str
    value_SI: str


@dataclass(frozen=True, slots=True)
class Source:
    """Where a study came from.

    Parameters
    ----------
    path : Path
        The config file.
    sha256 : str
        Digest of its bytes.
    entries : tuple of Entry
        Every field, for the report's table of inputs.
    """

    path: Path
    sha256: str
    entries: tuple[Entry, ...]


@dataclass(frozen=True, slots=True)
class Study:
    """A robot, its load, where it works, and how its cable is to be chosen."""

    name: str
    robot: Robot
    material: Material
    source: Source
    pose: Poses | None = None
    workspace: Workspace | None = None
    selection: Selection | None = None
    catalogues: tuple[Path, ...] = ()
