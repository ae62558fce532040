"""Random poses of random robots: none called impossible that another solver holds, none thicker.

    python tests/benchmarks/impossible.py [--robots 1000] [--poses 20] [--seed 0] [--starts 14]
        [--of-each 2]

Robots have 7 to 12 cables on a body, 4 to 12 on a point mass or in a plane, some as many as degrees
of freedom; hung below their exit points or held from all sides, from hardly any sag to cables that
can bear little more than themselves; some with a least tension, another largest sag, pulleys, wind
on the platform or on the cables. Each pose is asked for the thinnest cable of the family, and
whether a given cable holds it; what stays open is printed. Of each robot some poses are solved by
another solver as well, SLSQP from many starts with taut cables (`tests/twins/thinnest.py`). Ends
with status 1 if a pose is called impossible that it holds, if a cable that is called the thinnest
is more than 0.01 % thicker than its best, or if a given cable is too weak that it finds strong
enough. What is thicker, or more loaded, but makes no such claim is counted and printed.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1]))

from twins.thinnest import STARTS, least_utilisation, thinnest

from designer.arrays import frozen_array
from designer.model.cable import Cable, Material
from designer.model.robot import Platform, Poses, Robot
from designer.model.verdict import Verdict
from designer.sizing.newton import Sizing, size_poses
from designer.statics.inverse import Statics, solve_sagging

IMPOSSIBLE = (Verdict.OUTSIDE_HULL, Verdict.NO_FINITE_CABLE, Verdict.RANK_DEFICIENT)
OPEN = (Verdict.NOT_FOUND, Verdict.NOT_CONVERGED)
THICKER = 1.0001
POSES_OF_ROBOT = 5


@dataclass(frozen=True)
class Case:
    """A random robot, its cables' material and some poses."""

    name: str
    robot: Robot
    material: Material
    position: np.ndarray
    turn: np.ndarray

    @property
    def poses(self) -> Poses:
        return Poses.at(self.position, None if self.robot.is_point_mass else self.turn)


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


def varied(case: Case, rng: np.random.Generator) -> Case:
    """Return the case, or one like it: in a plane, with pulleys, in wind, with another sag."""
    robot, position, turn, name = case.robot, case.position.copy(), case.turn.copy(), case.name
    size = float(np.abs(robot.exit_points_m).max())
    platform = robot.platform
    if rng.random() < 0.15:
        attachments = platform.attachments_m
        if attachments is not None:
            platform = replace(platform, attachments_m=frozen_array(attachments * [1.0, 0.0, 1.0]))
            turn *= [0.0, 1.0, 0.0]
        position *= [1.0, 0.0, 1.0]
        exits = frozen_array(robot.exit_points_m * [1.0, 0.0, 1.0])
        planar = replace(robot, exit_points_m=exits, platform=platform, is_planar=True)
        is_free = planar.is_redundant or planar.tension_min_N == 0.0
        robot, name = (planar, f"{name} planar") if is_free else (robot, name)
        if not is_free:
            position, turn = case.position.copy(), case.turn.copy()
    if rng.random() < 0.2:
        robot = replace(robot, pulley_radius_m=size * 10 ** rng.uniform(-3.0, -1.5))
        name += " pulleys"
    if rng.random() < 0.2 and not robot.is_planar:
        weight = robot.platform.mass_kg * 9.81
        wind = np.append(rng.normal(0.0, 0.3, 2), 0.0)
        wrench = np.append(weight * wind, np.zeros(3))
        robot = replace(robot, platform=replace(robot.platform, wrench_N=frozen_array(wrench)))
        name += " wind"
        if rng.random() < 0.5:
            leaning = frozen_array(np.array([0.0, 0.0, -1.0]) + wind)
            robot, name = replace(robot, cable_load_direction=leaning), f"{name} on cables"
    if rng.random() < 0.3:
        robot = replace(robot, sag_max=float(rng.choice([0.02, 0.1, 0.5])))
    return replace(case, name=name, robot=robot, position=position, turn=turn)


def given_cable(case: Case, sizing: Sizing, rng: np.random.Generator) -> Cable:
    """Return a cable of the family, about as thick as some of the poses need."""
    needed = sizing.diameter_m[np.isfinite(sizing.diameter_m)]
    weight_N = case.robot.platform.mass_kg * 9.81
    likely = 2.0 * np.sqrt(weight_N / (np.pi * case.material.allowable_stress_Pa))
    typical = float(np.median(needed)) if len(needed) else likely
    return case.material.cable(typical * float(rng.uniform(0.4, 2.0)))


