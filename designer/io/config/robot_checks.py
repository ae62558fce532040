"""A config in parts, and checks of the robot that need several of its fields.

Each check looks only at parts that are valid in themselves, whatever is wrong with the others, so
that all faults of a file come out together.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from itertools import combinations
from typing import Any

import numpy as np
from pydantic import TypeAdapter, ValidationError

from designer.arrays import FloatArray
from designer.documents.bounds import BOUNDS, MOST_CABLES
from designer.documents.document import Data, Document, Key
from designer.documents.section import kind_at
from designer.effects.effect import Effect
from designer.errors import Fault
from designer.io.config.effects import Found, read_effects
from designer.io.config.schema import ORIENTATION_KINDS, StudySection
from designer.model.cable import STANDARD_GRAVITY_M_PER_S2
from designer.model.robot import vertical_frame


@dataclass(frozen=True, slots=True)
class Parts:
    """A document whose parts can be had one by one, whatever is wrong with the others.

    ``effects`` are those that there are, by their ids. A path is written as in messages, such as
    ``robot.platform.mass``.
    """

    document: Document
    data: Data
    effects: Mapping[str, Effect]
    _read: dict[str, Any] = field(default_factory=dict)

    def raw(self, path: str) -> Data:
        """Return what the file holds at a path, None for nothing."""
        data = self.data
        for key in path.split("."):
            data = data.get(key) if isinstance(data, dict) else None
        return data

    def read(self, path: str) -> Any:
        """Return the value at a path, checked by the schema; None if it is absent or faulty."""
        if path not in self._read:
            self._read[path] = valid(_reader_at(path), self.raw(path))
        return self._read[path]

    def array(self, path: str) -> FloatArray | None:
        """Return the value at a path as an array; None if it is absent, faulty or a word."""
        value = self.read(path)
        return None if value is None or isinstance(value, str) else np.array(value, dtype=float)

    def fault(self, path: str, problem: str, expected: str = "", *below: Key) -> Fault:
        """Return a fault at a path, or at a field or item below it."""
        return self.document.fault((*path.split("."), *below), problem, expected)

    @property
    def is_planar(self) -> bool:
        """Whether the file asks for a robot in a vertical plane, as far as it can be read."""
        return self.raw("robot.planar") not in (None, False)

    @property
    def is_point_mass(self) -> bool:
        """Whether the platform has no attachments."""
        return self.raw("robot.platform.attachments") is None

    @property
    def n_cables(self) -> int:
        """Number of cables; as many as there may be where the anchors are faulty."""
        anchors = self.read("robot.anchors")
        return MOST_CABLES if anchors is None else len(anchors)

    @property
    def declared(self) -> Found:
        """The effects, each with its place, and what is wrong with them."""
        return read_effects(self.raw("effects"), self.n_cables, self.effects)

    @property
    def down(self) -> FloatArray:
        """Direction of gravity (3,)."""
        down = self.array("robot.gravity")
        return np.array([0.0, 0.0, -1.0]) if down is None else down

    def seen_from_above(self, points_m: FloatArray) -> FloatArray:
        """Return points (n, 3) along two horizontal axes (n, 2) [m]."""
        return np.asarray((points_m @ vertical_frame(self.down).T)[:, :2])


def valid(reader: TypeAdapter[Any], data: Data) -> Any:
    """Return what a reader makes of a value; None where it refuses it."""
    try:
        return reader.validate_python(data)
    except ValidationError:
        return None


@cache
def _reader_at(path: str) -> TypeAdapter[Any]:
    return TypeAdapter(kind_at(StudySection, path.split(".")))


_COINCIDENT = 1e-9
"""Distance of two cables' ends that counts as none, over the extent of the robot."""
_FLAT = 1e-6
"""What counts as on one line or in one plane, over the extent of the points."""
_LARGEST_STRAIN = 0.5
"""Linear elasticity says nothing beyond; the softest rope of the catalogue breaks before."""
LARGEST = BOUNDS["distance"]
AT_MOST = f"at most {LARGEST.most:g} m: {LARGEST.reason}; check the unit"
_ANCHORS = "robot.anchors"
_ATTACHMENTS = "robot.platform.attachments"
_WINCHES = "robot.winches.positions"
_TENSION_MAX = "robot.winches.tension_max"
_ATTACHED = "robot.attached"
_NEAREST_WINCH_M = 1e-3
_NO_POINT_MASS = "robot.platform.attachments, or leave it out"


