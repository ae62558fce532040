"""A sheet to draw a chart on, and how it becomes SVG text.

Matplotlib is used through figure objects only, so that nothing is left behind in its global
state; glyphs are drawn as outlines, so that a chart looks the same where a font is missing.
"""

from __future__ import annotations

import io
import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING
from xml.sax.saxutils import escape, quoteattr

from designer.report.figures import palette

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_STYLE = {
    "font.family": "DejaVu Sans",
    "font.size": palette.FONT_POINTS,
    "axes.titlesize": palette.FONT_POINTS,
    "axes.labelsize": palette.FONT_POINTS,
    "xtick.labelsize": palette.FONT_POINTS - 0.5,
    "ytick.labelsize": palette.FONT_POINTS - 0.5,
    "legend.fontsize": palette.FONT_POINTS - 0.5,
    "axes.edgecolor": palette.INK,
    "axes.labelcolor": palette.INK,
    "text.color": palette.INK,
    "xtick.color": palette.INK,
    "ytick.color": palette.INK,
    "axes.linewidth": 0.6,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.major.size": 2.5,
    "ytick.major.size": 2.5,
    "lines.linewidth": 1.3,
    "hatch.linewidth": 0.5,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "svg.fonttype": "path",
    "svg.hashsalt": "cdpr-designer",
    "path.simplify": True,
}


@contextmanager
def drawing() -> Iterator[None]:
    """Open the style that every figure is made and saved in."""
    import matplotlib

    with matplotlib.rc_context(_STYLE):
        yield


def sheet(height_mm: float, width_mm: float = palette.PAPER_WIDTH_MM) -> Figure:
    """Return an empty figure of this size on paper."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width_mm / 25.4, height_mm / 25.4), layout="constrained")


def grid_lines(axes: Axes, axis: str = "y") -> None:
    """Draw faint lines at the ticks of one axis, behind the data."""
    axes.grid(axis=axis, color=palette.FAINT, linewidth=0.4, alpha=0.6)
    axes.set_axisbelow(True)


def svg(figure: Figure, key: str, title: str) -> str:
    """Return the figure as an ``<svg>`` element that scales with its surroundings.

    Parameters
    ----------
    figure : Figure
        What to save, inside `drawing`.
    key : str
        Put before every id, so that several charts can stand in one page.
    title : str
        What the chart shows, for those who cannot see it.
    """
    stream = io.StringIO()
    nothing = dict.fromkeys(("Creator", "Date", "Format", "Type"))
    figure.savefig(stream, format="svg", transparent=True, metadata=nothing)
    text = stream.getvalue()
    return _standalone(text[text.index("<svg") :].strip(), key, title)


def _standalone(text: str, key: str, title: str) -> str:
    text = re.sub(r'\bid="', f'id="{key}-', text)
    text = re.sub(r'(xlink:href="#|url\(#)', rf"\g<1>{key}-", text)
    text = re.sub(r' d="[^"]+"', lambda match: _rounded(match.group()), text)
    head, body = text.split(">", 1)
    head = re.sub(r' (?:width|height)="[^"]*"', "", head)
    return f"{head} role=\"img\" aria-label={quoteattr(title)}>\n <title>{escape(title)}</title>{body}"


def _rounded(path: str) -> str:
    """Cut coordinates to a hundredth of a point, which halves the size of a contour plot."""
    return re.sub(r"(\.\d\d)\d+", r"\1", path).replace(" \n", "\n")
