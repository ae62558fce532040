"""A config in parts, and checks that need several of its fields.

Each check looks only at parts that are valid in themselves, whatever is wrong with the others, so
that all faults of a file come out together.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cache
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import TypeAdapter, ValidationError
from scipy.spatial import QhullError

from designer.arrays import FloatArray
from designer.documents.bounds import BOUNDS, MAX_CABLES
from designer.documents.columns import COVARIATE, IGNORE, TIME_NAME, cable_of, is_rotation
from designer.documents.document import Data, Document, Key
from designer.documents.fields import kind_at, reader_of
from designer.documents.opened import open_input, reason
from designer.documents.picture import LARGEST_PICTURE_BYTES, why_not_shown
from designer.effects.effect import ALL_ATTACHMENTS, OF_CABLE, Effect
from designer.errors import Fault
from designer.io.config.effects import DeclaredEffects, read_effects
from designer.io.config.machine import attached_each
from designer.io.config.schema import ORIENTATION_KINDS, ColumnSection, StudySection
from designer.model.cable import STANDARD_GRAVITY_M_PER_S2
from designer.model.measurements import POSES
from designer.model.region import Prism, Rectangle
from designer.model.robot import vertical_frame
from designer.spelling import did_you_mean
from designer.units import describe


@dataclass(frozen=True, slots=True)
class StudyParts:
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
        return MAX_CABLES if anchors is None else len(anchors)

    @property
    def declared(self) -> DeclaredEffects:
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
_NEAREST_WINCH_M = 1e-3
_NO_POINT_MASS = "robot.platform.attachments, or leave it out"
_REGION = "workspace.region"
_CASES = "load_cases"
_GROUPS = "selection.groups"
_COLUMNS = "measurements.columns"
_UNCERTAINTY = "uncertainty"
_LOGO = "document.logo"
_UNKNOWN = "measurements.unknown"
_SESSIONS = "measurements.sessions"


def all_faults(document: Document, effects: Mapping[str, Effect]) -> list[Fault]:
    """Return every fault that concerns more than one field of the document, or the effects."""
    parts = StudyParts(document, document.root.data(), effects)
    checks = (
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
        lists_by_cable_fit,
        prism_has_area,
        rectangle_has_area,
        regions_fit_the_plane,
        places_are_near,
        catalogues_exist,
        each_cable_in_one_group,
        fields_go_together,
        path_stands_alone,
        load_cases_fit,
        inertia_is_known,
        effects_are_known,
        columns_fit_the_robot,
        unknowns_are_known,
        logo_is_a_picture,
        unknown_poses_are_identifiable,
        data_have_a_file,
        sessions_have_their_own,
    )
    return [fault for check in checks for fault in check(parts)]


def distinct_cables(parts: StudyParts) -> Iterator[Fault]:
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


def anchors_span_area(parts: StudyParts) -> Iterator[Fault]:
    """Seen from above, the exit points are not on one line, except in a plane."""
    anchors = parts.array(_ANCHORS)
    if anchors is None or parts.is_planar or any(distinct_cables(parts)):
        return
    if len(anchors) > 2 and rank(np.unique(parts.seen_from_above(anchors), axis=0)) < 2:
        problem = "all anchors lie on one line when seen from above"
        yield parts.fault(_ANCHORS, problem, "anchors that span an area in x and y")


def moved_anchors_span_area(parts: StudyParts) -> Iterator[Fault]:
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


def attachments_fit(parts: StudyParts) -> Iterator[Fault]:
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


def least_tension_is_a_choice(parts: StudyParts) -> Iterator[Fault]:
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


def point_mass_has_no_body(parts: StudyParts) -> Iterator[Fault]:
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


def load_is_not_cancelled(parts: StudyParts) -> Iterator[Fault]:
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
        np.zeros(3) if vector is None else vector
        for vector in map(
            parts.array, ("robot.platform.wrench.moment", "robot.platform.centre_of_mass")
        )
    )
    size_N = 1e-9 * float(np.linalg.norm(weight))  # counts as none
    imbalance = (force + weight, moment + np.cross(lever, weight))
    if all(np.linalg.norm(part) <= size_N for part in imbalance):
        problem = "cancels the platform's weight, so there is nothing for the cables to hold"
        yield parts.fault("robot.platform.wrench.force", problem, "a load that is left")


def strain_stays_small(parts: StudyParts) -> Iterator[Fault]:
    """The allowable stress is well below the modulus; else one of them is in another unit."""
    stress_Pa, modulus_Pa = map(parts.read, ("cable.allowable_stress", "cable.youngs_modulus"))
    if stress_Pa is None or modulus_Pa is None or stress_Pa <= _LARGEST_STRAIN * modulus_Pa:
        return
    problem = f"stretches the cable by {stress_Pa / modulus_Pa:.0%}"
    expected = f"at most {_LARGEST_STRAIN:.0%}; check the unit, also that of cable.youngs_modulus"
    yield parts.fault("cable.allowable_stress", problem, expected)


def robot_has_a_size(parts: StudyParts) -> Iterator[Fault]:
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


def enough_anchors(parts: StudyParts) -> Iterator[Fault]:
    """Only in a plane two cables can hold anything."""
    anchors = parts.read(_ANCHORS)
    if anchors is not None and len(anchors) < 3 and not parts.is_planar:
        yield parts.fault(_ANCHORS, "the list has 2 values", "at least 3 points, or planar: true")


def lies_in_plane(parts: StudyParts) -> Iterator[Fault]:
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
    for path, turns in _rotation_axes(parts):
        if np.linalg.norm(np.cross(turns, normal), axis=1).max() > _FLAT:
            yield parts.fault(path, "turns the platform out of the plane", "a turn in the plane")


def _vectors(
    parts: StudyParts, origin: FloatArray, size: float
) -> Iterator[tuple[str, FloatArray]]:
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
    orientation = parts.read("workspace.orientation")
    if orientation is not None and orientation.toward is not None:
        yield "workspace.orientation.toward", np.array([orientation.toward]) - origin
        yield "workspace.orientation.axis", np.array([orientation.axis]) * size
    force = parts.array("robot.platform.wrench.force")
    if force is not None and force.any():
        yield "robot.platform.wrench.force", force[None] * size / np.linalg.norm(force)
    for case in parts.read("load_cases") or ():
        wind = np.zeros(3) if case.wind is None else np.array(case.wind.direction or np.zeros(3))
        for along in (*case.wrenches_N[:, :3], wind):
            if along.any():
                yield "load_cases", along[None] * size / np.linalg.norm(along)


def _rotation_axes(parts: StudyParts) -> Iterator[tuple[str, FloatArray]]:
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


def winches_fit(parts: StudyParts) -> Iterator[Fault]:
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


def lists_by_cable_fit(parts: StudyParts) -> Iterator[Fault]:
    """A list by cable has an entry for each of them."""
    anchors = parts.array(_ANCHORS)
    for path, noun, absent in (
        ("robot.winches.tension_max", "tensions", "no limit"),
        ("robot.attached", "entries", "nothing"),
    ):
        entries = parts.read(path)
        if anchors is not None and isinstance(entries, tuple) and len(entries) != len(anchors):
            problem = f"{len(entries)} {noun} for {len(anchors)} anchors"
            expected = f"one for each anchor, in their order, null for {absent}"
            yield parts.fault(path, problem, expected)


def prism_has_area(parts: StudyParts) -> Iterator[Fault]:
    """Something is left of the prism's base inside the inset."""
    path, base = f"{_REGION}.prism", parts.read(f"{_REGION}.prism")
    corners = parts.array("robot.anchors" if base == "anchors" else path)
    if corners is None:
        return
    if rank(corners[:, :2]) < 2:
        if base != "anchors":  # the anchors have their own check
            yield parts.fault(path, "all corners lie on one line", "corners that span an area")
        return
    inset_m = parts.read(f"{_REGION}.inset") or 0.0
    try:
        Prism.over(corners, inset_m, (0.0, 1.0))
    except (ValueError, QhullError):
        problem = f"nothing of the region is left inside an inset of {inset_m:g} m"
        yield parts.fault(f"{_REGION}.inset", problem, "a smaller inset")


