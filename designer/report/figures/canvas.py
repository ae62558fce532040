"""A sheet to draw a chart on, and how it becomes SVG text.

Matplotlib is used through figure objects only, so that nothing is left behind in its global
state; glyphs are drawn as outlines, so that a chart looks the same where a font is missing.
"""

from __future__ import annotations

import io
import math
import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Literal
from xml.sax.saxutils import escape, quoteattr

import numpy as np
from numpy.typing import ArrayLike

from designer.report.figures import palette

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.patheffects import AbstractPathEffect

_TINY, _TOO_WIDE = 1e-9, 1e12
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
    "text.parse_math": False,  # names from files are shown as they are
}


@contextmanager
def drawing() -> Iterator[None]:
    """Open the style that every figure is made and saved in, whatever the user's own is."""
    import matplotlib

    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(_STYLE)
        yield


def sheet(height_mm: float, *, keeps_aspect: bool = False) -> Figure:
    """Return an empty figure of this height and of the column's width.

    Parameters
    ----------
    height_mm : float
        Height on paper [mm].
    keeps_aspect : bool
        Whether its axes have equal scales, so that they cannot fill the space they get.
    """
    from matplotlib.figure import Figure

    size = (palette.PAPER_WIDTH_MM / 25.4, height_mm / 25.4)
    return Figure(figsize=size, layout="compressed" if keeps_aspect else "constrained")


def number(value: float) -> str:
    """Return a number as short as it can be, with a true minus sign."""
    text = f"{value:,.0f}" if 1e4 <= abs(value) < _TOO_WIDE else f"{value:.6g}"
    return text.replace(",", "\N{NARROW NO-BREAK SPACE}").replace("-", "\N{MINUS SIGN}")


def significant(value: float, digits: int = 4) -> str:
    """Return a number to so many significant digits; only a tiny or huge one has an exponent."""
    if not _TINY <= abs(value) < _TOO_WIDE:
        return f"{value:.{digits}g}"
    places = max(digits - 1 - math.floor(math.log10(abs(value))), 0)
    return f"{value:,.{places}f}".replace(",", "\N{NARROW NO-BREAK SPACE}").replace(
        "-", "\N{MINUS SIGN}"
    )


def decimals(ticks: ArrayLike) -> int:
    """Return how many decimals it takes to write every tick."""
    return max(len(f"{tick:.6f}".rstrip("0").split(".")[1]) for tick in np.asarray(ticks))


def halo() -> list[AbstractPathEffect]:
    """Return a white rim for text and marks that stand on colours."""
    from matplotlib.patheffects import withStroke

    return [withStroke(linewidth=2.2, foreground="white")]


def grid_lines(axes: Axes, axis: Literal["x", "y"] = "y") -> None:
    """Draw faint lines at the ticks of one axis, behind the data."""
    axes.grid(axis=axis, color=palette.FAINT, linewidth=0.4, alpha=0.6)
    axes.set_axisbelow(True)


def svg(figure: Figure, key: str, title: str) -> str:
    """Return the figure as an ``<svg>`` element that scales with its surroundings, and empty it.

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
    words = _words(figure)
    figure.clear()  # it lies in reference cycles, which Python would clear up much later
    return _standalone(text[text.index("<svg") :].strip(), key, title, words)


def _words(figure: Figure) -> str:
    """All that is written on a figure beside bare numbers, for those who cannot see it."""
    from matplotlib.text import Text

    found = [artist for artist in figure.findobj(Text) if artist.get_visible()]
    words = dict.fromkeys(str(artist.get_text()) for artist in found if isinstance(artist, Text))
    return "; ".join(word for word in words if not re.fullmatch(r"[−\d.]*", word))


def _standalone(text: str, key: str, title: str, words: str) -> str:
    text = re.sub(r'\bid="', f'id="{key}-', text)
    text = re.sub(r'(xlink:href="#|url\(#)', rf"\g<1>{key}-", text)
    text = re.sub(r' d="[^"]+"', lambda match: _rounded(match.group()), text)
    head, body = text.split(">", 1)
    head = re.sub(r' (?:width|height)="[^"]*"', "", head)
    # Matplotlib has this as a style sheet, which would act on the whole page around the chart.
    body = re.sub(r"<style.*?</style>", "", body, flags=re.DOTALL)
    head += ' stroke-linejoin="round" stroke-linecap="butt"'
    head += f' role="img" aria-label={quoteattr(title)}>'
    return f"{head}\n <title>{escape(title)}</title>\n <desc>{escape(words)}</desc>{body}"


def _rounded(path: str) -> str:
    """Cut coordinates to a hundredth of a point, which halves the size of a contour plot."""
    return re.sub(r"(\.\d\d)\d+", r"\1", path).replace(" \n", "\n")
