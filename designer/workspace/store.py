"""The sweep on disk: a NetCDF file that grows along its sample axis, read back by xarray."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any

import numpy as np

from designer.arrays import FloatArray
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
}


class SweepFile:
    """Context manager that appends chunks of a sweep to a new NetCDF file.

    ``attributes`` are provenance: text and numbers that are stored with the file.
    """

    def __init__(self, path: Path, n_cables: int, attributes: Mapping[str, Any]) -> None:
        import netCDF4

        self._file = netCDF4.Dataset(path, "w")
        self._file.setncatts(dict(attributes))
        for name, size in (("sample", None), ("axis", 3), ("cable", n_cables)):
            self._file.createDimension(name, size)
        for name, (extra, unit, meaning) in _COLUMNS.items():
            self._create(name, "f8", ("sample",) if extra is None else ("sample", extra))
            self._file[name].setncatts({"units": unit, "long_name": meaning})
        self._create("verdict", "i1", ("sample",))
        self._file["verdict"].setncatts(
            {
                "long_name": "outcome of the pose",
                "flag_values": np.array([int(v) for v in Verdict], dtype=np.int8),
                "flag_meanings": " ".join(v.label for v in Verdict),
            }
        )
        self._create("hangs_below", "i1", ("sample",))
        self._file["hangs_below"].long_name = "1 where a cable hangs below the platform"

    def append(self, some_places: FloatArray, sizing: Sizing) -> None:
        """Write one chunk behind what is there."""
        statics = sizing.statics
        turns = some_places[:, 3:] if some_places.shape[1] > 3 else np.zeros_like(some_places)
        values = {
            "position": some_places[:, :3],
            "rotation_vector": turns,
            "diameter": sizing.diameter_m,
            "max_tension": statics.largest_tension_N,
            "massless_diameter": sizing.massless_diameter_m,
            "massless_max_tension": sizing.massless_tension_N,
            "length": statics.length_m,
            "exit_tension": statics.exit_tension_N,
            "platform_tension": statics.platform_tension_N,
            "closure_residual": sizing.closure_residual_m,
            "equilibrium_residual": sizing.equilibrium_residual_N,
            "verdict": statics.verdict,
            "hangs_below": statics.hangs_below,
        }
        start = self._file.dimensions["sample"].size
        for name, value in values.items():
            self._file[name][start : start + len(some_places)] = value

    def __enter__(self) -> SweepFile:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._file.close()

    def _create(self, name: str, dtype: str, dimensions: tuple[str, ...]) -> None:
        chunks = tuple(
            2**15 if d == "sample" else self._file.dimensions[d].size for d in dimensions
        )
        self._file.createVariable(
            name, dtype, dimensions, chunksizes=chunks, zlib=True, complevel=1
        )


def open_sweep(path: Path) -> xr.Dataset:
    """Return the sweep as an xarray Dataset, with units in the attributes of each variable."""
    import xarray as xr

    return xr.open_dataset(path, engine="netcdf4")
