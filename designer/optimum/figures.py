"""An optimisation in pictures: the robot before and after, the way there, each variable alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from designer.arrays import BoolArray, FloatArray, IntArray
from designer.model.region import Region
from designer.model.robot import Robot
from designer.report.figures import canvas, palette
from designer.report.figures.canvas import Style

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_BEFORE: Style = {"color": palette.MASSLESS, "linewidth": 0.8, "linestyle": canvas.DASHES}
_AFTER: Style = {"color": palette.SAG, "linewidth": 1.2}
_STARTS = (palette.SAG, "#E69F00", "#009E73", "#CC79A7")


@dataclass(frozen=True, slots=True)
class Curve:
    """The objective over one variable: its title, values, the objective, before and after."""

    title: str
    values: FloatArray
    objective: FloatArray
    before: float | None
    after: float


def robots(before: Robot, after: Robot, region: Region | None, where_m: FloatArray) -> str:
    """Return both robots in plan and from the side, the platform at a place (3,) [m], as SVG."""
    views = [(0, 1), (0, 2)]
    if before.is_planar:
        views = [(int(np.argmax(np.ptp(before.exit_points_m[:, :2], axis=0))), 2)]
    with canvas.drawing():
        everything = np.concatenate([before.exit_points_m, after.exit_points_m])
        tallest = max(float(np.ptp(everything[:, v]) / np.ptp(everything[:, u])) for u, v in views)
        figure = canvas.sheet(min(24.0 + 62.0 * max(tallest, 0.4), 110.0))
        for axes, plane in zip(
            figure.subplots(1, len(views), squeeze=False)[0], views, strict=True
        ):
            _view(axes, before, after, region, where_m, list(plane))
        looks: list[tuple[str, Style]] = [
            ("as given", {**_BEFORE, "marker": "^", "markerfacecolor": "white"}),
            ("optimised", {**_AFTER, "marker": "^"}),
        ]
        if region is not None:
            looks.append(("where the platform goes", canvas.REGION))
        canvas.legend(figure, looks, "outside lower center", ncols=3)
        return canvas.svg(figure, "robots", "The robot as given and optimised")


def _view(
    axes: Axes,
    before: Robot,
    after: Robot,
    region: Region | None,
    where_m: FloatArray,
    plane: list[int],
) -> None:
    if region is not None:
        canvas.region(axes, region, plane)
    for robot, look, face in ((before, _BEFORE, "white"), (after, _AFTER, palette.SAG)):
        exits, ends = robot.exit_points_m, where_m + robot.attachments_m
        for a, b in zip(exits, ends, strict=True):
            axes.plot(*np.stack([a, b])[:, plane].T, **look)
        style: Style = {"markersize": 6.0, "markerfacecolor": face, "clip_on": False, "zorder": 4}
        mark = {"marker": "^", "linestyle": "none", "color": look["color"]}
        axes.plot(*exits[:, plane].T, **mark, **style)
    moved = np.linalg.norm((after.exit_points_m - before.exit_points_m)[:, plane], axis=1) > 0.0
    for a, b in zip(before.exit_points_m[moved], after.exit_points_m[moved], strict=True):
        arrow = {"arrowstyle": "->", "color": palette.INK, "shrinkA": 4.0, "shrinkB": 4.0}
        axes.annotate("", b[plane], a[plane], arrowprops=arrow, zorder=5)
    centre = where_m[plane]
    exits_of_both = np.stack([robot.exit_points_m[:, plane] for robot in (before, after)])
    is_outer = np.linalg.norm(exits_of_both[0] - centre, axis=1) > np.linalg.norm(
        exits_of_both[1] - centre, axis=1
    )
    outer = np.where(is_outer[:, None], exits_of_both[0], exits_of_both[1])
    for text, place in canvas.names_of(outer, 0.06 * float(np.ptp(outer, axis=0).max())):
        away = (place - centre) / max(float(np.linalg.norm(place - centre)), 1e-9)
        canvas.note(axes, text, tuple(place), tuple(13.0 * away), ha="center", va="center")
    axes.plot(*where_m[plane], marker="s", markersize=3.5, color=palette.INK, zorder=6)
    axes.set_aspect("equal")
    axes.margins(0.15)
    axes.set(xlabel=f"{'xyz'[plane[0]]} [m]", ylabel=f"{'xyz'[plane[1]]} [m]")


def convergence(
    values: FloatArray, starts: IntArray, holds: BoolArray, before: float | None, title: str
) -> str:
    """Return the objective of every design, and the best so far of each start, as SVG.

    Parameters
    ----------
    values : array (n_designs,)
        Such that less is better, or signed for that by the axis; NaN where there is none.
    starts : array of int (n_designs,)
        Search that each belongs to, from 1; 0 for the last one, about the best of all.
    holds : array of bool (n_designs,)
        Which count.
    before : float or None
        Of the robot as given.
    title : str
        Of the objective, with its unit; begins with a minus where more is better.
    """
    number = np.arange(1, len(values) + 1)
    with canvas.drawing():
        figure = canvas.sheet(72.0)
        axes = figure.subplots()
        axes.plot(number[holds], values[holds], **canvas.DOTS, color=palette.FAINT, markersize=2.0)
        looks: list[tuple[str, Style]] = []
        for start in [k for k in np.unique(starts).tolist() if k] + [0]:
            of_start = (starts == start) & holds
            if not of_start.any():
                continue
            best = np.minimum.accumulate(values[of_start])
            colour = palette.INK if start == 0 else _STARTS[(start - 1) % len(_STARTS)]
            look: Style = {"color": colour, "linewidth": 1.4}
            axes.step(number[of_start], best, where="post", **look)
            looks.append((f"start {start}" if start else "about the best", look))
        if before is not None:
            axes.axhline(before, **_BEFORE)
            looks.append(("as given", _BEFORE))
        looks.append(("a design that holds", {**canvas.DOTS, "color": palette.FAINT}))
        _limit_to_the_better(axes, values[holds], before)
        axes.set(xlabel="design tried", ylabel=title)
        canvas.grid_lines(axes)
        canvas.legend(figure, looks, "outside lower center", ncols=len(looks))
        return canvas.svg(figure, "convergence", "The best design so far over all designs tried")


def _limit_to_the_better(axes: Axes, values: FloatArray, before: float | None) -> None:
    """Show the better half: the worst designs of a first population are of no interest."""
    if not len(values):
        return
    top = max(float(np.quantile(values, 0.8)), float(values.min()) if before is None else before)
    low = float(values.min())
    if top > low:
        axes.set_ylim(low - 0.05 * (top - low), top + 0.08 * (top - low))


def profiles(curves: Sequence[Curve], title: str) -> str:
    """Return the objective over each variable about the optimum, as SVG."""
    columns = min(len(curves), 4)
    rows = -(-len(curves) // columns)
    with canvas.drawing():
        figure = canvas.sheet(8.0 + 46.0 * rows)
        grid = figure.subplots(rows, columns, squeeze=False, sharey=True)
        for axes in grid.ravel()[len(curves) :]:
            axes.set_visible(False)
        for axes, curve in zip(grid.ravel(), curves, strict=False):
            axes.plot(curve.values, curve.objective, "-o", markersize=2.5, **_AFTER)
            for value in curve.values[np.isnan(curve.objective)]:
                axes.axvline(value, color=palette.WARNING, linewidth=0.8, linestyle=":")
            at = int(np.argmin(np.abs(curve.values - curve.after)))
            axes.plot(curve.after, curve.objective[at], markersize=6.0, **canvas.RING)
            if curve.before is not None and curve.values[0] <= curve.before <= curve.values[-1]:
                axes.axvline(curve.before, **_BEFORE)
            axes.set_xlabel(curve.title)
            canvas.grid_lines(axes, "both")
        for row in grid:
            row[0].set_ylabel(title)
        return canvas.svg(figure, "profiles", "The objective over each variable about the optimum")
