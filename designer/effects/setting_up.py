"""Errors of setting up: frames, points and clocks that are not as the drawing has them.

The laws of measured poses (zero, scale, frame and distortion of a tracker, and its target) take
them to the poses that the robot had. No cable feels such an error.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
from scipy.spatial.transform import Rotation

from designer.arrays import FloatArray, frozen_array
from designer.effects.effect import (
    ALL_ANCHORS,
    ALL_ATTACHMENTS,
    Effect,
    Parameter,
    Readings,
    Size,
    Values,
    can_turn,
    frame_size_m,
    is_in_space,
    moves_along,
    platform_extent_m,
    sized_by,
)
from designer.model.measurements import Measured
from designer.model.robot import Machine, Poses
from designer.statics.geometry import cable_geometry
from designer.units import ANGLE, LENGTH, NUMBER, PER_LENGTH, TIME

_ROTATION = Size(2e-3, bounds=(-1.6, 1.6), plausible=(-0.5, 0.5))
_AXES = "xyz"


def _in_plane(machine: Machine, moves_m: FloatArray) -> FloatArray:
    """Return moves (..., 3) [m], of a planar robot without what is across its plane."""
    if is_in_space(machine):
        return moves_m
    across = machine.robot.level[1]
    return np.asarray(moves_m - (moves_m @ across)[..., None] * across)


def _point(values: Values) -> FloatArray:
    return np.array([values.get(f"{axis}_m", 0.0) for axis in _AXES])


def _rotation(values: Values) -> FloatArray:
    vector = [values.get(f"r{axis}_rad", 0.0) for axis in _AXES]
    return np.asarray(Rotation.from_rotvec(vector).as_matrix())


def _scaled(poses: Poses, values: Values, *, machine: Machine) -> Poses:
    moves = poses.position_m / values["scale"] - poses.position_m
    return replace(poses, position_m=poses.position_m + _in_plane(machine, moves))


def _framed(poses: Poses, values: Values, *, machine: Machine) -> Poses:
    """Take the frame's scale, turn and shift back, the turn and the scale about the exit points.

    Their middle is a point that no log moves: what one log tells is right for another.
    """
    middle = machine.robot.exit_points_m.mean(axis=0)
    turn = _rotation(values)
    position = middle + (poses.position_m - middle - _point(values)) @ turn / values["scale"]
    if machine.robot.is_point_mass:
        return replace(poses, position_m=position)
    return Poses(position, turn.T @ poses.rotation)


def _straightened(poses: Poses, values: Values, *, machine: Machine) -> Poses:
    up, true_m = machine.robot.level[2], poses.position_m
    for _ in range(3):  # each turn takes the error down by 2 · gain · distance
        distance_m = np.linalg.norm(true_m - _point(values), axis=-1, keepdims=True)
        true_m = poses.position_m - values["gain_per_m"] * distance_m**2 * up
    return replace(poses, position_m=true_m)


def _pointed(poses: Poses, values: Values) -> Poses:
    rotation = poses.rotation @ _rotation(values).T
    return Poses(poses.position_m - rotation @ _point(values), rotation)


def _bent_by(
    measured: Measured, residual: FloatArray, *, machine: Machine
) -> tuple[dict[str, float], ...]:
    """Start from gain |p|² - 2 gain c·p + k that lifts the poses as the lengths ask for."""
    geometry = cable_geometry(machine.robot, measured.poses)
    slope = (geometry.drop_m / geometry.chord_m).ravel()  # what a length loses to a lift
    points = np.repeat(measured.poses.position_m, machine.robot.n_cables, axis=0)
    lift = np.column_stack([np.sum(points**2, axis=1), points, np.ones(len(points))])
    off = np.hsplit(residual, 2)[0].ravel()
    is_known = np.isfinite(off)
    if is_known.sum() < 2 * lift.shape[1]:
        return ()
    gain, *along, _ = np.linalg.lstsq(slope[is_known, None] * lift[is_known], off[is_known])[
        0
    ].tolist()
    tracker = {
        f"{axis}_m": -0.5 * x / (gain or 1e-12) for axis, x in zip(_AXES, along, strict=True)
    }
    return ({"gain_per_m": gain, **tracker},)


_SHIFT = sized_by(frame_size_m, 1e-3, bounds=(-1.0, 1.0), plausible=(-0.5, 0.5))
"""As far as half the frame's size is believed: a camera may stand anywhere."""
_GAIN = sized_by(
    lambda machine: 1.0 / frame_size_m(machine), 1e-3, bounds=(-1.0, 1.0), plausible=(-0.02, 0.02)
)
"""Up to a fiftieth of the frame's size at that distance."""
_TRACKER = sized_by(
    lambda machine: float(np.abs(machine.robot.exit_points_m).max()) + 3.0 * frame_size_m(machine),
    0.03, bounds=(-1.0, 1.0), plausible=(-1.0, 1.0),
)  # fmt: skip
"""Somewhere about the machine."""
_MARKER = sized_by(
    lambda machine: platform_extent_m(machine) or 0.1 * frame_size_m(machine),
    0.01, bounds=(-5.0, 5.0), plausible=(-1.0, 1.0),
)  # fmt: skip
"""A marker may be as far off as the platform is large."""


