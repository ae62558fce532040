"""Pulleys stay upright in wind: against a solver in world axes, and differences of states."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import nnls
from scipy.spatial.transform import Rotation
from twins.loaded import Twin, acting, held_over_pulleys, tensions_N
from twins.thinnest import least_utilisation

from designer.analysis.maps import cable_curves_m
from designer.arrays import FloatArray
from designer.model.cable import STANDARD_GRAVITY_M_PER_S2, Cable, Material
from designer.model.load_case import LoadCase, Loaded, Wind
from designer.model.robot import Platform, Poses, Robot
from designer.model.verdict import Verdict
from designer.statics.fixed_length import cables_of_length
from designer.statics.geometry import plane_vector
from designer.statics.inverse import Statics, solve_massless, solve_sagging
from designer.statics.pulleys import straight_run
from designer.statics.stiffness import platform_stiffness

ROPE = Cable(0.012, 0.5, 6e6, 30e3)
THICK = Cable(0.03, 4.0, 1e8, 4e5)


def three_ropes(rng: np.random.Generator) -> tuple[Robot, Cable, FloatArray]:
    exits = np.array([[0.0, 0, 18], [20, 0, 19], [9, 17, 17]]) + rng.normal(scale=0.5, size=(3, 3))
    robot = Robot(exits, Platform(80.0, drag_area_m2=0.3), pulley_radius_m=rng.uniform(0.05, 0.5))
    return robot, ROPE, np.array([*rng.uniform([7, 3], [13, 9]), rng.uniform(4, 12), 0, 0, 0])


def six_ropes(rng: np.random.Generator) -> tuple[Robot, Cable, FloatArray]:
    corners = np.repeat(np.array([[0.0, 0, 0], [60, 0, 0], [30, 52, 0]]), 2, axis=0)
    turn = np.array([[-2, -1, 0], [2, -1, 0], [2, -1, 0], [0, 2, 0], [0, 2, 0], [-2.0, -1, 0]])
    body = Platform(4000.0, turn + rng.normal(0.0, 0.2, (6, 3)), rng.normal(0.0, 0.2, 3))
    exits, radius = corners + rng.normal(0.0, 3.0, (6, 3)), rng.uniform(0.05, 0.5)
    place = np.array([*rng.uniform([20, 10], [40, 30]), rng.uniform(-40, -15)])
    return (
        Robot(exits, body, pulley_radius_m=radius),
        THICK,
        np.concatenate([place, rng.normal(0.0, 0.03, 3)]),
    )


def in_wind(robot: Robot, cable: Cable, rng: np.random.Generator) -> Loaded:
    wind = Wind(rng.uniform(5, 25), 1.2, direction=np.array([*rng.normal(size=2), 0.0]))
    (one,) = LoadCase("gust", wind=wind).on(robot, cable)
    return one


def points_m(statics: Statics) -> FloatArray:
    """Where the cables leave their pulleys, base frame."""
    return np.asarray(statics.run.exit_points_m @ statics.robot.upright)


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize(
    ("make", "count"),
    [(three_ropes, 30), (six_ropes, 15), (three_ropes, 120), (six_ropes, 80)],
)
def test_random_poses_against_a_solver_in_world_axes(make, count: int) -> None:
    rng, compared = np.random.default_rng(3), 0
    while compared < count:
        robot, cable, place = make(rng)
        one = in_wind(robot, cable, rng)
        turn = Rotation.from_rotvec(place[3:]).as_matrix()
        pose = Poses(place[None, :3], turn[None])
        if not solve_massless(one.robot, pose).tension_N.min() > 100.0:  # straight cables slacken
            continue
        body, wind = robot.platform, one.case.wind
        twin = Twin(
            robot.exit_points_m, body.mass_kg, cable.axial_stiffness_N,
            cable.linear_density_kg_per_m, cable.diameter_m, body.attachments_m,
            body.centre_of_mass_m, drag_area_m2=body.drag_area_m2 or 0.0, cable_drag=1.2,
            pulley_radius_m=robot.pulley_radius_m,
        )  # fmt: skip
        load = acting(twin, wind=wind.speed_m_per_s * one.wind)
        statics = solve_sagging(one.robot, Poses(place[:3], turn), one.cable)
        assert statics.is_solved
        if statics.length_over_chord.max() > 1.5:  # hangs farther than the quadrature can follow
            continue
        pull, free, points = held_over_pulleys(twin, load, place[:3], turn)
        np.testing.assert_allclose(points_m(statics), points, rtol=1e-9, atol=1e-8)
        np.testing.assert_allclose(statics.free_length_m, free, rtol=1e-9)
        expected = tensions_N(pull, free, load.q)
        np.testing.assert_allclose(statics.cable_tension_N, expected, rtol=1e-9)
        compared += 1


def loaded_pose(seed: int) -> tuple[Robot, Cable, Poses]:
    rng = np.random.default_rng(seed)
    robot, cable, place = three_ropes(rng)
    one = in_wind(robot, cable, rng)
    return one.robot, one.cable, Poses.at(place[None, :3])


@pytest.mark.parametrize("seed", range(3))
def test_stiffness_is_the_slope_of_the_force_at_kept_lengths(seed: int) -> None:
    robot, cable, pose = loaded_pose(seed)
    statics = solve_sagging(robot, pose, cable)
    cables = cable.axial_stiffness_N * np.ones(1), cable.weight_N_per_m * np.ones(1)

    def push_N(by: FloatArray) -> FloatArray:
        moved = Poses.at(pose.position_m[0] + by)
        there = cables_of_length(robot, moved, statics.length_m[0], *cables)
        force = plane_vector(there.force_x_N, there.force_z_N, there.geometry().outward)
        return np.asarray(force.sum(axis=0) @ robot.upright)

    def slope(along: FloatArray) -> FloatArray:
        near, far = (push_N(s * along) - push_N(-s * along) for s in (1e-5, 2e-5))
        return (8.0 * near - far) / 12e-5

    ours = platform_stiffness(statics)[0]
    theirs = np.column_stack([slope(axis) for axis in np.eye(3)])
    np.testing.assert_allclose(ours, theirs, atol=1e-8 * np.abs(ours).max())


def test_lowest_point_is_that_of_the_drawn_cable() -> None:
    robot = Robot(
        np.array([[0.0, 0, 6], [40, 0, 7], [18, 35, 6]]), Platform(30.0, drag_area_m2=0.1),
        pulley_radius_m=0.2,
    )  # fmt: skip
    heavy = Cable(0.02, 1.5, 2e7, 1e5)
    wind = Wind(12.0, 1.2, direction=np.array([1.0, 0.5, 0.0]))
    (one,) = LoadCase("gust", wind=wind).on(robot, heavy)
    pose = Poses.at([18.0, 9.0, 5.0])
    statics = solve_sagging(one.robot, pose, one.cable)
    drawn = cable_curves_m(statics, 4001)
    lowest = drawn[..., 2].min(axis=1)
    assert (lowest < 4.995).any()
    np.testing.assert_allclose(statics.lowest_m, lowest, atol=1e-4)
    np.testing.assert_allclose(drawn[:, -1], np.broadcast_to(pose.position_m, (3, 3)), atol=1e-9)


def _held_by_any_point(robot: Robot, place_m: FloatArray) -> bool:
    """Tell whether pulls toward any points of pulleys, and along the load, hold the platform."""
    toward = (place_m - robot.exit_points_m) * [1.0, 1.0, 0.0]
    toward /= np.linalg.norm(toward, axis=1)[:, None]
    angle = np.linspace(0.0, 2.0 * np.pi, 60)[:, None, None]
    spoke = np.cos(angle) * toward + np.sin(angle) * [0.0, 0.0, 1.0]
    points = robot.exit_points_m + robot.pulley_radius_m * (toward + spoke)
    rays = np.vstack([(points - place_m).reshape(-1, 3), robot.cable_load_direction])
    pull = robot.pull_N[:3] @ robot.upright
    return nnls(rays.T, pull)[1] < 1e-9 * np.linalg.norm(pull)


def _is_held_by_taut_cables(loaded: Loaded, place_m: FloatArray) -> bool:
    """Tell whether another solver finds an equilibrium that keeps the sag."""
    robot, cable = loaded.robot, loaded.cable
    weight_N_per_m = float(np.max(cable.weight_N_per_m))
    strength_m = float(np.max(cable.allowable_tension_N)) / weight_N_per_m
    stiffness_m = float(np.max(cable.axial_stiffness_N)) / weight_N_per_m
    density = 1e3
    stress = STANDARD_GRAVITY_M_PER_S2 * density
    rope = Material(density, stress * stiffness_m, stress * strength_m)
    exits = straight_run(robot, Poses.at(place_m)).exit_points_m @ robot.upright
    rng = np.random.default_rng(1)
    asked = robot, place_m, np.zeros(3), rope, weight_N_per_m, rng, 6, exits
    return bool(np.isfinite(least_utilisation(*asked, is_taut=True)[0]))


@pytest.mark.slow
def test_nothing_is_proved_of_poses_that_cables_over_upright_pulleys_hold() -> None:
    """What is refused no cables hold, or slack ones alone, as another solver has it."""
    rng, proved, slack, taut = np.random.default_rng(8), 0, 0, 0
    for _ in range(20):
        robot, cable, _ = three_ropes(rng)
        loaded = in_wind(replace(robot, pulley_radius_m=2.0), cable, rng)
        places = rng.uniform([-8, -8, -5], [28, 25, 24], (10, 3))
        statics = solve_sagging(loaded.robot, Poses.at(places), loaded.cable)
        refused = places[statics.verdict == Verdict.OUTSIDE_HULL]
        by_slack = [place for place in refused if _held_by_any_point(loaded.robot, place)]
        proved, slack = proved + len(refused), slack + len(by_slack)
        assert not any(_is_held_by_taut_cables(loaded, place) for place in by_slack)
        is_taut = statics.is_solved & (statics.length_over_chord.max(axis=-1) < 1.02)
        taut += _is_held_by_taut_cables(loaded, places[is_taut][0]) if is_taut.any() else 0
    assert proved > 30
    assert slack > 3
    assert taut > 5
