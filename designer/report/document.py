"""What a document is: its head, sections with what their templates are given, and drawings."""

from __future__ import annotations

import base64
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from datetime import datetime
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from designer import __version__
from designer.documents.opened import read_input
from designer.documents.picture import picture_type, why_not_shown
from designer.grades.registry import Catalogue
from designer.report.phrases import shown_time
from designer.study import Study

if TYPE_CHECKING:
    from designer.report.figures.stage import Image

MOST_ROWS = 8
"""As many rows of a ranking as a reader takes in; files beside the report have the rest."""


@dataclass(frozen=True, slots=True)
class Section:
    """A section: the id that links point to, classes of the style sheet, what its template gets.

    It is shown by a template of its own in the folder of the document, such as
    ``report/nomenclature.html.j2``, which gets ``context`` and sets ``title``; ``title`` and
    ``body`` are what that made of it.
    """

    id: str
    kind: str = ""
    context: Mapping[str, object] = field(default_factory=dict)
    title: str = ""
    body: str = ""


class ControlBox(NamedTuple):
    """A box in the head of a document, such as the number of the document."""

    label: str
    value: str


@dataclass(frozen=True, slots=True)
class Control:
    """Head of a document."""

    boxes: tuple[ControlBox, ...] = ()  #: number, revision and names, those that the study gives
    logo: str = ""  #: a picture as a data URI; may be empty
    identity: str = ""  #: digests of config, grades and measured data


NO_CONTROL = Control()


@dataclass(frozen=True, slots=True)
class Report:
    """A whole document; the templates know it as ``report``."""

    #: ``report`` or ``diagnosis``: the name of its files, and of the folder of its own templates
    name: str
    title: str  #: name of the study
    document: str  #: what it is, such as ``Cable design report``
    generator: str  #: this program and its version
    created: str  #: date and time of the results, to read
    created_iso: str  #: the same as ISO 8601
    sections: tuple[Section, ...]  #: all sections, in order
    missing: str = ""  #: why pictures in space are left out, and what to install
    control: Control = NO_CONTROL  #: document number, revision and who has checked it
    problems: tuple[str, ...] = ()  #: of sections and filters of plugins that are left out
    filters: Mapping[str, Callable[..., object]] | None = None  #: beside ours, for its templates

    @classmethod
    def of(
        cls,
        name: str,
        title: str,
        document: str,
        created: datetime,
        sections: Iterable[Section | None],
        *,
        version: str = __version__,
        missing: str = "",
        control: Control = NO_CONTROL,
        problems: Iterable[str] = (),
        filters: Mapping[str, Callable[..., object]] | None = None,
    ) -> Report:
        """Return a report; sections that are None are left out."""
        return cls(
            name,
            title,
            document,
            f"cdpr-designer {version}",
            shown_time(created),
            created.isoformat(timespec="seconds"),
            tuple(section for section in sections if section is not None),
            missing,
            control,
            tuple(problems),
            filters,
        )

    def section(self, section_id: str) -> Section:
        """Return a section that this report has."""
        return next(section for section in self.sections if section.id == section_id)


_DIGITS = 12
"""Of a digest on the first page; the provenance has all of them."""


def control_of(study: Study, catalogue: Catalogue | None = None) -> Control:
    """Return the head of a document on a study; with the grades that it was solved with."""
    given = study.document
    names = ("number", "revision", "author", "checker", "approver")
    titles = ("Document", "Revision", "Author", "Checked", "Approved")
    boxes = (
        ControlBox(title, getattr(given, name)) for name, title in zip(names, titles, strict=True)
    )
    return Control(
        tuple(box for box in boxes if box.value),
        "" if given.logo is None else _data_uri(given.logo),
        " · ".join(f"{what} {digest[:_DIGITS]}" for what, digest in _digests(study, catalogue)),
    )


def _digests(study: Study, catalogue: Catalogue | None) -> Iterator[tuple[str, str]]:
    if study.source.sha256:
        yield "SHA-256 of configuration", study.source.sha256
    yield from study.source.tables
    for source in catalogue.sources if catalogue is not None else ():
        if source.n_grades:
            yield f"grades {source.name}", source.sha256
    if study.measurements is not None:
        with suppress(OSError):  # a design needs no data, so they may be gone
            for path in study.measurements.files:
                name = f" {path.name}" if study.measurements.more_files else ""
                yield f"measured data{name}", sha256(read_input(path)).hexdigest()


def _data_uri(path: Path) -> str:
    """Return a picture; empty where it is gone or is none, although the study was read."""
    with suppress(OSError):
        content = read_input(path)
        if why_not_shown(content) is None:
            return f"data:{picture_type(content[:512])};base64,{base64.b64encode(content).decode()}"
    return ""


@dataclass(frozen=True, slots=True)
class Drawing:
    """A figure without its words.

    Parameters
    ----------
    svg : str
        Vector graphics to inline, trusted since drawn by this program; may be empty.
    bitmap : str
        A PNG as a data URI; may be empty.
    scene : str
        A whole HTML page with the same scene to turn; may be empty.
    """

    svg: str = ""
    bitmap: str = ""
    scene: str = ""


def vector(svg: str | None) -> Drawing | None:
    """Return a chart, its half-transparent parts written so that they stay vector graphics.

    PlutoPrint composes an element with ``opacity`` and a clip as a bitmap; the same with
    ``fill-opacity`` and ``stroke-opacity`` it draws. None stays None.
    """
    if svg is None:
        return None
    split = r"fill-opacity: \1; stroke-opacity: \1"
    return Drawing(re.sub(r"(?<![-\w])opacity: ([\d.]+)", split, svg))


def in_space(image: Image | None, page: str = "") -> Drawing | None:
    """Return a picture in space; ``page`` is the same to turn. None stays None."""
    if image is None:
        return None
    from designer.report.figures.overlay import png

    encoded = base64.b64encode(png(image)).decode()
    return Drawing(bitmap=f"data:image/png;base64,{encoded}", scene=page)
