"""A deck of MoorDyn v2, which MoorPy reads as well: the reference pose in air, cables as its lines.

After the input format (moordyn.readthedocs.io, "Inputs"), and `moorpy.System.load`. MoorPy computes
weights of lines as it reads them, so that density and gravity have to come first; it takes the end
of that section for no heading, hence the line before the types.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from designer.arrays import FloatArray
from designer.errors import InputError
from designer.exports.robot import Export, ExportedRobot, inertia_of, levelled, lost_by_all, numbers
from designer.model.cable import STANDARD_GRAVITY_M_PER_S2, Cable
from designer.model.robot import Robot
from designer.statics.inverse import Statics

SEGMENTS = 40
"""Of each line, in MoorDyn."""
DAMPING_RATIO = 0.1
"""Of a segment along its line, in MoorDyn."""


@dataclass(frozen=True, slots=True)
class _Load:
    """What hangs on the cables: mass [kg], centre of mass (3,) [m], whether the file holds it all.

    A vertical force at the origin of the body is a mass there.
    """

    mass_kg: float
    centre_m: FloatArray
    is_whole: bool

    @classmethod
    def of(cls, robot: Robot, rotation: FloatArray) -> _Load:
        body = robot.platform
        *aside, force_z_N = body.wrench_N[:3].tolist()
        mass_kg = body.mass_kg - force_z_N / STANDARD_GRAVITY_M_PER_S2
        if any(aside) or body.wrench_N[3:].any() or mass_kg <= 0.0:
            return cls(body.mass_kg, rotation @ body.centre_of_mass_m, False)
        return cls(mass_kg, body.mass_kg / mass_kg * rotation @ body.centre_of_mass_m, True)


def to_moordyn(exported: ExportedRobot, stem: str) -> Export:
    """Return the deck of the reference pose, in which MoorPy finds our tensions.

    Raises
    ------
    InputError
        If a cable does not stretch, or the reference pose is not held.
    """
    statics = exported.reference
    if not np.isfinite(statics.axial_stiffness_N).all():
        problem = "is unlimited, and MoorDyn's lines stretch"
        fault = exported.study.source.fault("cable.youngs_modulus", problem, "a finite modulus")
        raise InputError([fault])
    robot, poses, frame_note = levelled(exported.robot, statics.poses)
    load = _Load.of(robot, poses.rotation)
    # MoorDyn wants bodies below the water line, wherever that is.
    down_m = 0.0 if robot.is_point_mass else max(float(poses.position_m[2]), 0.0)
    place_m = poses.position_m - [0.0, 0.0, down_m]
    exits_m = statics.run.exit_points_m - [0.0, 0.0, down_m]
    attachments_m = robot.attachments_m @ poses.rotation.T
    lost = [
        *_lost(robot, load, down_m),
        *exported.lost_of_cables,
        *([frame_note] if frame_note else []),
        *lost_by_all(exported.study),
    ]
    lines = [
        *(line.replace("---", "- -") for line in exported.heading(lost)),
        *_options(np.vstack([exits_m, place_m])),
        *_types(exported, statics),
        *_bodies(robot, load, place_m, poses.rotation),
        *_points(robot, load, exits_m, place_m, attachments_m),
        *_lines(statics),
        _section("need this line"),
    ]
    return Export({f"{stem}.txt": ("\n".join(lines) + "\n").encode()}, tuple(lost))


def _lost(robot: Robot, load: _Load, down_m: float) -> list[str]:
    body, lost = robot.platform, ["the worst pose; this is the reference pose alone"]
    if not load.is_whole:
        lost.append(
            "the wrench on the platform, as MoorDyn takes a vertical force at its origin alone: "
            "the platform is coupled, which keeps it in this pose"
        )
    elif body.wrench_N.any():
        lost.append("the vertical force on the platform as such; it is in its mass here")
    if body.hull_m is not None:
        lost.append("the hull of the platform")
    if robot.pulley_radius_m:
        lost.append("pulleys; lines begin where cables leave them in this pose")
    if robot.is_planar:
        lost.append("what keeps the platform in its plane")
    if not robot.is_point_mass:
        lost.append("the axes of the body; here they are those of the world in this pose")
        if body.inertia_kg_m2 is None:
            lost.append("moments of inertia, not in the study: those of a solid box stand in")
        else:
            lost.append("products of inertia")
    if down_m:
        lost.append(f"heights: z here is z of the study less {down_m!r} m")
    if robot.tension_min_N:
        lost.append("the least tension, by which our tensions were chosen")
    return lost


def _section(title: str) -> str:
    return f"---------------------- {title} ----------------------"


def _options(points_m: FloatArray) -> Iterator[str]:
    low, size = float(points_m[:, 2].min()), float(np.ptp(points_m, axis=0).max())
    yield _section("OPTIONS")
    yield f"{STANDARD_GRAVITY_M_PER_S2} g gravity (m/s^2)"
    yield "0 rho density of water (kg/m^3): none, this stands in air"
    yield f"{numbers(max(-low, 0.0) + 2.0 * size)} WtrDpth seabed below everything (m)"
    yield "0.0002 dtM time step (s)"
    yield _section("END OF THE OPTIONS, WHICH MOORPY NEEDS FIRST")


def _types(exported: ExportedRobot, statics: Statics) -> Iterator[str]:
    yield _section("LINE TYPES")
    yield "TypeName Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx"
    yield "(name) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)"
    shape = statics.length_m.shape
    mass = np.broadcast_to(statics.weight_N_per_m / STANDARD_GRAVITY_M_PER_S2, shape)
    stiffness = np.broadcast_to(statics.axial_stiffness_N, shape)
    design = exported.design
    assert design is not None
    cable = design.cable
    cables = [cable] * len(mass) if isinstance(cable, Cable) else cable.each
    for k, figures in enumerate(zip(cables, mass, stiffness, strict=True), start=1):
        rope, mass_kg_per_m, stiffness_N = figures
        values = numbers(rope.diameter_m, mass_kg_per_m, stiffness_N, -DAMPING_RATIO)
        yield f"cable{k} {values} 0 0 0 0 0"


def _bodies(robot: Robot, load: _Load, place_m: FloatArray, rotation: FloatArray) -> Iterator[str]:
    if robot.is_point_mass:
        return
    yield _section("BODIES")
    yield "ID Attachment X0 Y0 Z0 r0 p0 y0 Mass CG* I* Volume CdA* Ca*"
    yield "(#) (word) (m) (m) (m) (deg) (deg) (deg) (kg) (m) (kg-m^2) (m^3) (m^2) (-)"
    inertia = np.diag(rotation @ inertia_of(robot.platform) @ rotation.T)
    centre, moments = ("|".join(numbers(x) for x in row) for row in (load.centre_m, inertia))
    place = f"{numbers(*place_m)} 0 0 0"
    yield f"1 {_held(load)} {place} {numbers(load.mass_kg)} {centre} {moments} 0 0 0"


def _held(load: _Load) -> str:
    return "Free" if load.is_whole else "Coupled"


def _points(
    robot: Robot, load: _Load, exits_m: FloatArray, place_m: FloatArray, attachments_m: FloatArray
) -> Iterator[str]:
    yield _section("POINTS")
    yield "ID Attachment X Y Z Mass Volume CdA Ca"
    yield "(#) (word/ID) (m) (m) (m) (kg) (m^3) (m^2) (-)"
    rows = [("Fixed", exit_m, 0.0) for exit_m in exits_m]
    if robot.is_point_mass:
        rows.append((_held(load), place_m, load.mass_kg))
    else:
        rows += [("Body1", attachment_m, 0.0) for attachment_m in attachments_m]
    for number, (attachment, point_m, mass_kg) in enumerate(rows, start=1):
        yield f"{number} {attachment} {numbers(*point_m, mass_kg)} 0 0 0"


def _lines(statics: Statics) -> Iterator[str]:
    count, is_point_mass = statics.robot.n_cables, statics.robot.is_point_mass
    yield _section("LINES")
    yield "ID LineType AttachA AttachB UnstrLen NumSegs LineOutputs"
    yield "(#) (name) (ID) (ID) (m) (-) (-)"
    for k, length_m in enumerate(statics.free_length_m, start=1):
        end = count + (1 if is_point_mass else k)
        yield f"{k} cable{k} {k} {end} {numbers(length_m)} {SEGMENTS} -"
