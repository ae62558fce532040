"""Fields and sections of config and grade files, and what is wrong in them.

First the kinds of values that fields hold, each with its own plain error message; then what all
mappings have in common.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from typing import Annotated, Any, ClassVar, get_args, get_origin, get_type_hints

import numpy as np
from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    Tag,
    TypeAdapter,
    ValidationError,
    model_validator,
)
from pydantic.fields import FieldInfo
from pydantic_core import CoreSchema, ErrorDetails, PydanticCustomError, core_schema

from designer import units
from designer.arrays import FloatArray, frozen_array
from designer.documents.bounds import BOUNDS
from designer.documents.document import Document, Key, printable
from designer.documents.plain import why_unreadable
from designer.errors import Fault
from designer.spelling import did_you_mean, nearest_name
from designer.units import describe

LONGEST_TEXT = 1000
"""The word that lifts a limit which a study has by default."""
_QUANTITY = r"^\s*[-+−]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d{1,3})?\s*(?:[^\s\d.].*)?$"
"""What a quantity looks like as a text; an editor does not know which units there are."""

JsonSchema = dict[str, Any]


def refusal(problem: str, expected: str) -> PydanticCustomError:
    """Return the error by which a validator reports a fault; pydantic adds the place."""
    return PydanticCustomError("fault", "{problem}", {"problem": problem, "expected": expected})


class Reader:
    """Base of an annotation by whose `read` alone pydantic reads a value."""

    def __get_pydantic_core_schema__(
        self, source: object, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """Let pydantic read the value by `read`."""
        return core_schema.no_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchema:
        """Tell editors what `read` takes."""
        return self.json_schema()

    def read(self, raw: object) -> Any:
        """Return the value, or refuse it."""
        raise NotImplementedError

    def json_schema(self) -> JsonSchema:
        """Return what may stand in the file, as a JSON Schema."""
        raise NotImplementedError


@dataclass(frozen=True)
class QuantityField(Reader):
    """Annotation of a float that the file gives as a quantity, and its limits [SI].

    It must exceed ``above`` and may reach the others; ``reason`` says why not beyond.
    """

    dimension: units.Dimension
    above: float | None = None
    at_least: float | None = None
    at_most: float | None = None
    reason: str = ""

    def read(self, raw: object) -> float:
        """Return the SI value, or refuse it."""
        try:
            value = units.read_quantity(raw, self.dimension)
        except units.QuantityError as error:
            raise refusal(error.problem, error.expected) from None
        bound = self._broken_bound(value)
        if bound:
            raise refusal(f"{units.describe(raw)} is out of range", f"{bound}{self._hint(raw)}")
        return value

    def json_schema(self) -> JsonSchema:
        """Return a number within the limits, or a text with a unit."""
        ends = {"exclusiveMinimum": self.above, "minimum": self.at_least, "maximum": self.at_most}
        if self.at_least is not None:
            del ends["exclusiveMinimum"]
        raw = {name: end for name, end in ends.items() if end is not None}
        text = {"type": "string", "pattern": _QUANTITY, "examples": [self.dimension.example]}
        return {"anyOf": [{"type": "number", **raw}, text], "x-unit": self.dimension.unit}

    def _hint(self, raw: object) -> str:
        """Return what a bare number was taken for, and what it may have been meant for."""
        unit = self.dimension.unit
        if not unit or isinstance(raw, str):
            return ""
        meant = f"{raw:.10g} mm" if isinstance(raw, int | float) and unit == "m" else ""
        try:
            fits = meant and not self._broken_bound(units.read_quantity(meant, self.dimension))
        except units.QuantityError:
            fits = False
        return f"; a bare number is in {unit}" + (f", did you mean '{meant}'?" if fits else "")

    def _broken_bound(self, value: float) -> str:
        why = f": {self.reason}" if self.reason else ""
        if self.above is not None and value <= self.above:
            return f"more than {units.format_SI(self.above, self.dimension)}"
        if self.at_least is not None and value < self.at_least:
            return f"at least {units.format_SI(self.at_least, self.dimension)}{why}"
        if self.at_most is not None and value > self.at_most:
            return f"at most {units.format_SI(self.at_most, self.dimension)}{why}"
        return ""


@dataclass(frozen=True)
class WholeNumber(Reader):
    """Annotation of an int between two limits."""

    least: int
    most: int

    def read(self, raw: object) -> int:
        """Return the number, or refuse it."""
        expected = f"a whole number from {self.least} to {self.most}"
        try:
            value = units.read_quantity(raw, units.NUMBER)
        except units.QuantityError as error:
            raise refusal(error.problem, expected) from None
        if value != int(value):
            raise refusal(f"{units.describe(raw)} is not a whole number", expected)
        if not self.least <= value <= self.most:
            raise refusal(f"{units.describe(raw)} is out of range", expected)
        return int(value)

    def json_schema(self) -> JsonSchema:
        """Return a whole number within the limits."""
        return {"type": "integer", "minimum": self.least, "maximum": self.most}


@dataclass(frozen=True)
class FormatOf(Reader):
    """Annotation of the number of a file's format, up to the newest that is read."""

    newest: int

    def read(self, raw: object) -> int:
        """Return the number, or refuse it."""
        why = why_unreadable(raw, self.newest)
        if why is not None:
            raise refusal(*why)
        return raw if isinstance(raw, int) else 1

    def json_schema(self) -> JsonSchema:
        """Return the formats that are read."""
        return {"type": "integer", "minimum": 1, "maximum": self.newest}


