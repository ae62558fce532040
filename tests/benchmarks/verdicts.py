"""Random poses of every shipped robot: how each ends, and the worst residual of those solved.

    python tests/benchmarks/verdicts.py [--poses 1000000] [--only NAME]

Positions fill a box half as large again as the workspace, so that some cannot be held; orientations
are those of the study, and small random turns where it has none. A pose that is called solved with
a residual above tolerance ends the run with status 1.
"""

from __future__ import annotations

import argparse
import sys
import time

import numpy as np

from designer.io.config import read_study
from designer.model.robot import Poses
from designer.model.verdict import Verdict
from designer.resources import example_file, example_names
from designer.sizing.newton import size_poses
from designer.study import Study

_TOLERANCE = 1e-9
_CHUNK = 2**15
_TURN_RAD = 0.02


def random_poses(study: Study, count: int, rng: np.random.Generator) -> Poses:
    assert study.workspace is not None
    bounds = study.workspace.region.bounds_m
    middle = bounds.mean(axis=0)
    low, high = middle + 1.5 * (bounds - middle)
    position = rng.uniform(low, high, (count, 3))
    robot = study.robot
    if robot.is_point_mass:
        return Poses.at(position)
    turns = study.workspace.orientations.turns_rad
    if len(turns) > 1:
        return Poses.at(position, turns[rng.integers(len(turns), size=count)])
    across = robot.upright[1] if robot.is_planar else np.ones(3)
    return Poses.at(position, rng.normal(0.0, _TURN_RAD, (count, 3)) * across)


def check(name: str, count: int) -> bool:
    study = read_study(example_file(name))
    rng = np.random.default_rng(0)
    verdicts = np.zeros(len(Verdict), dtype=np.int64)
    worst = 0.0
    start = time.perf_counter()
    for at in range(0, count, _CHUNK):
        poses = random_poses(study, min(_CHUNK, count - at), rng)
        statics = size_poses(study.robot, poses, study.material).statics
        verdicts += np.bincount(statics.verdict, minlength=len(Verdict))
        solved = statics.is_solved
        if solved.any():
            left = np.abs(statics.equilibrium_residual_N()[solved]).max(axis=1)
            open_m = statics.closure_residual_m()[solved].max(axis=1)
            length = statics.length_m[solved].max(axis=1)
            worst = max(worst, float((left / statics.largest_tension_N[solved]).max()))
            worst = max(worst, float((open_m / length).max()))
    seconds = time.perf_counter() - start
    counts = ", ".join(f"{v.label} {verdicts[v]}" for v in Verdict if verdicts[v])
    print(f"{name:10} {count} poses in {seconds:.1f} s: {counts}; worst residual {worst:.1e}")
    return worst <= _TOLERANCE


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--poses", type=int, default=20_000)
    parser.add_argument("--only", choices=example_names())
    given = parser.parse_args()
    names = [given.only] if given.only else example_names()
    good = [check(name, given.poses) for name in names]
    sys.exit(0 if all(good) else 1)


if __name__ == "__main__":
    main()
