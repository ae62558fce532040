"""Axes and texts that are written over the picture of a scene, and the finished picture.

Matplotlib writes them and not VTK, so that a scene has the letters and the colour bar of a chart.
Texts stand near what they name, clear of all else.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Callable, Iterable
from functools import cache
from itertools import product
from typing import TYPE_CHECKING, Any
from weakref import WeakKeyDictionary

import numpy as np

from designer.analysis.maps import RegionField
from designer.arrays import FloatArray
from designer.report import format as fmt
from designer.report.figures import canvas, palette
from designer.report.figures.canvas import Style
from designer.report.figures.parts import floor_corners, floor_m, ticks_between
from designer.report.figures.stage import Image
from designer.report.figures.view import HEIGHT_PX, WIDTH_PX, View

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

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
_WIDE = 0.45  # of a picture: a text beyond it is broken in two
_OVER_TEXT, _OVER_LINE, _BY_ORDER = 1000.0, 5.0, 0.02
"""What it costs to cover a text or a point of a line, and to take the next place of the list."""
_EXTENTS: WeakKeyDictionary[Artist, Any] = WeakKeyDictionary()


def over(image: Image, letters: float = 1.0) -> tuple[Figure, Axes]:
    """Return a figure with the picture in it, whose axes count pixels from the upper left.

    ``letters`` is the size of letters and lines over the usual, for a picture that is printed
    small. Only one of a size is written over at a time: the next one has its figure.
    """
    figure, axes = _empty(letters)
    for artist in (*axes.texts, *axes.lines, *figure.legends, *figure.axes[1:]):
        artist.remove()
    # An image of Matplotlib would be sampled anew, which takes longer than to draw all the rest.
    pixels = _pixels(figure)
    pixels[..., :3], pixels[..., 3] = image, 255
    return figure, axes


@cache
def _empty(letters: float) -> tuple[Figure, Axes]:
    """One figure for all pictures: to make one takes longer than to write over it."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    dots_per_inch = letters * 240.0  # 1600 px fill the column of the printed report
    size = (WIDTH_PX / dots_per_inch, HEIGHT_PX / dots_per_inch)
    figure = Figure(figsize=size, dpi=dots_per_inch, facecolor="none")
    FigureCanvasAgg(figure)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    axes.set(xlim=(0, WIDTH_PX), ylim=(HEIGHT_PX, 0))
    return figure, axes


def finished(figure: Figure) -> Image:
    """Return the picture (1000, 1600, 3) with what was written over it."""
    sheet: Any = figure.canvas
    figure.draw(sheet.get_renderer())
    return _pixels(figure)[..., :3].copy()


def _pixels(figure: Figure) -> Image:
    """What a figure has been drawn on, to be written to (height, width, 4)."""
    sheet: Any = figure.canvas
    return np.asarray(sheet.get_renderer().buffer_rgba())


def png(image: Image) -> bytes:
    """Return a picture as a PNG file, without the white rows at its top and bottom.

    A narrow margin stays, and so does the width: all scenes of a page are drawn to one scale. Rows
    are packed as they are: to filter them first, as Pillow does, takes longer and saves nothing.
    """
    lines = image.reshape(len(image), -1)
    rows = np.flatnonzero(lines.min(axis=1) < 255)
    margin = round(0.01 * len(image))
    top, bottom = (max(rows[0] - margin, 0), rows[-1] + 1 + margin) if len(rows) else (0, None)
    unfiltered = np.pad(lines[top:bottom], ((0, 0), (1, 0)))  # a zero before each row says so
    head = struct.pack(">2I5B", image.shape[1], len(unfiltered), 8, 2, 0, 0, 0)  # 8 bits, RGB
    parts = ((b"IHDR", head), (b"IDAT", zlib.compress(unfiltered.data, 3)), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        for kind, data in parts
    )


def meanings(fields: Iterable[RegionField]) -> list[tuple[str, str]]:
    """Return colours that are not on the colour bar, and what they mean, where they occur."""
    field_list = list(fields)
    found = []
    reasons = {field.why_infeasible for field in field_list} - {""}
    if reasons:
        text = reasons.pop() if len(reasons) == 1 else "no cable was found to hold the platform"
        found.append((palette.WARNING, text))
    if any(field.is_left_out.any() for field in field_list):
        found.append((palette.LEFT_OUT, "left out: a cable hangs below the platform"))
    return found


def proved(triangles_m: FloatArray) -> list[tuple[str, str]]:
    """Return colour and meaning of the border of what no rope can serve, if it is drawn."""
    text = "no rope of any size holds beyond this (proved)"
    return [(palette.IMPOSSIBLE, text)] if len(triangles_m) else []


