"""Changes of one value in the text of a YAML file, which leave every other letter as it was.

A library that writes the whole document anew keeps comments, but not how its author laid it out.
"""

from __future__ import annotations

import json
import re
import textwrap
from collections.abc import Iterator, Sequence
from typing import Any

from designer.documents.node import Key

_Node = Any
_PLAIN = re.compile(r"[+-]?[\w.°][\w.°²³·^*/%()+-]*(?: [\w.°/(][\w.°²³·^*/%()+-]*)*")
"""Words, numbers and units, without a letter that means something to YAML."""


def compose(text: str) -> _Node:
    """Return the nodes of a well-formed text, which know from where to where they stand."""
    import yaml

    return yaml.compose(text, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))


def scalar(typed: str) -> str:
    """Return what somebody typed as a value on one line, in quotes unless it surely needs none."""
    plain = " ".join(typed.split())
    return plain if _PLAIN.fullmatch(plain) else "'" + plain.replace("'", "''") + "'"


def value_text(text: str, keys: Sequence[Key]) -> str | None:
    """Return a value as it is written; None where there is none."""
    text = without_aliases(text)
    node, rest = _nearest(compose(text), keys)
    return None if rest else text[node.start_mark.index : _end(node)]


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
    if root.flow_style:
        return with_value(text, (name,), json.dumps(values))
    indent = " " * root.start_mark.column
    text = with_value(text, (name,), "\n" + textwrap.indent(block(values), f"{indent}  "))
    start = next(key.start_mark.index for key, _ in compose(text).value if key.value == name)
    return f"{text[:start]}# {comment}\n{indent}{text[start:]}"


def block(values: dict[str, Any]) -> str:
    """Return values as YAML, a line for each."""
    import yaml

    return str(yaml.safe_dump(values, sort_keys=False)).rstrip()


def without(text: str, keys: Sequence[Key]) -> str:
    """Return the text without the field at a path, which is there; its comment goes with it."""
    text = without_aliases(text)
    root = compose(text)
    parent, _ = _nearest(root, keys[:-1])
    names = [name.value for name, _ in parent.value]
    at = names.index(keys[-1])
    if len(names) == 1:
        return without(text, keys[:-1]) if keys[:-1] else "{}\n"
    name, end = parent.value[at][0], _end(parent.value[at][1])
    if parent.flow_style and at > 0:
        return text[: _end(parent.value[at - 1][1])] + text[end:]
    start = name.start_mark.index
    line = text.rfind("\n", 0, start) + 1
    if parent.flow_style or (at == 0 and text[line:start].strip()):  # as after "- "
        return text[:start] + text[parent.value[at + 1][0].start_mark.index :]
    return text[:line] + text[_line_end(text, end) + 1 :]


def without_aliases(text: str) -> str:
    """Return a text in which each ``*a`` is written out as what ``&a`` stands at, without it."""
    if "&" not in text:
        return text
    import yaml

    tokens = list(yaml.scan(text, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader)))
    nodes = {node.start_mark.index: node for node in _walk(compose(text))}
    named, parts, at = {}, [], 0
    for token in tokens:
        start, end = token.start_mark.index, token.end_mark.index
        if isinstance(token, yaml.AnchorToken):
            named[token.value] = nodes[start]
            parts.append(text[at:start])
            at = end + len(text[end:]) - len(text[end:].lstrip(" "))
        elif isinstance(token, yaml.AliasToken):
            parts += [text[at:start], _in_brackets(named[token.value])]
            at = end
    return "".join([*parts, text[at:]])


def _walk(node: _Node) -> Iterator[_Node]:
    """Yield a node and all below it, what an alias stands for once."""
    import yaml

    waiting, seen = [node], set()
    while waiting:
        pending = waiting.pop()
        if id(pending) not in seen:
            seen.add(id(pending))
            yield pending
            if isinstance(pending, yaml.MappingNode):
                waiting += [part for pair in pending.value for part in pair]
            elif isinstance(pending, yaml.SequenceNode):
                waiting += pending.value


def _in_brackets(node: _Node) -> str:
    """Return a node as it may stand anywhere, on one line."""
    import yaml

    if isinstance(node, yaml.MappingNode):
        entries = (f"{_in_brackets(name)}: {_in_brackets(value)}" for name, value in node.value)
        return "{" + ", ".join(entries) + "}"
    if isinstance(node, yaml.SequenceNode):
        return "[" + ", ".join(map(_in_brackets, node.value)) + "]"
    if not node.style:
        return scalar(node.value)
    return json.dumps(node.value, ensure_ascii=False)  # YAML reads it as JSON does


def _nearest(root: _Node, keys: Sequence[Key]) -> tuple[_Node, Sequence[Key]]:
    """Return the deepest node on a path, and the keys that it does not have."""
    import yaml

    node = root
    for at, key in enumerate(keys):
        child = None
        if isinstance(node, yaml.MappingNode):
            child = next((v for k, v in node.value if k.value == key), None)
        elif isinstance(node, yaml.SequenceNode) and isinstance(key, int):
            child = node.value[key] if key < len(node.value) else None
        if child is None:
            return node, keys[at:]
        node = child
    return node, ()


def _end(node: _Node) -> int:
    """Return where the letters of a node end, without blanks and comments after them."""
    import yaml

    if isinstance(node, yaml.ScalarNode) or node.flow_style or not node.value:
        return int(node.end_mark.index)
    last = node.value[-1]
    return _end(last[1] if isinstance(last, tuple) else last)


def _replaced(text: str, node: _Node, value: str) -> str:
    start, end = node.start_mark.index, _end(node)
    if value == text[start:end]:
        return text
    head = text[:start]
    if getattr(node, "flow_style", None) is False and node.value:  # begins in a line of its own
        head = head.rstrip()
        if "#" in head[head.rfind("\n") + 1 :]:
            head += "\n" + " " * (node.start_mark.column + 1)
    if value[0] == "\n":
        return head.rstrip() + value + text[end:]
    blank = "" if not head or head[-1].isspace() or head[-1] in "[{" else " "
    return head + blank + value + text[end:]


def _with_field(text: str, node: _Node, name: str, value: str) -> str:
    import yaml

    if not isinstance(node, yaml.MappingNode) or not node.value:
        return _replaced(text, node, f"{{{name}: {value}}}")
    last = _end(node.value[-1][1])
    if node.flow_style:
        return f"{text[:last]}, {name}: {value}{text[last:]}"
    newline = "\r\n" if "\r\n" in text else "\n"
    at = _line_end(text, last)
    at -= text[:at].endswith("\r")
    indent = " " * node.value[0][0].start_mark.column
    blank = "" if value[0] == "\n" else " "
    return f"{text[:at]}{newline}{indent}{name}:{blank}{value}{text[at:]}"


def _line_end(text: str, at: int) -> int:
    end = text.find("\n", at)
    return len(text) if end < 0 else end


def field_count(text: str, keys: Sequence[Key]) -> int:
    """Return how many fields a mapping has that is there."""
    return len(_nearest(compose(text), keys)[0].value)


def flow(value: str) -> str:
    """Return a list of plain values, as it is written, in brackets on one line."""
    if value.startswith("["):
        return value
    return "[" + ", ".join(scalar(str(item.value)) for item in compose(value).value) + "]"
