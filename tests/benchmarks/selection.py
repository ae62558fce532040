"""All sizes of all grades in all poses, in one pass, against one size at a time in the same run.

    python tests/benchmarks/selection.py [--poses 100000] [--baseline 20]

The baseline is `solve_sagging` of every pose with one size, then the largest tension; its mean over
some sizes stands for all. Ratios are what counts; absolute times depend on the machine.
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import time

import numpy as np

from designer.arrays import frozen_array
from designer.grades.registry import load_catalogue
from designer.model.cable import Cable
from designer.model.region import Prism
from designer.model.robot import Platform, Poses, Robot
from designer.model.workspace import Workspace
from designer.selection.verify import Sampled, verify_sizes
from designer.statics.inverse import solve_sagging

SAFETY_FACTOR = 2.0


def three_cables() -> tuple[Robot, Prism]:
    """The crane of Riehl et al., ICRA 2010, Table I, and the part of its space that is served."""
    anchors = frozen_array([[0, 0, 0], [500, 0, 0], [250, 433.01, 0]])
    return Robot(anchors, Platform(4000.0)), Prism.over(anchors, 10.35, (-200.0, -40.0))


def six_cables() -> tuple[Robot, Prism]:
    """Three masts with two cables each, to a triangular platform turned by 60 degrees."""

    def ring(radius: float, degrees: list[float]) -> np.ndarray:
        a = np.radians(degrees)
        return np.stack([radius * np.cos(a), radius * np.sin(a), 0 * a], axis=1)

    exits = ring(150.0, [0, 0, 120, 120, 240, 240])
    attachments = ring(5.0, [60, -60, 180, 60, 300, 180])
    robot = Robot(frozen_array(exits), Platform(4000.0, frozen_array(attachments)))
    return robot, Prism.box((-30.0, 30.0), (-30.0, 30.0), (-120.0, -50.0))


def all_cables() -> list[Cable]:
    """Every size of every product in the shipped catalogue."""
    catalogue = load_catalogue(with_plugins=False)
    grades = [grade for grade in catalogue.grades if not grade.is_nominal]
    return [grade.cable(size, SAFETY_FACTOR) for grade in grades for size in grade.sizes]


def one_at_a_time(robot: Robot, workspace: Workspace, cable: Cable) -> float:
    """Return the largest utilisation, as a user would compute it."""
    worst = -np.inf
    for positions in workspace.positions_m():
        statics = solve_sagging(robot, Poses.at(positions), cable)
        tension = np.where(statics.is_solved, statics.largest_tension_N, np.inf)
        worst = max(worst, float(tension.max()))
    return worst / cable.allowable_tension_N


def compare(name: str, robot: Robot, region: Prism, poses: int, baseline: int) -> None:
    cables = all_cables()
    workspace = Workspace(region, samples=poses)
    some = np.linspace(0, len(cables) - 1, baseline).astype(int)
    few = Workspace(region, samples=200)  # compiled or loaded before the clock starts
    verify_sizes(robot, few, cables[:2])
    one_at_a_time(robot, few, cables[0])
    start = time.perf_counter()
    found = verify_sizes(robot, workspace, cables, gives_up=False)
    ours = (time.perf_counter() - start) / (len(cables) * poses)
    start = time.perf_counter()
    alone = [one_at_a_time(robot, workspace, cables[k]) for k in some]
    slow = (time.perf_counter() - start) / (baseline * poses)
    print(f"{name}: {poses} poses × {len(cables)} sizes")
    print(
        f"  one pass {1e-6 / ours:8.2f} million poses × sizes a second   "
        f"one size at a time {1e-6 / slow:6.2f}   ratio {slow / ours:.1f}"
    )
    report(found, alone, some)


def report(found: list[Sampled], alone: list[float], some: np.ndarray) -> None:
    both = [(found[k].utilisation, u) for k, u in zip(some, alone, strict=True)]
    finite = [abs(a / b - 1.0) for a, b in both if np.isfinite(a) and np.isfinite(b)]
    same = sum(np.isinf(a) == np.isinf(b) for a, b in both)
    print(
        f"  largest relative difference {max(finite, default=0.0):.0e}, {same} of {len(both)} agree"
    )
    held = sum(one.utilisation <= 1.0 for one in found)
    unsolved = sum(one.not_held for one in found)
    print(f"  {held} sizes hold everywhere; {unsolved} poses × sizes without a solution")


def peak_memory_MB(poses: int) -> float:
    """Peak of a process of its own that makes the pass."""
    command = [sys.executable, __file__, "--pass-only", str(poses)]
    run = subprocess.run(command, check=True, capture_output=True, text=True)
    return float(run.stdout)


def pass_only(poses: int) -> None:
    robot, region = three_cables()
    verify_sizes(robot, Workspace(region, samples=poses), all_cables(), gives_up=False)
    print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--poses", type=int, default=100_000)
    parser.add_argument("--baseline", type=int, default=20)
    parser.add_argument("--pass-only", type=int, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.pass_only:
        pass_only(arguments.pass_only)
        return
    print(f"{os.cpu_count()} threads")
    compare("3 cables, 3 DOF", *three_cables(), arguments.poses, arguments.baseline)
    compare("6 cables, 6 DOF", *six_cables(), arguments.poses // 5, arguments.baseline)
    few, many = peak_memory_MB(arguments.poses // 10), peak_memory_MB(arguments.poses)
    print(f"peak memory of the pass: {few:.0f} MB, with ten times the poses {many:.0f} MB")


if __name__ == "__main__":
    main()
