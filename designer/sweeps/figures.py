"""A sweep in pictures: each result over each field, two goals against each other, all at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from designer.arrays import BoolArray, FloatArray
from designer.report import format as fmt
from designer.report.figures import canvas, palette

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_MOST_LINES = 1500
_MOST_LABELS = 12
_LONGEST_LABEL = 18
_TILTED = 24
"""Letters of labels at one axis beyond which they are tilted, so that neighbours stand apart."""
_FRONT: canvas.Style = {
    **canvas.DOTS, "markersize": 3.6, "markeredgewidth": 0.6, "color": palette.SAG,
    "markeredgecolor": palette.INK,
}  # fmt: skip


def _pale(n_points: int) -> canvas.Style:
    """Return how all points look: few must not be lost, many not hide each other."""
    size = 3.2 if n_points < 200 else 1.8
    look: canvas.Style = {"markersize": size, "markeredgewidth": 0.0, "rasterized": n_points > 2000}
    return {**canvas.DOTS, **look, "color": palette.SAG_PALE}


@dataclass(frozen=True, slots=True)
class Axis:
    """One quantity over all points: numbers, NaN for none, or places among labels."""

    title: str
    values: FloatArray
    labels: tuple[str, ...] = ()

    @classmethod
    def of(cls, name: str, unit: str, values: np.ndarray) -> Axis:
        """Return an axis of numbers, or of the texts in the order of the alphabet."""
        title = f"{name} [{unit}]" if unit else name
        if values.dtype.kind == "f":
            return cls(title, np.where(np.isfinite(values), values, np.nan))
        labels, places = np.unique([str(value) for value in values.tolist()], return_inverse=True)
        return cls(title, places.astype(float), tuple(map(str, labels)))

    def text(self, point: int) -> str:
        """Return the value at a point as a cell of a table has it."""
        value = float(self.values[point])
        return self.labels[int(value)] if self.labels else fmt.trimmed(value, 5)

    def tick(self, axes: Axes) -> None:
        """Write the labels of texts below a diagram; of many, some."""
        if not self.labels:
            return
        places = range(0, len(self.labels), -(-len(self.labels) // _MOST_LABELS))
        short = [_shortened(self.labels[k]) for k in places]
        tilted = sum(map(len, short)) > _TILTED
        axes.set_xticks(places, short, rotation=25 * tilted, ha="right" if tilted else "center")


def influences(varied: Sequence[Axis], kept_axes: Sequence[Axis], front: BoolArray) -> str:
    """Return every kept number over every varied field, the front marked, as SVG."""
    with canvas.drawing():
        figure = canvas.sheet(14.0 + 30.0 * len(kept_axes))
        grid = figure.subplots(
            len(kept_axes), len(varied), squeeze=False, sharex="col", sharey="row"
        )
        for row, result in zip(grid, kept_axes, strict=True):
            for axes, field in zip(row, varied, strict=True):
                axes.plot(field.values, result.values, **_pale(len(front)))
                axes.plot(field.values[front], result.values[front], **_FRONT)
                field.tick(axes)
                canvas.grid_lines(axes, "both")
            row[0].set_ylabel(_wrapped(result.title))
        for axes, field in zip(grid[-1], varied, strict=True):
            axes.set_xlabel(_wrapped(field.title))
        return canvas.svg(figure, "influences", "Each result over each field that is varied")


def trade_offs(goals: Sequence[tuple[Axis, Axis]], front: BoolArray) -> str:
    """Return pairs of goals against each other, the front marked, as SVG."""
    with canvas.drawing():
        figure = canvas.sheet(70.0)
        for axes, (x, y) in zip(
            figure.subplots(1, len(goals), squeeze=False)[0], goals, strict=True
        ):
            axes.plot(x.values, y.values, **_pale(len(front)))
            order = np.flatnonzero(front)[np.argsort(x.values[front])]
            axes.plot(
                x.values[order], y.values[order], **{**_FRONT, "linestyle": "-"}, linewidth=0.6
            )
            axes.set(xlabel=_wrapped(x.title), ylabel=_wrapped(y.title))
            canvas.grid_lines(axes, "both")
        return canvas.svg(figure, "trade-offs", "Goals against each other")


def parallel(axes_of: Sequence[Axis], colour: Axis, front: BoolArray) -> str:
    """Return a line a point over parallel axes, coloured by one of them, as SVG.

    Empty where no point has all quantities.
    """
    import matplotlib as mpl
    from matplotlib.collections import LineCollection

    ranges = [(np.nanmin(axis.values), np.nanmax(axis.values)) for axis in axes_of]
    shares = np.column_stack(
        [
            (axis.values - low) / (high - low) if high > low else np.full(len(axis.values), 0.5)
            for axis, (low, high) in zip(axes_of, ranges, strict=True)
        ]
    )
    complete = np.flatnonzero(np.isfinite(shares).all(axis=1))
    if not len(complete):
        return ""
    rows = complete[:: -(-max(len(complete), 1) // _MOST_LINES)]
    rows = np.concatenate([rows, np.flatnonzero(front)])
    places = np.broadcast_to(np.arange(len(axes_of), dtype=float), (len(rows), len(axes_of)))
    with canvas.drawing():
        figure = canvas.sheet(85.0)
        axes, bar = figure.subplots(1, 2, width_ratios=(60, 1))
        lines: Any = LineCollection(
            np.stack([places, shares[rows]], axis=2).tolist(),
            array=colour.values[rows],
            cmap=mpl.colormaps[palette.COLORMAP],
            linewidths=np.where(front[rows], 1.4, 0.4),
            alpha=0.8,
            rasterized=True,
        )
        axes.add_collection(lines)
        axes.set(xlim=(-0.15, len(axes_of) - 0.85), ylim=(-0.09, 1.06), yticks=[])
        axes.set_xticks(range(len(axes_of)), [_wrapped(axis.title) for axis in axes_of])
        axes.spines["left"].set_visible(False)
        for place, (axis, (low, high)) in enumerate(zip(axes_of, ranges, strict=True)):
            axes.axvline(place, color=palette.INK, linewidth=0.6)
            ends = (
                (axis.labels[0], axis.labels[-1]) if axis.labels else (f"{low:.4g}", f"{high:.4g}")
            )
            for text, at in zip(ends, (-0.05, 1.04), strict=True):
                ground = canvas.paper(0.5, 0.8)
                axes.text(place, at, _shortened(text), ha="center", va="center", bbox=ground)
        figure.colorbar(lines, cax=bar, label=_wrapped(colour.title))
        return canvas.svg(figure, "parallel", "Every point as a line over all quantities")


def _shortened(label: str) -> str:
    return label if len(label) <= _LONGEST_LABEL else f"{label[: _LONGEST_LABEL - 2]}…"


def _wrapped(title: str) -> str:
    """Return a path on several lines, broken at its dots, so that neighbours stand apart."""
    lines = [""]
    for part in title.replace(".", ".\n").split("\n"):
        if len(lines[-1]) + len(part) > 18 and lines[-1]:
            lines.append("")
        lines[-1] += part
    return "\n".join(lines)
