"""Robots for the tests of forward statics, stiffness and clearance."""

from __future__ import annotations

import numpy as np

from designer.model.cable import Cable, Material
from designer.model.robot import Poses, Robot
from designer.reference import cases

COGIRO = cases.COGIRO
COGIRO_CABLE = Material(7800.0, 100e9, 1e9).cable(0.004)

ROPE = Cable(0.03, 3.5, 5e7, 2e5)


def poses_under(robot: Robot, count: int, seed: int, turn_rad: float = 0.05) -> Poses:
    """Return random poses below the exit points, slightly turned where the platform can."""
    rng = np.random.default_rng(seed)
    exits = robot.exit_points_m
    position = rng.dirichlet(2.0 * np.ones(robot.n_cables), count) @ exits
    extent = np.ptp(exits[:, 0])
    position[:, 2] = exits[:, 2].min() - rng.uniform(0.1, 0.5, count) * extent
    if robot.is_point_mass:
        return Poses.at(position)
    return Poses.at(position, rng.normal(0.0, turn_rad, (count, 3)))
