"""Reads a YAML file that may be anything, within bounds of size, depth and expansion."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn

from designer.documents.node import Key, Node, path_text, printable
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
    composer = _Composer(name)
    root = composer.compose(decode(raw, name))
    if root is None:
        _refuse(name, None, "the file is empty", kind.content)
    if not isinstance(root.content, dict):
        expected = f"fields such as '{kind.field}'"
        _refuse(name, root.line, "the file does not hold a mapping", expected)
    return Document(name, hashlib.sha256(raw).hexdigest(), root, tuple(composer.faults))


def _refuse(name: str, line: int | None, problem: str, expected: str = "") -> NoReturn:
    raise InputError([Fault(name, line, "", problem, expected)])


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


@dataclass(slots=True)
class _Open:
    """A mapping or list whose end has not been read yet."""

    line: int
    anchor: str | None
    is_mapping: bool
    items: list[Node] = field(default_factory=list)
    fields: dict[str, Node] = field(default_factory=dict)
    key: str | None = None
    key_line: int = 0

    def close(self) -> Node:
        children = list(self.fields.values()) if self.is_mapping else self.items
        return Node(
            line=self.line,
            content=self.fields if self.is_mapping else tuple(self.items),
            size=1 + sum(child.size for child in children),
            height=1 + max((child.height for child in children), default=0),
        )


class _Composer:
    """Builds the tree from the parser's events, one by one, so that nothing expands unseen."""

    def __init__(self, name: str) -> None:
        self.faults: list[Fault] = []
        self._name = name
        self._open: list[_Open] = []
        self._anchors: dict[str, Node] = {}
        self._root: Node | None = None
        self._lines: list[str] = []

    def compose(self, text: str) -> Node | None:
        """Return the outermost value; None for an empty document."""
        import yaml

        self._lines = text.splitlines()
        documents = 0
        try:
            loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)  # libyaml is not everywhere
            events: Iterator[yaml.Event] = yaml.parse(text, Loader=loader)
            for event in events:
                documents += isinstance(event, yaml.DocumentStartEvent)
                if documents > 1:
                    _refuse(self._name, _line(event), "a second document starts here", "only one")
                self._take(event)
        except yaml.YAMLError as error:
            mark = getattr(error, "problem_mark", None) or getattr(error, "context_mark", None)
            reason = (
                getattr(error, "problem", None) or getattr(error, "reason", None) or "unreadable"
            )
            line = None if mark is None else mark.line + 1
            if "nesting depth" in str(reason):  # libyaml's own limit, which newer ones have
                self._refuse_nesting(line)
            text = "" if line is None else "".join(self._lines[line - 1 : line])
            if "\t" in text[: len(text) - len(text.lstrip())]:
                _refuse(self._name, line, "a tab indents this line", "blanks, which YAML asks for")
            _refuse(self._name, line, f"this is not valid YAML: {printable(str(reason))}")
        is_blank = self._root is not None and self._root.data() is None
        return None if is_blank else self._root

    def _take(self, event: yaml.Event) -> None:
        import yaml

        if isinstance(event, yaml.ScalarEvent):
            self._check_tag(event)
            self._add(Node(_line(event), event.value, event.implicit[0]), event.anchor)
        elif isinstance(event, yaml.AliasEvent):
            anchor = str(event.anchor)
            alias, line = f"the alias *{printable(anchor)}", _line(event)
            if any(opened.anchor == anchor for opened in self._open):
                _refuse(self._name, line, f"{alias} contains itself")
            if anchor not in self._anchors:
                _refuse(self._name, line, f"{alias} has no anchor before it")
            self._add(self._anchors[anchor])
        elif isinstance(event, yaml.CollectionStartEvent):
            self._check_tag(event)
            self._start(event, isinstance(event, yaml.MappingStartEvent))
        elif isinstance(event, yaml.CollectionEndEvent):
            opened = self._open.pop()
            node = opened.close()
            if node.size > MOST_VALUES:
                problem = f"the aliases or lists here expand to more than {MOST_VALUES} values"
                _refuse(self._name, node.line, problem)
            if node.height > DEEPEST_NESTING:
                self._refuse_nesting(node.line)
            self._add(node, opened.anchor)

    def _start(self, event: yaml.CollectionStartEvent, is_mapping: bool) -> None:
        if len(self._open) >= DEEPEST_NESTING:
            self._refuse_nesting(_line(event))
        if self._open and self._open[-1].is_mapping and self._open[-1].key is None:
            _refuse(self._name, _line(event), "a mapping or a list is no field name", "a name")
        self._open.append(_Open(_line(event), event.anchor, is_mapping))

    def _add(self, node: Node, anchor: str | None = None) -> None:
        if anchor is not None:
            self._anchors[anchor] = node
        if not self._open:
            self._root = node
            return
        parent = self._open[-1]
        if not parent.is_mapping:
            parent.items.append(node)
        elif parent.key is None:
            if not isinstance(node.content, str):
                _refuse(self._name, node.line, "a mapping or a list is no field name", "a name")
            parent.key, parent.key_line = node.content, node.line
        elif parent.key in parent.fields:
            keys = [
                container.key or "" if container.is_mapping else len(container.items)
                for container in self._open
            ]
            problem = f"is given twice, first in line {parent.fields[parent.key].line}"
            place = path_text(keys)
            self.faults.append(Fault(self._name, parent.key_line, place, problem, "once"))
            parent.key = None
        else:
            parent.fields[parent.key] = replace(node, line=parent.key_line)
            parent.key = None

    def _refuse_nesting(self, line: int | None) -> NoReturn:
        problem = f"values are nested more than {DEEPEST_NESTING} levels deep"
        _refuse(self._name, line, problem)

    def _check_tag(self, event: yaml.ScalarEvent | yaml.CollectionStartEvent) -> None:
        if event.tag not in (None, "!"):
            tag = printable(event.tag.replace("tag:yaml.org,2002:", "!!"))
            _refuse(self._name, _line(event), f"the tag '{tag}' is not supported", "plain YAML")


def _line(event: yaml.Event) -> int:
    return 1 if event.start_mark is None else event.start_mark.line + 1
