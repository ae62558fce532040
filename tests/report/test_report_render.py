"""HTML and PDF as files: self-contained, escaped, paged, with an outline."""

from __future__ import annotations

import dataclasses
import io
import json
import re
import shutil
import subprocess
from html import unescape
from html.parser import HTMLParser
from pathlib import Path

import pypdf
import pytest
from altered import altered
from jinja2 import UndefinedError
from report_parts import table

from designer.analysis.analyse import Analysis
from designer.report.design.report import design_report
from designer.report.document import Report
from designer.report.figures import palette
from designer.report.render import REPORT_FILES, render_html, render_pdf, rendered, write_report

pytestmark = pytest.mark.slow

A4_POINTS = (595.3, 841.9)


class Loads(HTMLParser):
    """Collects whatever a browser would fetch for a page, and its scripts."""

    def __init__(self) -> None:
        super().__init__()
        self.addresses: list[str] = []
        self.tags: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        for name, value in attrs:
            is_load = name in ("src", "srcset", "data", "poster") or (tag, name) == ("link", "href")
            if is_load and value:
                self.addresses.append(value)


def loads(html: str) -> Loads:
    parser = Loads()
    parser.feed(html)
    return parser


@pytest.fixture(scope="module")
def report(analyses: dict[str, Analysis]) -> Report:
    return design_report(analyses["positive"], draws=False)


@pytest.fixture(scope="module")
def drawn(analyses: dict[str, Analysis]) -> Report:
    """The same report with its pictures."""
    return design_report(analyses["positive"])


@pytest.fixture(scope="module")
def pdf(report: Report) -> pypdf.PdfReader:
    return pypdf.PdfReader(io.BytesIO(render_pdf(render_html(report, paged=True))))


def outline_titles(items: list[object]) -> list[object]:
    """Titles of the outline, one list for each level."""
    return [
        outline_titles(item) if isinstance(item, list) else str(getattr(item, "title", ""))
        for item in items
    ]


def test_nothing_is_loaded_from_outside(drawn: Report) -> None:
    html = render_html(drawn)
    addresses = loads(html).addresses
    assert addresses
    assert all(address.startswith("data:") for address in addresses)
    assert re.findall(r"url\(\s*['\"]?(?!#|data:)", html) == []
    assert "@import" not in html


def test_page_has_no_script_of_its_own(report: Report) -> None:
    assert "script" not in loads(render_html(report)).tags


def test_sentences_are_apart(analyses: dict[str, Analysis], kept: Analysis) -> None:
    for analysis in (*analyses.values(), kept):
        page = render_html(design_report(analysis, draws=False))
        for paragraph in re.findall(r"<(p|td|li|figcaption)\b[^>]*>(.*?)</\1>", page, re.DOTALL):
            assert not re.search(r"[a-z)%]\.[A-Z][a-z]", re.sub(r"<[^>]+>", "", paragraph[1]))


def test_wide_tables_and_pictures_are_scrolled_by_keys(drawn: Report) -> None:
    html = render_html(drawn)
    assert html.count('<div class="scroll" tabindex="0" role="region" aria-label="') >= 5
    views = re.findall(r'<div class="view"([^>]*)>', html)
    assert len(views) >= 2
    assert all('tabindex="0" role="group" aria-label="' in view for view in views)
    assert "tabindex" not in "".join(
        re.findall(r'<div class="view"[^>]*>', render_html(drawn, paged=True))
    )


def test_dark_page_names_every_colour_again(report: Report) -> None:
    """Each colour of the page, and of charts their ink, guides, paper and the blue of curves."""
    style = render_html(report)
    light = set(re.findall(r"(--[a-z-]+): ", style[style.index(":root {") :].split("}")[0]))
    dark = style[style.index("@media screen and (prefers-color-scheme: dark)") :]
    assert set(re.findall(r"(--[a-z-]+): ", dark.split("}")[0])) == light
    for colour in (palette.INK, palette.FAINT, palette.SAG, "#ffffff"):
        assert f"stroke: {colour.lower()}" in dark


def test_scenes_are_in_the_html_only(drawn: Report) -> None:
    assert "iframe" in loads(render_html(drawn)).tags
    assert "iframe" not in loads(render_html(drawn, paged=True)).tags


