"""Section through the workspace, as in Riehl et al., ICRA 2010, Fig. 9."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from designer.report.figures import canvas, palette
from designer.report.figures.colours import Steps, steps_for
from designer.report.figures.maps import WorkspaceMaps
from designer.report.figures.plan_map import draw_plan, height_over_width, keys
from designer.report.figures.quantity import DIAMETER, RATIO, TENSION, Quantity

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_WIDE_MM, _BESIDE_MM, _TALL_MM = 120.0, 150.0, 70.0
"""Width of one map alone, of several together, and the largest height of a map."""


def slice_chart(maps: WorkspaceMaps, quantity: Quantity = DIAMETER) -> str:
    """Return a large map of the section of a workspace at its greatest height, as SVG.

    Parameters
    ----------
    maps : WorkspaceMaps
        What to draw; a list of points is drawn as points, seen from above.
    quantity : Quantity
        What the colours mean.
    """
    with canvas.drawing():
        height_mm = 24.0 + _legend_mm(maps) + min(_WIDE_MM * _proportions(maps), _TALL_MM)
        figure = canvas.sheet(height_mm, keeps_aspect=True)
        axes = figure.subplots()
        _panel(figure, axes, maps, quantity, "right", 0.045)
        _legend(figure, maps)
        return canvas.svg(figure, f"slice-{quantity.key}", f"{_place(maps)}: {quantity.title}")


def slice_panels(maps: WorkspaceMaps, quantities: Sequence[Quantity] = (TENSION, RATIO)) -> str:
    """Return small maps of the same section side by side, one for each quantity, as SVG."""
    with canvas.drawing():
        panel_mm = _BESIDE_MM / len(quantities)
        height_mm = 38.0 + _legend_mm(maps) + min(panel_mm * _proportions(maps), _TALL_MM)
        figure = canvas.sheet(height_mm, keeps_aspect=True)
        row = figure.subplots(1, len(quantities), squeeze=False)[0]
        for axes, quantity in zip(row, quantities, strict=True):
            _panel(figure, axes, maps, quantity, "bottom", 0.09)
        for axes in row[1:]:
            axes.set_ylabel("")
            axes.tick_params(labelleft=False)
        _legend(figure, maps)
        titles = ", ".join(quantity.title for quantity in quantities)
        return canvas.svg(figure, "slice-panels", f"{_place(maps)}: {titles}")


def _proportions(maps: WorkspaceMaps) -> float:
    corners = maps.flat_m(maps.study.robot.exit_points_m)
    return height_over_width(maps.flat_m(maps.section.position_m), corners)


def _panel(
    figure: Figure, axes: Axes, maps: WorkspaceMaps, quantity: Quantity, bar: str, room: float
) -> None:
    steps = steps_for(quantity.of(maps.section))
    draw_plan(axes, maps, quantity, steps, room)
    axes.set_title(_place(maps), loc="left", color=palette.INK)
    if steps is None:
        why = "all left out" if maps.section.is_left_out.all() else "no pose can be held"
        axes.set_title(f"{_place(maps)}; {why}", loc="left")
        return
    _colour_bar(figure, axes, steps, quantity, bar)


def _colour_bar(figure: Figure, axes: Axes, steps: Steps, quantity: Quantity, place: str) -> None:
    shape: dict[str, dict[str, Any]] = {
        "right": {"shrink": 0.9, "aspect": 26},
        "bottom": {"shrink": 0.92, "aspect": 30},
    }
    crowded = place == "bottom" and canvas.decimals(steps.ticks) > 2
    bar = figure.colorbar(
        steps.mappable,
        ax=axes,
        location=place,
        ticks=steps.ticks[:: 2 if crowded else 1],
        extendfrac=0.04,
        label=quantity.label,
        **shape[place],
    )
    bar.outline.set_linewidth(0.4)
    bar.ax.tick_params(length=2)


def _legend(figure: Figure, maps: WorkspaceMaps) -> None:
    entries = keys(maps.section)
    if entries:
        figure.legend(handles=entries, loc="outside lower center", ncols=3, frameon=False)


def _legend_mm(maps: WorkspaceMaps) -> float:
    """Height that the legend takes."""
    return 6.0 if keys(maps.section) else 0.0


def _place(maps: WorkspaceMaps) -> str:
    if maps.is_upright:
        return "the region" if maps.has_area else "all poses"
    if maps.has_area:
        return f"top of the region, z = {canvas.number(maps.section.position_m[0, 0, 2])} m"
    return "all poses, seen from above"
