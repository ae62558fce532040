"""MoorPy reads the deck, and finds the pose and the tensions that we say."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from designer.errors import InputError
from designer.exports.moordyn import to_moordyn
from designer.exports.robot import ExportedRobot
from designer.model.cable import Attached, Material
from designer.model.robot import Platform, Poses, Robot
from designer.study import Study

moorpy = pytest.importorskip("moorpy", reason="the extra `test` brings MoorPy")
ROPE = Material(5290.0, 62.7e9, 198e6)
AGREES = 1e-4


def around(count: int, radius_m: float, height_m: float, turn: float = 0.0) -> np.ndarray:
    angles = 2 * np.pi * (np.arange(count) + turn) / count
    plan = radius_m * np.column_stack([np.cos(angles), np.sin(angles)])
    return np.column_stack([plan, np.full(count, height_m)])


def crane(rng: np.random.Generator, **changes) -> tuple[Robot, Poses]:
    exits = around(3, 150.0, 0.0) + rng.uniform(-5.0, 5.0, (3, 3))
    position = [*rng.uniform(-40.0, 40.0, 2), float(rng.uniform(-60.0, -20.0))]
    return Robot(exits, Platform(float(rng.uniform(500.0, 5e3))), **changes), Poses.at(position)


def platform(rng: np.random.Generator, **changes) -> tuple[Robot, Poses]:
    """Six cables in pairs from three corners, as RoboCrane's, on a body below."""
    exits = np.repeat(around(3, 20.0, 12.0), 2, axis=0)
    held = np.repeat(around(3, 4.0, 0.5, 0.5), 2, axis=0)[[5, 0, 1, 2, 3, 4]]
    body = Platform(
        float(rng.uniform(500.0, 5e3)), held, rng.uniform(-0.1, 0.1, 3), **changes.pop("body", {})
    )
    turn = rng.uniform(-0.05, 0.05, 3)
    return Robot(exits, body, **changes), Poses.at(rng.uniform(-2.0, 2.0, 3), turn)


@cache
def exported(kind: str, seed: int) -> ExportedRobot:
    rng = np.random.default_rng([seed, 77])
    robots = {
        "crane": lambda: crane(rng),
        "crane with pulleys": lambda: crane(rng, pulley_radius_m=0.6),
        "crane with lines": lambda: crane(
            rng, attached=(Attached(0.4), Attached(0.0), Attached(1.1))
        ),
        "crane in a lying frame": lambda: turned(*crane(rng)),
        "platform": lambda: platform(rng),
        "platform with a force": lambda: platform(
            rng, body={"wrench_N": np.array([0.0, 0.0, -8e3, 0.0, 0.0, 0.0])}
        ),
        "platform in wind": lambda: platform(
            rng, body={"wrench_N": np.array([900.0, 300.0, 0.0, 0.0, 0.0, 50.0])}
        ),
    }
    robot, pose = robots[kind]()
    return ExportedRobot.of(Study(kind, robot, ROPE, pose=pose))


def turned(robot: Robot, pose: Poses) -> tuple[Robot, Poses]:
    swap = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
    lying = replace(
        robot,
        exit_points_m=robot.exit_points_m @ swap.T,
        gravity_direction=swap @ [0.0, 0.0, -1.0],
    )
    return lying, Poses(pose.position_m @ swap.T, np.eye(3))


def read(folder, robot: ExportedRobot):
    made = to_moordyn(robot, "deck")
    path = folder / "deck.txt"
    path.write_bytes(made.files["deck.txt"])
    assert all(line in path.read_text() for line in made.lost)
    system = moorpy.System(file=str(path))
    system.initialize()
    return system, made.lost


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.slow)])
@pytest.mark.parametrize(
    "kind",
    [
        "crane", "crane with pulleys", "crane with lines", "crane in a lying frame", "platform",
        "platform with a force", "platform in wind",
    ],
)  # fmt: skip
def test_moorpy_finds_pose_and_tensions(tmp_path, kind: str, seed: int) -> None:
    robot = exported(kind, seed)
    statics = robot.reference
    system, lost = read(tmp_path, robot)
    moving = system.pointList[-1] if robot.robot.is_point_mass else system.bodyList[0]
    named = moving.r.copy() if robot.robot.is_point_mass else moving.r6.copy()
    assert moving.type == (-1 if kind == "platform in wind" else 0)
    assert any("wrench" in line for line in lost) == (kind == "platform in wind")
    size_m = float(np.ptp(robot.robot.exit_points_m, axis=0).max())
    if moving.type == 0:  # let go from somewhere else
        aside = 1e-3 * size_m * np.array([1.0, 1.0, 1.0, 0.02, 0.02, 0.02])
        moving.setPosition(named + aside[: len(named)])
    system.solveEquilibrium(tol=1e-7, maxIter=3000)
    rests = moving.r if robot.robot.is_point_mass else moving.r6
    assert np.abs(rests - named).max() <= AGREES * size_m
    for line, exit_N, held_N in zip(
        system.lineList, statics.exit_tension_N, statics.platform_tension_N, strict=True
    ):
        tension_N = line.TA, line.TB
        assert tension_N == pytest.approx((exit_N, held_N), rel=AGREES)


def test_cables_that_do_not_stretch_are_refused() -> None:
    robot, pose = crane(np.random.default_rng(1))
    study = Study("stiff", robot, replace(ROPE, youngs_modulus_Pa=np.inf), pose=pose)
    with pytest.raises(InputError, match="MoorDyn's lines stretch"):
        to_moordyn(ExportedRobot.of(study), "deck")
