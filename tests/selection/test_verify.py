"""The pass over all sizes against one size at a time."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from ropes import rope

from designer.arrays import frozen_array
from designer.model.cable import Cable, Cables
from designer.model.region import PointList, Prism
from designer.model.robot import Poses
from designer.model.workspace import Workspace
from designer.selection.verify import refined_each, verify, verify_sizes
from designer.statics import sizes
from designer.statics.inverse import solve_sagging
from designer.workspace.demand import is_left_out

TRIANGLE = [[0, 0, 0], [500, 0, 0], [250, 433.01, 0]]
LOW = Prism.over(TRIANGLE, 40.0, (-200.0, -60.0))
HIGH = Prism.over(TRIANGLE, 10.0, (-60.0, -20.0))


def cables() -> list[Cable]:
    """From threads to hawsers, stiff and soft, in no order."""
    grades = [
        rope("steel", [2.0, 60.0, 6.0, 12.0, 24.0, 36.0]),
        rope("soft", [10.0, 80.0, 30.0], weight=0.2, stiffness=0.05),
        rope("light", [8.0, 20.0], weight=0.12, strength=1.5, stiffness=0.8),
    ]
    return [g.cable(s, 2.0) for g in grades for s in g.sizes]


def cases(fast_robot, six_cable_robot):
    tilted = replace(fast_robot, tilt_rad=frozen_array([0.03, -0.02]))
    pulleys = replace(fast_robot, pulley_radius_m=0.4)
    middle = Prism.box((-30.0, 30.0), (-30.0, 30.0), (-90.0, -50.0))
    return {
        "three": (fast_robot, Workspace(LOW, samples=600)),
        "three, high": (fast_robot, Workspace(HIGH, samples=600)),
        "exclude": (fast_robot, Workspace(HIGH, samples=600, hangs_below="exclude")),
        "six": (six_cable_robot, Workspace(middle, samples=300)),
        "tilt": (tilted, Workspace(LOW, samples=300)),
        "pulleys": (pulleys, Workspace(LOW, samples=60)),
    }


NAMES = ["three", "three, high", "exclude", "six", "tilt", "pulleys"]


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=pytest.mark.slow) if name == "six" else name for name in NAMES],
)
def test_agrees_with_one_size_at_a_time(name: str, fast_robot, six_cable_robot) -> None:
    robot, workspace = cases(fast_robot, six_cable_robot)[name]
    tried = cables()
    found = verify_sizes(robot, workspace, tried, gives_up=False)
    positions = np.concatenate(list(workspace.positions_m()))
    for cable, one in zip(tried, found, strict=True):
        statics = solve_sagging(robot, Poses.at(positions), cable)
        left_out = is_left_out(statics, workspace.hangs_below)
        counts = statics.is_solved & ~left_out
        used = statics.largest_tension_N[counts] / cable.allowable_tension_N
        assert one.samples == len(positions)
        assert one.counted == counts.sum()
        assert one.overloaded == (used > 1.0).sum()
        everywhere = np.concatenate([positions, workspace.space.landmarks()])
        statics = solve_sagging(robot, Poses.at(everywhere), cable)
        counts = statics.is_solved & ~is_left_out(statics, workspace.hangs_below)
        used = statics.largest_tension_N[counts] / cable.allowable_tension_N
        assert one.not_held == (~statics.is_solved).sum()
        longest = statics.length_m[counts].max(axis=0, initial=0.0)
        assert one.longest_m == pytest.approx(longest, rel=1e-9)
        if one.not_held:
            assert np.isinf(one.utilisation)
        else:
            assert one.utilisation == pytest.approx(used.max(), rel=1e-9)
            assert one.worst_places[0] == pytest.approx(everywhere[counts][np.argmax(used)])


def test_the_two_cases_that_exclude_differ(fast_robot, six_cable_robot) -> None:
    """Poses are left out in the case that is to show it."""
    robot, workspace = cases(fast_robot, six_cable_robot)["exclude"]
    found = verify_sizes(robot, workspace, cables())
    assert any(0 < one.counted < one.samples for one in found)


def test_order_of_the_cables_does_not_matter(fast_robot) -> None:
    workspace, tried = Workspace(LOW, samples=500), cables()
    found = verify_sizes(fast_robot, workspace, tried)
    back = verify_sizes(fast_robot, workspace, tried[::-1])[::-1]
    for one, other in zip(found, back, strict=True):
        assert one.utilisation == pytest.approx(other.utilisation, rel=1e-12)
        assert one.worst_places == pytest.approx(other.worst_places)


def test_chunks_add_up(fast_robot) -> None:
    """More samples than one chunk has give the largest of all, and all counts."""
    workspace, tried = Workspace(LOW, samples=20_000), cables()[2:5]
    positions = np.concatenate(list(workspace.positions_m()))
    found = verify_sizes(fast_robot, workspace, tried, gives_up=False)
    for cable, one in zip(tried, found, strict=True):
        tension = solve_sagging(fast_robot, Poses.at(positions), cable).largest_tension_N
        corners = solve_sagging(fast_robot, Poses.at(workspace.space.landmarks()), cable)
        largest = max(tension.max(), corners.largest_tension_N.max())
        assert one.counted == one.samples == 20_000
        assert one.overloaded == (tension > cable.allowable_tension_N).sum()
        assert one.utilisation == pytest.approx(largest / cable.allowable_tension_N)


def test_a_size_that_is_too_thin_at_a_corner_needs_no_sample(fast_robot) -> None:
    workspace, tried = Workspace(LOW, samples=5000), cables()
    whole = verify_sizes(fast_robot, workspace, tried, gives_up=False)
    corners = Poses.at(workspace.space.landmarks())
    for cable, one, every in zip(
        tried, verify_sizes(fast_robot, workspace, tried), whole, strict=True
    ):
        tension_N = solve_sagging(fast_robot, corners, cable).largest_tension_N.max()
        assert one.is_complete == (one.utilisation <= 1.0) == (every.utilisation <= 1.0)
        assert (one.samples == 0) == bool(tension_N > cable.allowable_tension_N)
        assert every.samples == 5000
        is_same = one.utilisation == pytest.approx(every.utilisation, rel=1e-12)
        assert is_same or 1.0 < one.utilisation < every.utilisation


def test_pose_outside_the_hull_ends_every_cable(fast_robot) -> None:
    points = PointList(frozen_array([[250, 200, -50], [250, -60, -50], [250, 100, -50]]))
    for one in verify_sizes(fast_robot, Workspace(points), cables()):
        assert one.not_held == 1
        assert np.isinf(one.utilisation)
        assert one.worst_places[0] == pytest.approx([250, -60, -50])
        assert one.served <= 2 / 3


@pytest.mark.slow
def test_worst_poses_are_from_all_over_and_the_search_ends_where_it_did(fast_robot) -> None:
    workspace = Workspace(LOW, samples=2000)
    for cable in cables()[3:6]:
        (one,) = verify_sizes(fast_robot, workspace, [cable])
        assert len(np.unique(one.worst_places, axis=0)) == len(one.worst_places)
        assert len(one.worst_places) > 100 or one.utilisation > 1.0
        searched, alone = (
            refined_each(fast_robot, workspace, [cable], [one])[0],
            verify(fast_robot, workspace, cable),
        )
        assert searched.is_refined
        assert searched.utilisation >= one.utilisation
        assert searched.max_tension_N == pytest.approx(alone.max_tension_N, rel=1e-9)
        assert searched.longest_m == pytest.approx(alone.longest_m, rel=1e-9)


def test_nothing_counts_where_every_pose_is_left_out(fast_robot) -> None:
    edge = Prism.over([[200, 8], [300, 8], [250, 12]], 0.0, (-60.0, -50.0))
    workspace = Workspace(edge, samples=50, hangs_below="exclude")
    (one,) = verify_sizes(
        fast_robot, workspace, [rope("a", [40.0]).cable(rope("a", [40.0]).sizes[0], 2.0)]
    )
    assert one.counted == 0
    assert np.isinf(one.utilisation)
    assert one.served == 0.0


def test_no_cable_at_all(fast_robot) -> None:
    assert verify_sizes(fast_robot, Workspace(LOW, samples=50), []) == []


def test_slow_robot_gives_up_on_what_is_settled(fast_robot) -> None:
    """Over pulleys each size is solved alone; one that is too thin need not see every sample."""
    robot, workspace = replace(fast_robot, pulley_radius_m=0.4), Workspace(LOW, samples=1500)
    thin, thick = cables()[0], cables()[1]
    first, second = verify_sizes(robot, workspace, [thin, thick])
    assert not first.is_complete
    assert first.samples < 1500
    assert first.utilisation > 1.0
    assert second.is_complete
    assert second.samples == second.counted == 1500
    whole, _ = verify_sizes(robot, workspace, [thin, thick], gives_up=False)
    assert whole.is_complete
    assert whole.utilisation >= first.utilisation > 1.0


def test_of_a_slow_robot_one_pose_refutes_the_others(
    fast_robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    pulleys = replace(fast_robot, pulley_radius_m=0.4)
    workspace, tried = Workspace(LOW, samples=60), cables()
    each = verify_sizes(pulleys, workspace, tried, gives_up=False)
    asked: dict[type, list[int]] = {Cable: [], Cables: []}

    def counted(robot, poses, cable, **options):
        asked[type(cable)].append(len(poses.position_m))
        return solve_sagging(robot, poses, cable, **options)

    monkeypatch.setattr(sizes, "solve_sagging", counted)
    found = verify_sizes(pulleys, workspace, tried)
    for one, whole in zip(found, each, strict=True):
        assert (one.utilisation <= 1.0) == (whole.utilisation <= 1.0)
        assert one.utilisation <= whole.utilisation * (1.0 + 1e-12)
        assert one.is_complete or not one.utilisation <= 1.0
    fails = sum(one.utilisation > 1.0 for one in each)
    assert 0 < fails < len(tried)
    # All that fail are asked for one pose in a batch, but for the first, and for those that it does
    # not refute.
    assert len(asked[Cable]) <= 2 * (len(tried) - fails) + 3
    assert max(asked[Cables]) >= fails - 3