def _exit_points_m(robot: Robot, statics: Statics, k: int) -> np.ndarray | None:
    """Return where the cables leave their pulleys, base frame; None without pulleys.

    Of a pose that is not solved, where straight ones do.
    """
    if robot.pulley_radius_m == 0.0:
        return None
    points = np.broadcast_to(statics.run.exit_points_m, (*statics.length_m.shape, 3))[k]
    return np.asarray(points @ robot.upright)


def compare(
    case: Case, rng: np.random.Generator, starts: int, of_each: int = POSES_OF_ROBOT
) -> list[tuple[str, str]]:
    """Return what each pose ends as, and a line on those that end badly or stay open.

    So many poses of each verdict are solved by the other solver as well.
    """
    sizing = size_poses(case.robot, case.poses, case.material)
    cable = given_cable(case, sizing, rng)
    given = solve_sagging(case.robot, case.poses, cable)
    outcomes = []
    for is_sizing, statics in ((True, sizing.statics), (False, given)):
        asked: Counter[int] = Counter()
        used = np.asarray(given.largest_tension_N / cable.allowable_tension_N)
        for k in range(len(case.position)):
            verdict = Verdict(int(statics.verdict[k]))
            about = f"{case.name} {'sized' if is_sizing else 'given'} pose {k}: {verdict.label}"
            asked[verdict] += 1
            if verdict not in OPEN and asked[verdict] > of_each:
                outcomes.append((verdict.label, ""))
                continue
            exits = _exit_points_m(case.robot, statics, k)
            if exits is not None and not np.isfinite(exits).all():  # an attachment in its pulley
                is_open = verdict in OPEN
                outcome = f"open {verdict.label}" if is_open else f"{verdict.label}, no exit point"
                outcomes.append((outcome, about if is_open else ""))
                continue
            place = case.robot, case.position[k], case.turn[k], case.material
            if is_sizing:
                other = thinnest(*place, rng, starts, exits, is_taut=True).diameter_m
                pose = case.poses.part(np.array([k]))
                proved = size_poses(case.robot, pose, case.material, proves_thinnest=True)
                ours, is_claimed = float(proved.diameter_m[0]), bool(proved.is_thinnest[0])
            else:
                weight = cable.weight_N_per_m
                other = least_utilisation(*place, weight, rng, starts, exits, is_taut=True)[0]
                ours = float(used[k])
                is_claimed = ours > 1.0 >= other
            line, outcome = "", f"{verdict.label}, compared"
            if verdict in OPEN:
                outcome, line = f"open {verdict.label}", f"{about}; other {other:.6g}"
            elif np.isfinite(other) and verdict in IMPOSSIBLE:
                outcome, line = f"wrongly {verdict.label}", f"{about}; other {other:.6g}"
            elif ours > (THICKER if is_sizing else THICKER**2) * other:
                more = "thicker" if is_sizing else "more loaded"
                outcome = f"wrongly {more}" if is_claimed else f"{more}, told as not proved"
                line = f"{about} {ours:.6g}; other {other:.6g}, {outcome}"
            elif np.isnan(other) and verdict is Verdict.SOLVED:
                outcome = "solved, other none"
            outcomes.append((outcome, line))
    return outcomes


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--robots", type=int, default=1000)
    parser.add_argument("--poses", type=int, default=20)
    parser.add_argument("--of-each", type=int, default=2)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--starts", type=int, default=STARTS)
    given = parser.parse_args()
    outcomes: Counter[str] = Counter()
    bad = 0
    begun = time.perf_counter()
    for index in range(given.robots):
        rng = np.random.default_rng([given.seed, index])
        case = varied(random_case(rng, given.poses), rng)
        for outcome, line in compare(case, rng, given.starts, given.of_each):
            outcomes[outcome] += 1
            bad += outcome.startswith("wrongly")
            if line:
                print(f"{index}: {line}", flush=True)
        if index % 50 == 49:
            print(f"{index + 1} robots, {bad} bad, {time.perf_counter() - begun:.0f} s", flush=True)
    print(
        f"{sum(outcomes.values())} answers in {time.perf_counter() - begun:.0f} s, "
        f"seed {given.seed}"
    )
    for outcome, count in outcomes.most_common():
        print(f"  {count:6} {outcome}")
    sys.exit(1 if bad else 0)


if __name__ == "__main__":
    main()
