"""Sizing over the whole workspace: samples first, then the continuous search for the worst.

Samples go to a NetCDF file that grows along its sample axis, so that memory does not. Counted on
the way are verdicts, and samples in which a cable hangs as none should: far longer than its chord,
or below the floor.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from designer import checked
from designer.arrays import BoolArray, FloatArray
from designer.documents.plain import record
from designer.errors import OutputError
from designer.model.cable import Cable, Cables, Material
from designer.model.robot import Poses, Robot
from designer.model.space import named_orientation, named_pose, rotation_vector_of
from designer.model.verdict import Verdict
from designer.model.workspace import Workspace
from designer.progress import Advance
from designer.sizing.newton import Sizing, limit_ratio, size_poses
from designer.statics.inverse import Statics, solve_sagging
from designer.statics.task import LONG
from designer.workspace.demand import (
    diameter_demand,
    is_counted,
    is_left_out,
    massless_demand,
    massless_demand_of,
    size_worst,
)
from designer.workspace.refine import Pool, refine

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr


_COLUMNS = {
    "position": ("axis", "m", "position of the platform, world frame"),
    "rotation_vector": ("axis", "rad", "the worst orientation there"),
    "diameter": (None, "m", "needed diameter with sag"),
    "max_tension": (None, "N", "largest tension with that diameter"),
    "massless_diameter": (None, "m", "needed diameter with straight weightless cables"),
    "massless_max_tension": (None, "N", "largest tension with straight weightless cables"),
    "length": ("cable", "m", "unstrained length"),
    "exit_tension": ("cable", "N", "tension at the exit point"),
    "platform_tension": ("cable", "N", "tension at the platform"),
    "closure_residual": (None, "m", "worst closure error of the cable equations"),
    "equilibrium_residual": (None, "N", "what is left of the platform's balance"),
    "verdict": (None, "", "outcome of the pose"),
    "hangs_below": (None, "", "1 where a cable hangs below the platform"),
}
"""Of each variable its second axis, its unit (of those without, whole numbers) and its meaning."""
_PACKED = ("rotation_vector", "verdict", "hangs_below")
"""To compress the others takes ten times as long as to write them, and spares a seventh of them."""
_FILE_CHUNK = 2**11
"""Samples that a variable grows by on disk."""


@contextmanager
def sweep_file(
    path: Path, n_cables: int, attributes: Mapping[str, Any]
) -> Iterator[Callable[[FloatArray, Sizing], None]]:
    """Open a new NetCDF file, and hand out a function that writes one chunk behind what is there.

    ``attributes`` are provenance: text and numbers that are stored with the file.
    """
    import netCDF4

    with _disk_errors(path), netCDF4.Dataset(path, "w") as file:
        file.setncatts(dict(attributes))
        sizes = {"sample": None, "axis": 3, "cable": n_cables}
        for name, size in sizes.items():
            file.createDimension(name, size)
        for name, (extra, unit, meaning) in _COLUMNS.items():
            axes = ("sample",) if extra is None else ("sample", extra)
            chunks = [sizes[axis] or _FILE_CHUNK for axis in axes]
            kind, packs = "f8" if unit else "i1", name in _PACKED
            file.createVariable(name, kind, axes, chunksizes=chunks, zlib=packs, complevel=1)
            file[name].setncatts({"units": unit} if unit else {})
            file[name].long_name = meaning
        file["verdict"].flag_values = np.array([int(v) for v in Verdict], dtype=np.int8)
        file["verdict"].flag_meanings = " ".join(v.label for v in Verdict)

        def append(places: FloatArray, sizing: Sizing) -> None:
            start = file.dimensions["sample"].size
            for name, value in _values(places, sizing).items():
                file[name][start : start + len(places)] = value

        yield append


@contextmanager
def _disk_errors(path: Path) -> Iterator[None]:
    """Turn the library's own error, which it raises where a disk is full, into one for the user."""
    try:
        yield
    except RuntimeError as error:
        if not str(error).startswith("NetCDF:"):
            raise
        line = f"{path.name}: cannot be written ({error}; is the disk full?)"
        raise OutputError(line) from error


