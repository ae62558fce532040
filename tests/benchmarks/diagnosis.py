"""How well the diagnosis names an effect that nobody declared, on simulated twins.

    python tests/benchmarks/diagnosis.py [--seeds 1] [--nothing 200] [--robots yard3,fast3,…]
                                         [--sizes 2,5,10,30] [--only singles,nothing,pairs,…]
                                         [--troubles 25] [--kinds saturation,gusts,…] [--first 0]

The twins come from physics that shares nothing with the product (`tests/twins`). Prints, for each
size over noise, how often the effect was found first, found among the rivals of a finding, missed,
or replaced by a wrong one; then false findings where there is nothing; then pairs of effects; then
effects that are not in the list, which must come out as unexplained, with nothing named; then
troubles (`tests/twins/troubles.py`): how many sets of each kind have a false finding, and how many
findings make rows worse that no fit has seen. `--first` is the first seed of every part.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from twins import robots
from twins.dataset import DataSet, make, size_for
from twins.effects import LISTED, UNLISTED
from twins.troubles import TROUBLES, troubled

ROBOTS = {
    "yard3": robots.YARD3,
    "fast3": robots.FAST3,
    "hall6": robots.HALL6,
    "hall8": robots.HALL8,
}
PAIRS = (
    ("pulley_radius", "platform_mass"), ("elastic_modulus", "linear_mass"),
    ("length_offset", "elastic_modulus"), ("thermal_expansion", "tension_bias"),
    ("anchor_offset", "pulley_friction"), ("creep", "drum_scale"),
    ("wind_drag", "tension_gain"), ("base_tilt", "platform_mass"),
)  # fmt: skip
SIZES = (2.0, 5.0, 10.0, 30.0)
MOVING = ("clock_offset",)
PARTS = ("singles", "nothing", "pairs", "unlisted", "troubles")
RIGHT = {"stiffening": {"stiffening"}, "tension error": {"tension_length"}, "step": {"load_step"}}
"""What may be found in troubles that are in the list."""

Job = tuple[str, tuple[str, ...], float, int]
"""Robot, effects, size over noise, seed."""


@dataclass(frozen=True)
class Row:
    """A job and what became of it.

    Beside the outcome: what was found, what is left goes with, the verdict, and how many kinds of
    readings are worse by what was found on rows that no fit has seen.
    """

    job: Job
    outcome: str
    named: tuple[str, ...] = ()
    carrier: str | None = None
    seconds: float = 0.0
    verdict: str = ""
    worse: int = 0

    def __str__(self) -> str:
        robot, effects, size, seed = self.job
        left = f"; left: {self.carrier}" if self.carrier else ""
        return (
            f"  {robot} {' + '.join(effects) or 'nothing'} at {size:g}, seed {seed}: "
            f"{self.outcome}: {', '.join(self.named) or 'none'}{left} [{self.verdict}]"
            f"{' WORSE' * self.worse}"
        )


def verdict_on(job: Job, dataset: DataSet) -> Row:
    """Diagnose a data set and compare with what is in it."""
    from designer.diagnosis.case import case_of
    from designer.diagnosis.diagnose import diagnose
    from designer.io.config import read_study
    from designer.measured.read import read_measured

    with tempfile.TemporaryDirectory() as folder:
        dataset.write(Path(folder))
        study = read_study(Path(folder) / "config.yaml")
        assert study.measurements is not None
        measured = read_measured(study)
    start = time.perf_counter()
    found = diagnose(case_of(study, study.measurements, measured))
    took = time.perf_counter() - start
    named = tuple(finding.effect.key for finding in found.findings)
    structure = found.structure_after
    carriers = [e.text for e in structure.events] + [c.name for c in structure.present]
    carrier = carriers[0] if carriers else None
    score = _score(job[1], found)
    return Row(job, score, named, carrier, took, found.verdict.value, _worse(found))


def _worse(found) -> int:
    """Count findings without gain, and whether all together make unseen rows worse."""
    before, after = (
        sum(
            (error.heldout.value / noise) ** 2
            for error, noise in (
                (stage.length_m, found.noise.length_m),
                (stage.tension_N, found.noise.tension_N),
            )
            if error is not None
        )
        for stage in (found.stages[0], found.final)
    )
    return sum(f.heldout_gain <= 0.0 for f in found.findings) + (after > before)


def _score(effects: tuple[str, ...], found) -> str:
    ids = [finding.effect.id for finding in found.findings]
    rivals = {r.split(" of ")[0] for finding in found.findings for r in finding.rivals}
    if not effects:
        return "false" if ids or found.is_unexplained else "nothing"
    if effects[0] in TROUBLES | dict.fromkeys(UNLISTED):
        return _score_of_unlisted(effects[0], set(ids), rivals, found)
    if set(effects) <= {*ids, *rivals} and len(ids) <= len(effects):
        return "first" if set(ids) == set(effects) else "rival"
    if set(effects) & {*ids, *rivals}:
        return "with others" if set(effects) <= {*ids, *rivals} else "partly"
    return "wrong" if ids else "missed"


def _score_of_unlisted(effect: str, ids: set[str], rivals: set[str], found) -> str:
    if effect in TROUBLES:
        right = RIGHT.get(effect, set())
        return "right" if ids <= right else "rival" if right & rivals else "false"
    return ("in part" if ids else "unexplained") if found.is_unexplained else "bent"


def _one(job: Job) -> Row:
    name, effects, over_noise, seed = job
    robot = ROBOTS[name]
    if effects and effects[0] in TROUBLES:
        try:
            return verdict_on(job, troubled(robot, effects[0], seed))
        except ValueError:
            return Row(job, "impossible")
    settled = not any(effect in MOVING for effect in effects)
    try:
        sized = {
            effect: robot.draw(
                effect, size_for(robot, effect, over_noise, seed, settled=settled), seed
            )
            for effect in effects
        }
    except (ValueError, KeyError):
        return Row(job, "impossible")
    return verdict_on(job, make(robot, sized, seed=seed, settled=settled))


def run(jobs: list[Job]) -> list[Row]:
    """Run the jobs on all processors."""
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(_one, jobs))


def singles(names: list[str], sizes: list[float], seeds: range) -> None:
    """Print a table of outcomes for each size, and what went wrong."""
    rows = run(_jobs(names, [(effect,) for effect in LISTED], sizes, seeds))
    print("effect over noise   " + "  ".join(f"{s:>6g}" for s in sizes))
    for outcome in ("first", "rival", "with others", "partly", "missed", "wrong", "impossible"):
        counts = Counter(row.job[2] for row in rows if row.outcome == outcome)
        print(f"{outcome:18}  " + "  ".join(f"{counts[s]:6d}" for s in sizes))
    _print_others(rows, "first")


def troubles(names: list[str], kinds: list[str], count: int, first: int) -> None:
    """Print a table of false findings and of findings that make unseen rows worse, by kind."""
    print(f"{'':16} {'sets':>5} {'false':>6} {'worse':>6}  verdicts")
    for kind in kinds:
        seeds = range(first, first + count)
        rows = run([(names[k % len(names)], (kind,), TROUBLES[kind][1], k) for k in seeds])
        rows = [row for row in rows if row.outcome != "impossible"]
        false = sum(row.outcome == "false" for row in rows)
        worse = sum(row.worse for row in rows)
        verdicts = ", ".join(f"{n} {v}" for v, n in Counter(r.verdict for r in rows).items())
        print(f"{kind:16} {len(rows):5d} {false:6d} {worse:6d}  {verdicts}", flush=True)
        for row in rows:
            if row.outcome in ("false", "rival") or row.worse:
                print(row)


def nothing(names: list[str], count: int, first: int = 0) -> None:
    """Print how often something is found where there is nothing."""
    rows = run([(names[k % len(names)], (), 0.0, k) for k in range(first, first + count)])
    false = sum(row.outcome == "false" for row in rows)
    print(f"nothing there: {false} of {len(rows)} with a false finding or structure")
    _print_others(rows, "nothing")


def several(title: str, combinations: list[Job], right: str) -> None:
    """Print outcomes of pairs, or of effects that are not in the list."""
    rows = run(combinations)
    print(f"{title}: {dict(Counter(row.outcome for row in rows))}")
    _print_others(rows, right)


def _print_others(rows: list[Row], right: str) -> None:
    for row in rows:
        if row.outcome not in (right, "impossible") or row.job[1][:1] in [(e,) for e in UNLISTED]:
            print(row)
    slowest = max(rows, key=lambda row: row.seconds)
    mean = sum(row.seconds for row in rows) / len(rows)
    print(f"  {mean:.1f} s on average, at most {slowest.seconds:.0f} s:{slowest}", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--seeds", type=int, default=1)
    parser.add_argument("--nothing", type=int, default=200)
    parser.add_argument("--robots", default=",".join(ROBOTS))
    parser.add_argument("--sizes", default=",".join(map(str, SIZES)))
    parser.add_argument("--only", default=",".join(PARTS), help="parts of the table")
    parser.add_argument("--troubles", type=int, default=25, help="sets of each kind")
    parser.add_argument("--kinds", default=",".join(TROUBLES))
    parser.add_argument("--first", type=int, default=0)
    arguments = parser.parse_args()
    names, parts = arguments.robots.split(","), arguments.only.split(",")
    sizes = [float(size) for size in arguments.sizes.split(",")]
    seeds = range(arguments.first, arguments.first + arguments.seeds)
    if "singles" in parts:
        singles(names, sizes, seeds)
    if "nothing" in parts:
        nothing(names, arguments.nothing, arguments.first)
    if "pairs" in parts:
        several("pairs at 10", _jobs(names, PAIRS, (10.0,), seeds), "first")
    if "unlisted" in parts:
        one = [(effect,) for effect in UNLISTED]
        several("not in the list", _jobs(names, one, (10.0, 30.0), seeds), "unexplained")
    if "troubles" in parts:
        troubles(names, arguments.kinds.split(","), arguments.troubles, arguments.first)


def _jobs(
    names: list[str], effects: Iterable[tuple[str, ...]], sizes: Iterable[float], seeds: range
) -> list[Job]:
    return [(n, e, s, k) for n in names for e in effects for s in sizes for k in seeds]


if __name__ == "__main__":
    main()
