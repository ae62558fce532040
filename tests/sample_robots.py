"""Robots for the tests of forward statics, stiffness and clearance."""

from __future__ import annotations

import numpy as np

from designer.arrays import frozen_array
from designer.model.cable import Cable, Material
from designer.model.robot import Platform, Poses, Robot

# Exit points and attachments of CoGiRo [m], as published with the sample `cogiro` of
# github.com/cable-robots/cdpyr; each cable with the attachment that it holds.
_COGIRO_EXITS = [
    [-7.11966, 5.47261, 5.41063],
    [7.50556, 5.07892, 5.41820],
    [7.14351, -5.54158, 5.39749],
    [-7.47855, -5.15440, 5.40093],
    [-7.40830, 5.19141, 5.39874],
    [7.22425, 5.36889, 5.40799],
    [7.42883, -5.26133, 5.38777],
    [-7.19673, -5.43978, 5.39277],
]
_COGIRO_ATTACHMENTS = [
    [0.49605, 0.35613, 0.99961],
    [0.49983, -0.34038, 0.99913],
    [-0.50453, -0.34632, 0.99765],
    [-0.50968, 0.35080, 0.99759],
    [-0.50316, -0.26997, 0.0],
    [-0.50316, 0.49282, 0.0],
    [0.50214, 0.27502, -0.00067],
    [0.50316, -0.49282, 0.0],
]
COGIRO = Robot(
    frozen_array(_COGIRO_EXITS),
    Platform(91.058, frozen_array(_COGIRO_ATTACHMENTS), frozen_array([-0.034, -0.013, 0.264])),
)
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