def rectangle_has_area(parts: StudyParts) -> Iterator[Fault]:
    """Something is left of the rectangle's width inside the inset."""
    path, base = f"{_REGION}.rectangle", parts.read(f"{_REGION}.rectangle")
    ends = parts.array("robot.anchors") if base == "anchors" else base
    if ends is None:
        return
    if np.ptp(np.array(ends)[:, :2], axis=0).max() == 0.0:
        yield parts.fault(path, "begins and ends at one point", "two corners that are apart")
        return
    try:
        Rectangle.over(ends, parts.read(f"{_REGION}.inset") or 0.0, (0.0, 1.0))
    except ValueError as error:
        yield parts.fault(path, str(error), "a line that leaves something between its ends")


def places_are_near(parts: StudyParts) -> Iterator[Fault]:
    """The platform is asked to be where the cables can reach."""
    anchors = parts.array("robot.anchors")
    if anchors is None:
        return
    low, high = anchors.min(axis=0) - LARGEST.most, anchors.max(axis=0) + LARGEST.most
    for path, points in _places(parts, anchors.mean(axis=0)):
        axes = points.shape[1]
        off = np.maximum(low[:axes] - points, points - high[:axes])
        if float(off.max()) > 0.0:
            problem = f"lies {off.max() + LARGEST.most:.4g} m from the exit points"
            yield parts.fault(path, problem, AT_MOST)


