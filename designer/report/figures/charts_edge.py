"""How the needed diameter climbs toward the edge: why a sampled maximum can be an artefact."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from designer.analysis.maps import EdgeProfile, Focus, WorkspaceMaps
from designer.report.figures import canvas, palette
from designer.report.figures.canvas import Style

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_AT_TOP = ("data", "axes fraction")


def edge_chart(maps: WorkspaceMaps) -> str | None:
    """Return the needed diameter over the distance to the edge of the exit points' hull, as SVG.

    None where the maps have no profile toward the edge.
    """
    profile, focus = maps.edge, maps.focus
    if profile is None:
        return None
    start, top = _window(profile), _top(profile, focus)
    caption = "Needed diameter from the centre of the region through the worst pose to the edge"
    with canvas.drawing():
        figure = canvas.sheet(62.0, width_mm=palette.HALF_WIDTH_MM)
        axes = figure.subplots()
        axes.set(xlim=(start, 0.0), ylim=(0.0, top))
        _zones(axes, profile, start)
        _curves(axes, profile, start, top)
        end = profile.region_distance_m
        if end is not None and _is_visible(end, start):
            axes.axvline(end, color=palette.INK, linewidth=0.8, linestyle=canvas.DASHES)
            text = f"region ends, {canvas.significant(end, 3)} m"
            _upright(axes, end, text, palette.INK, 3.0 if end > 0.9 * start else -3.0)
        value, at = 1e3 * float(focus.field.diameter_m), profile.focus_distance_m
        if np.isfinite(value) and value <= top:
            axes.plot(at, value, **canvas.RING, markersize=6, zorder=5)
            text = f"{focus.label}, {canvas.significant(value, 3)} mm"
            # It is half as long as the axis; right of the middle, it stands below the rising curve.
            is_left, is_below = at > 0.48 * start, 0.48 * start < at < 0.75 * start
            offset = (8 if is_left else -16, -6 if is_below else 6)
            style: Style = {
                "ha": "left" if is_left else "right",
                "va": "top" if is_below else "bottom",
            }
            style |= {"fontweight": "bold", "path_effects": canvas.halo()}
            canvas.note(axes, text, (at, value), offset, **style)
        canvas.grid_lines(axes)
        height = canvas.significant(focus.position_m[2], 3)
        axes.set_title(f"needed diameter [mm] at z = {height} m", loc="left")
        axes.set_xlabel("distance to the exit points' hull [m]")
        return canvas.svg(figure, "edge", caption)


def _window(profile: EdgeProfile) -> float:
    """Where the horizontal axis starts, so that the last stretch has room [m]."""
    reach_m = float(profile.distance_m[0])
    marks = [profile.region_distance_m, profile.limit_distance_m]
    stretch = max(6.0 * max((m for m in marks if m is not None), default=0.0), 0.3 * reach_m)
    return min(max(stretch, 1.3 * profile.focus_distance_m), reach_m)


def _top(profile: EdgeProfile, focus: Focus) -> float:
    """Where the vertical axis ends: the diameter grows without bound [mm]."""
    diameters = np.concatenate([profile.field.diameter_m, profile.field.massless_diameter_m])
    diameters = diameters[np.isfinite(diameters)]
    if len(diameters) == 0:
        return 1.0
    middle, worst = float(np.median(diameters)), float(focus.field.diameter_m)
    if not np.isfinite(worst) or worst > 4.0 * middle:
        worst = 1.3 * middle
    return 1e3 * min(1.15 * float(diameters.max()), 2.0 * worst)


def _curves(axes: Axes, profile: EdgeProfile, start: float, top: float) -> None:
    """Both curves, named at their start unless the worst pose lies there."""
    x, field = profile.distance_m, profile.field
    named = (0.45 if profile.focus_distance_m > 0.9 * start else 0.94) * start
    at = int(np.argmin(np.abs(x - named)))
    for diameter_m, colour, label, rise, va in (
        (field.diameter_m, palette.SAG, "with sag", 5, "bottom"),
        (field.massless_diameter_m, palette.MASSLESS, "massless", -5, "top"),
    ):
        values = 1e3 * diameter_m
        axes.plot(x, np.where(values < 2.0 * top, values, np.nan), color=colour)
        if np.isfinite(values[at]):
            canvas.note(axes, label, (x[at], values[at]), (0, rise), va=va, color=colour)


def _zones(axes: Axes, profile: EdgeProfile, start: float) -> None:
    """Shade what the study leaves out, hatch what no cable can hold."""
    x, left_out = profile.distance_m, profile.field.is_left_out
    if left_out.any():
        band: Style = {"transform": axes.get_xaxis_transform(), "linewidth": 0, "alpha": 0.6}
        axes.fill_between(x, 0, 1, where=left_out, facecolor=palette.LEFT_OUT, **band)
        place = (min(float(x[left_out].max()), start), 0.97)
        text = "left out: a cable hangs below the platform"
        canvas.note(axes, text, place, (4, 0), xycoords=_AT_TOP, va="top")
    for begin, stop in profile.stretches_not_held_m:
        axes.axvspan(begin, stop, linewidth=0, **canvas.HATCHED)
    end = profile.limit_distance_m
    if end is None or not _is_visible(end, start):
        return
    axes.axvline(end, color=palette.WARNING, linewidth=0.9)
    distance = f"{canvas.significant(end, 2 if end < 100.0 else 3)} m"
    no_cable = "no cable holds" if profile.is_proved else "none found"
    text = f"{no_cable} within {distance}"
    if profile.holds_again:
        text = f"first failure, {distance} from the edge"
    _upright(axes, end, text, palette.WARNING, 3.0 if end > 0.02 * start else -3.0)


def _is_visible(distance_m: float, start: float) -> bool:
    """Whether it stands clear of both ends of the horizontal axis."""
    return bool(0.005 * start < distance_m < start)


def _upright(axes: Axes, at: float, text: str, colour: str, offset: float) -> None:
    """Write along a vertical line, on the side that the offset tells, below the curves."""
    style = {"color": colour, "fontsize": palette.FONT_POINTS - 0.5, "zorder": 1.9}
    ha, ground = "left" if offset > 0.0 else "right", canvas.paper(1.0, 0.95)
    canvas.note(
        axes, text, (at, 0.97), (offset, 0), xycoords=_AT_TOP, rotation=90, ha=ha, va="top",
        bbox=ground, **style,
    )  # fmt: skip
