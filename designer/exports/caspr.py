"""A model of CASPR, as `designer.foreign.caspr` reads it: one file of bodies, one of cables.

After CASPR's loaders (github.com/darwinlau/CASPR): gravity acts along −z, a free platform turns
about its own x, y and z, one in a plane about the plane's normal; attachments count from the joint.
"""

from __future__ import annotations

from collections.abc import Iterator
from xml.sax.saxutils import quoteattr

import numpy as np
from scipy.spatial.transform import Rotation

from designer.arrays import FloatArray
from designer.errors import one_line
from designer.exports.robot import (
    Export,
    ExportedRobot,
    inertia_of,
    levelled,
    lost_by_all,
    numbers,
    xml_document,
)
from designer.model.robot import Platform, Poses, Robot

JOINTS: dict[tuple[bool, bool], tuple[str, list[int], int]] = {
    (False, False): ("SPATIAL_EULER_XYZ", [0, 1, 2], 3),
    (False, True): ("T_XYZ", [0, 1, 2], 0),
    (True, False): ("PLANAR_XZ", [0, 2], 1),
    (True, True): ("P_XZ", [0, 2], 0),
}
"""Type of joint, axes of its first coordinates, and number of angles; by planar and point mass."""
INERTIA = (("Ixx", 0, 0), ("Iyy", 1, 1), ("Izz", 2, 2), ("Ixy", 0, 1), ("Ixz", 0, 2), ("Iyz", 1, 2))


def to_caspr(exported: ExportedRobot, stem: str) -> Export:
    """Return STEM_bodies.xml and STEM_cables.xml; nothing is solved for them."""
    study, space = exported.study, exported.study.workspace
    pose = study.pose
    lost = [
        "mass, sag and stretch of cables, and which ropes they are",
        *lost_by_all(study, ["tension_max_N"]),
    ]
    if pose is None:
        assert space is not None
        pose = Poses.at(space.region.bounds_m.mean(axis=0))
        lost.append("a pose of the study; q_initial is the middle of the region, not turned")
    robot, pose, frame_note = levelled(exported.robot, pose)
    if frame_note:
        lost.append(frame_note)
    lost += _lost_of(robot.platform)
    limits_m = None
    if space is not None:
        region = space.region
        limits_m = None if frame_note or region.is_discrete else region.bounds_m
        if limits_m is None:
            lost.append("the region of the workspace")
        elif not region.contains(np.stack(np.meshgrid(*limits_m.T), axis=-1).reshape(-1, 3)).all():
            lost.append("the shape of the region: q_min and q_max are the box around it")
    heading = exported.heading(lost, names_cables=False)
    files = {
        f"{stem}_bodies.xml": xml_document(heading, _bodies(study.name, robot, pose, limits_m)),
        f"{stem}_cables.xml": xml_document(heading, _cables(robot)),
    }
    return Export(files, tuple(lost))


def _lost_of(body: Platform) -> list[str]:
    lost = []
    if body.wrench_N.any():
        force, moment = numbers(*body.wrench_N[:3]), numbers(*body.wrench_N[3:])
        lost.append(f"the wrench on the platform: force [{force}] N, moment [{moment}] N·m")
    if body.hull_m is not None:
        lost.append("the hull of the platform")
    if body.inertia_kg_m2 is None and body.attachments_m is not None:
        lost.append("moments of inertia, not in the study: those of a solid box stand in")
    return lost


def _bodies(name: str, robot: Robot, pose: Poses, limits_m: FloatArray | None) -> Iterator[str]:
    body = robot.platform
    type_, axes, n_angles = JOINTS[robot.is_planar, robot.is_point_mass]
    base = [0.0, float(pose.position_m[1]) if robot.is_planar else 0.0, 0.0]
    angles_rad: list[float] = []
    if n_angles == 1:  # about y, the normal of the plane
        angles_rad = [float(np.arctan2(pose.rotation[0, 2], pose.rotation[0, 0]))]
    elif n_angles == 3:  # about the body's own x, y and z
        angles_rad = Rotation.from_matrix(pose.rotation).as_euler("XYZ").tolist()
    q = {"q_initial": [*pose.position_m[axes], *angles_rad]}
    if limits_m is not None:
        for key, end, angle in zip(("q_min", "q_max"), limits_m, (-np.pi, np.pi), strict=True):
            q[key] = [*end[axes], *[angle] * n_angles]
    coordinates = " ".join(f'{key}="{numbers(*values)}"' for key, values in q.items())
    inertia = np.eye(3) if robot.is_point_mass else inertia_of(body)
    moments = (f"<{tag}>{numbers(inertia[i, j])}</{tag}>" for tag, i, j in INERTIA)
    yield "<bodies_system>"
    yield "<links>"
    yield f'<link_rigid num="1" name={quoteattr(one_line(name))}>'
    yield f'<joint type="{type_}" {coordinates}/>'
    yield f"<physical><mass>{numbers(body.mass_kg)}</mass>"
    yield f"<com_location>{numbers(*body.centre_of_mass_m)}</com_location>"
    yield "<end_location>0 0 0</end_location>"
    yield f'<inertia ref="com">{"".join(moments)}</inertia></physical>'
    yield f"<parent><num>0</num><location>{numbers(*base)}</location></parent>"
    yield "</link_rigid>"
    yield "</links>"
    yield "</bodies_system>"


def _cables(robot: Robot) -> Iterator[str]:
    limits_N = robot.winches.largest_tensions_N(robot.n_cables).tolist()
    yield '<cables default_cable_set="main">'
    yield '<cable_set id="main">'
    rows = zip(robot.exit_points_m, robot.attachments_m, limits_N, strict=True)
    for number, (exit_m, attachment_m, limit_N) in enumerate(rows, start=1):
        yield f'<cable_ideal name="cable {number}" attachment_reference="joint">'
        limit = "Inf" if np.isinf(limit_N) else numbers(limit_N)
        yield f"<properties><force_min>{numbers(robot.tension_min_N)}</force_min>"
        yield f"<force_max>{limit}</force_max></properties>"
        yield f"<attachments>{_exit(exit_m, robot.pulley_radius_m)}"
        yield f"{_attachment(1, attachment_m)}</attachments>"
        yield "</cable_ideal>"
    yield "</cable_set>"
    yield "</cables>"


def _exit(exit_m: FloatArray, radius_m: float) -> str:
    if radius_m == 0.0:
        return _attachment(0, exit_m)
    return (
        f"<base_rotating_pulley><fixed_location>{numbers(*exit_m)}</fixed_location>"
        f"<pulley_radius>{numbers(radius_m)}</pulley_radius>"
        "<cable_entry_vector>0 0 1</cable_entry_vector></base_rotating_pulley>"
    )


def _attachment(link: int, place_m: FloatArray) -> str:
    return f"<attachment><link>{link}</link><location>{numbers(*place_m)}</location></attachment>"
