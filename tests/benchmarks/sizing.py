"""Sizing and statics of random poses against SciPy pose by pose, in the same run.

    python tests/benchmarks/sizing.py [--poses 1000000]
    python tests/benchmarks/sizing.py --against OTHER/.venv/bin/python [--runs 5]

The baselines are what a user would write: the paper's equations in NumPy, given to SLSQP and to
`root` with a massless start. Ratios are what counts; absolute times depend on the machine.

With ``--against`` this checkout and another size the same poses by turns, each turn in a process of
its own: on all threads by the clock, on one by processor time, which hardly depends on what else
the machine does, beside the time of a fixed piece of NumPy in the same process. ``--against`` its
own Python tells how much of a difference is chance.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import resource
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from scipy.optimize import minimize, root

from designer.arrays import frozen_array
from designer.model.cable import STANDARD_GRAVITY_M_PER_S2 as G
from designer.model.cable import Material
from designer.model.region import CHUNK, Prism
from designer.model.robot import Platform, Poses, Robot
from designer.model.workspace import Workspace
from designer.sizing.newton import size_poses
from designer.statics.geometry import cable_geometry, load_wrench_N, structure_matrix
from designer.statics.inverse import solve_massless, solve_sagging
from designer.workspace import sweep
from designer.workspace.sweep import map_workspace, sweep_file

STEEL = Material(7800.0, 200e9, 180e6)
FAST = Robot(frozen_array([[0, 0, 0], [500, 0, 0], [250, 433.01, 0]]), Platform(4000.0))
REGION = Prism.over(FAST.exit_points_m, 10.35, (-200.0, -40.0))


def six_cables() -> Robot:
    def ring(radius: float, degrees: list[float]) -> np.ndarray:
        a = np.radians(degrees)
        return np.stack([radius * np.cos(a), radius * np.sin(a), 0 * a], axis=1)

    exits = ring(150.0, [0, 0, 120, 120, 240, 240])
    attachments = ring(5.0, [60, -60, 180, 60, 300, 180])
    return Robot(frozen_array(exits), Platform(4000.0, frozen_array(attachments)))


def poses_of_three(count: int) -> Poses:
    rng = np.random.default_rng(0)
    low, high = REGION.bounds_m
    points = rng.uniform(low, high, (3 * count, 3))
    return Poses.at(points[REGION.contains(points)][:count])


def poses_of_six(count: int) -> Poses:
    rng = np.random.default_rng(0)
    position = np.column_stack([rng.uniform(-40, 40, (count, 2)), rng.uniform(-150, -40, count)])
    return Poses.at(position, rng.normal(0, 0.01, (count, 3)))


class Paper:
    """The paper's equations for one pose, written down as printed, in scaled unknowns."""

    def __init__(self, robot: Robot, pose: Poses) -> None:
        geometry = cable_geometry(robot, pose)
        self.X, self.Z = geometry.horizontal_distance_m, -geometry.drop_m
        self.W = structure_matrix(robot, geometry)
        self.e = load_wrench_N(robot, pose)
        self.tension = solve_massless(robot, pose).tension_N
        self.force = self.tension.max()
        self.chord = geometry.chord_m

    def start(self) -> np.ndarray:
        share = self.tension / self.force / self.chord
        return np.stack([share * self.X, share * self.Z, np.ones_like(share)], axis=1).ravel()

    def equations(self, u: np.ndarray, area: float) -> np.ndarray:
        Fx, Fz, length = u.reshape(-1, 3).T * [[self.force], [self.force], [1.0]]
        length = length * self.chord
        w, EA = G * STEEL.density_kg_per_m3 * area, STEEL.youngs_modulus_Pa * area
        top = Fz - w * length
        x = Fx * length / EA + Fx / w * (np.arcsinh(Fz / Fx) - np.arcsinh(top / Fx))
        z = Fz * length / EA - length**2 * w / (2 * EA) + (np.hypot(Fx, Fz) - np.hypot(Fx, top)) / w
        balance = self.W @ np.stack([Fx, Fz], axis=1).ravel() - self.e
        closure = np.concatenate([x - self.X, z - self.Z]) / np.tile(self.chord, 2)
        return np.concatenate([closure, balance / self.force])

    def margin(self, u: np.ndarray, area: float) -> np.ndarray:
        Fx, Fz, length = u.reshape(-1, 3).T * [[self.force], [self.force], [1.0]]
        w = G * STEEL.density_kg_per_m3 * area
        return 1.0 - np.hypot(Fx, Fz - w * length * self.chord) / (STEEL.allowable_stress_Pa * area)


