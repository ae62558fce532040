"""Changes of one value in the text of a YAML file, which leave every other letter as it was.

A library that writes the whole document anew keeps comments, but not how its author laid it out.
"""

from __future__ import annotations

import json
import re
import textwrap
from collections.abc import Sequence
from typing import Any

from designer.documents.document import Composer, Key, Node

_PLAIN = re.compile(r"[+-]?[\w.°][\w.°²³·^*/%()+-]*(?: [\w.°/(][\w.°²³·^*/%()+-]*)*")
"""Words, numbers and units, without a letter that means something to YAML."""


def compose(text: str) -> Node:
    """Return the tree of a well-formed text that holds something."""
    root = Composer().compose(text)
    assert root is not None
    return root


def scalar(typed: str) -> str:
    """Return what somebody typed as a value on one line, in quotes unless it surely needs none."""
    plain = " ".join(typed.split())
    return plain if _PLAIN.fullmatch(plain) else "'" + plain.replace("'", "''") + "'"


def value_text(text: str, keys: Sequence[Key]) -> str | None:
    """Return a value as it is written; None where there is none."""
    text = without_aliases(text)
    node, rest = _nearest(compose(text), keys)
    return None if rest else text[node.start : node.end]


def with_value(text: str, keys: Sequence[Key], value: str) -> str:
    """Return the text with a value, written as it is to stand there, at a path.

    A field that is not there is put at the end of its mapping, with the mappings around it.
    Aliases are written out before: a change at ``*a`` is not one of what ``&a`` stands at.
    """
    text = without_aliases(text)
    node, rest = _nearest(compose(text), keys)
    if not rest:
        return _replaced(text, node, value)
    for key in reversed(rest[1:]):
        value = f"{{{key}: {value}}}"
    return _with_field(text, node, str(rest[0]), value)


def with_section(text: str, name: str, values: dict[str, Any], comment: str) -> str:
    """Return the text with a section of its first level, a line for each value, below a comment.

    Where the first level stands in braces, so does the section, without a comment.
    """
    root = compose(text)
    if root.is_flow:
        return with_value(text, (name,), json.dumps(values))
    indent = " " * _column(text, root.start)
    text = with_value(text, (name,), "\n" + textwrap.indent(block(values), f"{indent}  "))
    section = compose(text).child(name)
    assert section is not None
    start = section.name_start
    return f"{text[:start]}# {comment}\n{indent}{text[start:]}"


def block(values: dict[str, Any]) -> str:
    """Return values as YAML, a line for each."""
    import yaml

    return str(yaml.safe_dump(values, sort_keys=False)).rstrip()


def without(text: str, keys: Sequence[Key]) -> str:
    """Return the text without the field at a path, which is there; its comment goes with it."""
    text = without_aliases(text)
    parent, _ = _nearest(compose(text), keys[:-1])
    assert isinstance(parent.content, dict)
    fields = list(parent.content.values())
    at = list(parent.content).index(str(keys[-1]))
    if len(fields) == 1:
        return without(text, keys[:-1]) if keys[:-1] else "{}\n"
    start, end = fields[at].name_start, fields[at].end
    if parent.is_flow and at > 0:
        return text[: fields[at - 1].end] + text[end:]
    line = text.rfind("\n", 0, start) + 1
    if parent.is_flow or (at == 0 and text[line:start].strip()):  # as after "- "
        return text[:start] + text[fields[at + 1].name_start :]
    return text[:line] + text[_line_end(text, end) + 1 :]


def without_aliases(text: str) -> str:
    """Return a text in which each ``*a`` is written out as what ``&a`` stands at, without it."""
    if "&" not in text:
        return text
    import yaml

    tokens = list(yaml.scan(text, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader)))
    composer = Composer()
    composer.compose(text)
    named, parts, at = {}, [], 0
    for token in tokens:
        start, end = token.start_mark.index, token.end_mark.index
        if isinstance(token, yaml.AnchorToken):
            named[token.value] = composer.anchored[start]
            parts.append(text[at:start])
            at = end + len(text[end:]) - len(text[end:].lstrip(" "))
        elif isinstance(token, yaml.AliasToken):
            parts += [text[at:start], _in_brackets(named[token.value])]
            at = end
    return "".join([*parts, text[at:]])


def _in_brackets(node: Node) -> str:
    """Return a node as it may stand anywhere, on one line."""
    if isinstance(node.content, dict):
        entries = (f"{scalar(name)}: {_in_brackets(value)}" for name, value in node.content.items())
        return "{" + ", ".join(entries) + "}"
    if isinstance(node.content, tuple):
        return "[" + ", ".join(map(_in_brackets, node.content)) + "]"
    if node.is_plain:
        return scalar(node.content)
    return json.dumps(node.content, ensure_ascii=False)  # YAML reads it as JSON does


def _nearest(root: Node, keys: Sequence[Key]) -> tuple[Node, Sequence[Key]]:
    """Return the deepest node on a path, and the keys that it does not have."""
    node = root
    for at, key in enumerate(keys):
        child = node.child(key)
        if child is None:
            return node, keys[at:]
        node = child
    return node, ()


def _column(text: str, at: int) -> int:
    return at - (text.rfind("\n", 0, at) + 1)


def _replaced(text: str, node: Node, value: str) -> str:
    start, end = node.start, node.end
    if value == text[start:end]:
        return text
    head = text[:start]
    if not isinstance(node.content, str) and not node.is_flow:  # begins in a line of its own
        head = head.rstrip()
        if "#" in head[head.rfind("\n") + 1 :]:
            head += "\n" + " " * (_column(text, start) + 1)
    if value[0] == "\n":
        return head.rstrip() + value + text[end:]
    blank = "" if not head or head[-1].isspace() or head[-1] in "[{" else " "
    return head + blank + value + text[end:]


def _with_field(text: str, node: Node, name: str, value: str) -> str:
    if not isinstance(node.content, dict) or not node.content:
        return _replaced(text, node, f"{{{name}: {value}}}")
    fields = list(node.content.values())
    last = fields[-1].end
    if node.is_flow:
        return f"{text[:last]}, {name}: {value}{text[last:]}"
    newline = "\r\n" if "\r\n" in text else "\n"
    at = _line_end(text, last)
    at -= text[:at].endswith("\r")
    indent = " " * _column(text, fields[0].name_start)
    blank = "" if value[0] == "\n" else " "
    return f"{text[:at]}{newline}{indent}{name}:{blank}{value}{text[at:]}"


def _line_end(text: str, at: int) -> int:
    end = text.find("\n", at)
    return len(text) if end < 0 else end


def field_count(text: str, keys: Sequence[Key]) -> int:
    """Return how many fields a mapping has that is there."""
    return len(_nearest(compose(text), keys)[0].content)


def flow(value: str) -> str:
    """Return a list of plain values, as it is written, in brackets on one line."""
    return value if value.startswith("[") else compose(value).as_written()
