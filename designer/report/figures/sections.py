"""Sections of the workspace, coloured by a value, as in Riehl et al., ICRA 2010, Fig. 9."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from designer.analysis.analyse import Analysis
from designer.analysis.maps import (
    RegionField,
    SectionMap,
    WorkspaceMaps,
    clearance_section,
    displacement_section,
    frequency_section,
)
from designer.arrays import BoolArray, FloatArray
from designer.report import format as fmt
from designer.report.figures import canvas, palette
from designer.report.figures.canvas import Style
from designer.report.figures.colours import (
    RATIO,
    TENSION,
    MapQuantity,
    Steps,
    steps_for,
    steps_over_decades,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_NARROW_MM = 112.0
"""Of the sheet of a map that has a list beside it."""
_BAR_MM = 1.9
"""Thickness of a colour bar."""
_ZOOM = 0.6
"""Of the extent with the exit points: a smaller region is shown alone."""
_APART = 0.09
"""Of labels of contour lines, over the size of the region."""
_HATCHED: Style = canvas.HATCHED | {"linewidth": 0.5}
_GREY: Style = {"facecolor": palette.LEFT_OUT}


def slice_panels(maps: WorkspaceMaps, quantities: Sequence[MapQuantity] = (TENSION, RATIO)) -> str:
    """Return maps of the section of a workspace at its greatest height side by side, as SVG.

    One for each quantity. A list of points is drawn as points, seen from above.
    """
    looks, width_mm = _slice_looks(maps.section), 150.0 / len(quantities)
    corners = maps.flat_m(maps.study.robot.exit_points_m)
    flat = maps.flat_m(maps.section.position_m)
    map_mm = min(width_mm * _height_over_width(flat, corners), 56.0)
    with canvas.drawing():
        figure = canvas.sheet(42.0 + (6.0 if looks else 0.0) + map_mm)
        canvas.legend(figure, looks, "outside lower center", ncols=3)
        heights = (map_mm, _BAR_MM)
        row, bars = figure.subplots(2, len(quantities), squeeze=False, height_ratios=heights)
        for axes, bar, quantity in zip(row, bars, quantities, strict=True):
            _slice(axes, bar, maps, quantity)
        for axes in row[1:]:
            axes.set_ylabel("")
            axes.tick_params(labelleft=False)
        titles = ", ".join(quantity.title for quantity in quantities)
        key = "-".join(["slice", *(quantity.key for quantity in quantities)])
        return canvas.svg(figure, key, f"{_place(maps)}: {titles}")


def stiffness_map(analysis: Analysis) -> str | None:
    """Return a map of the largest displacement under a unit force; None without an area."""
    section = displacement_section(analysis)
    if section is None:
        return None
    scaled = replace(section, values=1e6 * section.values)
    label = "largest displacement [mm/kN]"
    return section_map(scaled, "stiffness", label, "not held, or not stably")


def frequency_map(analysis: Analysis) -> str | None:
    """Return a map of the lowest frequency; None without an area or the platform's inertia."""
    section = frequency_section(analysis)
    if section is None:
        return None
    return section_map(section, "frequency", "lowest frequency [Hz]", "not held, or not stably")


def clearance_map(analysis: Analysis) -> str | None:
    """Return a map of the smallest clearance; None without an area or anything to compare."""
    section = clearance_section(analysis)
    if section is None or analysis.qualities is None or analysis.qualities.interference is None:
        return None
    scaled = replace(section, values=1e3 * section.values)
    limit = 1e3 * analysis.qualities.interference.clearance_m
    return section_map(scaled, "clearance", "smallest clearance [mm]", "not held", limit)


def section_map(
    section: SectionMap, key: str, label: str, why_bad: str, limit: float | None = None
) -> str:
    """Return a map of any value over a level section, as SVG.

    Parameters
    ----------
    section : SectionMap
        Values in the unit of the colour bar's label.
    key : str
        Short name, put before every id of the drawing.
    label, why_bad : str
        Of the colour bar, and what the hatching means.
    limit : float or None
        The value that is asked for, whose contour is drawn boldly.
    """
    flat, corners = section.position_m[..., :2], section.exit_points_m[:, :2]
    place = f"z = {fmt.trimmed(section.position_m[0, 0, 2], 6)} m"
    finite = section.values[np.isfinite(section.values)]
    has_limit = limit is not None and len(finite) > 0 and finite.min() < limit < finite.max()
    values, steps = np.ma.masked_invalid(section.values), steps_over_decades(section.values)
    with canvas.drawing():
        height_mm = 20.0 + min(80.0 * _height_over_width(flat, corners), 56.0)
        figure = canvas.sheet(height_mm, width_mm=_NARROW_MM)
        axes, bar = figure.subplots(1, 2, width_ratios=(0.75 * _NARROW_MM, _BAR_MM))
        _paint(axes, flat, values, section.is_bad, steps)
        if has_limit:
            bold: Style = {"colors": palette.WARNING, "linewidths": 1.6}
            axes.contour(*np.moveaxis(flat, -1, 0), values, levels=[limit], **bold)
        _outline(axes, flat)
        set_limits(axes, flat, corners)
        axes.set(xlabel="x [m]", ylabel="y [m]")
        axes.set_title(f"section at {place}", loc="left")
        if steps is None:
            bar.remove()
        else:
            steps.bar(bar, label, format=lambda value, _: fmt.trimmed(float(value), 6))
        looks: list[tuple[str, Style]] = []
        if has_limit:
            look: Style = {"color": palette.WARNING, "linewidth": 1.6}
            looks.append(("the clearance that is asked for", look))
        if section.is_bad.any():
            looks.append((why_bad, _HATCHED))
        if (np.isnan(section.values) & ~section.is_bad).any():
            looks.append(("left out", _GREY))
        canvas.legend(figure, looks, "outside lower center", ncols=3)
        return canvas.svg(figure, key, f"{label}, {place}")


