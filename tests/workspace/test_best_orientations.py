"""The orientation that is chosen in a range, against a grid of them that SciPy solves."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from pairs.reference import Pose, Problem, feasible, solve

from designer.arrays import frozen_array
from designer.model.cable import STANDARD_GRAVITY_M_PER_S2 as GRAVITY
from designer.model.cable import Material
from designer.model.region import Prism
from designer.model.robot import Platform, Robot
from designer.workspace.best_orientations import BestOrientations

STEEL = Material(7800.0, 1e11, 1.8e8)
NEAR = 0.02
"""Of the utilisation: twice the hundredth to which the diameter of the best turn is sought."""


def random_body(rng: np.random.Generator, n_cables: int) -> Robot:
    """Return a body on cables that alternate in how they cross to its corners."""
    azimuth = 2.0 * np.pi * (np.arange(n_cables) + rng.uniform(-0.15, 0.15, n_cables)) / n_cables
    around = np.column_stack([np.cos(azimuth), np.sin(azimuth)])
    exits_m = np.column_stack([rng.uniform(6.5, 8.0) * around, rng.uniform(8.0, 10.0, n_cables)])
    turned = azimuth + np.where(np.arange(n_cables) % 2, 0.7, -0.7)
    held_m = rng.uniform(0.7, 1.1, (n_cables, 1)) * np.column_stack(
        [np.cos(turned), np.sin(turned), rng.uniform(-0.1, 0.1, n_cables)]
    )
    return Robot(
        frozen_array(exits_m),
        Platform(
            float(rng.uniform(50.0, 500.0)),
            frozen_array(held_m),
            centre_of_mass_m=frozen_array(rng.uniform(-0.1, 0.1, 3)),
        ),
    )


def problem_of(robot: Robot, diameter_m: float) -> Problem:
    area_m2, n = 0.25 * np.pi * diameter_m**2, robot.n_cables
    weight = np.array([0.0, 0.0, -GRAVITY])
    return Problem(
        exits_m=robot.exit_points_m,
        arms_m=robot.attachments_m,
        load_N_per_m=np.tile(7800.0 * area_m2 * weight, (n, 1)),
        stiffness_N=np.full(n, 1e11 * area_m2),
        allowable_N=np.full(n, 1.8e8 * area_m2),
        mass_kg_per_m=np.full(n, 7800.0 * area_m2),
        force_N=np.zeros(3),
        moment_Nm=np.zeros(3),
        centre_m=robot.platform.centre_of_mass_m,
        centre_force_N=robot.platform.mass_kg * weight,
        freedoms=np.eye(6),
    )


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20))
def test_no_orientation_of_a_grid_needs_less(seed: int) -> None:
    rng = np.random.default_rng([20261126, seed])
    robot = random_body(rng, 6 + seed % 3)
    reach_rad = np.radians(rng.uniform(5.0, 20.0, (2, 3))) * [[-1.0], [1.0]] * [1.0, 1.0, 0.0]
    region = Prism.box((-1.5, 1.5), (-1.5, 1.5), (1.0, 4.0))
    law = BestOrientations(robot, STEEL, region, frozen_array(reach_rad))
    position_m = rng.uniform([-1.5, -1.5, 1.0], [1.5, 1.5, 4.0])
    (turn,), (diameter_m,) = law.best(position_m[None])
    grid = [np.array([*each, 0.0]) for each in product(*np.linspace(*reach_rad, 5).T[:2])]
    problem = problem_of(robot, float(diameter_m))
    find = solve if robot.n_cables == 6 else feasible
    on_grid = [find(problem, Pose(position_m, each)) for each in grid]
    held = [state.utilisation for state in on_grid if state is not None]
    assert np.all(turn >= reach_rad[0] - 1e-9)
    assert np.all(turn <= reach_rad[1] + 1e-9)
    best = find(problem, Pose(position_m, turn))
    assert best is not None
    assert best.utilisation == pytest.approx(1.0, abs=NEAR if robot.n_cables > 6 else 1e-6)
    assert min(held, default=np.inf) >= 1.0 - NEAR