def box_axes(axes: Axes, view: View, bounds_m: FloatArray) -> None:
    """Write coordinates along the edges of a box (2, 3) that face the camera.

    The lines themselves belong to the scene, see `floor_lines`.
    """
    low, high = bounds_m
    middle, corner = 0.5 * (low + high), leftmost_corner(view, bounds_m)
    near_corner = np.where(view.toward_camera > 0.0, high, low)
    small = {"fontsize": palette.FONT_POINTS - 1.0}
    points = axes.figure.dpi / 72.0
    label_px = view.pixels(np.array([*corner, low[2]]))  # where the upright axis has its own label
    for axis, across in ((0, 1), (1, 0)):
        name = np.array([*middle[:2], low[2]])
        name[across] = near_corner[across]
        beyond = name.copy()
        beyond[across] += near_corner[across] - middle[across]
        outward = (view.pixels(beyond) - view.pixels(name)) * [1.0, -1.0]
        outward /= max(float(np.hypot(*outward)), 1e-9)
        for tick in _ticks_along(view, bounds_m, axis, 27.0 * points):
            point = name.copy()
            point[axis] = tick
            if np.hypot(*(view.pixels(point) - label_px)) >= 13.5 * points:
                _write(axes, view, point, fmt.trimmed(tick, 6), 9.0 * outward, **small)
        # The name of an axis begins beyond its numbers, wherever these stand.
        side = "left" if outward[0] > 0.0 else "right"
        ha = side if abs(outward[0]) > 0.5 else "center"
        _write(axes, view, name, f"{'xy'[axis]} [m]", 24.0 * outward, ha=ha)
    for tick in _ticks_along(view, bounds_m, 2, 15.0 * points):
        place = np.array([*corner, tick])
        _write(axes, view, place, fmt.trimmed(tick, 6), (-5, 0), ha="right", **small)
    _write(axes, view, np.array([*corner, high[2]]), "z [m]", (-13, 12), ha="right")


def _ticks_along(view: View, bounds_m: FloatArray, axis: int, apart_px: float) -> FloatArray:
    """As many ticks as there is room for along an edge."""
    edge = np.zeros((2, 3))
    edge[:, axis] = bounds_m[:, axis]
    length = float(np.hypot(*np.diff(view.pixels(edge), axis=0)[0]))
    most = min(max(int(length / apart_px), 1), 4 if axis == 2 else 5)
    low, high = bounds_m[:, axis]
    return ticks_between(low, high, most)


def _write(
    axes: Axes, view: View, point_m: FloatArray, text: str, offset: Any, **style: Any
) -> None:
    """Write beside a point of the scene, ``offset`` in points; nothing outside the picture."""
    if view.shows(point_m):
        x, y = view.pixels(point_m)
        placed = {"ha": "center", "va": "center", "path_effects": canvas.halo(), **style}
        canvas.note(axes, text, (x, y), tuple(offset), **placed)


def floor_lines(view: View, bounds_m: FloatArray) -> list[FloatArray]:
    """Return the grid on the floor of a box (2, 3) and its upright at the left, each (2, 3) [m]."""
    corner = leftmost_corner(view, bounds_m)
    return [*floor_m(bounds_m), np.array([[*corner, z] for z in bounds_m[:, 2]])]


def box_ticks(view: View, bounds_m: FloatArray) -> list[tuple[FloatArray, str]]:
    """Return coordinates along edges of a box (2, 3) in space, and the names of its axes.

    As in `box_axes`, for a scene that is turned: each is a point (3,) [m] a little outside, and its
    text.
    """
    low, high = bounds_m
    beyond = 0.05 * float(np.ptp(bounds_m, axis=0).max())
    out = np.where(view.toward_camera > 0.0, 1.0, -1.0)
    near_corner = np.where(out > 0.0, high, low)
    corner = leftmost_corner(view, bounds_m)
    found = []
    for axis, name in enumerate("xyz"):
        edge = np.array([*(corner if axis == 2 else near_corner[:2]), low[2]])
        side = np.zeros(3)
        if axis == 2:
            side[:2] = np.sign(corner - 0.5 * (low + high)[:2])
        else:
            side[1 - axis] = out[1 - axis]
        ticks = ticks_between(low[axis], high[axis], 4 if axis == 2 else 5)
        ends = [(tick, fmt.trimmed(tick, 6), 1.0) for tick in ticks]
        if axis == 2:
            ends.append((high[axis] + beyond, f"{name} [m]", 0.0))
        else:
            ends.append((0.5 * (low + high)[axis], f"{name} [m]", 2.2))
        for at, text, times in ends:
            place = edge + times * beyond * side
            place[axis] = at
            found.append((place, text))
    return found


