"""What the utilisation answers to, as bars."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from designer.report.figures import canvas, palette

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Bars = Sequence[tuple[str, float]]
"""Names, and by how many percentage points the utilisation changes."""


def carries_chart(shares: Bars, moves: Bars, move: str) -> str:
    """Return bars for 1 % more of each input and for a ``move`` of each point, as SVG."""
    with canvas.drawing():
        figure = canvas.sheet(14.0 + 4.2 * max(len(shares), len(moves)))
        left, right = figure.subplots(1, 2)
        _bars(left, shares, "for 1 % more [points of percent]")
        _bars(right, moves, f"for {move} [points of percent]")
        return canvas.svg(figure, "carries", "Change of the utilisation with each input")


def _bars(axes: Axes, bars: Bars, title: str) -> None:
    values = np.array([value for _, value in bars])
    rows = np.arange(len(bars))
    colours = [palette.WARNING if value > 0.0 else palette.SAG for value in values]
    axes.barh(rows, values, color=colours, height=0.62)
    axes.axvline(0.0, color=palette.INK, linewidth=0.6)
    axes.set_yticks(rows, [name for name, _ in bars])
    axes.invert_yaxis()
    axes.tick_params(axis="y", length=0)
    axes.spines["left"].set_visible(False)
    axes.margins(x=0.12)
    axes.locator_params(axis="x", nbins=5)
    canvas.grid_lines(axes, "x")
    axes.set_title(title, loc="left")