def _slice(axes: Axes, bar: Axes, maps: WorkspaceMaps, quantity: MapQuantity) -> None:
    """One map and its scale."""
    field, flat = maps.section, maps.flat_m(maps.section.position_m)
    steps = steps_for(quantity.of(field))
    if maps.has_area:
        values = np.ma.masked_invalid(quantity.of(field))
        _paint(axes, flat, values, field.is_infeasible, steps, is_labelled=True)
        if _has_border(field):
            border: Style = {"colors": palette.INK, "linewidths": 0.9, "linestyles": "--"}
            uplift = np.ma.masked_invalid(field.uplift)
            axes.contour(*np.moveaxis(flat, -1, 0), uplift, levels=[0.0], **border)
        _outline(axes, flat)
    else:
        _scatter(axes, flat, field, quantity.of(field), steps)
    set_limits(axes, flat, maps.flat_m(maps.study.robot.exit_points_m))
    place = f"{_place(maps)}{{}}{_mark_focus(axes, maps, quantity)}"
    right, up = maps.axis_labels
    axes.set(xlabel=right, ylabel=up)
    if steps is None:
        why = "all left out" if field.is_left_out.all() else "no pose can be held"
        axes.set_title(place.format(f"; {why}"), loc="left")
        bar.remove()
        return
    axes.set_title(place.format(""), loc="left")
    is_crowded = canvas.decimals(steps.ticks) > 2
    ticks = steps.ticks[:: 2 if is_crowded else 1]
    steps.bar(bar, quantity.label, is_level=True, ticks=ticks)


def _place(maps: WorkspaceMaps) -> str:
    if maps.is_upright:
        return "the region" if maps.has_area else "all poses"
    if maps.has_area:
        return f"top of the region, z = {fmt.trimmed(maps.section.position_m[0, 0, 2], 6)} m"
    return "all poses, seen from above"


def _slice_looks(field: RegionField) -> list[tuple[str, Style]]:
    """What a legend explains beside the colours."""
    left_out = bool(field.is_left_out.any())
    border: Style = {"color": palette.INK, "linewidth": 0.9, "linestyle": (0, (4, 2))}
    looks: list[tuple[str, Style]] = []
    if field.position_m.ndim == 3 and _has_border(field) and not left_out:
        looks.append(("beyond: a cable hangs below the platform", border))
    if field.is_infeasible.any():
        looks.append((field.why_infeasible, _HATCHED))
    if left_out:
        looks.append(("left out: a cable hangs below the platform", _GREY))
    return looks


def _has_border(field: RegionField) -> bool:
    """Whether cables begin to hang below the platform somewhere within the section."""
    finite = field.uplift[np.isfinite(field.uplift)]
    return bool(len(finite) > 0 and finite.min() < 0.0 < finite.max())


def _paint(
    axes: Axes,
    flat: FloatArray,
    values: FloatArray,
    is_bad: BoolArray,
    steps: Steps | None,
    *,
    is_labelled: bool = False,
) -> None:
    """Colour rings (rings, spokes, 2): grey, hatched where bad, in steps where there are values."""
    x, y = np.moveaxis(flat, -1, 0)
    if np.ma.getmaskarray(values).any():
        axes.fill(x[-1], y[-1], facecolor=palette.LEFT_OUT, edgecolor="none")
    if is_bad.any():
        look: Style = {"colors": [palette.WARNING_PALE], "hatches": ["//////"]}
        bad = axes.contourf(x, y, is_bad.astype(np.float64), levels=[0.5, 1.5], **look)
        bad.set(edgecolor=palette.WARNING, linewidth=0.0)
    if steps is None:
        return
    steps.fill(axes, x, y, values)
    lines = axes.contour(x, y, values, levels=steps.ticks, colors="white", linewidths=0.5)
    if not is_labelled:
        return
    form = f"%.{canvas.decimals(steps.ticks)}f"
    style: Style = {"fontsize": palette.FONT_POINTS - 1.5, "colors": palette.INK}
    placed = list(flat[-1])  # keeps labels off the outline, too
    for label in axes.clabel(lines, fmt=form, inline=False, **style):
        at = np.array(label.get_position())
        if np.hypot(*(np.array(placed) - at).T).min() < _APART * max(np.ptp(x), np.ptp(y)):
            label.remove()
            continue
        placed.append(at)
        label.set_bbox(canvas.paper(0.7, 0.85))


