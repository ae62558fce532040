"""Tension and diameter over the turns of the loop, as in Riehl et al., ICRA 2010, Figs. 6 and 7."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from designer.analysis.pose import PoseAnalysis
from designer.arrays import FloatArray
from designer.report.figures import canvas, palette
from designer.report.figures.canvas import Style
from designer.sizing.loop import Iterate

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def loop_chart(pose: PoseAnalysis) -> str:
    """Return both iterates of the loop side by side, with the optimum as their limit, as SVG.

    Where straight cables cannot hold the pose, the chart says so.
    """
    turns = shown_turns(pose)
    largest_N = float(pose.sizing.statics.largest_tension_N)
    unit, scale = ("N", 1.0) if largest_N < 1e3 else ("kN", 1e-3)
    tension = np.array([turn.max_tension_N for turn in turns]) * scale
    diameter = np.array([turn.diameter_m for turn in turns]) * 1e3
    title = "Largest tension and diameter over the turns of the loop"
    with canvas.drawing():
        figure = canvas.sheet(50.0 if turns else 14.0)
        warning: Style = {"color": palette.WARNING}
        if turns:
            left, right = figure.subplots(1, 2)
            left.set_title(f"largest tension [{unit}]", loc="left")
            right.set_title("diameter [mm]", loc="left")
            _panel(left, tension, scale * largest_N, unit)
            _panel(right, diameter, float(pose.sizing.diameter_m) * 1e3, "mm")
            if not pose.loop.has_converged:
                place = {"transform": left.transAxes, "va": "top"}
                left.text(0.04, 0.94, pose.loop.outcome, **place, **warning)
        else:
            text = "Straight cables cannot hold this pose, so the loop has no start."
            figure.text(0.01, 0.5, text, va="center", **warning)
        return canvas.svg(figure, "loop", title)


def shown_turns(pose: PoseAnalysis) -> tuple[Iterate, ...]:
    """All turns, or those before a loop without an optimum runs away, the first few in any case."""
    turns = pose.loop.iterates
    if bool(pose.sizing.statics.is_solved):
        return turns
    most_N = max((10.0 * t.max_tension_N for t in turns[:1]), default=0.0)
    return tuple(t for k, t in enumerate(turns) if k < 3 or t.max_tension_N < most_N)


def _panel(axes: Axes, values: FloatArray, limit: float, unit: str) -> None:
    """One iterate, its massless start, and the optimum where there is one."""
    from matplotlib.ticker import MaxNLocator

    if np.isfinite(limit):
        axes.axhline(limit, color=palette.SAG, linewidth=0.9, linestyle=canvas.DASHES)
        text, frame = f"optimum {canvas.significant(limit)} {unit}", ("axes fraction", "data")
        style = {"ha": "right", "va": "bottom", "color": palette.SAG}
        canvas.note(axes, text, (1.0, limit), (0, 4), xycoords=frame, **style)
    marker = "o" if len(values) <= 40 else ""  # more would run together
    axes.plot(values, color=palette.SAG, marker=marker, markersize=3.2)
    rim = {"markeredgecolor": palette.MASSLESS, "markeredgewidth": 1.3}
    axes.plot(0, values[0], **(canvas.RING | rim), markersize=5.5)
    text = f"massless {canvas.significant(values[0])} {unit}"
    canvas.note(axes, text, (0, values[0]), (9, -3), va="top", color=palette.MASSLESS)
    low, high = np.nanmin([*values, limit]), np.nanmax([*values, limit])
    room = max(0.16 * (high - low), 0.05 * high)  # does not magnify a sag that hardly matters
    axes.set_ylim(low - room, high + room)
    axes.xaxis.set_major_locator(MaxNLocator("auto", integer=True))
    axes.set_xlabel("turn")
    canvas.grid_lines(axes)
