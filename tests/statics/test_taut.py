"""Robots whose cables and degrees of freedom differ in number: compiled against plain NumPy."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from designer.arrays import FloatArray, frozen_array
from designer.kernel.unit_cable import PULL_FLOOR
from designer.model.cable import Cable
from designer.model.robot import Platform, Poses, Robot
from designer.physics import catenary
from designer.statics.balance import solve_taut
from designer.statics.geometry import cable_geometry, load_wrench_N, structure_matrix
from designer.statics.pulleys import straight_run

REGULAR = 1e-4
LEAST = 1e-3

HALL = [[-2.0, -8.3, 8.5], [2.5, -8.4, 8.5], [2.7, 4.8, 8.4], [-1.8, 4.8, 8.4]]
PLATE = [[-0.21, -0.21, 0.0], [0.21, -0.21, 0.0], [0.21, 0.21, 0.0], [-0.21, 0.21, 0.0]]
FOUR_ON_A_BODY = Robot(
    frozen_array(HALL), Platform(4.4, frozen_array(PLATE), frozen_array([0.01, 0.0, -0.12]))
)
FOUR_ON_A_POINT = Robot(
    frozen_array([[0, -1.6, -0.1], [1.5, 0.9, -0.1], [-1.4, 0.8, -0.1], [0, 0, 2.4]]), Platform(2.0)
)
LIGHT = Cable(float("nan"), 0.01, 1e5, float("inf"))
SOFT = Cable(float("nan"), 0.02, 2e3, float("inf"))


def hall_poses(count: int = 150) -> Poses:
    rng = np.random.default_rng(1)
    turn = 0.05 * rng.normal(size=(count, 3))
    return Poses.at(rng.uniform([-1, -6, 1], [1.5, 3, 5], (count, 3)), turn)


def pushes(count: int = 150) -> FloatArray:
    return frozen_array(np.random.default_rng(2).normal(0.0, 0.5, (count, 3)))


def balance(
    robot: Robot, poses: Poses, force_N: FloatArray | None
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return AᵀA + ε, Aᵀ f and the chords, from the structure matrix."""
    geometry = cable_geometry(robot, poses, straight_run(robot, poses).exit_points_m)
    X, D, chord = geometry.horizontal_distance_m, geometry.drop_m, geometry.chord_m
    both = structure_matrix(robot, geometry)
    A = (both[..., 0::2] * X[:, None] - both[..., 1::2] * D[:, None]) / chord[:, None]
    normal = np.einsum("pki,pkj->pij", A, A)
    size = np.trace(normal, axis1=1, axis2=2)[:, None, None] / robot.n_cables
    right = np.einsum("pki,pk->pi", A, load_wrench_N(robot, poses, force_N))
    return normal + REGULAR * size * np.eye(robot.n_cables), right, chord


