"""The table of inputs: every field as the file gives it and in SI."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from pydantic import BaseModel

from designer.documents.document import Key, Node, path_text
from designer.documents.fields import QuantityField, reader_in
from designer.io.config.columns import ColumnSection
from designer.io.config.regions import OrientationSection
from designer.study import Entry
from designer.units import NUMBER, Dimension, format_SI

DEFAULT = "default"
_MOST_ROWS = 64


def all_entries(section: BaseModel, node: Node | None, place: tuple[Key, ...] = ()) -> list[Entry]:
    """Return the entries of a section and all below it, in the order of the schema.

    Fields and sections that the file leaves out are marked ``default``.
    """
    entries: list[Entry] = []
    for name, info in type(section).model_fields.items():
        value = getattr(section, name)
        below = field_node(node, name, section)
        if isinstance(value, BaseModel):
            entries += all_entries(value, below, (*place, name))
        else:
            reader = reader_in(info.rebuild_annotation())
            dimension = reader.dimension if isinstance(reader, QuantityField) else NUMBER
            entries += _entries(value, below, (*place, name), dimension)
    return entries


def as_given(node: Node | None) -> str:
    """Return a value as the file has it, ``default`` where it has none."""
    return DEFAULT if node is None else node.as_written()


def field_node(node: Node | None, name: str, section: BaseModel) -> Node | None:
    """Return the node of a section's field, None where the file gives none.

    A list in place of a section gives the section's first field.
    """
    if node is None:
        return None
    is_shorthand = isinstance(node.content, tuple)
    is_first = name == next(iter(type(section).model_fields))
    part_node = node if is_shorthand and is_first else node.child(name)
    is_empty = part_node is None or (
        isinstance(part_node.content, str) and part_node.data() is None
    )
    return None if is_empty else part_node


def _entries(
    value: Any, node: Node | None, place: tuple[Key, ...], dimension: Dimension
) -> Iterator[Entry]:
    if node is None:
        yield Entry(path_text(place), DEFAULT, _in_SI(value, dimension))
    elif isinstance(value, tuple) and value and isinstance(value[0], BaseModel):
        for index, item in enumerate(value):
            yield Entry(
                path_text((*place, index)),
                as_given(node.child(index)),
                _in_words(item, node.child(index)),
            )
    elif isinstance(value, dict) and value:
        for name, item in value.items():
            if isinstance(item, tuple):
                yield from _entries(item, node.child(name), (*place, name), NUMBER)
            elif isinstance(item, ColumnSection):
                yield Entry(path_text((*place, name)), as_given(node.child(name)), item.meaning)
    elif not (isinstance(value, tuple) and value and isinstance(value[0], tuple)):
        yield Entry(path_text(place), node.as_written(), _in_SI(value, dimension))
    elif len(value) > _MOST_ROWS:
        ends = f"{_in_SI(value[0], dimension)} … {_in_SI(value[-1], dimension)}"
        yield Entry(path_text(place), f"{len(value)} rows", ends)
    else:
        for index, row in enumerate(value):
            yield from _entries(row, node.child(index), (*place, index), dimension)


def _in_words(section: BaseModel, node: Node | None) -> str:
    """Return what a section in a list gives, in SI units."""
    if isinstance(section, OrientationSection):
        return str(section)
    written = (entry for entry in all_entries(section, node) if entry.given != DEFAULT)
    return ", ".join(f"{entry.field} {entry.value_SI}" for entry in written)


def _in_SI(value: Any, dimension: Dimension) -> str:
    if value is None or value in ((), {}):
        return "none"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return format_SI(value, dimension)
    if isinstance(value, tuple):
        return f"[{', '.join(_in_SI(item, NUMBER) for item in value)}] {dimension.unit}".rstrip()
    return str(value)