_SHIFTS = tuple(
    Parameter(
        f"{name}_m",
        LENGTH,
        _SHIFT,
        is_optional=True,
        can_have=partial(moves_along, axis),
        part_of=("pose_frame",),
    )
    for axis, name in enumerate(_AXES)
)
_ROTATIONS = tuple(Parameter(f"r{axis}_rad", ANGLE, _ROTATION, is_optional=True) for axis in _AXES)
_SCALE = Parameter(
    "scale",
    NUMBER,
    Size(1e-3, bounds=(0.5, 2.0), plausible=(0.9, 1.1)),
    neutral=1.0,
    above=0.0,
    part_of=("pose_frame",),
)

POSE_OFFSET = Effect(
    id="pose_shift",
    summary="the zero of the measured poses is not the robot's",
    law="measured position is the true one plus an offset",
    source="definition",
    parameters=_SHIFTS,
    on_poses=lambda poses, values, *, machine: replace(
        poses, position_m=poses.position_m - _in_plane(machine, _point(values))
    ),
    cause="setting_up",
    needs=frozenset({"pose"}),
    takes_machine=True,
)
POSE_SCALE = replace(
    POSE_OFFSET,
    id="pose_scale",
    summary="the scale of the measured poses is wrong",
    law="measured position is scale times the true one, about the origin of the robot's frame",
    parameters=(_SCALE,),
    on_poses=_scaled,
)
POSE_FRAME = replace(
    POSE_OFFSET,
    id="pose_frame",
    summary="the frame of the measured poses is not the robot's",
    law="measured pose is the true one turned by (rx, ry, rz) and scaled about the middle of the "
    "exit points, plus an offset",
    source="definition; Umeyama, IEEE Trans. Pattern Anal. Mach. Intell. 13, 1991",
    parameters=(*_SHIFTS, *_ROTATIONS, replace(_SCALE, is_optional=True)),
    on_poses=_framed,
    can_have=is_in_space,
)
POSE_DISTORTION = replace(
    POSE_OFFSET,
    id="pose_distortion",
    summary="the measured poses are distorted: an error that grows with the square of the distance "
    "from the tracker",
    law="measured height is the true one plus gain · d², d the distance from the tracker at "
    "(x, y, z), as where the line of sight is bent",
    source="Rüeger, Electronic Distance Measurement, 1996 (refraction)",
    parameters=(
        Parameter("gain_per_m", PER_LENGTH, _GAIN),
        *(replace(p, size=_TRACKER, part_of=(), is_shape=True) for p in _SHIFTS),
    ),
    on_poses=_straightened,
    can_have=is_in_space,
    needs=frozenset({"pose", "length"}),
    starts_from=_bent_by,
)
TOOL_POINT = replace(
    POSE_OFFSET,
    id="tool_point",
    summary="the measured point is not the origin of the platform's frame",
    law="measured is the point (x, y, z) of the platform's frame, with axes that are turned by "
    "(rx, ry, rz) in it where orientation is measured",
    source="definition; Tsai and Lenz, IEEE Trans. Robot. Autom. 5, 1989",
    parameters=(
        *(replace(p, size=_MARKER, part_of=()) for p in _SHIFTS),
        *(replace(p, can_have=can_turn) for p in _ROTATIONS),
    ),
    on_poses=_pointed,
    can_have=is_in_space,
    takes_machine=False,
)


# Exit points, attachment points and centre of mass.


def _moved(points_m: FloatArray, values: Values, cable: int) -> FloatArray:
    moved = np.array(points_m)
    moved[cable - 1] += _point(values)
    return frozen_array(moved)


