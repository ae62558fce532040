"""How well the diagnosis names an effect that nobody declared, on simulated twins.

    python tests/benchmarks/diagnosis.py [--seeds 1] [--nothing 200] [--robots yard3,fast3,hall6]
                                         [--sizes 2,5,10,30] [--unlisted]

The twins come from physics that shares nothing with the product (`tests/twins`). Prints, for each
size over noise, how often the effect was found first, found among the rivals of a finding, missed,
or replaced by a wrong one; then false findings where there is nothing; then effects that are not
in the list.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from twins import robots
from twins.dataset import DataSet, make, size_for

ROBOTS = {"yard3": robots.YARD3, "fast3": robots.FAST3, "hall6": robots.HALL6}
LISTED = (
    "pulley_radius", "thermal_expansion", "elastic_modulus", "linear_mass", "platform_mass",
    "centre_of_mass_offset", "anchor_offset", "length_offset", "drum_scale", "drum_layering",
    "creep", "pulley_friction", "tension_gain", "tension_bias", "wind_drag", "base_tilt",
    "clock_offset", "bending_stiffness",
)  # fmt: skip
UNLISTED = ("tower_settles", "mast_bending", "cable_mass_drift", "nonlinear_stiffness")
PAIRS = (
    ("pulley_radius", "platform_mass"), ("elastic_modulus", "linear_mass"),
    ("length_offset", "elastic_modulus"), ("thermal_expansion", "tension_bias"),
    ("anchor_offset", "pulley_friction"), ("creep", "drum_scale"),
    ("wind_drag", "tension_gain"), ("base_tilt", "platform_mass"),
)  # fmt: skip
SIZES = (2.0, 5.0, 10.0, 30.0)
MOVING = ("clock_offset",)


def verdict_on(effects: tuple[str, ...], dataset: DataSet) -> tuple[str, tuple[str, ...], bool]:
    """Return how the diagnosis did, what it found, and whether it left structure unexplained."""
    from designer.config import read_study
    from designer.diagnosis.case import case_of
    from designer.diagnosis.diagnose import diagnose
    from designer.measured.read import read_measured

    with tempfile.TemporaryDirectory() as folder:
        dataset.write(Path(folder))
        study = read_study(Path(folder) / "config.yaml")
        assert study.measurements is not None
        measured = read_measured(study)
    found = diagnose(case_of(study, study.measurements, measured))
    named = tuple(finding.effect.key for finding in found.findings)
    return _score(effects, found), named, found.is_unexplained


def _score(effects: tuple[str, ...], found) -> str:
    ids = [finding.effect.id for finding in found.findings]
    rivals = {r.split(" of ")[0] for finding in found.findings for r in finding.rivals}
    if not effects:
        return "false" if ids else "nothing"
    if set(ids) == set(effects):
        return "first"
    if set(effects) <= {*ids, *rivals} and len(ids) <= len(effects):
        return "rival"
    if set(effects) & {*ids, *rivals}:
        return "with others" if set(effects) <= {*ids, *rivals} else "partly"
    return "wrong" if ids else "missed"


def _one(job: tuple[str, tuple[str, ...], float, int]) -> tuple[object, ...]:
    name, effects, over_noise, seed = job
    robot = ROBOTS[name]
    settled = not any(effect in MOVING for effect in effects)
    try:
        sized = {
            effect: robot.draw(
                effect, size_for(robot, effect, over_noise, seed, settled=settled), seed
            )
            for effect in effects
        }
    except (ValueError, KeyError) as error:
        return (*job, "impossible", (str(error),), False)
    return (*job, *verdict_on(effects, make(robot, sized, seed=seed, settled=settled)))


def run(jobs: list[tuple[str, tuple[str, ...], float, int]]) -> list[tuple[object, ...]]:
    """Run the jobs on all processors."""
    with ProcessPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(_one, jobs))


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--seeds", type=int, default=1)
    parser.add_argument("--nothing", type=int, default=200)
    parser.add_argument("--robots", default="yard3,fast3,hall6")
    parser.add_argument("--sizes", default=",".join(map(str, SIZES)))
    parser.add_argument("--unlisted", action="store_true", help="minutes more")
    arguments = parser.parse_args()
    names = arguments.robots.split(",")
    sizes = [float(size) for size in arguments.sizes.split(",")]
    seeds = range(arguments.seeds)
    jobs = [(n, (e,), s, k) for n in names for e in LISTED for s in sizes for k in seeds]
    rows = run(jobs)
    print("effect over noise   " + "  ".join(f"{s:>6g}" for s in sizes))
    for outcome in ("first", "rival", "with others", "partly", "missed", "wrong", "impossible"):
        counts = Counter(row[2] for row in rows if row[4] == outcome)
        print(f"{outcome:18}  " + "  ".join(f"{counts[s]:6d}" for s in sizes))
    for row in rows:
        if row[4] not in ("first", "impossible"):
            print(f"  {row[0]} {row[1][0]} at {row[2]:g}: {row[4]}: {', '.join(row[5]) or 'none'}")
    blank = run([(names[k % len(names)], (), 0.0, k) for k in range(arguments.nothing)])
    false = sum(row[4] == "false" or bool(row[6]) for row in blank)
    print(f"nothing there: {false} of {len(blank)} with a false finding or structure")
    pairs = run([(n, pair, 10.0, k) for n in names for pair in PAIRS for k in seeds])
    print(f"pairs at 10: {dict(Counter(str(row[4]) for row in pairs))}")
    for row in pairs:
        if row[4] not in ("first", "impossible"):
            print(f"  {row[0]} {' + '.join(row[1])}: {row[4]}: {', '.join(row[5]) or 'none'}")
    if not arguments.unlisted:
        return
    other = [(n, (e,), s, k) for n in names for e in UNLISTED for s in (10.0, 30.0) for k in seeds]
    for row in run(other):
        told = "unexplained" if row[6] else "explained"
        named = ", ".join(row[5]) or "none"
        print(f"  not in the list: {row[0]} {row[1][0]} at {row[2]:g}: {told}: {named}")


if __name__ == "__main__":
    main()
