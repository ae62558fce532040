"""A region seen from above, coloured by what its poses need."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from designer.analysis.field import Field
from designer.arrays import BoolArray, FloatArray
from designer.report.figures import canvas, palette
from designer.report.figures.colours import Steps
from designer.report.figures.maps import WorkspaceMaps
from designer.report.figures.names import names_of
from designer.report.figures.quantity import Quantity

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_CHARACTER = 0.013  # half the width of a character over the width of small axes
_RIGHT_END = 1.15  # a text may pass the right end of the axes, where no numbers stand


def draw_plan(
    axes: Axes, maps: WorkspaceMaps, quantity: Quantity, steps: Steps | None, room: float
) -> None:
    """Draw the section of a workspace into axes of equal scale.

    Parameters
    ----------
    axes : Axes
        Where to draw; x and y in metres.
    maps : WorkspaceMaps
        What to draw.
    quantity : Quantity
        What the colours mean.
    steps : Steps or None
        Colour scale; None where no pose has a value.
    room : float
        Distance between labels of contour lines, over the size of the region.
    """
    field = maps.section
    if maps.has_area:
        _fill(axes, maps, quantity, steps, room)
    else:
        _scatter(axes, maps, quantity, steps)
    corners = maps.flat_m(maps.study.robot.exit_points_m)
    if set_limits(axes, maps.flat_m(field.position_m), corners):
        mark_exit_points(axes, corners)
    _focus(axes, maps, quantity)
    right, up = maps.axis_labels
    axes.set_xlabel(right)
    axes.set_ylabel(up)


def keys(field: Field) -> list[Any]:
    """Return legend entries for what the plan shows besides colours."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    entries: list[Any] = []
    if field.position_m.ndim == 3 and _has_border(field) and not field.is_left_out.any():
        style: dict[str, Any] = {"color": palette.INK, "linewidth": 0.9, "linestyle": (0, (4, 2))}
        label = "beyond: a cable hangs below the platform"
        entries.append(Line2D([], [], label=label, **style))
    if field.is_infeasible.any():
        entries.append(
            Patch(
                facecolor=palette.WARNING_PALE,
                edgecolor=palette.WARNING,
                hatch="//////",
                linewidth=0.5,
                label=field.why_infeasible,
            )
        )
    if field.is_left_out.any():
        label = "left out: a cable hangs below the platform"
        entries.append(Patch(facecolor=palette.LEFT_OUT, label=label))
    return entries


def _fill(
    axes: Axes, maps: WorkspaceMaps, quantity: Quantity, steps: Steps | None, room: float
) -> None:
    field = maps.section
    x, y = np.moveaxis(maps.flat_m(field.position_m), -1, 0)
    axes.fill(x[-1], y[-1], facecolor=palette.LEFT_OUT, edgecolor="none")
    _region_of(axes, x, y, field.is_infeasible)
    values = np.ma.masked_invalid(quantity.of(field))
    if steps is not None and values.count() > 0:
        steps.fill(axes, x, y, values)
        _contour_lines(axes, x, y, values, steps, room)
    if _has_border(field):
        uplift = np.ma.masked_invalid(field.uplift)
        axes.contour(
            x, y, uplift, levels=[0.0], colors=palette.INK, linewidths=0.9, linestyles="--"
        )
    axes.plot(x[-1], y[-1], color=palette.INK, linewidth=0.8)


def _region_of(axes: Axes, x: FloatArray, y: FloatArray, inside: BoolArray) -> None:
    """Hatch where no cable of the family holds the platform."""
    if not inside.any():
        return
    levels = [0.5, 1.5]
    axes.contourf(x, y, inside.astype(np.float64), levels=levels, colors=[palette.WARNING_PALE])
    hatched = axes.contourf(
        x, y, inside.astype(np.float64), levels=levels, colors="none", hatches=["//////"]
    )
    hatched.set_edgecolor(palette.WARNING)
    hatched.set_linewidth(0.0)


def _contour_lines(
    axes: Axes, x: FloatArray, y: FloatArray, values: FloatArray, steps: Steps, room: float
) -> None:
    decimals = canvas.decimals(steps.ticks)
    lines = axes.contour(x, y, values, levels=steps.ticks, colors="white", linewidths=0.5)
    labels = axes.clabel(
        lines,
        fmt=f"%.{decimals}f",
        fontsize=palette.FONT_POINTS - 1.5,
        colors=palette.INK,
        inline=False,
    )
    size = max(np.ptp(x), np.ptp(y))
    placed = list(np.stack([x[-1], y[-1]], axis=1))  # keeps labels off the outline, too
    for label in labels:
        at = np.array(label.get_position())
        if np.hypot(*(np.array(placed) - at).T).min() < room * size:
            label.remove()
            continue
        placed.append(at)
        label.set_bbox({"facecolor": "white", "edgecolor": "none", "pad": 0.7, "alpha": 0.85})


