"""Modes of platform and cables against finite elements, other programs and closed forms."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import finite_elements as fe
import numpy as np
import pytest
from redundant_robots import cogiro_poses
from sample_robots import COGIRO, ROPE, poses_under

import designer
from designer.arrays import frozen_array
from designer.io.config import read_study
from designer.model.cable import Cable
from designer.model.load_case import Ice, LoadCase, Wind
from designer.model.robot import Platform, Poses, Robot
from designer.statics.forward import solve_forward
from designer.statics.inverse import Statics, solve_sagging
from designer.statics.modes import (
    cable_frequencies_Hz,
    frequencies_Hz,
    platform_mass_matrix,
    platform_modes,
)
from designer.statics.stiffness import platform_stiffness

EXAMPLES = Path(designer.__file__).parent / "examples"
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


def coupled(at: Statics, density: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Frequencies, shapes of the platform and its shares of the energy, of 40 elements a cable."""
    K, M = twin(at, density)
    frequencies, shapes = fe.frequencies_Hz(K, M)
    own = shapes[: at.robot.degrees_of_freedom]
    mass = platform_mass_matrix(at, at.robot.platform)
    return frequencies, own, np.einsum("ik,ij,jk->k", own, mass, own)


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize("name", ["fast", "six", "cogiro"])
def test_coupled_modes_match_finite_elements(machines, name: str) -> None:
    robot, cable, poses = machines[name]
    density = cable.linear_density_kg_per_m
    statics = solve_sagging(robot, poses, cable)
    lowest = frequencies_Hz(statics, robot.platform, density)
    assert np.isnan(lowest[~statics.is_solved]).all()
    solved = np.flatnonzero(statics.is_solved)
    assert len(solved) >= 3
    for k in solved[:3]:
        at = statics.part(int(k))
        theirs, shapes, shares = coupled(at, density)
        modes = platform_modes(at, robot.platform, density)
        assert lowest[k] == pytest.approx(modes[0].frequency_Hz, rel=1e-3)
        ours = np.array([mode.frequency_Hz for mode in modes])
        for frequency in theirs[(shares > 0.08) & (theirs < 0.99 * ours[-1])]:
            assert np.abs(ours / frequency - 1.0).min() < 3e-3  # none is missed
        candidates = np.flatnonzero(shares > 0.03)
        for mode in modes:
            number = candidates[np.abs(theirs[candidates] - mode.frequency_Hz).argmin()]
            assert mode.frequency_Hz == pytest.approx(theirs[number], rel=3e-3)
            assert 1.0 - mode.cable_share == pytest.approx(shares[number], abs=0.03)
            along = mode.shape @ shapes[:, number]
            size = np.linalg.norm(mode.shape) * np.linalg.norm(shapes[:, number])
            assert abs(along) > 0.98 * size


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize("name", ["fast", "six", "cogiro"])
def test_no_mode_in_a_band_is_missed(machines, name: str) -> None:
    """Of platform and cables, overtones among them: deepest in bands all over the spectrum."""
    robot, cable, poses = machines[name]
    density = cable.linear_density_kg_per_m
    statics = solve_sagging(robot, poses, cable)
    at = statics.part(int(np.flatnonzero(statics.is_solved)[0]))
    theirs, _, shares = coupled(at, density)
    for low in np.geomspace(0.5 * theirs[0], theirs[15], 7):
        band = (float(low), 1.1 * float(low))
        middle = np.sqrt(band[0] * band[1])
        ours = frequencies_Hz(at, robot.platform, density, middle, of_platform=False)
        apart = np.abs(np.log(theirs / middle))
        assert abs(np.log(ours / middle)) == pytest.approx(apart.min(), abs=5e-3)
        ours = abs(np.log(frequencies_Hz(at, robot.platform, density, middle) / middle))
        assert np.abs(ours - apart[shares > 0.03]).min() < 5e-3
        assert ours < apart[shares > 0.08].min() + 5e-3


def test_cables_alone_where_the_inertia_is_not_known(machines) -> None:
    robot, cable, poses = machines["six"]
    density = cable.linear_density_kg_per_m
    statics = solve_sagging(robot, poses, cable)
    at = statics.part(int(np.flatnonzero(statics.is_solved)[0]))
    body = replace(robot.platform, inertia_kg_m2=None)
    each = cable_frequencies_Hz(at, density)
    K, M = twin(at, density)
    held, _ = fe.frequencies_Hz(K[6:, 6:], M[6:, 6:])
    assert each.min() == pytest.approx(held[0], rel=3e-3)
    ours = frequencies_Hz(at, body, density, held[0], of_platform=False)
    assert ours == pytest.approx(held[0], rel=3e-3)
    assert np.isnan(frequencies_Hz(at, body, density))
    assert np.isnan(frequencies_Hz(at, body, density, 0.1))


