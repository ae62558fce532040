"""Text, axes and colour bar that are written over the picture of a scene."""

from __future__ import annotations

import io
from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from designer.analysis.field import Field
from designer.arrays import FloatArray
from designer.report.figures import canvas, palette
from designer.report.figures.colours import Steps
from designer.report.figures.quantity import Quantity
from designer.report.figures.stage import Image
from designer.report.figures.view import HEIGHT_PX, WIDTH_PX, View

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_TICK_POINTS = 13.5
_TICKS_APART_POINTS = 27.0
_LINES_APART_POINTS = 15.0
_DOTS_PER_INCH = 240.0  # 1600 px fill the column of the printed report


def over(image: Image, letters: float = 1.0) -> tuple[Figure, Axes]:
    """Return a figure with the picture in it, whose axes count pixels from the upper left.

    Parameters
    ----------
    image : Image
        The picture of a scene.
    letters : float
        Size of letters and lines over the usual, for a picture that is printed small.
    """
    from matplotlib.figure import Figure

    dots_per_inch = letters * _DOTS_PER_INCH
    size = (WIDTH_PX / dots_per_inch, HEIGHT_PX / dots_per_inch)
    figure = Figure(figsize=size, dpi=dots_per_inch)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.imshow(image, extent=(0, WIDTH_PX, HEIGHT_PX, 0), interpolation="nearest", aspect="auto")
    axes.set_axis_off()
    axes.set(xlim=(0, WIDTH_PX), ylim=(HEIGHT_PX, 0))
    return figure, axes


def png(figure: Figure) -> bytes:
    """Return the finished picture as a PNG file of 1600 by 1000 pixels, and empty the figure.

    Figures lie in reference cycles, and a few objects that hold megabytes of pixels would wait
    hundreds of pictures long for Python to clear them up.
    """
    stream = io.BytesIO()
    figure.savefig(
        stream,
        format="png",
        dpi=figure.dpi,
        metadata={"Software": None},
        pil_kwargs={"optimize": True},
    )
    figure.clear()
    return stream.getvalue()


def write(
    axes: Axes,
    view: View,
    point_m: FloatArray,
    text: str,
    offset: tuple[float, float] = (0, 0),
    **style: Any,
) -> None:
    """Write a text beside a point of the scene, ``offset`` in points; none outside the picture."""
    x, y = view.pixels(point_m)
    if not (0.0 <= x <= WIDTH_PX and 0.0 <= y <= HEIGHT_PX):
        return
    placed = {"ha": "center", "va": "center", **style}
    label = axes.annotate(text, (x, y), offset, textcoords="offset points", **placed)
    label.set_path_effects(canvas.halo())


def mark(axes: Axes, view: View, point_m: FloatArray, colour: str = "white") -> None:
    """Draw a ring at a point of the scene."""
    axes.plot(
        *view.pixels(point_m),
        marker="o",
        markersize=5.5,
        color=colour,
        markeredgecolor=palette.INK,
        markeredgewidth=1.1,
    )


def hidden_lines(axes: Axes, view: View, lines_m: Iterable[FloatArray]) -> None:
    """Draw lines faintly over everything, so that what lies behind a surface can be guessed."""
    for line in lines_m:
        axes.plot(
            *view.pixels(line).T, color=palette.INK, linewidth=0.6, linestyle=(0, (2, 2)), alpha=0.6
        )


def colour_bar(
    figure: Figure,
    steps: Steps,
    quantity: Quantity,
    place: tuple[float, float, float, float] = (0.895, 0.2, 0.016, 0.6),
) -> None:
    """Draw the colour bar at the right edge, where ``place`` (left, low, width, height) says."""
    axes = figure.add_axes(place)
    bar = figure.colorbar(
        steps.mappable, cax=axes, ticks=steps.ticks, extendfrac=0.04, label=quantity.label
    )
    bar.outline.set_linewidth(0.4)
    bar.ax.tick_params(length=2)


def legend(figure: Figure, fields: Sequence[Field]) -> None:
    """Say what the colours mean that are not on the colour bar."""
    from matplotlib.patches import Patch

    reasons = {field.why_infeasible for field in fields} - {""}
    entries = []
    if reasons:
        label = reasons.pop() if len(reasons) == 1 else "no cable holds the platform"
        entries.append(Patch(facecolor=palette.WARNING, label=label))
    if any(field.is_left_out.any() for field in fields):
        label = "left out: a cable hangs below the platform"
        entries.append(Patch(facecolor=palette.LEFT_OUT, label=label))
    if entries:
        figure.legend(handles=entries, loc="lower left", ncols=2, frameon=False)


