"""A study that is edited: its text with comments kept, every step undone and done again."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Literal, Self

import numpy as np
from numpy.typing import ArrayLike

from designer.arrays import FloatArray, frozen_array
from designer.documents import edits
from designer.documents.document import Document, Key, decode, document_of, path_text
from designer.documents.opened import read_bytes
from designer.effects.load import load_effects
from designer.effects.registry import KnownEffects
from designer.errors import DesignerError, Fault, InputError, OutputError
from designer.explore.fields import Field, keys_of, study_fields, with_slider_of
from designer.explore.question import Question, Rope, RopePerCable, initial_place
from designer.io.config.moved import moved_to
from designer.io.config.reader import checked, study_of
from designer.io.config.schema import StudySection
from designer.io.output import write_file
from designer.plugins import Plugins
from designer.resources import example_file, example_names
from designer.study import Study

_SHORTHAND = {"pose": "position"}
"""What a list in place of these mappings is; of all others the rotation vector."""
_USUAL = "rotation_vector"
_POSE_DIGITS = 9


@dataclass(frozen=True, slots=True, eq=False)
class Context:
    """What a text is read with: where its relative paths start, effects, and plugins' grades."""

    path: Path
    effects: KnownEffects
    plugins: Plugins

    def read(self, text: str) -> Reading:
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
        return {field.path: field for field in self.fields}

    def moved_to(self, folder: Path) -> str:
        """Return the text with the relative paths in it as they are from a folder."""
        if self.document is None:
            return self.text
        return moved_to(folder, self.text, self.document, self.context.path.parent)


@dataclass(frozen=True, slots=True, eq=False)
class SessionState:
    """All that a step may change."""

    reading: Reading  #: The text, and what it is
    #: The same, or, where the text is faulty, what was sound last; where nothing ever was, the text
    live: Reading
    place: FloatArray  #: (6,) where the platform is, and its rotation vector [m, rad]
    rope: Rope | RopePerCable | None = None  #: The rope, or the ropes of groups, that are looked at
    pin: object = None  #: What the present state is compared with; None for nothing


@dataclass(frozen=True, slots=True)
class Rejected:
    """An entry that was refused: what was typed, and why."""

    text: str
    faults: tuple[Fault, ...]


def text_of(path: Path) -> str:
    """Return what a file holds, its line ends kept.

    Raises InputError if it cannot be read, is too large, or is no text.
    """
    return decode(read_bytes(path, str(path)), str(path))


def with_entry(reading: Reading, text: str, field: Field, typed: str) -> str:
    """Return a text of a study with what was typed for a field of it.

    Nothing typed takes an optional value out. What the text lacks is added: of a list, with the
    other values of its row as they are.
    """
    keys = _keys_in_text(text, field.path)
    is_given = edits.value_text(text, keys) is not None
    if not typed.strip() and field.is_optional:
        return edits.without(text, keys) if is_given else text
    value = edits.scalar(typed)
    if is_given:
        return edits.with_value(text, keys, value)
    if isinstance(keys[-1], int):
        row = path_text(keys_of(field.path)[:-1])
        parts = [f.text for f in reading.fields if path_text(keys_of(f.path)[:-1]) == row]
        parts[keys[-1]] = value
        value, keys = f"[{', '.join(parts)}]", keys[:-1]
    return edits.with_value(_expanded(text, keys), keys, value)


def put_back(present: Reading, saved: Reading, path: str) -> str:
    text = present.text
    keys, saved_keys = _keys_in_text(text, path), _keys_in_text(saved.text, path)
    saved_value = edits.value_text(saved.text, saved_keys)
    if saved_value is not None:
        if edits.value_text(text, keys) is None:
            text = _expanded(text, keys)
        return edits.with_value(text, keys, saved_value)
    if edits.value_text(text, keys) is None:
        return text
    if isinstance(keys[-1], int):
        default = saved.by_path.get(path)
        text = edits.with_value(text, keys, "0" if default is None else default.text)
        keys = keys[:-1]
    else:
        text = edits.without(text, keys)
    return _abbreviated(saved.text, _without_additions(present, saved.text, text, keys), keys)


def pose_text(place: FloatArray, *, is_point_mass: bool) -> str:
    """Return a place (6,) as a study has it under ``pose``."""
    position, turn = (
        "[" + ", ".join(f"{value + 0.0:.{_POSE_DIGITS}g}" for value in part) + "]"
        for part in np.split(place, 2)
    )
    if is_point_mass or not place[3:].any():
        return position
    return f"{{position: {position}, rotation_vector: {turn}}}"


