"""What a sweep over the workspace found."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from designer import checked
from designer.arrays import FloatArray
from designer.documents.plain import record
from designer.model.robot import Poses
from designer.model.space import named_pose, named_turn, turn_of
from designer.model.verdict import Verdict
from designer.workspace.hanging import HangingCables
from designer.workspace.store import open_sweep

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr


def _named_example(place: FloatArray | None) -> dict[str, FloatArray | None]:
    if place is None:
        return {"infeasible_example_m": None}
    return {"infeasible_example_m": place[:3], **named_turn(place, "infeasible_rotation_vector")}


@dataclass(frozen=True, slots=True, eq=False)
class Extreme:
    """The pose that asks for the most.

    Parameters
    ----------
    place : array (n_coordinates,)
        Where it is, and how the platform is turned there, see `designer.model.space` [m, rad].
    diameter_m : float
        The cable that it needs [m]; for a given cable, the diameter of that cable.
    max_tension_N : float
        The largest tension there [N].
    """

    place: FloatArray = field(metadata={"json": named_pose})
    diameter_m: float
    max_tension_N: float

    @property
    def position_m(self) -> FloatArray:
        """Where it is (3,) [m]."""
        return self.place[:3]

    @property
    def rotation_vector_rad(self) -> FloatArray:
        """How the platform is turned there (3,) [rad]."""
        return turn_of(self.place)

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
    hanging: HangingCables = field(default_factory=HangingCables, metadata={"json": record})

    also_in_files: ClassVar = ("fraction_no_finite_cable",)

    @property
    def fraction_no_finite_cable(self) -> float:
        """Share of the samples that no section of the family can hold."""
        return self.fraction(Verdict.NO_FINITE_CABLE.label)

    @property
    def is_all_left_out(self) -> bool:
        """Whether no sample counts."""
        return self.excluded == self.samples

    def fraction(self, status: str) -> float:
        """Return the share of the samples, hence of the volume, with this verdict."""
        return self.statuses[status] / self.samples


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class WorkspaceMap(checked.Shown):
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
    infeasible_place : array (n_coordinates,) or None
        A place without a finite cable, where there is one [m, rad].
    limit_ratio : float
        Stress at infinite section over allowable stress at the worst pose; 1 is the boundary
        beyond which no cable exists. NaN if not feasible.
    file : Path or None
        NetCDF file with every sample, where one was written.
    """

    census: Census = field(metadata={"json": record})
    is_feasible: bool = field(metadata={"json": "feasible"})
    sagging: Extreme | None
    sampled: Extreme | None
    massless: Extreme | None
    infeasible_place: FloatArray | None = field(metadata={"json": _named_example})
    limit_ratio: float
    file: Path | None = field(default=None, metadata={"json": None})

    also_in_files: ClassVar = ("reason",)

    @property
    def reason(self) -> str | None:
        """Why no cable of the family holds the whole region; None where one does."""
        if self.is_feasible:
            return None
        counts = self.census.statuses
        unserved = [v for v in Verdict if v is not Verdict.SOLVED and counts[v.label] > 0]
        if unserved:
            return " ".join(f"{counts[v.label]} samples: {v.sentence}" for v in unserved)
        if self.infeasible_place is None:
            return "Every pose is left out."
        return "The search between the samples met a pose without a finite cable."

    def to_xarray(self) -> xr.Dataset:
        """Return every sample along ``sample``, with units in the attributes of each variable.

        Along ``axis`` are x, y and z, along ``cable`` their numbers from 1.

        Raises
        ------
        ValueError
            If no file was written.
        """
        if self.file is None:
            raise ValueError("samples are kept in a file only; map_workspace(file=...) writes one")
        with open_sweep(self.file) as sweep:
            cables = range(1, sweep.sizes["cable"] + 1)
            return sweep.load().assign_coords(axis=[*"xyz"], cable=[*cables])

    def to_dataframe(self) -> pd.DataFrame:
        """Return one row a sample, such as with the columns position_x and length_1."""
        import pandas as pd

        samples = self.to_xarray()
        columns = {}
        for name, variable in samples.data_vars.items():
            labels = [*samples[variable.dims[1]].values] if variable.ndim > 1 else [None]
            for column, label in zip(np.atleast_2d(variable.values.T), labels, strict=True):
                columns[str(name) if label is None else f"{name}_{label}"] = column
        columns["verdict"] = [Verdict(int(code)).label for code in columns["verdict"]]
        return pd.DataFrame(columns).rename_axis("sample")

    @property
    def infeasible_example_m(self) -> FloatArray | None:
        """The position of that place [m]."""
        return None if self.infeasible_place is None else self.infeasible_place[:3]

    @property
    def infeasible_pose(self) -> Poses | None:
        """The pose without a finite cable, where there is one."""
        return None if self.infeasible_place is None else Poses.at(self.infeasible_place)
