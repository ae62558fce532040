"""Every number of a study that can vary: found in the schema and the file, not listed here."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from types import NoneType
from typing import Annotated, Any, Literal, get_args, get_origin

from pydantic import BaseModel

from designer.documents.document import Key, Node, path_text
from designer.documents.fields import QuantityField, WholeNumber, reader_in, words_at
from designer.effects.effect import Effect
from designer.explore.sliders import Sizes, count_slider, slider
from designer.io.config.effects import field_of, read_effects
from designer.io.config.machine import FORMS
from designer.io.config.reader import field_node
from designer.io.config.schema import StudySection
from designer.units import FORCE, MOMENT, NUMBER, Dimension, format_SI, read_quantity

Kind = Literal["quantity", "count", "choice"]
_MOST_ROWS = 64
"""A longer list is edited in the file."""
_AXES = "xyz"
_ENDS = ("from", "to")
_NUMBER = re.compile(r"\s*[-+−]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
_LEFT_OUT = ("format", "robot.planar", "measurements.settled")
"""What is no matter of degree: another robot, other data."""
_OF_A_BODY = (
    "robot.platform.centre_of_mass",
    "robot.platform.wrench.moment",
    "robot.platform.inertia",
    "load_cases.inertia",
    "load_cases.wrench.moment",
    "load_cases.wrench_set.moment",
    "pose.rotation_vector",
)
_ROUND = 3
"""Digits, beside the first, that a slider sets."""


@dataclass(frozen=True, slots=True)
class Field:
    """One value of the study.

    Parameters
    ----------
    path : str
        Into the study, such as ``robot.anchors[0][2]``; a shorthand of the file is written out, as
        in ``pose.position[0]``.
    group, label, unit : str
        Title of its section, its own, and the SI unit (empty for a number).
    kind : str
        ``quantity``, ``count`` (a whole number), or ``choice`` (one of ``choices``).
    value_SI : float or None
        None of a choice, and of what is not given.
    text : str
        As the file has it; where the file does not have it, its default, empty for none.
    low, high : float or None
        Sensible ends of a slider [SI]; None for no slider.
    is_log : bool
        Whether the slider goes by factors.
    choices : tuple of str
        Of a choice.
    is_optional : bool
        Whether it may be left empty, which means that there is none.
    definition : str
        What it is, and between which limits it may lie.
    dimension : Dimension
        What kind of quantity it is.
    """

    path: str
    group: str
    label: str
    unit: str
    kind: Kind
    value_SI: float | None
    text: str
    low: float | None = None
    high: float | None = None
    is_log: bool = False
    choices: tuple[str, ...] = ()
    is_optional: bool = False
    definition: str = ""
    dimension: Dimension = NUMBER

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
        unit = _unit_of(self.text)
        least, per_unit = 0.0, 1.0
        if unit:
            least = read_quantity(f"0 {unit}", self.dimension)
            per_unit = read_quantity(f"1 {unit}", self.dimension) - least
        shown = (value_SI - least) / per_unit
        span = abs(self.high - self.low) if self.high is not None and self.low is not None else 0.0
        size = abs(span / per_unit) if not self.is_log and span else abs(shown)
        places = _ROUND - math.floor(math.log10(size)) if size > 0.0 else 0
        number = f"{(shown if exactly else round(shown, places)) + 0.0:.12g}"
        return f"{number} {unit}" if unit else number


def keys_of(path: str) -> tuple[Key, ...]:
    """Return the steps of a path."""
    return tuple(
        int(part[1:-1]) if part.startswith("[") else part
        for part in re.findall(r"\[\d+\]|[^.\[\]]+", path)
    )


def study_fields(
    section: StudySection, root: Node, effects: Mapping[str, Effect]
) -> tuple[Field, ...]:
    """Return the fields of a study that is well-formed, in the order of the schema.

    Parameters
    ----------
    section : StudySection
        The study by its schema.
    root : Node
        The same as the file has it.
    effects : mapping of str to Effect
        All effects that are known, by id.
    """
    sizes = Sizes.of(section)
    hidden = _without_meaning(section)
    slots = (*_walk(section, root, ()), *_effect_slots(section, root, effects))
    return tuple(
        _field(slot, sizes if slot.depends_on_load else sizes.without_load)
        for slot in slots
        if slot.plain not in _LEFT_OUT and not (slot.given is None and slot.plain in hidden)
    )


def _without_meaning(section: StudySection) -> frozenset[str]:
    """Return what means nothing to this robot, and would be refused."""
    robot, is_point = section.robot, section.robot.platform.attachments is None
    freedom = (2 if is_point else 3) if robot.planar else (3 if is_point else 6)
    hidden = {*(_OF_A_BODY if is_point else ())}
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

    ``reader`` is that of a number or of the numbers in its lists, ``alone`` that of a number only.
    """

    reader: QuantityField | WholeNumber | None
    alone: QuantityField | WholeNumber | None
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
        """Path without places in lists."""
        return ".".join(key for key in self.place if isinstance(key, str))

    @property
    def depends_on_load(self) -> bool:
        """Whether its slider goes as far as the platform is heavy."""
        return isinstance(self.reader, QuantityField) and self.reader.dimension in (FORCE, MOMENT)


