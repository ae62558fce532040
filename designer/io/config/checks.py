"""Checks that need several fields at once: geometry, counts, files.

Each check looks only at parts that are valid in themselves, so that all faults of a file come out
together.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import combinations
from pathlib import Path

import numpy as np
from scipy.spatial import QhullError

from designer.arrays import FloatArray
from designer.documents.document import Document
from designer.documents.fields import Distance, Point, Rotation, Tension
from designer.effects.effect import Effect
from designer.errors import Fault
from designer.io.config.effects import read_effects
from designer.io.config.group_checks import GROUP_CHECKS
from designer.io.config.load_checks import LOAD_CHECKS
from designer.io.config.measured_checks import MEASURED_CHECKS
from designer.io.config.orientation import Quaternion
from designer.io.config.parts import Parts
from designer.io.config.plane_checks import PLANE_CHECKS, is_planar, seen_from_above
from designer.io.config.schema import Anchors, Attachments, Box, Corners, PrismBase, RectangleBase
from designer.io.config.size_checks import SIZE_CHECKS
from designer.model.region import Prism, Rectangle
from designer.units import describe

_COINCIDENT = 1e-9
_FLAT = 1e-6


_ANCHORS = ("robot", "anchors")
_ATTACHMENTS = ("robot", "platform", "attachments")
_MOVED = ("effects", "anchor_offset")
_REGION = ("workspace", "region")
_PRISM = (*_REGION, "prism")


def all_faults(document: Document, effects: Mapping[str, Effect]) -> list[Fault]:
    """Return every fault that concerns more than one field of the document, or the effects."""
    parts = Parts(document, document.root.data(), effects)
    return [fault for check in CHECKS for fault in check(parts)]


def distinct_cables(parts: Parts) -> Iterator[Fault]:
    """No two cables have both of their ends in common."""
    anchors = parts.array(Anchors, *_ANCHORS)
    attachments = parts.array(Attachments, *_ATTACHMENTS)
    if anchors is None or (attachments is not None and len(attachments) != len(anchors)):
        return
    if attachments is None:
        if parts.raw(*_ATTACHMENTS) is not None:
            return
        attachments = np.zeros_like(anchors)
    pair = _coincident_pair(np.hstack([anchors, attachments]))
    if pair is not None:
        problem = f"is the same point as robot.anchors[{pair[0]}]"
        alike = ", and so are their attachments" if attachments.any() else ""
        yield parts.fault((*_ANCHORS, pair[1]), problem + alike, "distinct cables")


def anchors_span_area(parts: Parts) -> Iterator[Fault]:
    """Seen from above, the exit points are not on one line, except in a plane."""
    anchors = parts.array(Anchors, *_ANCHORS)
    if anchors is None or is_planar(parts) or any(distinct_cables(parts)):
        return
    if len(anchors) > 2 and _rank(np.unique(seen_from_above(parts, anchors), axis=0)) < 2:
        problem = "all anchors lie on one line when seen from above"
        yield parts.fault(_ANCHORS, problem, "anchors that span an area in x and y")


def moved_anchors_span_area(parts: Parts) -> Iterator[Fault]:
    """The exit points are not on one line either where the effects say that they are."""
    anchors = parts.array(Anchors, *_ANCHORS)
    if anchors is None or is_planar(parts) or any(anchors_span_area(parts)):
        return
    moved = anchors.copy()
    for _, effect in read_effects(parts.raw("effects"), len(anchors), parts.effects).effects:
        if effect.id == "anchor_offset" and effect.cable is not None:
            values = effect.parameters
            moved[effect.cable - 1] += [values.get(name, 0.0) for name in ("x_m", "y_m", "z_m")]
    if (moved != anchors).any() and _rank(seen_from_above(parts, moved)) < 2:
        problem = "moves the anchors onto one line, seen from above"
        yield parts.fault(_MOVED, problem, "anchors that span an area in x and y")


def attachment_count(parts: Parts) -> Iterator[Fault]:
    """Each cable has its attachment."""
    anchors = parts.read(Anchors, *_ANCHORS)
    attachments = parts.read(Attachments, *_ATTACHMENTS)
    if anchors and attachments and len(anchors) != len(attachments):
        problem = f"{len(attachments)} attachments for {len(anchors)} anchors"
        yield parts.fault(_ATTACHMENTS, problem, "one attachment for each anchor, in their order")


def attachments_span_plane(parts: Parts) -> Iterator[Fault]:
    """The platform cannot turn freely about a point or a line of attachments."""
    attachments = parts.array(Attachments, *_ATTACHMENTS)
    if attachments is None or _rank(attachments) >= (1 if is_planar(parts) else 2):
        return
    where = "on one line" if _rank(attachments) else "at one point"
    problem = f"all attachments lie {where}, so nothing keeps the platform from turning"
    yield parts.fault(_ATTACHMENTS, problem, "attachments apart, or none for a point mass")


def least_tension_is_a_choice(parts: Parts) -> Iterator[Fault]:
    """Only spare cables leave tensions to choose."""
    keys = ("robot", "tension_min")
    anchors = parts.read(Anchors, *_ANCHORS)
    least_N = parts.read(Tension, *keys)
    if not anchors or not least_N:
        return
    is_point = parts.raw(*_ATTACHMENTS) is None
    freedoms = (2 if is_point else 3) if is_planar(parts) else (3 if is_point else 6)
    if len(anchors) <= freedoms:
        problem = (
            f"{len(anchors)} cables and {freedoms} degrees of freedom leave no tension to choose"
        )
        yield parts.fault(keys, problem, "more cables than degrees of freedom, or leave it out")


def point_mass_has_no_body(parts: Parts) -> Iterator[Fault]:
    """A point mass has neither a centre of mass of its own, nor a hull, nor an orientation."""
    if parts.raw(*_ATTACHMENTS) is not None:
        return
    for kind, keys, first in (
        (Point, ("robot", "platform", "centre_of_mass"), 0),
        (Box, ("robot", "platform", "hull"), 0),
        (Rotation, ("pose", "rotation_vector"), 0),
        (Quaternion, ("pose", "quaternion"), 1),  # the first number is 1 where nothing turns
        (Rotation, ("pose", "euler", "angles"), 0),
    ):
        value = parts.read(kind, *keys)
        if value is not None and any(value[first:]):
            problem = "has no meaning for a point mass"
            yield parts.fault(keys, problem, "robot.platform.attachments, or leave it out")


def prism_has_area(parts: Parts) -> Iterator[Fault]:
    """Something is left of the prism's base inside the inset."""
    base = parts.read(PrismBase, *_PRISM)
    inset_m = parts.read(Distance, *_REGION, "inset") or 0.0
    is_over_anchors = base == "anchors"
    kind, keys = (Anchors, _ANCHORS) if is_over_anchors else (Corners, _PRISM)
    corners = parts.array(kind, *keys)
    if corners is None:
        return
    if _rank(corners[:, :2]) < 2:
        if not is_over_anchors:  # the anchors have their own check
            yield parts.fault(_PRISM, "all corners lie on one line", "corners that span an area")
    elif not _has_inside(corners, inset_m):
        problem = f"nothing of the region is left inside an inset of {inset_m:g} m"
        yield parts.fault((*_REGION, "inset"), problem, "a smaller inset")


