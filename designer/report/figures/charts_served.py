"""What share of the workspace a cable of a given diameter serves."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from designer.arrays import FloatArray
from designer.report.figures import canvas, palette
from designer.report.figures.maps import Served

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_TITLE = "Share of the workspace that a cable serves, over its diameter"


def served_chart(served: Served) -> str:
    """Return the cumulative share of the workspace over the diameter, as SVG."""
    with canvas.drawing():
        figure = canvas.sheet(64.0)
        axes = figure.subplots()
        axes.set(ylim=(0.0, 104.0), xlim=_range(served))
        _curve(axes, served.massless_diameter_m, served.massless_share, palette.MASSLESS)
        _curve(axes, served.diameter_m, served.share, palette.SAG)
        _label_curves(axes, served)
        _needed(axes, served)
        _unserved(axes, served)
        canvas.grid_lines(axes)
        axes.set_yticks(range(0, 101, 20))
        axes.set_title("share of the poses that the cable serves [%]", loc="left")
        axes.set_xlabel("diameter of the cable [mm]")
        return canvas.svg(figure, "served", _TITLE)


def _range(served: Served) -> tuple[float, float]:
    """Horizontal limits [mm]; the last few poses near the boundary may need any diameter."""
    both = np.concatenate([served.diameter_m, served.massless_diameter_m])
    if len(both) == 0:
        return 0.0, 1.0
    most = [served.needed_m, served.massless_needed_m]
    if not np.isfinite(served.needed_m) and len(served.diameter_m) > 0:
        at = np.searchsorted(served.share, 0.97 * served.share[-1])
        most.append(1.4 * float(served.diameter_m[at]))
    low, high = 1e3 * float(both.min()), 1e3 * float(np.nanmax(most))
    room = max(0.06 * (high - low), 0.01 * high)
    return max(low - room, 0.0), high + room


def _curve(axes: Axes, diameter_m: FloatArray, share: FloatArray, colour: str) -> None:
    """A staircase, since each pose is served by its diameter and by all above."""
    if len(diameter_m) == 0:
        return
    right = axes.get_xlim()[1]
    x = np.concatenate([[0.0], 1e3 * diameter_m, [max(right, 1e3 * diameter_m[-1])]])
    y = 100.0 * np.concatenate([[0.0], share, share[-1:]])
    axes.step(x, y, where="post", color=colour)


def _label_curves(axes: Axes, served: Served) -> None:
    for diameter_m, share, label, colour, aligned in (
        (served.massless_diameter_m, served.massless_share, "massless", palette.MASSLESS, "right"),
        (served.diameter_m, served.share, "with sag", palette.SAG, "left"),
    ):
        if len(diameter_m) > 0:
            at = int(np.searchsorted(share, 0.45 * share[-1]))
            axes.annotate(
                label,
                (1e3 * diameter_m[at], 45.0 * share[-1]),
                (6 if aligned == "left" else -6, -4 if aligned == "left" else 4),
                textcoords="offset points",
                ha=aligned,
                va="top" if aligned == "left" else "bottom",
                color=colour,
            )


def _needed(axes: Axes, served: Served) -> None:
    for needed_m, what, colour, side in (
        (served.massless_needed_m, "massless", palette.MASSLESS, "right"),
        (served.needed_m, "serves all", palette.SAG, "left"),
    ):
        if not np.isfinite(needed_m):
            continue
        value = 1e3 * needed_m
        axes.axvline(value, color=colour, linewidth=0.9, linestyle=(0, (5, 2)))
        axes.annotate(
            f"{what}: {canvas.significant(value, 3)} mm",
            (value, 3.0),
            (-3 if side == "right" else 3, 0),
            rotation=90,
            textcoords="offset points",
            ha=side,
            va="bottom",
            color=colour,
        )


def _unserved(axes: Axes, served: Served) -> None:
    if served.samples == 0:
        axes.text(0.5, 50.0, "every pose is left out", ha="center", va="center")
    if served.unserved == 0.0:
        return
    low = 100.0 * (1.0 - served.unserved)
    axes.axhspan(
        low,
        100.0,
        facecolor=palette.WARNING_PALE,
        edgecolor=palette.WARNING,
        hatch="//////",
        linewidth=0,
    )
    text = axes.annotate(
        f"no cable serves {canvas.significant(100.0 * served.unserved, 2)} %",
        (0.0, max(low, 20.0)),
        (6, -3),
        xycoords=("axes fraction", "data"),
        textcoords="offset points",
        va="top",
        color=palette.WARNING,
    )
    text.set_bbox({"facecolor": "white", "edgecolor": "none", "pad": 0.8, "alpha": 0.85})
