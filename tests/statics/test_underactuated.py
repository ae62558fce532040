"""Fewer cables than degrees of freedom: against the twins' quadrature, SciPy, and the old rule."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation
from twins import physics
from twins.hanging import hang
from twins.robots import FIELD4

from designer.arrays import FloatArray, frozen_array
from designer.model.cable import Cable
from designer.model.robot import Platform, Poses, Robot
from designer.model.verdict import Verdict
from designer.physics import catenary
from designer.statics.balance import imbalance, solve_underactuated
from designer.statics.geometry import cable_geometry, load_wrench_N, structure_matrix

pytestmark = pytest.mark.slow  # compiles a kernel that other quick tests do without

ALL = tuple(range(6))


def ours(machine: physics.Machine, mass_kg: float) -> tuple[Robot, Cable]:
    """Return a twin's machine as the designer has it."""
    body = frozen_array(machine.attachment_m) if machine.has_moments else None
    robot = Robot(
        frozen_array(machine.exit_m[0]),
        Platform(mass_kg, body, frozen_array(machine.centre_m)),
        pulley_radius_m=float(np.max(machine.pulley_radius_m)),
        gravity_direction=frozen_array(machine.gravity),
    )
    figures = (float(np.max(x)) for x in (machine.linear_mass, machine.stiffness_N))
    return robot, Cable(float("nan"), *figures, float("inf"))


def random_machine(rng: np.random.Generator) -> tuple[physics.Machine, FloatArray, FloatArray]:
    """Return a machine with cables of up to one and a half times its platform's weight.

    Beside it lengths and positions near which it hangs.
    """
    n, size = int(rng.integers(2, 6)), 10.0 ** rng.uniform(0.5, 2.5)
    has_moments = n > 2 or rng.random() < 0.5
    around = 2 * np.pi * (np.arange(n) + rng.uniform(-0.2, 0.2, n)) / n
    ring = np.stack([np.cos(around), np.sin(around), np.zeros(n)], axis=-1)
    exits = size * (ring * rng.uniform(0.8, 1.2, (n, 1)) + rng.uniform(-0.05, 0.05, (n, 3)))
    body = rng.uniform(0.02, 0.15) * size * ring + 0.01 * size * rng.normal(size=(n, 3))
    plan = 0.3 * size * ring.T @ rng.dirichlet(np.ones(n), 5).T
    position = plan.T - [0.0, 0.0, size * rng.uniform(0.3, 1.0)]
    reach = position[:, None] + (body if has_moments else 0.0)
    length = np.linalg.norm(exits - reach, axis=-1) * rng.uniform(1.0, 1.02, (5, n))
    mass, share = 10.0 ** rng.uniform(0, 3), 10.0 ** rng.uniform(-2, 0.2)
    machine = physics.Machine(
        exit_m=exits[None],
        attachment_m=body if has_moments else np.zeros((n, 3)),
        mass_kg=mass,
        linear_mass=np.full((1, n), share * mass / length[0].sum()),
        stiffness_N=np.full((1, n), mass * 9.81 * 10.0 ** rng.uniform(1.5, 4)),
        has_moments=has_moments,
        centre_m=np.array([0.0, 0.0, -0.05 * size]) if has_moments else np.zeros(3),
        gravity=Rotation.from_rotvec(0.05 * rng.normal(size=3)).apply([0.0, 0.0, -9.81]),
    )
    return machine, length, position


def test_heavy_cables_on_a_large_robot() -> None:
    """34 kg on four cables of 25 kg over 250 m: lengths to a nanometre, tensions to a millinewton.

    Straight cables would be more than a metre off.
    """
    machine = FIELD4.machine()
    rng = np.random.default_rng(0)
    position = rng.uniform(*np.array(FIELD4.box_m).T, (30, 3))
    turn = np.repeat(np.eye(3)[None], 30, axis=0)
    reach = position[:, None] + machine.attachment_m
    length = np.linalg.norm(machine.exit_m - reach, axis=-1)
    position, turn, there = hang(machine, position, turn, ALL, length)
    robot, cable = ours(machine, FIELD4.mass_kg)
    assert 20.0 < FIELD4.linear_mass * length.sum(axis=1).min() < 30.0
    found = solve_underactuated(robot, Poses(position, turn), cable)
    assert found.is_solved.all()
    assert np.abs(found.length_m - there.length_m).max() < 1e-8
    assert np.abs(found.exit_tension_N - there.exit_tension_N).max() < 1e-4
    assert imbalance(found).max() < 1e-8
    assert found.closure_residual_m().max() < 1e-10


@pytest.mark.parametrize("seed", range(20))
def test_random_machines_at_rest(seed) -> None:
    machine, length, position = random_machine(np.random.default_rng(seed))
    free = ALL if machine.has_moments else ALL[:3]
    turn = np.repeat(np.eye(3)[None], len(position), axis=0)
    position, turn, there = hang(machine, position, turn, free, length)
    robot, cable = ours(machine, float(machine.mass_kg))
    found = solve_underactuated(robot, Poses(position, turn), cable)
    assert found.is_solved.all()
    assert np.abs(found.length_m - there.length_m).max() < 1e-6
    assert found.exit_tension_N == pytest.approx(there.exit_tension_N, rel=1e-6)


HALL = [[-2.0, -8.3, 8.5], [2.5, -8.4, 8.5], [2.7, 4.8, 8.4], [-1.8, 4.8, 8.4]]
PLATE = [[-0.21, -0.21, 0.0], [0.21, -0.21, 0.0], [0.21, 0.21, 0.0], [-0.21, 0.21, 0.0]]
HALL4 = Robot(
    frozen_array(HALL), Platform(4.4, frozen_array(PLATE), frozen_array([0.01, 0.0, -0.12]))
)
LIGHT, HEAVY = (Cable(float("nan"), mass, 1e5, float("inf")) for mass in (1e-7, 0.05))


