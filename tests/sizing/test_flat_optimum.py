"""Poses whose optimum is all but flat, where the interior point hardly gains on it."""

from __future__ import annotations

import numpy as np

from designer.io.config import read_study
from designer.model.robot import Poses
from designer.resources import example_file
from designer.sizing.newton import size_poses

# Found by a dense search: one cable hangs 2.07 times as long as its chord, another all but rests.
POSE = [-3.68707202, -2.28897127, 0.85829191, -0.0196724, 0.00727543, -0.07995529]


def test_a_pose_is_not_lost_where_two_ways_to_hang_all_but_meet() -> None:
    study = read_study(example_file("cogiro"))
    shift = np.random.default_rng(0).normal(size=(50, 6))
    shift[0] = 0.0
    poses = np.concatenate([POSE + shift * size for size in (1e-8, 1e-6, 1e-4)])
    sizing = size_poses(study.robot, Poses.at(poses), study.material, seeks_better=False)
    assert sizing.statics.is_solved.all()
    assert np.allclose(sizing.diameter_m, 2.62153e-3, rtol=2e-4)
