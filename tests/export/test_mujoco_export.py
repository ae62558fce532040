"""MuJoCo loads the model, which rests where we say with the tensions that we say."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from designer.errors import InputError
from designer.exports.mujoco import to_mujoco
from designer.exports.robot import ExportedRobot
from designer.io.config import read_study
from designer.model.cable import Material
from designer.model.robot import Platform, Poses, Robot
from designer.study import Study

mujoco = pytest.importorskip("mujoco", reason="the extra `mujoco` brings it")
ROPE = Material(5290.0, 62.7e9, 198e6)
TENSIONS_AGREE = 0.01
UP_3 = np.array([0.0, 0.0, 3.0])
CORNERS = np.array([(x, y, z) for z in (0.0, 6.0) for x in (-8.0, 8.0) for y in (-6.0, 6.0)])
KINDS = [
    "crane", "crane in a lying frame", "crane with pulleys", "platform", "platform in wind",
    "spare cables", "camera", "facade", "plumb line",
]  # fmt: skip


def robot_of(kind: str, rng: np.random.Generator) -> tuple[Robot, Poses]:
    mass_kg = float(rng.uniform(20.0, 2e3))
    aside, turn = rng.uniform(-1.0, 1.0, 3), rng.uniform(-0.06, 0.06, 3)
    ring = np.array([(np.cos(a), np.sin(a), 0.0) for a in 2 * np.pi * np.arange(3) / 3])
    if kind.startswith("crane"):
        return crane(kind, mass_kg, aside, 20.0 * ring + rng.uniform(-1.0, 1.0, (3, 3)))
    if kind.startswith("platform"):
        held = np.repeat(2.0 * np.roll(ring, 1, axis=0) * [-1, -1, 1], 2, axis=0)
        held = held[[5, 0, 1, 2, 3, 4]]
        force = [80.0, 30.0, 0.0, 0.0, 5.0, 20.0] if kind == "platform in wind" else [0.0] * 6
        body = Platform(
            mass_kg + 300.0, held, rng.uniform(-0.1, 0.1, 3), wrench_N=np.array(force),
            inertia_kg_m2=np.array([[200.0, 5.0, 0.0], [5.0, 250.0, 3.0], [0.0, 3.0, 300.0]]),
        )  # fmt: skip
        exits = np.repeat(9.0 * ring + [0.0, 0.0, 7.0], 2, axis=0)
        return Robot(exits, body), Poses.at(0.3 * aside, turn)
    return planar_or_redundant(kind, mass_kg, aside, turn)


def crane(kind: str, mass_kg: float, aside: np.ndarray, exits_m: np.ndarray) -> tuple[Robot, Poses]:
    robot, pose = Robot(exits_m, Platform(mass_kg)), Poses.at(2.0 * aside - 3.0 * UP_3)
    if kind == "crane with pulleys":
        return replace(robot, pulley_radius_m=0.3), pose
    if kind == "crane":
        return robot, pose
    swap = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
    down = swap @ [0.0, 0.0, -1.0]
    lying = replace(robot, exit_points_m=exits_m @ swap.T, gravity_direction=down)
    return lying, Poses.at(swap @ pose.position_m)


def planar_or_redundant(
    kind: str, mass_kg: float, aside: np.ndarray, turn: np.ndarray
) -> tuple[Robot, Poses]:
    if kind == "spare cables":
        held = 0.4 * np.sign(CORNERS - [0.0, 0.0, 3.0]) * [1.0, 1.0, -1.0]
        body = Platform(mass_kg, held)
        return Robot(CORNERS, body, tension_min_N=200.0), Poses.at(aside + UP_3, turn)
    if kind == "camera":
        return Robot(CORNERS[4:], Platform(mass_kg)), Poses.at(aside + 0.5 * UP_3)
    spin = Rotation.from_rotvec([0.0, 0.0, 0.6])
    if kind == "plumb line":
        exits = np.array([[-6.0, 0.0, 5.0], [6.0, 0.0, 5.0]])
        at = spin.apply([aside[0], 0.0, aside[2]])
        return Robot(spin.apply(exits), Platform(mass_kg), is_planar=True), Poses.at(at)
    exits = np.array([[-9.0, 0.0, 12.0], [9.0, 0.0, 12.0], [9.0, 0.0, 0.0], [-9.0, 0.0, 0.0]])
    held = np.array([[-1.0, 0.0, -0.6], [1.0, 0.0, -0.6], [1.0, 0.0, 0.6], [-1.0, 0.0, 0.6]])
    robot = Robot(
        spin.apply(exits),
        Platform(mass_kg, held, [0.0, 0.0, -0.2]),
        is_planar=True,
        tension_min_N=100.0,
    )
    place = Poses.at(spin.apply([aside[0], 0.0, 6.0]))
    about = spin.apply([0.0, turn[1], 0.0])
    return robot, Poses(place.position_m, (Rotation.from_rotvec(about) * spin).as_matrix())


def loaded(exported: ExportedRobot):
    made = to_mujoco(exported, "robot")
    text = made.files["robot.xml"].decode()
    assert all(line.replace("--", "- -") in text for line in made.lost)
    model = mujoco.MjModel.from_xml_string(text)
    return model, mujoco.MjData(model), made.lost


def tensions_N(model, data) -> np.ndarray:
    """What the model's springs pull with, beside its motors."""
    stretch_m = data.ten_length - model.tendon_lengthspring[:, 1]
    stiffness = np.asarray(model.tendon_stiffness).reshape(model.ntendon, -1)[:, 0]
    return stiffness * np.maximum(stretch_m, 0.0) + data.ctrl[: model.ntendon]


