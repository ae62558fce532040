"""The machine, its load cases, and regions and orientations as a config has them.

Each section builds its own value. A new kind of region is a section here, in `_REGIONS` and in
`AnyRegion`.
"""

from __future__ import annotations

import math
import re
from abc import abstractmethod
from difflib import get_close_matches
from itertools import product
from typing import Annotated, Literal

import numpy as np
from pydantic import (
    AfterValidator,
    BeforeValidator,
    Discriminator,
    Field,
    StrictBool,
    Tag,
    model_validator,
)
from scipy.spatial.transform import Rotation as SpatialRotation

from designer.arrays import FloatArray, frozen_array
from designer.documents import fields
from designer.documents.bounds import MAX_CABLES
from designer.documents.fields import (
    AngleInterval,
    Rotation,
    Section,
    Text,
    WholeNumber,
    bounded,
    by_list,
    by_word,
    config_field,
    list_of,
    only_word,
    refusal,
)
from designer.model.cable import Attached, AttachedEach
from designer.model.load_case import MAX_WRENCHES, Ice, LoadCase, Wind, WrenchSet
from designer.model.region import PointList, Prism, Rectangle, Region
from designer.model.robot import Platform, Robot
from designer.model.space import Orientations
from designer.model.winches import DEAD_TURNS, MAX_LAYERS, ROPE_OVERSIZE, Drum, Winches
from designer.units import describe

FORMS = ("rotation_vector", "quaternion", "euler")
_LARGEST_NORM_ERROR = 1e-3

_AXES = "three axes such as XYZ, which turn with the body, or xyz, which do not"


def _of_unit_length(parts: tuple[float, float, float, float]) -> tuple[float, ...]:
    length = math.hypot(*parts)
    if abs(length - 1.0) > _LARGEST_NORM_ERROR:
        raise refusal(f"the quaternion has length {length:.6g}", "length 1, as [w, x, y, z]")
    return parts


def _convention(value: object) -> str:
    axes = r"(?!.*(.)\1)(?:[XYZ]{3}|[xyz]{3})"
    if not isinstance(value, str) or not re.fullmatch(axes, value):
        raise refusal(f"{describe(value)} is no order of axes", _AXES)
    return value


def only_one_of(value: object, names: tuple[str, ...] = FORMS, owner: str = "the pose") -> object:
    """Return a mapping unchanged, or refuse it if it has several of these fields."""
    if isinstance(value, dict):
        given_kinds = [name for name in names if value.get(name) is not None]
        if len(given_kinds) > 1:
            raise refusal(f"{owner} has {' and '.join(given_kinds)}", f"one of {', '.join(names)}")
    return value


_Number = Annotated[float, bounded("part of a quaternion")]
Quaternion = Annotated[
    tuple[_Number, _Number, _Number, _Number],
    list_of(4, 4, "four numbers [w, x, y, z]"),
    AfterValidator(_of_unit_length),
]
Convention = Annotated[str, BeforeValidator(_convention)]


class EulerSection(Section):
    """Three turns, one after the other.

    Capital letters name axes that turn with the body (intrinsic), small ones axes that stay
    (extrinsic); the turns are made in the order of the letters.
    """

    convention: Convention = config_field(expected=_AXES)
    """Order of the axes: XYZ turn with the platform, xyz stay."""
    angles: Rotation = config_field(
        "Euler angle", expected="three angles, in the order of the axes"
    )
    """Turned about in the order of the convention."""


_TURN = "Component of the rotation vector: axis times angle, from the platform's frame to the world"
_BETWEEN = f"{_TURN}: from where to where."
ROTATION_VECTOR = Field((0.0, 0.0, 0.0), title="Turn", description=f"{_TURN}.")
QUATERNION = Field(
    None,
    description="Orientation as a unit quaternion [w, x, y, z] from the platform's frame to the "
    "world.",
)
EULER = Field(None, description="Orientation as three turns, one after the other.")


