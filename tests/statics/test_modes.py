"""Natural frequencies of the platform against finite elements of each cable, and closed forms."""

from __future__ import annotations

from dataclasses import replace

import finite_elements as fe
import numpy as np
import pytest
from redundant_robots import cogiro_poses
from sample_robots import COGIRO, ROPE, poses_under

from designer.arrays import frozen_array
from designer.model.cable import Cable
from designer.model.load_case import Ice, LoadCase, Wind
from designer.model.robot import Platform, Poses, Robot
from designer.physics.inertia import NEXT_TERM
from designer.statics.forward import solve_forward
from designer.statics.inverse import Statics, solve_sagging
from designer.statics.modes import lowest_bound_Hz, platform_frequencies_Hz, platform_modes
from designer.statics.shape import string_frequencies_Hz

DOWN = np.array([0.0, 0.0, -1.0])
INERTIA = frozen_array([[2.0e4, 1e3, 2e3], [1e3, 2.5e4, -1e3], [2e3, -1e3, 3.0e4]])


def with_inertia(robot: Robot, mass_kg: float, inertia: np.ndarray | None) -> Robot:
    body = replace(robot.platform, mass_kg=mass_kg, inertia_kg_m2=inertia)
    return replace(robot, platform=body)


def twin(at: Statics, density: float) -> tuple[np.ndarray, np.ndarray]:
    """Stiffness and mass of one equilibrium, of 40 elements a cable."""
    robot, turn = at.robot, at.poses.rotation
    body, n = robot.platform, robot.n_cables
    force = np.column_stack([at.force_x_N[:, None] * at.geometry().outward, at.force_z_N])
    EA, w = (np.broadcast_to(v, n) for v in (at.axial_stiffness_N, at.weight_N_per_m))
    ends = at.poses.attachment_points_m(robot)
    chains = [
        fe.Chain(
            robot.exit_points_m[k], ends[k], at.length_m[k], EA[k], density, w[k] * DOWN, force[k]
        )
        for k in range(n)
    ]
    inertia = np.zeros((3, 3)) if body.inertia_kg_m2 is None else body.inertia_kg_m2
    levers, arm = robot.attachments_m @ turn.T, turn @ body.centre_of_mass_m
    moving = fe.Body(
        body.mass_kg,
        turn @ inertia @ turn.T,
        arm,
        levers,
        robot.weight_N * DOWN,
        not robot.is_point_mass,
    )
    return fe.assembled(moving, chains)


@pytest.fixture
def machines(fast_robot, six_cable_robot) -> dict[str, tuple[Robot, Cable, Poses]]:
    six = with_inertia(six_cable_robot, 4000.0, INERTIA)
    stiff = with_inertia(COGIRO, 600.0, frozen_array(np.diag([150.0, 150.0, 220.0])))
    light = Cable(0.004, 0.02, 1.2e6, 5e3)
    return {
        "fast": (fast_robot, ROPE, poses_under(fast_robot, 8, 31)),
        "six": (six, ROPE, poses_under(six, 8, 32)),
        "cogiro": (stiff, light, cogiro_poses(8, 33)),
    }


@pytest.mark.parametrize("name", ["fast", "six", "cogiro"])
def test_against_finite_elements_that_follow_the_platform(machines, name: str) -> None:
    robot, cable, poses = machines[name]
    density = cable.linear_density_kg_per_m
    statics = solve_sagging(robot, poses, cable)
    ours = platform_frequencies_Hz(statics, robot.platform, density)
    assert np.isnan(ours[~statics.is_solved]).all()
    solved = np.flatnonzero(statics.is_solved)
    assert len(solved) >= 3
    for k in solved[:3]:
        at = statics.part(int(k))
        K, M = twin(at, density)
        alone = fe.condensed(K, M, robot.degrees_of_freedom)
        theirs, _ = fe.frequencies_Hz(*alone)
        assert np.allclose(ours[k], theirs, rtol=2e-3)
        modes = platform_modes(at, robot.platform, density)
        assert [mode.frequency_Hz for mode in modes] == pytest.approx(ours[k].tolist())
        width = robot.degrees_of_freedom
        for mode in modes:
            pushed, moved = alone[0] @ mode.shape[:width], alone[1] @ mode.shape[:width]
            size = np.abs(pushed).max()
            off = pushed - (2 * np.pi * mode.frequency_Hz) ** 2 * moved
            assert np.abs(off).max() < 0.01 * size
            assert 0.0 < mode.cable_share < 1.0


@pytest.mark.slow
def test_the_whole_system_to_one_per_cent_where_the_cables_are_fast(machines) -> None:
    """All nodes free: as told, our frequencies are too high by the estimate, to second order."""
    robot, cable, poses = machines["cogiro"]
    robot = with_inertia(robot, 6000.0, frozen_array(np.diag([1500.0, 1500.0, 2200.0])))
    cable = replace(cable, axial_stiffness_N=1.2e5, linear_density_kg_per_m=0.2)
    density = cable.linear_density_kg_per_m
    statics = solve_sagging(robot, poses, cable)
    compared = 0
    for k in np.flatnonzero(statics.is_solved)[:4]:
        at = statics.part(int(k))
        string = string_frequencies_Hz(at, density).min()
        full, shapes = fe.frequencies_Hz(*twin(at, density))
        for mode in platform_modes(at, robot.platform, density):
            if mode.frequency_Hz > 0.5 * string:
                continue
            nearest = full[np.abs(full - mode.frequency_Hz).argmin()]
            excess = mode.cable_share * NEXT_TERM * (mode.frequency_Hz / string) ** 2
            assert mode.frequency_Hz / nearest - 1.0 == pytest.approx(0.0, abs=0.01)
            assert mode.frequency_Hz / nearest - 1.0 < 2.0 * excess + 1e-3
            compared += 1
    assert compared >= 4
    assert shapes.shape[0] == len(full)