def pulls_N(robot: Robot, exits_m: np.ndarray, pose: Poses, tension_N: np.ndarray) -> np.ndarray:
    """What is left of force and moment on the platform, about its origin, world frame."""
    arms = robot.attachments_m @ pose.rotation.T
    chords = exits_m - (pose.position_m + arms)
    forces = tension_N[:, None] * chords / np.linalg.norm(chords, axis=1)[:, None]
    down = robot.gravity_direction / np.linalg.norm(robot.gravity_direction)
    weight = 9.81 * robot.platform.mass_kg * down
    centre = pose.rotation @ robot.platform.centre_of_mass_m
    moment = np.cross(arms, forces).sum(axis=0) + np.cross(centre, weight)
    return np.concatenate([forces.sum(axis=0) + weight, moment]) + robot.platform.wrench_N


def settle(model, data, key: int) -> None:
    """Let go a little aside of a key frame, in honey, until all is at rest."""
    mujoco.mj_resetDataKeyframe(model, data, key)
    mujoco.mj_forward(model, data)
    aside = 1e-4 * model.stat.extent * np.ones(model.nv)
    mujoco.mj_integratePos(model, data.qpos, aside, 1.0)
    model.tendon_damping *= 8.0
    for _ in range(40):
        mujoco.mj_step(model, data, nstep=1000)
        if np.abs(data.qvel).max() < 1e-8:
            break
    assert np.abs(data.qvel).max() < 1e-6


@pytest.mark.cases_by_default(9)
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", range(2))
def test_it_rests_where_we_say(kind: str, seed: int) -> None:
    robot, pose = robot_of(kind, np.random.default_rng([seed, 31]))
    model, data, lost = loaded(ExportedRobot.of(Study(kind, robot, ROPE, pose=pose)))
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    assert np.abs(data.qacc).max() < 1e-6 * 9.81
    assert np.allclose(data.body("platform").xpos, pose.position_m, atol=1e-9)
    assert np.allclose(data.body("platform").xmat.reshape(3, 3), pose.rotation, atol=1e-9)
    ours_N = tensions_N(model, data)
    exits_m = data.site_xpos[[model.site(f"exit{k + 1}").id for k in range(robot.n_cables)]]
    left = pulls_N(robot, exits_m, pose, ours_N)
    if robot.is_planar:  # its guides bear the rest
        along, across, up = robot.level
        left = [along @ left[:3], up @ left[:3], across @ left[3:]]
    free = left[:3] if robot.is_point_mass else left
    assert np.abs(free).max() < 1e-7 * ours_N.max() * model.stat.extent
    assert ours_N.min() >= robot.tension_min_N - 1e-6
    assert any("pulleys" in line for line in lost) == (robot.pulley_radius_m > 0.0)
    settle(model, data, 0)
    assert np.allclose(data.body("platform").xpos, pose.position_m, atol=1e-5 * model.stat.extent)
    assert np.abs(tensions_N(model, data) - ours_N).max() < TENSIONS_AGREE * ours_N.max()


def test_what_it_cannot_hold_is_refused() -> None:
    robot, pose = robot_of("crane", np.random.default_rng(4))
    study = Study("stiff", robot, replace(ROPE, youngs_modulus_Pa=np.inf), pose=pose)
    with pytest.raises(InputError, match=r"cable\.youngs_modulus: is unlimited"):
        to_mujoco(ExportedRobot.of(study), "robot")


HALL = """
name: Hall crane
robot:
  anchors: [[0, 0, 9], [12, 0, 9], [6, 9, 9]]
  platform: {mass: 300 kg}
cable: {grade: unirope-7x19-galvanised, safety_factor: 5}
pose: [6, 3, 3]
workspace: {region: {box: [[5, 7], [2, 4], [1, 5]]}, samples: 200}
selection: {grades: [unirope-7x19-galvanised], safety_factor: 5}
"""


@pytest.mark.slow
def test_the_worst_pose_is_a_key_frame_of_its_own(tmp_path: Path) -> None:
    path = tmp_path / "hall.yaml"
    path.write_text(HALL)
    exported = ExportedRobot.of(read_study(path))
    model, data, _ = loaded(exported)
    assert [model.key(k).name for k in range(model.nkey)] == ["reference", "worst"]
    mujoco.mj_resetDataKeyframe(model, data, 1)
    mujoco.mj_forward(model, data)
    assert np.abs(data.qacc).max() < 1e-6 * 9.81
    settle(model, data, 1)
    worst = exported.worst_pose.position_m
    assert not np.allclose(worst, exported.reference.poses.position_m, atol=0.5)
    assert np.allclose(data.body("platform").xpos, worst, atol=1e-5)
    exits_m = exported.robot.exit_points_m
    left = pulls_N(exported.robot, exits_m, Poses.at(worst), tensions_N(model, data))
    assert np.abs(left[:3]).max() < 1e-3 * 9.81 * 300.0
