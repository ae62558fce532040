"""An MJCF model of MuJoCo: cables as straight springs that pull only, our tensions as key frames.

After MuJoCo's XML reference (mujoco.readthedocs.io): a spatial tendon with ``springlength="0 L"``
pulls with its stiffness times what it is longer than L, and never pushes. The model rests in the
key frame *reference* without control. In *worst* the motors give what our tensions there are beside
those of the springs; their control is a pull in N.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from xml.sax.saxutils import quoteattr

import numpy as np
from scipy.spatial.transform import Rotation

from designer.arrays import FloatArray, frozen_array
from designer.errors import InputError, one_line
from designer.exports.robot import (
    Export,
    ExportedRobot,
    inertia_of,
    lost_by_all,
    numbers,
    xml_document,
)
from designer.model.cable import STANDARD_GRAVITY_M_PER_S2
from designer.model.robot import Poses, Robot
from designer.statics.inverse import solve_massless
from designer.statics.pulleys import straight_run

DAMPING_RATIO = 0.05
"""Of the platform's mass on one cable."""
LONGEST_STEP_S, STEP = 0.002, 0.1
"""Of time: the longest, and in radians of the fastest oscillation."""


@dataclass(frozen=True, eq=False)
class _Springs:
    """The cables as springs."""

    robot: Robot  #: with straight cables from where they leave their pulleys in the reference pose
    pose: Poses  #: that pose
    tension_N: FloatArray  #: (n_cables,) there [N]
    axial_stiffness_N: FloatArray  #: (n_cables,)

    def distance_m(self, pose: Poses) -> FloatArray:
        """Return the lengths of the chords in a pose (n_cables,) [m]."""
        chords_m = pose.attachment_points_m(self.robot) - self.robot.exit_points_m
        return np.asarray(np.linalg.norm(chords_m, axis=-1))

    @cached_property
    def length_m(self) -> FloatArray:
        """Unstrained lengths (n_cables,) [m]."""
        return self.distance_m(self.pose) / (1.0 + self.tension_N / self.axial_stiffness_N)

    @cached_property
    def stiffness_N_per_m(self) -> FloatArray:
        """EA over unstrained length (n_cables,) [N/m]."""
        return self.axial_stiffness_N / self.length_m

    def motors_N(self, pose: Poses) -> FloatArray | None:
        """Return what holds another pose beside the springs (n_cables,) [N]; None if nothing."""
        tension_N = solve_massless(self.robot, pose).tension_N
        stretch_m = np.maximum(self.distance_m(pose) - self.length_m, 0.0)
        is_held = bool((tension_N >= 0.0).all())
        return tension_N - self.stiffness_N_per_m * stretch_m if is_held else None

    @property
    def step_s(self) -> float:
        """A time step that the fastest oscillation allows [s]."""
        body, sum_N_per_m = self.robot.platform, float(self.stiffness_N_per_m.sum())
        fastest = sum_N_per_m / body.mass_kg
        if not self.robot.is_point_mass:
            arms_m = np.linalg.norm(self.robot.attachments_m - body.centre_of_mass_m, axis=1)
            least = float(np.linalg.eigvalsh(inertia_of(body))[0])
            fastest += float(self.stiffness_N_per_m @ arms_m**2) / least
        return min(LONGEST_STEP_S, STEP / math.sqrt(fastest))


def to_mujoco(exported: ExportedRobot, stem: str) -> Export:
    """Return the model, with straight cables that weigh nothing.

    Raises
    ------
    InputError
        If cables do not stretch, the platform weighs nothing, or straight cables do not hold it in
        the reference pose.
    """
    springs = _springs(exported)
    worst = None if exported.study.workspace is None else exported.worst_pose
    motors_N = None if worst is None else springs.motors_N(worst)
    lost = _lost(exported, springs)
    if worst is not None and motors_N is None:
        lost.append("the worst pose, which straight cables do not hold")
    lost += lost_by_all(exported.study)
    keys = [_key("reference", springs, springs.pose, np.zeros_like(springs.tension_N))]
    if worst is not None and motors_N is not None:
        keys.append(_key("worst", springs, worst, motors_N))
    lines = [
        f"<mujoco model={quoteattr(one_line(exported.study.name))}>",
        '<compiler angle="radian" inertiafromgeom="false"/>',
        *_options(springs),
        "<worldbody>",
        *_sites("exit", springs.robot.exit_points_m, _size_m(springs)),
        '<site name="world" size="0.001"/>',
        *_body(springs),
        "</worldbody>",
        *_tendons(exported, springs),
        *_actuators(springs),
        *("<keyframe>", *keys, "</keyframe>"),
        "</mujoco>",
    ]
    return Export({f"{stem}.xml": xml_document(exported.heading(lost), lines)}, tuple(lost))