def _places(parts: StudyParts, middle: FloatArray) -> Iterator[tuple[str, FloatArray]]:
    """Yield where positions stand, and the positions (n, 3), or (n, 2) without a height [m]."""
    pose, box, z_m = parts.read("pose"), *(parts.array(f"{_REGION}.{n}") for n in ("box", "z"))
    if pose is not None:
        yield "pose", np.array([pose.position])
    if box is not None:
        yield f"{_REGION}.box", box.T
    for name in ("points", "prism", "rectangle"):
        points = parts.array(f"{_REGION}.{name}")
        if points is not None:
            yield f"{_REGION}.{name}", points
    if z_m is not None:
        yield f"{_REGION}.z", np.array([[*middle[:2], height_m] for height_m in z_m])


def catalogues_exist(parts: StudyParts) -> Iterator[Fault]:
    """Each extra catalogue is a file or folder beside the config."""
    folder = Path(parts.document.name).parent
    for index, name in _texts(parts.raw("catalogues")):
        with suppress(OSError):  # such as a name longer than the file system takes
            if (folder / name).exists():
                continue
        expected = "a grade file or a folder, relative to this file"
        yield parts.fault("catalogues", f"there is no {describe(name)}", expected, index)


def each_cable_in_one_group(parts: StudyParts) -> Iterator[Fault]:
    """No cable is in two groups, none is left over, and none is named that is not there."""
    groups, anchors = parts.read(_GROUPS), parts.read("robot.anchors")
    if not groups or not anchors:
        return
    n_cables = len(anchors)
    first_use: dict[int, str] = {}
    once = "every cable in exactly one group"
    for name, cables in groups.items():
        for index, cable in enumerate(cables):
            if cable > n_cables:
                problem = f"there is no cable {cable}, the robot has {n_cables}"
                expected = f"a cable from 1 to {n_cables}"
                yield parts.fault(_GROUPS, problem, expected, name, index)
            elif cable in first_use:
                problem = f"cable {cable} is in group '{first_use[cable]}' already"
                yield parts.fault(_GROUPS, problem, once, name, index)
            first_use.setdefault(cable, name)
    missing = [str(cable) for cable in range(1, n_cables + 1) if cable not in first_use]
    if len(missing) == 1:
        yield parts.fault(_GROUPS, f"cable {missing[0]} is in no group", once)
    elif missing:
        listed = f"{', '.join(missing[:-1])} and {missing[-1]}"
        yield parts.fault(_GROUPS, f"cables {listed} are in no group", once)


