"""How many poses met with which verdict, as one bar."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from designer.report.figures import canvas, palette
from designer.workspace.result import Census

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_HELD_BELOW = "#8CC1E0"
_CHARACTER = 0.0098  # width of a character over the width of the figure


@dataclass(frozen=True, slots=True)
class Part:
    """One part of the bar: its label, how many poses, its colour and hatch."""

    label: str
    count: int
    colour: str
    hatch: str = ""


def parts(census: Census) -> tuple[Part, ...]:
    """Return the parts of the bar that are not empty; together they hold every sample."""
    status = census.statuses
    leaves_out = census.excluded > 0
    finite = status["no_finite_cable"]
    everything = (
        Part("held", status["solved"] - census.hangs_below, palette.SAG),
        Part(
            "left out: a cable hangs below" if leaves_out else "held, a cable hangs below",
            census.hangs_below + (finite if leaves_out else 0),
            palette.LEFT_OUT if leaves_out else _HELD_BELOW,
        ),
        Part("no finite cable", 0 if leaves_out else finite, palette.WARNING_PALE, "//////"),
        Part("no cables hold it", status["outside_hull"], palette.WARNING),
        Part("none found", status["not_found"], palette.WARNING_PALE, "......"),
        Part("rank deficient", status.get("rank_deficient", 0), palette.LEFT_OUT),
        Part("not converged", status["not_converged"], palette.INK),
    )
    return tuple(part for part in everything if part.count > 0)


def verdict_chart(census: Census) -> str:
    """Return all samples by their verdict as one stacked bar with labels, as SVG."""
    found = parts(census)
    shares = [part.count / census.samples for part in found]
    texts = [_text(part, share) for part, share in zip(found, shares, strict=True)]
    starts = [sum(shares[:index]) for index in range(len(shares))]
    with canvas.drawing():
        figure = canvas.sheet(19.0)
        axes = figure.subplots()
        axes.set(xlim=(0.0, 1.0), ylim=(-1.9, 0.5))
        axes.set_axis_off()
        for part, start, share in zip(found, starts, shares, strict=True):
            _bar(axes, part, start, share, 0.0, 0.9)
        for part, at, text in zip(found, spread(starts, texts), texts, strict=True):
            _bar(axes, part, at, 0.012, -0.98, 0.42)
            axes.text(at + 0.018, -0.78, text, va="top")
        return canvas.svg(figure, "verdicts", "Poses of the workspace by verdict")


def spread(starts: Sequence[float], texts: Sequence[str]) -> list[float]:
    """Return where to begin each text so that none overlaps, near its start, within 0 to 1."""
    widths = [0.03 + _CHARACTER * max(len(line) for line in text.split("\n")) for text in texts]
    places: list[float] = []
    for start in starts:
        before = places[-1] + widths[len(places) - 1] if places else 0.0
        places.append(max(start, before))
    limit = 1.0
    for index in reversed(range(len(places))):
        places[index] = max(min(places[index], limit - widths[index]), 0.0)
        limit = places[index]
    return places


def _text(part: Part, share: float) -> str:
    count = f"{part.count:,}".replace(",", "\N{NARROW NO-BREAK SPACE}")
    percent = 100.0 * share
    figures = "< 0.1" if percent < 0.1 else f"{percent:.1f}"
    return f"{part.label}\n{figures} %, {count}"


def _bar(axes: Axes, part: Part, start: float, width: float, middle: float, height: float) -> None:
    axes.barh(
        middle,
        width,
        left=start,
        height=height,
        color=part.colour,
        hatch=part.hatch,
        edgecolor=palette.WARNING if part.hatch else "white",
        linewidth=0.6,
    )