def distinct_cables(parts: Parts) -> Iterator[Fault]:
    """No two cables have both of their ends in common."""
    anchors, attachments = parts.array(_ANCHORS), parts.array(_ATTACHMENTS)
    if anchors is None or (attachments is not None and len(attachments) != len(anchors)):
        return
    if attachments is None:
        if not parts.is_point_mass:
            return
        attachments = np.zeros_like(anchors)
    ends = np.hstack([anchors, attachments])
    tolerance_m = _COINCIDENT * np.linalg.norm(np.ptp(ends, axis=0))
    for first, second in combinations(range(len(ends)), 2):
        if np.linalg.norm(ends[first] - ends[second]) <= tolerance_m:
            alike = ", and so are their attachments" if attachments.any() else ""
            problem = f"is the same point as robot.anchors[{first}]{alike}"
            yield parts.fault(_ANCHORS, problem, "distinct cables", second)
            return


def anchors_span_area(parts: Parts) -> Iterator[Fault]:
    """Seen from above, the exit points are not on one line, except in a plane."""
    anchors = parts.array(_ANCHORS)
    if anchors is None or parts.is_planar or any(distinct_cables(parts)):
        return
    if len(anchors) > 2 and rank(np.unique(parts.seen_from_above(anchors), axis=0)) < 2:
        problem = "all anchors lie on one line when seen from above"
        yield parts.fault(_ANCHORS, problem, "anchors that span an area in x and y")


def moved_anchors_span_area(parts: Parts) -> Iterator[Fault]:
    """The exit points are not on one line either where the effects say that they are."""
    anchors = parts.array(_ANCHORS)
    if anchors is None or parts.is_planar or any(anchors_span_area(parts)):
        return
    moved = anchors.copy()
    for _, effect in parts.declared.effects:
        if effect.id == "anchor_offset" and effect.cable is not None:
            values = effect.parameters
            moved[effect.cable - 1] += [values.get(name, 0.0) for name in ("x_m", "y_m", "z_m")]
    if (moved != anchors).any() and rank(parts.seen_from_above(moved)) < 2:
        problem = "moves the anchors onto one line, seen from above"
        expected = "anchors that span an area in x and y"
        yield parts.fault("effects.anchor_offset", problem, expected)


def attachments_fit(parts: Parts) -> Iterator[Fault]:
    """Each cable has its attachment, and the platform cannot turn freely about all of them."""
    anchors, attachments = parts.read(_ANCHORS), parts.array(_ATTACHMENTS)
    if attachments is None:
        return
    if anchors and len(anchors) != len(attachments):
        problem = f"{len(attachments)} attachments for {len(anchors)} anchors"
        expected = "one attachment for each anchor, in their order"
        yield parts.fault(_ATTACHMENTS, problem, expected)
    if rank(attachments) < (1 if parts.is_planar else 2):
        place = "on one line" if rank(attachments) else "at one point"
        problem = f"all attachments lie {place}, so nothing keeps the platform from turning"
        yield parts.fault(_ATTACHMENTS, problem, "attachments apart, or none for a point mass")


def least_tension_is_a_choice(parts: Parts) -> Iterator[Fault]:
    """Only spare cables leave tensions to choose."""
    anchors, least_N = parts.read(_ANCHORS), parts.read("robot.tension_min")
    if not anchors or not least_N:
        return
    turning = 0 if parts.is_point_mass else (1 if parts.is_planar else 3)
    freedoms = (2 if parts.is_planar else 3) + turning
    if len(anchors) <= freedoms:
        problem = (
            f"{len(anchors)} cables and {freedoms} degrees of freedom leave no tension to choose"
        )
        expected = "more cables than degrees of freedom, or leave it out"
        yield parts.fault("robot.tension_min", problem, expected)


