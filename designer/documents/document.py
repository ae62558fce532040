"""A YAML file as a tree in which every value knows its line, within bounds of size and depth."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, NoReturn

from designer.documents.opened import read_bytes
from designer.errors import Fault, InputError, visible
from designer.units import split_quantity

if TYPE_CHECKING:
    import yaml


Data = dict[str, "Data"] | list["Data"] | str | int | float | bool | None
"""What a document holds, in plain Python."""

Key = str | int
"""A field name, or the place in a list."""

Keys = tuple[Key, ...]
"""A path in a document, such as ``("sizes", 3, "linear_mass")``."""


class Flaw(NamedTuple):
    """One thing that is wrong with what a document holds: where, what was found and expected."""

    keys: Keys
    problem: str
    expected: str = ""


_WHOLE = re.compile(r"[-+]?\d{1,18}")
_DECIMAL = re.compile(r"[-+]?(\d+(\.\d*)?|\.\d+)([eE][-+]?\d+)?")
_SPECIAL: dict[str, Data] = {
    **dict.fromkeys(("", "~", "null", "Null", "NULL")),
    **dict.fromkeys(("true", "True", "TRUE"), True),
    **dict.fromkeys(("false", "False", "FALSE"), False),
    **dict.fromkeys((".nan", ".NaN", ".NAN"), float("nan")),
}


@dataclass(frozen=True, slots=True)
class Node:
    """One value of a document."""

    line: int  #: Line from 1; for a field of a mapping, the line of its name
    content: str | tuple[Node, ...] | dict[str, Node]  #: Text as written, items, or fields
    #: Whether a text stands without quotes, so that it may be a number or a truth value
    is_plain: bool = False
    #: Values and levels of nesting below this one, aliases expanded; itself is counted as a value
    size: int = 1
    height: int = 0
    #: Letters of the text before it, up to its end without blanks and comments, and before its name
    #: if it is a field of a mapping
    start: int = field(default=0, compare=False)
    end: int = field(default=0, compare=False)
    name_start: int = field(default=0, compare=False)
    #: Whether it is a mapping or list in brackets
    is_flow: bool = field(default=False, compare=False)

    def data(self) -> Data:
        """Return the value in plain Python, by the rules of YAML 1.2 (``no`` is a text)."""
        if isinstance(self.content, dict):
            return {key: child.data() for key, child in self.content.items()}
        if isinstance(self.content, tuple):
            return [child.data() for child in self.content]
        if not self.is_plain:
            return self.content
        if self.content in _SPECIAL:
            return _SPECIAL[self.content]
        if _WHOLE.fullmatch(self.content):
            return int(self.content)
        return float(self.content) if _DECIMAL.fullmatch(self.content) else self.content

    def quantity(self) -> tuple[float, str] | None:
        """Return number and unit of a text; None for what is none."""
        return split_quantity(self.content) if isinstance(self.content, str) else None

    def as_written(self) -> str:
        """Return the value on one line, numbers and units as the file has them."""
        if isinstance(self.content, dict):
            fields = (f"{key}: {child.as_written()}" for key, child in self.content.items())
            return "{" + ", ".join(fields) + "}"
        if isinstance(self.content, tuple):
            return "[" + ", ".join(child.as_written() for child in self.content) + "]"
        return " ".join(self.content.split())

    def child(self, key: Key) -> Node | None:
        """Return the field or item ``key``, None where there is none."""
        if isinstance(self.content, dict):
            return self.content.get(key) if isinstance(key, str) else None
        if isinstance(self.content, tuple) and isinstance(key, int) and key < len(self.content):
            return self.content[key]
        return None

    def at(self, keys: Sequence[Key]) -> Node | None:
        """Return the value at a path, None where there is none."""
        node: Node | None = self
        for key in keys:
            node = None if node is None else node.child(key)
        return node

    def with_value(self, keys: Sequence[Key], value: Node) -> Node:
        """Return the same with another value at a path, in the line of what it replaces.

        Fields that are missing on the way are made.

        Raises
        ------
        KeyError
            If the path leads through a text, or to an item that a list does not have.
        """
        if not keys:
            return replace(value, line=self.line)
        key, *rest = keys
        if isinstance(self.content, dict) and isinstance(key, str):
            child = self.content.get(key, Node(self.line, {}))
            return replace(self, content={**self.content, key: child.with_value(rest, value)})
        if isinstance(self.content, tuple) and isinstance(key, int) and key < len(self.content):
            child = self.content[key].with_value(rest, value)
            return replace(self, content=(*self.content[:key], child, *self.content[key + 1 :]))
        raise KeyError(key)

    def walk(self, keys: tuple[Key, ...] = ()) -> Iterator[tuple[tuple[Key, ...], Node]]:
        """Yield this value and all below it, each with its path."""
        yield keys, self
        if isinstance(self.content, dict):
            for name, child in self.content.items():
                yield from child.walk((*keys, name))
        elif isinstance(self.content, tuple):
            for index, child in enumerate(self.content):
                yield from child.walk((*keys, index))


def path_text(keys: Sequence[Key]) -> str:
    """Return a path as text, such as ``robot.anchors[2]``."""
    parts = (f"[{key}]" if isinstance(key, int) else f".{printable(key)}" for key in keys)
    return "".join(parts).removeprefix(".")


def path_keys(text: str) -> tuple[Key, ...]:
    """Return the path that a text names, such as ``robot.anchors[2]`` or ``robot.anchors.2``."""
    parts = re.findall(r"[^.\[\]]+", text)
    return tuple(int(part) if part.isdecimal() else part for part in parts)


def printable(name: str) -> str:
    """Return a field name cut short, with control characters replaced."""
    return visible(name if len(name) <= 60 else name[:60] + "…").replace("\n", "?")


MAX_VALUES = 200_000
DEEPEST_NESTING = 24
_CONTROL_CODE = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\x7f]")


@dataclass(frozen=True, slots=True)
class FileKind:
    """What a file should hold, for messages: the whole of it, and one of its fields."""

    content: str
    field: str


STUDY = FileKind("a study; `designer init` writes a first one", "robot: …")
GRADE = FileKind("a grade, as in the files of the shipped catalogue", "id: …")


@dataclass(frozen=True, slots=True)
class Document:
    """A YAML file that is well-formed, called ``name`` as the user named it.

    ``faults`` are the fields that are given twice; the first of the two is in the tree.
    """

    name: str
    sha256: str
    root: Node
    faults: tuple[Fault, ...]

    def fault(self, keys: Sequence[Key], problem: str, expected: str = "") -> Fault:
        """Return a fault at this path, in the line of its nearest value that exists."""
        node = self.root
        for key in keys:
            child = node.child(key)
            if child is None:
                break
            node = child
        return Fault(self.name, node.line, path_text(keys), problem, expected)


def read_document(path: Path, kind: FileKind = STUDY) -> Document:
    """Return the YAML mapping in ``path``, which should hold a ``kind``.

    Raises
    ------
    InputError
        If the file cannot be read, is too large, is not text, is empty, is not YAML, nests too
        deeply, expands to too many values, or is no mapping.
    """
    name = str(path)
    return document_of(read_bytes(path, name), name, kind)


def document_of(raw: bytes, name: str, kind: FileKind = STUDY) -> Document:
    """Return the YAML mapping in what a file holds, or would hold, as `read_document` does.

    Raises
    ------
    InputError
        As there.
    """
    composer = Composer(name)
    root = composer.compose(decode(raw, name))
    if root is None:
        _refuse(name, None, "the file is empty", kind.content)
    if not isinstance(root.content, dict):
        expected = f"fields such as '{kind.field}'"
        _refuse(name, root.line, "the file does not hold a mapping", expected)
    return Document(name, hashlib.sha256(raw).hexdigest(), root, tuple(composer.faults))


def _refuse(name: str, line: int | None, problem: str, expected: str = "") -> NoReturn:
    raise InputError.at(name, problem, expected, line=line)


def decode(raw: bytes, name: str) -> str:
    """Return what a file holds as text; `InputError` where it is none."""
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = raw.count(b"\n", 0, error.start) + 1
        _refuse(name, line, "this is not text in UTF-8", "a YAML text file")
    control_code = _CONTROL_CODE.search(text)
    if control_code is not None:
        line = text.count("\n", 0, control_code.start()) + 1
        _refuse(name, line, "this is a binary file", "a YAML text file")
    return text


class Composer:
    """Builds the tree from the parser's events, one by one, so that nothing expands unseen.

    ``faults`` are fields that are given twice, ``anchored`` the values with an anchor, each by
    where it starts.
    """

    def __init__(self, name: str = "") -> None:
        self.faults: list[Fault] = []
        self.anchored: dict[int, Node] = {}
        self._name = name
        self._events: Iterator[Any] = iter(())
        self._end = 0  # of the collection that was read last
        self._anchors: dict[str, Node | None] = {}  # None for what is not at its end yet

    def compose(self, text: str) -> Node | None:
        """Return the outermost value; None for an empty document."""
        import yaml

        try:
            loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # libyaml is not everywhere
            self._events = yaml.parse(text, Loader=loader)
            root: Node | None = None
            documents = 0
            for event in self._events:
                documents += isinstance(event, yaml.DocumentStartEvent)
                if documents > 1:
                    _refuse(self._name, _line(event), "a second document starts here", "only one")
                if isinstance(event, yaml.NodeEvent):
                    root = self._node(event, ())
        except yaml.YAMLError as error:
            mark = getattr(error, "problem_mark", None) or getattr(error, "context_mark", None)
            reason = (
                getattr(error, "problem", None) or getattr(error, "reason", None) or "unreadable"
            )
            line = None if mark is None else mark.line + 1
            if "nesting depth" in str(reason):  # libyaml's own limit, which newer ones have
                self._refuse_nesting(line)
            text = "" if line is None else "".join(text.splitlines()[line - 1 : line])
            if "\t" in text[: len(text) - len(text.lstrip())]:
                _refuse(self._name, line, "a tab indents this line", "blanks, which YAML asks for")
            _refuse(self._name, line, f"this is not valid YAML: {printable(str(reason))}")
        return None if root is None or root.data() is None else root

    def _node(self, event: Any, keys: Keys) -> Node:
        """Return the value at a path that begins with an event."""
        import yaml

        line, start, end = _line(event), event.start_mark.index, event.end_mark.index
        if isinstance(event, yaml.AliasEvent):
            anchor = str(event.anchor)
            if anchor not in self._anchors:
                problem = "has no anchor before it"
            elif (anchored := self._anchors[anchor]) is not None:
                return anchored
            else:
                problem = "contains itself"
            _refuse(self._name, line, f"the alias *{printable(anchor)} {problem}")
        if event.tag not in (None, "!"):
            tag = printable(event.tag.replace("tag:yaml.org,2002:", "!!"))
            _refuse(self._name, line, f"the tag '{tag}' is not supported", "plain YAML")
        if isinstance(event, yaml.ScalarEvent):
            node = Node(line, event.value, event.implicit[0], start=start, end=end)
        else:
            if len(keys) >= DEEPEST_NESTING:
                self._refuse_nesting(line)
            if event.anchor is not None:
                self._anchors[event.anchor] = None
            content = (
                self._fields(keys)
                if isinstance(event, yaml.MappingStartEvent)
                else tuple(self._node(e, (*keys, k)) for k, e in enumerate(self._until_end()))
            )
            node = self._collection(event, content)
        if event.anchor is not None:
            self._anchors[event.anchor] = self.anchored[start] = node
        return node

    def _collection(self, event: Any, content: tuple[Node, ...] | dict[str, Node]) -> Node:
        line, is_flow = _line(event), event.flow_style
        children = content if isinstance(content, tuple) else tuple(content.values())
        size = 1 + sum(child.size for child in children)
        height = 1 + max((child.height for child in children), default=0)
        if size > MAX_VALUES:
            problem = f"the aliases or lists here expand to more than {MAX_VALUES} values"
            _refuse(self._name, line, problem)
        if height > DEEPEST_NESTING:
            self._refuse_nesting(line)
        end = self._end if is_flow or not children else children[-1].end
        start = event.start_mark.index
        return Node(line, content, False, size, height, start, end, is_flow=is_flow)

    def _fields(self, keys: Keys) -> dict[str, Node]:
        import yaml

        fields: dict[str, Node] = {}
        for event in self._until_end():
            is_collection = isinstance(event, yaml.CollectionStartEvent)
            name = "" if is_collection else self._node(event, keys).content
            if is_collection or not isinstance(name, str):
                _refuse(self._name, _line(event), "a mapping or a list is no field name", "a name")
            place, line = (*keys, name), _line(event)
            value = self._node(next(self._events), place)
            if name in fields:
                problem = f"is given twice, first in line {fields[name].line}"
                self.faults.append(Fault(self._name, line, path_text(place), problem, "once"))
            else:
                fields[name] = replace(value, line=line, name_start=event.start_mark.index)
        return fields

    def _until_end(self) -> Iterator[Any]:
        """Yield what begins in the collection that is open, up to its end."""
        import yaml

        for event in self._events:
            if isinstance(event, yaml.CollectionEndEvent):
                self._end = getattr(event.end_mark, "index", 0)
                return
            yield event

    def _refuse_nesting(self, line: int | None) -> NoReturn:
        problem = f"values are nested more than {DEEPEST_NESTING} levels deep"
        _refuse(self._name, line, problem)


def _line(event: yaml.Event) -> int:
    return 1 if event.start_mark is None else event.start_mark.line + 1