def _values(places: FloatArray, sizing: Sizing) -> Mapping[str, Any]:
    statics = sizing.statics
    exit_N, platform_N = statics.end_tensions_N
    return {
        "position": places[:, :3],
        "rotation_vector": places[:, 3:] if places.shape[1] > 3 else 0.0 * places,
        "diameter": sizing.diameter_m,
        "max_tension": np.maximum(exit_N, platform_N).max(axis=-1),
        "massless_diameter": sizing.massless_diameter_m,
        "massless_max_tension": sizing.massless_tension_N,
        "length": statics.length_m,
        "exit_tension": exit_N,
        "platform_tension": platform_N,
        "closure_residual": sizing.closure_residual_m,
        "equilibrium_residual": sizing.equilibrium_residual_N,
        "verdict": statics.verdict,
        "hangs_below": statics.hangs_below,
    }


def columns(path: Path, *names: str) -> list[NDArray[Any]]:
    """Return variables of the sweep as arrays, without xarray, which takes a while to come up."""
    import netCDF4

    with netCDF4.Dataset(path) as file:
        file.set_auto_mask(False)
        return [file[name][:] for name in names]


def open_sweep(path: Path) -> xr.Dataset:
    """Return the sweep as an xarray Dataset, with units in the attributes of each variable."""
    import xarray as xr

    return xr.open_dataset(path, engine="netcdf4")


@dataclass(frozen=True, slots=True)
class Hanging:
    """Samples in which a cable hangs too far, and the worst of them."""

    samples: int  #: how many there are
    extreme: float  #: the largest length over chord; or the height of the lowest point [m]
    cable: int  #: which cable, counted from 1
    place: tuple[float, ...]  #: in which sample, see `designer.model.space` [m, rad]


def _named(name: str, extreme: str) -> dict[str, Any]:
    """Return how files of results name one of the two kinds, and its worst value."""

    def named(worst: Hanging | None) -> dict[str, Any]:
        if worst is None:
            return {name: {"samples": 0}}
        pose = named_pose(np.array(worst.place))
        return {
            name: {"samples": worst.samples, extreme: worst.extreme, "cable": worst.cable, **pose}
        }

    return {"json": named}


def _add(
    before: Hanging | None,
    places: FloatArray,
    values: FloatArray,
    counts: BoolArray,
    limit: float,
    *,
    sign: float,
) -> Hanging | None:
    """Count samples with a value beyond the limit; `sign` tells on which side of it."""
    excess = sign * (values - limit)
    beyond = counts[:, None] & (excess > 0.0)
    if not beyond.any():
        return before
    at, cable = np.unravel_index(np.where(beyond, excess, 0.0).argmax(), excess.shape)
    samples = int(beyond.any(axis=1).sum())
    hanging = Hanging(samples, float(values[at, cable]), int(cable) + 1, tuple(places[at].tolist()))
    if before is None:
        return hanging
    farthest = max(before, hanging, key=lambda candidate: sign * candidate.extreme)
    total = before.samples + samples
    return Hanging(total, farthest.extreme, farthest.cable, farthest.place)


@dataclass(frozen=True, slots=True)
class HangingCables:
    """What hangs too far over a workspace; None where nothing does."""

    #: samples looked at: those that are solved and count
    samples: int = field(default=0, metadata={"json": None})
    #: cables longer than `LONG` times their chord
    long: Hanging | None = field(default=None, metadata=_named("long_cables", "length_over_chord"))
    #: cables that hang below the floor; None also where the study has no floor
    below_floor: Hanging | None = field(default=None, metadata=_named("below_floor", "lowest_m"))

    def with_samples(
        self, places: FloatArray, statics: Statics, counts: BoolArray, floor_m: float | None
    ) -> HangingCables:
        """Return the same with samples (n, n_coordinates) added, if they count.

        No cable may hang below ``floor_m``, upright frame [m].
        """
        long = _add(self.long, places, statics.length_over_chord, counts, LONG, sign=1.0)
        below = self.below_floor
        if floor_m is not None:
            below = _add(below, places, statics.lowest_m, counts, floor_m, sign=-1.0)
        return HangingCables(self.samples + int(counts.sum()), long, below)

    def notes(self) -> Iterator[tuple[str, str]]:
        """Yield a heading and a few words for each of the two that there is."""
        kinds = (
            ("long cables", self.long, "times its chord"),
            ("below floor", self.below_floor, "m"),
        )
        for heading, hanging, unit in kinds:
            if hanging is not None:
                share = f"{hanging.samples / self.samples:.2%} of the samples"
                yield (
                    heading,
                    f"{share}, cable {hanging.cable} at the worst {hanging.extreme:.4g} {unit}",
                )


