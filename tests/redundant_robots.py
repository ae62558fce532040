"""Robots with more cables than degrees of freedom, and poses for them.

CoGiRo: exit and attachment points as in the sample `cogiro` of cable-robots/cdpyr, attachments in
the order of its kinematic chains, 91.058 kg.
"""

from __future__ import annotations

import numpy as np

from designer.arrays import frozen_array
from designer.cable import Material
from designer.robot import Platform, Poses, Robot

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

FOUR = Robot(frozen_array([[0, 0, 0], [100, 0, 0], [100, 80, 0], [0, 80, 0]]), Platform(1000.0))
"""A point mass under four masts."""

SEVEN = Robot(
    frozen_array(
        [[-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1], [0, -1, -1], [1, 0.6, -1], [-1, 0.6, -1]]
    ),
    Platform(
        2.0,
        frozen_array(
            [
                [-0.10, -0.12, -0.06], [0.05, 0.12, -0.11], [-0.04, -0.20, -0.15],
                [-0.26, 0.18, -0.03], [-0.19, -0.12, -0.06], [-0.05, -0.01, 0.09],
                [0.01, -0.15, 0.09],
            ]
        ),
    ),
    tension_min_N=10.0,
)  # fmt: skip
"""Seven cables, four from above and three from below, which only a least tension keeps taut."""


def steel(weights: float = 1.0) -> Material:
    """Return a steel whose cables weigh so many times as much."""
    return Material(7800.0 * weights, 100e9, 180e6)


def cogiro_poses(count: int, seed: int = 0) -> Poses:
    """Return random poses with small rotations, all of which straight cables can hold."""
    rng = np.random.default_rng(seed)
    low, high = [-4.0, -3.0, 0.3], [4.0, 3.0, 3.0]
    return Poses.at(rng.uniform(low, high, (count, 3)), rng.normal(0.0, 0.1, (count, 3)))


def anywhere(count: int, seed: int = 0) -> Poses:
    """Return random poses of CoGiRo, many of them beyond what its cables can hold."""
    rng = np.random.default_rng(seed)
    low, high = [-9.0, -7.0, 0.0], [9.0, 7.0, 6.5]
    return Poses.at(rng.uniform(low, high, (count, 3)), rng.normal(0.0, 0.3, (count, 3)))


def four_poses(count: int, seed: int = 0) -> Poses:
    """Return random points under the four masts."""
    rng = np.random.default_rng(seed)
    return Poses.at(rng.uniform([2.0, 2.0, -40.0], [98.0, 78.0, -5.0], (count, 3)))


def seven_poses(count: int, seed: int = 0) -> Poses:
    """Return random poses near the middle of the seven cables."""
    rng = np.random.default_rng(seed)
    return Poses.at(rng.uniform(-0.2, 0.2, (count, 3)), rng.normal(0.0, 0.05, (count, 3)))


def one(poses: Poses, k: int) -> Poses:
    """Return one pose of a batch, without leading axes."""
    return Poses(poses.position_m[k], poses.rotation[k] if poses.rotation.ndim > 2 else np.eye(3))