def _springs(exported: ExportedRobot) -> _Springs:
    robot, study, design = exported.robot, exported.study, exported.design
    assert design is not None
    pose = exported.reference_pose
    stiffness_N = np.broadcast_to(design.cable.axial_stiffness_N, robot.n_cables)
    exits_m = straight_run(robot, pose).exit_points_m @ robot.upright
    straight = replace(robot, exit_points_m=frozen_array(exits_m), pulley_radius_m=0.0)
    tension_N = solve_massless(straight, pose).tension_N
    faults = []
    if not np.isfinite(stiffness_N).all():
        faults.append(("cable.youngs_modulus", "is unlimited: no spring is", "a finite modulus"))
    if robot.platform.mass_kg <= 0.0:
        faults.append(("robot.platform.mass", "is 0, and MuJoCo moves no such body", "above 0"))
    if not (tension_N >= 0.0).all():
        problem = "straight weightless cables do not hold the platform at rest there"
        faults.append(("pose", problem, "a pose between the cables"))
    if faults:
        raise InputError([study.source.fault(*fault) for fault in faults])
    return _Springs(straight, pose, tension_N, stiffness_N)


def _lost(exported: ExportedRobot, springs: _Springs) -> list[str]:
    robot = exported.robot
    sagging_N = exported.reference.cable_tension_N
    apart = float(np.abs(springs.tension_N - sagging_N).max() / sagging_N.max())
    lost = [
        "sag and mass of the cables: they are straight, and tensions in the reference pose "
        f"differ by up to {apart:.2%} of the largest",
    ]
    if robot.pulley_radius_m:
        lost.append("pulleys; tendons begin where cables leave them in the reference pose")
    lost += exported.lost_of_cables
    if robot.platform.hull_m is not None:
        lost.append("the hull of the platform, but for a box around it that touches nothing")
    if not robot.is_point_mass and robot.platform.inertia_kg_m2 is None:
        lost.append("moments of inertia, not in the study: those of a solid box stand in")
    if robot.tension_min_N:
        lost.append("the least tension, by which our tensions were chosen")
    lost.append(
        f"damping, not in the study: {DAMPING_RATIO:g} of critical for each cable stands in"
    )
    return lost


def _options(springs: _Springs) -> Iterator[str]:
    gravity = -STANDARD_GRAVITY_M_PER_S2 * springs.robot.level[2]
    step_s = float(f"{springs.step_s:.1e}")
    exits_m = springs.robot.exit_points_m
    extent_m, middle_m = np.ptp(exits_m, axis=0).max(), springs.pose.position_m
    yield (f'<option gravity="{numbers(*gravity)}" timestep="{step_s}" integrator="implicitfast"/>')
    yield f'<statistic extent="{numbers(extent_m)}" center="{numbers(*middle_m)}"/>'


def _size_m(springs: _Springs) -> float:
    return 0.005 * float(np.ptp(springs.robot.exit_points_m, axis=0).max())


def _sites(name: str, points_m: FloatArray, size_m: float) -> Iterator[str]:
    for number, point_m in enumerate(points_m, start=1):
        yield f'<site name="{name}{number}" pos="{numbers(*point_m)}" size="{numbers(size_m)}"/>'


def _body(springs: _Springs) -> Iterator[str]:
    robot, pose, size_m = springs.robot, springs.pose, _size_m(springs)
    body, centre = robot.platform, numbers(*robot.platform.centre_of_mass_m)
    inertia = np.eye(3) * body.mass_kg if robot.is_point_mass else inertia_of(body)
    moments = [inertia[i, j] for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]
    yield f'<body name="platform" pos="{numbers(*pose.position_m)}" quat="{_quaternion(pose)}">'
    if not _axes(robot):
        yield '<freejoint name="free"/>'
    for number, (kind, axis) in enumerate(_axes(robot), start=1):
        local = axis @ pose.rotation  # an axis of MuJoCo's is along the body
        yield f'<joint name="joint{number}" type="{kind}" axis="{numbers(*local)}"/>'
    yield (
        f'<inertial pos="{centre}" mass="{numbers(body.mass_kg)}" '
        f'fullinertia="{numbers(*moments)}"/>'
    )
    yield _shape(robot, size_m)
    yield '<site name="origin" size="0.001"/>'
    yield from _sites("attachment", robot.attachments_m, 0.5 * size_m)
    yield "</body>"