class OrientationSection(Section):
    """How the platform is turned, in one of three forms."""

    rotation_vector: Rotation = ROTATION_VECTOR
    quaternion: Quaternion | None = QUATERNION
    euler: EulerSection | None = EULER

    @model_validator(mode="before")
    @classmethod
    def _from_list(cls, raw: object) -> object:
        return {"rotation_vector": raw} if isinstance(raw, list) else only_one_of(raw)

    def __str__(self) -> str:
        """Return the rotation vector with its unit, for the table of inputs."""
        return f"[{', '.join(f'{angle:.6g}' for angle in self.turn_rad)}] rad"

    @property
    def turn_rad(self) -> FloatArray:
        """Rotation vector (3,) [rad]."""
        return rotation_vector_rad(self.rotation_vector, self.quaternion, self.euler)


class FollowingSection(OrientationSection):
    """How the platform is turned at every position: fixed, or by a law that the position enters."""

    toward: fields.Point | None = config_field("Point that the platform faces")
    """Point that an axis of the platform is turned toward, wherever the platform is."""
    axis: fields.Direction = config_field("Axis that faces it", (0.0, 0.0, 1.0))
    """That axis, in the platform's frame; the turn is the shortest that brings it there."""
    table: fields.Text | None = config_field("Table of orientations")
    """A CSV file with x_m, y_m, z_m and rx_rad, ry_rad, rz_rad, relative to this file; between
    its rows the orientation is interpolated."""

    @model_validator(mode="before")
    @classmethod
    def _from_list(cls, raw: object) -> object:
        if isinstance(raw, dict) and raw.get("axis") and not raw.get("toward"):
            raise refusal("the axis has nothing to face", "toward: [x, y, z] beside it")
        forms = (*FORMS, "toward", "table")
        return {"rotation_vector": raw} if isinstance(raw, list) else only_one_of(raw, forms)


class OrientationRangeSection(Section):
    """Components of the rotation vector between two ends each; zero where left out."""

    rx: AngleInterval | None = Field(None, title="Turn about x", description=_BETWEEN)
    ry: AngleInterval | None = Field(None, title="Turn about y", description=_BETWEEN)
    rz: AngleInterval | None = Field(None, title="Turn about z", description=_BETWEEN)

    @model_validator(mode="after")
    def _has_a_component(self) -> OrientationRangeSection:
        if self.rx is None and self.ry is None and self.rz is None:
            raise refusal("the range is empty", "one or more of rx, ry and rz, as [lower, upper]")
        return self

    @property
    def bounds_rad(self) -> FloatArray:
        """Lowest and highest rotation vector (2, 3) [rad]."""
        return np.array([component or (0.0, 0.0) for component in (self.rx, self.ry, self.rz)]).T


def rotation_vector_rad(
    vector: tuple[float, float, float],
    quaternion: tuple[float, ...] | None,
    euler: EulerSection | None,
) -> FloatArray:
    """Return the orientation as a rotation vector (3,) [rad], from the one form that is given.

    The quaternion is from body to world, scalar first; it is scaled to unit length.
    """
    if quaternion is not None:
        scalar_last = np.roll(quaternion, -1)
        return np.asarray(SpatialRotation.from_quat(scalar_last).as_rotvec())
    if euler is not None:
        return np.asarray(SpatialRotation.from_euler(euler.convention, euler.angles).as_rotvec())
    return np.array(vector)


_ENDS = "'anchors' or two corners [[x, y], [x, y]]"
_CORNERS = "'anchors' or a list of at least 3 corners [x, y]"

Corners = Annotated[tuple[fields.Corner, ...], list_of(3, 1000, _CORNERS)]
Ends = Annotated[tuple[fields.Corner, fields.Corner], list_of(2, 2, _ENDS)]
Positions = Annotated[
    tuple[fields.Point, ...], list_of(1, 50_000, "1 to 50000 positions [x, y, z]")
]
Box = Annotated[
    tuple[fields.Interval, fields.Interval, fields.Interval],
    list_of(3, 3, "[[xmin, xmax], [ymin, ymax], [zmin, zmax]]"),
]


PrismBase = Annotated[
    Annotated[Literal["anchors"], only_word("anchors", _CORNERS), Tag("a word")]
    | Annotated[Corners, Tag("a list")],
    by_word("a list"),
]
RectangleBase = Annotated[
    Annotated[Literal["anchors"], only_word("anchors", _ENDS), Tag("a word")]
    | Annotated[Ends, Tag("a list")],
    by_word("a list"),
]


