"""What a sweep over the workspace found."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from designer.arrays import FloatArray, frozen_array
from designer.model.robot import Poses
from designer.model.space import turn_of
from designer.workspace.hanging import HangingCables
from designer.workspace.store import open_sweep

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True, slots=True, eq=False)
class Extreme:
    """The pose that asks for the most.

    Parameters
    ----------
    position_m : array (3,)
        Where it is [m].
    diameter_m : float
        The cable that it needs [m]; for a given cable, the diameter of that cable.
    max_tension_N : float
        The largest tension there [N].
    rotation_vector_rad : array (3,)
        How the platform is turned there [rad].
    """

    position_m: FloatArray
    diameter_m: float
    max_tension_N: float
    rotation_vector_rad: FloatArray = field(default_factory=lambda: frozen_array(np.zeros(3)))

    @classmethod
    def at(cls, place: FloatArray, diameter_m: float, max_tension_N: float) -> Extreme:
        """Return the extreme at a place (n_coordinates,)."""
        return cls(place[:3], diameter_m, max_tension_N, turn_of(place))

    @property
    def place(self) -> FloatArray:
        """Position and rotation vector in one array (6,) [m, rad]."""
        return np.concatenate([self.position_m, self.rotation_vector_rad])

    @property
    def pose(self) -> Poses:
        """Position and orientation."""
        return Poses.at(self.place)


@dataclass(frozen=True, slots=True)
class Census:
    """How many samples met with which verdict.

    Parameters
    ----------
    samples : int
        All samples.
    statuses : mapping of str to int
        Count of each verdict by its label, every label present.
    hangs_below : int
        Solved samples in which a cable hangs below the platform.
    excluded : int
        Those of them that the study leaves out.
    hanging : HangingCables
        Those that count in which a cable is far longer than its chord, or hangs below the floor.
    """

    samples: int
    statuses: Mapping[str, int]
    hangs_below: int
    excluded: int
    hanging: HangingCables = field(default_factory=HangingCables)

    @property
    def is_all_left_out(self) -> bool:
        """Whether no sample counts."""
        return self.excluded == self.samples

    def fraction(self, status: str) -> float:
        """Return the share of the samples, hence of the volume, with this verdict."""
        return self.statuses[status] / self.samples


@dataclass(frozen=True, slots=True, eq=False)
class WorkspaceMap:
    """Sizing over the whole workspace.

    Parameters
    ----------
    census : Census
        Verdict counts.
    is_feasible : bool
        Whether every pose of the region has a finite cable: every sample is solved (or left out
        on purpose) and the continuous search met no pose without one.
    sagging : Extreme or None
        The worst pose of the region, refined beyond the samples; None if not feasible, because
        then the needed diameter grows without bound toward the infeasible part.
    sampled : Extreme or None
        The worst solved sample; None if no sample is solved.
    massless : Extreme or None
        The worst pose of the region with straight weightless cables; None where they do not hold
        every pose that counts, because their tension can then grow without bound.
    infeasible_example_m : array (3,) or None
        A position without a finite cable, where there is one [m].
    limit_ratio : float
        Stress at infinite section over allowable stress at the worst pose; 1 is the boundary
        beyond which no cable exists. NaN if not feasible.
    infeasible_rotation_vector_rad : array (3,) or None
        How the platform is turned in that position [rad].
    file : Path or None
        NetCDF file with every sample, where one was written.
    """

    census: Census
    is_feasible: bool
    sagging: Extreme | None
    sampled: Extreme | None
    massless: Extreme | None
    infeasible_example_m: FloatArray | None
    limit_ratio: float
    infeasible_rotation_vector_rad: FloatArray | None = None
    file: Path | None = None

    def to_xarray(self) -> xr.Dataset:
        """Return every sample along ``sample``, with units in the attributes of each variable.

        Raises
        ------
        ValueError
            If no file was written.
        """
        if self.file is None:
            raise ValueError("samples are kept in a file only; map_workspace(file=...) writes one")
        with open_sweep(self.file) as sweep:
            return sweep.load()

    @property
    def infeasible_pose(self) -> Poses | None:
        """The pose without a finite cable, where there is one."""
        if self.infeasible_example_m is None:
            return None
        return Poses.at(self.infeasible_example_m, self.infeasible_rotation_vector_rad)
