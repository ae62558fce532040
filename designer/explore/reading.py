"""What a text is: a study, or what is wrong with it; and entries of fields into the text."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from designer.arrays import FloatArray
from designer.documents import edits
from designer.documents.document import Document, Key, decode, document_of, path_text
from designer.documents.opened import read_bytes
from designer.effects.registry import KnownEffects
from designer.errors import DesignerError, Fault, InputError
from designer.explore.fields import Field, keys_of, study_fields
from designer.explore.question import Rope, RopePerCable
from designer.io.config.moved import moved_to
from designer.io.config.reader import checked, study_of
from designer.io.config.schema import StudySection
from designer.plugins import Plugins
from designer.study import Study

_SHORTHAND = {"pose": "position"}
"""What a list in place of these mappings is; of all others the rotation vector."""
_USUAL = "rotation_vector"
_DIGITS = 9


@dataclass(frozen=True, slots=True, eq=False)
class Context:
    """What a text is read with: where its relative paths start, effects, and plugins' grades."""

    path: Path
    effects: KnownEffects
    plugins: Plugins

    def read(self, text: str) -> Reading:
        """Return what a text is."""
        try:
            document = document_of(text.encode(), str(self.path))
            section = checked(document, self.effects)
            study = study_of(section, document, self.path, self.effects, self.plugins)
        except InputError as error:
            return Reading(self, text, None, error.faults)
        except DesignerError as error:
            return Reading(self, text, None, (Fault(str(self.path), None, "", str(error)),))
        return Reading(self, text, study, (), document, section)


@dataclass(frozen=True, eq=False)
class Reading:
    """A text, and the study that it is; None, and faults, where it is none."""

    context: Context
    text: str
    study: Study | None
    faults: tuple[Fault, ...]
    document: Document | None = None
    section: StudySection | None = None

    @cached_property
    def fields(self) -> tuple[Field, ...]:
        """Every value that can vary; empty where the text is no study."""
        if self.section is None or self.document is None:
            return ()
        return study_fields(self.section, self.document.root, self.context.effects.by_id)

    @cached_property
    def by_path(self) -> dict[str, Field]:
        """The same by their paths."""
        return {field.path: field for field in self.fields}

    def moved_to(self, folder: Path) -> str:
        """Return the text with the relative paths in it as they are from a folder."""
        if self.document is None:
            return self.text
        return moved_to(folder, self.text, self.document, self.context.path.parent)


@dataclass(frozen=True, slots=True, eq=False)
class SessionState:
    """All that a step may change.

    Parameters
    ----------
    reading : Reading
        The text, and what it is.
    live : Reading
        The same, or, where the text is faulty, what was sound last; where nothing ever was, the
        text.
    place : array (6,)
        Where the platform is, and its rotation vector [m, rad].
    rope : Rope, RopePerCable or None
        The rope, or the ropes of groups, that are looked at.
    pin : object
        What the present state is compared with; None for nothing.
    """

    reading: Reading
    live: Reading
    place: FloatArray
    rope: Rope | RopePerCable | None = None
    pin: object = None


@dataclass(frozen=True, slots=True)
class Rejected:
    """An entry that was refused: what was typed, and why."""

    text: str
    faults: tuple[Fault, ...]


def text_of(path: Path) -> str:
    """Return what a file holds, its line ends kept.

    Raises
    ------
    InputError
        If it cannot be read, is too large, or is no text.
    """
    return decode(read_bytes(path, str(path)), str(path))


def with_entry(reading: Reading, text: str, one: Field, typed: str) -> str:
    """Return a text of a study with what was typed for a field of it.

    Nothing typed takes an optional value out. What the text lacks is added: of a list, with the
    other values of its row as they are.
    """
    keys = _written(text, one.path)
    is_there = edits.value_text(text, keys) is not None
    if not typed.strip() and one.is_optional:
        return edits.without(text, keys) if is_there else text
    value = edits.scalar(typed)
    if is_there:
        return edits.with_value(text, keys, value)
    if isinstance(keys[-1], int):
        row = path_text(keys_of(one.path)[:-1])
        parts = [f.text for f in reading.fields if path_text(keys_of(f.path)[:-1]) == row]
        parts[keys[-1]] = value
        value, keys = f"[{', '.join(parts)}]", keys[:-1]
    return edits.with_value(_spelt_out(text, keys), keys, value)


def put_back(now: Reading, saved: Reading, path: str) -> str:
    """Return the present text with one field as the file has it, or without it."""
    text = now.text
    here, there = _written(text, path), _written(saved.text, path)
    own = edits.value_text(saved.text, there)
    if own is not None:
        if edits.value_text(text, here) is None:
            text = _spelt_out(text, here)
        return edits.with_value(text, here, own)
    if edits.value_text(text, here) is None:
        return text
    if isinstance(here[-1], int):
        default = saved.by_path.get(path)
        text = edits.with_value(text, here, "0" if default is None else default.text)
        here = here[:-1]
    else:
        text = edits.without(text, here)
    return _shortened(saved.text, _without_new(now, saved.text, text, here), here)


def pose_text(place: FloatArray, *, is_point_mass: bool) -> str:
    """Return a place (6,) as a study has it under ``pose``."""
    position, turn = (
        "[" + ", ".join(f"{value + 0.0:.{_DIGITS}g}" for value in part) + "]"
        for part in np.split(place, 2)
    )
    if is_point_mass or not place[3:].any():
        return position
    return f"{{position: {position}, rotation_vector: {turn}}}"


def _without_new(now: Reading, saved_text: str, text: str, keys: Sequence[Key]) -> str:
    """Return a text without what the file lacks around a path, if that says nothing new."""
    section = now.context.read(text).section
    for end in range(1, len(keys) + 1):
        is_new = edits.value_text(saved_text, keys[:end]) is None
        if is_new and edits.value_text(text, keys[:end]) is not None:
            shorter = edits.without(text, keys[:end])
            if section is not None and now.context.read(shorter).section == section:
                return shorter
    return text


def _shortened(saved_text: str, text: str, keys: Sequence[Key]) -> str:
    """Return the text with a list in place of a mapping on this path, where the file has one."""
    for end in range(1, len(keys)):
        around = keys[:end]
        only = edits.value_text(text, (*around, _shorthand(around)))
        was_list = only is not None and _is_list(edits.value_text(saved_text, around))
        if only is not None and was_list and edits.field_count(text, around) == 1:
            return edits.with_value(text, around, only)
    return text


def _written(text: str, path: str) -> tuple[Key, ...]:
    """Return where a path of the schema is in a text, where a list may stand for a mapping."""
    keys: tuple[Key, ...] = ()
    for key in keys_of(path):
        if not (key == _shorthand(keys) and _is_list(edits.value_text(text, keys))):
            keys = (*keys, key)
    return keys


def _spelt_out(text: str, keys: Sequence[Key]) -> str:
    """Return the text with a list that stands for a mapping on this path written as that."""
    for end in range(1, len(keys)):
        around = keys[:end]
        value = edits.value_text(text, around)
        if value is not None and _is_list(value) and isinstance(keys[end], str):
            return edits.with_value(text, around, f"{{{_shorthand(around)}: {edits.flow(value)}}}")
    return text


def _shorthand(keys: Sequence[Key]) -> str:
    return _SHORTHAND.get(path_text(keys), _USUAL)


def _is_list(value: str | None) -> bool:
    return value is not None and value.startswith(("[", "- "))
