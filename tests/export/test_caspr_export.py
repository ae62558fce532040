"""CASPR files that are written are read back to the same robot, and say what they leave out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from designer.exports.caspr import to_caspr
from designer.exports.robot import ExportedRobot
from designer.foreign.robot import ForeignRobot
from designer.foreign.study import read_foreign
from designer.model.cable import Material
from designer.model.region import Prism
from designer.model.robot import Platform, Poses, Robot
from designer.model.winches import Winches
from designer.model.workspace import Workspace
from designer.study import Study

STEEL = Material(7800.0, 2e11, 2e8)


def random_robot(rng: np.random.Generator, kind: str) -> tuple[Robot, Poses]:
    is_point, is_planar = kind.startswith("point"), kind.endswith("plane")
    freedoms = (2 if is_planar else 3) + (0 if is_point else 1 if is_planar else 3)
    n_cables = freedoms + int(rng.integers(0, 3))
    exits = rng.uniform(-30.0, 30.0, (n_cables, 3))
    held = rng.uniform(-1.0, 1.0, (n_cables, 3))
    centre, turn = rng.uniform(-0.5, 0.5, 3), rng.uniform(-1.2, 1.2, 3)
    position = rng.uniform(-5.0, 5.0, 3)
    if is_planar:
        exits[:, 1] = position[1]
        held[:, 1] = centre[1] = turn[0] = turn[2] = 0.0
    body = Platform(
        mass_kg=float(rng.uniform(1.0, 5e4)),
        attachments_m=None if is_point else held,
        centre_of_mass_m=np.zeros(3) if is_point else centre,
        inertia_kg_m2=np.diag(rng.uniform(1.0, 9.0, 3)),
    )
    robot = Robot(
        exits,
        body,
        pulley_radius_m=float(rng.choice([0.0, 0.07])),
        tension_min_N=float(rng.uniform(0.0, 900.0)) if n_cables > freedoms else 0.0,
        is_planar=is_planar,
        winches=Winches(tension_max_N=_tension_max_N(rng, n_cables)),
    )
    return robot, Poses.at(position, np.zeros(3) if is_point else turn)


def _tension_max_N(rng: np.random.Generator, n_cables: int) -> np.ndarray | float | None:
    """Return no limit, one for all winches, or one for each but the last."""
    kind = rng.integers(3)
    return (
        [None, 12345.678][kind] if kind < 2 else np.append(rng.uniform(9, 99, n_cables - 1), np.inf)
    )


def read_back(folder, study: Study) -> tuple[ForeignRobot, tuple[str, ...]]:
    made = to_caspr(ExportedRobot.of(study), "rig")
    for name, content in made.files.items():
        (folder / name).write_bytes(content)
        assert all(line.replace("--", "- -") in content.decode() for line in made.lost)
    return read_foreign(folder / "rig_bodies.xml"), made.lost


@pytest.mark.parametrize("kind", ["body", "point", "body in a plane", "point in a plane"])
@pytest.mark.cases_by_default(12)
@pytest.mark.parametrize("seed", range(10))
def test_random_robots_are_read_back(tmp_path, kind: str, seed: int) -> None:
    robot, pose = random_robot(np.random.default_rng([seed, len(kind)]), kind)
    low, high = np.sort(np.random.default_rng(seed).uniform(-5.0, 5.0, (2, 3)), axis=0)
    study = Study('a --- <rig> & its "cables"', robot, STEEL, pose=pose)
    if not robot.is_planar:
        box = Prism.box(*zip(low.tolist(), high.tolist(), strict=True))
        study = replace(study, workspace=Workspace(box))
    same, lost = read_back(tmp_path, study)
    assert same.name == study.name
    assert np.array_equal(same.exit_points_m, robot.exit_points_m)
    assert (same.attachments_m is None) == robot.is_point_mass
    if same.attachments_m is not None:
        assert np.array_equal(same.attachments_m, robot.attachments_m)
        assert same.euler_xyz_rad is not None
        turn = Rotation.from_euler("XYZ", same.euler_xyz_rad).as_matrix()
        assert np.allclose(turn, pose.rotation, rtol=0.0, atol=1e-14)
    assert same.mass_kg == robot.platform.mass_kg
    assert np.array_equal(same.centre_of_mass_m, robot.platform.centre_of_mass_m)
    assert same.plane_normal == ((0.0, 1.0, 0.0) if robot.is_planar else None)
    assert np.array_equal(same.position_m, pose.position_m)
    assert same.tension_min_N == robot.tension_min_N
    limits_N = robot.winches.tension_max_N
    if isinstance(limits_N, np.ndarray):
        limits_N = tuple(None if np.isinf(limit) else limit for limit in limits_N.tolist())
    assert same.tension_max_N == limits_N
    assert (same.pulley_radius_m or 0.0) == robot.pulley_radius_m
    if not robot.is_planar:
        assert np.allclose(np.transpose(same.limits_m), [low, high], rtol=1e-15)
        assert not any("shape" in line for line in lost)
    is_unlimited = None in (limits_N if isinstance(limits_N, tuple) else (limits_N,))
    assert list(same.remarks) == ["robot.winches"] * is_unlimited


def test_a_lying_frame_is_turned_upright_and_keeps_its_shape(tmp_path) -> None:
    robot, pose = random_robot(np.random.default_rng(5), "body")
    robot = replace(robot, gravity_direction=np.array([1.0, 2.0, -0.5]))
    same, lost = read_back(tmp_path, Study("rig", robot, STEEL, pose=pose))
    assert any(line.startswith("the frame of the study") for line in lost)
    down = robot.gravity_direction / np.linalg.norm(robot.gravity_direction)
    assert np.allclose(np.array(same.exit_points_m)[:, 2], -robot.exit_points_m @ down)
    chords = pose.attachment_points_m(robot) - robot.exit_points_m
    turn = Rotation.from_euler("XYZ", same.euler_xyz_rad).as_matrix()
    ends = np.array(same.position_m) + np.array(same.attachments_m) @ turn.T
    assert np.allclose(
        np.linalg.norm(ends - same.exit_points_m, axis=1), np.linalg.norm(chords, axis=1)
    )


def test_an_oblique_plane_comes_to_lie_in_x_and_z(tmp_path) -> None:
    robot, pose = random_robot(np.random.default_rng(6), "body in a plane")
    aside = Rotation.from_rotvec([0.0, 0.0, 0.7])
    robot = replace(robot, exit_points_m=aside.apply(robot.exit_points_m.copy()))
    pose = Poses(aside.apply(pose.position_m.copy()), aside.as_matrix() @ pose.rotation)
    same, lost = read_back(tmp_path, Study("rig", robot, STEEL, pose=pose))
    assert same.plane_normal == (0.0, 1.0, 0.0)
    assert np.allclose(np.ptp(np.array(same.exit_points_m)[:, 1]), 0.0, atol=1e-12)
    assert len([line for line in lost if "frame" in line]) == 1


def test_what_it_cannot_hold_is_named(tmp_path) -> None:
    robot, _ = random_robot(np.random.default_rng(7), "body")
    body = replace(robot.platform, wrench_N=np.arange(6.0), inertia_kg_m2=None)
    triangle = Prism.over([[0, 0], [4, 0], [0, 4]], 0.0, (0.0, 3.0))
    study = Study("rig", replace(robot, platform=body), STEEL, workspace=Workspace(triangle))
    same, lost = read_back(tmp_path, study)
    assert np.allclose(same.position_m, triangle.bounds_m.mean(axis=0))
    for words in ("wrench", "inertia", "shape of the region", "a pose of the study", "sag"):
        assert any(words in line for line in lost), words