def test_markup_in_names_stays_text(analyses: dict[str, Analysis]) -> None:
    analysis = analyses["markup"]
    assert analysis.selection is not None
    chosen = analysis.selection.chosen
    assert chosen is not None
    evil = dataclasses.replace(chosen.grade, product="<img src=x onerror=alert(2)>")
    swapped = dataclasses.replace(chosen, grade=evil)
    outcomes = tuple(
        dataclasses.replace(
            o,
            candidates=tuple(swapped if c is chosen else c for c in o.candidates),
            best=swapped if o.best is chosen else o.best,
        )
        for o in analysis.selection.outcomes
    )
    selection = dataclasses.replace(analysis.selection, chosen=swapped, outcomes=outcomes)
    changed = altered(analysis, selection=selection)
    html = render_html(design_report(changed, draws=False))
    assert "<script" not in html
    assert "onerror=alert(2)>" not in html
    assert "&lt;script&gt;alert(1)&lt;/script&gt;" in html
    assert "&lt;img src=x onerror=alert(2)&gt;" in html


def test_rendering_again_gives_the_same(report: Report) -> None:
    html = render_html(report, paged=True)
    assert html == render_html(report, paged=True)
    assert render_pdf(html) == render_pdf(html)


def test_progress_advances_with_each_section(report: Report) -> None:
    steps: list[int] = []
    render_html(report, advance=steps.append)
    assert steps == [1] * len(report.sections)


def test_pdf_is_on_a4_with_numbered_pages(pdf: pypdf.PdfReader) -> None:
    total = len(pdf.pages)
    assert 6 <= total <= 12
    for number, page in enumerate(pdf.pages, start=1):
        assert (page.mediabox.width, page.mediabox.height) == pytest.approx(A4_POINTS, abs=0.5)
        text = page.extract_text()
        assert f"page {number} of {total}" in text
        assert "Crane" in text


def test_first_page_has_the_answer_and_inputs_begin_on_the_second(pdf: pypdf.PdfReader) -> None:
    first, second = (" ".join(pdf.pages[k].extract_text().split()) for k in (0, 1))
    assert "holds every pose of the workspace" in first
    assert "How sure this is" in first
    assert "robot.anchors" not in first
    assert "robot.anchors" in second


def test_pdf_outline_is_that_of_the_headings(pdf: pypdf.PdfReader, report: Report) -> None:
    titles = outline_titles(list(pdf.outline))
    top = [title for title in titles if isinstance(title, str)]
    assert top == [
        f"{k} {rendered(section, report).title}"
        for k, section in enumerate(report.sections, start=1)
    ]
    nested = [entry for entry in titles if isinstance(entry, list)]
    assert ["Equations"] in nested


def test_outline_leads_to_the_right_page(pdf: pypdf.PdfReader) -> None:
    for item in pdf.outline:
        if not isinstance(item, list):
            page = pdf.pages[pdf.get_destination_page_number(item) or 0]
            assert str(item.title).split(maxsplit=1)[1] in page.extract_text()


def test_pdf_metadata(pdf: pypdf.PdfReader, analyses: dict[str, Analysis]) -> None:
    data = pdf.metadata
    assert data is not None
    assert data.title == "Crane"
    assert data.author == f"cdpr-designer {analyses['positive'].provenance.version}"
    created = analyses["positive"].provenance.created.replace(microsecond=0)
    assert data.creation_date == created


def test_pdf_refuses_what_lies_outside(tmp_path: Path) -> None:
    picture = tmp_path / "picture.png"
    with pytest.raises(ValueError, match=r"picture\.png"):
        render_pdf(f'<title>x</title><img src="{picture.as_uri()}">')


def test_a_template_can_extend_ours(report: Report, tmp_path: Path) -> None:
    (tmp_path / "page.html.j2").write_text(
        '{% extends "default/page.html.j2" %}{% block footer %}Our own footer.{% endblock %}',
        encoding="utf-8",
    )
    own = tmp_path / "report" / "nomenclature.html.j2"
    own.parent.mkdir()
    own.write_text("<p>Our own words for {{ report.title }}.</p>", encoding="utf-8")
    html = render_html(report, user_folder=tmp_path)
    assert "Our own words for Crane." in html
    assert "Our own footer." in html
    assert "length of cable paid out" not in html
    assert "How sure this is" in html


