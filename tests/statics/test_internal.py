"""Internal forces from a pose's own readings: against SciPy, and against what was there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from designer.arrays import FloatArray, frozen_array
from designer.model.cable import Cable
from designer.model.robot import Platform, Poses, Robot
from designer.model.verdict import Verdict
from designer.physics import catenary
from designer.statics.balance import InternalBalance, solve_taut
from designer.statics.geometry import cable_geometry, load_wrench_N, structure_matrix
from designer.statics.inverse import Statics

pytestmark = pytest.mark.slow  # compiles a kernel that other quick tests do without

EIGHT = Robot(
    frozen_array(
        [
            [-7.2, -5.2, 5.5], [-7.3, -5.1, 5.5], [-7.3, 5.2, 5.5], [-7.2, 5.4, 5.5],
            [7.2, 5.3, 5.5], [7.3, 5.2, 5.5], [7.3, -5.1, 5.5], [7.2, -5.3, 5.5],
        ]
    ),
    Platform(
        500.0,
        frozen_array(
            [
                [0.5, -0.5, 0.0], [-0.5, 0.35, 1.0], [-0.5, -0.27, 0.0], [0.5, 0.35, 1.0],
                [-0.5, 0.5, 0.0], [0.5, -0.34, 1.0], [0.5, 0.27, 0.0], [-0.5, -0.35, 1.0],
            ]
        ),
    ),
)  # fmt: skip
FOUR = Robot(
    frozen_array([[-20.0, -15.0, 12.0], [20.0, -15.0, 12.5], [20.0, 15.0, 12.0], [-20, 15, 11.5]]),
    Platform(80.0),
)
ROPE = Cable(float("nan"), 0.6, 3e6, float("inf"))
NOISE = (1e-3, 5.0)
COUNT = 60


def poses_of(robot: Robot) -> Poses:
    rng = np.random.default_rng(0)
    if robot.is_point_mass:
        return Poses.at(rng.uniform([-10, -8, 1], [10, 8, 5], (COUNT, 3)))
    position = rng.uniform([-3, -2, 0.5], [3, 2, 2.5], (COUNT, 3))
    return Poses.at(position, rng.normal(0, 0.05, (COUNT, 3)))


def nothing(robot: Robot) -> FloatArray:
    return np.full((COUNT, robot.n_cables), np.nan)


def some_balance(robot: Robot, seed: int = 1) -> Statics:
    """A balance with arbitrary internal forces: that nearest to scattered tensions."""
    poses, none = poses_of(robot), nothing(robot)
    level = InternalBalance(robot, poses, ROPE).nearest(none, none, NOISE).exit_tension_N
    spread = np.random.default_rng(seed).normal(0.0, 0.05, level.shape) * level
    return InternalBalance(robot, poses, ROPE).nearest(none, level + spread, NOISE)


ROBOTS = [
    pytest.param(EIGHT, id="eight on a body"),
    pytest.param(FOUR, id="four on a point"),
    pytest.param(replace(EIGHT, pulley_radius_m=0.1), id="pulleys"),
    pytest.param(replace(FOUR, tilt_rad=frozen_array([0.02, -0.01])), id="tilt"),
]


@pytest.mark.parametrize("robot", ROBOTS)
def test_the_balance_closes(robot: Robot) -> None:
    there = some_balance(robot)
    assert there.is_solved.all()
    rest = np.abs(there.equilibrium_residual_N()).max()
    assert rest < 1e-8 * there.largest_tension_N.max()
    assert there.closure_residual_m().max() < 1e-9


@pytest.mark.parametrize("robot", ROBOTS)
def test_readings_without_noise_give_the_forces_that_are_there(robot: Robot) -> None:
    there = some_balance(robot)
    poses = poses_of(robot)
    both = InternalBalance(robot, poses, ROPE).nearest(there.length_m, there.exit_tension_N, NOISE)
    # The weak pull toward the smallest tensions holds the weight of the platform against the noise.
    np.testing.assert_allclose(both.exit_tension_N, there.exit_tension_N, atol=0.02)
    np.testing.assert_allclose(both.length_m, there.length_m, atol=1e-6)


def test_lengths_alone_tell_the_forces_through_elasticity() -> None:
    there = some_balance(EIGHT)
    none = nothing(EIGHT)
    level = InternalBalance(EIGHT, poses_of(EIGHT), ROPE).nearest(none, none, NOISE).exit_tension_N
    found = (
        InternalBalance(EIGHT, poses_of(EIGHT), ROPE)
        .nearest(there.length_m, none, NOISE)
        .exit_tension_N
    )
    assert np.abs(found - there.exit_tension_N).max() < 0.05 * np.abs(level - found).max()


@pytest.mark.parametrize("noise", [NOISE, (0.03, 400.0)], ids=["exact", "all but useless"])
def test_it_is_the_optimum_that_scipy_finds(noise: tuple[float, float]) -> None:
    """With readings that tell little, the hold near the smallest tensions counts as much."""
    there = some_balance(FOUR)
    rng = np.random.default_rng(2)
    length = there.length_m + rng.normal(0.0, NOISE[0], there.length_m.shape)
    tension = there.exit_tension_N + rng.normal(0.0, NOISE[1], there.length_m.shape)
    found = InternalBalance(FOUR, poses_of(FOUR), ROPE).nearest(length, tension, noise)
    for k in range(5):
        theirs = _by_slsqp(Poses.at(poses_of(FOUR).position_m[k]), length[k], tension[k], noise)
        np.testing.assert_allclose(found.force_x_N[k], theirs, rtol=1e-4)


def _by_slsqp(
    pose: Poses, length_m: FloatArray, tension_N: FloatArray, noise: tuple[float, float]
) -> FloatArray:
    """Horizontal forces that bring lengths and tensions nearest to those read, by SciPy."""
    from scipy.optimize import minimize

    w, EA = ROPE.weight_N_per_m, ROPE.axial_stiffness_N
    geometry = cable_geometry(FOUR, pose)
    X, D = geometry.horizontal_distance_m, geometry.drop_m
    matrix, load = structure_matrix(FOUR, geometry), load_wrench_N(FOUR, pose)
    scale = FOUR.weight_N / X
    _, taut_N, _ = solve_taut(FOUR, Poses.at(pose.position_m[None]), ROPE, None)
    smallest_N = np.fmax(taut_N[0], 0.05 * FOUR.weight_N)

    def cables(share: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        length, force_z = catenary.length_and_force_z(share * scale, X, D, EA, w)
        return length, force_z, np.hypot(share * scale * X, w * length - force_z)

    def misfit(share: FloatArray) -> float:
        length, _, tension = cables(share)
        off = ((length - length_m) / noise[0]) ** 2 + ((tension - tension_N) / noise[1]) ** 2
        hold = np.log(share * scale / (smallest_N / geometry.chord_m)) ** 2
        return float((off + hold).sum())

    def rest(share: FloatArray) -> FloatArray:
        _, force_z, _ = cables(share)
        forces = np.stack([share * scale * X, force_z], axis=-1).ravel()
        return np.asarray((matrix @ forces - load) / FOUR.weight_N)

    answer = minimize(
        misfit,
        0.5 * np.ones(4),
        method="SLSQP",
        bounds=[(1e-3, None)] * 4,
        constraints={"type": "eq", "fun": rest},
        options={"ftol": 1e-12, "maxiter": 500},
    )
    return np.asarray(answer.x * scale * X)


def test_a_wild_reading_moves_little() -> None:
    there = some_balance(EIGHT)
    wild = there.exit_tension_N.copy()
    wild[:, 2] += 200.0 * NOISE[1]
    found = InternalBalance(EIGHT, poses_of(EIGHT), ROPE).nearest(there.length_m, wild, NOISE)
    assert found.is_solved.all()
    assert np.abs(found.exit_tension_N - there.exit_tension_N).max() < 4.0 * NOISE[1]


def test_tensions_are_believed_where_an_attachment_is_in_the_wrong_place() -> None:
    """Of stiff cables, held well above the least tensions, and read not surely."""
    corners = np.array([[x, y, z] for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))])
    held = np.array([[x, y, -z] for x, y, z in 2.0 * corners - 1.0]) * [0.4, 0.3, 0.2]
    robot = Robot(
        frozen_array(corners * [6.0, 5.0, 3.5]),
        Platform(3.0, frozen_array(held + np.array([0.02, 0, 0]))),
    )
    tight = Cable(float("nan"), 1e-4, 1e5, float("inf"))
    at = np.random.default_rng(4).uniform([2.5, 2.0, 1.5], [3.5, 3.0, 2.0], (COUNT, 3))
    poses, none = Poses.at(at, np.full((COUNT, 3), 0.02)), nothing(robot)
    there = InternalBalance(robot, poses, tight).nearest(
        none, np.full_like(none, 500.0), (1e-3, 1.0)
    )
    assert np.median(there.exit_tension_N) > 300.0
    length = there.length_m + np.array([0.0, 0.0, 0.0, 0.015, 0.0, 0.0, 0.0, 0.0])
    found = InternalBalance(robot, poses, tight).nearest(length, there.exit_tension_N, (0.04, 50.0))
    assert np.abs(found.exit_tension_N - there.exit_tension_N).max() < 100.0


def test_readings_that_contradict_each_other_still_give_a_balance() -> None:
    there = some_balance(EIGHT)
    off = np.random.default_rng(3).normal(0.0, 300.0, there.length_m.shape)
    tension = np.fmax(there.exit_tension_N + off, 1.0)
    found = InternalBalance(EIGHT, poses_of(EIGHT), ROPE).nearest(nothing(EIGHT), tension, NOISE)
    assert found.is_solved.all()


def test_a_pose_that_cannot_be_balanced_is_told() -> None:
    position = np.array([[0.0, 0.0, 2.0], [0.0, 0.0, 40.0]])  # the second above all exit points
    none = np.full((2, 4), np.nan)
    found = InternalBalance(FOUR, Poses.at(position), ROPE).nearest(none, none, NOISE)
    assert found.verdict.tolist() == [Verdict.SOLVED, Verdict.NOT_CONVERGED]
    assert np.isnan(found.length_m[1]).all()


def test_one_pose_as_in_a_batch() -> None:
    there = some_balance(EIGHT)
    poses = poses_of(EIGHT)
    alone = InternalBalance(EIGHT, Poses(poses.position_m[7:8], poses.rotation[7:8]), ROPE).nearest(
        there.length_m[7:8], there.exit_tension_N[7:8], NOISE
    )
    all_ = InternalBalance(EIGHT, poses, ROPE).nearest(there.length_m, there.exit_tension_N, NOISE)
    np.testing.assert_allclose(alone.length_m[0], all_.length_m[7], rtol=1e-12)
