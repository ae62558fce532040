"""Tension and diameter over the turns of the loop, as in Riehl et al., ICRA 2010, Figs. 6 and 7."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from designer.analysis.analyse import PoseAnalysis
from designer.arrays import FloatArray
from designer.report.figures import canvas, palette
from designer.sizing.loop import Iterate

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_MOST_MARKERS = 40
_DIVERGES = 10.0
_FEWEST = 3
_KILONEWTON = 1e3


def loop_chart(pose: PoseAnalysis) -> str:
    """Return both iterates of the loop side by side, with the optimum as their limit, as SVG.

    Parameters
    ----------
    pose : PoseAnalysis
        Solved or not; where straight cables cannot hold the pose, the chart says so.
    """
    turns = pose.loop.iterates
    shown = _shown(pose)
    largest_N = float(pose.sizing.statics.largest_tension_N)
    unit, scale = ("N", 1.0) if largest_N < _KILONEWTON else ("kN", 1e-3)
    tension = np.array([turn.max_tension_N for turn in shown]) * scale
    diameter = np.array([turn.diameter_m for turn in shown]) * 1e3
    title = "Largest tension and diameter over the turns of the loop"
    with canvas.drawing():
        figure = canvas.sheet(62.0 if turns else 14.0)
        if turns:
            left, right = figure.subplots(1, 2)
            left.set_title(f"largest tension [{unit}]", loc="left")
            right.set_title("diameter [mm]", loc="left")
            _panel(left, tension, scale * largest_N, unit)
            _panel(right, diameter, float(pose.sizing.diameter_m) * 1e3, "mm")
            if not pose.loop.has_converged:
                _say_unsettled(left, pose.loop.outcome)
        else:
            text = "Straight cables cannot hold this pose, so the loop has no start."
            figure.text(0.01, 0.5, text, va="center", color=palette.WARNING)
        return canvas.svg(figure, "loop", title)


def _shown(pose: PoseAnalysis) -> tuple[Iterate, ...]:
    """All turns, or those before a loop without an optimum runs away, the first few in any case."""
    turns = pose.loop.iterates
    if bool(pose.sizing.statics.is_solved):
        return turns
    most_N = max((_DIVERGES * t.max_tension_N for t in turns[:1]), default=0.0)
    return tuple(t for k, t in enumerate(turns) if k < _FEWEST or t.max_tension_N < most_N)


def _panel(axes: Axes, values: FloatArray, limit: float, unit: str) -> None:
    """One iterate, and the optimum where there is one."""
    from matplotlib.ticker import MaxNLocator

    if np.isfinite(limit):
        axes.axhline(limit, color=palette.SAG, linewidth=0.9, linestyle=(0, (5, 2)))
        text = f"optimum {canvas.significant(limit)} {unit}"
        axes.annotate(
            text,
            (1.0, limit),
            (0, 4),
            xycoords=("axes fraction", "data"),
            textcoords="offset points",
            ha="right",
            va="bottom",
            color=palette.SAG,
        )
    marker = "o" if len(values) <= _MOST_MARKERS else ""
    axes.plot(values, color=palette.SAG, marker=marker, markersize=3.2)
    _mark_start(axes, values[0], unit)
    low, high = np.nanmin([*values, limit]), np.nanmax([*values, limit])
    room = max(0.16 * (high - low), 0.05 * high)  # does not magnify a sag that hardly matters
    axes.set_ylim(low - room, high + room)
    axes.xaxis.set_major_locator(MaxNLocator("auto", integer=True))
    axes.set_xlabel("turn")
    canvas.grid_lines(axes)


def _mark_start(axes: Axes, value: float, unit: str) -> None:
    axes.plot(
        0,
        value,
        marker="o",
        markersize=5.5,
        color="white",
        markeredgecolor=palette.MASSLESS,
        markeredgewidth=1.3,
    )
    axes.annotate(
        f"massless {canvas.significant(value)} {unit}",
        (0, value),
        (9, -3),
        textcoords="offset points",
        va="top",
        color=palette.MASSLESS,
    )


def _say_unsettled(axes: Axes, outcome: str) -> None:
    axes.text(
        0.04,
        0.94,
        outcome,
        transform=axes.transAxes,
        va="top",
        color=palette.WARNING,
    )
