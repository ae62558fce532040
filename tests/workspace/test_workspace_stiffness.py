"""The softest and the stiffest pose of a workspace."""

from __future__ import annotations

import numpy as np
import pytest

from designer.arrays import frozen_array
from designer.model.region import PointList, Prism
from designer.model.robot import Poses, Robot
from designer.model.workspace import Workspace
from designer.statics.inverse import solve_sagging
from designer.statics.stiffness import largest_displacement_m_per_N
from designer.workspace.stiffness import survey_stiffness


@pytest.mark.slow
def test_softest_and_stiffest_of_the_samples(fast_robot: Robot, steel) -> None:
    region = Prism.over(fast_robot.exit_points_m, 20.0, (-150.0, -50.0))
    found = survey_stiffness(fast_robot, Workspace(region, samples=400), steel.cable(0.04))
    assert found is not None
    assert found.samples == 400
    assert found.unstable == 0
    assert found.stiffest_m_per_N < found.softest_m_per_N
    for position, value in (
        (found.softest_place, found.softest_m_per_N),
        (found.stiffest_place, found.stiffest_m_per_N),
    ):
        assert region.contains(position)
        statics = solve_sagging(fast_robot, Poses.at(position), steel.cable(0.04))
        assert float(largest_displacement_m_per_N(statics)) == pytest.approx(value, rel=1e-6)


def test_poses_left_out_do_not_count(fast_robot: Robot, steel) -> None:
    """A cable hangs below the platform in the second pose, which is the softer one."""
    points = PointList(frozen_array([[250.0, 144, -100], [250.0, 20, -40]]))
    both, one = (
        survey_stiffness(fast_robot, Workspace(points, hangs_below=policy), steel.cable(0.05))
        for policy in ("include", "exclude")
    )
    assert both is not None and one is not None
    assert (both.samples, one.samples) == (2, 1)
    assert both.softest_m_per_N > one.softest_m_per_N == both.stiffest_m_per_N


def test_none_where_no_pose_is_held(fast_robot: Robot, steel) -> None:
    outside = PointList(frozen_array([[-50.0, 0, -50]]))
    assert survey_stiffness(fast_robot, Workspace(outside), steel.cable(0.05)) is None


def test_a_thicker_cable_is_stiffer(fast_robot: Robot, steel) -> None:
    points = PointList(frozen_array(np.array([[250.0, 144, -100], [200.0, 100, -60]])))
    thin, thick = (
        survey_stiffness(fast_robot, Workspace(points), steel.cable(d)) for d in (0.02, 0.022)
    )
    assert thin is not None and thick is not None
    assert thin.stiffest_m_per_N != thick.stiffest_m_per_N
