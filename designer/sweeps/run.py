"""The store of a sweep: Zarr, laid out whole before the first study, filled chunk by chunk.

A chunk is what one task solves. Its values are written first and its ``done`` last, each file
whole or not at all, so a sweep that is killed at any moment goes on after what is stored. What is
pending is solved in processes here or on a cluster, and stored as it comes.
"""

from __future__ import annotations

import math
import os
import shutil
from collections import Counter, deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import (
    FIRST_COMPLETED,
    CancelledError,
    Executor,
    Future,
    ProcessPoolExecutor,
    wait,
)
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack, contextmanager
from logging import CRITICAL, getLogger
from multiprocessing import active_children
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from designer import __version__
from designer.analysis.analyse import TemporaryFolder
from designer.errors import DesignerError, InputError, OutputError, described
from designer.io.output import explained
from designer.io.process import SPAWN, children_are_deaf, end_with_parent, written
from designer.progress import SILENT, Reporter
from designer.sweeps.plan import SweepPlan, read_sweep, solve_points

if TYPE_CHECKING:
    import xarray as xr
    import zarr

_CHUNKS = 2000
"""About as many tasks: fewer would be lost with a kill, more would be files without end."""
_LARGEST_CHUNK = 50
_AHEAD = 2
"""Tasks that wait at each worker, so that none is idle while a result is stored."""
_POLL_S = 0.2
"""So long at most it takes to hear that the sweep is to end [s]."""
_MAX_DEATHS = 2
"""A task that ends its process so often, alone in its pool, is to blame for it."""
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
            values = [values[k] for values, _ in results]
            if self._plan.kinds[name] is str:
                texts = ["" if value is None else str(value) for value in values]
                self._array(name)[place] = np.array(texts, dtype=object)
                continue
            self._array(name)[place] = np.array(
                [float(x) if isinstance(x, int | float) else math.nan for x in values], dtype=float
            )
            for at, value in enumerate(values):
                if isinstance(value, str):
                    reasons[at] += f"; {name} is a text here, and was none of the study as it is"
        self._array("reason")[place] = np.array(
            [why.removeprefix("; ") for why in reasons], dtype=object
        )
        self._array("done")[place] = True


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


Solved = list[tuple[list[Any], str]]
MakeExecutor = Callable[[], Executor]