def _scatter(axes: Axes, maps: WorkspaceMaps, quantity: Quantity, steps: Steps | None) -> None:
    field = maps.section
    values = quantity.of(field)
    order = np.argsort(np.nan_to_num(values, nan=-1.0))
    x, y = maps.flat_m(field.position_m[order]).T
    shown = np.isfinite(values[order])
    if steps is not None:
        axes.scatter(
            x[shown],
            y[shown],
            c=values[order][shown],
            cmap=steps.colormap,
            norm=steps.norm,
            s=26,
            linewidths=0.4,
            edgecolors=palette.INK,
        )
    bad, left = field.is_infeasible[order], field.is_left_out[order]
    axes.scatter(x[bad], y[bad], marker="x", s=16, linewidths=1.0, color=palette.WARNING)
    axes.scatter(x[left], y[left], marker="o", s=10, color=palette.LEFT_OUT)


def set_limits(axes: Axes, points: FloatArray, corners: FloatArray) -> bool:
    """Set the limits, around the exit points as well unless the region would be a speck."""
    middle, half, shows_corners = _frame(points, corners)
    axes.set_aspect("equal")
    axes.set_xlim(middle[0] - half[0], middle[0] + half[0])
    axes.set_ylim(middle[1] - half[1], middle[1] + half[1])
    return shows_corners


def height_over_width(points: FloatArray, corners: FloatArray) -> float:
    """Return the proportions of axes whose limits are those of `set_limits`."""
    _, half, _ = _frame(points, corners)
    return float(half[1] / half[0])


def _frame(points: FloatArray, corners: FloatArray) -> tuple[FloatArray, FloatArray, bool]:
    """Centre and half extent (2,) [m] of what is shown, and whether exit points are in it."""
    flat = points.reshape(-1, 2)
    everything = np.concatenate([flat, corners])
    wide = np.ptp(everything, axis=0).max()
    shows_corners = bool(np.ptp(flat, axis=0).max() > 0.2 * wide or len(flat) == 1)
    shown = everything if shows_corners else flat
    low, high = shown.min(axis=0), shown.max(axis=0)
    half = 0.5 * (high - low) + 0.12 * max((high - low).max(), 1e-3)
    half = np.maximum(half, 0.35 * half.max())  # no slivers
    return 0.5 * (low + high), half, shows_corners


def mark_exit_points(axes: Axes, corners: FloatArray) -> None:
    """Mark and name the exit points (n_cables, 2) [m]."""
    axes.plot(
        *corners.T, linestyle="none", marker="^", markersize=5, color=palette.INK, clip_on=False
    )
    middle = corners.mean(axis=0)
    for text, place in names_of(corners, 0.06 * float(np.ptp(corners, axis=0).max())):
        _write_away(axes, text, place, place - middle, 6.0)


def _focus(axes: Axes, maps: WorkspaceMaps, quantity: Quantity) -> None:
    focus = maps.focus
    top = maps.has_area and not maps.is_upright
    if top and not np.isclose(focus.position_m[2], maps.section.position_m[0, 0, 2]):
        return
    place = maps.flat_m(focus.position_m)
    axes.plot(
        *place,
        marker="o",
        markersize=6,
        color="white" if maps.has_area else "none",
        markeredgecolor=palette.INK,
        markeredgewidth=1.1,
        clip_on=False,
        zorder=5,
    )
    away = place - _middle(maps)
    _write_away(axes, focus.text(quantity), place, away, 9.0, fontweight="bold", zorder=6)


def _write_away(
    axes: Axes, text: str, place: FloatArray, away: FloatArray, points: float, **style: Any
) -> None:
    """Write beside a place, or above or below it, on the side of a direction, within the axes."""
    right, up = away if away.any() else (0.0, 1.0)
    left_end, right_end = axes.get_xlim()
    share = float((place[0] - left_end) / (right_end - left_end))
    half = _CHARACTER * len(text)
    has_room = 2.0 * half < (_RIGHT_END - share if right > 0.0 else share)
    aligned: dict[str, Any]
    if 2.0 * abs(right) > abs(up) and has_room:
        offset = (points if right > 0.0 else -points, 0.0)
        aligned = {"ha": "left" if right > 0.0 else "right", "va": "center"}
    else:
        offset = (0.0, points if up > 0.0 else -points)
        inward = "left" if share < half else "right" if share > 1.0 - half else "center"
        aligned = {"ha": inward, "va": "bottom" if up > 0.0 else "top"}
    label = axes.annotate(
        text, (place[0], place[1]), offset, textcoords="offset points", **aligned, **style
    )
    label.set_path_effects(canvas.halo())


def _middle(maps: WorkspaceMaps) -> FloatArray:
    """Centre of the region, or of the points."""
    positions = maps.flat_m(maps.section.position_m)
    middle = positions[0, 0] if positions.ndim == 3 else positions.mean(axis=0)
    return np.asarray(middle, dtype=np.float64)


def _has_border(field: Field) -> bool:
    """Whether cables begin to hang below the platform somewhere within the section."""
    finite = field.uplift[np.isfinite(field.uplift)]
    return bool(len(finite) > 0 and finite.min() < 0.0 < finite.max())
