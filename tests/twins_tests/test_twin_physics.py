"""The twins' statics: against the product's closed form, against closed forms of special cases."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation
from twins.bending import bending_shift_m
from twins.physics import GRAVITY, Machine, solve
from twins.robots import FAST3_WIDE, HALL6, ROBOTS, YARD3, TwinRobot

from designer.arrays import frozen_array
from designer.model.cable import Cable
from designer.model.robot import Platform, Poses, Robot
from designer.statics.inverse import solve_sagging

TRIPOD = np.array([[[10.0, 0, 0], [-5, 5 * np.sqrt(3), 0], [-5, -5 * np.sqrt(3), 0]]])
BELOW = np.array([[0.0, 0, -8]])
UPRIGHT = np.eye(3)[None]


def poses_in_box(robot: TwinRobot, count: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    low, high = np.array(robot.box_m).T
    turn = Rotation.from_rotvec(rng.normal(0, robot.turn_rad, (count, 3))).as_matrix()
    return rng.uniform(low, high, (count, 3)), turn


def assert_same(robot: Robot, cable: Cable, position: np.ndarray, turn: np.ndarray) -> None:
    machine = Machine(
        exit_m=robot.exit_points_m[None],
        attachment_m=robot.attachments_m,
        mass_kg=robot.platform.mass_kg,
        linear_mass=cable.linear_density_kg_per_m,
        stiffness_N=cable.axial_stiffness_N,
        has_moments=not robot.is_point_mass,
        centre_m=robot.platform.centre_of_mass_m,
    )
    statics = solve_sagging(robot, Poses(frozen_array(position), frozen_array(turn)), cable)
    assert statics.is_solved.all()
    twin = solve(machine, position, turn)
    assert np.allclose(twin.length_m, statics.length_m, rtol=1e-9, atol=0)
    assert np.allclose(twin.exit_tension_N, statics.exit_tension_N, rtol=1e-9, atol=0)


@pytest.mark.slow
@pytest.mark.parametrize("robot", [*ROBOTS.values(), FAST3_WIDE])
def test_agrees_with_the_closed_form_on_the_twins(robot) -> None:
    machine = robot.machine()
    attachments = frozen_array(machine.attachment_m) if robot.attachment_m else None
    product = Robot(frozen_array(machine.exit_m[0]), Platform(robot.mass_kg, attachments))
    cable = Cable(0.01, robot.linear_mass, robot.stiffness_N, 1e9)
    assert_same(product, cable, *poses_in_box(robot, 120, 1))


@pytest.mark.parametrize("diameter_m", [0.01, 0.03])
@pytest.mark.parametrize("name", ["fast_robot", "six_cable_robot"])
def test_agrees_with_the_closed_form_on_the_papers_robot(name, diameter_m, steel, request) -> None:
    robot = request.getfixturevalue(name)
    rng = np.random.default_rng(2)
    # Six cables stand only in a small part of what they span.
    spread = 3.0 if robot.is_point_mass else 40.0
    position = rng.dirichlet(np.full(robot.n_cables, spread), 100) @ robot.exit_points_m
    position[:, 2] = rng.uniform(-150, -60, 100)
    spin = 0.0 if robot.is_point_mass else 0.02
    turn = Rotation.from_rotvec(rng.normal(0, 1, (100, 3)) * spin).as_matrix()
    assert_same(robot, steel.cable(diameter_m), position, turn)


def test_weightless_cables_are_straight_springs() -> None:
    machine = Machine(TRIPOD, np.zeros((3, 3)), 100.0, 1e-15, 1e5)
    chord = np.hypot(10, 8)
    tension = 100 * GRAVITY / 3 * chord / 8
    twin = solve(machine, BELOW, UPRIGHT)
    assert np.allclose(twin.exit_tension_N, tension, rtol=1e-12)
    assert np.allclose(twin.length_m, chord / (1 + tension / 1e5), rtol=1e-12)
    toe = solve(replace(machine, toe_strain=1e-3, toe_tension_N=500.0), BELOW, UPRIGHT)
    strain = tension / 1e5 + 1e-3 * (1 - np.exp(-tension / 500))
    assert np.allclose(toe.length_m, chord / (1 + strain), rtol=1e-12)


def test_tension_of_an_inextensible_cable_grows_by_its_weight_per_height() -> None:
    machine = replace(YARD3.machine(), stiffness_N=np.full((1, 3), 1e18))
    position, turn = poses_in_box(YARD3, 20, 3)
    twin = solve(machine, position, turn)
    lower = np.linalg.norm(twin.platform_pull_N, axis=-1)
    height = machine.exit_m[..., 2] - position[:, None, 2]
    rise = YARD3.linear_mass * GRAVITY * height
    assert np.allclose(twin.exit_tension_N - lower, rise, rtol=1e-8)


def test_the_cable_ends_where_an_ode_solver_takes_it() -> None:
    machine = replace(FAST3_WIDE.machine(), toe_strain=1e-3, toe_tension_N=1e4)
    position, turn = poses_in_box(FAST3_WIDE, 4, 4)
    twin = solve(machine, position, turn)
    stiffness, mass = FAST3_WIDE.stiffness_N, FAST3_WIDE.linear_mass

    def slope(s: float, r: np.ndarray, start: np.ndarray) -> np.ndarray:
        vector = start + np.array([0, 0, mass * GRAVITY * s])
        size = np.linalg.norm(vector)
        return (1 + size / stiffness + 1e-3 * (1 - np.exp(-size / 1e4))) * vector / size

    for row in range(4):
        for k in range(3):
            end = solve_ivp(
                slope, (0, twin.length_m[row, k]), position[row], rtol=1e-10, atol=1e-9,
                args=(twin.platform_pull_N[row, k],),
            ).y[:, -1]  # fmt: skip
            assert np.allclose(end, FAST3_WIDE.exit_m[k], atol=1e-6)


@pytest.mark.parametrize("robot", [YARD3, HALL6])
def test_turning_everything_with_gravity_changes_nothing(robot) -> None:
    whole = Rotation.from_rotvec([0.7, -1.1, 0.4])
    machine = replace(robot.machine(), force_N=np.array([[30.0, -20, 5]]))
    turned = replace(
        machine,
        exit_m=whole.apply(machine.exit_m[0])[None],
        gravity=whole.apply(machine.gravity),
        force_N=whole.apply(machine.force_N),
        pulley_radius_m=np.full((1, robot.cables), 0.1),
    )
    machine = replace(machine, pulley_radius_m=np.full((1, robot.cables), 0.1))
    position, turn = poses_in_box(robot, 10, 5)
    one = solve(machine, position, turn)
    two = solve(turned, whole.apply(position), whole.as_matrix() @ turn)
    assert np.allclose(one.length_m, two.length_m, rtol=1e-11)
    assert np.allclose(one.exit_tension_N, two.exit_tension_N, rtol=1e-11)


def test_moments_balance_about_the_centre_of_mass() -> None:
    centre = np.array([0.1, -0.05, 0.02])
    machine = replace(HALL6.machine(), centre_m=centre)
    position, turn = poses_in_box(HALL6, 10, 6)
    pull = solve(machine, position, turn).platform_pull_N
    arm = np.einsum("rij,nj->rni", turn, machine.attachment_m - centre)
    moment = np.cross(arm, pull).sum(1)
    assert np.abs(moment).max() < 1e-7
    assert np.allclose(pull.sum(1), [0, 0, HALL6.mass_kg * GRAVITY], atol=1e-7)


def test_pulley_with_straight_cable_is_the_tangent_to_a_circle() -> None:
    radius = 0.5
    machine = Machine(
        TRIPOD, np.zeros((3, 3)), 100.0, 1e-15, 1e12, pulley_radius_m=np.full((1, 3), radius)
    )
    twin = solve(machine, BELOW, UPRIGHT)
    across, drop = 10 - radius, 8.0  # from the pulley's centre to the platform
    distance = np.hypot(across, drop)
    free = np.sqrt(distance**2 - radius**2)
    # The spoke to the tangent point stands at acos(r/d) above the line to the platform.
    spoke = np.arccos(radius / distance) - np.arctan2(drop, across)
    assert np.allclose(twin.length_m, free + radius * (np.pi - spoke), rtol=1e-9)
    assert np.allclose(twin.exit_tension_N, 100 * GRAVITY / 3 / np.cos(spoke), rtol=1e-9)


def test_a_bending_mast_is_an_exit_point_moved_by_the_horizontal_force() -> None:
    position, turn = poses_in_box(YARD3, 10, 7)
    softness = 2e-5
    twin = solve(
        replace(YARD3.machine(), mast_m_per_N=np.full((1, 3), softness)), position, turn
    )  # fmt: skip
    moved = YARD3.machine().exit_m - softness * twin.exit_pull_N * [1, 1, 0]
    by_hand = solve(replace(YARD3.machine(), exit_m=moved), position, turn)
    assert np.allclose(twin.length_m, by_hand.length_m, rtol=1e-12)
    inward = ((moved - YARD3.machine().exit_m) * (position[:, None] - YARD3.exit_m)).sum(-1)
    assert (inward > 0).all()


def test_bending_of_a_taut_level_cable_is_a_beam_column() -> None:
    pull, weight, length, rigidity = 1000.0, 20.0, 20.0, 200.0
    shift = bending_shift_m(
        np.full((1, 1), rigidity),
        np.full((1, 1), 1e15),
        np.array([[[length, 0, 0]]]),
        np.array([[[pull, 0, -weight / 2]]]),
        np.array([[[0, 0, -weight]]]),
        np.array([0, 0, -1.0]),
        np.full((1, 1), length),
    )[0, 0]
    x = np.linspace(-length / 2, length / 2, 20001)
    width = np.sqrt(rigidity / pull)
    limp = weight / length / pull * x
    stiff = limp - limp[-1] * np.sinh(x / width) / np.sinh(x[-1] / width)
    expected = np.trapezoid(limp**2 - stiff**2, x) / 2
    assert shift == pytest.approx([expected, 0, 0], rel=2e-3, abs=1e-10)


def test_a_slack_pose_is_refused_not_guessed() -> None:
    machine = replace(YARD3.machine(), mass_kg=np.array([180.0, 180.0]))
    position = np.array([YARD3.pose_m, (14.5, 10.0, 30.0)])
    with pytest.raises(RuntimeError, match=r"no equilibrium|slack"):
        solve(machine, position, np.repeat(UPRIGHT, 2, 0))
