"""A YAML document as a tree in which every value knows its line."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

from designer.units import split_quantity

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
    """One value of a document.

    Parameters
    ----------
    line : int
        Line from 1; for a field of a mapping, the line of its name.
    content : str, tuple of Node, or dict of Node
        Text as written, items, or fields.
    is_plain : bool
        Whether a text stands without quotes, so that it may be a number or a truth value.
    size, height : int
        Values and levels of nesting below this one, aliases expanded; itself is counted as a value.
    start, end, name_start : int
        Letters of the text before it, up to its end without blanks and comments, and before its
        name if it is a field of a mapping.
    is_flow : bool
        Whether it is a mapping or list in brackets.
    """

    line: int
    content: str | tuple[Node, ...] | dict[str, Node]
    is_plain: bool = False
    size: int = 1
    height: int = 0
    start: int = field(default=0, compare=False)
    end: int = field(default=0, compare=False)
    name_start: int = field(default=0, compare=False)
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
    printable_name = "".join(letter if letter.isprintable() else "?" for letter in name)
    return printable_name if len(printable_name) <= 60 else printable_name[:60] + "…"
