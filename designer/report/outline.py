"""The outline (bookmarks) and the metadata of the PDF, taken from the page it was made from."""

from __future__ import annotations

import io
from dataclasses import dataclass
from datetime import datetime
from html.parser import HTMLParser
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pypdf import PdfReader, PdfWriter
    from pypdf.generic import IndirectObject

_LEVELS = {"h1": 1, "h2": 2, "h3": 3}


@dataclass(frozen=True, slots=True)
class PageHeading:
    """A heading of the page: level from 1, the id that links point to, and its text."""

    level: int
    id: str
    text: str


@dataclass(frozen=True, slots=True)
class PageSummary:
    """What a page says about itself: title, generator, date of creation (ISO 8601), headings."""

    title: str
    generator: str
    created: str
    headings: tuple[PageHeading, ...]


def summarise(html: str) -> PageSummary:
    """Return what a page says about itself; only headings with an id count."""
    reader = _Reader()
    reader.feed(html)
    reader.close()
    return PageSummary(
        title=reader.title.strip(),
        generator=reader.meta.get("generator", ""),
        created=reader.meta.get("dcterms.created", ""),
        headings=tuple(PageHeading(k, name, " ".join(t.split())) for k, name, t in reader.headings),
    )


def add_outline(pdf: bytes, html: str) -> bytes:
    """Return the PDF with an outline and metadata.

    A heading gets its place from a named destination of its id. PlutoPrint writes one for every
    id that a link of the page points to; headings without are left out of the outline.
    """
    from pypdf import PdfReader, PdfWriter

    page = summarise(html)
    reader = PdfReader(io.BytesIO(pdf))
    writer = PdfWriter(clone_from=reader)
    _add_items(writer, reader, page.headings)
    writer.add_metadata(_metadata(page))
    writer.page_mode = "/UseOutlines"
    stream = io.BytesIO()
    writer.write(stream)
    return stream.getvalue()


def _add_items(writer: PdfWriter, reader: PdfReader, headings: tuple[PageHeading, ...]) -> None:
    from pypdf.generic import Fit

    places = reader.named_destinations
    parents: dict[int, IndirectObject] = {}
    for heading in headings:
        place = places.get(heading.id)
        number = None if place is None else reader.get_destination_page_number(place)
        if place is None or number is None:
            continue
        above = [parents[level] for level in sorted(parents) if level < heading.level]
        parents = {k: item for k, item in parents.items() if k < heading.level}
        parents[heading.level] = writer.add_outline_item(
            title=heading.text,
            page_number=number,
            parent=above[-1] if above else None,
            fit=Fit.xyz(top=float(place.top or 0.0)),
        )


def _metadata(page: PageSummary) -> dict[str, str]:
    values = {"/Title": page.title, "/Author": page.generator, "/Creator": page.generator}
    if page.created:
        moment = datetime.fromisoformat(page.created)
        offset = moment.strftime("%z")
        zone = f"{offset[:3]}'{offset[3:5]}'" if offset else ""
        values["/CreationDate"] = values["/ModDate"] = moment.strftime("D:%Y%m%d%H%M%S") + zone
    return values


class _Reader(HTMLParser):
    """Collects the title, the named metadata and the headings of a page."""

    def __init__(self) -> None:
        super().__init__()
        self.title = ""
        self.meta: dict[str, str] = {}
        self.headings: list[tuple[int, str, str]] = []
        self._open = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = {name: value or "" for name, value in attrs}
        if tag == "meta" and "name" in values:
            self.meta[values["name"]] = values.get("content", "")
        elif tag == "title" and not self.title:
            self._open = tag
        elif tag in _LEVELS and "id" in values:
            self._open = tag
            self.headings.append((_LEVELS[tag], values["id"], ""))

    def handle_endtag(self, tag: str) -> None:
        if tag == self._open:
            self._open = ""

    def handle_data(self, data: str) -> None:
        if self._open == "title":
            self.title += data
        elif self._open:
            level, name, text = self.headings[-1]
            self.headings[-1] = (level, name, text + data)
