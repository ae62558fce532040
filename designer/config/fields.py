"""Kinds of values that fields of the config hold, each with its own plain error message."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import AfterValidator, BeforeValidator, GetCoreSchemaHandler
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from designer.units import (
    ANGLE,
    DENSITY,
    FORCE,
    FRACTION,
    LENGTH,
    LINEAR_DENSITY,
    MASS,
    MOMENT,
    NUMBER,
    STRESS,
    Dimension,
    QuantityError,
    describe,
    format_SI,
    read_quantity,
)

LONGEST_TEXT = 1000


def refusal(problem: str, expected: str) -> PydanticCustomError:
    """Return the error by which a validator reports a fault; pydantic adds the place."""
    return PydanticCustomError("fault", "{problem}", {"problem": problem, "expected": expected})


@dataclass(frozen=True, slots=True)
class Quantity:
    """Annotation of a float that the file gives as a quantity.

    Parameters
    ----------
    dimension : Dimension
        What kind of quantity.
    above : float or None
        Limit that the SI value must exceed.
    at_least, at_most : float or None
        Limits that the SI value may reach.
    """

    dimension: Dimension
    above: float | None = None
    at_least: float | None = None
    at_most: float | None = None

    def __get_pydantic_core_schema__(
        self, source: object, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """Let pydantic read the value by `read` alone."""
        return core_schema.no_info_plain_validator_function(self.read)

    def read(self, given: object) -> float:
        """Return the SI value, or refuse it."""
        try:
            value = read_quantity(given, self.dimension)
        except QuantityError as error:
            raise refusal(error.problem, error.expected) from None
        bound = self._broken_bound(value)
        if bound:
            unit = f"; a bare number is in {self.dimension.unit}" if self.dimension.unit else ""
            hint = unit if isinstance(given, int | float) else ""
            raise refusal(f"{describe(given)} is out of range", f"{bound}{hint}")
        return value

    def _broken_bound(self, value: float) -> str:
        if self.above is not None and value <= self.above:
            return f"more than {format_SI(self.above, self.dimension)}"
        if self.at_least is not None and value < self.at_least:
            return f"at least {format_SI(self.at_least, self.dimension)}"
        if self.at_most is not None and value > self.at_most:
            return f"at most {format_SI(self.at_most, self.dimension)}"
        return ""


@dataclass(frozen=True, slots=True)
class WholeNumber:
    """Annotation of an int between two limits."""

    least: int
    most: int

    def __get_pydantic_core_schema__(
        self, source: object, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """Let pydantic read the value by `read` alone."""
        return core_schema.no_info_plain_validator_function(self.read)

    def read(self, given: object) -> int:
        """Return the number, or refuse it."""
        expected = f"a whole number from {self.least} to {self.most}"
        try:
            value = read_quantity(given, NUMBER)
        except QuantityError as error:
            raise refusal(error.problem, expected) from None
        if value != int(value):
            raise refusal(f"{describe(given)} is not a whole number", expected)
        if not self.least <= value <= self.most:
            raise refusal(f"{describe(given)} is out of range", expected)
        return int(value)


@dataclass(frozen=True, slots=True)
class ListOf:
    """Check of a list's length, before its items are read."""

    least: int
    most: int
    expected: str

    def __call__(self, given: object) -> object:
        """Return the list unchanged, or refuse it."""
        if not isinstance(given, list | tuple):
            raise refusal(f"{describe(given)} is not a list", self.expected)
        if not self.least <= len(given) <= self.most:
            count = f"{len(given)} value" + "s" * (len(given) != 1)
            raise refusal(f"the list has {count}", self.expected)
        return given


@dataclass(frozen=True, slots=True)
class OnlyWord:
    """Check that a text is the one word that may stand in place of a list."""

    word: str
    expected: str

    def __call__(self, given: object) -> object:
        """Return the word, or refuse what is given."""
        if given != self.word:
            raise refusal(f"{describe(given)} is not known", self.expected)
        return given


def _text(given: object) -> str:
    if not isinstance(given, str):
        raise refusal(f"{describe(given)} is not a text", "a text; quotes make a number one")
    if not 1 <= len(given.strip()) <= LONGEST_TEXT:
        raise refusal(f"the text has {len(given.strip())} characters", f"1 to {LONGEST_TEXT}")
    return given


def _rising(ends: tuple[float, float], unit: str = "m") -> tuple[float, float]:
    lower, upper = ends
    if lower >= upper:
        problem = f"the lower end {lower:g} {unit} is not below the upper {upper:g} {unit}"
        raise refusal(problem, _INTERVAL)
    return ends


def _rising_angles(ends: tuple[float, float]) -> tuple[float, float]:
    return _rising(ends, "rad")


def _not_zero(direction: tuple[float, float, float]) -> tuple[float, float, float]:
    if not any(direction):
        raise refusal("the direction is zero", _DIRECTION)
    return direction


