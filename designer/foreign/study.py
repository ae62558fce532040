"""A robot of whatever program's file as a commented study; what the file does not say is marked."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType

import numpy as np

from designer.documents.xml import read_xml
from designer.errors import DesignerError, InputError
from designer.foreign import caspr, wirex
from designer.foreign.robot import ForeignRobot, Importer, Point
from designer.plugins import Plugins, named, registered
from designer.units import DENSITY, FORCE, MASS, STRESS, format_SI

FILL_IN = "fill in"
Importers = Mapping[str, tuple[Importer, str]]
"""By the ending of their files, each with its plugin's label; empty for our own."""
_DOWN = (0.0, 0.0, -1.0)
_FIGURES = "density, youngs_modulus and allowable_stress"


@dataclass(frozen=True, slots=True)
class ImportAnswers:
    """What the user says beside the file, in SI units; None where nothing."""

    mass_kg: float | None = None
    payload_kg: float = 0.0
    centre_of_mass_m: Point | None = None
    position_m: Point | None = None
    gravity: Point | None = None
    grade: str | None = None
    safety_factor: float | None = None


@dataclass(frozen=True, slots=True)
class Gap:
    """A field that is to be filled in: its path, its line, and the option that gives it."""

    field: str
    line: int
    option: str


_OPTIONS = {
    "robot.platform.mass": "--mass",
    "robot.platform.centre_of_mass": "--centre-of-mass",
    "cable": "--grade",
    "cable.youngs_modulus": "--grade",
    "cable.allowable_stress": "--safety-factor",
    "pose": "--pose",
}


def study_text(robot: ForeignRobot, answers: ImportAnswers) -> str:
    """Return the study of a foreign robot as YAML with comments.

    Raises
    ------
    InputError
        If the platform moves in a plane that is not upright.
    """
    gravity, normal = answers.gravity or _DOWN, robot.plane_normal
    if normal is not None and abs(np.dot(normal, gravity)) > 1e-9 * np.linalg.norm(gravity):
        problem = (
            "the platform moves in a plane that is not upright, so that nothing but a table "
            "carries its weight"
        )
        expected = "an upright plane; --gravity where the frame is drawn lying, such as 0,-1,0"
        raise InputError.at(robot.file, problem, expected)
    if answers.position_m is not None:
        robot = replace(robot, position_m=answers.position_m, euler_xyz_rad=(0.0, 0.0, 0.0))
    lines = [
        f"# {_in_one_line(robot.name)}",
        f"# Imported from a {_in_one_line(robot.source)}.",
        f"# Where it says '{FILL_IN}', the file does not tell; the study is refused until all is",
        "# filled in. `designer init --example fast` explains the fields.",
        "",
        f"name: {_quoted(robot.name)}",
        "",
        *_robot(robot, answers),
        "",
        *_remarks(robot, "cable"),
        *_cable(robot, answers),
        "",
        *_pose(robot),
        "",
        *_workspace(robot, answers),
    ]
    effects = list(_remarks(robot, "effects"))
    if robot.pulley_radius_m is not None:
        radius = _number(robot.pulley_radius_m)
        effects.append(f"effects: {{pulley_radius: {{radius_m: {radius}}}}}")
    if effects:
        lines += ["", *effects]
    return "\n".join(lines) + "\n"


def gaps(text: str) -> tuple[Gap, ...]:
    """Return the fields of a study's text that are to be filled in."""
    fields, path = [], list[tuple[int, str]]()
    for number, line in enumerate(text.splitlines(), 1):
        plain = line.split("#", 1)[0].rstrip()
        name, colon, value = plain.strip().partition(":")
        if not colon or name.startswith("-"):
            continue
        depth = len(plain) - len(plain.lstrip())
        path = [*((d, n) for d, n in path if d < depth), (depth, name)]
        if value.strip() == FILL_IN:
            field = ".".join(name for _, name in path)
            fields.append(Gap(field, number, _OPTIONS[field]))
    return tuple(fields)


