"""Poses in a left-handed frame: one axis counted the other way, or two of them exchanged."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from designer.arrays import FloatArray
from designer.model.measured_data import Measured
from designer.model.robot import Poses, Robot


def left_handed(robot: Robot, measured: Measured) -> Iterator[tuple[str, Measured]]:
    """Yield each left-handed frame in words, with the rows as they are if it was the camera's.

    An axis may have been counted from the robot's zero, or from the middle of its exit points.
    """
    for text, mirror in _mirrors():
        for zero in (np.zeros(3), robot.exit_points_m.mean(axis=0)):
            poses = measured.poses
            position = zero + (poses.position_m - zero) @ mirror
            # Each axis of the body is mirrored as well, which leaves a rotation.
            rotation = mirror @ poses.rotation @ mirror
            yield text, replace(measured, poses=Poses(position, rotation))


def _mirrors() -> Iterator[tuple[str, FloatArray]]:
    for axis, name in enumerate("xyz"):
        yield f"{name} counted the other way", np.diag(np.where(np.arange(3) == axis, -1.0, 1.0))
    for order in ([1, 0, 2], [2, 1, 0], [0, 2, 1]):
        first, second = (name for name, k in zip("xyz", range(3), strict=True) if order[k] != k)
        yield f"{first} and {second} exchanged", np.eye(3)[order]