def _move_exit(machine: Machine, values: Values, *, cable: int) -> Machine:
    exits_m = _moved(machine.robot.exit_points_m, values, cable)
    return replace(machine, robot=replace(machine.robot, exit_points_m=exits_m))


def _move_attachment(machine: Machine, values: Values, *, cable: int) -> Machine:
    attachments_m = _moved(machine.robot.attachments_m, values, cable)
    platform = replace(machine.robot.platform, attachments_m=attachments_m)
    return replace(machine, robot=replace(machine.robot, platform=platform))


def _move_centre(machine: Machine, values: Values) -> Machine:
    platform = machine.robot.platform
    centre_m = frozen_array(platform.centre_of_mass_m + _point(values))
    platform = replace(platform, centre_of_mass_m=centre_m)
    return replace(machine, robot=replace(machine.robot, platform=platform))


_EXIT_OFFSET = sized_by(frame_size_m, 1e-3, bounds=(-1.0, 1.0), plausible=(-0.02, 0.02))
_ATTACHMENT_OFFSET = sized_by(
    lambda machine: platform_extent_m(machine) or 1.0, 0.01, (-1.0, 1.0), plausible=(-0.2, 0.2)
)


ANCHOR_OFFSET = Effect(
    id="anchor_offset",
    summary="the exit point of cable {cable} is not where the drawing has it",
    law="exit point plus offset",
    source="definition",
    parameters=tuple(Parameter(f"{a}_m", LENGTH, _EXIT_OFFSET, is_optional=True) for a in _AXES),
    on_machine=_move_exit,
    takes_cable=True,
    reaches_design=True,
    between_sessions=True,
    also_called=ALL_ANCHORS,
)
ATTACHMENT_OFFSET = replace(
    ANCHOR_OFFSET,
    id="attachment_offset",
    summary="the attachment point of cable {cable} is not where the drawing has it",
    law="attachment point plus offset, in the platform's frame",
    parameters=tuple(replace(p, size=_ATTACHMENT_OFFSET) for p in ANCHOR_OFFSET.parameters),
    on_machine=_move_attachment,
    can_have=can_turn,
    cause="setting_up",
    also_called=ALL_ATTACHMENTS,
)
CENTRE_OF_MASS_OFFSET = Effect(
    id="centre_of_mass_offset",
    summary="the centre of mass is not where the drawing has it",
    law="centre of mass plus offset, body frame",
    source="definition",
    parameters=tuple(
        replace(p, size=Size(0.01, bounds=(-5.0, 5.0), plausible=(-0.5, 0.5)))
        for p in ANCHOR_OFFSET.parameters
    ),
    on_machine=_move_centre,
    needs=frozenset({"rotation"}),
    can_have=can_turn,
    reaches_design=True,
)


# A base that does not stand upright.

_TILT = Size(2e-3, bounds=(-0.5, 0.5), plausible=(-0.1, 0.1))


def _tilt_base(machine: Machine, values: Values) -> Machine:
    tilt = frozen_array([values["rx_rad"], values["ry_rad"]])
    return replace(machine, robot=replace(machine.robot, tilt_rad=tilt))


BASE_TILT = Effect(
    id="base_tilt",
    summary="gravity is not along the frame's -z: the base stands tilted",
    law="the base frame is turned by the rotation vector (rx, ry, 0) against the vertical",
    source="definition",
    parameters=tuple(
        Parameter(name, ANGLE, _TILT, is_optional=True) for name in ("rx_rad", "ry_rad")
    ),
    on_machine=_tilt_base,
    reaches_design=True,
)


# Two streams whose clocks disagree.


def _delay_lengths(readings: Readings, values: Values, measured: Measured) -> Readings:
    assert measured.time_s is not None
    from designer.kernel.spline import at_earlier_times

    if np.isnan(readings.length_m).any():  # a spline would spread the gap over all rows
        return readings
    length = np.empty(readings.length_m.shape)
    present = np.ascontiguousarray(readings.length_m)
    at_earlier_times(measured.time_s, present, values["offset_s"], length)
    return replace(readings, length_m=length)


CLOCK_OFFSET = Effect(
    id="clock_offset",
    summary="the length stream lags the pose stream",
    law="the length of a row is that of the pose this much earlier",
    source="definition",
    parameters=(
        Parameter("offset_s", TIME, Size(0.05, bounds=(-60.0, 60.0), plausible=(-5.0, 5.0))),
    ),
    on_readings=_delay_lengths,
    cause="setting_up",
    needs=frozenset({"time", "motion", "length"}),
)
