"""What a sweep costs, and whether one that is killed again and again ends like one left alone.

    python tests/benchmarks/sweep.py [--points 100000] [--kills 10] [--sizes 1000,10000,100000]

Prints the time of a study, by the clock and of the processors, for sweeps of growing size; two
workers against one; and then kills a sweep with SIGKILL at random moments, all its processes at
once, goes on with it each time, and compares the two stores bit for bit.
"""

from __future__ import annotations

import argparse
import os
import resource
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

from designer.sweeps.run import read_store

_STUDY = """\
robot:
  anchors: [[0, 0, 12 m], [30, 0, 12 m], [15, 26, 12 m]]
  platform: {mass: 180 kg}
cable: {grade: unirope-7x19-galvanised}
pose: [15, 9, 4]
"""
_SWEEP = """\
study: crane.yaml
sampling: latin_hypercube
points: POINTS
seed: 3
vary:
  robot.platform.mass: {from: 100 kg, to: 300 kg}
  pose[2]: {from: 2 m, to: 9 m}
keep: [pose.optimum.diameter_m, pose.sagging.max_tension_N]
"""


def command(folder: Path, points: int, target: Path, workers: int) -> list[str]:
    """Return what solves a sweep of so many points."""
    sweep = folder / f"{points}.yaml"
    sweep.write_text(_SWEEP.replace("POINTS", str(points)))
    words = ["sweep", str(sweep), "-o", str(target), "--workers", str(workers), "--no-plugins"]
    return [sys.executable, "-m", "designer", *words]


def timed(words: list[str]) -> tuple[float, float]:
    """Run; return the seconds by the clock, and those of the processors."""

    def spent() -> float:
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        return used.ru_utime + used.ru_stime

    before, start = spent(), time.perf_counter()
    subprocess.run(words, check=True, capture_output=True)
    return time.perf_counter() - start, spent() - before


def killed(words: list[str], target: Path, kills: int, wanted_s: float) -> list[int]:
    """Run to the end in spite of so many kills; return how many points were done at each."""
    rng, counts = np.random.default_rng(5), []
    for _ in range(kills):
        process = subprocess.Popen(words, start_new_session=True, stderr=subprocess.DEVNULL)
        time.sleep(rng.uniform(0.2, 1.8) * wanted_s / (kills + 1))
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()
        counts.append(int(read_store(target).done.sum()) if target.exists() else 0)
    subprocess.run(words, check=True, capture_output=True)
    return counts


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--points", type=int, default=100_000)
    parser.add_argument("--kills", type=int, default=10)
    parser.add_argument("--sizes", default="1000,10000,100000")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "crane.yaml").write_text(_STUDY)
        alone, took = folder / f"{options.points}.zarr", 60.0
        for points in sorted({*map(int, options.sizes.split(",")), options.points}):
            took, used = timed(command(folder, points, folder / f"{points}.zarr", 2))
            each = f"{1e3 * took / points:.2f} ms, {1e3 * used / points:.2f} of processors"
            print(f"{points} points, 2 workers: {took:.0f} s; a point {each}", flush=True)
        smallest = min(map(int, options.sizes.split(",")))
        for workers in (1, 2):
            target = folder / f"with-{workers}.zarr"
            one, used = timed(command(folder, smallest, target, workers))
            print(f"{smallest} points, {workers} workers: {one:.1f} s, {used:.1f} s of processors")
        again = folder / "again.zarr"
        counts = killed(command(folder, options.points, again, 2), again, options.kills, took)
        is_same = bool(read_store(alone).identical(read_store(again)))
        print(f"killed at {counts} points; {'the same bit for bit' if is_same else 'NOT THE SAME'}")
    return 0 if is_same else 1


if __name__ == "__main__":
    sys.exit(main())