_INSET = Field(
    0.0,
    description="How far the outline of the region is moved inward from the outline of the anchors "
    "or corners.",
)


class RegionSection(Section):
    """A region, by its kind."""

    @abstractmethod
    def over(self, exit_points_m: FloatArray) -> Region:
        """Return the region over these exit points (n_cables, 3) [m].

        Raises
        ------
        ValueError
            If nothing is left of it.
        """


class PrismSection(RegionSection):
    """An upright prism over the anchors or over corners of one's own."""

    prism: PrismBase = config_field("Corner", expected=_CORNERS)
    """Corner of the region's outline, seen from above."""
    inset: fields.Distance = _INSET
    z: fields.Interval = config_field("Height", expected="[lower, upper]")
    """Lowest and highest z of the region."""

    def over(self, exit_points_m: FloatArray) -> Region:
        corners = exit_points_m if self.prism == "anchors" else self.prism
        return Prism.over(corners, self.inset, self.z)


class BoxSection(RegionSection):
    """An axis-parallel box."""

    box: Box = config_field(expected="[[xmin, xmax], [ymin, ymax], [zmin, zmax]]")
    """From where to where the region reaches along each axis."""

    def over(self, exit_points_m: FloatArray) -> Region:
        return Prism.box(*self.box)


class PointsSection(RegionSection):
    """A list of positions."""

    points: Positions = config_field("Point", expected="a list of positions [x, y, z]")
    """Position that the platform shall be able to take."""

    def over(self, exit_points_m: FloatArray) -> Region:
        return PointList(frozen_array(self.points))


class RectangleSection(RegionSection):
    """An upright rectangle over the line between two corners, or over anchors on a line."""

    rectangle: RectangleBase = config_field("End", expected=_ENDS)
    """End of the region's lower edge, seen from above."""
    inset: fields.Distance = _INSET
    z: fields.Interval = config_field("Height", expected="[lower, upper]")
    """Lowest and highest z of the region."""

    def over(self, exit_points_m: FloatArray) -> Region:
        ends = exit_points_m if self.rectangle == "anchors" else self.rectangle
        return Rectangle.over(ends, self.inset, self.z)


_REGIONS: dict[str, type[RegionSection]] = {
    "prism": PrismSection,
    "box": BoxSection,
    "points": PointsSection,
    "rectangle": RectangleSection,
}
*_FIRST, _LAST = _REGIONS
_KINDS = f"{', '.join(_FIRST)} and {_LAST}"


def _kinds_named(region: dict[str, object]) -> list[str]:
    """Return the kinds of region that the fields stand for, misspelt ones if there is no other."""
    names = [name for name, value in region.items() if value is not None]
    nearest = [kind for name in names for kind in get_close_matches(name, _REGIONS, n=1)]
    return [kind for kind in _REGIONS if kind in names] or nearest


def _of_one_kind(value: object) -> object:
    if not isinstance(value, dict):
        raise refusal(f"{describe(value)} is not a mapping", f"one of {_KINDS} in it")
    kinds = _kinds_named(value)
    if len(kinds) != 1:
        kinds_text = " and ".join(kinds) or "none of the kinds"
        raise refusal(f"the region has {kinds_text}", f"exactly one of {_KINDS}")
    return value


AnyRegion = Annotated[
    Annotated[PrismSection, Tag("prism region")]
    | Annotated[BoxSection, Tag("box region")]
    | Annotated[PointsSection, Tag("points region")]
    | Annotated[RectangleSection, Tag("rectangle region")],
    Discriminator(lambda raw: f"{_kinds_named(raw)[0]} region"),
    BeforeValidator(_of_one_kind),
]


_points = list_of(2, MAX_CABLES, f"3 to {MAX_CABLES} points [x, y, z], 2 in a plane")

Anchors = Annotated[tuple[fields.Point, ...], _points]
WinchPositions = Annotated[tuple[fields.Point, ...], _points]
Attachments = Annotated[tuple[fields.Point, ...], _points]


