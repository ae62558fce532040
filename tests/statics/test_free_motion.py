"""A motion that no cable resists: against the lengths of cables, and robots that have none."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from designer.api import read_study
from designer.model.cable import Material
from designer.model.robot import Platform, Poses, Robot
from designer.model.verdict import Verdict
from designer.resources import example_file
from designer.sizing.newton import limit_ratio, size_poses
from designer.statics.free_motion import free_motion

CORNERS = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
FRAME = np.array([[2 * x, 2 * y, 2 * z] for z in (1.0, -1.0) for x, y in CORNERS])
BODY = np.array([[0.15 * x, 0.15 * y, 0.1 * z] for z in (-1.0, 1.0) for x, y in CORNERS])
STEEL = Material(7800.0, 200e9, 180e6)


def somewhere(count: int = 20) -> Poses:
    return Poses.at(np.random.default_rng(3).uniform(-1.0, 1.0, (count, 3)))


def test_platform_like_its_frame_turns_about_the_vertical() -> None:
    robot, poses = Robot(FRAME, Platform(6.0, BODY)), somewhere()
    motion = free_motion(robot, poses)
    assert motion is not None
    assert (motion.kind, motion.of_any_cable) == ("turn", True)
    assert motion.axis == pytest.approx([0.0, 0.0, 1.0], abs=1e-9)
    # A small turn about some vertical axis leaves all lengths as they are, to first order.
    small = 1e-5
    for position in poses.position_m:

        def lengths(twist: np.ndarray) -> np.ndarray:
            turned = BODY @ Rotation.from_rotvec(small * twist[3:]).as_matrix().T
            return np.linalg.norm(FRAME - position - small * twist[:3] - turned, axis=1)  # noqa: B023

        slope = [(lengths(e) - lengths(-e)) / (2 * small) for e in np.eye(6)]
        moves, *_ = np.linalg.lstsq(np.array(slope[:5]).T, -slope[5], rcond=None)
        assert np.array(slope[:5]).T @ moves + slope[5] == pytest.approx(0.0, abs=1e-8)
    assert set(size_poses(robot, poses, STEEL).statics.verdict) == {Verdict.RANK_DEFICIENT}


def test_axis_follows_the_frame_and_straight_cables_alone_are_meant() -> None:
    lying = Rotation.from_euler("x", 90, degrees=True).as_matrix()
    poses = somewhere()
    robot = Robot(FRAME @ lying.T, Platform(6.0, BODY @ lying.T))
    motion = free_motion(robot, Poses.at(poses.position_m @ lying.T))
    assert motion is not None
    assert (motion.kind, motion.of_any_cable) == ("turn", False)
    assert motion.axis == pytest.approx([0.0, 1.0, 0.0], abs=1e-9)
    assert "no straight cable" in motion.clause
    tilted = replace(robot, gravity_direction=lying @ [0.0, 0.0, -1.0])
    again = free_motion(tilted, Poses.at(poses.position_m @ lying.T))
    assert again is not None
    assert again.of_any_cable
    assert again.axis == pytest.approx([0.0, 1.0, 0.0], abs=1e-9)


def test_point_in_the_plane_of_its_exit_points_moves_across() -> None:
    exits = np.array([[0.0, 0, 9], [9, 0, 9], [0, 0, 0], [9, 0, 0]])
    inside = Poses.at(np.array([[3.0, 0, 4], [5, 0, 6], [4, 0, 2]]))
    motion = free_motion(Robot(exits, Platform(5.0)), inside)
    assert motion is not None
    assert (motion.kind, motion.of_any_cable) == ("move", True)
    assert motion.axis == pytest.approx([0.0, 1.0, 0.0], abs=1e-9)
    assert free_motion(Robot(exits, Platform(5.0), is_planar=True), inside) is None


@pytest.mark.parametrize("order", [[3, 0, 1, 2, 5, 6, 7, 4], [1, 0, 3, 2, 4, 5, 6, 7]])
def test_crossed_cables_leave_no_motion(order: list[int]) -> None:
    assert free_motion(Robot(FRAME, Platform(6.0, BODY[order])), somewhere()) is None
    assert free_motion(Robot(FRAME, Platform(6.0, BODY * [1, 0.4, 1])), somewhere()) is None


@pytest.mark.parametrize("name", ["fast", "cogiro", "facade", "falcon", "robocrane", "yard"])
def test_shipped_robots_have_no_free_motion(name: str) -> None:
    study = read_study(str(example_file(name)), with_plugins=False)
    assert study.workspace is not None
    assert free_motion(study.robot, Poses.at(study.workspace.thinned(32))) is None


@pytest.mark.parametrize("exits", [
    [[0.0, 0, 0], [100, 0, 0]], [[0.0, 0, 0], [500, 0, 0], [250, 433.01, 0]],
])  # fmt: skip
def test_deep_point_is_held_or_proved_not_to_be(exits: list[list[float]]) -> None:
    """On as many cables as degrees of freedom the limit ratio of a taut cable decides."""
    is_planar = len(exits) == 2
    robot = Robot(np.array(exits), Platform(100.0), is_planar=is_planar)
    span_m, middle = np.ptp(exits, axis=0)[0], np.mean(exits, axis=0)
    for depth in (0.33, 0.5, 1.0, 2.0):
        pose = Poses.at(middle - [0.0, 0.0, depth * span_m])
        ratio = float(limit_ratio(robot, pose, STEEL))
        for target, held in ((0.99, True), (1.001, False), (1.1, False), (1.7, False)):
            stress_Pa = STEEL.allowable_stress_Pa * ratio / target
            material = replace(STEEL, allowable_stress_Pa=stress_Pa)
            verdict = size_poses(robot, pose, material).statics.verdict
            assert verdict == (Verdict.SOLVED if held else Verdict.NO_FINITE_CABLE)


def test_pose_in_an_exit_point_has_a_cable_of_no_length() -> None:
    exits = np.array([[0.0, 0, 10], [20, 0, 10], [10, 17, 10]])
    for robot in (Robot(exits, Platform(100.0)), Robot(FRAME, Platform(6.0, BODY))):
        at = robot.exit_points_m[0]
        if not robot.is_point_mass:
            at = at - robot.platform.attachments_m[0]
        statics = size_poses(robot, Poses.at(at), STEEL).statics
        assert statics.verdict == Verdict.NO_LENGTH
        assert "no length" in statics.sentence
