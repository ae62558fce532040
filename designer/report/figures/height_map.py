"""Any value over a horizontal section of a region, seen from above."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from designer.arrays import BoolArray, FloatArray
from designer.report.figures import canvas, palette
from designer.report.figures.colours import Steps, steps_over_decades
from designer.report.figures.plan_map import height_over_width, mark_exit_points, set_limits

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_WIDE_MM, _TALL_MM = 120.0, 64.0


@dataclass(frozen=True, slots=True, eq=False)
class HeightMap:
    """What to draw.

    Parameters
    ----------
    position_m : array (rings, spokes, 3)
        Rings about the centre of the region, see `designer.report.figures.grids.disc_m` [m].
    values : array (rings, spokes)
        NaN where there is none.
    is_bad : array (rings, spokes) of bool
        Where it is hatched.
    why_bad : str
        What the hatching means.
    exit_points_m : array (n_cables, 3)
        Shown in plan [m].
    label : str
        Of the colour bar, with the unit.
    limit : float or None
        A value whose contour is drawn boldly.
    limit_label : str
        What that contour is.
    """

    position_m: FloatArray
    values: FloatArray
    is_bad: BoolArray
    why_bad: str
    exit_points_m: FloatArray
    label: str
    limit: float | None = None
    limit_label: str = ""


def height_map(shown: HeightMap, key: str) -> str:
    """Return the map as SVG.

    Parameters
    ----------
    shown : HeightMap
        What to draw.
    key : str
        Short name, put before every id of the drawing.
    """
    steps = steps_over_decades(shown.values)
    place = f"z = {canvas.number(shown.position_m[0, 0, 2])} m"
    with canvas.drawing():
        corners = shown.exit_points_m[:, :2]
        proportions = height_over_width(shown.position_m[..., :2], corners)
        figure = canvas.sheet(20.0 + min(_WIDE_MM * proportions, _TALL_MM), keeps_aspect=True)
        axes = figure.subplots()
        _fill(axes, shown, steps)
        if set_limits(axes, shown.position_m[..., :2], corners):
            mark_exit_points(axes, corners)
        axes.set_xlabel("x [m]")
        axes.set_ylabel("y [m]")
        axes.set_title(f"section at {place}", loc="left", color=palette.INK)
        if steps is not None:
            bar = figure.colorbar(
                steps.mappable,
                ax=axes,
                ticks=steps.ticks,
                format=lambda value, _: canvas.number(float(value)),
                extendfrac=0.04,
                label=shown.label,
                shrink=0.9,
                aspect=26,
            )
            bar.outline.set_linewidth(0.4)
            bar.ax.tick_params(length=2)
        entries = _keys(shown)
        if entries:
            figure.legend(handles=entries, loc="outside lower center", ncols=3, frameon=False)
        return canvas.svg(figure, key, f"{shown.label}, {place}")


def _fill(axes: Axes, shown: HeightMap, steps: Steps | None) -> None:
    x, y = shown.position_m[..., 0], shown.position_m[..., 1]
    axes.fill(x[-1], y[-1], facecolor=palette.LEFT_OUT, edgecolor="none")
    if shown.is_bad.any():
        bad, levels = shown.is_bad.astype(np.float64), [0.5, 1.5]
        axes.contourf(x, y, bad, levels=levels, colors=[palette.WARNING_PALE])
        hatched = axes.contourf(x, y, bad, levels=levels, colors="none", hatches=["//////"])
        hatched.set_edgecolor(palette.WARNING)
        hatched.set_linewidth(0.0)
    values = np.ma.masked_invalid(shown.values)
    if steps is not None:
        steps.fill(axes, x, y, values)
        axes.contour(x, y, values, levels=steps.ticks, colors="white", linewidths=0.5)
    if _crosses_limit(shown):
        limits = [shown.limit]
        axes.contour(x, y, values, levels=limits, colors=palette.WARNING, linewidths=1.6)
    axes.plot(x[-1], y[-1], color=palette.INK, linewidth=0.8)


def _keys(shown: HeightMap) -> list[Any]:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    entries: list[Any] = []
    if _crosses_limit(shown):
        style: dict[str, Any] = {"color": palette.WARNING, "linewidth": 1.6}
        entries.append(Line2D([], [], label=shown.limit_label, **style))
    if shown.is_bad.any():
        entries.append(
            Patch(
                facecolor=palette.WARNING_PALE,
                edgecolor=palette.WARNING,
                hatch="//////",
                linewidth=0.5,
                label=shown.why_bad,
            )
        )
    if (np.isnan(shown.values) & ~shown.is_bad).any():
        entries.append(Patch(facecolor=palette.LEFT_OUT, label="left out"))
    return entries


def _crosses_limit(shown: HeightMap) -> bool:
    finite = shown.values[np.isfinite(shown.values)]
    if shown.limit is None or len(finite) == 0:
        return False
    return bool(finite.min() < shown.limit < finite.max())