def _robot(robot: ForeignRobot, answers: ImportAnswers) -> Iterator[str]:
    yield "robot:"
    yield from _remarks(robot, "robot", "  ")
    yield "  anchors:"
    yield from (f"    - {_list(point)}" for point in robot.exit_points_m)
    yield "  platform:"
    yield from _mass(robot, answers)
    if robot.attachments_m is not None:
        yield from _centre_of_mass(robot, answers)
        yield "    attachments:"
        yield from (f"      - {_list(point)}" for point in robot.attachments_m)
    if robot.tension_min_N > 0.0:
        least = format_SI(robot.tension_min_N, FORCE)
        if robot.has_choice:
            yield from _remarks(robot, "robot.tension_min", "  ")
            yield f"  tension_min: {least}"
        else:
            yield f"  # The file asks for {least} at least, which so few cables cannot choose."
    yield from _winches(robot, has_workspace=_box_m(robot, answers) is not None)
    if answers.gravity is not None:
        yield f"  gravity: {_list(answers.gravity)}"
    if robot.plane_normal is not None:
        yield "  planar: true"


def _winches(robot: ForeignRobot, *, has_workspace: bool) -> Iterator[str]:
    """Yield the largest tension, commented out where the study has no poses to hold it in."""
    yield from _remarks(robot, "robot.winches", "  ")
    largest = robot.tension_max_N
    if largest is None:
        return
    limits_N = largest if isinstance(largest, tuple) else (largest,)
    written = ["null" if limit is None else format_SI(limit, FORCE) for limit in limits_N]
    value = f"[{', '.join(written)}]" if isinstance(largest, tuple) else written[0]
    mark = "" if has_workspace else "# "
    yield f"  {mark}winches: {{tension_max: {value}}}"
    if not has_workspace:
        yield "  #   is held against all poses of a workspace."


def _mass(robot: ForeignRobot, answers: ImportAnswers) -> Iterator[str]:
    mass, payload = answers.mass_kg, answers.payload_kg
    if mass is None:
        mass = robot.mass_kg
        yield from _remarks(robot, "robot.platform.mass", "    ")
    if mass is None:
        and_payload = f", with its payload of {format_SI(payload, MASS)}" if payload else ""
        yield f"    mass: {FILL_IN}                       # such as 4000 kg{and_payload}"
    elif payload:
        masses = f"{format_SI(mass, MASS)} and a payload of {format_SI(payload, MASS)}"
        yield f"    mass: {format_SI(mass + payload, MASS)}   # {masses}"
    else:
        yield f"    mass: {format_SI(mass, MASS)}"


def _centre_of_mass(robot: ForeignRobot, answers: ImportAnswers) -> Iterator[str]:
    centre = answers.centre_of_mass_m
    if centre is None:
        centre = robot.centre_of_mass_m
        yield from _remarks(robot, "robot.platform.centre_of_mass", "    ")
        if centre is not None and answers.payload_kg:
            yield "    # Of the empty platform; the payload is taken to have the same."
    yield f"    centre_of_mass: {FILL_IN if centre is None else _list(centre)}"


def _cable(robot: ForeignRobot, answers: ImportAnswers) -> Iterator[str]:
    rope, safety = robot.rope, answers.safety_factor
    if answers.grade is not None:
        and_safety = "" if safety is None else f", safety_factor: {_number(safety)}"
        yield f"cable: {{grade: {json.dumps(answers.grade)}{and_safety}}}"
    elif rope is None:
        yield "# {grade: ID} with an ID of `designer catalog list`, or its figures:"
        yield f"# {_FIGURES}."
        yield f"cable: {FILL_IN}"
    else:
        modulus, stress = rope.youngs_modulus_Pa, rope.breaking_stress_Pa
        yield "cable:"
        yield f"  density: {format_SI(rope.density_kg_per_m3, DENSITY)}"
        quantity = FILL_IN if modulus is None else format_SI(modulus, STRESS)
        yield f"  youngs_modulus: {quantity}"
        yield f"  # It breaks at {format_SI(stress, STRESS)}; divide by a safety factor of yours."
        quantity = FILL_IN if safety is None else format_SI(stress / safety, STRESS)
        yield f"  allowable_stress: {quantity}"


def _pose(robot: ForeignRobot) -> Iterator[str]:
    position, angles = robot.position_m, robot.euler_xyz_rad
    if position is None or angles is None:
        yield "# One pose to size the cables for: [x, y, z] of the platform."
        yield f"pose: {FILL_IN}"
    elif any(angles):
        yield "# Where the file has the platform at first."
        euler = f"{{convention: XYZ, angles: {_list(angles)}}}"
        yield f"pose: {{position: {_list(position)}, euler: {euler}}}"
    else:
        yield f"pose: {_list(position)}"


def _box_m(robot: ForeignRobot, answers: ImportAnswers) -> tuple[tuple[float, float], ...] | None:
    """Return the limits of the joint, which another gravity makes those of another frame."""
    return robot.limits_m if answers.gravity is None else None