_NO_WORKSPACE = "a workspace that the rope is to serve, or no selection"
_NO_LIMIT = "has no meaning without selection.groups"
_NO_CASES = "a workspace: a load case is for all its poses"
_NO_ROPE = "a selection: it is the chosen rope that may not be enough"
_NO_WINCHES = "a workspace: winches are held against what they meet in all its poses"
_NO_MOTOR = "robot.winches.motor: {torque: …}, or leave it out"
_NO_USE = "robot.winches.motor: {torque: …} or robot.winches.drum: {length: …}, or leave it out"
_NO_DRUM = "robot.winches.drum_diameter, which tells the torque of a tension"
_PATH = "workspace.path"
_NO_PATH = "workspace.path, along which speed and power are evaluated"
_DRUM, _ETA = "robot.winches.drum", "robot.winches.sheave_efficiency"
_LIFE, _SHEAVE = "selection.rope_life", "selection.sheave_diameter"
_NO_DIAMETER = "robot.winches.drum_diameter beside it"
_NO_SHEAVE = f"{_DRUM}.sheave_distance, which tells the angle"
_NO_ANGLE = f"{_DRUM}.fleet_angle_max, or leave it out"
_NEEDS = (
    *(
        (f"robot.winches.{name}", _PATH, "there is no path, so that nothing moves", _NO_PATH)
        for name in ("speed_max", "motor.speed", "motor.power")
    ),
    ("selection", "workspace", "has no meaning without a workspace", _NO_WORKSPACE),
    (_LIFE, _PATH, "there is no path along which ropes bend", "workspace.path, or leave it out"),
    (_LIFE, _SHEAVE, "the sheaves' diameter is not given", f"{_SHEAVE} beside it"),
    (f"{_LIFE}.days_min", f"{_LIFE}.runs_per_day", "a day has no runs", f"{_LIFE}.runs_per_day"),
    ("selection.max_distinct_products", _GROUPS, _NO_LIMIT, "groups, or neither"),
    (_CASES, "workspace", "there is no workspace", _NO_CASES),
    (_UNCERTAINTY, "selection", "there is no selection", _NO_ROPE),
    *(
        (f"robot.winches.{name}", "robot.winches.motor", "there is no motor to drive it", _NO_MOTOR)
        for name in ("gear_ratio", "efficiency")
    ),
    ("robot.winches.sheaves", _ETA, "nothing is lost on them", f"{_ETA}, or leave it out"),
    (
        "robot.winches.drum",
        "robot.winches.drum_diameter",
        "its diameter is not given",
        _NO_DIAMETER,
    ),
    (f"{_DRUM}.fleet_angle_max", f"{_DRUM}.sheave_distance", "there is no sheave", _NO_SHEAVE),
    (f"{_DRUM}.sheave_distance", f"{_DRUM}.fleet_angle_max", "no angle is asked for", _NO_ANGLE),
    ("robot.winches.motor", "robot.winches.drum_diameter", "there is no drum", _NO_DRUM),
    ("robot.winches", "workspace", "there is no workspace", _NO_WINCHES),
)
"""Fields that another one has to be beside: what is wrong without it, and what is expected."""
_EXCLUDES = (
    (
        _CASES,
        "groups of cables are chosen for the static load alone: wind loads ropes of different "
        "thickness in different directions, and all cables are solved with one",
        "load_cases or groups, not both",
    ),
    (
        _UNCERTAINTY,
        "uncertainty is computed for one rope on all cables",
        "uncertainty or groups, not both",
    ),
    (
        "selection.prefer",
        "the sizes of groups are chosen by the objective alone, whatever their units",
        "prefer or groups, not both",
    ),
)
"""Fields beside which groups of cables may not be."""


def fields_go_together(parts: StudyParts) -> Iterator[Fault]:
    """What each field needs is there, and what excludes another is there alone."""
    paths = {path for path, *_ in (*_NEEDS, *_EXCLUDES) if parts.raw(path) not in (None, [])}
    for path, needed, problem, expected in _NEEDS:
        if path in paths and parts.raw(needed) is None:
            yield parts.fault(path, problem, expected)
    if parts.raw("robot.winches.motor") is None and parts.raw(_DRUM) is None:
        for name in ("drum_diameter", "layers"):
            if parts.raw(f"robot.winches.{name}") is not None:
                problem = "there is no motor to drive it, and no length of the drum"
                yield parts.fault(f"robot.winches.{name}", problem, _NO_USE)
    for path, problem, expected in _EXCLUDES:
        if path in paths and parts.raw(_GROUPS) is not None:
            yield parts.fault(_GROUPS, problem, expected)
    if parts.raw(_GROUPS) is not None and len(attached_each(parts.read("robot.attached"))) > 1:
        problem = "groups of cables are chosen where the same is attached to all of them"
        yield parts.fault(_GROUPS, problem, "one robot.attached for all cables, or no groups")


