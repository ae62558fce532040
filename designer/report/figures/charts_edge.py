"""How the needed diameter climbs toward the edge: why a sampled maximum can be an artefact."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

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
        figure = canvas.sheet(70.0)
        axes = figure.subplots()
        start, top = _window(profile), _top(profile, maps.focus)
        axes.set(xlim=(start, 0.0), ylim=(0.0, top))
        _zones(axes, profile)
        _curves(axes, profile)
        _region_end(axes, profile)
        _mark_focus(axes, profile, maps.focus)
        canvas.grid_lines(axes)
        axes.set_title(
            f"needed diameter [mm] at z = {canvas.significant(maps.focus.position_m[2], 3)} m",
            loc="left",
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
        at = int(np.argmin(np.abs(profile.distance_m - _label_place(axes, profile))))
        if np.isfinite(values[at]):
            axes.annotate(
                label,
                (profile.distance_m[at], values[at]),
                (0, 5 if above else -5),
                textcoords="offset points",
                va="bottom" if above else "top",
                color=colour,
            )


def _label_place(axes: Axes, profile: EdgeProfile) -> float:
    """Where to name the curves: at their start, unless the worst pose lies there [m]."""
    start = axes.get_xlim()[0]
    return float((0.45 if profile.focus_distance_m > 0.9 * start else 0.94) * start)


def _zones(axes: Axes, profile: EdgeProfile) -> None:
    """Shade what the study leaves out, hatch what no cable can hold."""
    x, field = profile.distance_m, profile.field
    band: dict[str, Any] = {"transform": axes.get_xaxis_transform(), "linewidth": 0}
    if field.is_left_out.any():
        axes.fill_between(
            x, 0, 1, where=field.is_left_out, facecolor=palette.LEFT_OUT, alpha=0.6, **band
        )
        start = min(float(x[field.is_left_out].max()), axes.get_xlim()[0])
        axes.annotate(
            "left out: a cable hangs below the platform",
            (start, 0.97),
            (4, 0),
            xycoords=("data", "axes fraction"),
            textcoords="offset points",
            va="top",
        )
    for start, stop in _not_held(profile):
        axes.axvspan(
            start,
            stop,
            linewidth=0,
            facecolor=palette.WARNING_PALE,
            edgecolor=palette.WARNING,
            hatch="//////",
        )
    end = profile.limit_distance_m
    if end is not None and _is_visible(axes, end):
        axes.axvline(end, color=palette.WARNING, linewidth=0.9)
        inside = end > 0.02 * axes.get_xlim()[0]
        _upright(axes, end, _limit_text(profile, end), palette.WARNING, 3.0 if inside else -3.0)


def _not_held(profile: EdgeProfile) -> list[tuple[float, float]]:
    """Return where each stretch of poses that are not held starts and stops on the way out [m]."""
    x, failed = profile.distance_m, ~profile.field.is_solved
    turns = np.flatnonzero(np.diff(failed)) + 1
    between = 0.5 * (x[turns - 1] + x[turns])
    if profile.limit_distance_m is not None:
        between[0] = profile.limit_distance_m
    ends = [
        *([float(x[0])] if failed[0] else []),
        *between.tolist(),
        *([0.0] if failed[-1] else []),
    ]
    return list(zip(ends[::2], ends[1::2], strict=True))


def _limit_text(profile: EdgeProfile, end: float) -> str:
    distance = f"{canvas.significant(end, 2 if end < 100.0 else 3)} m"
    if profile.holds_again:
        return f"first failure, {distance} from the edge"
    none = "no cable holds" if profile.is_proved else "none found"
    return f"{none} within {distance} of the edge"


def _region_end(axes: Axes, profile: EdgeProfile) -> None:
    end = profile.region_distance_m
    if end is None or not _is_visible(axes, end):
        return
    axes.axvline(end, color=palette.INK, linewidth=0.8, linestyle=(0, (5, 2)))
    side = 3.0 if end > 0.9 * axes.get_xlim()[0] else -3.0
    _upright(axes, end, f"region ends, {canvas.significant(end, 3)} m", palette.INK, side)


def _is_visible(axes: Axes, distance_m: float) -> bool:
    """Whether it stands clear of both ends of the horizontal axis."""
    start = axes.get_xlim()[0]
    return bool(0.005 * start < distance_m < start)


def _upright(axes: Axes, at: float, text: str, colour: str, offset: float) -> None:
    """Write along a vertical line, on the side that the offset tells."""
    label = axes.annotate(
        text,
        (at, 0.97),
        (offset, 0),
        xycoords=("data", "axes fraction"),
        rotation=90,
        textcoords="offset points",
        ha="left" if offset > 0.0 else "right",
        va="top",
        color=colour,
        fontsize=palette.FONT_POINTS - 0.5,
        zorder=1.9,  # below the curves
    )
    label.set_bbox({"facecolor": "white", "edgecolor": "none", "pad": 1.0, "alpha": 0.95})


def _mark_focus(axes: Axes, profile: EdgeProfile, focus: Focus) -> None:
    value = 1e3 * float(focus.field.diameter_m)
    if not np.isfinite(value) or value > axes.get_ylim()[1]:
        return
    at = profile.focus_distance_m
    axes.plot(
        at,
        value,
        marker="o",
        markersize=6,
        color="white",
        markeredgecolor=palette.INK,
        markeredgewidth=1.1,
        zorder=5,
    )
    is_left = at > 0.6 * axes.get_xlim()[0]
    label = axes.annotate(
        f"{focus.label}, {canvas.significant(value, 3)} mm",
        (at, value),
        (8 if is_left else -16, 6),
        textcoords="offset points",
        ha="left" if is_left else "right",
        va="bottom",
        fontweight="bold",
    )
    label.set_path_effects(canvas.halo())
