"""Random regions of every shipped robot: does anything exceed the worst pose that is reported?

    python tests/benchmarks/worst.py [--regions 500] [--samples 1000000] [--seed 0] [--first 0]
                                      [--only NAME]

Each region is mapped as the report does; then the same demands are asked at many more samples, at
every vertex, and about the largest of these by differential evolution. What exceeds the
reported extreme by more than 1e-6 of it is told, and ends the run with status 1. The extremes are
the needed diameter and the massless tension, and for a rope that nearly holds its tension, its
two of its longest and shortest lengths, the softest pose and, of one region in five, the smallest
clearance.
"""

from __future__ import annotations

import argparse
import itertools
import sys
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from designer.arrays import FloatArray, frozen_array
from designer.io.config import read_study
from designer.model.region import Prism, Rectangle
from designer.model.robot import Poses, Robot
from designer.model.space import Orientations
from designer.model.workspace import Workspace
from designer.resources import example_file, example_names
from designer.selection.verify import verify
from designer.statics.inverse import solve_sagging
from designer.study import Study
from designer.workspace.clearance import smallest_clearance, survey
from designer.workspace.demand import diameter_demand, is_left_out, massless_demand, rope_demand
from designer.workspace.refine import Demand
from designer.workspace.stiffness import displacement_demand, survey_stiffness
from designer.workspace.sweep import map_workspace

_TOLERANCE = 1e-6
_SLOW_SAMPLES = {"stiffness": 20_000, "clearance": 2_000}
_CHUNK = 2**15
_POLISHED = 3
_TOUCHING_M = 1e-6
"""Cables nearer than this touch."""


def random_workspace(study: Study, rng: np.random.Generator) -> Workspace:
    """Return a region in or about that of the study: inset, shifted, cut; few or many samples."""
    assert study.workspace is not None
    given = study.workspace
    region = given.region
    z = np.sort(rng.uniform(*_widened(np.array(region.bounds_m[:, 2]), 0.1), 2))
    if isinstance(region, Rectangle):
        ends = np.sort(rng.uniform(0.0, 1.0, 2))
        plan = region.ends_m[0] + ends[:, None] * (region.ends_m[1] - region.ends_m[0])
        region = Rectangle(frozen_array(plan), (z[0], z[1]))
    elif study.robot.n_cables == 3 and rng.random() < 0.7:
        size = np.ptp(study.robot.exit_points_m[:, :2])
        inset = size * rng.choice([rng.uniform(0.006, 0.01), rng.uniform(0.01, 0.1)])
        region = Prism.over(study.robot.exit_points_m, float(inset), (z[0], z[1]))
    else:
        corners = _widened(region.bounds_m[:, :2], 0.15)
        low, high = np.sort(rng.uniform(*corners, (2, 2)), axis=0)
        region = Prism.box((low[0], high[0]), (low[1], high[1]), (z[0], z[1]))
    return replace(
        given,
        region=region,
        samples=int(rng.choice([50, 1000, 20_000])),
        sampling=str(rng.choice(["low_discrepancy", "grid"]))
        if given.sampling != "grid"
        else "grid",
        seed=int(rng.integers(1000)),
        hangs_below=str(rng.choice(["include", "exclude"])),
        orientations=_random_orientations(study.robot, given.orientations, rng),
    )


def _widened(bounds: FloatArray, share: float) -> FloatArray:
    middle = bounds.mean(axis=0)
    return middle + (1.0 + share) * (bounds - middle)


def _random_orientations(
    robot: Robot, given: Orientations, rng: np.random.Generator
) -> Orientations:
    if robot.is_point_mass or rng.random() < 0.3:
        return given if not robot.is_point_mass else Orientations()
    free = np.array([0.0, 1.0, 0.0]) if robot.is_planar else np.ones(3)
    if robot.is_planar or rng.random() < 0.5:
        return Orientations(frozen_array(rng.normal(0.0, 0.05, (rng.integers(1, 4), 3)) * free))
    half = rng.uniform(0.0, 0.06, 3) * (rng.random(3) < 0.6)
    return Orientations.within(-half, half) if half.any() else Orientations()


def dense(
    workspace: Workspace, demand: Demand, count: int, rng: np.random.Generator
) -> tuple[float, FloatArray | None]:
    """Return the largest demand over random places and vertices, polished, and where."""
    best = np.empty((0, workspace.space.n_coordinates))
    values = np.empty(0)
    for at in range(0, count + 1, _CHUNK):
        some = _vertices(workspace) if at == 0 else _random_places(workspace, _CHUNK, rng)
        best, values = np.concatenate([best, some]), np.concatenate([values, demand(some)])
        kept = np.argsort(-values)[:200]
        best, values = best[kept], values[kept]
        if len(values) and np.isposinf(values[0]):
            return float(values[0]), best[0]
    counts = ~np.isneginf(values)
    best, values = best[counts], values[counts]
    if not len(values):
        return -np.inf, None
    size = np.ptp(workspace.space.bounds, axis=0)
    starts: list[int] = []
    for k in range(len(best)):
        far = [np.abs((best[k] - best[j]) / np.where(size > 0, size, 1.0)).max() for j in starts]
        if len(starts) < _POLISHED and min(far, default=1.0) > 0.05:
            starts.append(k)
    polished = [_polish(workspace, demand, best[k], float(values[k]), k) for k in starts]
    return max(polished, key=lambda one: one[0])


def _vertices(workspace: Workspace) -> FloatArray:
    region = workspace.region
    plan = region.ends_m if isinstance(region, Rectangle) else region.polygon_m
    corners = np.array([[*xy, z] for xy in plan for z in region.z_m])
    if workspace.orientations.range_rad is None:
        return workspace.space.places(corners)
    turns = np.array(list(itertools.product(*workspace.orientations.range_rad.T)))
    return np.array([[*p, *t] for p in corners for t in turns])