def path_stands_alone(parts: StudyParts) -> Iterator[Fault]:
    """A path is beside nothing that is not computed in motion."""
    if parts.raw(_PATH) is None:
        return
    expected = "workspace.path, or this beside workspace.poses"
    for path, problem in _NOT_IN_MOTION:
        if parts.raw(path) not in (None, []):
            yield parts.fault(path, f"{problem} along a path", expected)
    if parts.raw("workspace.proof") is not None:
        problem = "the instants of a path are tried one by one, and nothing is proved between them"
        yield parts.fault("workspace.proof", problem, "no such field beside workspace.path")
    for index, case in _load_cases(parts):
        for name, problem in _CASES_NOT_IN_MOTION.items():
            if case.get(name) is not None:
                yield parts.fault(_CASES, problem, "a load case without it", index, name)


_NOT_IN_MOTION = (
    (_GROUPS, "groups of cables are not chosen"),
    (_UNCERTAINTY, "uncertainty is not computed"),
)
_CASES_NOT_IN_MOTION = {
    "acceleration": "the path gives the platform's accelerations itself",
    "cable_lost": "where a moving platform goes without a cable is not computed",
    "temperature_change": "where a moving platform goes on braked winches is not computed",
    "region": "the platform follows workspace.path in every load case",
}


def regions_fit_the_plane(parts: StudyParts) -> Iterator[Fault]:
    """A planar robot has flat regions."""
    if not parts.is_planar:
        return
    problem, expected = "is a solid region, but the robot is planar", "rectangle or points"
    for kind in ("prism", "box"):
        if parts.raw(f"{_REGION}.{kind}") is not None:
            yield parts.fault(f"{_REGION}.{kind}", problem, expected)
            break
    for index, case in _load_cases(parts):
        region = case.get("region")
        if isinstance(region, dict) and ("prism" in region or "box" in region):
            yield parts.fault(_CASES, problem, expected, index, "region")


def _load_cases(parts: StudyParts) -> Iterator[tuple[int, dict[str, Data]]]:
    """Yield the load cases that are mappings, each with its place."""
    cases = parts.raw(_CASES)
    for index, case in enumerate(cases if isinstance(cases, list) else ()):
        if isinstance(case, dict):
            yield index, case


def load_cases_fit(parts: StudyParts) -> Iterator[Fault]:
    """Load cases have names of their own, cables that exist, and what their wind acts on."""
    first_use: dict[str, int] = {}
    for index, case in _load_cases(parts):
        name, lost = case.get("name"), case.get("cable_lost")
        if isinstance(name, str) and first_use.setdefault(name, index) != index:
            problem = f"load_cases[{first_use[name]}] has the name '{name}' already"
            yield parts.fault(_CASES, problem, "a name of its own", index, "name")
        if isinstance(lost, int) and not isinstance(lost, bool) and lost > parts.n_cables:
            problem = f"there is no cable {lost}, the robot has {parts.n_cables}"
            expected = f"1 to {parts.n_cables} or each"
            yield parts.fault(_CASES, problem, expected, index, "cable_lost")
        if lost is not None and parts.n_cables - 1 < (2 if parts.is_planar else 1):
            problem = "too few cables are left"
            yield parts.fault(_CASES, problem, "a robot with more", index, "cable_lost")
        for figure in ("safety_factor", "termination_efficiency"):
            if case.get(figure) is not None and parts.raw("selection") is None:
                problem = "there is no selection whose figure it could replace"
                yield parts.fault(
                    _CASES, problem, "a selection, or a case without it", index, figure
                )
        if case.get("wind") is not None:
            for problem, expected in _why_no_wind(parts):
                yield parts.fault(_CASES, problem, expected, index, "wind")


def _why_no_wind(parts: StudyParts) -> Iterator[tuple[str, str]]:
    """Yield what the wind of a load case lacks, and what is expected."""
    if parts.raw("robot.platform.drag") is None:
        expected = "robot.platform.drag: {area: …, coefficient: …}"
        yield "the platform has no area in the wind", expected
    if len(attached_each(parts.read("robot.attached"))) > 1:
        problem = "wind loads cables to which different things are attached in different directions"
        expected = "the same attached to all cables, or no wind; all are solved with one direction"
        yield problem, expected
    if parts.raw("cable.drag_coefficient") is None:
        expected = "cable.drag_coefficient, such as 1.2; 0 for none"
        yield "the drag of the cables is not given", expected


