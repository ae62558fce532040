"""Probabilities against brute-force sampling by SciPy's own equilibrium, on random robots.

For each random point mass in a random box: our probability that the chosen rope is enough, and that
of draws of its own, each solved at corners and a grid of the box by ``tests/brute_force.py``, which
shares no code with the package, and climbed from the worst by Nelder and Mead. Then, draw by draw,
by how much the climb finds more than our poses have.

    python tests/benchmarks/uncertainty.py --robots 6 --draws 300 --seed 1
"""

from __future__ import annotations

import argparse
import sys
import time
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import minimize
from scipy.stats import binomtest

sys.path.insert(0, str(Path(__file__).parents[1]))
sys.path.insert(0, str(Path(__file__).parents[1] / "selection"))

from brute_force import G, utilisation
from ropes import rope

from designer.analysis.uncertainty import draws_at, uncertainty_of
from designer.effects.design import AsBuilt
from designer.model.cable import Material
from designer.model.region import Prism
from designer.model.robot import Platform, Robot
from designer.model.uncertainty import Normal, Uncertainty, Uniform
from designer.model.workspace import Workspace
from designer.progress import SILENT
from designer.selection.select import select
from designer.study import Selection, Study

SIZES = [round(2.0 + 0.05 * k, 2) for k in range(300)]
STEEL = Material(5290.0, 62.7e9, 198e6)
ASKED = Uncertainty(
    payload=Normal(0.05), modulus=Uniform(-0.2, 0.2), linear_mass=Uniform(-0.05, 0.1),
    breaking_load=Normal(0.04), exit_points_m=Normal(0.1), samples=4096,
)  # fmt: skip


def case_of(rng: np.random.Generator) -> tuple[Robot, Workspace, np.ndarray]:
    """Return a robot on three masts, a box below them, and the box's ends (3, 2)."""
    size = 10.0 ** rng.uniform(1.2, 1.8)
    turn = 2 * np.pi * (np.arange(3) + rng.uniform(-0.1, 0.1, 3)) / 3
    height = size * rng.uniform(0.7, 1.1, 3)
    exits = np.column_stack([size * np.cos(turn), size * np.sin(turn), height])
    half, low = size * rng.uniform(0.05, 0.2, 2), size * rng.uniform(0.0, 0.1)
    box = np.array([[-half[0], half[0]], [-half[1], half[1]], [low, low + 0.2 * size]])
    workspace = Workspace(Prism.box(*map(tuple, box.tolist())), samples=500)
    return Robot(exits, Platform(float(10.0 ** rng.uniform(1.5, 2.8)))), workspace, box


@dataclass(frozen=True)
class Brute:
    """The same question, for SciPy alone."""

    robot: Robot
    box: np.ndarray
    figures: np.ndarray  # Mass per length [kg/m], EA [N], allowable tension [N]

    def worst(self, exits: np.ndarray, payload: float, factors: np.ndarray) -> float:
        """Return the largest utilisation on a grid with the corners, and by a climb from there."""
        load = np.array([0.0, 0.0, -payload * self.robot.platform.mass_kg * G])
        rope_now = tuple(self.figures * factors)
        grid = np.array(list(product(*[np.linspace(*ends, 3) for ends in self.box])))
        each = [utilisation(exits, at, load, rope_now) for at in grid]
        start = grid[int(np.argmax(each))]
        inward = np.where(start > self.box.mean(axis=1), -0.05, 0.05) * np.ptp(self.box, axis=1)
        climbed = minimize(
            lambda at: -utilisation(exits, np.clip(at, *self.box.T), load, rope_now),
            start,
            method="Nelder-Mead",
            options={
                "maxfev": 40,
                "initial_simplex": start + np.vstack([0 * inward, np.diag(inward)]),
            },
        )
        return max(*each, -climbed.fun)

    def drawn(self, rng: np.random.Generator) -> float:
        """Return it for inputs drawn here, from the distributions of `ASKED`."""
        factors = np.array([rng.uniform(0.95, 1.1), rng.uniform(0.8, 1.2), 1 + 0.04 * rng.normal()])
        moved = self.robot.exit_points_m + rng.normal(0, 0.1, (3, 3))
        return self.worst(moved, 1 + 0.05 * rng.normal(), factors)


def row(robot: Robot, workspace: Workspace, box: np.ndarray, draws: int, rng: Any) -> str:
    """Return what there is to compare for one robot."""
    selection = Selection(safety_factor=5.0)
    chosen = select(robot, workspace, selection, [rope("a", SIZES)])
    if chosen.chosen is None:
        return f"no rope: {chosen.reason}"
    study = Study("a", robot, STEEL, workspace=workspace, selection=selection, uncertainty=ASKED)
    began = time.perf_counter()
    found = uncertainty_of(study, chosen, AsBuilt(robot), SILENT)
    ours_s = time.perf_counter() - began
    assert found is not None
    own = found.chosen
    cable = own.candidate.cable
    figures = [cable.linear_density_kg_per_m, cable.axial_stiffness_N, cable.allowable_tension_N]
    brute = Brute(robot, box, np.array(figures))
    enough = sum(brute.drawn(rng) <= 1.0 for _ in range(draws))
    theirs = binomtest(enough, draws).proportion_ci(0.95, "exact")
    same = draws_at(found.spreads, robot, np.random.default_rng(0).random((ASKED.samples, 13)))
    missed = -np.inf
    for k in range(draws // 5):
        rope_now = np.array([same.linear_mass[k], same.modulus[k], same.breaking_load[k]])
        exits = robot.exit_points_m + same.exit_points_m[k]
        missed = max(missed, brute.worst(exits, same.payload[k], rope_now) - own.utilisation[k])
    low, high = own.probability_95
    return (
        f"{own.candidate.verification.utilisation:6.1%}  {own.probability:6.1%} ({low:6.1%} to "
        f"{high:6.1%})  {enough / draws:6.1%} ({theirs.low:6.1%} to {theirs.high:6.1%})  "
        f"{100 * missed:+9.4f}  {found.poses:5d}  {ours_s:5.1f} s"
    )


def main() -> None:
    """Print a row for each robot."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--robots", type=int, default=6)
    parser.add_argument("--draws", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    print("stated  ours, 95 %                 brute force, 95 %          missed, points  poses")
    for one in range(asked.robots):
        rng = np.random.default_rng([asked.seed, one])
        print(row(*case_of(rng), asked.draws, rng), flush=True)


if __name__ == "__main__":
    main()
