"""Find things in a report."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from typing import Any

from designer.report.blocks import Box, Facts, Picture, Statement, Table


def parts(part: object) -> Iterator[object]:
    """A part of a report and all that is in it, however deep."""
    yield part
    if isinstance(part, tuple):
        for item in part:
            yield from parts(item)
    elif dataclasses.is_dataclass(part):
        for field in dataclasses.fields(part):
            yield from parts(getattr(part, field.name))


def tables(part: object) -> list[Table]:
    """Every table."""
    return [one for one in parts(part) if isinstance(one, Table)]


def table(part: object, start: str) -> Table:
    """The one table whose caption begins so."""
    (found,) = [one for one in tables(part) if one.caption.startswith(start)]
    return found


def cells(part: object, start: str) -> list[tuple[str, ...]]:
    """The rows of the one table whose caption begins so."""
    return [row.cells for group in table(part, start).groups for row in group.rows]


def pictures(part: object) -> list[Picture]:
    """Every picture."""
    return [one for one in parts(part) if isinstance(one, Picture)]


def statements(part: object) -> dict[str, Statement]:
    """Every statement by its title."""
    return {one.title: one for one in parts(part) if isinstance(one, Statement)}


def facts(part: object) -> dict[str, Any]:
    """Every fact by its label."""
    return {f.label: f for one in parts(part) if isinstance(one, Facts) for f in one.items}


def texts(part: object) -> Iterator[str]:
    """Every text that a reader sees."""
    if isinstance(part, str):
        yield part
    elif isinstance(part, tuple):
        for item in part:
            yield from texts(item)
    elif dataclasses.is_dataclass(part):
        unseen = {"kind"} if isinstance(part, Box | Table) else set()
        if isinstance(part, Picture):
            unseen = {"svg", "bitmap", "alternative", "kind"}
        for field in dataclasses.fields(part):
            if field.name not in unseen:
                yield from texts(getattr(part, field.name))


def said(part: object) -> str:
    """Every text in one, with plain spaces."""
    return " ".join(texts(part)).replace("\u00a0", " ")
