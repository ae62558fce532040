"""Checks of how far apart things are: they may be far from the origin, not from each other."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from designer.arrays import FloatArray
from designer.documents.bounds import BOUNDS
from designer.documents.fields import Interval, Point
from designer.documents.node import Key
from designer.errors import Fault
from designer.io.config.parts import Parts
from designer.io.config.schema import Anchors, Attachments, Box, Corners, PoseSection, Positions

_LARGEST = BOUNDS["distance"]
_ANCHORS = ("robot", "anchors")
_REGION = ("workspace", "region")
_PLATFORM = ("robot", "platform")


def robot_has_a_size(parts: Parts) -> Iterator[Fault]:
    """Exit points lie within some kilometres, and so does what belongs to the platform."""
    anchors = parts.array(Anchors, *_ANCHORS)
    if anchors is not None and float(np.ptp(anchors, axis=0).max()) > _LARGEST.most:
        problem = f"the exit points are {np.ptp(anchors, axis=0).max():.4g} m apart"
        yield parts.fault(_ANCHORS, problem, _at_most())
    for name, kind in (("attachments", Attachments), ("centre_of_mass", Point), ("hull", Box)):
        values = parts.array(kind, *_PLATFORM, name)
        if values is not None and float(np.abs(values).max()) > _LARGEST.most:
            problem = f"reaches {np.abs(values).max():.4g} m from the platform's origin"
            yield parts.fault((*_PLATFORM, name), problem, _at_most())


def places_are_near(parts: Parts) -> Iterator[Fault]:
    """The platform is asked to be where the cables can reach."""
    anchors = parts.array(Anchors, *_ANCHORS)
    if anchors is None:
        return
    low, high = anchors.min(axis=0) - _LARGEST.most, anchors.max(axis=0) + _LARGEST.most
    for keys, points in _places(parts):
        axes = points.shape[1]
        off = np.maximum(low[:axes] - points, points - high[:axes])
        if float(off.max()) > 0.0:
            problem = f"lies {off.max() + _LARGEST.most:.4g} m from the exit points"
            yield parts.fault(keys, problem, _at_most())


def _at_most() -> str:
    return f"at most {_LARGEST.most:g} m: {_LARGEST.reason}; check the unit"


def _places(parts: Parts) -> Iterator[tuple[tuple[Key, ...], FloatArray]]:
    pose = parts.read(PoseSection, "pose")
    if pose is not None:
        yield ("pose",), np.array([pose.position])
    box = parts.array(Box, *_REGION, "box")
    if box is not None:
        yield (*_REGION, "box"), box.T
    for name, kind in (("points", Positions), ("prism", Corners), ("rectangle", Corners)):
        points = parts.array(kind, *_REGION, name)
        if points is not None:
            yield (*_REGION, name), points
    z_m = parts.array(Interval, *_REGION, "z")
    anchors = parts.array(Anchors, *_ANCHORS)
    if z_m is not None and anchors is not None:
        middle = np.repeat(anchors.mean(axis=0, keepdims=True), 2, axis=0)
        middle[:, 2] = z_m
        yield (*_REGION, "z"), middle


SIZE_CHECKS = (robot_has_a_size, places_are_near)
