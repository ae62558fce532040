"""The sweep on disk: a NetCDF file that grows along its sample axis, read back by xarray."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from designer.arrays import FloatArray
from designer.errors import OutputError
from designer.model.verdict import Verdict
from designer.sizing.newton import Sizing

if TYPE_CHECKING:
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
_CHUNK = 2**11
"""Samples that a variable grows by on disk."""


@contextmanager
def sweep_file(
    path: Path, n_cables: int, attributes: Mapping[str, Any]
) -> Iterator[Callable[[FloatArray, Sizing], None]]:
    """Open a new NetCDF file, and hand out a function that writes one chunk behind what is there.

    ``attributes`` are provenance: text and numbers that are stored with the file.
    """
    import netCDF4

    with _write_failures_told(path), netCDF4.Dataset(path, "w") as file:
        file.setncatts(dict(attributes))
        sizes = {"sample": None, "axis": 3, "cable": n_cables}
        for name, size in sizes.items():
            file.createDimension(name, size)
        for name, (extra, unit, meaning) in _COLUMNS.items():
            axes = ("sample",) if extra is None else ("sample", extra)
            chunks = [sizes[axis] or _CHUNK for axis in axes]
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
def _write_failures_told(path: Path) -> Iterator[None]:
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
