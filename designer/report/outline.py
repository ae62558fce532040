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


@dataclass(slots=True)
class PageHeading:
    """A heading of the page: level from 1, the id that links point to, and its text."""

    level: int
    id: str
    text: str = ""


class PageSummary(HTMLParser):
    """What a page says about itself: title, language, named metadata, headings with an id."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.title = ""
        self.language = ""
        self.meta: dict[str, str] = {}
        self.headings: list[PageHeading] = []
        self._open = ""
        self.feed(html)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Begin a heading or the title, or note metadata."""
        values = {name: value or "" for name, value in attrs}
        if tag == "html":
            self.language = values.get("lang", "")
        elif tag == "meta" and "name" in values:
            self.meta[values["name"]] = values.get("content", "")
        elif tag == "title" and not self.title:
            self._open = tag
        elif tag in ("h1", "h2", "h3") and "id" in values:
            self._open = tag
            self.headings.append(PageHeading(int(tag[1]), values["id"]))

    def handle_endtag(self, tag: str) -> None:
        """End what this tag began."""
        if tag == self._open:
            self._open = ""

    def handle_data(self, data: str) -> None:
        """Add to what is open."""
        if self._open == "title":
            self.title += data
        elif self._open:
            self.headings[-1].text += data


def add_outline(pdf: bytes, html: str) -> bytes:
    """Return the PDF with an outline, metadata, and its language, which readers aloud ask for.

    Of the structure that they ask for, too, PlutoPrint writes the links alone; the HTML has all.
    A heading gets its place from a named destination of its id. PlutoPrint writes one for every id
    that a link of the page points to; headings without are left out of the outline.
    """
    from pypdf import PdfReader, PdfWriter
    from pypdf.generic import BooleanObject, DictionaryObject, NameObject, TextStringObject

    page = PageSummary(html)
    reader = PdfReader(io.BytesIO(pdf))
    writer = PdfWriter(clone_from=reader)
    _add_items(writer, reader, page.headings)
    writer.add_metadata(_metadata(page))
    writer.page_mode = "/UseOutlines"
    if page.language:
        writer.root_object[NameObject("/Lang")] = TextStringObject(page.language)
    shown = DictionaryObject({NameObject("/DisplayDocTitle"): BooleanObject(True)})
    writer.root_object[NameObject("/ViewerPreferences")] = shown
    stream = io.BytesIO()
    writer.write(stream)
    return stream.getvalue()


def _add_items(writer: PdfWriter, reader: PdfReader, headings: list[PageHeading]) -> None:
    from pypdf.generic import Fit

    places = reader.named_destinations
    parents: dict[int, IndirectObject] = {}
    for heading in headings:
        place = places.get(heading.id)
        number = None if place is None else reader.get_destination_page_number(place)
        if place is None or number is None:
            continue
        parents = {level: item for level, item in parents.items() if level < heading.level}
        parents[heading.level] = writer.add_outline_item(
            title=" ".join(heading.text.split()),
            page_number=number,
            parent=parents[max(parents)] if parents else None,
            fit=Fit.xyz(top=float(place.top or 0.0)),
        )


def _metadata(page: PageSummary) -> dict[str, str]:
    author, created = page.meta.get("generator", ""), page.meta.get("dcterms.created", "")
    values = {"/Title": page.title.strip(), "/Author": author, "/Creator": author}
    if created:
        moment = datetime.fromisoformat(created)
        offset = moment.strftime("%z")
        zone = f"{offset[:3]}'{offset[3:5]}'" if offset else ""
        values["/CreationDate"] = values["/ModDate"] = moment.strftime("D:%Y%m%d%H%M%S") + zone
    return values