def _without_additions(present: Reading, saved_text: str, text: str, keys: Sequence[Key]) -> str:
    """Return a text without what the file lacks around a path, if that says nothing new."""
    section = present.context.read(text).section
    for end in range(1, len(keys) + 1):
        is_new = edits.value_text(saved_text, keys[:end]) is None
        if is_new and edits.value_text(text, keys[:end]) is not None:
            shorter = edits.without(text, keys[:end])
            if section is not None and present.context.read(shorter).section == section:
                return shorter
    return text


def _abbreviated(saved_text: str, text: str, keys: Sequence[Key]) -> str:
    """Return the text with a list in place of a mapping on this path, where the file has one."""
    for end in range(1, len(keys)):
        outer = keys[:end]
        value = edits.value_text(text, (*outer, _shorthand(outer)))
        was_list = value is not None and _is_list(edits.value_text(saved_text, outer))
        if value is not None and was_list and edits.field_count(text, outer) == 1:
            return edits.with_value(text, outer, value)
    return text


def _keys_in_text(text: str, path: str) -> tuple[Key, ...]:
    """Return where a path of the schema is in a text, where a list may stand for a mapping."""
    keys: tuple[Key, ...] = ()
    for key in keys_of(path):
        if not (key == _shorthand(keys) and _is_list(edits.value_text(text, keys))):
            keys = (*keys, key)
    return keys


def _expanded(text: str, keys: Sequence[Key]) -> str:
    """Return the text with a list that stands for a mapping on this path written as that."""
    for end in range(1, len(keys)):
        outer = keys[:end]
        value = edits.value_text(text, outer)
        if value is not None and _is_list(value) and isinstance(keys[end], str):
            return edits.with_value(text, outer, f"{{{_shorthand(outer)}: {edits.flow(value)}}}")
    return text


def _shorthand(keys: Sequence[Key]) -> str:
    return _SHORTHAND.get(path_text(keys), _USUAL)


def _is_list(value: str | None) -> bool:
    return value is not None and value.startswith(("[", "- "))


OnDisk = Literal["same", "changed", "gone", "never saved"]
_DIGITS = 6  #: Of metres: a drag sets no finer ones
MAX_STEPS = 1000  #: Some hours of edits; each holds a text and what was read of it


@dataclass(slots=True)
class _Step:
    """What was done, the state that it led to, and the ``key`` of what may go on with it."""

    label: str
    state: SessionState
    key: object = None