def _outline(axes: Axes, flat: FloatArray) -> None:
    axes.plot(*flat[-1].T, color=palette.INK, linewidth=0.8)


def _scatter(
    axes: Axes, flat: FloatArray, field: RegionField, values: FloatArray, steps: Steps | None
) -> None:
    """A list of points, the greatest value on top."""
    order = np.argsort(np.nan_to_num(values, nan=-1.0))
    x, y = flat.T
    if steps is not None:
        finite = order[np.isfinite(values[order])]
        scale: Style = {"c": values[finite], "cmap": steps.colormap, "norm": steps.norm}
        axes.scatter(x[finite], y[finite], s=26, linewidths=0.4, edgecolors=palette.INK, **scale)
    bad, left = (order[mask[order]] for mask in (field.is_infeasible, field.is_left_out))
    axes.scatter(x[bad], y[bad], marker="x", s=16, linewidths=1.0, color=palette.WARNING)
    axes.scatter(x[left], y[left], marker="o", s=10, color=palette.LEFT_OUT)


def set_limits(axes: Axes, flat: FloatArray, corners: FloatArray) -> None:
    """Set the limits, around the exit points, with their names, unless the region were a speck."""
    from matplotlib.ticker import MaxNLocator

    for axis in (axes.xaxis, axes.yaxis):  # steps of a quarter have names too long for a small map
        axis.set_major_locator(MaxNLocator("auto", steps=[1, 2, 5, 10]))
    middle, half, shows_corners = _frame(flat, corners)
    axes.set_aspect("equal")
    (left, low), (right, high) = middle - half, middle + half
    axes.set(xlim=(left, right), ylim=(low, high))
    if not shows_corners:
        return
    axes.plot(*corners.T, "^", markersize=5, color=palette.INK, clip_on=False)
    centre = corners.mean(axis=0)
    for text, place in canvas.names_of(corners, 0.06 * float(np.ptp(corners, axis=0).max())):
        _write_away(axes, text, place, place - centre, 6.0)


def _height_over_width(flat: FloatArray, corners: FloatArray) -> float:
    half = _frame(flat, corners)[1]
    return float(half[1] / half[0])


def _frame(points: FloatArray, corners: FloatArray) -> tuple[FloatArray, FloatArray, bool]:
    """Centre and half extent (2,) [m] of what is shown, and whether exit points are in it."""
    flat = points.reshape(-1, 2)
    everything = np.concatenate([flat, corners])
    wide = np.ptp(everything, axis=0).max()
    shows_corners = bool(np.ptp(flat, axis=0).max() > _ZOOM * wide or len(flat) == 1)
    shown_m = everything if shows_corners else flat
    low, high = shown_m.min(axis=0), shown_m.max(axis=0)
    half = 0.5 * (high - low) + 0.18 * max((high - low).max(), 1e-3)
    half = np.maximum(half, 0.35 * half.max())  # no slivers
    return 0.5 * (low + high), half, shows_corners


def _mark_focus(axes: Axes, maps: WorkspaceMaps, quantity: MapQuantity) -> str:
    """Mark the worst pose; return what it meets as a line of the title, clear of the map."""
    focus = maps.focus
    is_level = maps.has_area and not maps.is_upright
    if is_level and not np.isclose(focus.position_m[2], maps.section.position_m[0, 0, 2]):
        return ""
    ring = canvas.RING | {"color": "white" if maps.has_area else "none"}
    axes.plot(*maps.flat_m(focus.position_m), **ring, markersize=6, clip_on=False, zorder=5)
    return f"\n○ {quantity.text_of(focus)}"


def _write_away(
    axes: Axes, text: str, place: FloatArray, away: FloatArray, points: float, **style: Any
) -> None:
    """Write beside a place, or above or below it, on the side of a direction, within the axes."""
    right, up = away if away.any() else (0.0, 1.0)
    left_end, right_end = axes.get_xlim()
    share = float((place[0] - left_end) / (right_end - left_end))
    half = 0.013 * len(text)  # of its width, over the width of small axes
    # A text may pass the right end of the axes, where no numbers stand.
    has_room = 2.0 * half < (1.15 - share if right > 0.0 else share)
    if 2.0 * abs(right) > abs(up) and has_room:
        offset = (points if right > 0.0 else -points, 0.0)
        style |= {"ha": "left" if right > 0.0 else "right", "va": "center"}
    else:
        offset = (0.0, points if up > 0.0 else -points)
        inward = "left" if share < half else "right" if share > 1.0 - half else "center"
        style |= {"ha": inward, "va": "bottom" if up > 0.0 else "top"}
    canvas.note(axes, text, (place[0], place[1]), offset, path_effects=canvas.halo(), **style)