def _quaternion(pose: Poses) -> str:
    x, y, z, w = Rotation.from_matrix(pose.rotation).as_quat()
    return numbers(w, x, y, z)


def _axes(robot: Robot) -> list[tuple[str, FloatArray]]:
    """Return kind and axis of each joint, world frame; nothing for a body free in space."""
    if robot.is_planar:
        along, across, up = robot.level
        slides = [("slide", along), ("slide", up)]
        return slides if robot.is_point_mass else [*slides, ("hinge", across)]
    return [("slide", axis) for axis in np.eye(3)] if robot.is_point_mass else []


def _shape(robot: Robot, size_m: float) -> str:
    """Return what is seen of the platform; it touches nothing."""
    look = 'contype="0" conaffinity="0" rgba="0.3 0.4 0.6 0.6"/>'
    if robot.is_point_mass:
        return f'<geom type="sphere" size="{numbers(2.0 * size_m)}" {look}'
    hull_m = robot.attachments_m if robot.platform.hull_m is None else robot.platform.hull_m
    low, high = hull_m.min(axis=0), hull_m.max(axis=0)
    half = numbers(*np.maximum(0.5 * (high - low), 0.5 * size_m))
    return f'<geom type="box" pos="{numbers(*(0.5 * (low + high)))}" size="{half}" {look}'


def _tendons(exported: ExportedRobot, springs: _Springs) -> Iterator[str]:
    yield "<tendon>"
    mass_kg, size_m = springs.robot.platform.mass_kg, _size_m(springs)
    rows = zip(springs.stiffness_N_per_m, springs.length_m, strict=True)
    for number, (stiffness, length_m) in enumerate(rows, start=1):
        damping = 2.0 * DAMPING_RATIO * math.sqrt(stiffness * mass_kg)
        yield (
            f'<spatial name="cable{number}" stiffness="{numbers(stiffness)}" '
            f'damping="{numbers(damping)}" springlength="0 {numbers(length_m)}" '
            f'width="{numbers(0.3 * size_m)}"><site site="exit{number}"/>'
            f'<site site="attachment{number}"/></spatial>'
        )
    yield "</tendon>"


def _actuators(springs: _Springs) -> Iterator[str]:
    yield "<actuator>"
    for number in range(1, springs.robot.n_cables + 1):
        yield f'<motor name="winch{number}" tendon="cable{number}" gear="-1"/>'
    wrench_N = springs.robot.platform.wrench_N
    if wrench_N.any():  # along the axes of the world, whatever the control
        yield (
            f'<general name="wrench" site="origin" refsite="world" gear="{numbers(*wrench_N)}" '
            'gaintype="fixed" gainprm="0" biastype="affine" biasprm="1 0 0"/>'
        )
    yield "</actuator>"


def _key(name: str, springs: _Springs, pose: Poses, motors_N: FloatArray) -> str:
    controls = [*motors_N, *([0.0] if springs.robot.platform.wrench_N.any() else [])]
    qpos = numbers(*_coordinates(springs, pose))
    if not _axes(springs.robot):
        qpos = f"{numbers(*pose.position_m)} {_quaternion(pose)}"
    return f'<key name="{name}" qpos="{qpos}" ctrl="{numbers(*controls)}"/>'


def _coordinates(springs: _Springs, pose: Poses) -> Sequence[float]:
    """Return the joints' coordinates, counted from the reference pose."""
    moved_m = pose.position_m - springs.pose.position_m
    rotation_vector = Rotation.from_matrix(pose.rotation @ springs.pose.rotation.T).as_rotvec()
    return [
        float(axis @ (rotation_vector if kind == "hinge" else moved_m))
        for kind, axis in _axes(springs.robot)
    ]
