"""Wind, ice and inertia: cables in the plane of load and chord, against integration in 3-D."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from twins.loaded import Acting, Twin, acting, held, integrated_end_m, rest, tensions_N

from designer.analysis.maps import cable_curves_m
from designer.arrays import FloatArray
from designer.model.cable import STANDARD_GRAVITY_M_PER_S2 as G
from designer.model.cable import Cable
from designer.model.load_case import Ice, LoadCase, Loaded, Wind
from designer.model.robot import Platform, Poses, Robot
from designer.physics import catenary
from designer.statics.cable_loss import Fate, settle
from designer.statics.fixed_length import cables_of_length
from designer.statics.inverse import Statics, solve_sagging

ROPE = Cable(0.012, 0.5, 6e6, 30e3)
SQUARE = np.array([[0.0, 0, 30], [40, 0, 32], [18, 35, 29]])


def pulls_N(statics: Statics) -> FloatArray:
    """Pull of each cable on the platform of one pose, base frame (n_cables, 3)."""
    force = np.concatenate(
        [statics.force_x_N[:, None] * statics.geometry().outward, statics.force_z_N[:, None]],
        axis=1,
    )
    return np.asarray(-force @ statics.robot.upright)


def point_robot() -> Robot:
    return Robot(SQUARE, Platform(300.0, drag_area_m2=0.8))


def twin_of(robot: Robot, cable: Cable, wind: Wind) -> Twin:
    body = robot.platform
    return Twin(
        robot.exit_points_m,
        body.mass_kg,
        cable.axial_stiffness_N,
        cable.linear_density_kg_per_m,
        cable.diameter_m,
        body.attachments_m,
        body.centre_of_mass_m,
        body.wrench_N,
        body.drag_area_m2 or 0.0,
        body.drag_centre_m,
        wind.cable_drag_coefficient,
    )


def acting_of(twin: Twin, one: Loaded) -> Acting:
    case, mass = one.case, twin.mass_kg
    assert case.wind is not None
    assert one.wind is not None
    push = None if one.inertia is None else mass * case.acceleration_m_per_s2 * one.inertia
    return acting(
        twin,
        wind=case.wind.speed_m_per_s * one.wind,
        ice_m=case.ice.thickness_m if case.ice else 0.0,
        factor=case.dynamic_factor,
        inertia_N=push,
    )


def test_midpoint_of_a_span_in_a_cross_wind() -> None:
    side = 0.5 / np.sqrt(2.0)
    robot = Robot(
        np.zeros((1, 3)), Platform(1.0), cable_load_direction=np.array([0.0, side, -side])
    )
    length, _ = catenary.length_and_force_z(1.0, 1000.0, 0.0, np.inf, 0.5)
    pose = Poses.at([1000.0, 0.0, 0.0])
    ones = np.ones(1)
    statics = cables_of_length(robot, pose, ones * length, np.inf * ones, 0.5 * ones)
    assert statics.force_x_N == pytest.approx(1000.0, rel=1e-9)
    middle = cable_curves_m(statics)[0, 40]
    sag = 2000.0 * (np.cosh(0.25) - 1.0) / np.sqrt(2.0)
    np.testing.assert_allclose(middle, [500.0, sag, -sag], rtol=1e-9)
    assert np.abs(middle[1:]).round(1).tolist() == [44.4, 44.4]


@pytest.mark.parametrize("seed", range(6))
def test_random_point_robots_against_a_twin(seed: int) -> None:
    rng = np.random.default_rng(seed)
    robot = point_robot()
    wind = Wind(rng.uniform(5, 25), 1.2, direction=rng.normal(size=3))
    case = LoadCase(
        "any", wind=wind, ice=Ice(rng.uniform(0, 0.02)), dynamic_factor=rng.uniform(1, 1.5),
        acceleration_m_per_s2=rng.uniform(0.1, 1),
    )  # fmt: skip
    one = list(case.on(robot, ROPE))[int(rng.integers(14))]
    place = np.array([rng.uniform(15, 25), rng.uniform(8, 16), rng.uniform(2, 15)])
    check(one, place, np.eye(3))


@pytest.mark.parametrize("seed", range(4))
def test_random_bodies_against_a_twin(seed: int, six_cable_robot: Robot) -> None:
    rng = np.random.default_rng(seed)
    body = replace(
        six_cable_robot.platform,
        centre_of_mass_m=np.array([0.2, -0.1, -0.3]),
        wrench_N=rng.normal(scale=100.0, size=6),
        drag_area_m2=2.0,
        drag_centre_m=None if seed % 2 else rng.normal(size=3),
    )
    robot = replace(six_cable_robot, platform=body)
    cable = Cable(0.03, 4.0, 1e8, 4e5)
    wind = Wind(rng.uniform(3, 10), 1.1, direction=np.array([*rng.normal(size=2), 0.0]))
    case = LoadCase("any", wind=wind, acceleration_m_per_s2=0.2, dynamic_factor=1.2)
    one = list(case.on(robot, cable))[int(rng.integers(14))]
    turn = rng.normal(scale=0.02, size=3)
    check(one, np.array([*rng.uniform(-8, 8, 2), -80.0]), Rotation.from_rotvec(turn).as_matrix())


def check(one: Loaded, place: FloatArray, turn: FloatArray) -> None:
    """Tensions and lengths agree with the twin's, and our cables end where an ODE solver ends."""
    robot, cable = one.bare
    assert one.case.wind is not None
    twin = twin_of(robot, cable, one.case.wind)
    load = acting_of(twin, one)
    statics = solve_sagging(one.robot, Poses(place, turn), one.cable)
    assert statics.is_solved
    pull, length = held(twin, load, place, turn)
    np.testing.assert_allclose(statics.length_m, length, rtol=1e-9)
    np.testing.assert_allclose(statics.cable_tension_N, tensions_N(pull, length, load.q), rtol=1e-8)
    ours = pulls_N(statics)
    arms = statics.poses.attachment_points_m(robot)
    for k in range(robot.n_cables):
        end = integrated_end_m(ours[k], float(statics.length_m[k]), load.q, twin.stiffness_N)
        off = np.linalg.norm(arms[k] + end - robot.exit_points_m[k])
        assert off <= 1e-9 * float(statics.length_m[k])


