"""The comparison of two results as a document."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from datetime import datetime
from pathlib import Path
from typing import Any

from designer.analysis.comparison import Comparison, ComparisonLine
from designer.report import format as fmt
from designer.report.blocks import (
    MOST_ROWS,
    Block,
    Column,
    Picture,
    Report,
    Row,
    Section,
    Statement,
    Table,
    plain_report,
)
from designer.report.figures import canvas, palette
from designer.report.render import write_pages

_MOST_PRODUCTS, _MOST_OTHERS = 5 * MOST_ROWS, 60
_SHOWN: tuple[tuple[str, Callable[[Any], str]], ...] = (
    ("utilisation", lambda x: fmt.utilisation(float(x))),
    ("ratio", lambda x: fmt.percent(float(x))),
    ("drum_diameter_m", lambda x: fmt.metres(float(x))),
    ("diameter_m", lambda x: f"{fmt.number(1e3 * x, 5)} mm"),
    ("distance_m", lambda x: f"{fmt.number(1e3 * x, 5)} mm"),
    ("m_per_N", lambda x: f"{fmt.number(1e6 * x)} mm/kN"),
    ("kg_per_m", lambda x: fmt.kilograms_per_metre(float(x))),
    ("_kg", lambda x: fmt.kilograms(float(x))),
    ("_N", lambda x: fmt.newtons(float(x))),
)
"""How values are shown, by the end of their path."""


def comparison_report(found: Comparison, names: tuple[str, str], created: datetime) -> Report[None]:
    """Return the document; ``names`` are those of the two files."""
    sections = (
        Section.of("differences", "What differs", *_answers(found, names)),
        Section.of("inputs", "What was asked", *_inputs(found, names)),
        _products(found, names),
        _others(found, names),
        _origin(found, names),
    )
    titles = dict.fromkeys(str(one.get("name", "")) for one in (found.a, found.b))
    title = " and ".join(titles)
    return plain_report("comparison", title, "Comparison of two designs", created, sections)


def write_comparison(
    found: Comparison, names: tuple[str, str], folder: Path, templates: Path | None = None
) -> None:
    """Write ``comparison.html`` and ``comparison.pdf`` into an existing folder."""
    write_pages(comparison_report(found, names, datetime.now().astimezone()), folder, templates)


def shown(path: str, value: Any) -> str:
    """Return a value of ``result.json`` as a reader wants it."""
    if value is None:
        return fmt.MISSING
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, list):
        return f"({', '.join(shown(path, one) for one in value)})"
    if isinstance(value, str):
        return value
    texts = (text for end, text in _SHOWN if path.endswith(end))
    return next(texts, lambda x: fmt.trimmed(float(x), 6))(value)


def change(line: ComparisonLine) -> str:
    """Return the relative change of a number; empty where there is none."""
    return fmt.signed_percent(line.relative) if line.differs and line.relative is not None else ""


def _table(
    caption: str, lines: tuple[ComparisonLine, ...], names: tuple[str, str], first: str
) -> Table:
    a, b = names
    rows = (
        Row(
            (
                fmt.capital(line.label) or line.path,
                shown(line.path, line.a),
                shown(line.path, line.b),
                change(line),
            ),
            "" if line.differs else "muted",
        )
        for line in lines
    )
    heads = (first, f"A: {a}", f"B: {b}", Column("Change"))
    return Table.of(caption, heads, *rows, kind="long")


def _answers(found: Comparison, names: tuple[str, str]) -> tuple[Block | None, ...]:
    if found.is_same:
        text = "Every input and every result is the same to nine digits."
        return (Statement("Nothing differs", text, "good"),)
    changed = [line for line in found.answers if line.differs]
    text = f"{fmt.plural(len(changed), 'answer')} of {len(found.answers)} changed"
    if found.has_inputs:
        text += f", after {fmt.plural(len(found.inputs), 'field')} of the study did"
    caption = "The answers. What is the same in both is grey."
    table = _table(caption, found.answers, names, "Answer")
    unmet = None
    if found.unmet:
        caption = "What one of the two does not meet, of all that its study asks for."
        unmet = _table(caption, found.unmet, names, "Requirement")
    return (Statement("The two differ", f"{text}."), table, unmet, _chart(found))


def _chart(found: Comparison) -> Picture | None:
    """Return the relative changes as bars; None where no number has changed."""
    lines = [(line, line.relative) for line in found.answers if line.differs]
    bars = [(fmt.capital(line.label), 100.0 * x) for line, x in lines if x and math.isfinite(x)]
    if not bars:
        return None
    with canvas.drawing():
        figure = canvas.sheet(14.0 + 6.0 * len(bars))
        axes = figure.subplots()
        labels, values = zip(*reversed(bars), strict=True)
        bars_drawn = axes.barh(labels, values, color=palette.SAG, height=0.6)
        axes.axvline(0.0, color=palette.INK, linewidth=0.6)
        axes.bar_label(bars_drawn, fmt=lambda x: fmt.signed_percent(x / 100.0), padding=3)
        axes.margins(x=0.18)
        axes.set_xlabel("change from A to B [%]")
        canvas.grid_lines(axes, "x")
        svg = canvas.svg(figure, "change", "Relative change of each answer from A to B")
    return Picture("Relative change of each answer that is a number, from A to B.", "", svg=svg)


def _inputs(found: Comparison, names: tuple[str, str]) -> tuple[Block, ...]:
    if not found.has_inputs:
        return ("One of the results is of a version that did not write down its inputs.",)
    if not found.inputs:
        return ("Both studies ask for the same.",)
    caption = "Fields of the studies that differ, in SI units."
    return (_table(caption, found.inputs, names, "Field"),)


def _products(found: Comparison, names: tuple[str, str]) -> Section | None:
    if not found.products:
        return None
    caption = "Sizes that hold in one of the two only, or were tried in one only."
    shown = _first(caption, found.products, _MOST_PRODUCTS, names, "Size")
    return Section.of("products", "Which ropes hold", *shown)


def _others(found: Comparison, names: tuple[str, str]) -> Section | None:
    if not found.remaining:
        return None
    caption = "Other values of result.json that differ, by their path."
    shown = _first(caption, found.remaining, _MOST_OTHERS, names, "Value")
    return Section.of("others", "All else that differs", *shown)


def _first(
    caption: str, lines: tuple[ComparisonLine, ...], most: int, names: tuple[str, str], title: str
) -> Iterator[Block]:
    """Yield the table of the first lines, and where the rest is."""
    yield _table(caption, lines[:most], names, title)
    if len(lines) > most:
        yield f"{fmt.plural(len(lines) - most, f'more {title.lower()}')} in comparison.json."


def _origin(found: Comparison, names: tuple[str, str]) -> Section:
    keys = {"version": "Program", "config_sha256": "SHA-256 of the configuration"}
    keys |= {"created": "Computed", "system": "On"}
    origins = [one["provenance"] for one in (found.a, found.b)]
    rows = ((title, *(str(o.get(key, "")) for o in origins)) for key, title in keys.items())
    return Section.of(
        "provenance",
        "Provenance",
        Table.of("Where the two come from.", ("", f"A: {names[0]}", f"B: {names[1]}"), *rows),
    )