def _workspace(robot: ForeignRobot, answers: ImportAnswers) -> Iterator[str]:
    """Yield the box of the joint's limits, or its upright rectangle in a plane."""
    limits = _box_m(robot, answers)
    if limits is None:
        remarks = list(_remarks(robot, "workspace"))
        unknown = "" if remarks or robot.limits_m is not None else "; the file does not tell"
        yield f"# All poses that the cables have to serve{unknown}."
        yield from remarks
        yield "# workspace:"
        yield "#   region: {box: [[xmin, xmax], [ymin, ymax], [zmin, zmax]]}"
        return
    x, y, z = limits
    region = f"{{box: [{', '.join(map(_list, limits))}]}}"
    if robot.plane_normal is not None:
        ends = f"[[{_number(x[0])}, {_number(y[0])}], [{_number(x[1])}, {_number(y[1])}]]"
        region = f"{{rectangle: {ends}, z: {_list(z)}}}"
    yield "# The limits of the platform's joint in the file, without turning."
    yield "workspace:"
    yield f"  region: {region}"
    yield "  samples: 5000"


def _remarks(robot: ForeignRobot, field: str, indent: str = "") -> Iterator[str]:
    return (f"{indent}# {line}" for line in robot.remarks.get(field, ()))


def _in_one_line(text: str) -> str:
    # Else a name could go on beyond its comment.
    return "".join(letter if letter.isprintable() else "?" for letter in " ".join(text.split()))


def _quoted(text: str) -> str:
    """Return a text in quotes; what YAML lets in no file is escaped, as JSON does not."""
    quoted = json.dumps(text, ensure_ascii=False)
    return "".join(x if x.isprintable() else f"\\U{ord(x):08x}" for x in quoted)


def _number(value: float) -> str:
    return f"{value + 0.0:.10g}"  # 0.0 makes a plain zero of −0


def _list(values: tuple[float, ...]) -> str:
    return f"[{', '.join(map(_number, values))}]"


def load_importers(plugins: Plugins) -> tuple[Importers, list[str]]:
    """Return all importers for `read_foreign`, and a line for each that is left out."""
    return registered(plugins, "register_importers", Importer, lambda importer: importer.ending)


def read_foreign(
    path: Path,
    other: Path | None = None,
    cable_set: str | None = None,
    importers: Importers = MappingProxyType({}),
) -> ForeignRobot:
    """Return the robot of a CASPR model (either file of it), a WireX file or a plugin's file.

    Parameters
    ----------
    path : Path
        The file; one whose name ends as no importer's is read as one of ours.
    other : Path or None
        The other file of a CASPR model; None for the one beside it.
    cable_set : str or None
        Which set of cables of a CASPR model; None for the file's default.
    importers : mapping of str to tuple
        See `load_importers`.

    Raises
    ------
    InputError
        If a file is missing or faulty, is of another kind, or no study can hold such a robot.
    PluginError
        If a plugin fails.
    """
    endings = sorted((ending for ending in importers if path.name.endswith(ending)), key=len)
    importer, label = importers[endings[-1]] if endings else (IMPORTERS[0], "")
    parts = (other, cable_set)
    if not importer.has_parts:
        _refuse_parts(path, *parts)
    with named(label, f"fails in reading {path}", DesignerError):
        robot = importer.read(path, *parts) if importer.has_parts else importer.read(path)
        if not isinstance(robot, ForeignRobot):
            raise TypeError(f"it returned {type(robot).__name__}, not a ForeignRobot")
    return robot.as_point_mass()


def _read_model(path: Path, other: Path | None, cable_set: str | None) -> ForeignRobot:
    """Return the robot of a file in XML, told by its outermost element."""
    root = read_xml(path)
    if root.tag in caspr.ROOTS:
        return caspr.read_caspr(path, root, other, cable_set)
    if root.tag != wirex.ROOT:
        roots = f"<{'>, <'.join(caspr.ROOTS)}> of CASPR or <{wirex.ROOT}> of WireX"
        root.refuse(f"the file holds <{root.tag}>", roots)
    _refuse_parts(path, other, cable_set)
    return wirex.read_wirex(path, root)


def _refuse_parts(path: Path, *parts: object) -> None:
    if any(parts):
        expected = "no --cables, --bodies or --cable-set"
        raise InputError.at(path, "is no model of CASPR", expected)


IMPORTERS = [Importer(ending, _read_model, has_parts=True) for ending in (".xml", ".wcrfx")]
"""Our own."""
