"""The store of a sweep: Zarr, laid out whole before the first study, filled chunk by chunk.

A chunk is what one task solves. Its values are written first and its ``done`` last, each file
whole or not at all, so a sweep that is killed at any moment goes on after what is stored.
"""

from __future__ import annotations

import math
import shutil
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from designer import __version__
from designer.errors import InputError, OutputError
from designer.io.output import explained
from designer.io.process import written
from designer.sweeps.plan import SweepPlan

if TYPE_CHECKING:
    import xarray as xr
    import zarr

_CHUNKS = 2000
"""About as many tasks: fewer would be lost with a kill, more would be files without end."""
_LARGEST_CHUNK = 50
_EXPECTED = "that of this sweep, or another -o"


class Store:
    """A sweep's store, open for this run alone; made by `opened`."""

    def __init__(self, group: zarr.Group, plan: SweepPlan) -> None:
        self._group, self._plan = group, plan
        self._chunk = int(self._array("done").chunks[0])

    def _array(self, name: str) -> Any:
        return self._group[name]

    def pending(self) -> list[range]:
        """Return the points of each chunk that is not done."""
        is_done = np.asarray(self._array("done")[:])
        starts = range(0, self._plan.n_points, self._chunk)
        chunks = (range(at, min(at + self._chunk, len(is_done))) for at in starts)
        return [points for points in chunks if not is_done[points.start : points.stop].all()]

    def write(self, points: range, results: Sequence[tuple[Sequence[Any], str]]) -> None:
        """Write the results of a chunk: what is kept of each point, and why there is nothing."""
        place, reasons = slice(points.start, points.stop), [why for _, why in results]
        for k, name in enumerate(self._plan.base.keep):
            kind = self._plan.kinds[name]
            values = [_as_kind(values_kept[k], kind) for values_kept, _ in results]
            self._array(name)[place] = np.array(values, dtype=object if kind is str else float)
            for at, (values_kept, _) in enumerate(results):
                if kind is float and isinstance(values_kept[k], str):
                    reasons[at] += f"; {name} is a text here, and was none of the study as it is"
        self._array("reason")[place] = np.array(
            [why.removeprefix("; ") for why in reasons], dtype=object
        )
        self._array("done")[place] = True


def _as_kind(value: Any, kind: type) -> Any:
    if kind is str:
        return "" if value is None else str(value)
    return float(value) if isinstance(value, int | float) else math.nan


@contextmanager
def opened(path: Path, plan: SweepPlan) -> Iterator[Store]:
    """Open the store of a plan, laid out anew where there is none; nobody else may fill it.

    Raises
    ------
    InputError
        If there is something else at the path: no store, or that of another sweep.
    OutputError
        If it cannot be written, or another run fills it.
    """
    import zarr
    from filelock import FileLock, Timeout

    if not path.exists():
        with explained(path):
            _lay_out(path, plan)
    try:
        digest = zarr.open_group(path, mode="r").attrs.get("digest")
    except Exception:  # whatever a folder or file may be that is none
        raise InputError.at(path, "is no store of a sweep", _EXPECTED) from None
    if digest != plan.digest:
        problem = "is the store of another sweep, study, catalogue or version"
        raise InputError.at(path, problem, _EXPECTED)
    with explained(path):
        lock = FileLock(path / ".lock")
        try:
            lock.acquire(timeout=0)
        except Timeout:
            raise OutputError(f"{path}: another run fills this store") from None
        with lock:
            for unfinished in path.rglob(
                "*.partial"
            ):  # of a run that was killed while it wrote them
                unfinished.unlink(missing_ok=True)
            written[path] = None
            yield Store(zarr.open_group(path, mode="r+"), plan)


def _lay_out(path: Path, plan: SweepPlan) -> None:
    """Make the store with all arrays at full size, under another name until it is whole."""
    import zarr

    unfinished = path.with_name(f".{path.name}.part")
    shutil.rmtree(unfinished, ignore_errors=True)
    unfinished.parent.mkdir(parents=True, exist_ok=True)
    chunk = max(1, min(_LARGEST_CHUNK, plan.n_points // _CHUNKS))
    try:
        group = zarr.open_group(unfinished, mode="w", zarr_format=2)
        group.attrs.update(digest=plan.digest, source=f"cdpr-designer {__version__}")

        def add(name: str, dtype: Any, chunks: int, attributes: dict[str, str], fill: Any) -> Any:
            return group.create_array(
                name,
                shape=(plan.n_points,),
                chunks=(chunks,),
                dtype=dtype,
                fill_value=fill,
                attributes={"_ARRAY_DIMENSIONS": ["point"], **attributes},
            )

        for column in plan.columns:
            is_text = column.stored.dtype == object
            unit = getattr(column.varied, "unit", "")
            array = add(
                column.name,
                str if is_text else float,
                plan.n_points,
                {"role": "varied", **({"units": unit} if unit else {})},
                None if is_text else math.nan,
            )
            array[:] = column.stored
        for name, kind in plan.kinds.items():
            fill = None if kind is str else math.nan
            goal = {1: "minimise", -1: "maximise"}.get(plan.goals.get(name, 0), "")
            attributes = {"role": "kept", **({"goal": goal} if goal else {})}
            add(name, kind, chunk, {**attributes, **plan.attributes.get(name, {})}, fill)
        add("reason", str, chunk, {"long_name": "why there is no result, or none that holds"}, None)
        add("done", bool, chunk, {}, None)
        zarr.consolidate_metadata(unfinished, zarr_format=2)
        unfinished.replace(path)
    finally:
        shutil.rmtree(unfinished, ignore_errors=True)


def report_folder(path: Path) -> Path:
    """Return where the pages on a store go: beside it."""
    return path.with_name(f"{path.stem}-report")


def read_store(path: Path) -> xr.Dataset:
    """Return a store's points, one variable for each field and result, along ``point``."""
    import xarray as xr

    dataset: xr.Dataset
    with xr.open_zarr(path, chunks=None) as dataset:
        return dataset.load()