def swaying(count: int = 40) -> Poses:
    """Return poses with a tenth of the weight out of balance, as a moving platform has them."""
    rng = np.random.default_rng(1)
    return Poses.at(
        rng.uniform([-0.2, -2.5, 1], [0.6, -1, 4], (count, 3)), 0.01 * rng.normal(size=(count, 3))
    )


def about_centre(robot: Robot, poses: Poses, wrench: FloatArray) -> FloatArray:
    """Return wrenches (…, 6) with the moment about the centre of mass, over the gyration."""
    arm = poses.rotation @ robot.platform.centre_of_mass_m
    apart = robot.attachments_m - robot.platform.centre_of_mass_m
    moment = wrench[..., 3:] - np.cross(arm, wrench[..., :3])
    return np.concatenate([wrench[..., :3], moment / np.sqrt((apart**2).sum(1).mean())], axis=-1)


def test_massless_cables_leave_the_least_squares() -> None:
    """The limit of light cables: NumPy's least squares of the weighted balance."""
    poses = swaying()
    geometry = cable_geometry(HALL4, poses)
    both = structure_matrix(HALL4, geometry)
    X, D = geometry.horizontal_distance_m, geometry.drop_m
    pulls = (both[..., 0::2] * X[:, None] - both[..., 1::2] * D[:, None]) / geometry.chord_m[
        :, None
    ]
    load = about_centre(HALL4, poses, load_wrench_N(HALL4, poses))
    found = solve_underactuated(HALL4, poses, LIGHT)
    for k in range(len(load)):
        pose = Poses(poses.position_m[k : k + 1], poses.rotation[k : k + 1])
        matrix = about_centre(HALL4, pose, pulls[k].T).T
        least, left, *_ = np.linalg.lstsq(matrix, load[k])
        assert found.exit_tension_N[k] == pytest.approx(least, abs=1e-3 * HALL4.weight_N)
        assert imbalance(found)[k] == pytest.approx(np.sqrt(left[0]) / HALL4.weight_N, rel=1e-5)


def test_heavy_cables_leave_the_least_that_scipy_finds() -> None:
    poses = swaying(12)
    found = solve_underactuated(HALL4, poses, HEAVY)
    w, EA = HEAVY.weight_N_per_m, HEAVY.axial_stiffness_N
    geometry = cable_geometry(HALL4, poses)
    both, load = structure_matrix(HALL4, geometry), load_wrench_N(HALL4, poses)
    X, D = geometry.horizontal_distance_m, geometry.drop_m
    for k in range(12):
        pose = Poses(poses.position_m[k : k + 1], poses.rotation[k : k + 1])

        def left(logarithm: FloatArray, k: int = k, pose: Poses = pose) -> float:
            density = np.exp(logarithm)
            _, force_z = catenary.length_and_force_z(density, X[k], D[k], EA, w)
            held = both[k] @ np.stack([density * X[k], force_z], axis=-1).ravel()
            return float(np.sum(about_centre(HALL4, pose, (held - load[k])[None]) ** 2))

        start = np.log(found.force_x_N[k] / X[k]) + 0.1
        least = np.sqrt(minimize(left, start, tol=1e-10).fun) / HALL4.weight_N
        assert least - 1e-8 < imbalance(found)[k] < least * 1.001 + 1e-8


def test_what_no_cables_hold_is_told() -> None:
    places = [[0.3, -1.8, 2.0], [0.3, -1.8, 12.0], [np.nan, 0.0, 1.0]]
    found = solve_underactuated(HALL4, Poses.at(places), HEAVY)
    assert found.verdict.tolist()[:2] == [Verdict.SOLVED, Verdict.NOT_FOUND]
    assert found.verdict[2] != Verdict.SOLVED
    assert np.isnan(found.length_m[1:]).all()
    assert np.isfinite(found.length_m[0]).all()


def test_batch_equals_loop() -> None:
    poses = swaying(5)
    together = solve_underactuated(HALL4, poses, HEAVY)
    for k in range(5):
        alone = Poses(poses.position_m[k : k + 1], poses.rotation[k : k + 1])
        one = solve_underactuated(HALL4, alone, HEAVY)
        np.testing.assert_allclose(one.length_m[0], together.length_m[k], rtol=1e-10)


def test_pulleys_and_wind() -> None:
    """A set that hangs from pulleys in a steady wind, against the twins' quadrature."""
    machine = replace(
        FIELD4.machine(),
        pulley_radius_m=np.full((1, 4), 0.3),
        force_N=np.array([[12.0, -5.0, 2.0]]),
    )
    position = np.random.default_rng(3).uniform(*np.array(FIELD4.box_m).T, (10, 3))
    turn = np.repeat(np.eye(3)[None], 10, axis=0)
    length = np.linalg.norm(machine.exit_m - position[:, None] - machine.attachment_m, axis=-1)
    position, turn, there = hang(machine, position, turn, ALL, length)
    robot, cable = ours(machine, FIELD4.mass_kg)
    push = np.repeat(machine.force_N, 10, axis=0)
    found = solve_underactuated(robot, Poses(position, turn), cable, push)
    assert np.abs(found.length_m - there.length_m).max() < 1e-6
    assert found.exit_tension_N == pytest.approx(there.exit_tension_N, rel=1e-6)