@dataclass(frozen=True)
class _ListOf:
    """Annotation of a list: how many items it may have, checked before they are read."""

    least: int
    most: int
    expected: str

    def __get_pydantic_core_schema__(
        self, source: object, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """Let pydantic read the items once there are as many as there should be."""
        return core_schema.no_info_before_validator_function(self._check, handler(source))

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchema:
        """Tell editors how many items there may be."""
        return {**handler(schema), "minItems": self.least, "maxItems": self.most}

    def _check(self, raw: object) -> object:
        if not isinstance(raw, list | tuple):
            raise refusal(f"{units.describe(raw)} is not a list", self.expected + in_brackets(raw))
        if not self.least <= len(raw) <= self.most:
            count = f"{len(raw)} value" + "s" * (len(raw) != 1)
            raise refusal(f"the list has {count}", self.expected)
        return raw


def reader_in(kind: Any, *, into_lists: bool = True) -> QuantityField | WholeNumber | None:
    """Return what reads the numbers of an annotation, wherever in it they stand."""
    if isinstance(kind, QuantityField | WholeNumber):
        return kind
    if get_origin(kind) is tuple and not into_lists:
        return None
    readers = (reader_in(part, into_lists=into_lists) for part in get_args(kind))
    return next((reader for reader in readers if reader is not None), None)


def list_of(least: int, greatest: int, expected: str) -> _ListOf:
    """Return the check of a list's length, before its items are read."""
    return _ListOf(least, greatest, expected)


def only_word(word: str, expected: str) -> BeforeValidator:
    """Return the check that a text is the one word that may stand in place of a list."""

    def check(raw: object) -> object:
        if raw != word:
            raise refusal(f"{units.describe(raw)} is not known", expected + in_brackets(raw))
        return raw

    return BeforeValidator(check)


def by_list(label: str, otherwise: str) -> Discriminator:
    """Return what labels an alternative by whether a list is given."""
    return Discriminator(lambda raw: label if isinstance(raw, list | tuple) else otherwise)


def by_word(otherwise: str) -> Discriminator:
    """Return what labels an alternative as a word, if a text is given, or otherwise."""
    return Discriminator(lambda raw: "a word" if isinstance(raw, str) else otherwise)


def in_brackets(value: object) -> str:
    """Return how a text with commas is written as the list that it was meant for; else nothing."""
    if not isinstance(value, str) or "," not in value or len(value) > LONGEST_TEXT:
        return ""
    return f"; a list stands in brackets: [{printable(value)}]"


def _text(raw: object) -> str:
    if not isinstance(raw, str):
        raise refusal(f"{units.describe(raw)} is not a text", "a text; quotes make a number one")
    if not 1 <= len(raw.strip()) <= LONGEST_TEXT:
        raise refusal(f"the text has {len(raw.strip())} characters", f"1 to {LONGEST_TEXT}")
    return raw


def _rising(ends: tuple[float, float], unit: str = "m") -> tuple[float, float]:
    lower, upper = ends
    if lower >= upper:
        problem = f"the lower end {lower:g} {unit} is not below the upper {upper:g} {unit}"
        raise refusal(problem, _INTERVAL)
    return ends


def _not_falling(ends: tuple[float, float], unit: str) -> tuple[float, float]:
    lower, upper = ends
    if lower > upper:
        problem = f"the lower end {lower:g} {unit} is above the upper {upper:g} {unit}"
        raise refusal(problem, "[lowest, highest]")
    return ends


def _not_zero(direction: tuple[float, float, float]) -> tuple[float, float, float]:
    # Squares of smaller parts come near the least that a float can be.
    if max(map(abs, direction)) < _LEAST_OF_A_DIRECTION:
        problem = "smaller than any that is meant" if any(direction) else "zero"
        raise refusal(f"the direction is {problem}", _DIRECTION)
    return direction


def _of_a_body(parts: tuple[float, ...]) -> tuple[float, ...]:
    if len(parts) not in (3, 6):
        raise refusal(f"the list has {len(parts)} values", _INERTIAS)
    principal = np.linalg.eigvalsh(symmetric(parts))
    if principal[0] <= 0.0 or principal[0] + principal[1] < principal[2] * (1.0 - 1e-9):
        values = ", ".join(f"{value:.4g}" for value in principal)
        problem = f"no body has the principal moments {values} kg*m^2"
        raise refusal(problem, "moments above zero, the largest at most the sum of the others")
    return parts


def symmetric(parts: tuple[float, ...]) -> FloatArray:
    """Return the matrix (3, 3) of xx, yy, zz and, where they are given, xy, xz, yz."""
    matrix = np.diag(parts[:3])
    for (row, column), value in zip(((0, 1), (0, 2), (1, 2)), parts[3:], strict=False):
        matrix[row, column] = matrix[column, row] = value
    return frozen_array(matrix)


def different(names: tuple[str, ...]) -> tuple[str, ...]:
    """Return the names unchanged, or refuse them if one stands twice."""
    twice = next((name for index, name in enumerate(names) if name in names[:index]), None)
    if twice is not None:
        raise refusal(f"{units.describe(twice)} is named twice", "each name once")
    return names


def mapping(value: object) -> object:
    """Return the mapping unchanged, or refuse what is given."""
    if not isinstance(value, dict):
        raise refusal(f"{units.describe(value)} is not a mapping", "a mapping such as {}")
    return value


def not_empty(raw: dict[str, Any]) -> dict[str, Any]:
    """Return the mapping unchanged, or refuse one without fields."""
    if not raw:
        raise refusal("the mapping is empty", "at least one group such as {front: [1, 2]}")
    return raw


def bounded(name: str, kind: type[QuantityField] = QuantityField) -> QuantityField:
    """Return the annotation of a number of this name in `designer.documents.bounds`."""
    bound = BOUNDS[name]
    return kind(
        bound.dimension,
        above=0.0 if bound.least > 0.0 else None,
        at_least=bound.least,
        at_most=bound.most,
        reason=bound.reason,
    )


_INTERVAL = "[lower, upper]"
_INERTIAS = "moments of inertia [xx, yy, zz], or [xx, yy, zz, xy, xz, yz]"
_DIRECTION = "a direction such as [0, 0, -1]"
_LEAST_OF_A_DIRECTION = 1e-6

Text = Annotated[str, BeforeValidator(_text)]
FreeMapping = Annotated[dict[str, Any], BeforeValidator(mapping)]

Length = Annotated[float, bounded("position")]
Distance = Annotated[float, bounded("distance")]
Clearance = Annotated[float, bounded("clearance")]
Sag = Annotated[float, bounded("sag")]
LengthNoise = Annotated[float, bounded("length noise")]
TensionNoise = Annotated[float, bounded("tension noise")]
AngleNoise = Annotated[float, bounded("angle noise")]
SearchTime = Annotated[float, bounded("search time")]
ProofTime = Annotated[float, bounded("proof time")]
Mass = Annotated[float, bounded("mass")]
Inertia = Annotated[float, bounded("inertia")]
Density = Annotated[float, bounded("density")]
LinearDensity = Annotated[float, bounded("mass per length")]
AxialStiffness = Annotated[float, bounded("axial stiffness")]
BreakingLoad = Annotated[float, bounded("breaking load")]
Tension = Annotated[float, bounded("tension")]
ForcePart = Annotated[float, bounded("force")]
MomentPart = Annotated[float, bounded("moment")]
Share = Annotated[float, bounded("direction")]
HalfTurn = Annotated[float, bounded("half turn")]
YoungsModulus = Annotated[float, bounded("modulus")]
Stress = Annotated[float, bounded("stress")]
Angle = Annotated[float, bounded("angle")]
FleetAngle = Annotated[float, bounded("fleet angle")]
SafetyFactor = Annotated[float, bounded("safety factor")]
SheaveDiameter = Annotated[float, bounded("sheave")]
RopeDiameter = Annotated[float, bounded("rope diameter")]
Efficiency = Annotated[float, bounded("efficiency")]
RopeOversize = Annotated[float, bounded("rope oversize")]
SheaveEfficiency = Annotated[float, bounded("sheave efficiency")]
Temperature = Annotated[float, bounded("temperature")]
TemperatureChange = Annotated[float, bounded("temperature change")]
Expansion = Annotated[float, bounded("expansion")]
Speed = Annotated[float, bounded("speed")]
Acceleration = Annotated[float, bounded("acceleration")]
DynamicFactor = Annotated[float, bounded("dynamic factor")]
DragCoefficient = Annotated[float, bounded("drag coefficient")]
DragArea = Annotated[float, bounded("drag area")]
IceThickness = Annotated[float, bounded("ice")]
GearRatio = Annotated[float, bounded("gear ratio")]
Torque = Annotated[float, bounded("torque")]
RotationalSpeed = Annotated[float, bounded("rotational speed")]
Power = Annotated[float, bounded("power")]
LifeConstant = Annotated[float, bounded("constant of a rope's life")]
LifeFactor = Annotated[float, bounded("factor of a rope's life")]
RunsPerDay = Annotated[float, bounded("runs a day")]
Days = Annotated[float, bounded("days")]
RopeSpeed = Annotated[float, bounded("rope speed")]
PathAcceleration = Annotated[float, bounded("path acceleration")]
Frequency = Annotated[float, bounded("frequency")]
Stiffness = Annotated[float, bounded("stiffness")]
DrumCapacity = Annotated[float, bounded("drum capacity")]

Interval = Annotated[tuple[Length, Length], list_of(2, 2, _INTERVAL), AfterValidator(_rising)]
AngleInterval = Annotated[
    tuple[HalfTurn, HalfTurn],
    list_of(2, 2, _INTERVAL),
    AfterValidator(partial(_rising, unit="rad")),
]
Band = Annotated[
    tuple[Frequency, Frequency],
    list_of(2, 2, _INTERVAL),
    AfterValidator(partial(_rising, unit="Hz")),
]
BandOrLeast = Annotated[
    Annotated[Band, Tag("a band")] | Annotated[Frequency, Tag("a frequency")],
    by_list("a band", "a frequency"),
]
Inertias = Annotated[tuple[Inertia, ...], list_of(3, 6, _INERTIAS), AfterValidator(_of_a_body)]
Corner = Annotated[tuple[Length, Length], list_of(2, 2, "two lengths [x, y]")]
Point = Annotated[tuple[Length, Length, Length], list_of(3, 3, "three lengths [x, y, z]")]
Rotation = Annotated[tuple[Angle, Angle, Angle], list_of(3, 3, "three angles [rx, ry, rz]")]
Forces = Annotated[tuple[ForcePart, ForcePart, ForcePart], list_of(3, 3, "three forces [x, y, z]")]
Moments = Annotated[
    tuple[MomentPart, MomentPart, MomentPart],
    list_of(3, 3, "three moments [x, y, z]"),
]
_UNTIL = "[lowest, highest]"
ForceRange = Annotated[
    tuple[ForcePart, ForcePart],
    list_of(2, 2, _UNTIL),
    AfterValidator(partial(_not_falling, unit="N")),
]
MomentRange = Annotated[
    tuple[MomentPart, MomentPart],
    list_of(2, 2, _UNTIL),
    AfterValidator(partial(_not_falling, unit="N*m")),
]
ForceRanges = Annotated[
    tuple[ForceRange, ForceRange, ForceRange],
    list_of(3, 3, "three ranges of forces [[lowest, highest], …, …]"),
]
MomentRanges = Annotated[
    tuple[MomentRange, MomentRange, MomentRange],
    list_of(3, 3, "three ranges of moments [[lowest, highest], …, …]"),
]
Direction = Annotated[
    tuple[Share, Share, Share],
    list_of(3, 3, _DIRECTION),
    AfterValidator(_not_zero),
]


class Section(BaseModel):
    """A mapping of a file: frozen, without unknown fields, each with a text below it."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    @model_validator(mode="before")
    @classmethod
    def _leave_out_empty_fields(cls, raw: object) -> object:
        return _without_empty(cls, raw)


class FileValue:
    """Base of a dataclass that is read from a mapping by `reader_of`.

    Its annotations say what each field may hold in a file and, by an alias, how the file calls it.
    Made in Python it is a plain dataclass, which checks nothing.
    """

    __slots__ = ()
    __pydantic_config__: ClassVar = ConfigDict(extra="forbid")

    @model_validator(mode="before")
    @classmethod
    def _leave_out_empty_fields(cls, raw: object) -> object:
        return _without_empty(cls, raw)


@cache
def reader_of(kind: Any) -> TypeAdapter[Any]:
    """Return what reads values of a kind; made once, since that takes milliseconds.

    Older Pydantic looks up the names of its annotations in this module first, so that none of them
    may name another thing here.
    """
    return TypeAdapter(kind)


@dataclasses.dataclass(frozen=True, slots=True)
class ReadAs:
    """Annotation of a value that the file gives as a section, whose ``value()`` it is."""

    section: type[Section]

    def __get_pydantic_core_schema__(
        self, source: object, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        """Let pydantic read the section and make the value of it."""
        schema = handler.generate_schema(self.section)
        return core_schema.no_info_after_validator_function(lambda read: read.value(), schema)


AnySection = type[Section] | type[FileValue]


def config_field(title: str = "", default: object = None, *, expected: str = "") -> Any:
    """Return the field of a section; the text below it says what it is.

    Messages, editors, the window and the docs take its words from here. Where the section stands
    in several places, ``{title}`` and ``{meaning}`` are those of the field that holds it.

    Parameters
    ----------
    title : str
        What the window calls it; empty for its name in the file.
    default : object
        Its value where a file leaves it out.
    expected : str
        Of a field that must be given: what to write, for the message that it is missing.
    """
    extra: Any = {"expected": expected} if expected else None
    return Field(... if expected else default, title=title or None, json_schema_extra=extra)


def expected_of(field: FieldInfo) -> str:
    """Return what to write for a field that is missing; of a `FileValue` its description says."""
    extra = field.json_schema_extra
    expected = extra.get("expected") if isinstance(extra, dict) else None
    return str(expected or field.description or "")


def fields_of(section: AnySection) -> Mapping[str, FieldInfo]:
    """Return the fields of a mapping, by their names in the file."""
    if issubclass(section, BaseModel):
        return section.model_fields
    kind: Any = section  # mypy takes its __hash__ for a method of one value
    return _annotated_fields(kind)


@cache
def _annotated_fields(section: Any) -> dict[str, FieldInfo]:
    hints = get_type_hints(section, include_extras=True)
    infos = {
        field.name: FieldInfo.from_annotation(hints[field.name])
        if field.default is dataclasses.MISSING
        else FieldInfo.from_annotated_attribute(hints[field.name], field.default)
        for field in dataclasses.fields(section)
    }
    return {info.alias or name: info for name, info in infos.items()}


def _without_empty(section: AnySection, raw: object) -> object:
    """Take ``samples:`` with nothing after it as a field that is not given."""
    if not isinstance(raw, dict):
        return raw
    fields = fields_of(section)
    return {
        key: value
        for key, value in raw.items()
        if value is not None or key not in fields or fields[key].is_required()
    }


def known_fields(schema: AnySection, loc: Sequence[Key]) -> Mapping[str, FieldInfo]:
    """Return the fields that the schema knows at pydantic's path ``loc``."""
    section = next(_sections_in(kind_at(schema, loc)), None)
    return fields_of(section) if section else {}


def kind_at(schema: AnySection, loc: Sequence[Key]) -> Any:
    """Return what the schema holds at a path, which may have pydantic's labels of alternatives.

    A place in a list keeps its kind.
    """
    kind: Any = schema
    for key in loc:
        plain = get_args(kind)[0] if get_origin(kind) is Annotated else kind
        if get_origin(plain) is dict:
            kind = get_args(plain)[1]
        elif (branch := _branch(kind, key)) is not None:
            kind = branch
        else:
            infos = (fields_of(section).get(str(key)) for section in _sections_in(kind))
            kind = next((info.rebuild_annotation() for info in infos if info is not None), kind)
    return kind


def _branch(kind: Any, label: Key) -> Any:
    """Return the alternative with this label, None where there is none."""
    parts = get_args(kind)
    if any(isinstance(part, Tag) and part.tag == label for part in parts):
        return kind
    return next((branch for part in parts if (branch := _branch(part, label)) is not None), None)


def _sections_in(kind: Any) -> Iterator[AnySection]:
    if isinstance(kind, ReadAs):
        yield kind.section
    elif isinstance(kind, type) and issubclass(kind, Section | FileValue):
        yield kind
    else:
        for part in get_args(kind):
            yield from _sections_in(part)


@cache
def words_at(schema: AnySection, path: str) -> tuple[str, str]:
    """Return title and meaning of a field, by its dotted path without places in lists."""
    kind: Any = schema
    title = meaning = ""
    for name in path.split("."):
        infos = (fields_of(section).get(name) for section in _sections_in(kind))
        info = next((info for info in infos if info is not None), None) or FieldInfo()
        plain_title = name.replace("_", " ").capitalize()
        title, meaning = (
            words.replace("{title}", title.lower()).replace("{meaning}", meaning)
            for words in (info.title or plain_title, " ".join((info.description or "").split()))
        )
        kind = info.rebuild_annotation()
    return title, meaning


_UNKNOWN = ("extra_forbidden", "unexpected_keyword_argument")
MOST_FAULTS = 100
"""As many as anybody reads; a wrong generated file could have one in each of its lines."""


def schema_faults(error: ValidationError, document: Document, schema: AnySection) -> list[Fault]:
    """Return one fault for each thing in the document that does not follow the schema.

    A field that is missing while another one beside it has nearly its name is reported once, as
    misspelt. After the first hundred the rest are left out.
    """
    details = error.errors(include_url=False)[:MOST_FAULTS]
    unknown = [detail["loc"] for detail in details if detail["type"] in _UNKNOWN]
    meant = [(loc, nearest_name(str(loc[-1]), known_fields(schema, loc[:-1]))) for loc in unknown]
    misspelt = {(*loc[:-1], nearest) for loc, nearest in meant if nearest is not None}
    return [
        document.fault(_document_path(detail, document), *_words(detail, schema))
        for detail in details
        if detail["loc"] not in misspelt
    ]


def _document_path(detail: ErrorDetails, document: Document) -> list[Key]:
    """Return pydantic's path without the steps that the document does not have.

    Those are the labels of alternatives, and the fields that a shorthand leaves out.
    """
    keys: list[Key] = []
    node = document.root
    for key in detail["loc"]:
        child = node.child(key)
        if child is not None:
            keys.append(key)
            node = child
    return [*keys, detail["loc"][-1]] if detail["type"] == "missing" else keys


def _words(detail: ErrorDetails, schema: AnySection) -> tuple[str, str]:
    """Return the problem and what was expected."""
    loc, context = detail["loc"], detail.get("ctx", {})
    if detail["type"] == "fault":
        return context["problem"], context["expected"]
    if detail["type"] == "missing":
        return "is missing", expected_of(known_fields(schema, loc[:-1])[str(loc[-1])])
    if detail["type"] in _UNKNOWN:
        names = known_fields(schema, loc[:-1])
        expected = _one_of(names, "one of ") + did_you_mean(str(loc[-1]), names)
        return f"unknown field '{printable(str(loc[-1]))}'", expected
    needed = _one_of(known_fields(schema, loc), "a mapping with ")
    verdict, expected = {
        "literal_error": ("is not known", context.get("expected", "")),
        "bool_type": ("is not a truth value", "true or false"),
        "model_type": ("is not a mapping", needed),
        "dataclass_type": ("is not a mapping", needed),
        "dict_type": ("is not a mapping", "a mapping such as {}"),
    }.get(detail["type"], ("is not valid here", ""))
    return f"{describe(detail['input'])} {verdict}", expected


def _one_of(names: Collection[str], lead: str) -> str:
    return lead + ", ".join(names) if names else ""
