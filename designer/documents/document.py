"""Reads a YAML file that may be anything, within bounds of size, depth and expansion."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

from designer.documents.node import Key, Keys, Node, path_text, printable
from designer.documents.opened import read_bytes
from designer.errors import Fault, InputError

if TYPE_CHECKING:
    import yaml

MOST_VALUES = 200_000
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
            is_mapping = isinstance(event, yaml.MappingStartEvent)
            node = self._collection(event, self._fields(keys) if is_mapping else self._items(keys))
        if event.anchor is not None:
            self._anchors[event.anchor] = self.anchored[start] = node
        return node

    def _collection(self, event: Any, content: tuple[Node, ...] | dict[str, Node]) -> Node:
        line, is_flow = _line(event), event.flow_style
        children = content if isinstance(content, tuple) else tuple(content.values())
        size = 1 + sum(child.size for child in children)
        height = 1 + max((child.height for child in children), default=0)
        if size > MOST_VALUES:
            problem = f"the aliases or lists here expand to more than {MOST_VALUES} values"
            _refuse(self._name, line, problem)
        if height > DEEPEST_NESTING:
            self._refuse_nesting(line)
        end = self._end if is_flow or not children else children[-1].end
        start = event.start_mark.index
        return Node(line, content, False, size, height, start, end, is_flow=is_flow)

    def _items(self, keys: Keys) -> tuple[Node, ...]:
        items: list[Node] = []
        for event in self._until_end():
            items.append(self._node(event, (*keys, len(items))))
        return tuple(items)

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
