"""A sheet to draw a chart on, what charts share, and how they become SVG text.

Matplotlib is used through figure objects only, so that nothing is left behind in its global
state; glyphs are drawn as outlines, so that a chart looks the same where a font is missing.
"""

from __future__ import annotations

import io
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache, partial
from typing import TYPE_CHECKING, Any, Literal
from xml.sax.saxutils import escape, quoteattr

import numpy as np
from numpy.typing import ArrayLike

from designer.arrays import FloatArray
from designer.model.region import Region
from designer.report import format as fmt
from designer.report.figures import palette

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.backends.backend_svg import RendererSVG
    from matplotlib.figure import Figure
    from matplotlib.patheffects import AbstractPathEffect
    from matplotlib.text import Annotation

Style = dict[str, Any]
"""How Matplotlib shall draw something."""
_STYLE = {
    "font.family": "DejaVu Sans",
    **dict.fromkeys(("font.size", "axes.titlesize", "axes.labelsize"), palette.FONT_POINTS),
    **dict.fromkeys(("xtick.labelsize", "ytick.labelsize"), palette.FONT_POINTS - 0.5),
    "legend.fontsize": palette.FONT_POINTS - 0.5,
    "legend.frameon": False,
    **dict.fromkeys(("axes.edgecolor", "axes.labelcolor", "text.color"), palette.INK),
    **dict.fromkeys(("xtick.color", "ytick.color"), palette.INK),
    **dict.fromkeys(("axes.linewidth", "xtick.major.width", "ytick.major.width"), 0.6),
    **dict.fromkeys(("xtick.major.size", "ytick.major.size"), 2.5),
    "lines.linewidth": 1.3,
    "hatch.linewidth": 0.5,
    **dict.fromkeys(("axes.spines.top", "axes.spines.right"), False),
    "axes.titley": 1.0,  # nothing is above axes that a title would have to be lifted over
    **dict.fromkeys(("figure.facecolor", "axes.facecolor"), "none"),
    "svg.fonttype": "path",
    "svg.hashsalt": "cdpr-designer",
    "text.parse_math": False,  # names from files are shown as they are
}
DASHES = (0, (5, 2))
DOTS: Style = {"linestyle": "none", "marker": "o"}
RING: Style = {
    "marker": "o",
    "color": "white",
    "markeredgecolor": palette.INK,
    "markeredgewidth": 1.1,
}
HATCHED: Style = {
    "facecolor": palette.WARNING_PALE,
    "edgecolor": palette.WARNING,
    "hatch": "//////",
}
"""Where no cable holds the platform."""
REGION: Style = {"facecolor": "#EEF1F4", "edgecolor": palette.FAINT}
"""Where the platform goes, in a plan."""


@contextmanager
def drawing() -> Iterator[None]:
    """Open the style that every figure is made and saved in, whatever the user's own is."""
    import matplotlib

    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(_STYLE)
        yield


def sheet(height_mm: float, *, width_mm: float = palette.PAPER_WIDTH_MM) -> Figure:
    """Return an empty figure of this height on paper and, unless told, of the column's width [mm].

    For axes in one grid; what stands beside that, such as a legend, is given to `beside`.
    """
    from matplotlib.backends.backend_svg import FigureCanvasSVG
    from matplotlib.figure import Figure
    from matplotlib.gridspec import SubplotParams

    from designer.report.figures.layout import GridLayout

    # Axes begin nearly where they end, so that their texts are measured only once.
    begin = {"left": 0.1, "right": 0.98, "bottom": 0.15, "top": 0.92, "wspace": 0.1, "hspace": 0.2}
    size = (width_mm / 25.4, height_mm / 25.4)
    figure = Figure(figsize=size, layout=GridLayout(), subplotpars=SubplotParams(**begin))
    FigureCanvasSVG(figure).get_renderer = partial(_ruler, figure)
    return figure


def _ruler(figure: Figure) -> RendererSVG:
    """Return what measures the texts of a figure, as large as they are printed."""
    figure.dpi = 72
    return _one_ruler()


@cache
def _one_ruler() -> RendererSVG:
    """One for all figures: Matplotlib makes one anew at each question, which then knows no text."""
    from matplotlib.backends.backend_svg import RendererSVG

    return RendererSVG(1.0, 1.0, io.StringIO())


def decimals(ticks: ArrayLike) -> int:
    """Return how many decimals it takes to write every tick."""
    return max(len(f"{tick:.6f}".rstrip("0").split(".")[1]) for tick in np.asarray(ticks))


def significant(value: float, digits: int = 4) -> str:
    """Return a number to so many significant digits, but none before the point is rounded off."""
    return fmt.number(value, max(digits, len(f"{abs(value):.0f}")))


def halo() -> list[AbstractPathEffect]:
    """Return a white rim for text and marks that stand on colours."""
    from matplotlib.patheffects import withStroke

    return [withStroke(linewidth=2.2, foreground="white")]


def paper(pad: float, alpha: float) -> dict[str, Any]:
    """Return a white ground for text."""
    return {"facecolor": "white", "edgecolor": "none", "pad": pad, "alpha": alpha}


