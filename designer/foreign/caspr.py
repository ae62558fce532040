"""Models of CASPR, the cable robot simulator for MATLAB: one file of bodies, one of cables.

Read as CASPR's own loaders do (github.com/darwinlau/CASPR): gravity acts along −z; the first two
or three coordinates of a joint that moves freely are its position, and the angles after them turn
about the body's own x, y and z; attachments are counted from the joint or from the centre of mass.
"""

from __future__ import annotations

import math
import warnings
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from designer.documents.xml import Element, read_xml
from designer.errors import InputError
from designer.foreign.robot import (
    ORIGIN,
    ForeignRobot,
    Point,
    Remarks,
    held_at_one_point,
    largest_tension_N,
    moved,
)

BODIES, CABLES = "bodies", "cables"
ROOTS = {"bodies_system": BODIES, "links": BODIES, "cables": CABLES}
"""What a file holds, by its outermost element; older files of bodies have no outer one."""

_WITH_WINCH = (
    *("cable_ideal", "cable_linear_spring"),
    *("cable_vsd_torsion_spring", "cable_vsd_flexure_linear", "cable_vsd_polynomial"),
)
_POINT, _PULLEY = "attachment", "base_rotating_pulley"
_NOT_SUPPORTED = {
    "cable_passive_linear_spring": "no study has a spring without a winch",
    "muscle_hill_type": "no study has a muscle",
    "pneumatic_artificial_muscle": "no study has a muscle",
    "screw_base_rotating_pulley": "no study has an exit point that a screw moves",
}
"""With those above, all kinds of cables and attachments that CASPR knows."""


@dataclass(frozen=True, slots=True)
class _Joint:
    """How a joint moves: which axes its first coordinates are, normal of its plane, if it turns."""

    axes: tuple[int, ...]
    normal: Point | None = None
    turns: bool = True


_X, _Y, _Z = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)
_JOINTS = {
    "SPATIAL_EULER_XYZ": _Joint((0, 1, 2)),
    "SPATIAL_QUATERNION": _Joint((0, 1, 2)),
    "SPATIAL": _Joint((0, 1, 2)),
    "T_XYZ": _Joint((0, 1, 2), turns=False),
    "PLANAR_XY": _Joint((0, 1), _Z),
    "PLANAR_XZ": _Joint((0, 2), _Y),
    "PLANAR_YZ": _Joint((1, 2), _X),
    "P_XY": _Joint((0, 1), _Z, turns=False),
    "P_XZ": _Joint((0, 2), _Y, turns=False),
    "P_YZ": _Joint((1, 2), _X, turns=False),
}


def read_caspr(
    path: Path, root: Element, counterpart: Path | None, cable_set: str | None
) -> ForeignRobot:
    """Return the robot of a CASPR model.

    Parameters
    ----------
    path : Path
        Its file of bodies or of cables.
    root : Element
        What is in it.
    counterpart : Path or None
        The file of the other kind; None for the one beside it that CASPR's names lead to.
    cable_set : str or None
        Which of its sets of cables; None for the default of the file.

    Raises
    ------
    InputError
        If a file is missing or faulty, or no study can hold such a robot.
    """
    kind = ROOTS[root.tag]
    suffix = CABLES if kind == BODIES else BODIES
    second = read_xml(counterpart or _beside(path, kind, suffix))
    if ROOTS.get(second.tag) != suffix:
        second.refuse(f"the file holds <{second.tag}>", f"CASPR's {suffix} to {path.name}")
    bodies, cables = (root, second) if kind == BODIES else (second, root)
    return _robot(bodies, _chosen_set(cables, cable_set))


def _beside(path: Path, kind: str, suffix: str) -> Path:
    """Return where CASPR keeps the file of the other kind."""
    before, separator, after = path.name.rpartition(f"_{kind}")
    counterpart = path.with_name(f"{before}_{suffix}{after}")
    if not separator or not counterpart.is_file():
        option = f"--{suffix} FILE"
        problem = f"holds the {kind} alone"
        if separator:
            problem += f", and there is no {counterpart.name} beside it"
        raise InputError.at(path, problem, option)
    return counterpart


def _chosen_set(cables: Element, wanted_id: str | None) -> Element:
    sets = {cable_set.attributes.get("id", ""): cable_set for cable_set in cables.all("cable_set")}
    name = wanted_id if wanted_id is not None else cables.attributes.get("default_cable_set")
    if not sets:
        cables.refuse("the file has no cable set", "<cable_set>")
    if name is None and len(sets) == 1:
        return next(iter(sets.values()))
    names = ", ".join(sets)
    if name is None:
        cables.refuse("the file names no default cable set", f"--cable-set, one of: {names}")
    if name not in sets:
        cables.refuse(f"there is no cable set '{name}'", f"one of: {names}")
    return sets[name]


