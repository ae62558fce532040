"""Over large pulleys: each solved cable leaves its pulley as a tangent, by plain geometry."""

from __future__ import annotations

import numpy as np
import pytest

from designer.arrays import FloatArray, frozen_array
from designer.model.cable import Material
from designer.model.robot import Platform, Poses, Robot
from designer.model.verdict import Verdict
from designer.sizing.newton import size_poses
from designer.statics.inverse import Statics, solve_sagging

pytestmark = pytest.mark.slow

ROPE = Material(5290.0, 62.7e9, 198e6)


def robot_and_poses(seed: int, n_cables: int, count: int) -> tuple[Robot, Poses]:
    """Cables from above: over large pulleys six may be slack, eight sag as far as they may."""
    rng = np.random.default_rng(seed)
    angle = np.sort(rng.uniform(0.0, 2.0 * np.pi, n_cables))
    height = rng.uniform(-4.0, 4.0, n_cables)
    exits = np.column_stack([20.0 * np.cos(angle), 20.0 * np.sin(angle), height])
    platform = Platform(300.0, frozen_array(rng.uniform(-2.0, 2.0, (n_cables, 3))))
    places = np.hstack(
        [
            rng.uniform(-14.0, 14.0, (count, 2)),
            rng.uniform(-20.0, -4.0, (count, 1)),
            rng.uniform(-0.2, 0.2, (count, 3)),
        ]
    )
    return Robot(frozen_array(exits), platform, pulley_radius_m=4.0), Poses.at(places)


def off_tangent(statics: Statics) -> FloatArray:
    """Return how far cables leave their pulleys from where a tangent would, over the radius."""
    robot, points = statics.robot, statics.run.exit_points_m
    radius = robot.pulley_radius_m
    toward = (statics.poses.attachment_points_m(robot) - robot.exit_points_m)[..., :2]
    out = toward / np.linalg.norm(toward, axis=-1, keepdims=True)
    centre = robot.exit_points_m + np.pad(radius * out, ((0, 0), (0, 0), (0, 1)))
    spoke = (points - centre) / radius
    downward = statics.force_z_N - statics.weight_N_per_m * statics.free_length_m
    along = np.concatenate([statics.force_x_N[..., None] * out, downward[..., None]], axis=-1)
    along /= np.linalg.norm(along, axis=-1, keepdims=True)
    on_rim = np.abs(np.linalg.norm(spoke, axis=-1) - 1.0)
    return np.asarray(np.maximum(on_rim, np.abs(np.sum(spoke * along, axis=-1))).max(axis=-1))


@pytest.mark.parametrize(("seed", "n_cables"), [(0, 6), (1, 8), (2, 8)])
def test_what_is_solved_leaves_its_pulley_as_a_tangent(seed, n_cables) -> None:
    robot, poses = robot_and_poses(seed, n_cables, 600)
    for statics in (
        size_poses(robot, poses, ROPE).statics,
        solve_sagging(robot, poses, ROPE.cable(0.01)),
    ):
        solved = statics.is_solved
        assert solved.sum() > 20
        assert off_tangent(statics)[solved].max() < 1e-8
        assert np.isnan(statics.length_m[statics.verdict == Verdict.NOT_CONVERGED]).all()
