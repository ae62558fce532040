"""Robots with more cables than degrees of freedom, and poses for them."""

from __future__ import annotations

import numpy as np

from designer.arrays import frozen_array
from designer.model.cable import Material
from designer.model.robot import Platform, Poses, Robot

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
    return poses.part(k)