class Session:
    """A study on its way; used by one thread.

    ``text`` is of the study, faulty or not; ``file`` None for a shipped study, which is not written
    to.
    """

    def __init__(self, text: str, context: Context, file: Path | None) -> None:
        self._context = context
        self.file = file  #: Where it is saved; None before that is known
        self.rejected: dict[str, Rejected] = {}
        """Entries that were refused, by the path of their field."""
        self._saved = context.read(text)
        self._question: tuple[SessionState, Question] | None = None
        self._fields: tuple[Reading, Reading, tuple[Field, ...]] | None = None
        place = initial_place(self._saved.study)
        self._steps = [_Step("", SessionState(self._saved, self._saved, place))]
        self._index = 0  #: Which of these steps was the last one; those after it were undone

    @classmethod
    def open(cls, path: Path, plugins: Plugins) -> Self:
        """Open a study file, faulty or not; a shipped one is saved elsewhere.

        Raises InputError if it cannot be read, or is no text.
        """
        text = text_of(path)
        is_shipped = path.stem in example_names() and path == example_file(path.stem)
        context = Context(path, load_effects(plugins), plugins)
        return cls(text, context, None if is_shipped else path)

    # What there is

    @property
    def state(self) -> SessionState:
        return self._steps[self._index].state

    @property
    def path(self) -> Path:
        """Where the study came from; relative paths in it start there."""
        return self._context.path

    @property
    def text(self) -> str:
        return self.state.reading.text

    @property
    def saved_text(self) -> str:
        return self._saved.text

    @property
    def faults(self) -> tuple[Fault, ...]:
        """What is wrong with the text, by line; empty for a study that is sound."""
        return self.state.reading.faults

    @property
    def study(self) -> Study | None:
        """The study; where the text is faulty the last one that was sound."""
        return self.state.live.study

    @property
    def name(self) -> str:
        """Title of the study; of one that never was sound the file's name."""
        return self.path.stem if self.study is None else self.study.name

    @property
    def problems(self) -> tuple[str, ...]:
        """What plugins brought that could not be used, one line each."""
        return self._context.effects.problems

    @property
    def is_modified(self) -> bool:
        return self.text != self.saved_text

    def question(self) -> Question | None:
        """Return what answers are computed of; None where there never was a sound study."""
        state, live = self.state, self.state.live
        if live.study is None:
            return None
        if self._question is None or self._question[0] is not state:
            origin = self._context.path, self._context.plugins
            question = Question(live.study, state.place, state.rope, live.text, *origin)
            self._question = state, question
        return self._question[1]

    def fields(self) -> tuple[Field, ...]:
        """Return every value that can vary; of a text that is faulty those of the last sound one.

        Sliders go from where to where they went for the file, as long as the value lies there.
        """
        live, saved = self.state.live, self._saved
        if self._fields is None or self._fields[:2] != (live, saved):
            ends = saved.by_path
            fields = tuple(with_slider_of(field, ends.get(field.path)) for field in live.fields)
            self._fields = live, saved, fields
        return self._fields[2]

    @property
    def differing(self) -> frozenset[str]:
        """Paths of the fields whose values are not those of the file."""
        saved = {field.path: field.meaning for field in self._saved.fields}
        return frozenset(
            field.path for field in self.state.live.fields if saved.get(field.path) != field.meaning
        )

    # Changes

    def edit(self, path: str, typed: str, *, continuous: bool = False) -> tuple[Fault, ...]:
        """Give a field another value, as typed; return what is wrong with it, nothing if taken.

        What is refused is kept in `rejected`, changes nothing else, and is tried again together
        with the next edit: of two values that hang together, one must come first. An empty text
        takes an optional value out. A ``continuous`` edit goes on with the last such edit of the
        same field, as one step; see `settle`.
        """
        field = self.state.live.by_path.get(path)
        if field is None:
            expected = "a value of this study"
            return (Fault(str(self.path), None, path, "there is no such value", expected),)
        self.rejected.pop(path, None)
        if " ".join(typed.split()) == field.text:
            return ()
        entries = {**{key: entry.text for key, entry in self.rejected.items()}, path: typed}
        reading = self._with_entries(entries)
        if reading.study is not None:
            self.rejected.clear()
        elif len(entries) > 1:
            reading = self._with_entries({path: typed})
        if reading.study is None:
            self.rejected[path] = Rejected(typed, reading.faults)
            return reading.faults
        label = f"Change {field.label[:1].lower()}{field.label[1:]}"
        self._take(label, path if continuous else None, reading, moves=path.startswith("pose."))
        return ()

    def put_back(self, path: str) -> tuple[Fault, ...]:
        self.rejected.pop(path, None)
        field = self.state.live.by_path.get(path)
        if field is None:
            return ()
        reading = self._context.read(put_back(self.state.live, self._saved, path))
        if reading.study is None:
            self.rejected[path] = Rejected(field.text, reading.faults)
            return reading.faults
        label = f"Put back {field.label[:1].lower()}{field.label[1:]}"
        self._take(label, None, reading, moves=path.startswith("pose."))
        return ()

    def set_text(self, text: str, *, continuous: bool = False) -> tuple[Fault, ...]:
        """Replace the whole text, which is taken as it is; return what is wrong with it."""
        reading = self._context.read(text)
        self.rejected.clear()
        starts = self.state.live.study is None
        self._take("Edit the text", "text" if continuous else None, reading, moves=starts)
        return reading.faults

    def move(self, place: ArrayLike, *, continuous: bool = False) -> None:
        """Take the platform to a position (3,) or a place (6,) [m, rad]; not part of the study."""
        target = np.asarray(place, dtype=np.float64)
        if len(target) == 3:
            target = np.concatenate([target, self.state.place[3:]])
        if not np.isfinite(target).all():
            raise ValueError("a place has finite coordinates")
        if not np.array_equal(target, self.state.place):
            key = "place" if continuous else None
            self._take("Move the platform", key, place=frozen_array(target))

    def turn(self, rotation_rad: FloatArray) -> None:
        """Turn the platform by a rotation vector (3,) [rad]; in a plane about its normal."""
        from scipy.spatial.transform import Rotation

        study, place = self.state.live.study, self.state.place.copy()
        if study is not None and study.robot.is_planar:
            rotation_rad = np.asarray(study.robot.upright[1]) * float(rotation_rad.sum())
        rotation = Rotation.from_rotvec(rotation_rad) * Rotation.from_rotvec(place[3:])
        place[3:] = rotation.as_rotvec()
        self.move(place, continuous=True)

    def keep_pose(self) -> tuple[Fault, ...]:
        """Write the place of the platform into the study as its pose; return what is wrong."""
        live, place = self.state.live, self.state.place
        if live.study is None:
            return self.faults
        value = pose_text(place, is_point_mass=live.study.robot.is_point_mass)
        reading = self._context.read(edits.with_value(live.text, ("pose",), value))
        if reading.study is not None:
            self._take("Keep the pose", None, reading, moves=True)
        return reading.faults

    def move_exit_point(self, number: int, position_m: FloatArray) -> tuple[Fault, ...]:
        """Take an exit point, counted from 0, to (3,) [m], on its way as one step until `settle`.

        Return what is wrong with that, nothing if taken. Coordinates that stay keep their text.
        """
        fields = [self.state.live.by_path[f"robot.anchors[{number}][{axis}]"] for axis in range(3)]
        entries = {
            field.path: field.text_of(value, exactly=True)
            for field, value in zip(fields, np.round(position_m, _DIGITS).tolist(), strict=True)
            if field.value_SI is None or abs(value - field.value_SI) > 10.0**-_DIGITS
        }
        if not entries:
            return ()
        reading = self._with_entries(entries)
        if reading.study is not None:
            self._take(f"Move exit point {number + 1}", ("exit point", number), reading)
        return reading.faults

    def choose(self, rope: Rope | RopePerCable | None) -> None:
        """Look at a rope, or ropes; at the thinnest cable of the configured family for None."""
        if rope != self.state.rope:
            self._take("Choose a rope", None, rope=rope)

    def begin_with(self, rope: Rope | RopePerCable | None) -> None:
        """Look at a rope that nobody chose; nothing that could be undone."""
        self._steps[self._index].state = replace(self.state, rope=rope)

    def set_pin(self, pin: object) -> None:
        """Compare with a state from now on; with nothing for None."""
        if pin is not self.state.pin:
            self._take("Pin" if pin is not None else "Unpin", None, pin=pin)

    def settle(self) -> None:
        """End what was going on: the next continuous change is a step of its own."""
        self._steps[self._index].key = None

    def _take(
        self,
        label: str,
        key: object,
        reading: Reading | None = None,
        *,
        moves: bool = False,
        **changes: Any,
    ) -> None:
        """Go on to another state; one that ``moves`` the platform takes it to the study's pose."""
        if reading is not None:
            live = self.state.live if reading.study is None else reading
            changes |= {"reading": reading, "live": live}
            if moves and reading.study is not None:
                changes["place"] = initial_place(reading.study)
        state, last = replace(self.state, **changes), self._steps[self._index]
        del self._steps[self._index + 1 :]
        if key is not None and last.key == key:
            last.state = state
        else:
            self._steps = [*self._steps, _Step(label, state, key)][-MAX_STEPS:]
            self._index = len(self._steps) - 1

    def _with_entries(self, entries: dict[str, str]) -> Reading:
        """Return what the last sound text is with entries in it, by path."""
        live = self.state.live
        text = live.text
        for path, typed in entries.items():
            if path in live.by_path:
                text = with_entry(live, text, live.by_path[path], typed)
        return self._context.read(text)

    # Undo

    @property
    def undo_label(self) -> str:
        return self._steps[self._index].label if self._index else ""

    @property
    def redo_label(self) -> str:
        return "".join(step.label for step in self._steps[self._index + 1 :][:1])

    def undo(self) -> None:
        self._go_to(max(self._index - 1, 0))

    def redo(self) -> None:
        self._go_to(min(self._index + 1, len(self._steps) - 1))

    def _go_to(self, step: int) -> None:
        self.rejected.clear()
        self.settle()
        self._index = step
        self.settle()
        self._stay_here()

    def _stay_here(self) -> None:
        """Have the present text, which may be of before it was saved elsewhere, lie where it is."""
        state = self.state
        if state.reading.context is not self._context:
            reading = self._context.read(state.reading.moved_to(self.path.parent))
            live = reading
            if reading.study is None:
                live = self._context.read(state.live.moved_to(self.path.parent))
            self._steps[self._index].state = replace(state, reading=reading, live=live)

    # Files

    def disk(self) -> OnDisk:
        """Tell how the file stands to what was read from it or written to it last."""
        if self.file is None:
            return "never saved"
        try:
            return "same" if text_of(self.file) == self.saved_text else "changed"
        except InputError:
            return "changed" if self.file.exists() else "gone"

    def reload(self) -> None:
        """Take what the file holds now, as a step that can be undone.

        Raises InputError if it cannot be read, or is no text; then nothing changes.
        """
        text = text_of(self.path)
        self.rejected.clear()
        self._saved = self._context.read(text)
        if text != self.text:
            self._take("Reload", None, self._saved, moves=True)

    def save(self) -> None:
        """Write the text to its file, whole or not at all.

        Raises OutputError if there is no file yet, or it cannot be written.
        """
        if self.file is None:
            raise OutputError(f"{self.name}: a shipped study is saved under another name")
        write_file(self.file, self.text)
        self._saved = self.state.reading

    def save_as(self, path: Path) -> None:
        """Write the study to another file, which it is from now on.

        Paths in it that are relative to where it was are rewritten for where it is.

        Raises OutputError if the file cannot be written; then nothing changes.
        """
        text = self.state.reading.moved_to(path.parent)
        write_file(path, text)
        self.file, self._context = path, replace(self._context, path=path)
        self._stay_here()
        self._saved = self.state.reading
