"""How often a diagnosis finds something in readings that differ from the model by noise alone.

    python tests/benchmarks/false_findings.py [--sets 12] [--first 0] [--rows 60]
                                              [--noises AR0.9,AR0.97,…] [--declared both]
                                              [--robots fast3,hall6,yard3] [--moving]

The twins come from physics that shares nothing with the product (`tests/twins`), and have no
effect. Prints, for each kind of noise, how many sets have a finding, and which; and how many are
told to hold something unexplained, which for a drift is the truth.
"""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from twins import robots
from twins.troubles import NO_EFFECT, noisy

Job = tuple[str, str, bool, bool, int, int]
"""Robot, kind of noise, whether it is declared, whether poses are at rest, rows, seed."""


def outcome(job: Job) -> tuple[tuple[str, ...], str, str, float]:
    """Diagnose a set without effects: what was found, the verdict, what is left, seconds."""
    import yaml

    from designer.diagnosis.case import case_of
    from designer.diagnosis.diagnose import diagnose
    from designer.io.config import read_study
    from designer.measured.read import read_measured

    name, kind, is_declared, settled, rows, seed = job
    robot = getattr(robots, name.upper())
    dataset = noisy(robot, NO_EFFECT[kind], seed, rows, settled=settled)
    with TemporaryDirectory() as folder:
        path = dataset.write(Path(folder))
        if not is_declared:
            config = yaml.safe_load(path.read_text(encoding="utf-8"))
            del config["measurements"]["noise"]
            path.write_text(yaml.safe_dump(config), encoding="utf-8")
        study = read_study(path)
        measured = read_measured(study)
    assert study.measurements is not None
    start = time.process_time()
    result = diagnose(case_of(study, study.measurements, measured))
    took = time.process_time() - start
    left = result.structure_after
    carriers = [e.text for e in left.events] + [c.name for c in left.present]
    named = tuple(finding.effect.key for finding in result.findings)
    return named, result.verdict.value, ", ".join(carriers[:1]), took


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--sets", type=int, default=12, help="of each kind")
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--rows", type=int, default=60)
    parser.add_argument("--robots", default="fast3,hall6,yard3", help="in turn")
    parser.add_argument("--noises", default=",".join(NO_EFFECT))
    parser.add_argument("--declared", choices=("yes", "no", "both"), default="both")
    parser.add_argument("--workers", type=int, default=os.cpu_count())
    parser.add_argument("--moving", action="store_true", help="samples of a slow motion")
    parser.add_argument("--verbose", action="store_true", help="each finding with its seed")
    arguments = parser.parse_args()
    seeds = range(arguments.first, arguments.first + arguments.sets)
    ways = {"yes": (True,), "no": (False,), "both": (True, False)}[arguments.declared]
    names = arguments.robots.split(",")
    print(f"{'noise':12} {'given':9} {'sets':>4} {'found':>5} {'left':>5} {'s':>5}  what")
    with ProcessPoolExecutor(arguments.workers) as pool:
        for kind in arguments.noises.split(","):
            for is_declared in ways:
                of_kind = kind, is_declared, not arguments.moving, arguments.rows
                jobs = [(names[seed % len(names)], *of_kind, seed) for seed in seeds]
                answers = list(pool.map(outcome, jobs))
                false = sum(bool(named) for named, *_ in answers)
                left = sum(bool(carrier) for *_, carrier, _ in answers)
                effects = Counter(name for named, *_ in answers for name in named)
                verdicts = Counter(verdict for _, verdict, *_ in answers)
                print(
                    f"{kind:12} {'declared' if is_declared else 'estimated':9} {len(jobs):4d} "
                    f"{false:5d} {left:5d} {np.mean([a[-1] for a in answers]):5.1f}  "
                    f"{dict(effects)} {dict(verdicts)}",
                    flush=True,
                )
                if arguments.verbose:
                    for job, answer in zip(jobs, answers, strict=True):
                        if answer[0]:
                            print(f"    {job[0]} seed {job[-1]}: {answer}", flush=True)


if __name__ == "__main__":
    main()