_FREQUENCY = "selection.limits.platform_frequency"


def inertia_is_known(parts: StudyParts) -> Iterator[Fault]:
    """The inertia of a body is known in every load case where its frequencies have a limit."""
    cases = [*_load_cases(parts)]
    if parts.is_point_mass:
        for index, case in cases:
            if case.get("inertia") is not None:
                problem, expected = "has no meaning for a point mass", "no inertia"
                yield parts.fault(_CASES, problem, expected, index, "inertia")
        return
    if parts.raw(_FREQUENCY) is None:
        return
    if parts.raw("robot.platform.inertia") is None:
        expected = "robot.platform.inertia: [xx, yy, zz]"
        yield parts.fault(_FREQUENCY, "the inertia of the platform is not given", expected)
        return
    for index, case in cases:
        if case.get("mass") is not None and case.get("inertia") is None:
            problem = f"the inertia of the platform with this mass is not given, for {_FREQUENCY}"
            yield parts.fault(_CASES, problem, "inertia beside it", index, "mass")


def effects_are_known(parts: StudyParts) -> Iterator[Fault]:
    """Each effect has an id, parameters and a cable that there are, and leaves a platform."""
    declared, mass_kg = parts.declared, parts.read("robot.platform.mass")
    for flaw in declared.flaws:
        yield parts.document.fault(*flaw)
    for place, effect in declared.effects:
        if effect.id != "platform_mass" or mass_kg is None:
            continue
        if mass_kg + effect.parameters.get("offset_kg", 0.0) <= 0:
            expected = f"more than -{mass_kg:g} kg, minus the platform's own mass"
            yield parts.document.fault((*place, "offset_kg"), "leaves no mass", expected)


def columns_fit_the_robot(parts: StudyParts) -> Iterator[Fault]:
    """Each column goes to a place of its own that the robot has, and a point mass to no turn."""
    first_use: dict[str, str] = {}
    columns, has_files = parts.raw(_COLUMNS), isinstance(parts.raw("measurements.file"), list)
    for name, column in columns.items() if isinstance(columns, dict) else ():
        section = valid(reader_of(ColumnSection), column)
        if section is None or section.to in (IGNORE, COVARIATE):
            continue
        target: str = section.to
        if (cable_of(target) or 0) > parts.n_cables:
            problem = f"{target}: the robot has {parts.n_cables} cables"
            yield parts.fault(_COLUMNS, problem, f"a cable from 1 to {parts.n_cables}", name)
        elif is_rotation(target) and parts.is_point_mass:
            expected = f"robot.platform.attachments, or '{IGNORE}'"
            problem = f"{target} has no meaning for a point mass"
            yield parts.fault(_COLUMNS, problem, expected, name)
        if target in first_use and not (target == TIME_NAME and has_files):
            problem = f"{target} is already the column '{first_use[target]}'"
            yield parts.fault(_COLUMNS, problem, f"another name of ours, or '{IGNORE}'", name)
        first_use.setdefault(target, name)


def unknowns_are_known(parts: StudyParts) -> Iterator[Fault]:
    """What is fitted from the start is an effect, or all exit points together; each once."""
    yield from _unknown_names(parts, parts.raw(_UNKNOWN), _UNKNOWN)


def _unknown_names(parts: StudyParts, names: Data, path: str, *below: Key) -> Iterator[Fault]:
    """Yield what is wrong with a list of unknowns at a path, or below it."""
    seen: set[str] = set()
    together = [effect.also_called for effect in parts.effects.values() if effect.also_called]
    anchors = parts.raw("robot.anchors")
    cables = range(1, (len(anchors) if isinstance(anchors, list) else 0) + 1)
    by_cable = [effect.id for effect in parts.effects.values() if effect.takes_cable]
    of_cables = [f"{name}{OF_CABLE}{k}" for name in by_cable for k in cables]
    unknowns = (*parts.effects, *together, POSES, *of_cables)
    for index, name in _texts(names):
        if name not in unknowns:
            listed = f"{', '.join((*together, POSES))}, or an effect: {', '.join(parts.effects)}"
            expected = listed + did_you_mean(name, unknowns)
            yield parts.fault(path, f"{describe(name)} is not known", expected, *below, index)
        if name in seen:
            yield parts.fault(path, f"'{name}' is given twice", "once", *below, index)
        seen.add(name)


