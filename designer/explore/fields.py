"""Every number of a study that can vary: found in the schema and the file, not listed here.

A slider goes from where to where the machine, or the number itself, makes sense.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from types import NoneType
from typing import Annotated, Any, Literal, get_args, get_origin

import numpy as np
from pydantic import BaseModel

from designer.documents.document import Key, Node, path_text
from designer.documents.fields import QuantityField, WholeNumber, reader_in, words_at
from designer.effects.effect import Effect
from designer.io.config.effects import field_of, read_effects
from designer.io.config.machine import FORMS
from designer.io.config.reader import field_node
from designer.io.config.schema import StudySection
from designer.model.cable import STANDARD_GRAVITY_M_PER_S2
from designer.units import (
    ANGLE,
    FORCE,
    LENGTH,
    MOMENT,
    NUMBER,
    TEMPERATURE,
    Dimension,
    format_SI,
    read_quantity,
)

_FACTOR = 4.0
_TURN_RAD = math.radians(45.0)
_DEGREES = 40.0
_MAX_SAFETY_FACTOR = 12.0
_IN_WORLD = ("pose.position", "workspace.region.z", "workspace.region.box", "workspace.floor")
_IN_BODY = ("robot.platform.attachments", "robot.platform.centre_of_mass", "robot.platform.hull")


@dataclass(frozen=True, slots=True)
class Sizes:
    """How large the machine is."""

    #: Box around the exit points, downward by half its diagonal, where the platform is [m]
    low_m: tuple[float, ...]
    high_m: tuple[float, ...]
    extent_m: float  #: That diagonal [m]
    #: Twice the distance of the farthest attachment from the origin of the platform [m]
    reach_m: float
    weight_N: float  #: Of the platform [N]

    @classmethod
    def of(cls, section: StudySection) -> Sizes:
        anchors, platform = np.array(section.robot.anchors), section.robot.platform
        low, high = anchors.min(axis=0), anchors.max(axis=0)
        extent = float(np.linalg.norm(high - low))
        ends = np.array(platform.attachments or [(0.0, 0.0, 0.0)])
        reach = 2.0 * float(np.linalg.norm(ends, axis=1).max()) or 0.01 * extent
        low = low - [0.0, 0.0, 0.5 * extent]
        weight = platform.mass * STANDARD_GRAVITY_M_PER_S2
        return cls(tuple(low.tolist()), tuple(high.tolist()), extent, reach, weight)

    @property
    def without_load(self) -> Sizes:
        """The same of an empty machine, for all that does not depend on the load."""
        return replace(self, weight_N=0.0)


def count_slider(value: float | None, low: int, high: int, plain: str) -> dict[str, Any]:
    """Return low, high and is_log of a whole number; nothing where none makes sense."""
    if value is None or plain.endswith("seed"):
        return {}
    is_log = high > 1000
    ends = (max(low, 100), min(high, 200_000)) if is_log else (low, min(high, 12))
    lowest, highest = min(ends[0], value), max(ends[1], value)
    return {"low": float(lowest), "high": float(highest), "is_log": is_log}


def slider(
    plain: str, place: Sequence[Key], value: float | None, reader: QuantityField, sizes: Sizes
) -> dict[str, Any]:
    """Return low, high and is_log of a quantity; nothing where none makes sense."""
    least = -math.inf if reader.at_least is None else reader.at_least
    largest = math.inf if reader.at_most is None else reader.at_most
    ends = _ends(plain, place, value, reader, sizes)
    if ends is None:
        return {}
    low, high = max(ends[0], least), min(ends[1], largest)
    if not low < high:
        return {}
    is_log = low > 0.0 and least > 0.0 and high / low >= 10.0
    return {"low": low, "high": high, "is_log": is_log}


def _ends(
    plain: str, place: Sequence[Key], value: float | None, reader: QuantityField, sizes: Sizes
) -> tuple[float, float] | None:
    at, kind, least = value or 0.0, reader.dimension, reader.at_least
    ends: tuple[float, float] | None = None
    if plain in _IN_WORLD:
        last = place[-1]
        axis = 2 if last == "floor" or "z" in place else int(place[-2] if "box" in place else last)
        ends = min(at, sizes.low_m[axis]), max(at, sizes.high_m[axis])
    elif kind is ANGLE:
        ends = at - _TURN_RAD, at + _TURN_RAD
    elif kind is TEMPERATURE:
        ends = at - _DEGREES, at + _DEGREES
    elif kind in (FORCE, MOMENT):
        reach = max(sizes.weight_N * (sizes.reach_m if kind is MOMENT else 1.0), 2.0 * abs(at))
        ends = -reach, reach  # where it may not be below zero, its limit cuts this
    elif (least, reader.at_most) == (0.01, 1.0):
        ends = min(0.5, at or 0.5), 1.0
    elif (least, reader.at_most) == (1.0, 100.0):
        ends = 1.0, max(_MAX_SAFETY_FACTOR, at)
    elif kind is LENGTH:
        ends = _lengths(plain, value, reader, sizes)
    elif at > 0.0 and (least or 0.0) >= 0.0:
        ends = at / _FACTOR, at * _FACTOR
    return ends


def _lengths(
    plain: str, value: float | None, reader: QuantityField, sizes: Sizes
) -> tuple[float, float]:
    """Return ends of a length: in the body as far as that reaches, else by the whole machine."""
    at = value or 0.0
    if reader.at_least is None or reader.at_least < 0.0:
        reach = sizes.reach_m if plain in _IN_BODY else 0.5 * sizes.extent_m
        return at - reach, at + reach
    if reader.at_least > 0.0:  # none is another thing than a very small one
        middle = at or 0.01 * sizes.extent_m
        return middle / _FACTOR**2, middle * _FACTOR**2
    return 0.0, max(0.25 * sizes.extent_m, at)


Kind = Literal["quantity", "count", "choice"]
MAX_ROWS = 64  #: A longer list is edited in the file
_AXES = "xyz"
_ENDS = ("from", "to")
_NUMBER = re.compile(r"\s*[-+−]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
_EXCLUDED = ("format", "robot.planar", "measurements.settled")
"""What is no matter of degree: another robot, other data."""
_BODY_ONLY = (
    "robot.platform.centre_of_mass",
    "robot.platform.wrench.moment",
    "robot.platform.inertia",
    "load_cases.inertia",
    "load_cases.wrench.moment",
    "load_cases.wrench_set.moment",
    "pose.rotation_vector",
)
_ROUND = 3  #: Digits, beside the first, that a slider sets


@dataclass(frozen=True, slots=True)
class Field:
    """One value of the study."""

    #: Into the study, such as ``robot.anchors[0][2]``; a shorthand of the file is written out, as
    #: in ``pose.position[0]``
    path: str
    group: str  #: Title of its section, its own, and the SI unit (empty for a number)
    label: str
    unit: str
    kind: Kind  #: ``quantity``, ``count`` (a whole number), or ``choice`` (one of ``choices``)
    value_SI: float | None  #: None of a choice, and of what is not given
    text: str  #: As the file has it; where the file does not have it, its default, empty for none
    low: float | None = None  #: Sensible ends of a slider [SI]; None for no slider
    high: float | None = None
    is_log: bool = False  #: Whether the slider goes by factors
    choices: tuple[str, ...] = ()  #: Of a choice
    is_optional: bool = False  #: Whether it may be left empty, which means that there is none
    definition: str = ""  #: What it is, and between which limits it may lie
    dimension: Dimension = NUMBER  #: What kind of quantity it is

    @property
    def meaning(self) -> float | str | None:
        """What it stands for, however it is written."""
        return self.text if self.kind == "choice" else self.value_SI

    def text_of(self, value_SI: float, *, exactly: bool = False) -> str:
        """Return a value as text, in the unit that the present text has, of a few digits.

        Or ``exactly``, but for what its last digits are rounded to by the unit.
        """
        if self.kind == "count":
            return str(round(value_SI))
        number = _NUMBER.match(self.text)
        unit = "" if number is None else self.text[number.end() :].strip()
        zero_SI, per_unit = 0.0, 1.0
        if unit:
            zero_SI = read_quantity(f"0 {unit}", self.dimension)
            per_unit = read_quantity(f"1 {unit}", self.dimension) - zero_SI
        value = (value_SI - zero_SI) / per_unit
        span = abs(self.high - self.low) if self.high is not None and self.low is not None else 0.0
        size = abs(span / per_unit) if not self.is_log and span else abs(value)
        places = _ROUND - math.floor(math.log10(size)) if size > 0.0 else 0
        text = f"{(value if exactly else round(value, places)) + 0.0:.12g}"
        return f"{text} {unit}" if unit else text


def keys_of(path: str) -> tuple[Key, ...]:
    return tuple(
        int(part[1:-1]) if part.startswith("[") else part
        for part in re.findall(r"\[\d+\]|[^.\[\]]+", path)
    )


def study_fields(
    section: StudySection, root: Node, effects: Mapping[str, Effect]
) -> tuple[Field, ...]:
    """Return the fields of a study that is well-formed, in the order of the schema.

    ``root`` is the same as the file has it; ``effects`` are all that are known, by id.
    """
    sizes = Sizes.of(section)
    hidden = _without_meaning(section)
    slots = (*_walk(section, root, ()), *_effect_slots(section, root, effects))
    return tuple(
        _field(slot, sizes if slot.depends_on_load else sizes.without_load)
        for slot in slots
        if slot.plain not in _EXCLUDED and not (slot.given is None and slot.plain in hidden)
    )


def _without_meaning(section: StudySection) -> frozenset[str]:
    """Return what means nothing to this robot, and would be refused."""
    robot, is_point = section.robot, section.robot.platform.attachments is None
    freedom = (2 if is_point else 3) if robot.planar else (3 if is_point else 6)
    hidden = {*(_BODY_ONLY if is_point else ())}
    if len(robot.anchors) <= freedom:
        hidden.add("robot.tension_min")
    if section.workspace is None:
        hidden |= {f"robot.winches.{name}" for name in type(section.robot.winches).model_fields}
    if section.selection is None or not section.selection.groups:
        hidden.add("selection.max_distinct_products")
    return frozenset(hidden)


@dataclass(frozen=True, slots=True)
class _Kind:
    """What a field of the schema holds: how its numbers are read, or between what one chooses.

    ``reader`` is of a number or of the numbers in its lists, ``scalar_reader`` of a number only.
    """

    reader: QuantityField | WholeNumber | None
    scalar_reader: QuantityField | WholeNumber | None
    words: tuple[str, ...]
    is_optional: bool


@dataclass(frozen=True, slots=True)
class _Slot:
    """A value in the schema, and as the file has it, None where it does not.

    ``effect`` has label and definition of a parameter of an effect, which the schema has not.
    """

    place: tuple[Key, ...]
    value: Any
    given: str | None
    reader: QuantityField | WholeNumber | None
    choices: tuple[str, ...] = ()
    is_optional: bool = False
    effect: tuple[str, str] | None = None

    @property
    def plain(self) -> str:
        return ".".join(key for key in self.place if isinstance(key, str))

    @property
    def depends_on_load(self) -> bool:
        """Whether its slider goes as far as the platform is heavy."""
        return isinstance(self.reader, QuantityField) and self.reader.dimension in (FORCE, MOMENT)


def _walk(section: BaseModel, node: Node | None, place: tuple[Key, ...]) -> Iterator[_Slot]:
    turned = [name for name in FORMS[1:] if getattr(section, name, None) is not None]
    for name, kind in _kinds(type(section)).items():
        if name == "quaternion" or (name == FORMS[0] and turned):
            continue  # its parts do not vary one by one; another form is given
        below = field_node(node, name, section)
        yield from _slots(getattr(section, name), below, (*place, name), kind)


@cache
def _kinds(section: type[BaseModel]) -> Mapping[str, _Kind]:
    kinds = {}
    for name, info in section.model_fields.items():
        kind = info.rebuild_annotation()
        plain = get_args(kind)[0] if get_origin(kind) is Annotated else kind
        words = get_args(plain) if get_origin(plain) is Literal and len(get_args(plain)) > 1 else ()
        reader, scalar = (reader_in(kind, into_lists=into) for into in (True, False))
        kinds[name] = _Kind(reader, scalar, words, NoneType in get_args(plain))
    return kinds


def _slots(value: Any, node: Node | None, place: tuple[Key, ...], kind: _Kind) -> Iterator[_Slot]:
    in_list = isinstance(place[-1], int)
    given = None if node is None or isinstance(value, tuple | BaseModel) else node.as_written()
    if isinstance(value, BaseModel):
        yield from _walk(value, node, place)
    elif isinstance(value, tuple):
        for index, item in enumerate(value if len(value) <= MAX_ROWS else ()):
            child = None if node is None else node.child(index)
            yield from _slots(item, child, (*place, index), kind)
    elif isinstance(value, bool):
        yield _Slot(place, value, given, None, ("false", "true"))
    elif kind.words and not in_list:
        yield _Slot(place, value, given, None, kind.words)
    elif value is None and kind.scalar_reader is not None:
        yield _Slot(place, value, given, kind.scalar_reader, is_optional=kind.is_optional)
    elif isinstance(value, int | float) and kind.reader is not None:
        is_optional = kind.is_optional and not in_list
        yield _Slot(place, value, given, kind.reader, is_optional=is_optional)


def _effect_slots(
    section: StudySection, root: Node, effects: Mapping[str, Effect]
) -> Iterator[_Slot]:
    n_cables = len(section.robot.anchors)
    for place, declared in read_effects(section.effects, n_cables, effects).effects:
        effect, of_cable = effects[declared.id], ""
        if declared.cable is not None:
            of_cable = f" of cable {declared.cable}"
        title = f"{declared.id.replace('_', ' ').capitalize()}{of_cable}"
        summary = effect.summary.format(cable=declared.cable)
        for parameter in effect.parameters_for(n_cables):
            keys = (*place, parameter.name)
            node = root.at(keys)
            given = None if node is None else node.as_written()
            words = f"{title}, {parameter.label}", f"Effect: {summary}."
            value = declared.parameters[parameter.name]
            yield _Slot(keys, value, given, field_of(parameter), effect=words)


@lru_cache(maxsize=4096)
def _field(slot: _Slot, sizes: Sizes) -> Field:
    title, definition = words_at(StudySection, slot.plain)
    label = _label(title, slot.place)
    if slot.effect is not None:
        label, definition = slot.effect
    given = slot.given or ""
    common: dict[str, Any] = {
        "path": path_text(slot.place),
        "group": words_at(StudySection, str(slot.place[0]))[0],
        "label": label,
        "is_optional": slot.is_optional,
    }
    if slot.reader is None:
        word = str(slot.value).lower() if isinstance(slot.value, bool) else slot.value
        text = given or word
        return Field(
            **common, unit="", kind="choice", value_SI=None, text=text, choices=slot.choices,
            definition=definition,
        )  # fmt: skip
    value = None if slot.value is None else float(slot.value)
    if isinstance(slot.reader, WholeNumber):
        least, most = slot.reader.least, slot.reader.most
        text = given or ("" if value is None else str(slot.value))
        return Field(
            **common, unit="", kind="count", value_SI=value, text=text,
            definition=f"{definition} A whole number from {least} to {most}.".strip(),
            **count_slider(value, least, most, slot.plain),
        )  # fmt: skip
    dimension = slot.reader.dimension
    text = given or ("" if value is None else format_SI(value, dimension))
    low, high = slot.reader.at_least, slot.reader.at_most
    limits = ""
    if low is not None and high is not None:
        limits = f"From {format_SI(low, dimension)} to {format_SI(high, dimension)}."
    return Field(
        **common, unit=dimension.unit, kind="quantity", value_SI=value, text=text,
        definition=f"{definition} {limits}".strip(), dimension=dimension,
        **slider(slot.plain, slot.place, value, slot.reader, sizes),
    )  # fmt: skip


def _label(title: str, place: Sequence[Key]) -> str:
    """Return the title with what tells the values of a list from each other."""
    *names, last = place
    plain = ".".join(key for key in place if isinstance(key, str))
    is_range = "wrench_set" in names and isinstance(names[-1], int)
    is_box = is_range or plain.endswith(("box", "hull"))
    rows = [key + 1 for key in (names[:-1] if is_box else names) if isinstance(key, int)]
    numbered = f"{title} {'.'.join(map(str, rows))}" if rows else title
    if isinstance(last, str):
        return numbered
    if is_box:
        return f"{numbered}, {_AXES[int(names[-1])]} {_ENDS[last]}"
    if plain.endswith((".z", ".rx", ".ry", ".rz")):
        return f"{numbered}, {_ENDS[last]}"
    is_numbered = plain.endswith(("angles", "tension_max"))
    part = str(last + 1) if is_numbered else _AXES[last] if last < 3 else str(last)
    return f"{numbered}, {part}"


def with_slider_of(field: Field, saved: Field | None) -> Field:
    """Return a field with the slider that it has in the file, if its value lies on it."""
    if saved is None or saved.low is None or saved.high is None or field.value_SI is None:
        return field
    if not saved.low <= field.value_SI <= saved.high:
        return field
    return replace(field, low=saved.low, high=saved.high, is_log=saved.is_log)
