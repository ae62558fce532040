"""What a report is made of: sections of blocks; everything in them is text, ready to be shown.

A text among the blocks is a paragraph. Of the others, ``shape`` names the macro of
``reports/blocks.html.j2`` that shows it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from datetime import datetime
from typing import TYPE_CHECKING, ClassVar, Generic, Literal, TypeVar

from designer import __version__
from designer.report.phrases import shown_time

if TYPE_CHECKING:
    from designer.analysis.provenance import Provenance
    from designer.study import Study

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
class Facts:
    """Named values, one below the other."""

    shape: ClassVar = "facts"
    items: tuple[Fact, ...]


@dataclass(frozen=True, slots=True)
class Statement:
    """A short heading and a sentence or two."""

    shape: ClassVar = "statement"
    title: str
    text: str
    tone: Tone = ""


@dataclass(frozen=True, slots=True)
class Bullets:
    """A list."""

    shape: ClassVar = "bullets"
    items: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Listing:
    """Text as it stands in a file."""

    shape: ClassVar = "listing"
    text: str


@dataclass(frozen=True, slots=True)
class Subheading:
    """A heading within a section; links point to its ``id``."""

    shape: ClassVar = "subheading"
    id: str
    title: str


@dataclass(frozen=True, slots=True)
class Column:
    """Head of a column: its title, its unit, and whether it holds numbers (set to the right)."""

    title: str
    unit: str = ""
    is_number: bool = True


Heads = tuple[Column | str, ...]
"""Heads of a table; a plain title heads a column of words."""


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
    """A table with a caption; every row has as many cells as there are columns.

    ``kind`` holds classes of the style sheet: ``long`` may break over pages, ``narrow`` is as wide
    as its text.
    """

    shape: ClassVar = "table"
    caption: str
    columns: tuple[Column, ...]
    groups: tuple[Group, ...]
    kind: str = ""

    @classmethod
    def of(
        cls,
        caption: str,
        columns: Heads,
        *rows: Row | tuple[str, ...],
        kind: str = "",
    ) -> Table:
        """Return a table without groups."""
        body = (Row(row) if isinstance(row, tuple) else row for row in rows)
        return cls.grouped(caption, columns, (Group(tuple(body)),), kind)

    @classmethod
    def grouped(
        cls, caption: str, columns: Heads, groups: Iterable[Group], kind: str = ""
    ) -> Table:
        """Return a table of groups of rows."""
        heads = (Column(c, is_number=False) if isinstance(c, str) else c for c in columns)
        return cls(caption, tuple(heads), tuple(groups), kind)


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
    kind : str
        Classes of the style sheet: ``space`` is a little smaller than the page is wide, ``half``
        half as wide; ``screen`` is not on paper.
    """

    shape: ClassVar = "picture"
    caption: str
    alternative: str
    svg: str = ""
    bitmap: str = ""
    scene: str = ""
    kind: str = ""


@dataclass(frozen=True, slots=True)
class Box:
    """Blocks with classes of the style sheet around them: ``keep`` stays on one page."""

    shape: ClassVar = "box"
    kind: str
    blocks: tuple[Block, ...]

    @classmethod
    def of(cls, kind: str, *blocks: Block | None) -> Box:
        """Return a box; what is None or an empty text is left out."""
        return cls(kind, tuple(block for block in blocks if block))


Block = str | Facts | Statement | Bullets | Listing | Subheading | Table | Picture | Box


@dataclass(frozen=True, slots=True)
class Section:
    """A section: the id that links point to, its title, its blocks, classes of the style sheet.

    It is shown by a template of its own in the folder of the document, such as
    ``report/nomenclature.html.j2``, which gets ``context`` and may ``set title``; else by
    ``section.html.j2``. ``body`` is what that made of it.
    """

    id: str
    title: str = ""
    blocks: tuple[Block, ...] = ()
    kind: str = ""
    context: Mapping[str, object] = field(default_factory=dict)
    body: str = ""

    @classmethod
    def of(cls, section_id: str, title: str, *blocks: Block | None, kind: str = "") -> Section:
        """Return a section; what is None or an empty text is left out."""
        return cls(section_id, title, tuple(block for block in blocks if block), kind)


@dataclass(frozen=True, slots=True)
class Control:
    """Head of a document.

    Parameters
    ----------
    boxes : tuple of Fact
        Number, revision and names, those that the study gives.
    logo : str
        A picture as a data URI; may be empty.
    identity : str
        Digests of config, grades and measured data.
    """

    boxes: tuple[Fact, ...] = ()
    logo: str = ""
    identity: str = ""


NO_CONTROL = Control()

Page = TypeVar("Page")


@dataclass(frozen=True, slots=True)
class Report(Generic[Page]):
    """A whole document; the templates know it as ``report``.

    Parameters
    ----------
    name : str
        ``report`` or ``diagnosis``: the name of its files, and of the folder of its own templates.
    title : str
        Name of the study.
    document : str
        What it is, such as ``Cable design report``.
    generator : str
        This program and its version.
    created, created_iso : str
        Date and time of the results, to read and as ISO 8601.
    first_page : FirstPage
        What the template of the first section, ``answer``, shows.
    sections : tuple of Section
        All sections, in order.
    missing : str
        Why pictures in space are left out, and what to install; empty where they are not.
    control : Control
        Number, revision, names, logo, digests.
    """

    name: str
    title: str
    document: str
    generator: str
    created: str
    created_iso: str
    first_page: Page
    sections: tuple[Section, ...]
    missing: str = ""
    control: Control = NO_CONTROL

    @classmethod
    def of(
        cls,
        name: str,
        document: str,
        study: Study,
        provenance: Provenance,
        first_page: Page,
        sections: Iterable[Section | None],
        missing: str = "",
        control: Control = NO_CONTROL,
    ) -> Report[Page]:
        """Return a report on a study; sections that are None are left out."""
        return cls(
            name,
            study.name,
            document,
            f"cdpr-designer {provenance.version}",
            shown_time(provenance.created),
            provenance.created.isoformat(timespec="seconds"),
            first_page,
            tuple(section for section in sections if section is not None),
            missing,
            control,
        )

    def section(self, section_id: str) -> Section:
        """Return a section that this report has."""
        return next(section for section in self.sections if section.id == section_id)


def plain_report(
    name: str, title: str, document: str, created: datetime, sections: Iterable[Section | None]
) -> Report[None]:
    """Return a report that is not on one study; sections that are None are left out."""
    return Report(
        name,
        title,
        document,
        f"cdpr-designer {__version__}",
        shown_time(created),
        created.isoformat(timespec="seconds"),
        None,
        tuple(section for section in sections if section is not None),
    )
