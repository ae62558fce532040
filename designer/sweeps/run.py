"""Solves what is pending of a sweep, here or on a cluster, and stores it as it comes."""

from __future__ import annotations

import os
from collections import Counter, deque
from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack
from logging import CRITICAL, getLogger
from multiprocessing import active_children
from typing import Any

from designer.errors import DesignerError, OutputError, described
from designer.io.process import SPAWN, children_are_deaf, end_with_parent
from designer.progress import SILENT, Reporter
from designer.sweeps.plan import SweepPlan
from designer.sweeps.point import solve_points
from designer.sweeps.store import Store

_AHEAD = 2
"""Tasks that wait at each worker, so that none is idle while a result is stored."""
_ASKS_S = 0.2
"""So long at most it takes to hear that the sweep is to end [s]."""
_MOST_DEATHS = 2
"""A task that ends its process so often, alone in its pool, is to blame for it."""

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
                for future in wait(running, _ASKS_S, FIRST_COMPLETED).done:
                    result = _result(future)
                    points = running.pop(future)
                    deaths.pop(points, None)
                    store.write(points, result)
                    advance(len(points))
    except BrokenProcessPool:
        for points in reversed(running.values()):
            deaths[points] += 1
            waiting.appendleft(points)
        if len(running) == 1 and deaths[waiting[0]] > _MOST_DEATHS:
            points = waiting.popleft()
            del deaths[points]
            no_values = [None] * len(plan.base.keep)
            store.write(points, [(no_values, "its process ended without an answer")] * len(points))
            advance(len(points))


def _result(future: Future[Solved]) -> Solved:
    try:
        return future.result()
    except BrokenProcessPool:
        raise
    except Exception as error:  # of a cluster: each kind of it tells this in its own way
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