def plainly(
    robot: Robot, poses: Poses, cable: Cable, force_N: FloatArray | None
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """The same by NumPy's solver and the safeguarded Newton of `designer.physics.catenary`."""
    normal, right, chord = balance(robot, poses, force_N)
    tension = np.linalg.solve(normal, right[..., None])[..., 0]
    density = np.maximum(tension, LEAST * robot.weight_N) / chord
    run = straight_run(robot, poses)
    geometry = cable_geometry(robot, poses, run.exit_points_m)
    X, w, EA = geometry.horizontal_distance_m, cable.weight_N_per_m, cable.axial_stiffness_N
    length, force_z = catenary.length_and_force_z(density, X, geometry.drop_m, EA, w)
    upper, _ = catenary.end_tensions_N(length, density * X, force_z, w)
    return length + run.unstrained(upper / EA).wrap_m, upper, X


def assert_as_plain(
    robot: Robot, poses: Poses, cable: Cable, force: FloatArray | None = None, *, rtol: float
) -> None:
    for ours, plain in zip(
        solve_taut(robot, poses, cable, force), plainly(robot, poses, cable, force), strict=True
    ):
        assert ours.shape == (*poses.shape, robot.n_cables)
        np.testing.assert_allclose(ours, plain, rtol=rtol, atol=0.0)


@pytest.mark.parametrize("cable", [LIGHT, SOFT], ids=["light", "soft"])
@pytest.mark.parametrize(
    ("change", "force"),
    [
        pytest.param({}, None, id="plain"),
        pytest.param({"pulley_radius_m": 0.04}, None, id="pulleys"),
        pytest.param({"tilt_rad": frozen_array([0.02, -0.01])}, pushes(), id="tilt and force"),
    ],
)
def test_compiled_is_as_plain(cable: Cable, change: dict, force: FloatArray | None) -> None:
    assert_as_plain(replace(FOUR_ON_A_BODY, **change), hall_poses(), cable, force, rtol=1e-12)


def test_more_cables_than_degrees_of_freedom() -> None:
    """There the normal matrix has a condition of 10⁴, so its own equations are checked."""
    robot = Robot(frozen_array(HALL), Platform(4.4))
    poses = Poses.at(np.random.default_rng(3).uniform([-1, -4, 1], [1.5, 2, 4], (200, 3)))
    light_as_air = Cable(float("nan"), 1e-9, 1e5, float("inf"))  # its tension is that of a chord
    _, tension, _ = solve_taut(robot, poses, light_as_air)
    normal, right, _ = balance(robot, poses, None)
    pulling = (tension > 1.01 * LEAST * robot.weight_N).all(axis=1)
    assert pulling.sum() > 100
    left = np.einsum("pij,pj->pi", normal, tension) - right
    assert np.abs(left[pulling]).max() < 1e-7 * robot.weight_N
    assert_as_plain(robot, poses, LIGHT, rtol=1e-11)


def test_cable_straight_above() -> None:
    poses = Poses.at([[0.0, 0.0, 1.0], [0.1, 0.0, 1.0]])
    length, _, distance = solve_taut(FOUR_ON_A_POINT, poses, LIGHT)
    assert distance[0, 3] == 0.0
    assert 1.3995 < length[0, 3] < 1.4
    assert_as_plain(FOUR_ON_A_POINT, poses, LIGHT, rtol=1e-11)


def test_batch_equals_loop() -> None:
    poses = hall_poses(5)
    together = solve_taut(FOUR_ON_A_BODY, poses, SOFT)
    for k in range(5):
        alone = Poses(poses.position_m[k : k + 1], poses.rotation[k : k + 1])
        for one, all_ in zip(solve_taut(FOUR_ON_A_BODY, alone, SOFT), together, strict=True):
            np.testing.assert_allclose(one[0], all_[k], rtol=1e-14, atol=0.0)


def test_what_is_not_taut_carries_no_number() -> None:
    """A cable so heavy that it would be many times as long as its chord; a pose that is none."""
    heavy = Cable(float("nan"), 50.0, 1e7, float("inf"))
    poses = hall_poses(40)
    length, tension, _ = solve_taut(FOUR_ON_A_BODY, poses, heavy)
    normal, right, chord = balance(FOUR_ON_A_BODY, poses, None)
    straight = np.linalg.solve(normal, right[..., None])[..., 0]
    pull = np.maximum(straight, LEAST * FOUR_ON_A_BODY.weight_N) / chord / heavy.weight_N_per_m
    assert (np.isnan(length) == (pull < PULL_FLOOR)).all()
    assert (np.isnan(tension) == np.isnan(length)).all()
    assert np.isnan(length).any()
    nowhere = Poses.at([[np.nan, 0.0, 1.0], [0.0, 0.0, 2.0]], np.zeros((2, 3)))
    length, tension, _ = solve_taut(FOUR_ON_A_BODY, nowhere, LIGHT)
    assert np.isnan(length[0]).all()
    assert np.isnan(tension[0]).all()
    assert np.isfinite(length[1]).all()