class WrenchSection(Section):
    """Constant load beside gravity, along the axes of the world frame."""

    force: fields.Forces = config_field("Force on the platform", (0.0, 0.0, 0.0))
    """Constant force beside the weight, along the axes of the world frame."""
    moment: fields.Moments = config_field("Moment on the platform", (0.0, 0.0, 0.0))
    """Constant moment about the origin of the platform's frame, along the axes of the world."""

    @property
    def wrench_N(self) -> FloatArray:
        """Force and moment (6,) [N, N·m]."""
        return frozen_array([*self.force, *self.moment])


class DragSection(Section):
    """What the wind finds of the platform."""

    area: fields.DragArea = config_field(
        "Area across the wind", expected="an area such as '1.2 m^2'"
    )
    """Of the platform, as the wind of a load case finds it."""
    coefficient: fields.DragCoefficient = config_field(
        "Drag of the platform", expected="a drag coefficient such as 1.1"
    )
    """Force of the wind over its pressure times the area."""
    centre: fields.Point | None = config_field("Centre of the drag")
    """Where the wind acts, in the platform's own frame; at the centre of mass unless given."""


class PlatformSection(Section):
    """What the cables carry."""

    mass: fields.Mass = config_field("Platform with payload", expected="a mass such as '4000 kg'")
    """Mass that the cables carry: the platform with its payload."""
    attachments: Attachments | None = config_field("Attachment")
    """Where the cable holds the platform, in the platform's own frame."""
    centre_of_mass: fields.Point = (0.0, 0.0, 0.0)
    """Where the platform's weight acts, in its own frame."""
    inertia: fields.Inertias | None = config_field("Inertia of the platform")
    """Moments of inertia about the centre of mass, along the axes of the platform's frame: xx, yy,
    zz, and the entries xy, xz, yz of the matrix where they are not zero. For frequencies."""
    hull: Box | None = config_field("Hull of the platform")
    """Box, in the platform's own frame, that cables shall keep clear of."""
    wrench: WrenchSection = WrenchSection()
    """Constant load beside the weight, at the origin of the platform's frame."""
    drag: DragSection | None = None
    """What the wind of a load case finds of the platform."""

    def platform(self) -> Platform:
        """Return the platform."""
        centre = None if self.drag is None else self.drag.centre
        return Platform(
            self.mass,
            None if self.attachments is None else frozen_array(self.attachments),
            frozen_array(self.centre_of_mass),
            None if self.hull is None else frozen_array(list(product(*self.hull))),
            self.wrench.wrench_N,
            drag_area_m2=None if self.drag is None else self.drag.area * self.drag.coefficient,
            drag_centre_m=None if centre is None else frozen_array(centre),
            inertia_kg_m2=None if self.inertia is None else fields.symmetric(self.inertia),
        )


class MotorSection(Section):
    """The motor of a winch."""

    torque: fields.Torque = config_field("Torque of a motor", expected="a torque such as '40 N*m'")
    """Torque that the motor may give while it holds a load or slowly pulls it."""
    speed: fields.RotationalSpeed | None = config_field("Speed of a motor")
    """Fastest that the motor turns, along workspace.path."""
    power: fields.Power | None = config_field("Power of a motor")
    """Power that the motor may give or take, along workspace.path."""


class DrumSection(Section):
    """The drum of a winch, which takes up the rope in layers."""

    length: fields.SheaveDiameter = config_field(
        "Length of the drum", expected="a length such as '0.8 m'"
    )
    """Between the flanges."""
    groove_pitch: fields.RopeDiameter | None = config_field("Pitch of the grooves")
    """From turn to turn; left out, the drum is smooth and turns touch."""
    dead_turns: Annotated[int, WholeNumber(0, 100)] = config_field("Dead turns", DEAD_TURNS)
    """Turns of the lowest layer that stay on the drum."""
    sheave_distance: fields.Clearance | None = config_field("Distance of the first sheave")
    """From the axis of the drum to the first sheave, which is opposite the drum's middle."""
    fleet_angle_max: fields.FleetAngle | None = config_field("Largest fleet angle")
    """Between the rope at a flange and the plane across the axis. For grooved drums of several
    layers LEBUS International advises 0.25 to 1.25 deg, for one layer 3 deg at most."""
    rope_oversize: fields.RopeOversize = config_field("Oversize of the rope", ROPE_OVERSIZE)
    """By how much a rope may be thicker than nominal, for what a smooth drum takes up; steel wire
    ropes by up to 5 % (EN 12385-4)."""

    def drum(self, diameter_m: float, layers: int) -> Drum:
        """Return the drum, of this diameter."""
        return Drum(
            diameter_m,
            self.length,
            layers,
            self.groove_pitch,
            self.dead_turns,
            self.sheave_distance,
            self.fleet_angle_max,
            self.rope_oversize,
        )