def leftmost_corner(view: View, bounds_m: FloatArray) -> FloatArray:
    """Return x and y of the upright edge of a box that is leftmost in the picture (2,) [m]."""
    corners = floor_corners(bounds_m)
    return np.asarray(corners[np.argmin(view.pixels(corners)[:, 0]), :2])


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

    The texts that are already in the axes are not covered.

    Parameters
    ----------
    anchors_m, distances : array (n, 3), iterable of float
        Places that the text may stand beside [m], and how far off [points]; the best first.
    obstacles_px : array (k, 2)
        Points of lines and bodies that are better left free, see `obstacles`.
    """
    looks = {"bbox": canvas.paper(1.2, 0.8), "annotation_clip": False, **style}
    label = canvas.note(axes, text, (0, 0), (0, 0), **looks)
    if label.get_window_extent().width > _WIDE * WIDTH_PX:  # would not fit on either side
        label.set_text(text.replace(", ", ",\n", 1))
    occupied = _boxes(
        *(_extent(bar, bar.get_tightbbox) for bar in axes.figure.axes[1:]),
        *(_extent(x, x.get_window_extent) for x in axes.texts if x is not label),
    )

    size = np.asarray(label.get_window_extent().size, dtype=np.float64)
    points = axes.figure.dpi / 72.0

    def box(anchor_px: FloatArray, side: Any, distance: float) -> FloatArray:
        toward = np.array(side[0], dtype=np.float64) * [1.0, -1.0]
        middle = anchor_px + points * distance * toward / np.hypot(*toward) + 0.5 * size * toward
        return np.concatenate([middle - 0.5 * size, middle + 0.5 * size])

    anchors_px = view.pixels(np.atleast_2d(anchors_m))
    places = [(a, side, d) for d, a, side in product(distances, anchors_px, _SIDES)]
    costs = [_cost(box(*place), occupied, obstacles_px) for place in places]
    best = places[int(np.argmin(costs + _BY_ORDER * np.arange(len(costs))))]
    anchor, ((right, up), ha, va), distance = best
    along = distance / np.hypot(right, up)
    label.xy = (float(anchor[0]), float(anchor[1]))
    label.set(position=(along * right, along * up), ha=ha, va=va)
    left, top, right, bottom = box(*best)
    if distance > 15.0:
        end = np.clip(anchor, [left, top], [right, bottom])
        line: Style = {"color": palette.INK, "linewidth": 0.7, "zorder": 1.9}
        axes.plot(*np.stack([anchor, end]).T, path_effects=canvas.halo(), **line)


def write_exits(
    axes: Axes, view: View, exit_points_m: FloatArray, obstacles_px: FloatArray
) -> None:
    """Name the exit points (n_cables, 3) [m] that lie in the picture, neighbours together."""
    for name, place in canvas.names_of(exit_points_m, 45.0 / view.pixels_per_m):
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


def _extent(artist: Artist, measure: Callable[[], Any]) -> Any:
    """Where something stands that stays there; to measure it again and again takes long."""
    if artist not in _EXTENTS:
        _EXTENTS[artist] = measure()
    return _EXTENTS[artist]


def _boxes(*boxes: Any) -> FloatArray:
    """Left, upper, right and lower edges (n, 4) of boxes that Matplotlib counts from below [px]."""
    edges = [[box.x0, HEIGHT_PX - box.y1, box.x1, HEIGHT_PX - box.y0] for box in boxes]
    return np.array(edges).reshape(-1, 4)


def _cost(box: FloatArray, occupied: FloatArray, obstacles_px: FloatArray) -> float:
    """How bad a place is: texts below it or the rim beyond it, then lines that it covers."""
    left, top, right, bottom = box + 3.0 * np.array([-1.0, -1.0, 1.0, 1.0])
    if left < 0.0 or top < 0.0 or right > WIDTH_PX or bottom > HEIGHT_PX:
        return 10.0 * _OVER_TEXT
    wide = np.minimum(right, occupied[:, 2]) - np.maximum(left, occupied[:, 0])
    high = np.minimum(bottom, occupied[:, 3]) - np.maximum(top, occupied[:, 1])
    x, y = obstacles_px.T
    covered = (x > left) & (x < right) & (y > top) & (y < bottom)
    texts = np.count_nonzero((wide > 0.0) & (high > 0.0))
    return float(_OVER_TEXT * texts + _OVER_LINE * np.count_nonzero(covered))
