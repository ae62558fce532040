"""Over large pulleys: each solved cable leaves its pulley as a tangent, by plain geometry."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from designer.arrays import FloatArray, frozen_array
from designer.model.cable import Cable, Material
from designer.model.robot import Platform, Poses, Robot
from designer.model.verdict import Verdict
from designer.physics import catenary
from designer.sizing.newton import size_poses
from designer.statics.inverse import Statics, solve_sagging

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
    # A cable to a point below its pulley leads back: horizontally its force is against `out`.
    past = (statics.poses.attachment_points_m(robot) - points)[..., :2]
    level = np.sign(np.sum(past * out, axis=-1)) * statics.force_x_N
    along = np.concatenate([level[..., None] * out, downward[..., None]], axis=-1)
    along /= np.linalg.norm(along, axis=-1, keepdims=True)
    on_rim = np.abs(np.linalg.norm(spoke, axis=-1) - 1.0)
    return np.asarray(np.maximum(on_rim, np.abs(np.sum(spoke * along, axis=-1))).max(axis=-1))


@pytest.mark.slow
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


def hung(
    robot: Robot, exit_m: FloatArray, end_m: FloatArray, cable: Cable, tension_N: float
) -> tuple[FloatArray, float, float]:
    """Return pull on the platform, top tension and sag over chord of a cable over its pulley.

    By the angle at which it leaves, sought among all; ``tension_N`` is along the chord.
    """
    w, EA, radius = cable.weight_N_per_m, cable.axial_stiffness_N, robot.pulley_radius_m
    up = np.array([0.0, 0.0, 1.0])
    out = (end_m - exit_m) * [1.0, 1.0, 0.0]
    out /= np.linalg.norm(out)

    def at(angle: float) -> tuple[FloatArray, ...]:
        leaves = exit_m + radius * ((1.0 + np.sin(angle)) * out + np.cos(angle) * up)
        x, y, z = robot.upright @ (end_m - leaves)
        X, chord = np.hypot(x, y), np.sqrt(x * x + y * y + z * z)
        force_x = tension_N * X / chord
        length, force_z = catenary.length_and_force_z(force_x / X, X, -z, EA, w)
        sag = catenary.sag_m(length, force_x, force_z, EA, w, X, -z) / chord
        level = force_x * np.array([x, y, 0.0]) / X
        ends = level + force_z * up, level + (force_z - w * length) * up
        return ends[0] @ robot.upright, ends[1] @ robot.upright, sag

    def turned(angle: float) -> float:
        along = at(angle)[1]
        return float(np.angle(np.exp(1j * (np.arctan2(-along[2], along @ out) - angle))))

    X, drop = (end_m - exit_m) @ out, exit_m[2] - end_m[2]
    straight = np.arctan2(drop, X - radius) + np.arcsin(radius / np.hypot(X - radius, drop))
    load = -robot.upright[2]
    angles = np.linspace(straight, np.arctan2(-load[2], load @ out), 200)[:-1]
    turns = np.array([turned(angle) for angle in angles])
    crosses = np.flatnonzero((turns[:-1] * turns[1:] <= 0.0) & (np.abs(turns[:-1]) < 1.0))
    if len(crosses) == 0:  # so slack that it swings within one of these angles
        return np.zeros(3), 0.0, np.inf
    k = int(crosses[0])
    pull, top, sag = at(brentq(turned, angles[k], angles[k + 1], xtol=1e-15, rtol=1e-15))
    ends = np.linalg.norm(pull), np.linalg.norm(top)
    return -pull, float(max(ends)), float(sag)


@pytest.mark.slow
@pytest.mark.parametrize("lean", [0.0, 0.3])
@pytest.mark.parametrize("near", [False, True])
def test_what_cables_over_pulleys_hold_is_held(lean: float, near: bool) -> None:
    """Cables are hung by plain geometry, and the load that they balance is asked for.

    Near ones are within two radii of their exit points, above or below; others in wind bow out.
    """
    held = 0
    for seed in range(10):
        rng = np.random.default_rng([seed, near, int(10 * lean)])
        exits = np.column_stack([rng.uniform(-20.0, 20.0, (7, 2)), rng.uniform(8.0, 20.0, 7)])
        ends, radius = rng.uniform(-3.0, 3.0, (7, 3)), 10 ** rng.uniform(-1.0, 0.0)
        if near:
            angle, away = rng.uniform(0.0, 2.0 * np.pi), rng.uniform(0.2, 1.9) * radius
            height = rng.choice([-1.0, 1.0]) * rng.uniform(2.5 * radius, 15.0)
            exits[0] = ends[0] + [away * np.cos(angle), away * np.sin(angle), height]
        robot = Robot(
            frozen_array(exits),
            Platform(0.0, frozen_array(ends)),
            pulley_radius_m=radius,
            sag_max=float(rng.choice([0.05, 0.2])),
            cable_load_direction=frozen_array([lean, 0.5 * lean, -1.0]) if lean else None,
        )
        cable = ROPE.cable(0.01)
        chords = np.linalg.norm(exits - ends, axis=1)
        factor = 10 ** rng.uniform(0.05, 1.0, 7)
        tensions = cable.weight_N_per_m * chords / (8.0 * robot.sag_max) * factor
        each = [hung(robot, exits[i], ends[i], cable, tensions[i]) for i in range(7)]
        if max(sag for *_, sag in each) > robot.sag_max:
            continue
        pulls = np.array([pull for pull, *_ in each])
        wrench = -np.append(pulls.sum(axis=0), np.cross(ends, pulls).sum(axis=0))
        loaded = replace(robot, platform=replace(robot.platform, wrench_N=frozen_array(wrench)))
        statics = solve_sagging(loaded, Poses.at(np.zeros((1, 6))), cable)
        assert statics.is_solved.all()
        assert statics.largest_tension_N[0] < max(top for _, top, _ in each) * (1.0 + 1e-6)
        held += 1
    assert held > 4


def test_no_cable_reaches_into_its_pulley() -> None:
    robot, _ = robot_and_poses(1, 8, 1)
    end = robot.attachments_m[0]
    toward = np.append(-robot.exit_points_m[0, :2], 0.0) / 20.0
    inside = Poses.at(np.append(robot.exit_points_m[0] + 4.5 * toward - end, np.zeros(3))[None])
    assert size_poses(robot, inside, ROPE).statics.verdict[0] == Verdict.NO_LENGTH