def different(names: tuple[str, ...]) -> tuple[str, ...]:
    """Return the names unchanged, or refuse them if one stands twice."""
    twice = next((name for index, name in enumerate(names) if name in names[:index]), None)
    if twice is not None:
        raise refusal(f"{describe(twice)} is named twice", "each name once")
    return names


def mapping(given: object) -> object:
    """Return the mapping unchanged, or refuse what is given."""
    if not isinstance(given, dict):
        raise refusal(f"{describe(given)} is not a mapping", "a mapping such as {}")
    return given


def not_empty(given: dict[str, Any]) -> dict[str, Any]:
    """Return the mapping unchanged, or refuse one without fields."""
    if not given:
        raise refusal("the mapping is empty", "at least one group such as {front: [1, 2]}")
    return given


_INTERVAL = "[lower, upper]"
_DIRECTION = "a direction such as [0, 0, -1]"
_FARTHEST_M = 1e7
_POINT = "three lengths [x, y, z]"

Text = Annotated[str, BeforeValidator(_text)]
FreeMapping = Annotated[dict[str, Any], BeforeValidator(mapping)]

Length = Annotated[float, Quantity(LENGTH, at_least=-_FARTHEST_M, at_most=_FARTHEST_M)]
Distance = Annotated[float, Quantity(LENGTH, at_least=0.0, at_most=_FARTHEST_M)]
Clearance = Annotated[float, Quantity(LENGTH, above=0.0, at_most=_FARTHEST_M)]
LengthNoise = Annotated[float, Quantity(LENGTH, above=0.0, at_least=1e-12, at_most=_FARTHEST_M)]
TensionNoise = Annotated[float, Quantity(FORCE, above=0.0, at_least=1e-9, at_most=1e20)]
Mass = Annotated[float, Quantity(MASS, above=0.0, at_least=1e-9, at_most=1e12)]
Density = Annotated[float, Quantity(DENSITY, above=0.0, at_most=1e6)]
LinearDensity = Annotated[float, Quantity(LINEAR_DENSITY, above=0.0, at_most=1e6)]
Force = Annotated[float, Quantity(FORCE, above=0.0, at_most=1e20)]
Tension = Annotated[float, Quantity(FORCE, at_least=0.0, at_most=1e20)]
ForcePart = Annotated[float, Quantity(FORCE, at_least=-1e20, at_most=1e20)]
MomentPart = Annotated[float, Quantity(MOMENT, at_least=-1e20, at_most=1e20)]
Share = Annotated[float, Quantity(NUMBER, at_least=-1e6, at_most=1e6)]
HalfTurn = Annotated[float, Quantity(ANGLE, at_least=-math.pi, at_most=math.pi)]
Modulus = Annotated[float, Quantity(STRESS, above=0.0, at_least=1e5, at_most=1e20)]
Stress = Annotated[float, Quantity(STRESS, above=0.0, at_least=1e3, at_most=1e20)]
# A turn at most: a bare 90 that is meant in degrees shall not pass as 90 rad.
Angle = Annotated[float, Quantity(ANGLE, at_least=-2.0 * math.pi, at_most=2.0 * math.pi)]
SafetyFactor = Annotated[float, Quantity(NUMBER, at_least=1.0, at_most=1000.0)]
SheaveDiameter = Annotated[float, Quantity(LENGTH, above=0.0, at_most=_FARTHEST_M)]
Efficiency = Annotated[float, Quantity(FRACTION, above=0.0, at_most=1.0)]

Interval = Annotated[
    tuple[Length, Length], BeforeValidator(ListOf(2, 2, _INTERVAL)), AfterValidator(_rising)
]
Turn = Annotated[
    tuple[HalfTurn, HalfTurn],
    BeforeValidator(ListOf(2, 2, _INTERVAL)),
    AfterValidator(_rising_angles),
]
Corner = Annotated[tuple[Length, Length], BeforeValidator(ListOf(2, 2, "two lengths [x, y]"))]
Point = Annotated[tuple[Length, Length, Length], BeforeValidator(ListOf(3, 3, _POINT))]
Rotation = Annotated[
    tuple[Angle, Angle, Angle], BeforeValidator(ListOf(3, 3, "three angles [rx, ry, rz]"))
]
Forces = Annotated[
    tuple[ForcePart, ForcePart, ForcePart], BeforeValidator(ListOf(3, 3, "three forces [x, y, z]"))
]
Moments = Annotated[
    tuple[MomentPart, MomentPart, MomentPart],
    BeforeValidator(ListOf(3, 3, "three moments [x, y, z]")),
]
Direction = Annotated[
    tuple[Share, Share, Share],
    BeforeValidator(ListOf(3, 3, _DIRECTION)),
    AfterValidator(_not_zero),
]
