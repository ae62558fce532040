"""Which cables count as hanging below the platform."""

from __future__ import annotations

import numpy as np

from designer.model.cable import Cable
from designer.model.robot import Platform, Poses, Robot
from designer.statics.inverse import solve_sagging

SLACK = Cable(0.02, 2.0, 1e8, 1e9)
"""Heavy enough for the far cable to sag below a light load."""


def test_a_slack_cable_from_above_hangs_below() -> None:
    robot = Robot(
        np.array([[0.0, 0.0, 20.0], [60.0, 0.0, 20.0], [30.0, 50.0, 20.0]]), Platform(100.0)
    )
    poses = Poses.at([[30.0, 15.0, 0.0], [30.0, 3.0, 15.0]])
    statics = solve_sagging(robot, poses, SLACK)
    assert statics.is_solved.all()
    assert (statics.force_z_N > 0.0).any(axis=1).tolist() == [False, True]
    assert statics.hangs_below.tolist() == [False, True]


def test_a_cable_that_comes_from_below_does_not_count() -> None:
    robot = Robot(
        np.array([[-10.0, 0.0, 20.0], [10.0, 0.0, 20.0], [0.0, 12.0, 20.0], [0.0, 0.0, -5.0]]),
        Platform(100.0),
        tension_min_N=200.0,
    )
    statics = solve_sagging(robot, Poses.at([[0.0, 4.0, 2.0]]), Cable(0.005, 0.05, 1e6, 1e5))
    assert statics.is_solved.all()
    assert (statics.force_z_N[0] > 0.0).tolist() == [False, False, False, True]
    assert not statics.hangs_below.any()
