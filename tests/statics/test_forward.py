"""Forward statics: round trips, a published reference case, stability, slack cables, failures."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from sample_robots import COGIRO, COGIRO_CABLE, ROPE, poses_under
from scipy.spatial.transform import Rotation

from designer.arrays import frozen_array
from designer.model.cable import Cable, Cables, Material
from designer.model.robot import Platform, Poses, Robot
from designer.model.verdict import Verdict
from designer.statics.fixed_length import cables_of_length
from designer.statics.forward import ForwardStatics, solve_forward
from designer.statics.inverse import solve_sagging
from designer.statics.rest import find_equilibria, spread_poses

COGIRO_LENGTHS_M = np.array(
    [9.69426, 9.3803, 9.73006, 9.40211, 9.71528, 10.00552, 9.74173, 10.01977]
)


def nudged(poses: Poses, size_m: float, seed: int) -> Poses:
    rng = np.random.default_rng(seed)
    return Poses(poses.position_m + rng.normal(0.0, size_m, poses.position_m.shape), poses.rotation)


def test_eight_cables_on_six_degrees_of_freedom() -> None:
    """Numbers that two independent codes agree on, for this cable and no pulleys."""
    found = solve_forward(COGIRO, COGIRO_CABLE, COGIRO_LENGTHS_M, Poses.at([0, 0, 1.0], [0, 0, 0]))
    assert found.statics.is_solved
    assert found.is_stable
    pose = found.poses
    assert np.allclose(
        pose.position_m, [1.100564e-2, -1.002498e-2, 1.317075894], rtol=1e-5, atol=1e-9
    )
    # Turns about the fixed axes x, y, z in turn, to the digits that are given.
    turns = Rotation.from_matrix(pose.rotation).as_euler("xyz")
    assert np.abs(turns - [1.7486e-4, -2.0186e-4, -6.478e-5]).max() < 5e-9
    tensions = [311.711, 330.697, 327.472, 306.706, 325.902, 305.030, 306.584, 326.948]
    assert np.allclose(found.statics.exit_tension_N, tensions, rtol=1e-5)
    assert np.abs(found.statics.equilibrium_residual_N()).max() < 1e-8 * 311.0
    assert found.statics.closure_residual_m().max() < 1e-12


AS_BUILT = {"pulley_radius_m": 0.8, "tilt_rad": frozen_array([0.02, -0.03])}


@pytest.mark.slow
@pytest.mark.parametrize("as_built", [{}, AS_BUILT], ids=["plain", "pulleys, tilt, force"])
@pytest.mark.parametrize("name", ["fast_robot", "six_cable_robot"])
def test_round_trip_with_inverse_statics(request, steel: Material, name: str, as_built) -> None:
    robot = replace(request.getfixturevalue(name), **as_built)
    poses = poses_under(robot, 100, 1)
    force = np.random.default_rng(2).normal(0.0, 1000.0, (100, 3)) if as_built else None
    inverse = solve_sagging(robot, poses, steel.cable(0.03), force)
    solved = inverse.is_solved
    assert solved.mean() > 0.9
    found = solve_forward(
        robot,
        steel.cable(0.03),
        inverse.length_m[solved],
        nudged(poses, 1.0, 3).part(solved),
        None if force is None else force[solved],
    )
    assert found.statics.is_solved.all()
    assert found.is_stable.all()
    position, rotation = found.poses.position_m, found.poses.rotation
    assert np.abs(position - poses.position_m[solved]).max() < 1e-9
    if not robot.is_point_mass:
        assert np.abs(rotation - poses.rotation[solved]).max() < 1e-9
    ratio = found.statics.exit_tension_N / inverse.exit_tension_N[solved]
    assert np.abs(ratio - 1.0).max() < 1e-9


def test_cables_that_differ(six_cable_robot) -> None:
    cables = Cables(tuple(replace(ROPE, axial_stiffness_N=5e7 * (1 + k)) for k in range(6)))
    poses = poses_under(six_cable_robot, 10, 4)
    inverse = solve_sagging(six_cable_robot, poses, cables)
    solved = inverse.is_solved
    start = nudged(poses, 0.5, 5).part(solved)
    found = solve_forward(six_cable_robot, cables, inverse.length_m[solved], start)
    assert solved.sum() >= 8
    assert np.abs(found.poses.position_m - poses.position_m[solved]).max() < 1e-9


@pytest.mark.parametrize("name", ["fast_robot", "six_cable_robot"])
def test_from_its_own_answer_it_comes_no_farther_from_balance(request, name: str) -> None:
    robot = request.getfixturevalue(name)
    length = solve_sagging(robot, poses_under(robot, 40, 8), ROPE).length_m
    length = length[np.isfinite(length).all(axis=1)]
    assert len(length) > 20
    start = solve_forward(robot, ROPE, length, nudged(poses_under(robot, 1, 8), 1.0, 9))
    again = solve_forward(robot, ROPE, length, start.poses)

    def imbalance_N(found: ForwardStatics) -> np.ndarray:
        return np.linalg.norm(found.statics.equilibrium_residual_N()[:, :3], axis=1)

    held = start.statics.is_solved
    assert held.any()
    # Each is at rest but for rounding, and stays there.
    assert imbalance_N(again)[held].max() <= 2.0 * imbalance_N(start)[held].max()


def test_batch_equals_loop_on_any_leading_axes() -> None:
    starts = spread_poses(COGIRO, 6)
    lengths = COGIRO_LENGTHS_M * np.array([[1.0], [1.001]])[:, None]
    batch = solve_forward(COGIRO, COGIRO_CABLE, lengths, starts)
    assert batch.verdict.shape == (2, 6)
    for i in range(2):
        for k in range(6):
            start = Poses(starts.position_m[k], starts.rotation[k])
            one = solve_forward(COGIRO, COGIRO_CABLE, lengths[i, 0], start)
            assert one.verdict == batch.verdict[i, k]
            assert np.allclose(one.poses.position_m, batch.poses.position_m[i, k], atol=1e-9)


def test_a_slack_cable_hangs_and_the_others_carry() -> None:
    """The fourth cable is far too long; three carry the load, plus what it weighs at their end."""
    exits = [[0, 0, 0], [100, 0, 0], [50, 80, 0], [50, 30, 5]]
    robot = Robot(frozen_array(exits), Platform(500.0))
    three = Robot(frozen_array(exits[:3]), Platform(500.0))
    rope = Cable(0.01, 0.4, 5e6, 1e5)
    pose = Poses.at([50.0, 30.0, -20.0])
    lengths = solve_sagging(three, pose, rope).length_m
    found = solve_forward(robot, rope, np.append(lengths, 60.0), pose)
    assert found.is_stable
    assert found.statics.exit_tension_N[3] < 60.0 * rope.weight_N_per_m
    assert found.statics.force_z_N[3] > 0.0  # it hangs below the platform, which holds it up
    drop = pose.position_m[2] - found.poses.position_m[2]
    assert 0.0 < drop < 1.0


def test_fewer_cables_than_degrees_of_freedom(six_cable_robot) -> None:
    """A platform on two cables hangs with its centre of mass in their vertical plane."""
    body = Platform(
        1000.0, frozen_array([[1.0, 0, 0.5], [-1.0, 0, 0.5]]), frozen_array([0, 0, -0.3])
    )
    robot = Robot(frozen_array([[0.0, 0, 20], [30.0, 0, 20]]), body)
    start = Poses.at([12.0, 2.0, 2.0], [0.2, 0.1, 2.9])
    found = solve_forward(robot, ROPE, np.array([20.0, 22.0]), start)
    assert found.is_stable
    centre = found.poses.position_m + found.poses.rotation @ body.centre_of_mass_m
    assert centre[1] == pytest.approx(0.0, abs=1e-8)
    assert np.allclose(found.poses.rotation[1, [0, 2]], 0.0, atol=1e-8)


def test_an_unstable_balance_is_told_and_left_at_the_least_disturbance() -> None:
    """A body on two cables with its centre of mass above them, like a pendulum upside down."""
    body = Platform(
        1000.0, frozen_array([[1.0, 0, 0.5], [-1.0, 0, 0.5]]), frozen_array([0, 0, 0.8])
    )
    robot = Robot(frozen_array([[15.0, 0, 20], [-15.0, 0, 20]]), body)
    lengths = np.array([20.0, 20.0])
    upright = solve_forward(robot, ROPE, lengths, Poses.at([0, 0, 5.0], [0, 0, 0]))
    assert upright.statics.is_solved
    assert not upright.is_stable
    assert upright.poses.rotation[2, 2] == pytest.approx(1.0)
    disturbed = solve_forward(robot, ROPE, lengths, Poses.at([0, 0, 5.0], [0.001, 0, 0]))
    assert disturbed.is_stable
    assert disturbed.poses.rotation[2, 2] == pytest.approx(-1.0)


def test_several_equilibria_are_found_and_told_apart() -> None:
    starts = spread_poses(COGIRO, 40, largest_turn_rad=0.8)
    found = find_equilibria(COGIRO, COGIRO_CABLE, COGIRO_LENGTHS_M, starts)
    assert found.n_stable > 1
    assert found.n_stable == len(set(found.which[found.found.is_stable]))
    position = found.found.poses.position_m
    for number in set(found.which) - {-1}:
        same = position[found.which == number]
        assert np.abs(same - same[0]).max() < 1e-4
    home = np.abs(position - [1.100564e-2, -1.002498e-2, 1.317076]).max(axis=-1) < 1e-5
    assert len(set(found.which[home])) == 1


def test_three_cables_have_one_place_to_rest(fast_robot, steel) -> None:
    lengths = solve_sagging(
        fast_robot, Poses.at([[250.0, 200, -50], [200, 100, -90]]), steel.cable(0.03)
    ).length_m
    found = find_equilibria(fast_robot, steel.cable(0.03), lengths, spread_poses(fast_robot, 12))
    assert list(found.n_stable) == [1, 1]
    assert found.found.is_stable[:, 0].all()
    assert set(found.which[found.found.is_stable]) == {0}


def unsolved(found: ForwardStatics) -> bool:
    nothing = np.isnan(found.poses.position_m).all() and np.isnan(found.statics.length_m).all()
    return bool(found.verdict == Verdict.NOT_CONVERGED and not found.is_stable and nothing)


def test_what_cannot_be_solved_says_so_and_carries_no_number(fast_robot) -> None:
    inextensible = replace(ROPE, axial_stiffness_N=np.inf)
    too_short = solve_forward(
        fast_robot, inextensible, np.array([10.0, 10.0, 10.0]), Poses.at([250.0, 150, -50])
    )
    assert unsolved(too_short)
    pulleys = replace(fast_robot, pulley_radius_m=0.5)
    wound_up = solve_forward(pulleys, ROPE, np.array([0.1, 300, 300]), Poses.at([250.0, 150, -50]))
    assert unsolved(wound_up)


def test_forces_of_fixed_lengths_are_those_of_inverse_statics(six_cable_robot) -> None:
    robot = replace(six_cable_robot, **AS_BUILT)
    poses = poses_under(robot, 30, 6)
    inverse = solve_sagging(robot, poses, ROPE)
    solved = inverse.is_solved
    again = cables_of_length(
        robot,
        poses.part(solved),
        inverse.length_m[solved],
        inverse.axial_stiffness_N[solved],
        inverse.weight_N_per_m[solved],
    )
    scale = inverse.largest_tension_N[solved][:, None]
    assert np.abs(again.force_x_N - inverse.force_x_N[solved]).max() < 1e-7 * scale.max()
    assert np.abs(again.run.wrap_m - inverse.run.wrap_m[solved]).max() < 1e-9