def slsqp_diameter_m(robot: Robot, pose: Poses) -> float:
    paper = Paper(robot, pose)
    unit = paper.force / STEEL.allowable_stress_Pa
    answer = minimize(
        lambda u: u[-1],
        np.append(paper.start(), 1.0),
        jac=lambda u: np.eye(u.size)[-1],
        method="SLSQP",
        constraints=[
            {"type": "eq", "fun": lambda u: paper.equations(u[:-1], u[-1] * unit)},
            {"type": "ineq", "fun": lambda u: paper.margin(u[:-1], u[-1] * unit)},
        ],
        options={"ftol": 1e-12, "maxiter": 300},
    )
    return math.sqrt(4 * answer.x[-1] * unit / math.pi)


def root_lengths_m(robot: Robot, pose: Poses, area: float) -> np.ndarray:
    paper = Paper(robot, pose)
    answer = root(paper.equations, paper.start(), args=(area,), tol=1e-12)
    return answer.x.reshape(-1, 3)[:, 2] * paper.chord


def seconds_per_pose(work: Callable[[], object], count: int, repeats: int = 3) -> float:
    best = math.inf
    for _ in range(repeats):
        start = time.perf_counter()
        work()
        best = min(best, time.perf_counter() - start)
    return best / count


def one(poses: Poses, k: int) -> Poses:
    return poses.part(k)


def in_chunks(solve: Callable[[Poses], object], poses: Poses) -> None:
    for at in range(0, len(poses.position_m), CHUNK):
        solve(poses.part(slice(at, at + CHUNK)))


def compare(name: str, robot: Robot, poses: Poses, n_baseline: int) -> None:
    cable = STEEL.cable(0.04)
    size_poses(robot, one(poses, 0), STEEL)  # compiled or loaded before the clock starts
    ours = seconds_per_pose(
        lambda: in_chunks(lambda p: size_poses(robot, p, STEEL), poses), len(poses.position_m)
    )
    fixed = seconds_per_pose(
        lambda: in_chunks(lambda p: solve_sagging(robot, p, cable), poses), len(poses.position_m)
    )
    some = range(n_baseline)
    slsqp = seconds_per_pose(
        lambda: [slsqp_diameter_m(robot, one(poses, k)) for k in some], n_baseline, 2
    )
    rooted = seconds_per_pose(
        lambda: [root_lengths_m(robot, one(poses, k), math.pi * 0.01**2 * 4) for k in some],
        n_baseline, 2,
    )  # fmt: skip
    newton = size_poses(robot, poses, STEEL).diameter_m
    agreement = [abs(slsqp_diameter_m(robot, one(poses, k)) / newton[k] - 1) for k in some]
    print(f"{name}: {len(poses.position_m)} poses, baseline on {n_baseline}")
    for task, fast, peer, slow in (
        ("sizing", ours, "SLSQP", slsqp),
        ("statics", fixed, "root", rooted),
    ):
        times = f"{1e6 * fast:8.3f} µs   {peer:5} {1e6 * slow:8.0f} µs"
        print(f"  {task:8} {times}   ratio {slow / fast:10.0f}")
    print(f"  difference {np.median(agreement):.0e} (median), {max(agreement):.0e} (largest)")


def fixed_work() -> None:
    """Some NumPy that no checkout changes."""
    x = np.linspace(0.1, 2.0, 2**14)
    for _ in range(50):
        x = np.sqrt(1.0 + x * x) - 0.4