def point_mass_has_no_body(parts: Parts) -> Iterator[Fault]:
    """A point mass has no body, takes no moment and has no orientations."""
    if not parts.is_point_mass:
        return
    meaningless = "has no meaning for a point mass"
    for path, first in (
        ("robot.platform.centre_of_mass", 0),
        ("robot.platform.hull", 0),
        ("robot.platform.drag.centre", 0),
        ("pose.rotation_vector", 0),
        ("pose.quaternion", 1),  # the first number is 1 where nothing turns
        ("pose.euler.angles", 0),
        ("robot.platform.wrench.moment", 0),
        ("robot.platform.inertia", 0),
    ):
        value = parts.read(path)
        if value is not None and any(value[first:]):
            yield parts.fault(path, meaningless, _NO_POINT_MASS)
    for kind in ORIENTATION_KINDS:
        if parts.raw(f"workspace.{kind}") is not None:
            yield parts.fault(f"workspace.{kind}", meaningless, _NO_POINT_MASS)
    for index, case in enumerate(parts.read("load_cases") or ()):
        if case.wrenches_N[:, 3:].any():
            kind = "wrench" if case.wrench_set is None else "wrench_set"
            problem = f"a moment {meaningless}"
            yield parts.fault("load_cases", problem, _NO_POINT_MASS, index, kind)


def load_is_not_cancelled(parts: Parts) -> Iterator[Fault]:
    """The wrench, with what the effects add, leaves a load: without one there is no diameter."""
    force, mass_kg = parts.array("robot.platform.wrench.force"), parts.read("robot.platform.mass")
    if force is None or mass_kg is None:
        return
    mass_kg += sum(
        effect.parameters.get("offset_kg", 0.0)
        for _, effect in parts.declared.effects
        if effect.id == "platform_mass"
    )
    weight = mass_kg * STANDARD_GRAVITY_M_PER_S2 * parts.down / np.linalg.norm(parts.down)
    moment, lever = (
        np.zeros(3) if found is None else found
        for found in map(
            parts.array, ("robot.platform.wrench.moment", "robot.platform.centre_of_mass")
        )
    )
    size_N = 1e-9 * float(np.linalg.norm(weight))  # counts as none
    imbalance = (force + weight, moment + np.cross(lever, weight))
    if all(np.linalg.norm(part) <= size_N for part in imbalance):
        problem = "cancels the platform's weight, so there is nothing for the cables to hold"
        yield parts.fault("robot.platform.wrench.force", problem, "a load that is left")


def strain_stays_small(parts: Parts) -> Iterator[Fault]:
    """The allowable stress is well below the modulus; else one of them is in another unit."""
    stress_Pa, modulus_Pa = map(parts.read, ("cable.allowable_stress", "cable.youngs_modulus"))
    if stress_Pa is None or modulus_Pa is None or stress_Pa <= _LARGEST_STRAIN * modulus_Pa:
        return
    problem = f"stretches the cable by {stress_Pa / modulus_Pa:.0%}"
    expected = f"at most {_LARGEST_STRAIN:.0%}; check the unit, also that of cable.youngs_modulus"
    yield parts.fault("cable.allowable_stress", problem, expected)


