"""Slopes of the utilisation against differences of solved states."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from redundant_robots import FOUR, SEVEN, cogiro_poses, four_poses, seven_poses, steel
from sample_robots import COGIRO, COGIRO_CABLE, ROPE, poses_under

from designer.arrays import FloatArray
from designer.model.cable import STANDARD_GRAVITY_M_PER_S2, Cable
from designer.model.robot import Platform, Poses, Robot
from designer.statics.geometry import load_wrench_N
from designer.statics.inverse import sag_ratio, solve_sagging
from designer.statics.slopes import Slopes, utilisation_slopes

_STEP = 1e-5
_AGREES = 1e-5


def point_mass(rng: np.random.Generator) -> Robot:
    exits = np.array([[0.0, 0, 0], [90, 0, 0], [40, 70, 0]]) + rng.normal(0.0, 8.0, (3, 3))
    return Robot(exits, Platform(3000.0))


def body(rng: np.random.Generator) -> Robot:
    corners = np.repeat(np.array([[0.0, 0, 0], [60, 0, 0], [30, 52, 0]]), 2, axis=0)
    exits = corners + rng.normal(0.0, 4.0, (6, 3))
    turn = np.array([[2, -1, 0], [-2, -1, 0], [2, -1, 0], [0, 2, 0], [0, 2, 0], [-2, -1, 0]])
    attachments = turn[[1, 0, 2, 3, 4, 5]] + rng.normal(0.0, 0.2, (6, 3))
    wrench = np.array([300.0, -200, 0, 0, 0, 100])
    return Robot(exits, Platform(4000.0, attachments, rng.normal(0.0, 0.2, 3), wrench_N=wrench))


def planar(rng: np.random.Generator) -> Robot:
    exits = np.array([[0.0, 0, 20], [40, 0, 20], [40.0, 0, 21]]) + [1.0, 1.0, 1.0] * rng.normal(
        0.0, [[1.0, 0.0, 1.0]], (3, 3)
    )
    attachments = np.array([[-1.0, 0, 0.5], [1, 0, 0.5], [1, 0, -0.5]])
    return Robot(exits, Platform(2000.0, attachments), is_planar=True)


def in_wind(robot: Robot) -> Robot:
    """The load on the cables points aside, as that of wind."""
    across = 0.0 if robot.is_planar else -0.2
    return replace(robot, cable_load_direction=np.array([0.4, across, -1.0]))


def over_pulleys(robot: Robot) -> Robot:
    return replace(robot, pulley_radius_m=0.3)


def over_pulleys_in_wind(robot: Robot) -> Robot:
    return over_pulleys(in_wind(robot))


def used(robot: Robot, poses: Poses, cable: Cable) -> float:
    return (
        float(solve_sagging(robot, poses, cable).largest_tension_N[0]) / cable.allowable_tension_N
    )


def heavier(robot: Robot, share: float) -> Robot:
    platform = robot.platform
    return replace(
        robot,
        platform=replace(
            platform,
            mass_kg=(1.0 + share) * platform.mass_kg,
            wrench_N=(1.0 + share) * platform.wrench_N,
        ),
    )


def with_load(robot: Robot, cable: Cable, more: FloatArray) -> tuple[Robot, Cable]:
    """Robot and cable with a further load per length on the cables (3,) [N/m]."""
    load = -cable.weight_N_per_m * robot.upright[2] + more
    size = float(np.linalg.norm(load))
    lines = replace(cable, linear_density_kg_per_m=size / STANDARD_GRAVITY_M_PER_S2)
    return replace(robot, cable_load_direction=load / size), lines


def moved(robot: Robot, cable: int, by: FloatArray) -> Robot:
    exits = np.array(robot.exit_points_m)
    exits[cable] += by
    return replace(robot, exit_points_m=exits)


def difference(of: Callable[[float], float], step: float) -> float:
    """Slope at zero, of fourth order."""
    near, far = of(step) - of(-step), of(2.0 * step) - of(-2.0 * step)
    return (8.0 * near - far) / (12.0 * step)


def compare(robot: Robot, poses: Poses, cable: Cable) -> int:
    """Compare every slope at each pose; the number of poses that have slopes."""
    compared = 0
    for k in range(len(poses.position_m)):
        pose = poses.part(slice(k, k + 1))
        statics = solve_sagging(robot, pose, cable)
        if not statics.is_solved[0]:
            continue
        found = utilisation_slopes(statics, cable.allowable_tension_N)
        if len(found) != 1:
            continue
        check(robot, pose, cable, found[0])
        compared += 1
    return compared


def check(robot: Robot, pose: Poses, cable: Cable, slopes: Slopes) -> None:
    size, now = float(np.ptp(robot.exit_points_m, axis=0).max()), slopes.utilisation
    assert now == pytest.approx(used(robot, pose, cable), rel=1e-12)

    def close(ours: float, of: Callable[[float], float], step: float = _STEP) -> None:
        theirs = difference(of, step)
        assert ours * step == pytest.approx(theirs * step, rel=_AGREES, abs=1e-5 * now * _STEP)

    load = load_wrench_N(robot, pose)[0]
    close(float(slopes.load @ load), lambda s: used(heavier(robot, s), pose, cable))
    close(
        float(slopes.stiffness.sum()),
        lambda s: used(
            robot, pose, replace(cable, axial_stiffness_N=np.exp(s) * cable.axial_stiffness_N)
        ),
    )
    weight = cable.weight_N_per_m
    axes = robot.level[[0, 2]] if robot.is_planar else np.eye(3)
    for axis in axes:
        ours = float(slopes.cable_load_m_per_N.sum(axis=0) @ axis) * weight
        close(ours, lambda s, axis=axis: used(
            with_load(robot, cable, s * weight * axis)[0], pose,
            with_load(robot, cable, s * weight * axis)[1],
        ))  # fmt: skip
    for number in range(0, robot.n_cables, 2):
        for axis in axes:
            ours = float(slopes.exit_points_per_m[number] @ axis) * size
            close(ours, lambda s, n=number, axis=axis: used(
                moved(robot, n, s * size * axis), pose, cable
            ))  # fmt: skip


@pytest.mark.cases_by_default(1)
@pytest.mark.parametrize("make", [point_mass, body, planar])
@pytest.mark.parametrize("change", [lambda r: r, over_pulleys_in_wind, in_wind, over_pulleys])
def test_square_robots(
    make: Callable[[np.random.Generator], Robot], change: Callable[[Robot], Robot]
) -> None:
    rng = np.random.default_rng(5)
    total = 0
    for seed in range(2):
        robot = change(make(rng))
        total += compare(robot, poses_under(robot, 2, seed), ROPE)
    assert total >= 1


def test_redundant_robots() -> None:
    assert compare(COGIRO, cogiro_poses(3), COGIRO_CABLE) >= 2
    assert compare(FOUR, four_poses(3), steel().cable(0.012)) >= 2
    assert compare(SEVEN, seven_poses(3), steel().cable(0.003)) >= 2


@pytest.mark.parametrize("change", [lambda r: r, in_wind])
def test_cables_at_their_largest_sag(change: Callable[[Robot], Robot]) -> None:
    robot, cable = change(replace(FOUR, sag_max=0.06)), steel(2.0).cable(0.012)
    statics = solve_sagging(robot, four_poses(6), cable)
    at_limit = (sag_ratio(statics) > 0.06 * (1.0 - 1e-5)).any(axis=1)
    assert at_limit.sum() >= 1
    some = Poses(four_poses(6).position_m[at_limit][:2], np.eye(3))
    assert compare(robot, some, cable) >= 1