def test_following_cables_match_condensed_finite_elements(machines) -> None:
    for robot, cable, poses in machines.values():
        density = cable.linear_density_kg_per_m
        statics = solve_sagging(robot, poses, cable)
        rough = frequencies_Hz(statics, robot.platform, density, near=0.0)
        k = int(np.flatnonzero(statics.is_solved)[0])
        alone = fe.condensed(*twin(statics.part(k), density), robot.degrees_of_freedom)
        assert rough[k] == pytest.approx(fe.frequencies_Hz(*alone)[0][0], rel=2e-3)


def test_fast_as_built_matches_moordyn() -> None:
    """A free swing of 200 s in MoorDyn 2.7.2, 20 segments a line: one peak in x-z, two in y."""
    study = read_study(EXAMPLES / "fast-as-built.yaml")
    cable = Cable(0.046, 8.65444, 1.01376e8, 2.95e5)
    pose = Poses.at([103.0, 0.0, 177.56], [0.0, -0.24472763, 0.0])
    at = solve_sagging(study.robot, pose, cable)
    modes = platform_modes(at, study.robot.platform, cable.linear_density_kg_per_m)
    assert modes[0].frequency_Hz == pytest.approx(0.171, rel=0.01)
    assert abs(modes[0].shape[1]) < 1e-6
    aside = [m.frequency_Hz for m in modes if abs(m.shape[1]) > np.abs(m.shape[[0, 2]]).max()]
    assert aside[:2] == pytest.approx([0.211, 0.265], rel=0.01)


def test_a_stiff_platform_is_told_from_slow_cables() -> None:
    """Many modes of light cables lie below its own, which is that of a mass on springs."""
    corners = np.array([[x, y, z] for x in (-9.0, 9.0) for y in (-7.0, 7.0) for z in (0.0, 8.0)])
    robot = Robot(frozen_array(corners), Platform(3.0), tension_min_N=60.0)
    at = solve_sagging(robot, Poses.at([0.4, 0.3, 4.2]), Cable(0.006, 0.002, 3e5, 2e4))
    softest = np.linalg.eigvalsh(platform_stiffness(at))[0]
    expected = np.sqrt(softest / 3.0) / (2.0 * np.pi)
    slowest = float(cable_frequencies_Hz(at, 0.002).min())
    assert slowest < 0.7 * expected
    lowest = float(frequencies_Hz(at, robot.platform, 0.002))
    assert lowest == pytest.approx(expected, rel=0.03)
    middle = 0.5 * (slowest + lowest)
    every = float(frequencies_Hz(at, robot.platform, 0.002, middle, of_platform=False))
    assert 0.9 * slowest < every < 0.99 * lowest
    own = frequencies_Hz(at, robot.platform, 0.002, middle)
    assert own == pytest.approx(lowest, rel=1e-3)


def test_a_pendulum_and_a_rod_that_hangs_with_it() -> None:
    """A light cable: g/l. A heavy one that stays straight moves a third of its mass."""
    robot = Robot(frozen_array([[0.0, 0.0, 10.0]]), Platform(1e5))
    for density, share in ((1e-6, 0.0), (30.0, 80.0)):
        cable = Cable(0.05, density, 1e11, 1e9)
        at = solve_forward(robot, cable, np.array([8.0]), Poses.at([0.0, 0.0, 2.0])).statics
        swing = frequencies_Hz(at, robot.platform, density)
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
    modes = platform_modes(at, body, 0.15)
    theirs, _ = fe.frequencies_Hz(*_along(*twin(at, 0.15), [0, 2, 4]))
    for mode in modes:
        assert mode.shape[[1, 3, 5]] == pytest.approx(0.0, abs=1e-12)
        assert np.abs(theirs / mode.frequency_Hz - 1.0).min() < 2e-3


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
    assert np.isnan(frequencies_Hz(statics, other.moving_body, 3.5)).all()
    (told,) = LoadCase("empty", mass_kg=1000.0, inertia_kg_m2=INERTIA).on(robot, ROPE)
    assert told.moving_body.inertia_kg_m2 is INERTIA or told.moving_body.mass_kg == 1000.0