def processor_count() -> int:
    """Return how many processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else 1


def processes(workers: int) -> MakeExecutor:
    """Return what makes pools of processes here."""
    return lambda: ProcessPoolExecutor(workers, SPAWN, initializer=end_with_parent)


def run(
    plan: SweepPlan,
    store: Store,
    make_executor: MakeExecutor,
    workers: int,
    reporter: Reporter = SILENT,
    stop: Callable[[], bool] = lambda: False,
) -> None:
    """Solve and store every point that is not done.

    A worker that is killed takes nothing along: what it was at is solved again. ``stop`` is asked
    often; once it says so, all workers are ended, and what is stored stays.

    Raises
    ------
    OutputError
        If the store cannot be written, or the cluster is gone; what is stored stays.
    """
    waiting = deque(store.pending())
    deaths: Counter[range] = Counter()
    with reporter.task("sweep", sum(map(len, waiting))) as advance:
        while waiting and not stop():
            _run_until_death(plan, store, make_executor, workers, waiting, deaths, advance, stop)


def _run_until_death(
    plan: SweepPlan,
    store: Store,
    make_executor: MakeExecutor,
    workers: int,
    waiting: deque[range],
    deaths: Counter[range],
    advance: Callable[[int], None],
    stop: Callable[[], bool],
) -> None:
    """Work through what waits; ends early, with the rest waiting, where a worker dies."""
    running: dict[Future[Solved], range] = {}

    def may_add() -> bool:
        """After a death tasks run alone, so that it shows which one is to blame."""
        suspects = any(deaths[points] for points in (waiting[0], *running.values()))
        return len(running) < (1 if suspects else _AHEAD * workers)

    try:
        with make_executor() as executor, ExitStack() as at_end:
            # An executor's own end waits for what has not begun, and Dask's cannot cancel.
            at_end.callback(lambda: [future.cancel() for future in running])
            while waiting or running:
                if stop():
                    for process in active_children():
                        process.terminate()
                    return
                while waiting and may_add():
                    changes = [plan.changes(point) for point in waiting[0]]
                    with children_are_deaf():
                        running[executor.submit(solve_points, plan.base, changes)] = waiting[0]
                    waiting.popleft()
                for future in wait(running, _POLL_S, FIRST_COMPLETED).done:
                    result = _result(future, is_last=deaths[running[future]] >= _MAX_DEATHS)
                    points = running.pop(future)
                    if result is None:
                        deaths[points] += 1
                        waiting.appendleft(points)
                        continue
                    deaths.pop(points, None)
                    store.write(points, result)
                    advance(len(points))
    except BrokenProcessPool:
        for points in reversed(running.values()):
            deaths[points] += 1
            waiting.appendleft(points)
        if len(running) == 1 and deaths[waiting[0]] > _MAX_DEATHS:
            points = waiting.popleft()
            del deaths[points]
            no_values = [None] * len(plan.base.keep)
            store.write(points, [(no_values, "its process ended without an answer")] * len(points))
            advance(len(points))


def _result(future: Future[Solved], is_last: bool) -> Solved | None:
    """Return the result; None if it is lost, and to be asked for again unless this is the last try.

    A worker of a cluster that dies takes along what it has not handed over, and each kind of
    cluster tells that in its own way. What it cancels it does because its scheduler is gone.
    """
    try:
        return future.result()
    except BrokenProcessPool:
        raise
    except Exception as error:
        if not (is_last or isinstance(error, CancelledError)):
            return None
        line = f"the workers are gone ({described(error)})"
        raise OutputError(f"{line}; what is stored stays, and the same command goes on") from error


def cluster(address: str) -> tuple[MakeExecutor, int]:
    """Return what hands out the executor of a running Dask cluster, and how many tasks it runs.

    Raises
    ------
    DesignerError
        If Dask is not installed, or nothing answers at the address.
    """
    try:
        from distributed import Client
    except ImportError:
        line = "--cluster needs Dask: pip install 'cdpr-designer[cluster]'"
        raise DesignerError(line) from None
    # Where the scheduler goes away they write tracebacks, beside the line that the user gets.
    for library in (
        "distributed",
        "distributed.client",
        "tornado",
        "tornado.application",
        "asyncio",
    ):
        getLogger(library).setLevel(CRITICAL)
    try:
        client = Client(address, timeout=10)
    except (OSError, ValueError, TypeError) as error:
        raise DesignerError(f"--cluster {address}: nothing answers there ({error})") from None
    return lambda: client.get_executor(pure=False), max(sum(client.nthreads().values()), 1)


def sweep(
    plan: Path | str, store: Path | str | None = None, *, workers: int | None = None
) -> xr.Dataset:
    """Return a sweep's points, solved in ``workers`` processes, as `designer sweep` does.

    In a script it stands below ``if __name__ == "__main__":``, since processes read the script.

    Parameters
    ----------
    plan : Path or str
        The YAML file of the sweep.
    store : Path or str, optional
        Zarr store to keep; a sweep that is in it goes on. Nothing is kept if left out.
    workers : int, optional
        All processors if left out.

    Raises
    ------
    InputError
        If the plan is wrong.
    """
    scratch = TemporaryFolder()
    path = scratch.folder / "sweep.zarr" if store is None else Path(store)
    laid_out, count = read_sweep(Path(plan), True), workers or processor_count()
    with opened(path, laid_out) as points:
        run(laid_out, points, processes(count), count)
    return read_store(path).load()
