"""Eight cables on a platform: the compiled map against CVXPY and SciPy pose by pose, in one run.

    python tests/benchmarks/redundant.py [--poses 200000]

The baselines are what a user would write: sequential convex programming with a parametrised CVXPY
problem that is built once, and the paper's equations in NumPy given to SLSQP, both from the
massless solution. Ratios are what counts; absolute times depend on the machine.
"""

from __future__ import annotations

import argparse
import math
import os
import resource
import subprocess
import sys
from collections import Counter
from pathlib import Path

import numpy as np
from scipy.optimize import minimize

sys.path.insert(0, str(Path(__file__).parents[1]))

from convex_tensions import BLOCK, distribute
from redundant_robots import anywhere, cogiro_poses, one
from sample_robots import COGIRO
from sizing import STEEL, Paper, in_chunks, seconds_per_pose

from designer.model.cable import Material
from designer.model.region import Prism
from designer.model.robot import Poses
from designer.model.verdict import Verdict
from designer.model.workspace import Workspace
from designer.sizing.newton import size_poses
from designer.sizing.scp import size_by_scp
from designer.statics.inverse import distribute_evenly, solve_sagging
from designer.workspace.sweep import map_workspace

REGION = Prism.box((-4.0, 4.0), (-3.0, 3.0), (0.3, 3.0))


def heavier(weights: float) -> Material:
    return Material(7800.0 * weights, 200e9, 180e6)


def slsqp_diameter_m(pose: Poses) -> float:
    paper = Paper(COGIRO, pose)
    paper.tension = np.maximum(paper.tension, 0.02 * paper.force)
    unit = paper.force / STEEL.allowable_stress_Pa
    answer = minimize(
        lambda u: u[-1],
        np.append(paper.start(), 1.0),
        jac=lambda u: np.eye(u.size)[-1],
        method="SLSQP",
        bounds=[(1e-9, None), (None, None), (1e-9, None)] * COGIRO.n_cables + [(1e-9, None)],
        constraints=[
            {"type": "eq", "fun": lambda u: paper.equations(u[:-1], u[-1] * unit)},
            {"type": "ineq", "fun": lambda u: paper.margin(u[:-1], u[-1] * unit)},
        ],
        options={"ftol": 1e-12, "maxiter": 300},
    )
    return math.sqrt(4 * answer.x[-1] * unit / math.pi)


def part(poses: Poses, count: int) -> Poses:
    return Poses(poses.position_m[:count], poses.rotation[:count])


def sizing(poses: Poses, n_baseline: int) -> None:
    count, some = len(poses.position_m), range(n_baseline)
    for weights in (1.0, 30.0, 60.0):
        material = heavier(weights)
        size_poses(COGIRO, part(poses, 1), material)  # compiled or loaded before the clock starts
        ours = seconds_per_pose(
            lambda m=material: in_chunks(lambda p: size_poses(COGIRO, p, m), poses), count
        )
        cable = material.cable(0.003)
        fixed = seconds_per_pose(
            lambda c=cable: in_chunks(lambda p: solve_sagging(COGIRO, p, c), poses), count
        )
        convex = seconds_per_pose(
            lambda m=material: [size_by_scp(COGIRO, one(poses, k), m) for k in some], n_baseline, 2
        )
        print(f"cables × {weights:g}: sizing {1e6 * ours:.2f} µs, given cable {1e6 * fixed:.2f} µs")
        print(f"  CVXPY pose by pose {1e6 * convex:7.0f} µs   ratio {convex / ours:6.0f}")
        if weights == 1.0:
            slow = seconds_per_pose(
                lambda: [slsqp_diameter_m(one(poses, k)) for k in some], n_baseline, 2
            )
            print(f"  SLSQP pose by pose {1e6 * slow:7.0f} µs   ratio {slow / ours:6.0f}")
            found = size_poses(COGIRO, part(poses, n_baseline), material).diameter_m
            agree = [abs(slsqp_diameter_m(one(poses, k)) / found[k] - 1) for k in some]
            print(
                f"  difference to SLSQP {np.median(agree):.0e} (median), {max(agree):.0e} (largest)"
            )


def massless(poses: Poses) -> None:
    count = len(poses.position_m)
    distribute_evenly(COGIRO, part(poses, 1))
    ours = seconds_per_pose(lambda: in_chunks(lambda p: distribute_evenly(COGIRO, p), poses), count)
    block = part(poses, 5 * BLOCK)
    blocks = seconds_per_pose(lambda: distribute(COGIRO, block, math.inf), 5 * BLOCK, 2)
    single = seconds_per_pose(
        lambda: [distribute(COGIRO, one(poses, k), math.inf) for k in range(20)], 20, 2
    )
    print(f"smallest largest tension, with proof: {1e6 * ours:.2f} µs")
    print(f"  CVXPY in blocks    {1e6 * blocks:7.0f} µs   ratio {blocks / ours:6.0f}")
    print(f"  CVXPY pose by pose {1e6 * single:7.0f} µs   ratio {single / ours:6.0f}")


def verdicts(count: int) -> None:
    """Poses anywhere: what became of them, and the worst residual of those that are solved."""
    poses = anywhere(count)
    for weights in (1.0, 30.0, 60.0):
        sized = size_poses(COGIRO, poses, heavier(weights))
        statics = sized.statics
        solved = statics.is_solved
        names = Counter(Verdict(v).label for v in statics.verdict.tolist())
        closure = (statics.closure_residual_m()[solved] / statics.length_m[solved]).max()
        force = np.abs(statics.equilibrium_residual_N()[solved]).max(axis=1)
        balance = (force / statics.largest_tension_N[solved]).max()
        print(f"anywhere, cables × {weights:g}: {dict(names)}")
        print(f"  worst of the solved: closure {closure:.0e}, balance {balance:.0e}")


def peak_memory_MB(samples: int) -> float:
    command = [sys.executable, __file__, "--map-only", str(samples)]
    run = subprocess.run(command, check=True, capture_output=True, text=True)
    return float(run.stdout)


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--poses", type=int, default=200_000)
    parser.add_argument("--baseline", type=int, default=40)
    parser.add_argument("--map-only", type=int, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.map_only:
        map_workspace(COGIRO, Workspace(REGION, samples=arguments.map_only), STEEL)
        print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)
        return
    poses = cogiro_poses(arguments.poses)
    print(f"{os.cpu_count()} threads, {arguments.poses} poses, baseline on {arguments.baseline}")
    sizing(poses, arguments.baseline)
    massless(poses)
    verdicts(min(arguments.poses, 100_000))
    few, many = peak_memory_MB(arguments.poses // 10), peak_memory_MB(arguments.poses)
    print(f"peak memory of the map: {few:.0f} MB, with ten times the poses {many:.0f} MB")


if __name__ == "__main__":
    main()