def _robot(bodies: Element, cable_set: Element) -> ForeignRobot:
    links_of = bodies if bodies.tag == "links" else bodies.need("links")
    links = list(links_of.all("link_rigid"))
    if len(links) != 1:
        description = "no link" if not links else f"{len(links)} links that move against each other"
        links_of.refuse(f"the robot has {description}", "one rigid platform: a study has no more")
    link = links[0]
    joint_element = link.need("joint")
    type_ = joint_element.attribute("type")
    if type_ not in _JOINTS:
        expected = f"a platform that moves freely: {', '.join(_JOINTS)}"
        joint_element.refuse(f"the platform hangs in a joint of type {type_}", expected)
    joint, base = _JOINTS[type_], _point(link.need("parent", "location"))
    centre = _point(link.need("physical", "com_location"))
    ends = [_ends(cable, centre) for cable in _cables(cable_set)]
    exit_points, attachments = (tuple(points) for points in zip(*ends, strict=True))
    position, euler = _initial(joint_element, joint, base)
    remarks: Remarks = {}
    limits = _limits(joint_element, joint, base, remarks)
    if not joint.turns:
        held_at_one_point(cable_set, attachments)
    least_N, largest_N = _tension_limits(cable_set, remarks)
    properties = (cable.find("properties") for cable in cable_set.children)
    names = {child.tag for element in properties if element for child in element.children}
    if names := names - {"force_min", "force_max"}:
        listed = ", ".join(sorted(names))
        remarks["cable"] = (f"Of its cables the file has {listed}; a study has those of its rope.",)
    return ForeignRobot(
        file=bodies.file,
        name=link.attributes.get("name", "").strip()
        or Path(bodies.file).stem.removesuffix("_bodies"),
        source=f"CASPR model: {Path(bodies.file).name} and {Path(cable_set.file).name}, "
        f"cable set '{cable_set.attributes.get('id', '')}'",
        exit_points_m=exit_points,
        attachments_m=attachments,
        mass_kg=link.need("physical", "mass").numbers(1)[0],
        centre_of_mass_m=centre,
        plane_normal=joint.normal,
        turns=joint.turns,
        position_m=position,
        euler_xyz_rad=euler,
        limits_m=limits,
        tension_min_N=least_N,
        tension_max_N=largest_N,
        pulley_radius_m=_pulley_radius(cable_set, remarks),
        remarks=remarks,
    )


def _cables(cable_set: Element) -> list[Element]:
    if not cable_set.children:
        cable_set.refuse("the cable set has no cables", "<cable_ideal> and the like")
    for cable in cable_set.children:
        _require_kind(cable, _WITH_WINCH)
    return cable_set.children


def _require_kind(element: Element, kinds: tuple[str, ...]) -> None:
    if element.tag not in kinds:
        why = _NOT_SUPPORTED.get(element.tag, "CASPR has no such kind")
        expected = f"<{'>, <'.join(kinds)}>"
        element.refuse(f"<{element.tag}> is not supported: {why}", expected)


def _point(element: Element) -> Point:
    x, y, z = element.numbers(3)
    return x, y, z


def _ends(cable: Element, centre: Point) -> tuple[Point, Point]:
    """Return the exit point and the attachment of a cable, whichever the file names first."""
    name = f"cable '{cable.attributes.get('name', '?')}'"
    reference = cable.attributes.get("attachment_reference", "joint")
    exits, attachments = [], []
    for attachment in cable.need("attachments").children:
        _require_kind(attachment, (_POINT, _PULLEY))
        if attachment.tag == _PULLEY:
            exits.append(_point(attachment.need("fixed_location")))
            continue
        link, place = attachment.need("link").numbers(1)[0], _point(attachment.need("location"))
        if link not in (0, 1):
            attachment.refuse(f"{name} is held by link {link:g}", "0, the base, or 1, the platform")
        at = attachment.attributes.get("attachment_reference", reference)
        if at not in ("joint", "com"):
            attachment.refuse(f"{name} has attachments counted from '{at}'", "joint or com")
        if link == 0:
            exits.append(place)
        else:
            attachments.append(moved(place, centre) if at == "com" else place)
    if len(exits) != 1 or len(attachments) != 1:
        counted = f"{len(exits)} points of the base and {len(attachments)} of the platform"
        cable.refuse(f"{name} runs over {counted}", "one of each")
    return exits[0], attachments[0]