def data_have_a_file(parts: StudyParts) -> Iterator[Fault]:
    """Measurements name a file, or sessions with a file each."""
    data = parts.raw("measurements")
    if not isinstance(data, dict):
        return
    has_file, has_sessions = (data.get(name) is not None for name in ("file", "sessions"))
    if not has_file and not has_sessions:
        expected = "the name of a CSV file, or a list of files; or sessions with a file each"
        yield parts.fault("measurements.file", "is missing", expected)
    if has_file and has_sessions:
        yield parts.fault("measurements.file", "there are sessions as well", "one of the two")


def sessions_have_their_own(parts: StudyParts) -> Iterator[Fault]:
    """What is unknown or known of a session is known to be so, and not of the machine as well."""
    sessions = parts.raw(_SESSIONS)
    if not isinstance(sessions, list):
        return
    of_machine = {name for _, name in _texts(parts.raw(_UNKNOWN))}
    if POSES in of_machine:
        yield parts.fault(_SESSIONS, f"'{POSES}' are unknown", "measured poses in every session")
    declared = {effect.id for _, effect in parts.declared.effects}
    for number, session in enumerate(sessions):
        if not isinstance(session, dict):
            continue
        unknown, place = session.get("unknown"), ("measurements", "sessions", number, "effects")
        yield from _unknown_names(parts, unknown, _SESSIONS, number, "unknown")
        for index, name in _texts(unknown):
            why = "cannot be" if name == POSES else "is unknown of the machine, so cannot be"
            if name in of_machine or name == POSES:
                problem = f"'{name}' {why} of a session"
                yield parts.fault(_SESSIONS, problem, "another", number, "unknown", index)
        declared_there = read_effects(session.get("effects"), parts.n_cables, parts.effects, place)
        for flaw in declared_there.flaws:
            yield parts.document.fault(*flaw)
        for keys, effect in declared_there.effects:
            if effect.id in declared:
                problem = f"'{effect.id}' is declared of the machine, so of all sessions"
                yield parts.document.fault(keys, problem, "one of the two")


def unknown_poses_are_identifiable(parts: StudyParts) -> Iterator[Fault]:
    """Where poses are unknown, attachments and the vertical are not."""
    unknown = {name: index for index, name in _texts(parts.raw(_UNKNOWN))}
    if POSES not in unknown:
        for name in ("position", "rotation"):
            if parts.raw(f"measurements.noise.{name}") is not None:
                problem = "has no use where poses are taken as they were measured"
                expected = f"'{POSES}' in {_UNKNOWN}, by which coordinates are data with a noise"
                yield parts.fault(f"measurements.noise.{name}", problem, expected)
        return
    lost = {ALL_ATTACHMENTS, "attachment_offset", "base_tilt"}
    for name in unknown.keys() & lost:
        problem = f"'{name}' and '{POSES}' are both unknown, and nothing tells one from the other"
        yield parts.fault(_UNKNOWN, problem, "one of them", unknown[name])
    if parts.raw("workspace.region") is None:
        expected = "where the platform may be, since its poses are unknown"
        yield parts.fault("workspace.region", "is missing", expected)


def _texts(data: Data) -> Iterator[tuple[int, str]]:
    """Yield the texts of a list, each with its place."""
    for index, text in enumerate(data if isinstance(data, list) else ()):
        if isinstance(text, str):
            yield index, text


def logo_is_a_picture(parts: StudyParts) -> Iterator[Fault]:
    """The logo is a file that a page can show."""
    name = parts.read(_LOGO)
    if name is None:
        return
    path = Path(parts.document.name).parent / name
    try:
        with open_input(path) as file:
            problem = why_not_shown(file.read(LARGEST_PICTURE_BYTES + 1))
    except FileNotFoundError:
        yield parts.fault(_LOGO, f"there is no file {path}", "a picture, relative to this file")
    except (OSError, ValueError) as error:
        expected = "a picture, relative to this file"
        yield parts.fault(_LOGO, f"{path} cannot be read: {reason(error)}", expected)
    else:
        if problem is not None:
            yield parts.fault(_LOGO, f"{path.name} {problem[0]}", problem[1])