def note(
    axes: Axes, text: str, at: tuple[float, float], offset: tuple[float, float], **style: Any
) -> Annotation:
    """Write a text beside a point, ``offset`` in points."""
    return axes.annotate(text, at, offset, textcoords="offset points", **style)


def grid_lines(axes: Axes, axis: Literal["x", "y", "both"] = "y") -> None:
    """Draw faint lines at the ticks, behind the data."""
    axes.grid(axis=axis, color=palette.FAINT, linewidth=0.4, alpha=0.6)
    axes.set_axisbelow(True)


def beside(figure: Figure, artist: Artist, side: str) -> None:
    """Have the axes of a sheet leave room for what stands at its side: ``left``, ``lower``, …."""
    layout: Any = figure.get_layout_engine()
    if layout is not None:  # a picture in space has none
        layout.beside.append((artist, side))


def legend(figure: Figure, looks: Sequence[tuple[str, Style]], loc: str, **layout: Any) -> None:
    """Say what each look means, an area where it has a ``facecolor``, else a line or a mark."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    entries = [
        Patch(label=label, **look) if "facecolor" in look else Line2D([], [], label=label, **look)
        for label, look in looks
    ]
    if entries:
        beside(figure, figure.legend(handles=entries, loc=loc, **layout), loc.split()[1])


def region(axes: Axes, shape: Region, plane: list[int], label: str = "") -> None:
    """Draw where the platform goes, seen along the axis that is not in the plane (2,)."""
    if shape.is_discrete:
        points = np.concatenate([*shape.samples_m(1, "grid", 0)])[:, plane]
        axes.plot(*points.T, ".", color=palette.FAINT, markersize=2.5, label=label)
    else:
        axes.fill(*shape.outline_m(plane).T, **REGION, label=label)


def names_of(points_m: FloatArray, apart_m: float) -> list[tuple[str, FloatArray]]:
    """Return a name and a place for each exit point (n_cables, 2 or 3) [m].

    Those closer together than ``apart_m``, whose names would overlap, have one name [m].
    """
    groups: dict[int, list[int]] = {}
    for index, point in enumerate(points_m):
        groups_near = (
            first for first in groups if np.linalg.norm(points_m[first] - point) < apart_m
        )
        groups.setdefault(next(groups_near, index), []).append(index)
    return [
        (", ".join(f"A{index + 1}" for index in group), points_m[group].mean(axis=0))
        for group in groups.values()
    ]


_figures: ContextVar[list[Figure] | None] = ContextVar("figures", default=None)


@contextmanager
def kept_figures() -> Iterator[list[Figure]]:
    """Have figures kept as they are in the block, instead of written as SVG."""
    figures: list[Figure] = []
    token = _figures.set(figures)
    try:
        yield figures
    finally:
        _figures.reset(token)


def svg(figure: Figure, key: str, title: str) -> str:
    """Return the figure as an ``<svg>`` element that scales with its surroundings.

    Inside `drawing`. ``key`` is put before every id, so that several charts can stand in one page;
    the title tells what the chart shows to those who cannot see it.
    """
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    figures = _figures.get()
    if figures is not None:
        figures.append(figure)
        return "<svg></svg>"
    stream = io.StringIO()
    no_metadata = dict.fromkeys(("Creator", "Date", "Format", "Type"))
    sheet = figure.canvas
    assert isinstance(sheet, FigureCanvasSVG)
    sheet.print_svg(stream, metadata=no_metadata)  # `savefig` would draw everything twice
    text = stream.getvalue()
    return _standalone(text[text.index("<svg") :].strip(), key, title, _words(figure))


def _words(figure: Figure) -> str:
    """All that is written on a figure beside bare numbers, for those who cannot see it."""
    from matplotlib.text import Text

    texts = [artist for artist in figure.findobj(Text) if artist.get_visible()]
    words = dict.fromkeys(str(artist.get_text()) for artist in texts if isinstance(artist, Text))
    return "; ".join(word for word in words if not re.fullmatch(r"[−\d.]*", word))


def _standalone(text: str, key: str, title: str, words: str) -> str:
    for reference in (' id="', 'xlink:href="#', "url(#"):
        text = text.replace(reference, f"{reference}{key}-")
    # A hundredth of a point is enough, and halves the size of a contour plot.
    further = re.compile(r"(?<=\.\d\d)\d+")
    text = re.sub(
        r' d="[^"]+"', lambda path: further.sub("", path.group()).replace(" \n", "\n"), text
    )
    head, body = text.split(">", 1)
    head = re.sub(r' (?:width|height)="[^"]*"', "", head)
    # Matplotlib has this as a style sheet, which would act on the whole page around the chart.
    body = re.sub(r"<style.*?</style>", "", body, flags=re.DOTALL)
    head += ' stroke-linejoin="round" stroke-linecap="butt"'
    head += f' role="img" aria-label={quoteattr(title)}>'
    return f"{head}\n <title>{escape(title)}</title>\n <desc>{escape(words)}</desc>{body}"