def robot_has_a_size(parts: Parts) -> Iterator[Fault]:
    """Exit points lie within some kilometres, and what belongs to the platform between them."""
    anchors, hull = parts.array(_ANCHORS), parts.array("robot.platform.hull")
    if anchors is not None and float(np.ptp(anchors, axis=0).max()) > LARGEST.most:
        problem = f"the exit points are {np.ptp(anchors, axis=0).max():.4g} m apart"
        yield parts.fault(_ANCHORS, problem, AT_MOST)
    if hull is not None and anchors is not None:
        size_m = float(np.linalg.norm(np.ptp(hull, axis=1)))
        room_m = float(np.linalg.norm(np.ptp(anchors, axis=0)))
        if size_m > room_m:
            problem = f"is {size_m:.3g} m from corner to corner, the exit points {room_m:.3g} m"
            expected = "a box that fits between them; check the unit"
            yield parts.fault("robot.platform.hull", problem, expected)
    for name in ("attachments", "centre_of_mass", "hull"):
        values = parts.array(f"robot.platform.{name}")
        if values is not None and float(np.abs(values).max()) > LARGEST.most:
            problem = f"reaches {np.abs(values).max():.4g} m from the platform's origin"
            yield parts.fault(f"robot.platform.{name}", problem, AT_MOST)


def enough_anchors(parts: Parts) -> Iterator[Fault]:
    """Only in a plane two cables can hold anything."""
    anchors = parts.read(_ANCHORS)
    if anchors is not None and len(anchors) < 3 and not parts.is_planar:
        yield parts.fault(_ANCHORS, "the list has 2 values", "at least 3 points, or planar: true")


def lies_in_plane(parts: Parts) -> Iterator[Fault]:
    """Everything of a planar robot lies in the vertical plane of its anchors."""
    anchors = parts.array(_ANCHORS)
    if anchors is None or not parts.is_planar:
        return
    size = float(np.linalg.norm(np.ptp(anchors, axis=0)))
    plan = parts.seen_from_above(anchors)
    _, spread, axes = np.linalg.svd(plan - plan.mean(axis=0))
    on_line = len(spread) < 2 or spread[1] <= _FLAT * size
    if not (spread[0] > _FLAT * size and on_line):
        problem = "the anchors do not lie in one vertical plane, as robot.planar asks"
        yield parts.fault(_ANCHORS, problem, "anchors on one line, seen from above")
        return
    normal = np.array([-axes[0, 1], axes[0, 0], 0.0]) @ vertical_frame(parts.down)
    for path, values in _vectors(parts, anchors[0], size):
        off = np.abs(values @ normal)
        if off.max() > _FLAT * size:
            expected = "what lies in the vertical plane of the anchors, as robot.planar asks"
            yield parts.fault(path, f"leaves that plane by {off.max():.3g}", expected)
    for path, turns in _turns(parts):
        if np.linalg.norm(np.cross(turns, normal), axis=1).max() > _FLAT:
            yield parts.fault(path, "turns the platform out of the plane", "a turn in the plane")


def _vectors(parts: Parts, origin: FloatArray, size: float) -> Iterator[tuple[str, FloatArray]]:
    """Yield where vectors stand, and the vectors (n, 3), positions from a point of the plane."""
    for path in ("robot.platform.centre_of_mass", _ATTACHMENTS):
        values = parts.array(path)
        if values is not None:
            yield path, np.atleast_2d(values)
    pose, points = parts.read("pose"), parts.array("workspace.region.points")
    if pose is not None:
        yield "pose", np.array([pose.position]) - origin
    if points is not None:
        yield "workspace.region.points", points - origin
    ends = parts.array("workspace.region.rectangle")
    if ends is not None:
        yield "workspace.region.rectangle", np.column_stack([ends, [origin[2]] * 2]) - origin
    turned = parts.read("workspace.orientation")
    if turned is not None and turned.toward is not None:
        yield "workspace.orientation.toward", np.array([turned.toward]) - origin
        yield "workspace.orientation.axis", np.array([turned.axis]) * size
    force = parts.array("robot.platform.wrench.force")
    if force is not None and force.any():
        yield "robot.platform.wrench.force", force[None] * size / np.linalg.norm(force)
    for case in parts.read("load_cases") or ():
        wind = np.zeros(3) if case.wind is None else np.array(case.wind.direction or np.zeros(3))
        for along in (*case.wrenches_N[:, :3], wind):
            if along.any():
                yield "load_cases", along[None] * size / np.linalg.norm(along)


