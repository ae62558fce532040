"""How many poses met with which verdict, as one bar."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from designer.report.figures import canvas, palette
from designer.workspace.result import Census

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_HELD_BELOW = "#6BAED6"


@dataclass(frozen=True, slots=True)
class Part:
    """One part of the bar: its label, how many poses, its colours and hatch."""

    label: str
    count: int
    colour: str
    ink: str = palette.INK
    hatch: str = ""


def parts(census: Census) -> tuple[Part, ...]:
    """Return the parts of the bar that are not empty; together they hold every sample."""
    status = census.statuses
    leaves_out = census.excluded > 0
    finite = status["no_finite_cable"]
    everything = (
        Part("held", status["solved"] - census.hangs_below, palette.SAG, "white"),
        Part(
            "left out: a cable hangs below" if leaves_out else "held, a cable hangs below",
            census.hangs_below + (finite if leaves_out else 0),
            palette.LEFT_OUT if leaves_out else _HELD_BELOW,
        ),
        Part(
            "no finite cable", 0 if leaves_out else finite, palette.WARNING_PALE,
            palette.WARNING, "//////",
        ),
        Part("no positive tensions", status["outside_hull"], palette.WARNING, "white"),
        Part("not converged", status["not_converged"], palette.INK, "white"),
    )
    return tuple(part for part in everything if part.count > 0)


def verdict_chart(census: Census) -> str:
    """Return all samples by their verdict as one stacked bar with labels, as SVG."""
    with canvas.drawing():
        figure = canvas.sheet(24.0)
        axes = figure.subplots()
        axes.set(xlim=(0.0, 1.0), ylim=(-1.75, 0.45))
        axes.set_axis_off()
        start = 0.0
        free_from = 0.0
        for part in parts(census):
            share = part.count / census.samples
            _bar(axes, part, start, share)
            free_from = _label(axes, part, start, share, free_from)
            start += share
        return canvas.svg(figure, "verdicts", "Poses of the workspace by verdict")


def _bar(axes: Axes, part: Part, start: float, share: float) -> None:
    axes.barh(
        0.0, share, left=start, height=0.8, color=part.colour, hatch=part.hatch,
        edgecolor=part.ink if part.hatch else "white", linewidth=0.6,
    )


def _label(axes: Axes, part: Part, start: float, share: float, free_from: float) -> float:
    """Write below the bar, to the right of the label before; return where this one ends."""
    text = f"{part.label}\\n{percent(share)}  ({part.count:,})".replace(",", "\\N{NARROW NO-BREAK SPACE}")
    return free_from
