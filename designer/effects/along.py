"""Forces along a cable, from the tension at its exit: for effects that act where it is pulled."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from designer.arrays import FloatArray
from designer.model.machine import Machine
from designer.model.measured_data import Measured
from designer.statics.geometry import cable_geometry


@dataclass(frozen=True, slots=True, eq=False)
class Pull:
    """Of each cable in each row (n_rows, n_cables).

    Parameters
    ----------
    horizontal_N : array
        Its horizontal force on the exit point [N].
    mean_N : array
        Its tension half way down [N].
    """

    horizontal_N: FloatArray
    mean_N: FloatArray


def pull_of(machine: Machine, measured: Measured, tension_N: FloatArray) -> Pull:
    """Return the pull of parabolas between the exit points and the measured poses.

    With H the horizontal force, w the weight per length, chord c over X and drop D: the upward
    force at the exit is H D / X + w c / 2, which with H makes the tension there.
    """
    geometry = cable_geometry(machine.robot, measured.poses)
    across = np.maximum(geometry.horizontal_distance_m, 1e-9)
    slope = geometry.drop_m / across
    half = 0.5 * machine.cable.weight_N_per_m * geometry.chord_m
    square, mixed = 1.0 + slope**2, slope * half
    inside = np.maximum(mixed**2 - square * (half**2 - tension_N**2), 0.0)
    level = np.maximum((np.sqrt(inside) - mixed) / square, 0.0)
    drop = 0.5 * machine.cable.weight_N_per_m * slope * across
    return Pull(level, np.maximum(tension_N - drop, 0.0))
