"""Places for texts over the picture of a scene: near what they name, clear of all else."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from designer.arrays import FloatArray
from designer.report.figures import canvas, palette
from designer.report.figures.canvas import Style
from designer.report.figures.view import HEIGHT_PX, WIDTH_PX, View

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_SIDES = (
    ((0, 1), "center", "bottom"),
    ((1, 1), "left", "bottom"),
    ((-1, 1), "right", "bottom"),
    ((1, 0), "left", "center"),
    ((-1, 0), "right", "center"),
    ((0, -1), "center", "top"),
    ((1, -1), "left", "top"),
    ((-1, -1), "right", "top"),
)
"""Where a text may stand, right and up, and how it is aligned then."""
_OVER_TEXT, _OVER_LINE = 1000.0, 5.0
_LEADER_POINTS = 15.0
_ROOM_PX = 3.0
_NAMES_APART_PX = 45.0


def names_of(points_m: FloatArray, apart_m: float) -> list[tuple[str, FloatArray]]:
    """Return a name and a place for each exit point, one for those closer together than a name.

    Parameters
    ----------
    points_m : array (n_cables, 2 or 3)
        Exit points [m].
    apart_m : float
        Names this close would overlap [m].
    """
    groups: list[list[int]] = []
    for index, point in enumerate(points_m):
        near = (g for g in groups if np.linalg.norm(points_m[g[0]] - point) < apart_m)
        group = next(near, None)
        if group is None:
            groups.append([index])
        else:
            group.append(index)
    return [
        (", ".join(f"A{index + 1}" for index in group), points_m[group].mean(axis=0))
        for group in groups
    ]


def write_clear(
    axes: Axes,
    view: View,
    anchors_m: FloatArray,
    text: str,
    obstacles_px: FloatArray,
    distances: Iterable[float] = (11.0, 18.0, 28.0, 42.0, 60.0),
    **style: Any,
) -> None:
    """Write a text where it covers least, with a line to what it names where that is far off.

    Parameters
    ----------
    axes : Axes
        With the picture; the texts already in it are not covered.
    view : View
        Where points land.
    anchors_m : array (n, 3)
        Places that the text may stand beside, the best first [m].
    text : str
        What to write.
    obstacles_px : array (k, 2)
        Points of lines and bodies that are better left free, see `obstacles`.
    distances : iterable of float
        From anchor to the edge of the text, the best first [points].
    **style
        Of the text.
    """
    looks = {"bbox": canvas.paper(1.2, 0.8), "annotation_clip": False, **style}
    label = canvas.note(axes, text, (0, 0), (0, 0), **looks)
    taken = _boxes(
        *(bar.get_tightbbox() for bar in axes.figure.axes[1:]),
        *(other.get_window_extent() for other in axes.texts if other is not label),
    )

    def put(anchor_px: FloatArray, side: Any, distance: float) -> FloatArray:
        (right, up), ha, va = side
        along = distance / np.hypot(right, up)
        label.xy = (float(anchor_px[0]), float(anchor_px[1]))
        label.set_position((along * right, along * up))
        label.set(ha=ha, va=va)
        return np.asarray(_boxes(label.get_window_extent())[0])

    anchors_px = view.pixels(np.atleast_2d(anchors_m))
    places = [(a, side, d) for d, a, side in product(distances, anchors_px, _SIDES)]
    costs = [_cost(put(*place), taken, obstacles_px) for place in places]
    anchor, side, distance = places[int(np.argmin(costs + 0.02 * np.arange(len(costs))))]
    left, top, right, bottom = put(anchor, side, distance)
    if distance > _LEADER_POINTS:
        end = np.clip(anchor, [left, top], [right, bottom])
        line: Style = {"color": palette.INK, "linewidth": 0.7, "zorder": 1.9}
        axes.plot(*np.stack([anchor, end]).T, path_effects=canvas.halo(), **line)


def write_exits(
    axes: Axes, view: View, exit_points_m: FloatArray, obstacles_px: FloatArray
) -> None:
    """Name the exit points (n_cables, 3) [m] that lie in the picture, neighbours together."""
    for name, place in names_of(exit_points_m, _NAMES_APART_PX / view.pixels_per_m):
        if view.shows(place):
            style = {"bbox": None, "path_effects": canvas.halo()}
            write_clear(axes, view, place, name, obstacles_px, (5.0, 9.0), **style)


def obstacles(view: View, lines_m: Iterable[FloatArray]) -> FloatArray:
    """Return points (k, 2) a few pixels apart along lines (n, 3), to be kept free of text [px]."""
    parts = [np.empty((0, 2))]
    for line in lines_m:
        corners = view.pixels(line)
        steps = np.hypot(*np.diff(corners, axis=0).T)
        along = np.concatenate([[0.0], np.cumsum(steps)])
        at = np.linspace(0.0, along[-1], max(int(along[-1] / 6.0), 2))
        parts.append(np.stack([np.interp(at, along, corners[:, k]) for k in (0, 1)], axis=1))
    return np.concatenate(parts)


def _boxes(*boxes: Any) -> FloatArray:
    """Left, upper, right and lower edges (n, 4) of boxes that Matplotlib counts from below [px]."""
    edges = [[box.x0, HEIGHT_PX - box.y1, box.x1, HEIGHT_PX - box.y0] for box in boxes]
    return np.array(edges).reshape(-1, 4)


def _cost(box: FloatArray, taken: FloatArray, obstacles_px: FloatArray) -> float:
    """How bad a place is: texts below it or the rim beyond it, then lines that it covers."""
    left, top, right, bottom = box + _ROOM_PX * np.array([-1.0, -1.0, 1.0, 1.0])
    if left < 0.0 or top < 0.0 or right > WIDTH_PX or bottom > HEIGHT_PX:
        return 10.0 * _OVER_TEXT
    wide = np.minimum(right, taken[:, 2]) - np.maximum(left, taken[:, 0])
    high = np.minimum(bottom, taken[:, 3]) - np.maximum(top, taken[:, 1])
    x, y = obstacles_px.T
    covered = (x > left) & (x < right) & (y > top) & (y < bottom)
    texts = np.count_nonzero((wide > 0.0) & (high > 0.0))
    return float(_OVER_TEXT * texts + _OVER_LINE * np.count_nonzero(covered))
