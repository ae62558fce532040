"""What a report costs: processor time of ``designer report``, against another checkout.

    python tests/benchmarks/report.py --against OTHER/.venv/bin/python --example yard --runs 5

Both draw the same study by turns, with what each has already compiled, and their processes'
processor time (user and system, with that of processes they start) is compared by its medians:
unlike the time on the clock, it hardly depends on what else the machine does. Sizes of the files
and pages of the PDF tell whether the content is the same.
"""

from __future__ import annotations

import argparse
import resource
import statistics
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import pypdf

FILES = (
    "report.html",
    "report.pdf",
    "result.json",
    "candidates.csv",
    "reactions.csv",
    "workspace.nc",
)


def processor_time_s(python: str, config: Path, folder: Path) -> float:
    """Write one report and return what it took [s]."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    command = [python, "-m", "designer", "report", str(config), "-o", str(folder)]
    done = subprocess.run(command, capture_output=True, text=True, cwd=config.parent, check=False)
    if done.returncode not in (0, 1):
        raise SystemExit(f"{' '.join(command)}\n{done.stderr}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def describe(name: str, times_s: list[float], folder: Path) -> None:
    """Print the times of one checkout, and what it wrote."""
    sizes = ", ".join(f"{file} {(folder / file).stat().st_size // 1024} kB" for file in FILES)
    pages = len(pypdf.PdfReader(folder / "report.pdf").pages)
    each = " ".join(f"{time:.2f}" for time in sorted(times_s))
    print(f"{name}: median {statistics.median(times_s):.2f} s of {each}\n  {pages} pages; {sizes}")


def main() -> None:
    """Run both by turns and print the ratio of their medians."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--against", help="Python of the other checkout; none: this one alone")
    parser.add_argument("--example", default="yard", help="see `designer init --list`")
    parser.add_argument("--runs", type=int, default=5, help="of each, after one to warm up")
    options = parser.parse_args()
    pythons = [sys.executable, *([options.against] if options.against else [])]
    times_s: list[list[float]] = [[] for _ in pythons]
    with TemporaryDirectory() as name:
        folder = Path(name)
        config = folder / "study.yaml"
        init = [sys.executable, "-m", "designer", "init", "--example", options.example, config]
        subprocess.run(init, check=True, capture_output=True)
        for run in range(options.runs + 1):
            for k, python in enumerate(pythons):
                time_s = processor_time_s(python, config, folder / str(k))
                if run > 0:
                    times_s[k].append(time_s)
        for k, title in enumerate(("this checkout", "the other one")[: len(pythons)]):
            describe(title, times_s[k], folder / str(k))
    if len(pythons) == 2:
        ours, others = map(statistics.median, times_s)
        print(f"ratio of processor times: {ours / others:.3f}")


if __name__ == "__main__":
    main()
