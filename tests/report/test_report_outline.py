"""What a page says about itself."""

from __future__ import annotations

import io

import pypdf

from designer.report.fonts import with_fonts
from designer.report.outline import PageHeading, PageSummary, add_outline
from designer.report.render import render_pdf

PAGE = """<!doctype html><html lang="en"><head><title>Tom &amp; Co</title>
<meta name="generator" content="us 1.0">
<meta name="dcterms.created" content="2026-02-03T04:05:06+01:30">
<style>body { font-family: "Report Sans" }</style></head><body>
<svg><title>not this one</title></svg>
<h1 id="top">Top</h1>
<h3 id="deep"><a href="#deep">Deep <b>one</b></a></h3>
<h2 id="two"><a href="#two">Two</a></h2>
<h2>No id</h2>
<h3 id="below"><a href="#below">Below</a></h3>
</body></html>"""


def test_summary() -> None:
    page = PageSummary(PAGE)
    assert (page.title, page.language) == ("Tom & Co", "en")
    assert page.meta == {"generator": "us 1.0", "dcterms.created": "2026-02-03T04:05:06+01:30"}
    assert page.headings == [
        PageHeading(1, "top", "Top"),
        PageHeading(3, "deep", "Deep one"),
        PageHeading(2, "two", "Two"),
        PageHeading(3, "below", "Below"),
    ]


def test_outline_holds_linked_headings_by_level() -> None:
    # With a font of its own: a machine may have none, and headings without letters have no place.
    reader = pypdf.PdfReader(io.BytesIO(render_pdf(with_fonts(PAGE))))
    first, second, nested = reader.outline
    assert [first.title, second.title] == ["Deep one", "Two"]
    assert [item.title for item in nested] == ["Below"]
    assert reader.metadata is not None
    assert reader.metadata["/CreationDate"] == "D:20260203040506+01'30'"
    root = reader.trailer["/Root"]
    assert root["/Lang"] == "en"
    assert root["/ViewerPreferences"]["/DisplayDocTitle"].value is True


def test_a_page_without_metadata_gets_none_invented() -> None:

    bare = pypdf.PdfWriter()
    bare.add_blank_page(100, 100)
    stream = io.BytesIO()
    bare.write(stream)
    reader = pypdf.PdfReader(io.BytesIO(add_outline(stream.getvalue(), "<p>Bare</p>")))
    assert list(reader.outline) == []
    assert reader.metadata is not None
    assert "/CreationDate" not in reader.metadata
    assert "/Lang" not in reader.trailer["/Root"]
