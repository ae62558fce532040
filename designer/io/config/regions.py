"""Regions that a config may name, each a section that builds its own, and orientations in them.

A new kind of region is a section here, in `_REGIONS` and in `AnyRegion`.
"""

from __future__ import annotations

import math
import re
from abc import abstractmethod
from difflib import get_close_matches
from typing import Annotated, Literal

import numpy as np
from pydantic import AfterValidator, BeforeValidator, Discriminator, Field, Tag, model_validator
from scipy.spatial.transform import Rotation as SpatialRotation

from designer.arrays import FloatArray, frozen_array
from designer.documents import fields
from designer.documents.fields import Rotation, Turn, bounded, list_of, only_word, refusal
from designer.documents.section import Section, config_field
from designer.model.region import PointList, Prism, Rectangle, Region
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
    def _from_list(cls, given: object) -> object:
        return {"rotation_vector": given} if isinstance(given, list) else only_one_of(given)

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
    def _from_list(cls, given: object) -> object:
        if isinstance(given, dict) and given.get("axis") and not given.get("toward"):
            raise refusal("the axis has nothing to face", "toward: [x, y, z] beside it")
        forms = (*FORMS, "toward", "table")
        return {"rotation_vector": given} if isinstance(given, list) else only_one_of(given, forms)


class OrientationRangeSection(Section):
    """Components of the rotation vector between two ends each; zero where left out."""

    rx: Turn | None = Field(None, title="Turn about x", description=_BETWEEN)
    ry: Turn | None = Field(None, title="Turn about y", description=_BETWEEN)
    rz: Turn | None = Field(None, title="Turn about z", description=_BETWEEN)

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


def word_or_list(value: object) -> str:
    """Return the tag of a value that may be a word or a list."""
    return "a word" if isinstance(value, str) else "a list"


PrismBase = Annotated[
    Annotated[Literal["anchors"], only_word("anchors", _CORNERS), Tag("a word")]
    | Annotated[Corners, Tag("a list")],
    Discriminator(word_or_list),
]
RectangleBase = Annotated[
    Annotated[Literal["anchors"], only_word("anchors", _ENDS), Tag("a word")]
    | Annotated[Ends, Tag("a list")],
    Discriminator(word_or_list),
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
    Discriminator(lambda given: f"{_kinds_named(given)[0]} region"),
    BeforeValidator(_of_one_kind),
]
