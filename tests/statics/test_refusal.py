"""What is proved of poses that nothing holds: the cone of all that cables can do, both ways."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from redundant_robots import FOUR, SEVEN, anywhere, one, steel
from sample_robots import COGIRO
from scipy.optimize import nnls

from designer.arrays import frozen_array
from designer.kernel.batch import refuse_batch
from designer.model.cable import Material
from designer.model.robot import Platform, Poses, Robot
from designer.model.verdict import Verdict
from designer.physics import catenary
from designer.sizing.newton import limit_ratio, size_poses
from designer.statics.geometry import (
    cable_geometry,
    load_wrench_N,
    structure_matrix,
    upright_situation,
)
from designer.statics.inverse import solve_sagging
from designer.statics.pulleys import over_pulleys, straight_run

OUTSIDE, NOT_FOUND = Verdict.OUTSIDE_HULL, Verdict.NOT_FOUND


def refuse(robot: Robot, poses: Poses) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    points = straight_run(robot, poses).exit_points_m
    least_N = robot.tension_min_N if robot.is_redundant else 0.0
    return refuse_batch(upright_situation(robot, poses, points), least_N)


def random_robot(rng: np.random.Generator, kind: str) -> Robot:
    """A robot with exit points on all sides, also below, and random gravity."""
    n = int(rng.integers(3, 8)) if kind == "point" else int(rng.integers(6, 11))
    if kind == "planar":
        exits = rng.uniform(-10, 10, (n, 3)) * [1, 0, 1]
        attachments = rng.uniform(-1, 1, (n, 3)) * [1, 0, 1]
        return Robot(frozen_array(exits), Platform(50.0, frozen_array(attachments)), is_planar=True)
    attachments = None if kind == "point" else frozen_array(rng.uniform(-1, 1, (n, 3)))
    down = rng.normal(size=3) if kind == "tilted" else np.array([0.0, 0.0, -1.0])
    exits = frozen_array(rng.uniform(-10, 10, (n, 3)))
    return Robot(exits, Platform(50.0, attachments), gravity_direction=frozen_array(down))


def random_poses(rng: np.random.Generator, robot: Robot, count: int) -> Poses:
    across = np.array([1.0, 0.0, 1.0]) if robot.is_planar else np.ones(3)
    position = rng.uniform(-9, 9, (count, 3)) * across
    if robot.is_point_mass:
        return Poses.at(position)
    turn = rng.normal(0, 0.2, (count, 3)) * (1.0 - across if robot.is_planar else across)
    return Poses.at(position, turn)


def rays(robot: Robot, poses: Poses) -> tuple[np.ndarray, np.ndarray]:
    """Wrenches of straight cables, and of forces straight down at the attachments: (..., 2 n)."""
    geometry = cable_geometry(robot, poses, straight_run(robot, poses).exit_points_m)
    forces = structure_matrix(robot, geometry)
    level, up = forces[..., 0::2], forces[..., 1::2]
    along = geometry.horizontal_distance_m[..., None, :], geometry.drop_m[..., None, :]
    # The force on a cable at the platform is opposite to its pull: so is the load's sign.
    return level * along[0] - up * along[1], up


@pytest.mark.parametrize("kind", ["point", "body", "planar", "tilted"])
def test_the_cone_is_that_of_least_squares(kind) -> None:
    rng = np.random.default_rng(1)
    seen = set()
    for _ in range(12):
        robot = random_robot(rng, kind)
        poses = random_poses(rng, robot, 8)
        verdict, wrench, separation = refuse(robot, poses)
        straight, down = rays(robot, poses)
        load = load_wrench_N(robot, poses)
        for k in range(8):
            sizes = np.ones(len(load[k]))
            lever = cable_geometry(robot, one(poses, k)).lever_m
            sizes[robot.balance_rows >= 3] = np.abs(lever).sum(axis=1).max()
            both = np.hstack([straight[k], down[k]]) / sizes[:, None]
            both = both / np.linalg.norm(both, axis=0)
            wanted = load[k] / sizes / np.linalg.norm(load[k] / sizes)
            rest, rest_straight = nnls(both, wanted)[1], nnls(both[:, : robot.n_cables], wanted)[1]
            seen.add(int(verdict[k]))
            assert (verdict[k] == OUTSIDE) == (rest > 1e-8)
            assert (verdict[k] in (OUTSIDE, NOT_FOUND)) == (rest_straight > 1e-8)
            if verdict[k] == OUTSIDE:
                assert separation[k] == pytest.approx(rest, rel=1e-6)
                assert np.linalg.norm(wrench[k]) == pytest.approx(1.0)
    # A force straight down is of no use to a point mass, which only hangs.
    assert seen >= ({int(OUTSIDE)} if kind == "point" else {int(OUTSIDE), int(NOT_FOUND)})


def held_by(robot: Robot, poses: Poses, pull: np.ndarray, weight: float) -> np.ndarray:
    """The load (6,), base frame, that sagging cables of these pulls p hold in one pose."""
    EA = 1e5 * weight

    def solve(run):
        geometry = cable_geometry(robot, poses, run.exit_points_m)
        length, force_z = catenary.length_and_force_z(
            pull * weight, geometry.horizontal_distance_m, geometry.drop_m, EA, weight
        )
        force_x = pull * weight * geometry.horizontal_distance_m
        return (geometry, force_x, force_z), np.arctan2(weight * length - force_z, force_x), 0.0

    (geometry, force_x, force_z), _, _ = over_pulleys(robot, poses, solve)
    outward = np.concatenate([geometry.outward, np.zeros((robot.n_cables, 1))], axis=-1)
    forces = outward * force_x[:, None] + np.array([0.0, 0.0, 1.0]) * force_z[:, None]
    moment = np.cross(geometry.lever_m, forces).sum(axis=0)
    turned = np.stack([forces.sum(axis=0), moment]) @ robot.upright
    return turned.ravel()


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize("kind", ["point", "body", "planar", "tilted", "pulleys", "least"])
def test_what_random_sagging_cables_hold_is_never_refused(kind) -> None:
    """Cables with random pulls, from above and below, slack to taut, hold the load by the way."""
    rng = np.random.default_rng(2)
    checked = 0
    for _ in range(150):
        robot = random_robot(rng, kind if kind in ("point", "planar", "tilted") else "body")
        if kind == "pulleys":
            robot = replace(robot, pulley_radius_m=float(rng.uniform(0.05, 0.8)))
        poses = random_poses(rng, robot, 1)
        pose = one(poses, 0)
        geometry = cable_geometry(robot, pose)
        if (geometry.horizontal_distance_m < 2.0 * robot.pulley_radius_m).any():
            continue
        pull = 10 ** rng.uniform(-0.7, 1.5, robot.n_cables)
        if kind == "least" and robot.is_redundant:
            robot = replace(robot, tension_min_N=float((pull * geometry.chord_m).min() * 30.0))
        wrench = held_by(robot, pose, pull, 30.0)
        platform = replace(robot.platform, mass_kg=0.0, wrench_N=frozen_array(wrench))
        loaded = replace(robot, platform=platform)
        assert refuse(loaded, poses)[0][0] != OUTSIDE
        # Against the same load turned round they are of no use as a rule.
        turned = replace(loaded, platform=replace(platform, wrench_N=frozen_array(-wrench)))
        checked += refuse(turned, poses)[0][0] == OUTSIDE
    assert checked > 30


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize("weights", [1.0, 60.0])
def test_solved_poses_are_never_refused(weights) -> None:
    robot, poses = replace(COGIRO, sag_max=0.5), anywhere(2500, 7)
    sizing = size_poses(robot, poses, steel(weights))
    refused = refuse(robot, poses)[0]
    solved = sizing.statics.is_solved
    assert not np.any(refused[solved] == OUTSIDE)
    assert np.any(sizing.statics.verdict == OUTSIDE)
    # What straight cables cannot hold, sagging ones may.
    assert np.any(refused[solved] == NOT_FOUND)


def test_a_least_tension_moves_the_cone() -> None:
    poses = Poses.at([[50.0, 40.0, -5.0]])
    assert refuse(FOUR, poses)[0] == [Verdict.NOT_CONVERGED]
    tight = replace(FOUR, tension_min_N=50_000.0)
    # Straight cables cannot all be so tight; how far they may sag is not bounded.
    assert refuse(tight, poses)[0] == [NOT_FOUND]


@pytest.mark.slow
def test_many_cables_are_judged_like_few() -> None:
    """Sixty-four cables round a small platform: no pose is called impossible by a failed solver."""
    rng = np.random.default_rng(4)
    angle = np.linspace(0.0, 2.0 * np.pi, 64, endpoint=False)
    exits = np.column_stack([10 * np.cos(angle), 10 * np.sin(angle), rng.uniform(4, 6, 64)])
    attachments = rng.uniform(-0.5, 0.5, (64, 3))
    robot = Robot(frozen_array(exits), Platform(100.0, frozen_array(attachments)))
    poses = Poses.at(rng.uniform(-7, 7, (40, 3)) * [1, 1, 0.3], rng.normal(0, 0.1, (40, 3)))
    statics = size_poses(robot, poses, steel()).statics
    refused = refuse(robot, poses)[0]
    assert np.array_equal(statics.verdict == OUTSIDE, refused == OUTSIDE)
    assert np.all(statics.is_solved[refused == Verdict.NOT_CONVERGED])


def test_vertical_cables_are_not_rank_deficient() -> None:
    """A cable straight above the platform has zeros where others have their horizontal pull."""
    exits = [[0.0, 0, 10], [4, 1, 10], [-4, 2, 10]]
    robot = Robot(frozen_array(exits), Platform(100.0))
    statics = size_poses(robot, Poses.at([[0.0, 1e-3, 2.0]]), steel()).statics
    assert statics.verdict[0] in (Verdict.SOLVED, OUTSIDE)
    assert refuse(SEVEN, Poses.at([[0.0, 0.0, 0.0]]))[0] != [Verdict.RANK_DEFICIENT]
    fixed = solve_sagging(robot, Poses.at([[0.0, 0.0, 2.0]]), steel().cable(0.01))
    assert fixed.verdict[0] != Verdict.RANK_DEFICIENT


def test_near_the_edge_of_the_hull_no_finite_cable_is_proved(fast_robot: Robot) -> None:
    """On the edge, and inside of it as far as stress at infinite section is above what is allowed.

    At some scale of the distance to the edge both happen.
    """
    rng = np.random.default_rng(20261125)
    material = Material(7800.0, 200e9, 180e6)
    corners = fast_robot.exit_points_m
    share, drop_m = rng.uniform(0.1, 0.9, (3, 60, 1)), rng.uniform(20.0, 120.0, (3, 60))
    edges = corners[:, None] + share * (np.roll(corners, -1, axis=0) - corners)[:, None]
    inward = corners.mean(axis=0) - edges
    for depth in (0.0, 1e-12, 1e-6, 1e-3, 0.03, 0.1):
        places = (edges + depth * inward).reshape(-1, 3) - [0.0, 0.0, 1.0] * drop_m.reshape(-1, 1)
        verdict = size_poses(fast_robot, Poses.at(places), material).statics.verdict
        if depth > 1e-6:
            over = limit_ratio(fast_robot, Poses.at(places), material) > 1.0
            assert ((verdict == Verdict.NO_FINITE_CABLE) == over).all()
        else:
            assert (verdict == Verdict.NO_FINITE_CABLE).all()