def costs_us(poses: int) -> dict[str, float]:
    """Return what a pose costs through the public API, and the fixed work [µs].

    The least of some repetitions. Of six cables no other branches are sought, which takes a
    thousand times as long. Where this process has one processor, by processor time.
    """
    is_alone = len(os.sched_getaffinity(0)) == 1
    os.cpu_count = lambda: len(os.sched_getaffinity(0))  # threads of our pool
    clock = time.process_time if is_alone else time.perf_counter

    def cost(work: Callable[[], object], count: int, repeats: int) -> float:
        work()
        spent = []
        for _ in range(repeats):
            start = clock()
            work()
            spent.append(clock() - start)
        return 1e6 * min(spent) / count

    three, six = poses_of_three(poses), poses_of_six(poses)
    workspace, robot = Workspace(REGION, samples=poses), six_cables()
    found = {"fixed work": cost(fixed_work, 1, 9)}
    sized = {
        "3 cables": lambda p: size_poses(FAST, p, STEEL),
        "6 cables": lambda p: size_poses(robot, p, STEEL),
    }
    for (name, size), those in zip(sized.items(), (three, six), strict=True):
        found[name] = cost(lambda size=size, those=those: in_chunks(size, those), poses, 5)
    with TemporaryDirectory() as folder:
        file = Path(folder) / "sweep.nc"
        found["sweep, 3 cables"] = cost(lambda: sweep_only(workspace, file), poses, 3)
    return found


def sweep_only(workspace: Workspace, file: Path) -> None:
    """Size, survey and store every sample, without the search between them."""
    gathered = sweep._Gathered(workspace)
    with sweep_file(file, FAST.n_cables, {}) as store:
        for positions in workspace.positions_m():
            some, sizing = sweep.size_worst(FAST, workspace, positions, STEEL)
            gathered.add(some, sizing)
            store(some, sizing)


def compare_checkouts(pythons: list[str], poses: int, runs: int) -> None:
    """Print costs of each checkout and their ratio, from medians over alternating runs."""
    for threads in sorted({os.cpu_count() or 1, 1}):
        taken: list[list[dict[str, float]]] = [[] for _ in pythons]
        for _ in range(runs):
            for mine, python in zip(taken, pythons, strict=True):
                command = [python, "-P", __file__, "--costs-only", str(threads)]
                run = subprocess.run(
                    [*command, "--poses", str(poses)], check=True, capture_output=True, text=True
                )
                mine.append(json.loads(run.stdout))
        print(f"{threads} threads, {poses} poses, medians of {runs} runs [µs]")
        for name in taken[0][0]:
            median = [statistics.median(one[name] for one in mine) for mine in taken]
            beside = [statistics.median(one[name] / one["fixed work"] for one in m) for m in taken]
            each = "   ".join(f"{us:9.3f}" for us in median)
            tail = f"   ratio {beside[0] / beside[1]:.2f}" if len(pythons) > 1 else ""
            print(f"  {name:16} {each}{tail}")


def peak_memory_MB(samples: int) -> float:
    """Peak of a process of its own that maps the workspace."""
    command = [sys.executable, __file__, "--map-only", str(samples)]
    run = subprocess.run(command, check=True, capture_output=True, text=True)
    return float(run.stdout)


def map_only(samples: int) -> None:
    map_workspace(FAST, Workspace(REGION, samples=samples), STEEL)
    print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--poses", type=int, default=1_000_000)
    parser.add_argument("--baseline", type=int, default=60)
    parser.add_argument("--against", help="Python of the other checkout")
    parser.add_argument("--runs", type=int, default=5, help="of each checkout")
    parser.add_argument("--map-only", type=int, help=argparse.SUPPRESS)
    parser.add_argument("--costs-only", type=int, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.costs_only:
        os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[: arguments.costs_only])
        print(json.dumps(costs_us(arguments.poses)))
        return
    if arguments.against:
        compare_checkouts([sys.executable, arguments.against], arguments.poses, arguments.runs)
        return
    if arguments.map_only:
        map_only(arguments.map_only)
        return
    compare_checkouts([sys.executable], arguments.poses, 1)
    print(f"{os.cpu_count()} threads")
    compare("3 cables, 3 DOF", FAST, poses_of_three(arguments.poses), arguments.baseline)
    compare("6 cables, 6 DOF", six_cables(), poses_of_six(arguments.poses), arguments.baseline)
    few, many = peak_memory_MB(arguments.poses), peak_memory_MB(10 * arguments.poses)
    print(f"peak memory of the map: {few:.0f} MB, with ten times the poses {many:.0f} MB")


if __name__ == "__main__":
    main()
