"""Random poses of random robots: none called impossible that another solver holds, none thicker.

    python tests/benchmarks/impossible.py [--poses 2000] [--seed 0] [--starts 14]

Robots have 6 to 12 cables on a body, 4 to 12 on a point mass, some as many as degrees of freedom;
hung below their exit points or held from all sides, from hardly any sag to cables that can bear
little more than themselves, some with a least tension. The other solver is SLSQP from many starts
(`tests/twins/thinnest.py`). Ends with status 1 if a pose is called impossible that it holds, or
answered with a cable more than 0.1 % thicker than its best.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from twins.thinnest import STARTS, thinnest

from designer.arrays import frozen_array
from designer.model.cable import Material
from designer.model.robot import Platform, Poses, Robot
from designer.model.verdict import Verdict
from designer.sizing.newton import size_poses

IMPOSSIBLE = (Verdict.OUTSIDE_HULL, Verdict.NO_FINITE_CABLE, Verdict.RANK_DEFICIENT)
THICKER = 1.001
POSES_OF_ROBOT = 5


@dataclass(frozen=True)
class Case:
    """A random robot, its cables' material and some poses."""

    name: str
    robot: Robot
    material: Material
    position: np.ndarray
    turn: np.ndarray


def random_case(rng: np.random.Generator, count: int = POSES_OF_ROBOT) -> Case:
    """Return a random robot with random poses, many of them hard or impossible to hold."""
    is_body = rng.random() < 0.75
    n = int(rng.integers(6, 13)) if is_body else int(rng.integers(3, 13))
    hung = rng.random() < 0.6
    size = 10 ** rng.uniform(0.5, 2.3)
    box = size * rng.uniform(0.5, 1.0, 3)
    exits = rng.uniform(-1.0, 1.0, (n, 3)) * box
    edge = rng.integers(0, 2, n)
    exits[np.arange(n), edge] = np.sign(exits[np.arange(n), edge]) * box[edge]
    if hung:
        exits[:, 2] = box[2] * rng.uniform(0.7, 1.0, n)
    mass = 10 ** rng.uniform(1.0, 4.0)
    attachments = rng.uniform(-1.0, 1.0, (n, 3)) * size * 10 ** rng.uniform(-1.7, -0.5)
    centre = rng.uniform(-0.2, 0.2, 3) * np.abs(attachments).max()
    platform = (
        Platform(mass, frozen_array(attachments), frozen_array(centre))
        if is_body
        else Platform(mass)
    )
    least = mass * 9.81 * rng.uniform(0.01, 0.2) if rng.random() < 0.2 else 0.0
    robot = Robot(frozen_array(exits), platform, tension_min_N=least)
    if not robot.is_redundant:
        robot = Robot(frozen_array(exits), platform)
    # The length whose own weight breaks the cable, in sizes of the robot: the level of sag.
    strength = size * 10 ** rng.uniform(0.4, 2.6)
    stress = 180e6
    material = Material(stress / (9.81 * strength), stress / 10 ** rng.uniform(-3.3, -2.0), stress)
    low, high = np.array([-0.9, -0.9, -1.0]), np.array([0.9, 0.9, 0.8 if not hung else 0.6])
    position = rng.uniform(low, high, (count, 3)) * box
    return Case(
        f"{'body' if is_body else 'point'} {n}{' hung' if hung else ''}{' least' if least else ''}",
        robot, material, position, rng.normal(0.0, 0.15, (count, 3)),
    )  # fmt: skip


def compare(case: Case, rng: np.random.Generator, starts: int) -> list[tuple[str, str]]:
    """Return what each pose ends as, and a line on those that end badly."""
    turn = None if case.robot.is_point_mass else case.turn
    poses = Poses.at(case.position, turn)
    sizing = size_poses(case.robot, poses, case.material)
    found = []
    for k in range(len(case.position)):
        verdict = Verdict(int(sizing.statics.verdict[k]))
        ours = float(sizing.diameter_m[k])
        other = thinnest(case.robot, case.position[k], case.turn[k], case.material, rng, starts)
        line = ""
        outcome = verdict.label
        if np.isfinite(other.diameter_m):
            longest = float((other.length_m / sizing.statics.geometry().chord_m[k]).max())
            told = (
                f"{case.name} pose {k}: {{}}; other {1e3 * other.diameter_m:.4g} mm, "
                f"longest cable {longest:.2f} chords"
            )
            if verdict in IMPOSSIBLE:
                outcome, line = "wrongly " + verdict.label, told.format(verdict.label)
            elif verdict is not Verdict.SOLVED:
                outcome, line = "missed " + verdict.label, told.format(verdict.label)
            elif ours > THICKER * other.diameter_m:
                by = 100 * (ours / other.diameter_m - 1)
                outcome, line = "thicker", told.format(f"{1e3 * ours:.4g} mm, {by:.2f} % thicker")
            elif other.diameter_m > THICKER * ours:
                outcome = "solved, other thicker"
        elif verdict is Verdict.SOLVED:
            outcome = "solved, other none"
        found.append((outcome, line))
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--poses", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--starts", type=int, default=STARTS)
    parser.add_argument("--quiet", action="store_true")
    given = parser.parse_args()
    outcomes: Counter[str] = Counter()
    bad = 0
    begun = time.perf_counter()
    for index in range(-(-given.poses // POSES_OF_ROBOT)):
        rng = np.random.default_rng([given.seed, index])
        for outcome, line in compare(random_case(rng), rng, given.starts):
            outcomes[outcome] += 1
            bad += outcome == "thicker" or outcome.startswith("wrongly")
            if line and not given.quiet:
                print(f"{index}: {line}", flush=True)
        if index % 20 == 19:
            print(f"{index + 1} robots, {bad} bad, {time.perf_counter() - begun:.0f} s", flush=True)
    print(
        f"{sum(outcomes.values())} poses in {time.perf_counter() - begun:.0f} s, seed {given.seed}"
    )
    for outcome, count in outcomes.most_common():
        print(f"  {count:6} {outcome}")
    sys.exit(1 if bad else 0)


if __name__ == "__main__":
    main()