def survey_hanging(robot: Robot, workspace: Workspace, cable: Cable | Cables) -> HangingCables:
    """Return which samples of the workspace have such a cable, with these cables on the machine."""
    hanging_cables = HangingCables()
    for places in workspace.places():
        statics = solve_sagging(robot, Poses.at(places), cable)
        counts = is_counted(statics, workspace.hangs_below)
        hanging_cables = hanging_cables.with_samples(places, statics, counts, workspace.floor_m)
    return hanging_cables


def _named_example(place: FloatArray | None) -> dict[str, FloatArray | None]:
    if place is None:
        return {"infeasible_example_m": None}
    return {
        "infeasible_example_m": place[:3],
        **named_orientation(place, "infeasible_rotation_vector"),
    }


@dataclass(frozen=True, slots=True, eq=False)
class Extreme:
    """The pose that asks for the most."""

    #: (n_coordinates,) see `designer.model.space` [m, rad]
    place: FloatArray = field(metadata={"json": named_pose})
    diameter_m: float  #: the cable that it needs [m]; for a given cable, the diameter of that cable
    max_tension_N: float  #: the largest tension there [N]

    @property
    def position_m(self) -> FloatArray:
        """Where it is (3,) [m]."""
        return self.place[:3]

    @property
    def rotation_vector_rad(self) -> FloatArray:
        """How the platform is turned there (3,) [rad]."""
        return rotation_vector_of(self.place)

    @property
    def pose(self) -> Poses:
        """Position and orientation."""
        return Poses.at(self.place)


@dataclass(frozen=True, slots=True)
class Census:
    """How many samples met with which verdict."""

    samples: int  #: all samples
    statuses: Mapping[str, int]  #: count of each verdict by its label, every label present
    hangs_below: int  #: solved samples in which a cable hangs below the platform
    excluded: int  #: those of them that the study leaves out
    #: those that count in which a cable is far longer than its chord, or hangs below the floor
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
    """Sizing over the whole workspace."""

    workspace: Workspace = field(metadata={"json": None})
    census: Census = field(metadata={"json": record})  #: verdict counts
    #: whether every pose of the region has a finite cable: every sample is solved (or left out on
    #: purpose) and the continuous search met no pose without one
    is_feasible: bool = field(metadata={"json": "feasible"})
    #: the worst pose of the region, refined beyond the samples; None if not feasible, because then
    #: the needed diameter grows without bound toward the infeasible part
    sagging: Extreme | None
    sampled: Extreme | None  #: the worst solved sample; None if no sample is solved
    #: the worst pose of the region with straight weightless cables; None where they do not hold
    #: every pose that counts, because their tension can then grow without bound
    massless: Extreme | None
    #: (n_coordinates,) A place without a finite cable, where there is one [m, rad]
    infeasible_place: FloatArray | None = field(metadata={"json": _named_example})
    #: stress at infinite section over allowable stress at the worst pose; 1 is the boundary beyond
    #: which no cable exists. NaN if not feasible.
    limit_ratio: float
    #: NetCDF file with every sample, where one was written
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


