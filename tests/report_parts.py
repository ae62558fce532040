"""Find things in a report, as its pages show them."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from html.parser import HTMLParser
from itertools import zip_longest
from types import SimpleNamespace
from typing import Any

from markupsafe import Markup

from designer.analysis.provenance import Provenance
from designer.diagnosis.report import diagnosis_report
from designer.diagnosis.result import Diagnosis
from designer.report.design.drawings import Drawings
from designer.report.design.report import section
from designer.report.document import Report, Section
from designer.report.render import rendered
from designer.report.templates import environment

_VOID = ("img", "meta", "link", "br", "hr", "input", "path", "use", "rect", "circle", "line")


@dataclass
class Node:
    """An element: its tag, attributes, children (elements and texts), and its source."""

    tag: str
    attributes: dict[str, str]
    children: list[Node | str] = field(default_factory=list)
    inner: str = ""
    start: int = 0

    @property
    def classes(self) -> list[str]:
        return self.attributes.get("class", "").split()

    def all(self, tag: str, kind: str = "") -> Iterator[Node]:
        """Every element of a tag within, of a class where one is named."""
        for child in self.children:
            if isinstance(child, Node):
                if child.tag == tag and (not kind or kind in child.classes):
                    yield child
                yield from child.all(tag, kind)

    def text(self, *, without: tuple[str, ...] = ()) -> str:
        """All text within, with single plain spaces between words; no-break spaces stay."""
        return re.sub(r"[ \n\t]+", " ", "".join(self._texts(without))).strip(" ")

    def _texts(self, without: tuple[str, ...]) -> Iterator[str]:
        for child in self.children:
            if isinstance(child, str):
                yield child
            elif child.tag not in (*without, "svg"):
                inline = child.tag in ("strong", "small", "a", "span", "i", "sub", "sup", "cite")
                yield "" if inline else " "
                yield from child._texts(without)


class _Tree(HTMLParser):
    def __init__(self, html: str) -> None:
        super().__init__()
        self.root = Node("root", {})
        self._open = [self.root]
        self._lines = [0]
        for line in html.splitlines(keepends=True):
            self._lines.append(self._lines[-1] + len(line))
        self._html = html
        self.feed(html)
        self.close()

    def _at(self) -> int:
        line, column = self.getpos()
        return self._lines[line - 1] + column

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        node = Node(tag, {name: value or "" for name, value in attrs})
        self._open[-1].children.append(node)
        if tag not in _VOID:
            node.start = self._at() + len(self.get_starttag_text() or "")
            self._open.append(node)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self._open[-1].children.append(Node(tag, {name: value or "" for name, value in attrs}))

    def handle_endtag(self, tag: str) -> None:
        while len(self._open) > 1 and any(node.tag == tag for node in self._open):
            node = self._open.pop()
            if node.tag == tag:
                node.inner = self._html[node.start : self._at()]
                return

    def handle_data(self, data: str) -> None:
        self._open[-1].children.append(data)


@dataclass(frozen=True)
class Statement:
    title: str
    text: str
    tone: str


@dataclass(frozen=True)
class Fact:
    label: str
    value: str
    note: str
    link: str


@dataclass(frozen=True)
class Head:
    title: str
    unit: str
    is_number: bool


@dataclass(frozen=True)
class Line:
    cells: tuple[str, ...]
    tone: str
    note: str


@dataclass(frozen=True)
class Rows:
    rows: tuple[Line, ...]
    title: str
    remark: str
    tone: str


@dataclass(frozen=True)
class Grid:
    """A table."""

    caption: str
    columns: tuple[Head, ...]
    groups: tuple[Rows, ...]
    kind: str


@dataclass(frozen=True)
class Drawn:
    """A picture."""

    caption: str
    alternative: str
    svg: str
    bitmap: str
    scene: str
    kind: str


def page(part: object, name: str = "report") -> str:
    """The HTML of a section, of all sections of a report, or of what is HTML already.

    ``name`` is the document that a section belongs to.
    """
    if part is None:
        return ""
    if isinstance(part, Section):
        stub: Any = SimpleNamespace(name=name, sections=())
        return part.body or rendered(part, stub).body
    if isinstance(part, Report):
        return "\n".join(rendered(section, part).body for section in part.sections)
    if isinstance(part, tuple | list):
        return "\n".join(page(item, name) for item in part)
    return str(part)


def caption(name: str, *values: object) -> str:
    """A caption of a figure of the workspace, as its macro makes it."""
    template = environment().get_template("report/captions.html.j2")
    return said(Markup(vars(template.module)[name](*values)))


def tree(part: object, name: str = "report") -> Node:
    """The same as elements."""
    return part if isinstance(part, Node) else _tree(page(part, name))


@lru_cache(maxsize=64)
def _tree(html: str) -> Node:
    return _Tree(html).root


def tables(part: object) -> list[Grid]:
    """Every table."""
    return [_grid(node) for node in tree(part).all("figure", "table")]


def table(part: object, start: str) -> Grid:
    """The one table whose caption begins so."""
    (found,) = [grid for grid in tables(part) if grid.caption.startswith(start)]
    return found


def cells(part: object, start: str) -> list[tuple[str, ...]]:
    """The rows of the one table whose caption begins so."""
    return [row.cells for group in table(part, start).groups for row in group.rows]


def _grid(node: Node) -> Grid:
    (caption,) = node.all("figcaption")
    heads = []
    for head in node.all("th"):
        if head.attributes.get("scope") == "col":
            units = " ".join(unit.text() for unit in head.all("span", "unit"))
            title = head.text().removesuffix(units).strip()
            heads.append(Head(title, units, "number" in head.classes))
    groups = []
    for body in node.all("tbody"):
        groups += _groups(body)
    kind = " ".join(node.classes[1:])
    return Grid(caption.text(), tuple(heads), tuple(groups), kind)


def _groups(body: Node) -> list[Rows]:
    groups = [Rows((), "", "", "")]
    for row in body.all("tr"):
        if "group" in row.classes:
            remark = " ".join(span.text() for span in row.all("span", "remark"))
            title = row.text().removesuffix(remark).strip()
            tone = " ".join(name for name in row.classes if name != "group")
            groups.append(Rows((), title, remark, tone))
            continue
        last = groups[-1]
        if "note" in row.classes:
            noted = Line(last.rows[-1].cells, last.rows[-1].tone, row.text())
            rows = (*last.rows[:-1], noted)
        else:
            rows = (*last.rows, Line(tuple(cell.text() for cell in row.all("td")),
                                     " ".join(row.classes), ""))  # fmt: skip
        groups[-1] = Rows(rows, last.title, last.remark, last.tone)
    return [group for group in groups if group.rows or group.title]


def pictures(part: object) -> list[Drawn]:
    """Every picture."""
    found = []
    for node in tree(part).all("figure", "picture"):
        (caption,) = node.all("figcaption")
        (view,) = node.all("div", "view")
        scenes = [frame.attributes["srcdoc"] for frame in node.all("iframe")]
        images = [image.attributes["src"] for image in node.all("img")]
        drawings = [drawing.inner for drawing in node.all("div", "drawing")]
        found.append(
            Drawn(
                caption.text(),
                view.attributes.get("aria-label", ""),
                *("".join(parts) for parts in (drawings, images, scenes)),
                " ".join(node.classes[1:]),
            )
        )
    return found


def statements(part: object) -> dict[str, Statement]:
    """Every statement by its title."""
    nodes = (*tree(part).all("p", "statement"), *tree(part).all("p", "verdict"))
    return {one.title: one for node in nodes for one in _statements(node)}


def _statements(node: Node) -> Iterator[Statement]:
    strong = next(node.all("strong"))
    text = node.text().removeprefix(strong.text()).strip()
    tone = " ".join(name for name in node.classes if name not in ("statement", "verdict"))
    yield Statement(strong.text().removesuffix("."), text, tone)


def facts(part: object) -> dict[str, Fact]:
    """Every fact by its label."""
    found = {}
    for node in tree(part).all("dl", "facts"):
        for entry in node.all("div"):
            (label,), (value,) = entry.all("dt"), entry.all("dd")
            note = " ".join(small.text() for small in value.all("small"))
            link = "".join(anchor.attributes["href"] for anchor in value.all("a"))
            shown = value.text(without=("small",))
            found[label.text()] = Fact(label.text(), shown, note, link)
    return found


def paragraphs(part: object) -> list[str]:
    """Every plain paragraph."""
    return [node.text() for node in tree(part).all("p") if not node.classes]


def said(part: object) -> str:
    """Every text in one, with plain spaces."""
    return tree(part).text().replace("\u00a0", " ")


def texts(part: object) -> Iterator[str]:
    """Every text that a reader sees."""
    yield from (text for text in tree(part)._texts(()) if text.strip())


@dataclass(frozen=True)
class Card:
    """The answer at a glance."""

    heading: str
    size: str
    product: str
    facts: tuple[Fact, ...]


@dataclass(frozen=True)
class DiagnosisPage:
    """The first page of a diagnosis."""

    verdict: Statement
    findings: tuple[Statement, ...]
    errors: Grid
    design: tuple[str, ...]
    sureness: tuple[Statement, ...]


def diagnosis_page(part: Diagnosis | Report) -> DiagnosisPage:
    """The first page, as its template shows it; plain spaces in what it means for the cable."""
    report = part if isinstance(part, Report) else diagnosis_report(part, Provenance.now())
    root = tree(rendered(report.section("answer"), report).body)
    (verdict,) = [one for node in root.all("p", "verdict") for one in _statements(node)]
    panels = {next(panel.all("h3")).text(): panel for panel in root.all("div", "panel")}
    parts = {title: tuple(statements(panel).values()) for title, panel in panels.items()}
    (errors,) = tables(root)
    return DiagnosisPage(
        verdict,
        parts.get("What the model lacked", ()),
        errors,
        tuple(map(said, paragraphs(panels["What it means for the cable"]))),
        parts["How sure this is"],
    )


@dataclass(frozen=True)
class FirstPage:
    """The first page of a design report."""

    verdict: Statement
    card: Card | None
    reasons: tuple[Statement, ...]
    actions: tuple[str, ...]
    groups: Statement | None
    confidence: tuple[Statement, ...]


def first_page(part: Drawings | Report) -> FirstPage:
    """The first page, as its template shows it."""
    root = tree(part.section("answer") if isinstance(part, Report) else section(part, "answer"))
    (verdict,) = [one for node in root.all("p", "verdict") for one in _statements(node)]
    panels = {next(panel.all("h3")).text(): panel for panel in root.all("div", "panel")}
    sure = list(root.all("div", "columns"))
    columns = [[*column.all("p", "statement")] for one in sure for column in one.all("div")]
    cards = [
        Card(*(next(card.all("p", kind)).text() for kind in ("over", "size", "product")),
             tuple(facts(card).values()))
        for card in root.all("div", "card")
    ]  # fmt: skip
    reasons, groups = panels.get("Why, and where"), panels.get("Groups of cables")
    return FirstPage(
        verdict,
        cards[0] if cards else None,
        () if reasons is None else tuple(statements(reasons).values()),
        tuple(
            item.text()
            for name, panel in panels.items()
            if name == "What could be done"
            for item in panel.all("li")
        ),
        None if groups is None else next(iter(statements(groups).values())),
        tuple(
            one
            for pair in zip_longest(*columns)
            for node in pair
            if node is not None
            for one in _statements(node)
        ),
    )