def _turns(parts: Parts) -> Iterator[tuple[str, FloatArray]]:
    """Yield where turns and moments stand, and their axes (n, 3)."""
    pose = parts.read("pose")
    if pose is not None:
        yield "pose", pose.turn_rad[None]
    single, several, *ranges = (parts.read(f"workspace.{kind}") for kind in ORIENTATION_KINDS)
    if single is not None:
        yield "workspace.orientation", single.turn_rad[None]
    if several is not None:
        yield "workspace.orientations", np.array([section.turn_rad for section in several])
    for kind, between in zip(ORIENTATION_KINDS[2:], ranges, strict=True):
        if between is not None:
            yield f"workspace.{kind}", between.bounds_rad
    moment = parts.array("robot.platform.wrench.moment")
    if moment is not None and moment.any():
        yield "robot.platform.wrench.moment", moment[None] / np.linalg.norm(moment)
    for case in parts.read("load_cases") or ():
        for moment in case.wrenches_N[:, 3:]:
            if moment.any():
                yield "load_cases", moment[None] / np.linalg.norm(moment)


def rank(points: FloatArray) -> int:
    """Return 0 for one point, 1 for a line, 2 or more otherwise."""
    spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    return int(np.sum(spread > _FLAT * max(spread[0], np.finfo(float).tiny)))


def winches_fit(parts: Parts) -> Iterator[Fault]:
    """Each cable has a winch, apart from its exit point; with pulleys it comes from below."""
    anchors, positions = parts.array(_ANCHORS), parts.array(_WINCHES)
    if anchors is None or positions is None:
        return
    if any(effect.id == "pulley_radius" for _, effect in parts.declared.effects):
        problem = "with effects.pulley_radius each cable comes to its pulley from straight below"
        yield parts.fault(_WINCHES, problem, "one of the two")
    if len(positions) != len(anchors):
        problem = f"{len(positions)} positions for {len(anchors)} anchors"
        yield parts.fault(_WINCHES, problem, "one for each anchor, in their order")
        return
    distance_m = np.linalg.norm(positions - anchors, axis=1)
    for index in np.flatnonzero((distance_m < _NEAREST_WINCH_M) | (distance_m > LARGEST.most)):
        problem = f"is {distance_m[index]:.4g} m from robot.anchors[{index}]"
        expected = f"{_NEAREST_WINCH_M:g} m or more, so that it has a direction; {AT_MOST}"
        yield parts.fault(_WINCHES, problem, expected, int(index))


def largest_tensions_fit(parts: Parts) -> Iterator[Fault]:
    """A list of the winches' largest tensions has an entry for each cable."""
    anchors, largest = parts.array(_ANCHORS), parts.read(_TENSION_MAX)
    if anchors is None or not isinstance(largest, tuple) or len(largest) == len(anchors):
        return
    problem = f"{len(largest)} tensions for {len(anchors)} anchors"
    yield parts.fault(
        _TENSION_MAX, problem, "one for each anchor, in their order, null for no limit"
    )


def attached_fit(parts: Parts) -> Iterator[Fault]:
    """A list of what is attached has an entry for each cable."""
    anchors, attached = parts.array(_ANCHORS), parts.read(_ATTACHED)
    if anchors is None or not isinstance(attached, tuple) or len(attached) == len(anchors):
        return
    problem = f"{len(attached)} entries for {len(anchors)} anchors"
    yield parts.fault(_ATTACHED, problem, "one for each anchor, in their order, null for nothing")


ROBOT_CHECKS = (
    distinct_cables,
    anchors_span_area,
    moved_anchors_span_area,
    attachments_fit,
    least_tension_is_a_choice,
    point_mass_has_no_body,
    enough_anchors,
    lies_in_plane,
    load_is_not_cancelled,
    strain_stays_small,
    robot_has_a_size,
    winches_fit,
    largest_tensions_fit,
    attached_fit,
)
