"""Robot files of WireX (A. Pott), ``.wcrfx``: the ATLAS model in XML, versions 0.31 and 0.32.

Read as WireLib does (its ``RobotData.cpp``): lengths in m, elasticity in Pa, ``weight`` in kg/m.
WireLib writes what nobody entered as well, always with the same values; where a file has exactly
these, it is taken to say nothing, and the user is asked.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path

from designer.documents.bounds import BOUNDS
from designer.documents.xml import Element
from designer.foreign.robot import (
    ForeignRobot,
    ForeignRope,
    Point,
    Remarks,
    held_at_one_point,
    largest_tension_N,
)
from designer.grades.checks import LARGEST_FACTOR_OF_DOUBT

ROOT = "models"
_MASS = 25.0
_CENTRE = (0.0, 1.0, 0.2)
_RADIUS = 0.1
_ROPE = {"elasticity": 110e9, "radius": 0.006, "breaking_load": 40e3, "weight": 0.023}
_WINCH = {("cable", "f_max"): 720.0, ("drum", "r_drum"): 0.1}
"""What WireX writes of a winch where nobody entered anything."""
_FREE, _PLANAR, _POINT, _PLANAR_POINT = "3R3T", "1R2T", "3T", "2T"


def read_wirex(path: Path, root: Element) -> ForeignRobot:
    """Return the robot of a WireX file.

    Raises
    ------
    InputError
        If the file is faulty, or no study can hold such a robot.
    """
    robots = list(root.all("robot"))
    if len(robots) != 1:
        root.refuse(f"the file has {len(robots) or 'no'} robots", "one <robot>")
    robot = robots[0]
    pattern = robot.attributes.get("motionpattern", _FREE)
    if pattern not in (_FREE, _PLANAR, _POINT, _PLANAR_POINT):
        expected = f"{_FREE}, {_PLANAR}, {_POINT} or {_PLANAR_POINT}"
        robot.refuse(f"no study has a platform of the motion pattern '{pattern}'", expected)
    chains = list(robot.need("geometry").all("chain"))
    if not chains:
        robot.need("geometry").refuse("the robot has no cables", "<chain>")
    bases = [chain.need("base") for chain in chains]
    attachments = tuple(_position(chain.need("platform")) for chain in chains)
    if pattern in (_POINT, _PLANAR_POINT):
        held_at_one_point(robot, attachments)
    platform, remarks = robot.find("platform"), Remarks()
    winch = root.find("winch")
    drum_radius_m = _of_winch(winch, "drum", "r_drum")
    if drum_radius_m is not None:
        remarks["robot"] = (
            f"Of the winches the file has: drum radius {drum_radius_m:g} m. No field of a study "
            "takes it.",
        )
    return ForeignRobot(
        file=str(path),
        name=robot.attributes.get("name", "").strip() or path.stem,
        source=f"WireX robot file: {path.name}",
        exit_points_m=tuple(map(_position, bases)),
        attachments_m=attachments,
        mass_kg=_mass(platform, remarks),
        centre_of_mass_m=_centre(platform, remarks),
        plane_normal=(0.0, 0.0, 1.0) if pattern in (_PLANAR, _PLANAR_POINT) else None,
        turns=pattern in (_FREE, _PLANAR),
        tension_max_N=largest_tension_N(_of_winch(winch, "cable", "f_max"), remarks),
        pulley_radius_m=_pulley_radius(bases, remarks),
        rope=_rope(root.find("cable"), remarks),
        remarks=remarks,
    )


def _position(element: Element) -> Point:
    return element.number("x"), element.number("y"), element.number("z")


def _mass(platform: Element | None, remarks: Remarks) -> float | None:
    if platform is None or "mass" not in platform.attributes:
        return None
    mass = platform.number("mass")
    if mass != _MASS:
        return mass
    remarks["robot.platform.mass"] = (
        f"The file has {mass:g} kg, which WireX writes where nobody entered a mass.",
    )
    return None


def _centre(platform: Element | None, remarks: Remarks) -> Point | None:
    element = None if platform is None else platform.find("centerofgravity")
    if element is None:
        return None
    centre = _position(element)
    if centre != _CENTRE:
        return centre
    coordinates = ", ".join(f"{coordinate:g}" for coordinate in centre)
    remarks["robot.platform.centre_of_mass"] = (
        f"The file has [{coordinates}], which WireX writes where nobody entered one.",
    )
    return None


def _rope(cable: Element | None, remarks: Remarks) -> ForeignRope | None:
    """Return the rope; None where the file does not say enough of one."""
    needed = ("radius", "breaking_load", "weight")
    if cable is None or any(name not in cable.attributes for name in needed):
        return None
    figures = {name: cable.number(name) for name in _ROPE if name in cable.attributes}
    if all(value == _ROPE[name] for name, value in figures.items()):
        remarks["cable"] = (
            "The file has the 6 mm rope that WireX writes where nobody entered one.",
        )
        return None
    if min(figures.values()) <= 0.0:
        cable.refuse("the rope has a figure that is zero or less", "figures above zero")
    bound = BOUNDS["rope diameter"]
    if not bound.least <= 2.0 * figures["radius"] <= bound.most:
        radius_words = f"the rope has a radius of {figures['radius']:g} m"
        expected = f"{0.5 * bound.least:g} m to {0.5 * bound.most:g} m: {bound.reason}"
        cable.refuse(radius_words, expected)
    area = math.pi * figures["radius"] ** 2
    rope = ForeignRope(
        density_kg_per_m3=figures["weight"] / area,
        breaking_stress_Pa=figures["breaking_load"] / area,
        youngs_modulus_Pa=figures.get("elasticity"),
    )
    remarks["cable"] = (
        f"A rope of {2e3 * figures['radius']:g} mm, {figures['weight']:g} kg/m, breaking at "
        f"{figures['breaking_load']:g} N; all over the full circle of its diameter.",
        *_unlike_all_known(rope),
    )
    return rope


def _unlike_all_known(rope: ForeignRope) -> Iterator[str]:
    """Yield a remark where each rope of the catalogue is far off in some figure."""
    from designer.grades.registry import load_catalogue

    figures = {name: value for name, value in asdict(rope).items() if value is not None}
    off = min(
        max(abs(math.log(value) - math.log(getattr(fit, name))) for name, value in figures.items())
        for fit in (grade.fit() for grade in load_catalogue(with_plugins=False).grades)
    )
    if off > math.log(LARGEST_FACTOR_OF_DOUBT):
        modulus = f", E {rope.youngs_modulus_Pa / 1e9:.3g} GPa" if rope.youngs_modulus_Pa else ""
        yield (
            f"No rope of the catalogue is near its {rope.density_kg_per_m3:.0f} kg/m³, breaking at "
            f"{rope.breaking_stress_Pa / 1e6:.0f} MPa{modulus}: check radius, weight, elasticity "
            "and breaking load."
        )


def _of_winch(winch: Element | None, tag: str, name: str) -> float | None:
    """Return what the file has of the winches; None where nobody entered it."""
    element = None if winch is None else winch.find(tag)
    if element is None or name not in element.attributes:
        return None
    value = element.number(name)
    return None if value in (0.0, _WINCH[tag, name]) else value


def _pulley_radius(bases: list[Element], remarks: Remarks) -> float | None:
    """Return the radius of the pulleys, where a study can have them and the file says so."""
    pulleys = [base for base in bases if "radius" in base.attributes]
    radii = {item.number("radius") for item in pulleys}
    if not pulleys or radii == {0.0}:
        return None
    if radii == {_RADIUS}:
        remarks["effects"] = (
            "The file has pulleys of 0.1 m, which WireX writes where nobody entered a radius; exit "
            "points are taken as fixed. If the robot has such pulleys:",
            "effects: {pulley_radius: {radius_m: 0.1}}",
        )
        return None
    upward = all("a33" not in item.attributes or item.number("a33") == 1.0 for item in pulleys)
    if len(pulleys) == len(bases) and len(radii) == 1 and upward:
        return radii.pop()
    listed = " and ".join(f"{item:g}" for item in sorted(radii))
    remarks["effects"] = (
        f"The file has pulleys of {listed} m that differ, or that cables do not reach from below: "
        "exit points are taken as fixed.",
    )
    return None