def test_a_misspelt_name_in_a_template_is_an_error(report: Report, tmp_path: Path) -> None:
    (tmp_path / "page.html.j2").write_text("{{ report.titel }}", encoding="utf-8")
    with pytest.raises(UndefinedError, match="titel"):
        render_html(report, user_folder=tmp_path)


def test_report_files_are_written_whole(analyses: dict[str, Analysis], tmp_path: Path) -> None:
    write_report(analyses["too_thin"], tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {*REPORT_FILES} - {"path.csv"}
    assert (tmp_path / "report.html").read_text(encoding="utf-8").endswith("</html>")
    assert (tmp_path / "report.pdf").stat().st_size < 8e6


def test_a_failed_report_leaves_nothing(
    analyses: dict[str, Analysis], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(html: str) -> bytes:
        raise OSError("disk full")

    monkeypatch.setattr("designer.report.render.render_pdf", fail)
    with pytest.raises(OSError, match="disk full"):
        write_report(analyses["too_thin"], tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_a_browser_is_told_to_load_nothing(report: Report) -> None:
    html = render_html(report)
    policy = re.search(r'http-equiv="Content-Security-Policy" content="([^"]*)"', html)
    assert policy is not None
    assert policy.group(1).startswith("default-src 'none'")
    assert "http" not in policy.group(1)


def test_on_paper_a_group_heading_stays_with_its_first_row(report: Report) -> None:
    title = table(report.section("selection"), "Sizes that hold everywhere").groups[0].title
    lifted = rf'<td><span class="lifted \w*">{re.escape(title)} '
    assert re.search(lifted, render_html(report, paged=True))
    assert not re.search(lifted, render_html(report))
    assert re.search(rf'<th scope="rowgroup"[^>]*>{re.escape(title)} ', render_html(report))


def test_scene_is_linked_from_page_1(drawn: Report) -> None:
    if drawn.missing:
        pytest.skip(drawn.missing)
    page, paged = render_html(drawn), render_html(drawn, paged=True)
    summary = page.index('<section class="first-page')
    assert summary < page.index('href="#scene"') < page.index("</section>", summary)
    assert re.search(r'<details class="scene" id="scene" open>', page)
    assert "scene" not in set(re.findall(r'(?:href|id)="#?([^"]*)"', paged))


BROKEN = """<script>addEventListener("load", () => {
const broken = [], walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
for (let node; (node = walker.nextNode()); ) {
  if (node.parentElement.closest("script,style,svg,iframe")) continue;
  for (const word of node.data.matchAll(/[^\\s\\-–\\/]{2,40}/g)) {
    const range = document.createRange();
    range.setStart(node, word.index);
    range.setEnd(node, word.index + word[0].length);
    const lines = [...range.getClientRects()].filter((box) => box.width > 0);
    if (new Set(lines.map((box) => Math.round(box.top))).size > 1) broken.push(word[0]);
  }
}
document.title = "broken: " + JSON.stringify([document.documentElement.scrollWidth, ...broken]);
});</script>"""


@pytest.mark.skipif(shutil.which("chromium") is None, reason="needs Chromium")
def test_no_word_is_broken_at_500_px(report: Report, tmp_path: Path) -> None:
    page = tmp_path / "page.html"
    page.write_text(render_html(report).replace("</body>", f"{BROKEN}</body>"), encoding="utf-8")
    done = subprocess.run(
        ["chromium", "--headless=new", "--no-sandbox", "--disable-gpu", "--window-size=500,2000",
         "--virtual-time-budget=3000", "--dump-dom", page.as_uri()],
        capture_output=True, text=True, timeout=300, check=True,
    )  # fmt: skip
    title = re.search(r"<title>broken: (.*?)</title>", done.stdout)
    assert title is not None
    width, *words = json.loads(unescape(title[1]))
    assert width <= 500
    assert [word for word in words if not re.fullmatch(r"[0-9a-f]{16,40}", word)] == []
