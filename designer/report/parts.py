"""Building blocks of the report's context: everything in them is text, ready to be shown."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

MOST_ROWS = 8
"""As many rows of a ranking as a reader takes in; files beside the report have the rest."""

Tone = Literal["", "good", "bad", "doubt", "muted"]
"""How a statement or a row is coloured."""


@dataclass(frozen=True, slots=True)
class Fact:
    """A named value, with a remark where it needs one; ``link`` is where the remark leads to."""

    label: str
    value: str
    note: str = ""
    link: str = ""


@dataclass(frozen=True, slots=True)
class Column:
    """Head of a column: its title, its unit, and whether it holds numbers (set to the right)."""

    title: str
    unit: str = ""
    is_number: bool = True


@dataclass(frozen=True, slots=True)
class Row:
    """One row; ``note`` is shown below it over the whole width."""

    cells: tuple[str, ...]
    tone: Tone = ""
    note: str = ""


@dataclass(frozen=True, slots=True)
class Group:
    """Rows of a table that belong together, with a heading row where ``title`` is not empty."""

    rows: tuple[Row, ...]
    title: str = ""
    remark: str = ""
    tone: Tone = ""


@dataclass(frozen=True, slots=True)
class Table:
    """A table with a caption; every row has as many cells as there are columns."""

    caption: str
    columns: tuple[Column, ...]
    groups: tuple[Group, ...]

    @classmethod
    def of(cls, caption: str, columns: tuple[Column, ...], *rows: Row) -> Table:
        """Return a table without groups."""
        return cls(caption, columns, (Group(rows),))


@dataclass(frozen=True, slots=True)
class Picture:
    """A figure: vector graphics or a bitmap, and for some a scene to turn.

    Parameters
    ----------
    caption, alternative : str
        What is shown, below the picture and for those who cannot see it.
    svg : str
        Vector graphics to inline, trusted since drawn by this program; may be empty.
    bitmap : str
        A PNG as a data URI; may be empty.
    scene : str
        A whole HTML page with the same scene to turn; may be empty.
    """

    caption: str
    alternative: str
    svg: str = ""
    bitmap: str = ""
    scene: str = ""


@dataclass(frozen=True, slots=True)
class Statement:
    """A short heading and a sentence or two."""

    title: str
    text: str
    tone: Tone = ""