class _Gathered:
    """Running totals of a sweep, and the few samples that the search starts from."""

    def __init__(self, workspace: Workspace) -> None:
        self._workspace = workspace
        self.verdicts: Counter[int] = Counter()
        self.hangs_below = 0
        self.excluded = 0
        self.hanging = HangingCables()
        self.starts = Pool(workspace.space)
        self.massless_starts = Pool(workspace.space)
        self.sampled: Extreme | None = None
        self.infeasible_example: FloatArray | None = None

    def add(self, places: FloatArray, sizing: Sizing) -> None:
        statics = sizing.statics
        left_out = is_left_out(statics, self._workspace.hangs_below)
        self.verdicts.update(dict(enumerate(np.bincount(statics.verdict).tolist())))
        self.hangs_below += int(statics.hangs_below.sum())
        self.excluded += int(left_out.sum())
        counts = statics.is_solved & ~left_out
        self.hanging = self.hanging.with_samples(places, statics, counts, self._workspace.floor_m)
        diameter = np.where(counts, sizing.diameter_m, -np.inf)
        self.starts.add(places, diameter)
        straight = massless_demand_of(sizing, self._workspace.hangs_below)
        self.massless_starts.add(places, straight)
        at = int(np.argmax(diameter))
        diameter_m = -np.inf if self.sampled is None else self.sampled.diameter_m
        if diameter[at] > diameter_m:
            tension = float(statics.largest_tension_N[at])
            self.sampled = Extreme(places[at], float(diameter[at]), tension)
        served = statics.is_solved | left_out
        if self.infeasible_example is None and not served.all():
            self.infeasible_example = places[int(np.argmin(served))]


def map_workspace(
    robot: Robot,
    workspace: Workspace,
    material: Material,
    *,
    file: Path | None = None,
    attributes: Mapping[str, Any] = MappingProxyType({}),
    progress: Advance = lambda _: None,
    with_massless: bool = True,
) -> WorkspaceMap:
    """Size every sample of the workspace, and find the worst pose of the region.

    Parameters
    ----------
    file : Path, optional
        NetCDF file that receives every sample; without it only the summary is kept, and memory
        does not grow with the number of samples in either case.
    attributes : mapping, optional
        Provenance that is stored in the file.
    progress : callable
        Called after each chunk.
    with_massless : bool
        Whether to search for the worst pose of straight weightless cables as well.
    """
    gathered = _Gathered(workspace)
    opened = sweep_file(file, robot.n_cables, attributes) if file else nullcontext(lambda *_: None)
    with opened as store:
        for positions in workspace.positions_m():
            places, sizing = size_worst(robot, workspace, positions, material)
            gathered.add(places, sizing)
            store(places, sizing)
            progress(len(positions))
    example = gathered.infeasible_example
    sagging = massless = None
    ratio = np.nan
    if example is None and gathered.sampled is not None:
        demand = partial(diameter_demand, robot, material, workspace.hangs_below)
        (worst,) = refine(workspace.space, demand, gathered.starts.places)
        if np.isfinite(worst.demand):
            pose = Poses.at(worst.place)
            tension = float(size_poses(robot, pose, material).statics.largest_tension_N)
            sagging = Extreme(worst.place, worst.demand, tension)
            ratio = float(limit_ratio(robot, pose, material))
        else:
            example = worst.place
    starts = gathered.massless_starts.places
    if with_massless and len(starts):
        demand = partial(massless_demand, robot, material, workspace.hangs_below)
        (worst,) = refine(workspace.space, demand, starts)
        if np.isfinite(worst.demand):
            diameter = material.diameter_for_tension_m(worst.demand)
            massless = Extreme(worst.place, diameter, worst.demand)
    statuses = {v.label: gathered.verdicts[int(v)] for v in Verdict}
    return WorkspaceMap(
        workspace=workspace,
        census=Census(
            samples=sum(statuses.values()),
            statuses=statuses,
            hangs_below=gathered.hangs_below,
            excluded=gathered.excluded,
            hanging=gathered.hanging,
        ),
        is_feasible=sagging is not None,
        sagging=sagging,
        sampled=gathered.sampled,
        massless=massless,
        infeasible_place=example,
        limit_ratio=ratio,
        file=file,
    )