def _walk(section: BaseModel, node: Node | None, place: tuple[Key, ...]) -> Iterator[_Slot]:
    """Yield all values below a section."""
    turned = [name for name in FORMS[1:] if getattr(section, name, None) is not None]
    for name, kind in _kinds(type(section)).items():
        if name == "quaternion" or (name == FORMS[0] and turned):
            continue  # its parts do not vary one by one; another form is given
        below = field_node(node, name, section)
        yield from _slots(getattr(section, name), below, (*place, name), kind)


@cache
def _kinds(section: type[BaseModel]) -> Mapping[str, _Kind]:
    """Return what the fields of a section hold."""
    found = {}
    for name, info in section.model_fields.items():
        kind = info.rebuild_annotation()
        plain = get_args(kind)[0] if get_origin(kind) is Annotated else kind
        words = get_args(plain) if get_origin(plain) is Literal and len(get_args(plain)) > 1 else ()
        reader, alone = (reader_in(kind, into_lists=into) for into in (True, False))
        found[name] = _Kind(reader, alone, words, NoneType in get_args(plain))
    return found


def _slots(value: Any, node: Node | None, place: tuple[Key, ...], kind: _Kind) -> Iterator[_Slot]:
    in_list = isinstance(place[-1], int)
    given = None if node is None or isinstance(value, tuple | BaseModel) else node.as_written()
    if isinstance(value, BaseModel):
        yield from _walk(value, node, place)
    elif isinstance(value, tuple):
        for index, item in enumerate(value if len(value) <= _MOST_ROWS else ()):
            child = None if node is None else node.child(index)
            yield from _slots(item, child, (*place, index), kind)
    elif isinstance(value, bool):
        yield _Slot(place, value, given, None, ("false", "true"))
    elif kind.words and not in_list:
        yield _Slot(place, value, given, None, kind.words)
    elif value is None and kind.alone is not None:
        yield _Slot(place, value, given, kind.alone, is_optional=kind.is_optional)
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
        for one in effect.parameters_for(n_cables):
            at = (*place, one.name)
            node = root.at(at)
            given = None if node is None else node.as_written()
            words = f"{title}, {one.label}", f"Effect: {summary}."
            value = declared.parameters[one.name]
            yield _Slot(at, value, given, field_of(one), effect=words)


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
        low, high = slot.reader.least, slot.reader.most
        text = given or ("" if value is None else str(slot.value))
        return Field(
            **common, unit="", kind="count", value_SI=value, text=text,
            definition=f"{definition} A whole number from {low} to {high}.".strip(),
            **count_slider(value, low, high, slot.plain),
        )  # fmt: skip
    dimension = slot.reader.dimension
    text = given or ("" if value is None else format_SI(value, dimension))
    return Field(
        **common, unit=dimension.unit, kind="quantity", value_SI=value, text=text,
        definition=f"{definition} {_limits(slot.reader)}".strip(), dimension=dimension,
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


def _limits(reader: QuantityField) -> str:
    """Return between which limits a quantity may lie."""
    low, high = reader.at_least, reader.at_most
    if low is None or high is None:
        return ""
    ends = (format_SI(end, reader.dimension) for end in (low, high))
    return "From {} to {}.".format(*ends)


def _unit_of(text: str) -> str:
    """Return the unit of a quantity as it is written; nothing of a bare number."""
    number = _NUMBER.match(text)
    return "" if number is None else text[number.end() :].strip()


def with_ends_of(one: Field, file: Field | None) -> Field:
    """Return a field with the slider that it has in the file, if its value lies on it."""
    if file is None or file.low is None or file.high is None or one.value_SI is None:
        return one
    if not file.low <= one.value_SI <= file.high:
        return one
    return replace(one, low=file.low, high=file.high, is_log=file.is_log)
