"""Robots whose cables differ, against quadrature of the cable equation in space."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from twins import physics
from twins.robots import FAST3, HALL6, TwinRobot

from designer.arrays import FloatArray, frozen_array
from designer.effects.design import AsBuilt
from designer.model.cable import Cable, Cables, Material, MaterialsByPose
from designer.model.robot import Platform, Poses, Robot
from designer.sizing.newton import size_poses
from designer.statics.inverse import solve_sagging

PULLEYS_M = [0.0, 0.4]
MACHINES = [FAST3, HALL6]
HEAVIER = np.array([1.0, 1.7, 0.4, 2.5, 0.7, 1.2])
STIFFER = np.array([1.3, 0.2, 0.9, 1.0, 4.0, 0.6])


def ours(twin: TwinRobot, pulley_radius_m: float = 0.0) -> Robot:
    attachments = frozen_array(twin.attachment_m) if twin.attachment_m else None
    platform = Platform(twin.mass_kg, attachments)
    return Robot(frozen_array(twin.exit_m), platform, pulley_radius_m)


def mixed(twin: TwinRobot) -> Cables:
    n = twin.cables
    return Cables(
        tuple(
            Cable(0.02, twin.linear_mass * heavier, twin.stiffness_N * stiffer, 1e6 * (1 + k))
            for k, (heavier, stiffer) in enumerate(zip(HEAVIER[:n], STIFFER[:n], strict=True))
        )
    )


def poses(twin: TwinRobot, count: int = 60) -> tuple[FloatArray, Poses]:
    rng = np.random.default_rng(5)
    low, high = np.array(twin.box_m, dtype=float).T
    position = rng.uniform(low, high, (count, 3))
    turn = twin.turn_rad * rng.normal(size=(count, 3))
    return position, Poses.at(position, turn if twin.attachment_m else None)


def by_quadrature(
    twin: TwinRobot, cables: Cables, position: FloatArray, at: Poses, pulley_radius_m: float
) -> physics.Equilibrium:
    machine = replace(
        twin.machine(),
        linear_mass=cables.linear_density_kg_per_m[None],
        stiffness_N=cables.axial_stiffness_N[None],
        pulley_radius_m=pulley_radius_m,
    )
    rotation = np.broadcast_to(at.rotation, (len(position), 3, 3))
    return physics.solve(machine, position, rotation)


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize("pulley_radius_m", PULLEYS_M)
@pytest.mark.parametrize("twin", MACHINES, ids=lambda twin: twin.name)
def test_lengths_and_tensions_are_those_of_other_physics(twin, pulley_radius_m) -> None:
    cables = mixed(twin)
    position, at = poses(twin)
    statics = solve_sagging(ours(twin, pulley_radius_m), at, cables)
    truth = by_quadrature(twin, cables, position, at, pulley_radius_m)
    assert statics.is_solved.all()
    assert np.allclose(statics.length_m, truth.length_m, rtol=1e-9, atol=0)
    assert np.allclose(statics.exit_tension_N, truth.exit_tension_N, rtol=1e-7, atol=0)
    at_platform = np.linalg.norm(truth.platform_pull_N, axis=-1)
    assert np.allclose(statics.platform_tension_N, at_platform, rtol=1e-7, atol=0)
    assert np.array_equal(statics.cable_tension_N.max(axis=-1), statics.largest_tension_N)


@pytest.mark.parametrize("twin", MACHINES, ids=lambda twin: twin.name)
def test_residuals_by_the_papers_equations(twin) -> None:
    statics = solve_sagging(ours(twin), poses(twin)[1], mixed(twin))
    closure = statics.closure_residual_m() / statics.length_m
    balance = np.abs(statics.equilibrium_residual_N()).max(axis=1)
    assert closure.max() < 1e-9
    assert (balance / statics.largest_tension_N).max() < 1e-9


def test_residuals_tell_when_cables_are_confused() -> None:
    """The residuals above are no tautology: another order of the cables breaks them."""
    statics = solve_sagging(ours(FAST3), poses(FAST3)[1], mixed(FAST3))
    turned = replace(statics, weight_N_per_m=np.roll(statics.weight_N_per_m, 1, axis=-1))
    assert turned.closure_residual_m().max() > 1e-2


@pytest.mark.parametrize("twin", MACHINES, ids=lambda twin: twin.name)
def test_equal_cables_are_the_single_cable(twin) -> None:
    cable = Cable(0.02, twin.linear_mass, twin.stiffness_N, 1e5)
    at = poses(twin)[1]
    one = solve_sagging(ours(twin), at, cable)
    each = solve_sagging(ours(twin), at, Cables((cable,) * twin.cables))
    assert np.array_equal(one.length_m, each.length_m)
    assert np.array_equal(one.exit_tension_N, each.exit_tension_N)


def test_renaming_the_cables_renames_the_answer() -> None:
    order = [2, 0, 1]
    robot, cables, at = ours(FAST3), mixed(FAST3), poses(FAST3)[1]
    renamed = replace(robot, exit_points_m=robot.exit_points_m[order])
    before = solve_sagging(robot, at, cables)
    after = solve_sagging(renamed, at, Cables(tuple(cables.each[k] for k in order)))
    assert np.allclose(after.length_m, before.length_m[:, order], rtol=1e-11, atol=0)


def test_any_leading_axes() -> None:
    at = poses(FAST3, 12)[1]
    flat = solve_sagging(ours(FAST3), at, mixed(FAST3))
    grid = solve_sagging(ours(FAST3), Poses.at(at.position_m.reshape(3, 4, 3)), mixed(FAST3))
    assert grid.cable_tension_N.shape == (3, 4, 3)
    assert np.array_equal(grid.cable_tension_N.reshape(-1, 3), flat.cable_tension_N)


def test_unsolved_poses_carry_no_number() -> None:
    outside = solve_sagging(ours(FAST3), Poses.at([[-50.0, 100.0, -50.0]]), mixed(FAST3))
    assert not outside.is_solved.any()
    assert np.isnan(outside.axial_stiffness_N).all()
    assert np.isnan(outside.cable_tension_N).all()


def changed_by(mass: float, stiffness: float) -> Callable[[Cable], Cable]:
    return lambda cable: replace(
        cable,
        linear_density_kg_per_m=mass * cable.linear_density_kg_per_m,
        axial_stiffness_N=stiffness * cable.axial_stiffness_N,
    )


def test_the_machine_as_built_changes_each_cable() -> None:
    built = AsBuilt(ours(FAST3), changed_by(1.2, 0.5))
    cables = mixed(FAST3)
    changed = Cables(tuple(built.cable(cable) for cable in cables.each))
    expected = 1.2 * cables.linear_density_kg_per_m
    assert np.allclose(changed.linear_density_kg_per_m, expected, rtol=1e-15)
    assert np.allclose(changed.axial_stiffness_N, 0.5 * cables.axial_stiffness_N, rtol=1e-15)
    assert np.array_equal(changed.allowable_tension_N, cables.allowable_tension_N)


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize("pulley_radius_m", PULLEYS_M)
@pytest.mark.parametrize("twin", MACHINES, ids=lambda twin: twin.name)
def test_cables_that_differ_from_pose_to_pose_are_each_solved_with_their_own(
    twin: TwinRobot, pulley_radius_m: float
) -> None:
    robot, (_, at) = ours(twin, pulley_radius_m), poses(twin, 30)
    ropes = mixed(twin).each
    of_pose = np.random.default_rng(1).integers(len(ropes), size=30)
    together = solve_sagging(robot, at, Cables(ropes, of_pose))
    families = [Material(7000.0 + 500.0 * k, 1e11 / (1 + k), 3e8) for k in range(len(ropes))]
    sized = size_poses(robot, at, MaterialsByPose(families, of_pose))
    for k, (rope, family) in enumerate(zip(ropes, families, strict=True)):
        own = of_pose == k
        alone, diameter_m = solve_sagging(robot, at, rope), size_poses(robot, at, family).diameter_m
        assert (together.verdict[own] == alone.verdict[own]).all()
        assert together.length_m[own] == pytest.approx(alone.length_m[own], rel=1e-12, nan_ok=True)
        tension_N = together.exit_tension_N[own]
        assert tension_N == pytest.approx(alone.exit_tension_N[own], rel=1e-9, nan_ok=True)
        assert sized.diameter_m[own] == pytest.approx(diameter_m[own], rel=1e-12, nan_ok=True)
