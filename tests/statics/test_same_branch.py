"""A search of other branches that ends in the same one changes nothing, not even the last bit.

What looks between samples tells by that whether it can do without such a search, which takes a
hundred times as long.
"""

from __future__ import annotations

import numpy as np

from designer.arrays import frozen_array
from designer.model.cable import Cable
from designer.model.robot import Platform, Poses, Robot
from designer.statics.inverse import solve_sagging

ANGLES = np.repeat([0.0, 2.0943951, 4.1887902], 2)
CORNERS = np.radians([60.0, -60.0, 180.0, 60.0, 300.0, 180.0])
ROBOT = Robot(
    frozen_array(np.column_stack([2.06 * np.cos(ANGLES), 2.06 * np.sin(ANGLES), np.full(6, 3.82)])),
    Platform(
        102.4,
        frozen_array(np.column_stack([0.3 * np.cos(CORNERS), 0.3 * np.sin(CORNERS), np.zeros(6)])),
    ),
)


def test_the_same_branch_found_again_is_the_same_to_the_last_bit() -> None:
    low, high = [-0.57, -0.45, 0.76], [0.57, 0.4, 1.55]
    poses = Poses.at(np.random.default_rng(0).uniform(low, high, (400, 3)))
    searched = 0
    for weight in (0.5, 1.5, 5.0, 12.0):
        cable = Cable(np.nan, weight / 9.81, 1e6, 1e5)
        plain = solve_sagging(ROBOT, poses, cable, seeks_better=False)
        found = solve_sagging(ROBOT, poses, cable, seeks_better=True)
        change = np.abs(found.largest_tension_N / plain.largest_tension_N - 1.0)
        same = plain.is_solved & (change < 1e-7)
        searched += int(same.sum())
        for name in ("length_m", "force_x_N", "force_z_N"):
            assert np.array_equal(getattr(plain, name)[same], getattr(found, name)[same])
    assert searched > 1000
