"""What the utilisation of a rope answers to, and how it spreads where inputs are not certain."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from designer.analysis.uncertainty import Share
from designer.arrays import FloatArray
from designer.report.figures import canvas, palette
from designer.report.figures.canvas import Style

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_BARS = 40
_TAIL = 99.9
"""Percentile up to which the axis reaches at least."""
Size = tuple[str, FloatArray, bool]
"""Name of a size, its utilisation in each draw, and whether it is the chosen one."""


def odds_chart(sizes: Sequence[Size]) -> str:
    """Return how often each size is used how much, one above the other, as SVG."""
    with canvas.drawing():
        figure = canvas.sheet(14.0 + 17.0 * len(sizes))
        rows = figure.subplots(len(sizes), 1, sharex=True, squeeze=False)[:, 0]
        finite = [100.0 * used[np.isfinite(used)] for _, used, _ in sizes]
        ends = np.concatenate(
            [*(np.percentile(values, [0.1, _TAIL]) for values in finite if len(values)), [100.0]]
        )
        room = 0.04 * max(float(np.ptp(ends)), 1.0)
        edges = np.linspace(ends.min() - room, ends.max() + room, _BARS * len(sizes) + 1)
        for axes, (name, _, is_chosen), used in zip(rows, sizes, finite, strict=True):
            _histogram(axes, name, used, edges, is_chosen)
        rows[0].set_title("how often the size is used so much", loc="left")
        rows[-1].set_xlabel("used of what the safety factor allows [%]")
        return canvas.svg(figure, "odds", "Distribution of the utilisation of each size")


def _histogram(axes: Axes, name: str, used: FloatArray, edges: FloatArray, is_chosen: bool) -> None:
    count, _ = np.histogram(np.clip(used, edges[0], edges[-1]), edges)
    middle, width = 0.5 * (edges[1:] + edges[:-1]), edges[1] - edges[0]
    colours = np.where(middle > 100.0, palette.WARNING, palette.SAG)
    axes.bar(middle, count, width, color=colours, alpha=1.0 if is_chosen else 0.55)
    axes.axvline(100.0, color=palette.INK, linewidth=0.9, linestyle=canvas.DASHES)
    axes.set(yticks=[], xlim=(edges[0], edges[-1]))
    axes.spines["left"].set_visible(False)
    style: Style = {"ha": "left", "va": "top", "fontweight": "bold" if is_chosen else "normal"}
    text = f"{name}, chosen" if is_chosen else name
    is_left = count[: len(count) // 2].sum() > 0.5 * count.sum()
    side = 0.99 if is_left else 0.01
    style["ha"] = "right" if is_left else "left"
    axes.text(side, 0.95, text, transform=axes.transAxes, bbox=canvas.paper(0.8, 0.85), **style)


def shares_chart(shares: Sequence[tuple[str, Share]]) -> str:
    """Return the share of each input in the spread, with its 95 % confidence, as SVG."""
    with canvas.drawing():
        figure = canvas.sheet(16.0 + 8.0 * len(shares))
        axes = figure.subplots()
        rows = np.arange(len(shares))
        looks = (
            (-0.19, palette.SAG, "alone (first order)"),
            (0.19, palette.SAG_PALE, "with all that it does together with others (total order)"),
        )
        for k, (off, colour, _) in enumerate(looks):
            kinds = ("first_order", "total_order")[k]
            value = 100.0 * np.array([getattr(share, kinds) for _, share in shares])
            ends = 100.0 * np.array([getattr(share, f"{kinds}_95") for _, share in shares]).T
            error = np.maximum([value - ends[0], ends[1] - value], 0.0)
            bars: Style = {"color": colour, "height": 0.36, "capsize": 2.0}
            line: Style = {"ecolor": palette.INK, "elinewidth": 0.8}
            axes.barh(rows + off, np.maximum(value, 0.0), xerr=error, error_kw=line, **bars)
        axes.set_yticks(rows, [name for name, _ in shares])
        axes.invert_yaxis()
        axes.tick_params(axis="y", length=0)
        axes.spines["left"].set_visible(False)
        axes.set_xlim(0.0, 105.0)
        canvas.grid_lines(axes, "x")
        axes.set_xlabel("share of the variance of the utilisation [%]")
        canvas.legend(
            figure, [(words, {"facecolor": colour}) for _, colour, words in looks],
            "outside upper left", ncols=2,
        )  # fmt: skip
        return canvas.svg(figure, "shares", "Share of each input in the spread of the utilisation")


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
    axes.set_title(title, loc="right")  # over the names as well, for which there is room