@pytest.mark.parametrize("name", ["fast", "six"])
def test_where_the_cables_are_slow_the_lowest_of_all_lies_between_the_bounds(
    machines, name
) -> None:
    robot, cable, poses = machines[name]
    density = cable.linear_density_kg_per_m
    statics = solve_sagging(robot, poses, cable)
    for k in np.flatnonzero(statics.is_solved)[:3]:
        at = statics.part(int(k))
        high = float(platform_frequencies_Hz(at, robot.platform, density).min())
        low = float(lowest_bound_Hz(at, high, density))
        full, _ = fe.frequencies_Hz(*twin(at, density))
        assert low < full[0] < high * 1.002
        assert low < 0.9 * high


def test_a_pendulum_and_a_rod_that_hangs_with_it() -> None:
    """A light cable: g/l. A heavy one that stays straight moves a third of its mass."""
    robot = Robot(frozen_array([[0.0, 0.0, 10.0]]), Platform(1e5))
    for density, share in ((1e-6, 0.0), (30.0, 80.0)):
        cable = Cable(0.05, density, 1e11, 1e9)
        at = solve_forward(robot, cable, np.array([8.0]), Poses.at([0.0, 0.0, 2.0])).statics
        swing = platform_frequencies_Hz(at, robot.platform, density)[0]
        expected = np.sqrt((1e5 + 1.5 * share) * 9.81 / (8.0 * (1e5 + share))) / (2 * np.pi)
        assert swing == pytest.approx(expected, rel=1e-5)


def test_in_a_plane_as_in_space() -> None:
    """A planar robot has the modes that the same in space has in its plane."""
    anchors = np.array([[-9.0, 0, 15], [9, 0, 15], [9, 0, 0], [-9, 0, 0]])
    holds = np.array([[-0.5, 0, 0.5], [0.5, 0, 0.5], [0.5, 0, -0.5], [-0.5, 0, -0.5]])
    inertia = frozen_array(np.diag([20.0, 30.0, 20.0]))
    body = Platform(120.0, frozen_array(holds), inertia_kg_m2=inertia)
    planar = Robot(frozen_array(anchors), body, is_planar=True, tension_min_N=200.0)
    cable = Cable(0.006, 0.15, 1e6, 2e4)
    at = solve_sagging(planar, Poses.at([1.0, 0.0, 7.0]), cable)
    assert at.is_solved
    K, M = twin(at, 0.15)
    rows = [0, 2, 4]
    alone = fe.condensed(*_along(K, M, rows), 3)
    theirs, _ = fe.frequencies_Hz(*alone)
    assert platform_frequencies_Hz(at, body, 0.15) == pytest.approx(theirs, rel=2e-3)
    for mode in platform_modes(at, body, 0.15):
        assert mode.shape[[1, 3, 5]] == pytest.approx(0.0, abs=1e-12)


def _along(K: np.ndarray, M: np.ndarray, rows: list[int]) -> tuple[np.ndarray, np.ndarray]:
    """Keep the platform's rows in the plane, and all inner nodes."""
    kept = [*rows, *range(6, len(K))]
    return K[np.ix_(kept, kept)], M[np.ix_(kept, kept)]


def test_what_of_a_load_case_moves(six_cable_robot) -> None:
    robot = with_inertia(six_cable_robot, 4000.0, INERTIA)
    wind = Wind(20.0, 1.2, direction=np.array([1.0, 0.0, 0.0]))
    case = LoadCase("storm", dynamic_factor=1.5, wind=wind, ice=Ice(0.01))
    robot = replace(robot, platform=replace(robot.platform, drag_area_m2=1.0))
    (loaded,) = case.on(robot, ROPE)
    assert loaded.moving_body.mass_kg == 4000.0
    assert loaded.robot.platform.mass_kg == 6000.0
    iced = ROPE.linear_density_kg_per_m + np.pi * 0.01 * 0.04 * 900.0
    assert loaded.moving_density_kg_per_m == pytest.approx(iced)
    assert loaded.cable.linear_density_kg_per_m > 1.01 * iced  # with the drag as if it were weight
    (other,) = LoadCase("empty", mass_kg=1000.0).on(robot, ROPE)
    assert other.moving_body.inertia_kg_m2 is None
    statics = solve_sagging(other.robot, poses_under(robot, 2, 4), ROPE)
    assert np.isnan(platform_frequencies_Hz(statics, other.moving_body, 3.5)).all()
    (told,) = LoadCase("empty", mass_kg=1000.0, inertia_kg_m2=INERTIA).on(robot, ROPE)
    assert told.moving_body.inertia_kg_m2 is INERTIA or told.moving_body.mass_kg == 1000.0