ConfiguredTensionMax = Annotated[
    Annotated[fields.BreakingLoad, Tag("of all winches")]
    | Annotated[
        tuple[fields.BreakingLoad | None, ...],
        list_of(2, MAX_CABLES, "one for each cable, null for no limit"),
        Tag("of each winch"),
    ],
    by_list("of each winch", "of all winches"),
]


def tension_max_each(
    configured: float | tuple[float | None, ...] | None,
) -> FloatArray | float | None:
    """Return the largest tension of all winches, or of each where they differ [N]."""
    if not isinstance(configured, tuple):
        return configured
    if len(set(configured)) == 1:
        return configured[0]
    return frozen_array([np.inf if largest is None else largest for largest in configured])


class WinchesSection(Section):
    """The winches, one for each cable and all alike but for their largest tension."""

    tension_max: ConfiguredTensionMax | None = config_field("Largest tension of a winch")
    """Largest tension of a cable at its exit point, or with sheave_efficiency at its drum, in every
    load case: the same of all winches, or a list with one for each cable, in the order of the
    anchors, null for no limit."""
    speed_max: fields.RopeSpeed | None = config_field("Largest speed of a winch")
    """Fastest that a winch hauls in or pays out strained rope, along workspace.path."""

    positions: WinchPositions | None = config_field("Winch")
    """Where the cable comes from to its exit point: its winch, or the last sheave before that;
    tells the direction of that branch. With pulleys it comes from below."""

    drum_diameter: fields.SheaveDiameter | None = config_field("Drum of a winch")
    """Diameter of the drum at the bottom of its grooves."""
    layers: Annotated[int, WholeNumber(1, MAX_LAYERS)] = config_field("Layers on the drum", 1)
    """Layers of rope on the drum at most; torque is that on the outermost."""
    gear_ratio: fields.GearRatio = config_field("Gear ratio", 1.0)
    """Turns of the motor for one of the drum."""
    efficiency: fields.Efficiency = config_field("Efficiency of a winch", 1.0)
    """Share of the motor's work that the drum gives to the rope: gear and drum, with the sheaves
    where sheave_efficiency is left out."""
    sheave_efficiency: fields.SheaveEfficiency = config_field("Efficiency of a sheave", 1.0)
    """Tension before a sheave over that behind it as the rope is hauled in, bending and bearing
    together. Between the last sheave and the drum the rope bears the tension at the exit point over
    this to the power of sheaves, and its strength is held against that; paid out, times that. Wire
    Rope Users Manual: 1/1.04 on rolling, 1/1.09 on plain bearings. A fit to measured data takes the
    effect pulley_friction instead."""
    sheaves: Annotated[int, WholeNumber(1, 20)] = config_field("Sheaves of a cable", 1)
    """Between platform and drum, that at the exit point among them; left out, that one alone."""
    motor: MotorSection | None = None
    """The motor of a winch."""
    drum: DrumSection | None = None
    """How much rope the drum takes up, and how far aside it runs."""

    def winches(self) -> Winches:
        """Return the winches."""
        return Winches(
            tension_max_each(self.tension_max),
            None if self.positions is None else frozen_array(self.positions),
            self.drum_diameter,
            self.layers,
            self.gear_ratio,
            self.efficiency,
            None if self.motor is None else self.motor.torque,
            self.speed_max,
            None if self.motor is None else self.motor.speed,
            None if self.motor is None else self.motor.power,
            drum=None
            if self.drum is None or self.drum_diameter is None
            else self.drum.drum(self.drum_diameter, self.layers),
            sheave_efficiency=self.sheave_efficiency,
            sheaves=self.sheaves,
        )


