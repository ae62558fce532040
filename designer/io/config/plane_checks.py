"""Checks of robots that move in a vertical plane, and of the orientations of a workspace."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from designer.arrays import FloatArray
from designer.documents.fields import Direction, Forces, Moments, Point
from designer.errors import Fault
from designer.io.config.orientation import OrientationRangeSection, OrientationSection
from designer.io.config.parts import Parts
from designer.io.config.schema import (
    ORIENTATION_KINDS,
    Anchors,
    Attachments,
    PoseSection,
    Positions,
    RectangleBase,
    TurnList,
)
from designer.model.robot import vertical_frame

_OFF = 1e-6
_ANCHORS = ("robot", "anchors")
_PLATFORM = ("robot", "platform")
_REGION = ("workspace", "region")


def is_planar(parts: Parts) -> bool:
    """Tell whether the file asks for a robot in a vertical plane, as far as it can be read."""
    return parts.raw("robot", "planar") not in (None, False)


def seen_from_above(parts: Parts, points_m: FloatArray) -> FloatArray:
    """Return points (n, 3) along two horizontal axes, by the file's gravity (n, 2) [m]."""
    down = parts.array(Direction, "robot", "gravity")
    frame = vertical_frame(np.array([0.0, 0.0, -1.0]) if down is None else down)
    return np.asarray((points_m @ frame.T)[:, :2])


def enough_anchors(parts: Parts) -> Iterator[Fault]:
    """Only in a plane two cables can hold anything."""
    anchors = parts.read(Anchors, *_ANCHORS)
    if anchors is not None and len(anchors) < 3 and not is_planar(parts):
        yield parts.fault(_ANCHORS, "the list has 2 values", "at least 3 points, or planar: true")


def lies_in_plane(parts: Parts) -> Iterator[Fault]:
    """Everything of a planar robot lies in the vertical plane of its anchors."""
    plane = _Plane.of(parts) if is_planar(parts) else None
    if plane is None:
        return
    if plane.normal is None:
        problem = "the anchors do not lie in one vertical plane, as robot.planar asks"
        yield parts.fault(_ANCHORS, problem, "anchors on one line, seen from above")
        return
    for keys, values, origin in plane.vectors():
        off = np.abs((values - origin) @ plane.normal)
        if off.max() > _OFF * plane.size:
            expected = "what lies in the vertical plane of the anchors, as robot.planar asks"
            yield parts.fault(keys, f"leaves that plane by {off.max():.3g}", expected)
    for keys, turns in plane.turns():
        if np.linalg.norm(np.cross(turns, plane.normal), axis=1).max() > _OFF:
            yield parts.fault(keys, "turns the platform out of the plane", "a turn in the plane")


def planar_region(parts: Parts) -> Iterator[Fault]:
    """A planar robot has a flat region."""
    region = parts.raw(*_REGION)
    if is_planar(parts) and isinstance(region, dict):
        solid = next((kind for kind in ("prism", "box") if region.get(kind) is not None), None)
        if solid is not None:
            problem = "is a solid region, but the robot is planar"
            yield parts.fault((*_REGION, solid), problem, "rectangle or points")


def point_mass_does_not_turn(parts: Parts) -> Iterator[Fault]:
    """A point mass has no orientations to be served in, and takes no moment."""
    if parts.raw(*_PLATFORM, "attachments") is not None:
        return
    expected = "robot.platform.attachments, or leave it out"
    for kind in ORIENTATION_KINDS:
        if parts.raw("workspace", kind) is not None:
            yield parts.fault(("workspace", kind), "has no meaning for a point mass", expected)
    moment = parts.read(Moments, *_PLATFORM, "wrench", "moment")
    if moment is not None and any(moment):
        keys = (*_PLATFORM, "wrench", "moment")
        yield parts.fault(keys, "has no meaning for a point mass", expected)


PLANE_CHECKS = (enough_anchors, lies_in_plane, planar_region, point_mass_does_not_turn)


class _Plane:
    """The vertical plane of the anchors, and what the file says of it."""

    def __init__(self, parts: Parts, anchors: FloatArray) -> None:
        self.parts = parts
        self.origin = anchors[0]
        self.size = float(np.linalg.norm(np.ptp(anchors, axis=0)))
        plan = seen_from_above(parts, anchors)
        _, spread, axes = np.linalg.svd(plan - plan.mean(axis=0))
        on_line = len(spread) < 2 or spread[1] <= _OFF * self.size
        self.normal: FloatArray | None = None
        if spread[0] > _OFF * self.size and on_line:
            down = parts.array(Direction, "robot", "gravity")
            frame = vertical_frame(np.array([0.0, 0.0, -1.0]) if down is None else down)
            across = np.array([-axes[0, 1], axes[0, 0], 0.0])
            self.normal = np.asarray(across @ frame)

    @classmethod
    def of(cls, parts: Parts) -> _Plane | None:
        anchors = parts.array(Anchors, *_ANCHORS)
        return None if anchors is None else cls(parts, anchors)

    def vectors(self) -> Iterator[tuple[tuple[str, ...], FloatArray, FloatArray]]:
        """Yield where vectors stand, the vectors (n, 3), and what they are counted from."""
        zero = np.zeros(3)
        single = [
            ((*_PLATFORM, "centre_of_mass"), Point, zero),
            (("pose",), PoseSection, self.origin),
        ]
        several = [
            ((*_PLATFORM, "attachments"), Attachments, zero),
            ((*_REGION, "points"), Positions, self.origin),
        ]
        for keys, kind, origin in single:
            value = self.parts.read(kind, *keys)
            if value is not None:
                point = value.position if isinstance(value, PoseSection) else value
                yield keys, np.array([point]), origin
        for keys, kind, origin in several:
            values = self.parts.array(kind, *keys)
            if values is not None:
                yield keys, values, origin
        ends = self.parts.read(RectangleBase, *_REGION, "rectangle")
        if ends is not None and ends != "anchors":
            corners = np.column_stack([np.array(ends), np.full(2, self.origin[2])])
            yield (*_REGION, "rectangle"), corners, self.origin
        force = self.parts.array(Forces, *_PLATFORM, "wrench", "force")
        if force is not None and force.any():
            scale = self.size / np.linalg.norm(force)
            yield (*_PLATFORM, "wrench", "force"), force[None] * scale, zero

    def turns(self) -> Iterator[tuple[tuple[str, ...], FloatArray]]:
        """Yield where turns and moments stand, and their axes (n, 3)."""
        pose = self.parts.read(PoseSection, "pose")
        if pose is not None:
            turn = OrientationSection(
                rotation_vector=pose.rotation_vector, quaternion=pose.quaternion, euler=pose.euler
            )
            yield ("pose",), turn.turn_rad[None]
        one = self.parts.read(OrientationSection, "workspace", "orientation")
        if one is not None:
            yield ("workspace", "orientation"), one.turn_rad[None]
        several = self.parts.read(TurnList, "workspace", "orientations")
        if several is not None:
            yield ("workspace", "orientations"), np.array([each.turn_rad for each in several])
        between = self.parts.read(OrientationRangeSection, "workspace", "orientation_range")
        if between is not None:
            yield ("workspace", "orientation_range"), between.bounds_rad
        moment = self.parts.array(Moments, *_PLATFORM, "wrench", "moment")
        if moment is not None and moment.any():
            yield (*_PLATFORM, "wrench", "moment"), moment[None] / np.linalg.norm(moment)