def rectangle_has_area(parts: Parts) -> Iterator[Fault]:
    """Something is left of the rectangle's width inside the inset."""
    keys = (*_REGION, "rectangle")
    base = parts.read(RectangleBase, *keys)
    inset_m = parts.read(Distance, *_REGION, "inset") or 0.0
    ends = parts.array(Anchors, *_ANCHORS) if base == "anchors" else base
    if ends is None:
        return
    if np.ptp(np.array(ends)[:, :2], axis=0).max() == 0.0:
        yield parts.fault(keys, "begins and ends at one point", "two corners that are apart")
        return
    try:
        Rectangle.over(ends, inset_m, (0.0, 1.0))
    except ValueError as error:
        yield parts.fault(keys, str(error), "a line that leaves something between its ends")


def catalogues_exist(parts: Parts) -> Iterator[Fault]:
    """Each extra catalogue is a file or folder beside the config."""
    folder = Path(parts.document.name).parent
    names = parts.raw("catalogues")
    for index, name in enumerate(names if isinstance(names, list) else ()):
        if isinstance(name, str) and not _exists(folder / name):
            expected = "a grade file or a folder, relative to this file"
            yield parts.fault(("catalogues", index), f"there is no {describe(name)}", expected)


CHECKS = (
    distinct_cables,
    anchors_span_area,
    moved_anchors_span_area,
    attachment_count,
    attachments_span_plane,
    least_tension_is_a_choice,
    point_mass_has_no_body,
    prism_has_area,
    rectangle_has_area,
    catalogues_exist,
    *PLANE_CHECKS,
    *GROUP_CHECKS,
    *LOAD_CHECKS,
    *MEASURED_CHECKS,
    *SIZE_CHECKS,
)


def _coincident_pair(points: FloatArray) -> tuple[int, int] | None:
    extent = np.linalg.norm(np.ptp(points, axis=0))
    for first, second in combinations(range(len(points)), 2):
        if np.linalg.norm(points[first] - points[second]) <= _COINCIDENT * extent:
            return first, second
    return None


def _rank(points: FloatArray) -> int:
    """Return 0 for one point, 1 for a line, 2 or more otherwise."""
    spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    return int(np.sum(spread > _FLAT * max(spread[0], np.finfo(float).tiny)))


def _has_inside(corners_m: FloatArray, inset_m: float) -> bool:
    try:
        Prism.over(corners_m, inset_m, (0.0, 1.0))
    except (ValueError, QhullError):
        return False
    return True


def _exists(path: Path) -> bool:
    try:
        return path.exists()
    except OSError:  # such as a name longer than the file system takes
        return False
