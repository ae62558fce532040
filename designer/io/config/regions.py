"""The kinds of region that a config may name: each a section that builds its region.

A new kind is a section here, in `_REGIONS` and in `AnyRegion`.
"""

from __future__ import annotations

from abc import abstractmethod
from difflib import get_close_matches
from typing import Annotated, Literal

from pydantic import BeforeValidator, Discriminator, Field, Tag

from designer.arrays import FloatArray, frozen_array
from designer.documents import fields
from designer.documents.fields import list_of, only_word, refusal
from designer.documents.section import Section, config_field
from designer.model.point_list import PointList
from designer.model.prism import Prism
from designer.model.rectangle import Rectangle
from designer.model.region import Region
from designer.units import describe

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
