"""How the needed diameter climbs toward the edge: why a sampled maximum can be an artefact."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from designer.report.figures import canvas, palette
from designer.report.figures.edge import EdgeProfile
from designer.report.figures.maps import Focus, WorkspaceMaps

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_TITLE = "Needed diameter from the centre of the region through the worst pose to the edge"


def edge_chart(maps: WorkspaceMaps) -> str | None:
    """Return the needed diameter over the distance to the edge of the exit points' hull, as SVG.

    Parameters
    ----------
    maps : WorkspaceMaps
        With the profile toward the edge.

    Returns
    -------
    str or None
        None where there is no such profile.
    """
    profile = maps.edge
    if profile is None:
        return None
    with canvas.drawing():
        figure = canvas.sheet(78.0)
        axes = figure.subplots()
        start, top = _window(profile), _top(profile, maps.focus)
        axes.set(xlim=(start, 0.0), ylim=(0.0, top))
        _zones(axes, profile)
        _curves(axes, profile)
        _region_end(axes, profile)
        _mark_focus(axes, profile, maps.focus)
        canvas.grid_lines(axes)
        axes.set_title(
            f"needed diameter [mm] at z = {canvas.number(maps.focus.position_m[2])} m", loc="left"
        )
        axes.set_xlabel("distance to the edge of the exit points' hull, along the line [m]")
        return canvas.svg(figure, "edge", _TITLE)


def _window(profile: EdgeProfile) -> float:
    """Where the horizontal axis starts, so that the last stretch has room [m]."""
    whole = float(profile.distance_m[0])
    marks = [profile.region_distance_m, profile.limit_distance_m]
    stretch = max(6.0 * max((m for m in marks if m is not None), default=0.0), 0.3 * whole)
    return min(max(stretch, 1.3 * profile.focus_distance_m), whole)


def _top(profile: EdgeProfile, focus: Focus) -> float:
    """Where the vertical axis ends: the diameter grows without bound [mm]."""
    field = profile.field
    shown = np.concatenate([field.diameter_m, field.massless_diameter_m])
    shown = shown[np.isfinite(shown)]
    if len(shown) == 0:
        return 1.0
    middle = float(np.median(shown))
    worst = float(focus.field.diameter_m)
    if not np.isfinite(worst) or worst > 4.0 * middle:
        worst = 1.3 * middle
    return 1e3 * min(1.15 * float(shown.max()), 2.0 * worst)


def _curves(axes: Axes, profile: EdgeProfile) -> None:
    field, top = profile.field, axes.get_ylim()[1]
    for diameter_m, colour, label, above in (
        (field.diameter_m, palette.SAG, "with sag", True),
        (field.massless_diameter_m, palette.MASSLESS, "massless", False),
    ):
        values = 1e3 * diameter_m
        axes.plot(profile.distance_m, np.where(values < 2.0 * top, values, np.nan), color=colour)
        at = int(np.argmin(np.abs(profile.distance_m - 0.94 * axes.get_xlim()[0])))
        if np.isfinite(values[at]):
            axes.annotate(
                label, (profile.distance_m[at], values[at]), (0, 5 if above else -5),
                textcoords="offset points", va="bottom" if above else "top", color=colour,
            )


def _zones(axes: Axes, profile: EdgeProfile) -> None:
    """Shade what the study leaves out, hatch what no cable can hold."""
    x, field = profile.distance_m, profile.field
    if field.is_left_out.any():
        axes.fill_between(
            x, 0, 1, where=field.is_left_out, transform=axes.get_xaxis_transform(),
            facecolor=palette.LEFT_OUT, alpha=0.6, linewidth=0,
        )
        _upright(axes, _nearest_to_start(axes, profile), "left out: a cable hangs below")
    end = profile.limit_distance_m
    if not field.is_solved.any():
        end = float(x[0])
    if end is not None:
        axes.axvspan(
            end, 0.0, facecolor=palette.WARNING_PALE, edgecolor=palette.WARNING, hatch="//////",
            linewidth=0,
        )
        axes.axvline(end, color=palette.WARNING, linewidth=0.9)
        distance = canvas.significant(end, 2 if end < 100 else 3)
        text = f"no cable holds within {distance} m of the edge"
        _upright(axes, end, text, palette.WARNING)


def _region_end(axes: Axes, profile: EdgeProfile) -> None:
    end = profile.region_distance_m
    if end is None or not 0.0 <= end < axes.get_xlim()[0]:
        return
    axes.axvline(end, color=palette.INK, linewidth=0.8, linestyle=(0, (5, 2)))
    _upright(axes, end, f"region ends, {canvas.significant(end, 3)} m")


def _nearest_to_start(axes: Axes, profile: EdgeProfile) -> float:
    shown = profile.distance_m[profile.field.is_left_out]
    return float(min(shown.max(), axes.get_xlim()[0]))


def _upright(axes: Axes, at: float, text: str, colour: str = palette.INK) -> None:
    """A text along a vertical line, on its left where the curve is lower."""
    label = axes.annotate(
        text, (at, 0.97), (-3, 0), xycoords=("data", "axes fraction"), rotation=90,
        textcoords="offset points", ha="right", va="top", color=colour,
        fontsize=palette.FONT_POINTS - 0.5,
    )
    label.set_path_effects(canvas.halo())


def _mark_focus(axes: Axes, profile: EdgeProfile, focus: Focus) -> None:
    value = 1e3 * float(focus.field.diameter_m)
    if not np.isfinite(value) or value > axes.get_ylim()[1]:
        return
    axes.plot(
        profile.focus_distance_m, value, marker="o", markersize=6, color="white",
        markeredgecolor=palette.INK, markeredgewidth=1.1, zorder=5,
    )
    label = axes.annotate(
        f"{focus.label}, {canvas.significant(value)} mm", (profile.focus_distance_m, value),
        (-16, 6), textcoords="offset points", ha="right", va="bottom", fontweight="bold",
    )
    label.set_path_effects(canvas.halo())
