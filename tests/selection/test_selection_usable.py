"""How much of the workspace a size serves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from ropes import rope

from designer.arrays import frozen_array
from designer.io.config import read_study
from designer.model.region import PointList, Prism
from designer.model.robot import Poses
from designer.model.space import Orientations
from designer.model.workspace import Workspace
from designer.resources import example_file
from designer.selection.result import usable
from designer.selection.select import select
from designer.sizing.newton import size_poses
from designer.statics.inverse import solve_sagging
from designer.study import Selection

TRIANGLE = [[0, 0, 0], [500, 0, 0], [250, 433.01, 0]]
SIZES = [8.0, 14.0, 16.0, 18.0, 20.0, 24.0, 32.0]


@pytest.mark.slow
def test_share_is_that_of_the_poses_that_need_no_more(fast_robot) -> None:
    """In a grade after the law a size serves the poses whose needed diameter is not above it."""
    workspace = Workspace(Prism.over(TRIANGLE, 30.0, (-200.0, -50.0)), samples=3000)
    grade = rope("a", SIZES)
    found = select(fast_robot, workspace, Selection(None, 2.0), [grade]).usable
    assert found is not None
    positions = np.concatenate(list(workspace.positions_m()))
    needed = size_poses(fast_robot, Poses.at(positions), grade.family(2.0)).diameter_m
    for one in found.sizes:
        share = np.mean(needed <= one.size.diameter_m)
        assert one.fraction == pytest.approx(share, abs=1e-12)
        assert one.volume_m3 == pytest.approx(share * workspace.region.volume_m3)
    shares = [one.fraction for one in found.sizes]
    assert shares == sorted(shares)
    assert shares[0] < 0.5
    assert shares[-1] == 1.0


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize("pulley_radius_m", [0.0, 0.4])
def test_where_nothing_holds_it_is_shown_for_what_serves_most(fast_robot, pulley_radius_m) -> None:
    fast_robot = replace(fast_robot, pulley_radius_m=pulley_radius_m)
    workspace = Workspace(Prism.over(TRIANGLE, 30.0, (-200.0, -50.0)), samples=500)
    grades = [rope("thin", [4.0, 6.0]), rope("nearly", [12.0, 14.0])]
    found = select(fast_robot, workspace, Selection(None, 2.0), grades)
    assert found.chosen is None
    assert found.usable is not None
    assert found.usable.grade.id == "nearly"
    assert 0.0 < found.usable.sizes[-1].fraction < 1.0


def test_of_a_slow_robot_a_part_of_the_samples_is_asked_and_counted(fast_robot) -> None:
    pulleys = replace(fast_robot, pulley_radius_m=0.4)
    workspace = Workspace(Prism.over(TRIANGLE, 30.0, (-200.0, -50.0)), samples=4000)
    grade = rope("a", [10.0, 12.0])
    cables = [(size, grade.cable(size, 2.0)) for size in grade.sizes]
    every, some = (usable(robot, workspace, grade, cables) for robot in (fast_robot, pulleys))
    assert (every.samples, some.samples) == (4000, 1000)
    for whole, part in zip(every.sizes, some.sizes, strict=True):
        assert 0.1 < whole.fraction < 0.9
        assert part.fraction == pytest.approx(whole.fraction, abs=0.06)  # 4 deviations


def test_points_have_no_volume(fast_robot) -> None:
    points = PointList(frozen_array([[250, 144, -190], [250, 40, -45], [250, -60, -50]]))
    found = select(fast_robot, Workspace(points), Selection(None, 2.0), [rope("a", [14.0, 40.0])])
    assert found.usable is not None
    assert [one.fraction for one in found.usable.sizes] == pytest.approx([1 / 3, 2 / 3])
    assert {one.volume_m3 for one in found.usable.sizes} == {None}


def test_a_weak_thicker_size_does_not_serve_what_a_thinner_one_does(fast_robot) -> None:
    """Each size counts on its own samples, and what it loses against thinner ones is told."""
    workspace = Workspace(Prism.over(TRIANGLE, 30.0, (-200.0, -50.0)), samples=1000)
    grade = rope("a", [14.0, 18.0, 20.0, 32.0], weaker={20.0: 0.6})
    found = select(fast_robot, workspace, Selection(None, 2.0), [grade]).usable
    assert found is not None and not found.is_nested
    positions = np.concatenate(list(workspace.positions_m()))
    holds = []
    for size in grade.sizes:
        statics = solve_sagging(fast_robot, Poses.at(positions), grade.cable(size, 2.0))
        allowable = size.minimum_breaking_load_N / 2.0
        holds.append(statics.is_solved & (np.nan_to_num(statics.largest_tension_N) <= allowable))
    assert [one.fraction for one in found.sizes] == pytest.approx([h.mean() for h in holds])
    assert found.sizes[2].fraction < found.sizes[1].fraction
    lost = ((holds[0] | holds[1]) & ~holds[2]).mean()
    assert 0.0 < lost == pytest.approx(found.sizes[2].lost_fraction)
    assert [one.lost_fraction for one in found.sizes[:2]] == [0.0, 0.0]
    assert found.first_for_good == 3


def test_a_position_is_served_only_in_all_its_orientations() -> None:
    study = read_study(example_file("robocrane"))
    turns = frozen_array(np.radians([[0.0, 0.0, 0.0], [12.0, 0.0, 0.0]]))
    few = replace(study.workspace, samples=200, orientations=Orientations(turns))
    grade = rope("a", [1.0, 2.0, 3.0, 4.0])
    cables = [(size, grade.cable(size, 5.0)) for size in grade.sizes]
    both = usable(study.robot, few, grade, cables)
    each = [
        usable(
            study.robot, replace(few, orientations=Orientations(turns[k : k + 1])), grade, cables
        )
        for k in range(2)
    ]
    for k, one in enumerate(both.sizes):
        assert one.fraction <= min(found.sizes[k].fraction for found in each)
    assert any(0.0 < one.fraction < 1.0 for one in both.sizes)
