"""A sweep on a Dask cluster of this machine, which loses a worker and then its scheduler."""

from __future__ import annotations

import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path

import pytest
from sweep_cases import SWEEP, written

from designer.sweeps.plan import read_sweep
from designer.sweeps.run import opened, run

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(find_spec("distributed") is None, reason="needs the extra `cluster`"),
]
Process = subprocess.Popen[bytes]


@contextmanager
def cluster(port: int) -> Iterator[tuple[Process, list[Process]]]:
    """Run a scheduler and three workers on the loopback."""
    dask = [sys.executable, "-m", "distributed.cli.dask_"]

    def start(part: str, *arguments: str) -> Process:
        program = [*dask[:2], dask[2] + part, *arguments, "--no-dashboard"]
        return subprocess.Popen(program, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    scheduler = start("scheduler", "--host", "127.0.0.1", "--port", str(port))
    address = (f"tcp://127.0.0.1:{port}", "--nthreads", "1", "--no-nanny")
    workers = [start("worker", *address) for _ in range(3)]
    try:
        until(lambda: answers(port))
        yield scheduler, workers
    finally:
        for process in (scheduler, *workers):
            process.kill()
            process.wait()


def until(is_so: Callable[[], object], within_s: float = 900.0) -> None:
    deadline = time.monotonic() + within_s
    while not is_so():
        assert time.monotonic() < deadline
        time.sleep(0.02)


def answers(port: int) -> bool:
    with socket.socket() as asked:
        return asked.connect_ex(("127.0.0.1", port)) == 0


def free_port() -> int:
    with socket.socket() as asked:
        asked.bind(("127.0.0.1", 0))
        return int(asked.getsockname()[1])


def n_done(store: Path) -> int:
    """Return how many points are stored: a file each, which is looked up faster than it is read."""
    return sum(1 for _ in store.glob("done/[0-9]*"))


def contents(store: Path) -> dict[str, bytes]:
    files = (path for path in store.rglob("*") if path.is_file() and path.name != ".lock")
    return {str(path.relative_to(store)): path.read_bytes() for path in files}


def test_a_worker_and_the_scheduler_are_killed_and_the_store_is_that_of_a_local_run(
    tmp_path: Path,
) -> None:
    path = written(tmp_path, SWEEP.replace("count: 3", "count: 80"))
    plan = read_sweep(path, with_plugins=False)
    with opened(tmp_path / "alone.zarr", plan) as store:
        run(plan, store, lambda: ThreadPoolExecutor(1), 1)

    target, port = tmp_path / "out.zarr", free_port()
    command = [sys.executable, "-m", "designer", "sweep", str(path), "-o", str(target)]
    command += ["--no-plugins", "--cluster", f"tcp://127.0.0.1:{port}"]
    with cluster(port) as (scheduler, workers):
        sweep = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
        until(lambda: n_done(target) > 20 or sweep.poll() is not None)
        workers[0].kill()
        before = n_done(target)
        until(lambda: n_done(target) > before + 20 or sweep.poll() is not None)
        assert sweep.poll() is None, sweep.communicate()
        scheduler.kill()
        _, told = sweep.communicate(timeout=900)
    # Beside how far it is, and where nothing is compiled yet that it is.
    lines = [x for x in told.splitlines() if " s: sweep" not in x and "Compiling" not in x]
    assert sweep.returncode == 2
    assert 40 < n_done(target) < plan.n_points
    assert len(lines) == 1, told
    assert lines[0].startswith("the workers are gone")
    assert lines[0].endswith("what is stored stays, and the same command goes on")

    with cluster(port):
        again = subprocess.run(command, capture_output=True, text=True, timeout=900, check=False)
    assert again.returncode == 0
    assert "Traceback" not in again.stderr
    assert contents(target) == contents(tmp_path / "alone.zarr")
