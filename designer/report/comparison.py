"""The comparison of two results as a document."""

from __future__ import annotations

import math
from datetime import datetime
from pathlib import Path

from designer.analysis.comparison import Comparison
from designer.report import format as fmt
from designer.report.document import Drawing, Report, Section, vector
from designer.report.figures import canvas, palette
from designer.report.render import write_pages


def comparison_report(comparison: Comparison, names: tuple[str, str], created: datetime) -> Report:
    """Return the document; ``names`` are those of the two files."""
    sections = {
        "differences": True,
        "inputs": True,
        "products": comparison.products,
        "others": comparison.remaining,
        "provenance": True,
    }
    context = {"comparison": comparison, "names": names, "changes": _changes(comparison)}
    titles = dict.fromkeys(str(result.get("name", "")) for result in (comparison.a, comparison.b))
    return Report.of(
        "comparison",
        " and ".join(titles),
        "Comparison of two designs",
        created,
        (Section(name, context=context) for name, has_content in sections.items() if has_content),
    )


def write_comparison(
    comparison: Comparison, names: tuple[str, str], folder: Path, templates: Path | None = None
) -> None:
    """Write ``comparison.html`` and ``comparison.pdf`` into an existing folder."""
    write_pages(
        comparison_report(comparison, names, datetime.now().astimezone()), folder, templates
    )


def _changes(comparison: Comparison) -> Drawing | None:
    """Return the relative changes as bars; None where no number has changed."""
    lines = [(line, line.relative) for line in comparison.answers if line.differs]
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
        return vector(canvas.svg(figure, "change", "Relative change of each answer from A to B"))
