"""All sizes that hold, by what they are compared by and by what they are made of.

Those that no other beats have a dark rim.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from designer.arrays import FloatArray
from designer.report.blocks import MOST_ROWS
from designer.report.figures import canvas, palette
from designer.report.material_class import CLASSES, MaterialClass, class_of
from designer.selection.objectives import MEANINGS
from designer.selection.result import Candidate, SelectionResult
from designer.study import Objective

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_ROOM_PX = 14.0
_FEW = 60
_DECADE = 6.0
_THOUSAND = 1e3
_BEATEN: dict[str, Any] = {"markersize": 2.6, "markeredgewidth": 0.0}
_FRONT: dict[str, Any] = {"markersize": 6.0, "markeredgewidth": 0.9, "markeredgecolor": palette.INK}
_CHOSEN: dict[str, Any] = _FRONT | {"markersize": 9.0, "markeredgewidth": 1.8}
_DOTS: dict[str, Any] = {"linestyle": "none"}


@dataclass(frozen=True, slots=True)
class _Along:
    """What runs along an axis: its name with the unit, and from SI to that unit."""

    objective: Objective
    label: str
    scale: float


def pareto_chart(selection: SelectionResult) -> str | None:
    """Return the first objective over each of the others, a panel each, as SVG.

    None where there is one objective only, or nothing holds.
    """
    first, *others = selection.objectives
    if not others or not selection.front:
        return None
    up = _along(first, selection)
    with canvas.drawing():
        figure = canvas.sheet(82.0)
        panels = figure.subplots(1, len(others), sharey=True, squeeze=False)[0]
        for axes, other in zip(panels, others, strict=True):
            _panel(axes, selection, _along(other, selection), up)
        panels[0].set_title(up.label, loc="left")
        _legend(panels[0], selection)
        return canvas.svg(figure, "pareto", "Sizes that hold, by what they are compared by")


def _panel(axes: Axes, selection: SelectionResult, across: _Along, up: _Along) -> None:
    holding = [c for c in selection.candidates if c.verification.holds]
    front = list(selection.front)
    size = _BEATEN["markersize"] * (1.5 if len(holding) < _FEW else 1.0)
    for some, style in (
        ([c for c in holding if c not in front], _BEATEN | {"markersize": size}),
        (front[1:], _FRONT),
        (front[:1], _CHOSEN),
    ):
        for kind in CLASSES:
            points = _points([c for c in some if class_of(c.grade) == kind], across, up)
            axes.plot(*points.T, **_DOTS, **_look(kind), **style)
    axes.set_xlabel(across.label)
    _scales(axes, [*_points(holding, across, up).T])
    if len(front) > 1:
        _number(axes, front, across, up)


def _number(axes: Axes, front: list[Candidate], across: _Along, up: _Along) -> None:
    """Write the row of the table beside each point, as far as there is room."""
    taken: list[FloatArray] = []
    for number, candidate in enumerate(front[:MOST_ROWS], start=1):
        for point in _points([candidate], across, up):
            place = axes.transData.transform(point)
            if any(np.hypot(*(place - other)) < _ROOM_PX for other in taken):
                continue
            taken.append(place)
            label = axes.annotate(
                f"{number}", (point[0], point[1]), (-5, 5), textcoords="offset points",
                ha="right", fontweight="bold",
            )  # fmt: skip
            label.set_path_effects(canvas.halo())


def _points(candidates: list[Candidate], across: _Along, up: _Along) -> FloatArray:
    values = [[c.figures.value(one.objective) for one in (across, up)] for c in candidates]
    points = np.array(values, dtype=np.float64).reshape(-1, 2) * [across.scale, up.scale]
    return points[np.isfinite(points).all(axis=1) & (points > 0.0).all(axis=1)]


def _along(objective: Objective, selection: SelectionResult) -> _Along:
    """Return an axis, of forces and stiffnesses in thousands where all are that large."""
    meaning = MEANINGS[objective]
    unit, scale = meaning.unit or selection.currency or "", 1.0
    values = [c.figures.value(objective) for c in selection.candidates if c.verification.holds]
    if unit.startswith("N") and min(values, default=0.0) >= _THOUSAND:
        unit, scale = f"k{unit}", 1.0 / _THOUSAND
    return _Along(objective, f"{meaning.title} [{unit}]" if unit else meaning.title, scale)


def _scales(axes: Axes, values: list[FloatArray]) -> None:
    """Make an axis logarithmic where its values span decades."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    for axis, which, along in zip((axes.xaxis, axes.yaxis), "xy", values, strict=True):
        span = float(along.max() / along.min()) if len(along) else 1.0
        if span > _DECADE:
            axes.set(**{f"{which}scale": "log"})
            subs = (1.0,) if span > 30.0 else (1.0, 2.0, 5.0)
            axis.set_major_locator(LogLocator(subs=subs))
            axis.set_minor_formatter(NullFormatter())
        axis.set_major_formatter(FuncFormatter(lambda value, _: canvas.number(float(value))))
    axes.margins(0.08)
    axes.grid(color=palette.FAINT, linewidth=0.4, alpha=0.6)
    axes.set_axisbelow(True)


def _look(kind: MaterialClass) -> dict[str, Any]:
    return {"color": palette.CLASS_COLOURS[kind], "marker": palette.CLASS_MARKERS[kind]}


def _legend(axes: Axes, selection: SelectionResult) -> None:
    from matplotlib.lines import Line2D

    there = {class_of(c.grade) for c in selection.candidates if c.verification.holds}
    chosen = _look(class_of(selection.front[0].grade))
    any_one = {"marker": "o", "color": "white"}
    entries = [
        Line2D([], [], label=label, **_DOTS, **style)
        for label, style in (
            *(
                (kind, _BEATEN | _look(kind) | {"markersize": 5.0})
                for kind in CLASSES
                if kind in there
            ),
            ("chosen", _CHOSEN | chosen),
            *([("no other beats it", _FRONT | any_one)] if len(selection.front) > 1 else []),
        )
    ]
    axes.figure.legend(
        handles=entries, loc="outside upper center", ncols=len(entries), frameon=False
    )