def test_the_moment_of_the_weight_stays_under_a_tilted_cable_load(six_cable_robot: Robot) -> None:
    body = replace(six_cable_robot.platform, centre_of_mass_m=np.array([0.4, 0.3, 0.5]))
    straight = replace(six_cable_robot, platform=body)
    tilted = replace(straight, cable_load_direction=np.array([0.3, -0.2, -1.0]))
    turn = tilted.upright
    force, moment = turn.T @ tilted.pull_N[:3], turn.T @ tilted.pull_N[3:]
    np.testing.assert_allclose(force, straight.pull_N[:3], atol=1e-9)
    np.testing.assert_allclose(moment, straight.pull_N[3:], atol=1e-9)
    np.testing.assert_allclose(turn.T @ tilted.centre_pull_N, [0, 0, straight.weight_N], atol=1e-9)


def test_the_dynamic_factor_is_on_the_platform_alone() -> None:
    case = LoadCase("hoisting", dynamic_factor=1.3, wrench_N=np.array([0, 0, -100.0, 0, 0, 0]))
    (one,) = case.on(point_robot(), ROPE)
    assert one.robot.platform.mass_kg == pytest.approx(390.0)
    assert one.robot.platform.wrench_N[2] == pytest.approx(-130.0)
    assert one.cable is ROPE