def box_axes(axes: Axes, view: View, bounds_m: FloatArray) -> None:
    """Write coordinates along the edges of a box (2, 3) that face the camera.

    The lines themselves belong to the scene, see `floor_lines`.
    """
    low, high = bounds_m
    near = np.where(view.toward_camera > 0.0, high, low)
    middle = 0.5 * (low + high)
    corner = leftmost_corner(view, bounds_m)
    taken = view.pixels(np.array([*corner, low[2]]))
    points = axes.figure.dpi / 72.0
    for axis, across in ((0, 1), (1, 0)):
        for tick in _ticks_along(view, low, high, axis, _TICKS_APART_POINTS * points):
            point = np.array([0.0, 0.0, low[2]])
            point[axis], point[across] = tick, near[across]
            if np.hypot(*(view.pixels(point) - taken)) < _TICK_POINTS * points:
                continue  # the upright axis has its own label there
            _tick(
                axes, view, point, canvas.number(float(tick)), across, near[across] - middle[across]
            )
        name = np.array([0.0, 0.0, low[2]])
        name[axis], name[across] = middle[axis], near[across]
        _tick(axes, view, name, "xy"[axis] + " [m]", across, near[across] - middle[across], 24.0)
    for tick in _ticks_along(view, low, high, 2, _LINES_APART_POINTS * points):
        write(
            axes,
            view,
            np.array([*corner, tick]),
            canvas.number(float(tick)),
            (-5, 0),
            ha="right",
            fontsize=palette.FONT_POINTS - 1.0,
        )
    write(axes, view, np.array([*corner, high[2]]), "z [m]", (-13, 12), ha="right")


def _ticks_along(
    view: View, low: FloatArray, high: FloatArray, axis: int, apart_px: float
) -> FloatArray:
    """As many ticks as there is room for along an edge."""
    edge = np.zeros((2, 3))
    edge[:, axis] = low[axis], high[axis]
    length = float(np.hypot(*np.diff(view.pixels(edge), axis=0)[0]))
    return ticks_between(
        low[axis], high[axis], min(max(int(length / apart_px), 1), 4 if axis == 2 else 5)
    )


def _tick(
    axes: Axes,
    view: View,
    point: FloatArray,
    text: str,
    across: int,
    side: float,
    distance: float = 9.0,
) -> None:
    """Write outside the edge, in the direction in which the picture shows it to lie."""
    beyond = point.copy()
    beyond[across] += side
    step = view.pixels(beyond) - view.pixels(point)
    step = step / max(float(np.hypot(*step)), 1e-9) * distance
    # The name of an axis begins beyond its numbers, wherever these stand.
    aside = distance > 10.0 and abs(step[0]) > 0.5 * distance
    write(
        axes,
        view,
        point,
        text,
        (float(step[0]), -float(step[1])),
        ha=("left" if step[0] > 0.0 else "right") if aside else "center",
        fontsize=palette.FONT_POINTS - (1.0 if distance < 10.0 else 0.0),
    )


def floor_lines(view: View, bounds_m: FloatArray) -> list[FloatArray]:
    """Return the grid on the floor of a box (2, 3) and its upright at the left, each (2, 3) [m]."""
    low, high = bounds_m
    lines = []
    for axis, across in ((0, 1), (1, 0)):
        for at in [low[axis], *ticks_between(low[axis], high[axis]), high[axis]]:
            line = np.full((2, 3), low[2])
            line[:, axis] = at
            line[:, across] = low[across], high[across]
            lines.append(line)
    corner = leftmost_corner(view, bounds_m)
    lines.append(np.array([[*corner, low[2]], [*corner, high[2]]]))
    return lines


def leftmost_corner(view: View, bounds_m: FloatArray) -> FloatArray:
    """Return x and y of the upright edge of a box that is leftmost in the picture (2,) [m]."""
    low, high = bounds_m
    corners = np.array([[x, y, low[2]] for x in (low[0], high[0]) for y in (low[1], high[1])])
    return np.asarray(corners[np.argmin(view.pixels(corners)[:, 0]), :2])


def ticks_between(low: float, high: float, most: int = 5) -> FloatArray:
    """Return round numbers from low to high."""
    from matplotlib.ticker import MaxNLocator

    if not high > low:
        return np.array([low])
    ticks = np.asarray(MaxNLocator(nbins=most, steps=[1, 2, 5, 10]).tick_values(low, high))
    slack = 1e-9 * (high - low)
    return ticks[(ticks >= low - slack) & (ticks <= high + slack)]