class AttachedSection(Section):
    """What is clipped along a cable, such as a power line or a hose; it bears no tension."""

    linear_mass: fields.LinearDensity = config_field(
        "Mass along the cables", expected="a mass per length such as '0.4 kg/m'"
    )
    """Mass per length of what is clipped along a cable: it hangs on the rope, and is none of the
    rope's own mass, price and stiffness."""
    diameter: fields.RopeDiameter = config_field(
        "Diameter along the cables", expected="a length such as '12 mm'"
    )
    """Diameter of what is clipped along a cable, beside the rope in wind and ice. Clearances are
    those of the ropes' axes, without it."""

    @property
    def attached(self) -> Attached:
        """What it is."""
        return Attached(self.linear_mass, self.diameter)


def attached_each(
    configured: AttachedSection | tuple[AttachedSection | None, ...] | None,
) -> AttachedEach:
    """Return what is attached to each cable; one entry where all are alike, none of nothing."""
    sections = configured if isinstance(configured, tuple) else (configured,)
    lines = tuple(Attached() if section is None else section.attached for section in sections)
    if len(set(lines)) > 1:
        return lines
    return lines[:1] if lines[0] != Attached() else ()


ConfiguredAttached = Annotated[
    Annotated[AttachedSection, Tag("along all cables")]
    | Annotated[
        tuple[AttachedSection | None, ...],
        list_of(2, MAX_CABLES, "one for each cable, null for nothing"),
        Tag("along each cable"),
    ],
    by_list("along each cable", "along all cables"),
]


class RobotSection(Section):
    """The machine."""

    anchors: Anchors = config_field("Exit point", expected="at least 3 exit points [x, y, z]")
    """Where the cable leaves the base, in the world frame, z upward."""
    platform: PlatformSection = config_field(expected="a mapping with the platform's mass")
    """What the cables carry."""
    gravity: fields.Direction = (0.0, 0.0, -1.0)
    """Where things fall; only its direction counts."""
    planar: StrictBool = False
    """Whether the robot lies in one vertical plane."""
    tension_min: fields.Tension = config_field("Least tension", 0.0)
    """Least tension anywhere in any cable, where there are more cables than degrees of
    freedom."""
    winches: WinchesSection = WinchesSection()
    """What pulls the cables."""
    attached: ConfiguredAttached | None = None
    """What is clipped along each cable, such as a power line or a hose: the same along all, or a
    list with one for each cable, in the order of the anchors, null for nothing."""

    def robot(self) -> Robot:
        """Return the robot."""
        return Robot(
            frozen_array(self.anchors),
            self.platform.platform(),
            tension_min_N=self.tension_min,
            gravity_direction=frozen_array(self.gravity),
            is_planar=self.planar,
            winches=self.winches.winches(),
            attached=attached_each(self.attached),
        )


_DRAG = Field(
    None,
    title="Drag of the cables",
    description="Force of a load case's wind over its pressure times the cables' diameter and "
    "length.",
)
_EXPANSION = Field(
    None,
    title="Thermal expansion of the cables",
    description="Strain per change of temperature in load cases; left out, that of the rope's "
    "table, or that of steel, 12e-6 /K.",
)


class CableSection(Section):
    """The continuous family of cables in which the optimum is computed."""

    density: fields.Density = config_field(expected="a density such as '7800 kg/m^3'")
    """Mass per length over the area of the circle of the nominal diameter, of the family in
    which the optimum is computed."""
    youngs_modulus: fields.YoungsModulus = config_field(
        "Modulus", expected="a modulus such as '200 GPa'"
    )
    """Force per strain over the area of the circle of the nominal diameter."""
    allowable_stress: fields.Stress = config_field(expected="a stress such as '180 MPa'")
    """Allowable tension over the area of the circle of the nominal diameter, safety factor
    included."""
    drag_coefficient: fields.DragCoefficient | None = _DRAG
    thermal_expansion: fields.Expansion | None = _EXPANSION


