"""How much of the workspace each size of one grade serves."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from designer.report.figures import canvas, palette
from designer.selection.result import Candidate
from designer.selection.usable import Usable

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_APART = 0.03
_LOW = 75.0  # where all serve more, the axis begins here


def usable_chart(usable: Usable, chosen: Candidate | None) -> str:
    """Return the share of the workspace over the diameter of the sizes, as SVG.

    Parameters
    ----------
    usable : Usable
        What each size serves.
    chosen : Candidate or None
        The size to mark.
    """
    with canvas.drawing():
        figure = canvas.sheet(62.0)
        axes = figure.subplots()
        diameters = [1e3 * one.size.diameter_m for one in usable.sizes]
        shares = [100.0 * one.fraction for one in usable.sizes]
        low = _LOW if min(shares) > _LOW else 0.0
        axes.set(
            ylim=(low - 0.02 * (100.0 - low), 100.0 + 0.16 * (100.0 - low)),
            xlim=_range(usable),
        )
        axes.plot(diameters, shares, color=palette.SAG, linewidth=1.0, alpha=0.6)
        axes.plot(
            diameters, shares, linestyle="none", marker="o", markersize=4.2, color=palette.SAG
        )
        _names(axes, usable)
        if chosen is not None:
            _mark(axes, usable, chosen)
        canvas.grid_lines(axes)
        axes.set_yticks(np.linspace(low, 100.0, 6))
        axes.set_title("share of the workspace that the size serves [%]", loc="left")
        axes.set_xlabel(f"nominal diameter of the sizes of {usable.grade.id} [mm]")
        return canvas.svg(figure, "usable", "Share of the workspace that each size serves")


def _range(usable: Usable) -> tuple[float, float]:
    """From the last size before any serves to a few above the one from which on all serve all."""
    diameters = [1e3 * one.size.diameter_m for one in usable.sizes]
    serving = [k for k, one in enumerate(usable.sizes) if one.fraction > 0.0]
    low = diameters[max(serving[0] - 1, 0)] if serving else diameters[0]
    whole = usable.first_for_good
    high = diameters[-1] if whole is None else min(1.5 * diameters[whole], diameters[-1])
    room = max(0.05 * (high - low), 0.02 * high)
    return low - room, high + room


def _names(axes: Axes, usable: Usable) -> None:
    """Name the sizes along the curve, as far as there is room."""
    left, right = axes.get_xlim()
    last = -1.0
    for one in usable.sizes:
        x, y = 1e3 * one.size.diameter_m, 100.0 * one.fraction
        place = (x - left) / (right - left)
        if not 0.0 <= place <= 1.0 or place - last < _APART:
            continue
        last = place
        below = y > 50.0
        label = axes.annotate(
            one.size.id,
            (x, y),
            (3, -4 if below else 4),
            textcoords="offset points",
            rotation=-60 if below else 60,
            ha="left",
            va="top" if below else "bottom",
            rotation_mode="anchor",
            fontsize=palette.FONT_POINTS - 1.0,
        )
        label.set_path_effects(canvas.halo())


def _mark(axes: Axes, usable: Usable, chosen: Candidate) -> None:
    at = next((one for one in usable.sizes if one.size is chosen.size), None)
    if at is None:
        return
    axes.plot(
        1e3 * at.size.diameter_m,
        100.0 * at.fraction,
        marker="o",
        markersize=8.0,
        markerfacecolor="none",
        markeredgecolor=palette.INK,
        markeredgewidth=1.2,
    )
    axes.annotate(
        "chosen",
        (1e3 * at.size.diameter_m, 100.0 * at.fraction),
        (0, 6),
        textcoords="offset points",
        ha="center",
        va="bottom",
        fontweight="bold",
    )