def test_ice_adds_its_ring() -> None:
    (one,) = LoadCase("ice", ice=Ice(0.01, 900.0)).on(point_robot(), ROPE)
    ring = np.pi / 4 * (0.032**2 - 0.012**2) * 900.0
    assert one.cable.weight_N_per_m == pytest.approx(G * (0.5 + ring), rel=1e-12)


def test_any_direction_is_near_one_of_the_inertia_force() -> None:
    case = LoadCase("jerk", acceleration_m_per_s2=1.0)
    along = np.array([one.inertia for one in case.on(point_robot(), ROPE)])
    any_way = np.random.default_rng(0).normal(size=(10_000, 3))
    any_way /= np.linalg.norm(any_way, axis=1, keepdims=True)
    assert np.degrees(np.arccos((any_way @ along.T).max(axis=1).min())) < 37.0


@pytest.mark.parametrize("lost", [1, 2, 3])
def test_a_point_mass_swings_into_the_plane_of_two_cables(lost: int) -> None:
    robot, place = point_robot(), np.array([18.0, 11.0, 8.0])
    twin = twin_of(robot, ROPE, Wind(0.0, 0.0))
    load = acting(twin)
    _, length = held(twin, load, place, np.eye(3))
    loss = settle(robot, Poses.at(place[None]), ROPE, lost)
    assert loss.fate[0] == Fate.RESTS_ELSEWHERE
    others = np.delete(np.arange(3), lost - 1)
    there, _, pull = rest(
        twin, load, loss.rest.position_m[0] + 0.01, np.eye(3), length[others], others
    )
    np.testing.assert_allclose(loss.rest.position_m[0], there, rtol=1e-7, atol=1e-9)
    np.testing.assert_allclose(
        loss.tension_N[0, others], tensions_N(pull, length[others], load.q), rtol=1e-7
    )
    assert loss.tension_N[0, lost - 1] == 0.0


def test_wind_along_the_plane_of_a_planar_robot() -> None:
    exits = np.array([[0.0, 0, 10], [6, 8, 10]])
    robot = Robot(exits, Platform(100.0, drag_area_m2=0.5), is_planar=True)
    case = LoadCase("gust", wind=Wind(15.0, 1.2), acceleration_m_per_s2=0.3)
    each = list(case.on(robot, ROPE))
    assert len(each) == 2 * 8
    for one in each:
        assert one.wind is not None
        assert one.inertia is not None
        assert abs(one.wind @ [0.8, -0.6, 0.0]) < 1e-12
        assert abs(one.inertia @ [0.8, -0.6, 0.0]) < 1e-12
        statics = solve_sagging(one.robot, Poses.at([3.0, 4.0, 3.0]), one.cable)
        assert statics.is_solved
        drag = 0.5 * 1.25 * 15.0**2 * 0.5 * one.wind
        applied = drag + 100.0 * 0.3 * one.inertia + np.array([0, 0, -100.0 * G])
        np.testing.assert_allclose(pulls_N(statics).sum(axis=0) + applied, 0.0, atol=1e-8)


def test_a_frame_that_lies_on_its_side_makes_no_difference() -> None:
    turn = Rotation.from_rotvec([1.2, 0.3, -0.5]).as_matrix()
    along, place = np.array([0.6, -0.2, 0.1]), np.array([18.0, 11.0, 8.0])
    straight = point_robot()
    lying = replace(
        straight,
        exit_points_m=straight.exit_points_m @ turn.T,
        gravity_direction=turn @ [0.0, 0.0, -1.0],
    )
    tensions = []
    for robot, wind, where in ((straight, along, place), (lying, turn @ along, turn @ place)):
        case = LoadCase("gust", wind=Wind(18.0, 1.2, direction=wind), ice=Ice(0.004))
        (one,) = case.on(robot, ROPE)
        statics = solve_sagging(one.robot, Poses.at(where), one.cable)
        assert statics.is_solved
        tensions.append(statics.cable_tension_N)
    np.testing.assert_allclose(tensions[1], tensions[0], rtol=1e-9)