class GradeCableSection(Section):
    """The continuous family of a rope grade."""

    grade: Text = config_field(expected="a grade id from `designer catalog list`")
    """Id of a grade, from `designer catalog list`."""
    safety_factor: fields.SafetyFactor | None = config_field("Safety factor of the family")
    """Breaking load over allowable tension of the grade that the optimum is computed in."""
    drag_coefficient: fields.DragCoefficient | None = _DRAG
    thermal_expansion: fields.Expansion | None = _EXPANSION


def _cable_tag(value: object) -> str:
    names_grade = isinstance(value, dict | GradeCableSection) and "grade" in dict(value)
    return "grade of a cable" if names_grade else "figures of a cable"


ConfiguredCable = Annotated[
    Annotated[CableSection, Tag("figures of a cable")]
    | Annotated[GradeCableSection, Tag("grade of a cable")],
    Discriminator(_cable_tag),
]


LostCable = Annotated[
    Annotated[Literal["each"], only_word("each", "'each' or the number of a cable"), Tag("a word")]
    | Annotated[int, WholeNumber(1, MAX_CABLES), Tag("a number")],
    by_word("a number"),
]

Directions = Annotated[
    Annotated[Literal["all"], only_word("all", "'all' or a number of directions"), Tag("a word")]
    | Annotated[int, WholeNumber(1, 72), Tag("a number")],
    by_word("a number"),
]


class WindSection(Section):
    """Wind of one speed, from the worst horizontal direction, from so many or along one."""

    speed: fields.Speed = config_field("Wind in load case", expected="a speed such as '20 m/s'")
    """Speed of the wind, horizontal; it acts on the platform and on the cables."""
    directions: Directions | None = config_field("Winds in load case")
    """From how many directions, evenly spread, the wind may come; all searches for the
    worst."""
    direction: fields.Direction | None = None
    """Where the wind blows to; instead of `directions`."""

    @model_validator(mode="before")
    @classmethod
    def _one_kind_of_direction(cls, value: object) -> object:
        return only_one_of(value, ("directions", "direction"), "the wind")

    def wind(self, drag_coefficient: float) -> Wind:
        """Return the wind on cables of this drag."""
        count = None if isinstance(self.directions, str) else self.directions
        along = None if self.direction is None else frozen_array(self.direction)
        return Wind(self.speed, drag_coefficient, count, along)


class IceSection(Section):
    """Ice around the cables."""

    thickness: fields.IceThickness = config_field(
        "Ice in load case", expected="a length such as '10 mm'"
    )
    """Thickness of the ice around the cables."""
    density: fields.Density = config_field("Density of ice in load case", 900.0)
    """Of the ice around the cables."""


class CaseWrenchSection(WrenchSection):
    """Constant load beside gravity, along the axes of the world frame."""

    force: fields.Forces = config_field("Force in load case", (0.0, 0.0, 0.0))
    """Constant force on the platform in this case, along the axes of the world frame."""
    moment: fields.Moments = config_field("Moment in load case", (0.0, 0.0, 0.0))
    """Constant moment on the platform in this case, along the axes of the world frame."""


class ListedWrenchSection(WrenchSection):
    """One of several constant loads of a load case."""

    force: fields.Forces = config_field("Force of the set in load case", (0.0, 0.0, 0.0))
    """Force on the platform, along the axes of the world frame."""
    moment: fields.Moments = config_field("Moment of the set in load case", (0.0, 0.0, 0.0))
    """Moment on the platform, along the axes of the world frame."""


_NO_RANGES = ((0.0, 0.0), (0.0, 0.0), (0.0, 0.0))


class WrenchBoxSection(Section):
    """All wrenches whose forces and moments lie between two ends, each for itself."""

    force: fields.ForceRanges = config_field("Force of the set in load case", _NO_RANGES)
    """From where to where the force reaches along each axis of the world frame."""
    moment: fields.MomentRanges = config_field("Moment of the set in load case", _NO_RANGES)
    """From where to where the moment reaches about each axis of the world frame."""


ConfiguredWrenchSet = Annotated[
    Annotated[WrenchBoxSection, Tag("a box")]
    | Annotated[
        tuple[ListedWrenchSection, ...],
        list_of(1, MAX_WRENCHES, f"1 to {MAX_WRENCHES} wrenches {{force: …, moment: …}}"),
        Tag("a list"),
    ],
    by_list("a list", "a box"),
]


