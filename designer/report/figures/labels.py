"""Places for texts over the picture of a scene: near what they name, clear of all else."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from designer.arrays import FloatArray
from designer.report.figures import canvas, palette
from designer.report.figures.names import names_of
from designer.report.figures.view import HEIGHT_PX, WIDTH_PX, View

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.text import Annotation

_DIRECTIONS = ((0, 1), (1, 1), (-1, 1), (1, 0), (-1, 0), (0, -1), (1, -1), (-1, -1))
_HORIZONTAL = {1: "left", 0: "center", -1: "right"}
_VERTICAL = {1: "bottom", 0: "center", -1: "top"}
_OVER_TEXT = 1000.0
_OVER_LINE = 5.0
_LEADER_POINTS = 15.0
_ROOM_PX = 3.0
_NAMES_APART_PX = 45.0
_PAPER: dict[str, Any] = {"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 1.2}


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
    looks = {"bbox": _PAPER, **style}
    label = axes.annotate(
        text, (0, 0), (0, 0), textcoords="offset points", annotation_clip=False, **looks
    )
    taken = _taken(axes, label)
    anchors_px = view.pixels(np.atleast_2d(anchors_m))
    places = [
        (anchor, direction, distance)
        for distance, anchor, direction in product(distances, anchors_px, _DIRECTIONS)
    ]
    costs = []
    for order, place in enumerate(places):
        _put(label, *place)
        costs.append(_cost(_edges(label.get_window_extent()), taken, obstacles_px) + 0.02 * order)
    anchor, direction, distance = places[int(np.argmin(costs))]
    _put(label, anchor, direction, distance)
    if distance > _LEADER_POINTS:
        _lead(axes, label, anchor)


def write_exits(
    axes: Axes, view: View, exit_points_m: FloatArray, obstacles_px: FloatArray
) -> None:
    """Name the exit points (n_cables, 3) [m] that lie in the picture, neighbours together."""
    for name, place in names_of(exit_points_m, _NAMES_APART_PX / view.pixels_per_m):
        x, y = view.pixels(place)
        if 0.0 <= x <= WIDTH_PX and 0.0 <= y <= HEIGHT_PX:
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


def _put(
    label: Annotation, anchor_px: FloatArray, direction: tuple[int, int], distance: float
) -> None:
    """Let a text stand off from an anchor in one of eight directions."""
    right, up = direction
    along = distance / np.hypot(right, up)
    label.xy = (float(anchor_px[0]), float(anchor_px[1]))
    label.set_position((along * right, along * up))
    label.set(ha=_HORIZONTAL[right], va=_VERTICAL[up])


def _taken(axes: Axes, label: Annotation) -> FloatArray:
    """Boxes (n, 4) of the other texts in the picture and of the colour bar beside it [px]."""
    bars = [other.get_tightbbox() for other in axes.figure.axes[1:]]
    texts = [other.get_window_extent() for other in axes.texts if other is not label]
    return np.array([_edges(box) for box in (*bars, *texts)]).reshape(-1, 4)


def _edges(box: Any) -> FloatArray:
    """Left, upper, right and lower edge of a box that Matplotlib counts from below [px]."""
    return np.array([box.x0, HEIGHT_PX - box.y1, box.x1, HEIGHT_PX - box.y0])


def _cost(box: FloatArray, taken: FloatArray, obstacles_px: FloatArray) -> float:
    """How bad a place is: texts below it or the rim beyond it, then lines that it covers."""
    left, top, right, bottom = box + _ROOM_PX * np.array([-1.0, -1.0, 1.0, 1.0])
    if left < 0.0 or top < 0.0 or right > WIDTH_PX or bottom > HEIGHT_PX:
        return 10.0 * _OVER_TEXT
    wide = np.minimum(right, taken[:, 2]) - np.maximum(left, taken[:, 0])
    high = np.minimum(bottom, taken[:, 3]) - np.maximum(top, taken[:, 1])
    x, y = obstacles_px.T
    covered = (x > left) & (x < right) & (y > top) & (y < bottom)
    return float(
        _OVER_TEXT * np.count_nonzero((wide > 0.0) & (high > 0.0))
        + _OVER_LINE * np.count_nonzero(covered)
    )


def _lead(axes: Axes, label: Annotation, anchor_px: FloatArray) -> None:
    """Draw a thin line from an anchor to the nearest point of its text."""
    left, top, right, bottom = _edges(label.get_window_extent())
    x, y = np.clip(anchor_px, [left, top], [right, bottom])
    axes.plot(
        [anchor_px[0], x],
        [anchor_px[1], y],
        color=palette.INK,
        linewidth=0.7,
        path_effects=canvas.halo(),
        zorder=1.9,
    )