def _initial(element: Element, joint: _Joint, base: Point) -> tuple[Point | None, Point | None]:
    """Return position and angles at first; None where the file gives none that a study knows."""
    written = element.attributes.get("q_initial", "").split()
    if len(written) < len(joint.axes):
        return None, ORIGIN
    values = element.numbers(len(written), "q_initial")
    position = moved(base, _along(joint.axes, values))
    angles = values[len(joint.axes) :] if joint.turns else ()
    if element.attributes["type"] == "SPATIAL_EULER_XYZ" and len(angles) == 3:
        return position, (angles[0], angles[1], angles[2])
    if element.attributes["type"] == "SPATIAL_QUATERNION" and len(angles) == 4:
        return position, _euler_xyz_rad(angles)
    if joint.normal is not None and len(angles) == 1:
        x, y, z = (component * angles[0] for component in joint.normal)
        return position, (x, y, z)
    return position, None if any(angles) else ORIGIN


def _euler_xyz_rad(quaternion: tuple[float, ...]) -> Point | None:
    """Return the angles of a quaternion, real part first; None for one of zeros."""
    from scipy.spatial.transform import Rotation

    if not any(quaternion):
        return None
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of turns by 90° about y, for which several angles serve
        x, y, z = Rotation.from_quat(quaternion, scalar_first=True).as_euler("XYZ").tolist()
    return x, y, z


def _along(axes: tuple[int, ...], values: tuple[float, ...]) -> Point:
    point = [0.0, 0.0, 0.0]
    for axis, value in zip(axes, values, strict=False):
        point[axis] = value
    return point[0], point[1], point[2]


def _limits(
    element: Element, joint: _Joint, base: Point, remarks: Remarks
) -> tuple[tuple[float, float], ...] | None:
    """Return the limits of the joint, where the file has some that span a region."""
    written = [element.attributes.get(name, "").split() for name in ("q_min", "q_max")]
    if not all(written):
        return None
    ends = []
    for name, words in zip(("q_min", "q_max"), written, strict=True):
        values = element.numbers(len(words), name)
        ends.append(moved(base, _along(joint.axes, values)))
    box = tuple(zip(*ends, strict=True))
    is_whole = min(map(len, written)) >= len(joint.axes)
    if is_whole and all(box[axis][0] < box[axis][1] for axis in joint.axes):
        return box
    interval = " to ".join(f"[{' '.join(words)}]" for words in written)
    remarks["workspace"] = (f"The limits of the joint in the file span no region: {interval}.",)
    return None


def _pulley_radius(cable_set: Element, remarks: Remarks) -> float | None:
    """Return the radius of the pulleys of all cables, if a study can have them."""
    cables = _cables(cable_set)
    pulleys = [
        pulley
        for cable in cables
        for pulley in cable.need("attachments").all("base_rotating_pulley")
    ]
    if not pulleys:
        return None
    radii = {pulley.need("pulley_radius").numbers(1)[0] for pulley in pulleys}
    upward = all(
        math.isclose(_point(pulley.need("cable_entry_vector"))[2], 1.0) for pulley in pulleys
    )
    if len(pulleys) == len(cables) and len(radii) == 1 and upward:
        return radii.pop()
    remarks["effects"] = (
        "The file has pulleys that differ, or that cables do not reach from below: exit points are "
        "taken as fixed.",
    )
    return None


def _tension_limits(
    cable_set: Element, remarks: Remarks
) -> tuple[float, float | tuple[float | None, ...] | None]:
    """Return the least tension of all cables, and the largest of all or of each."""
    cables = _cables(cable_set)
    forces_N = {force for cable in cables if (force := _force(cable, "force_min")) is not None}
    if len(forces_N) > 1:
        remarks["robot.tension_min"] = ("The file's cables differ; this is the largest.",)
    limits_N = tuple(largest_tension_N(_force(cable, "force_max"), remarks) for cable in cables)
    return max((0.0, *forces_N)), limits_N if len(set(limits_N)) > 1 else limits_N[0]


def _force(cable: Element, name: str) -> float | None:
    """Return a limit of a cable's tension; None where the file has none."""
    element = cable.find("properties", name)
    if element is None:
        return None
    with suppress(ValueError):
        if float(element.text) == math.inf:  # in any case, as MATLAB reads it
            return math.inf
    return element.numbers(1)[0]