def wrench_set_of(
    configured: WrenchBoxSection | tuple[ListedWrenchSection, ...] | None,
) -> WrenchSet | None:
    """Return the wrenches of a load case."""
    if configured is None:
        return None
    if isinstance(configured, WrenchBoxSection):
        return WrenchSet.between(*frozen_array([*configured.force, *configured.moment]).T)
    return WrenchSet(frozen_array([section.wrench_N for section in configured]))


class LoadCaseSection(Section):
    """One load case; what it leaves out is as in the rest of the study."""

    name: Text = config_field(expected="a name such as 'hoisting'")
    """What the report calls the case."""
    mass: fields.Mass | None = config_field("Mass in load case")
    """Mass of the platform with its payload in this case, instead of the study's."""
    inertia: fields.Inertias | None = config_field("Inertia in load case")
    """Of the platform with its payload in this case, as the platform's; where the case changes the
    mass and gives none, natural frequencies are not computed in it."""
    wrench: CaseWrenchSection | None = None
    """Constant load on the platform in this case, instead of the robot's."""
    wrench_set: ConfiguredWrenchSet | None = None
    """Constant loads of which any one may act, instead of the robot's: a list, or a box
    {force: [[lowest, highest], …, …], moment: …}. The corners of a box are held, and between them
    is searched."""
    dynamic_factor: fields.DynamicFactor = config_field("Dynamic factor in load case", 1.0)
    """On the weight and the wrench of the platform, not on the cables' own weight."""
    acceleration: fields.Acceleration = config_field("Acceleration in load case", 0.0)
    """Of the platform, in the direction in which its inertia force is worst."""
    wind: WindSection | None = None
    """Wind on the platform and on the cables."""
    ice: IceSection | None = None
    """Ice around the cables."""
    cable_lost: LostCable | None = config_field("Cable lost in load case")
    """Number of the cable that breaks."""
    temperature_change: fields.TemperatureChange | None = config_field(
        "Change of temperature in load case"
    )
    """Of the cables since the pose was reached; the winches are braked and the lengths kept, so
    that the platform comes to rest elsewhere."""
    safety_factor: fields.SafetyFactor | None = config_field("Safety factor in load case")
    """Instead of that of the selection."""
    termination_efficiency: fields.Efficiency | None = config_field(
        "End fittings keep in load case"
    )
    """Share of the breaking load, instead of that of the selection."""
    region: AnyRegion | None = None
    """Where the platform is in this case, instead of the workspace's region."""

    @property
    def wrenches_N(self) -> FloatArray:
        """Forces and moments (n, 6) that it names; of a box the corners [N, N·m]."""
        several = wrench_set_of(self.wrench_set)
        if several is not None:
            return several.wrenches_N
        return np.zeros((0, 6)) if self.wrench is None else self.wrench.wrench_N[None]

    @model_validator(mode="before")
    @classmethod
    def _one_kind_of_wrench(cls, value: object) -> object:
        return only_one_of(value, ("wrench", "wrench_set"), "the load case")

    def load_case(
        self,
        cable: CableSection | GradeCableSection,
        region: Region | None,
        orientations: Orientations | None,
    ) -> LoadCase:
        """Return the load case, on cables of a family, over its region."""
        return LoadCase(
            name=self.name,
            mass_kg=self.mass,
            inertia_kg_m2=None if self.inertia is None else fields.symmetric(self.inertia),
            wrench_N=None if self.wrench is None else self.wrench.wrench_N,
            dynamic_factor=self.dynamic_factor,
            acceleration_m_per_s2=self.acceleration,
            wind=None if self.wind is None else self.wind.wind(cable.drag_coefficient or 0.0),
            ice=None if self.ice is None else Ice(self.ice.thickness, self.ice.density),
            cable_lost=self.cable_lost,
            temperature_change_K=self.temperature_change,
            expansion_per_K=cable.thermal_expansion,
            safety_factor=self.safety_factor,
            termination_efficiency=self.termination_efficiency,
            region=region,
            orientations=orientations,
            wrench_set=wrench_set_of(self.wrench_set),
        )