def _random_places(workspace: Workspace, count: int, rng: np.random.Generator) -> FloatArray:
    low, high = workspace.space.bounds
    region = workspace.region
    if isinstance(region, Rectangle):
        positions = region.at(rng.random((count, 2)))
    else:
        positions = rng.uniform(*region.bounds_m, (count, 3))
        positions = positions[region.contains(positions)]
    if workspace.orientations.range_rad is not None:
        return np.hstack([positions, rng.uniform(low[3:], high[3:], (len(positions), 3))])
    return workspace.space.places(positions)


def _polish(
    workspace: Workspace, demand: Demand, start: FloatArray, value: float, seed: int
) -> tuple[float, FloatArray]:
    """Climb by differential evolution about the best, in a box, then in a smaller one."""
    from scipy.optimize import differential_evolution

    space = workspace.space
    size = np.ptp(space.bounds, axis=0)
    free = size > 0.0
    best = value, start

    def burden(x: FloatArray) -> FloatArray:
        nonlocal best
        places = np.tile(best[1], (x.shape[1], 1))
        places[:, free] = x.T * size[free]
        places = space.nearest(places)
        asked = demand(places)
        top = int(np.argmax(asked))
        if asked[top] > best[0]:
            best = float(asked[top]), places[top]
        return -np.clip(asked, -1e30, 1e30)

    for half in (0.02, 1e-3, 3e-5):
        at = best[1][free] / size[free]
        box = [(one - half, one + half) for one in at]
        differential_evolution(
            burden, box, x0=at, vectorized=True, updating="deferred", popsize=max(24 // len(at), 5),
            maxiter=25, tol=0.0, polish=False, rng=seed,
        )  # fmt: skip
    return best


def check(study: Study, workspace: Workspace, count: int, rng: np.random.Generator) -> list[str]:
    """Return what exceeds the reported extremes, one line each."""
    robot, material, policy = study.robot, study.material, workspace.hangs_below
    faults: list[str] = []

    def compare(name: str, told: float, demand: Demand, tries: int) -> None:
        found, where = dense(workspace, demand, tries, rng)
        scale = abs(told) if np.isfinite(told) else 1.0
        if found > told + _TOLERANCE * scale:
            faults.append(f"{name}: told {told:.9g}, found {found:.9g} at {where}")

    mapped = map_workspace(robot, workspace, material)
    told = mapped.sagging.diameter_m if mapped.sagging else np.inf
    if mapped.sagging is None and mapped.infeasible_example_m is None:
        told = -np.inf
    compare("diameter", told, partial(diameter_demand, robot, material, policy), count)
    straight = mapped.massless.max_tension_N if mapped.massless else np.inf
    if mapped.census.excluded == mapped.census.samples:
        straight = -np.inf
    compare("massless", straight, partial(massless_demand, robot, material, policy), count)
    if mapped.sagging is None:
        return faults
    cable = material.cable(1.02 * told)
    rope = verify(robot, workspace, cable)
    asked = partial(rope_demand, robot, cable, policy)
    extremes = [rope.max_tension_N, *rope.longest_m, *-rope.shortest_m]
    names = ["tension", *(f"longest {k}" for k in range(1, robot.n_cables + 1))]
    names += [f"shortest {k}" for k in range(1, robot.n_cables + 1)]
    for k in (0, *rng.choice(np.arange(1, len(names)), 2, replace=False)):
        compare(names[k], extremes[k], _column(asked, k), count if k == 0 else count // 10)
    soft = survey_stiffness(robot, workspace, cable)
    if soft is not None:
        displacement = partial(displacement_demand, robot, workspace, cable)
        compare("softest", soft.softest_m_per_N, displacement, _SLOW_SAMPLES["stiffness"])
    if rng.random() < 0.2:
        near = survey(robot, workspace, cable, 0.1).worst

        def nearness(places: FloatArray) -> FloatArray:
            statics = solve_sagging(robot, Poses.at(places), cable)
            distance = smallest_clearance(statics).distance_m
            distance[is_left_out(statics, policy)] = np.nan
            return -np.maximum(np.nan_to_num(distance, nan=np.inf), _TOUCHING_M)

        told_near = -np.inf if near is None else -max(near.distance_m, _TOUCHING_M)
        compare("clearance", told_near, nearness, _SLOW_SAMPLES["clearance"])
    return faults


def _column(demand: Demand, k: int) -> Callable[[FloatArray], FloatArray]:
    return lambda places: demand(places)[:, k]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--regions", type=int, default=500)
    parser.add_argument("--samples", type=int, default=1_000_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--first", type=int, default=0, help="number of the first region")
    parser.add_argument("--only")
    options = parser.parse_args()
    names = [options.only] if options.only else list(example_names())
    studies = [read_study(example_file(name)) for name in names]
    bad = done = 0
    start = time.perf_counter()
    for number in range(options.first, options.first + options.regions):
        study = studies[number % len(studies)]
        rng = np.random.default_rng([options.seed, number])
        workspace = random_workspace(study, rng)
        faults = check(study, workspace, options.samples, rng)
        done += 1
        for fault in faults:
            print(f"{number} {names[number % len(studies)]}: {fault}", flush=True)
        bad += bool(faults)
        if done % 10 == 0:
            spent = time.perf_counter() - start
            print(f"{done} regions, {bad} with a fault, {spent:.0f} s", flush=True)
    print(f"{done} regions, {bad} with a fault")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
