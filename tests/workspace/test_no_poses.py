"""A batch of no poses, as where a load case leaves none, has an answer of no poses."""

from __future__ import annotations

import numpy as np
import pytest

from designer.io.config import read_study
from designer.model.robot import Poses
from designer.resources import example_file, example_names
from designer.sizing.newton import size_poses
from designer.statics.inverse import solve_massless, solve_sagging
from designer.workspace.demand import diameter_demand, massless_demand, rope_demand


@pytest.mark.parametrize("name", example_names())
def test_no_poses_are_answered_by_none(name: str) -> None:
    study = read_study(example_file(name))
    robot, cable, none = study.robot, study.material.cable(5e-3), Poses.at(np.empty((0, 3)))
    assert solve_massless(robot, none).tension_N.shape == (0, robot.n_cables)
    assert solve_sagging(robot, none, cable).length_m.shape == (0, robot.n_cables)
    assert size_poses(robot, none, study.material).diameter_m.shape == (0,)
    assert study.workspace is not None
    places = np.empty((0, study.workspace.space.n_coordinates))
    assert diameter_demand(robot, study.material, "include", places).shape == (0,)
    for hangs_below in ("include", "exclude"):
        assert massless_demand(robot, study.material, hangs_below, places).shape == (0,)
    assert rope_demand(robot, cable, "exclude", places).shape == (0, 1 + 2 * robot.n_cables)
