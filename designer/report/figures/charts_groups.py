"""The robot from above, with the product that each group of cables gets."""

from __future__ import annotations

from itertools import cycle
from typing import TYPE_CHECKING

import numpy as np

from designer.arrays import FloatArray
from designer.model.region import PointList, Prism, Region
from designer.model.robot import Poses, Robot
from designer.report.figures import canvas, palette
from designer.report.figures.names import names_of
from designer.selection.groups.result import Assigned, GroupChoice

if TYPE_CHECKING:
    from matplotlib.axes import Axes

# Okabe and Ito again; vermilion stays a warning.
_COLOURS = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#222222")
_STYLES = ("-", "--", ":")
_THINNEST_PT, _THICKEST_PT = 1.2, 4.2
_REGION = "#EEF1F4"


def groups_plan(robot: Robot, region: Region, choice: GroupChoice, chosen: Assigned) -> str:
    """Return the plan as SVG: cables as thick as their products are to each other.

    The platform stands where the most used group is used most.
    """
    most = int(np.argmax(chosen.verification.utilisation))
    pose = Poses.at(chosen.verification.worst_place[most])
    with canvas.drawing():
        figure = canvas.sheet(104.0, keeps_aspect=True)
        axes = figure.subplots()
        plane = _plane(robot)
        _region(axes, region, plane)
        _cables(axes, robot, pose, choice, chosen)
        _exit_points(axes, robot.exit_points_m[:, plane])
        axes.set_aspect("equal")
        axes.set(xlabel=f"{'xyz'[plane[0]]} [m]", ylabel=f"{'xyz'[plane[1]]} [m]")
        _widen(axes)
        figure.legend(loc="outside right upper", frameon=False, handlelength=2.6)
        return canvas.svg(figure, "groups", "The robot from above with the cables of each group")


def _plane(robot: Robot) -> list[int]:
    """Return the axes to look along the third of: from above, or onto a planar robot's plane."""
    if not robot.is_planar:
        return [0, 1]
    return [int(np.argmax(np.ptp(robot.exit_points_m[:, :2], axis=0))), 2]


def _region(axes: Axes, region: Region, plane: list[int]) -> None:
    label = "where the platform goes"
    if isinstance(region, PointList):
        points = region.points_m[:, plane]
        axes.plot(*points.T, ".", color=palette.FAINT, markersize=2.5, label=label)
        return
    (left, low), (right, high) = region.bounds_m[:, plane]
    corners = np.array([[left, low], [right, low], [right, high], [left, high]])
    if isinstance(region, Prism) and plane == [0, 1]:
        corners = region.polygon_m
    axes.fill(*corners.T, facecolor=_REGION, edgecolor=palette.FAINT, label=label)


def _cables(axes: Axes, robot: Robot, pose: Poses, choice: GroupChoice, chosen: Assigned) -> None:
    ends = pose.attachment_points_m(robot)
    plane = _plane(robot)
    thickest = max(one.size.diameter_m for one in chosen.products)
    styles = cycle([(colour, style) for style in _STYLES for colour in _COLOURS])
    for k, (group, product) in enumerate(zip(choice.groups, chosen.products, strict=True)):
        colour, style = next(styles)
        width = max(_THICKEST_PT * product.size.diameter_m / thickest, _THINNEST_PT)
        label = _label(group.name, k, chosen)
        for cable in group.cables:
            start, end = robot.exit_points_m[cable - 1], ends[cable - 1]
            axes.plot(
                *np.stack([start, end])[:, plane].T, color=colour, linestyle=style, linewidth=width,
                solid_capstyle="round", label=label,
            )  # fmt: skip
            label = ""
    _platform(axes, ends[:, plane])


def _widen(axes: Axes) -> None:
    """Leave the same room on all sides, for the names of the exit points."""
    low, high = np.reshape([axes.get_xlim(), axes.get_ylim()], (2, 2)).T
    room = 0.06 * float((high - low).max())
    axes.set(xlim=(low[0] - room, high[0] + room), ylim=(low[1] - room, high[1] + room))


def _label(name: str, k: int, chosen: Assigned) -> str:
    product, used = chosen.products[k], chosen.verification.utilisation[k]
    return f"{name}: {product.size.id}\n{product.grade.id}\n{100 * used:.1f} % used"


def _platform(axes: Axes, ends_m: FloatArray) -> None:
    label = "platform at the most used cable's worst pose"
    label = label.replace(" at the ", "\nat the ")
    points = np.unique(ends_m.round(9), axis=0)
    if len(points) > 2:
        centre = points.mean(axis=0)
        around = np.argsort(np.arctan2(*(points - centre).T[::-1]))
        axes.fill(*points[around].T, facecolor="white", edgecolor=palette.INK, zorder=4)
    axes.plot(
        *ends_m.mean(axis=0), marker="o", markersize=4.5, color=palette.INK,
        linestyle="none", zorder=5, label=label,
    )  # fmt: skip


def _exit_points(axes: Axes, points: FloatArray) -> None:
    axes.plot(*points.T, "s", color="white", markeredgecolor=palette.INK, markersize=4.5, zorder=5)
    centre = points.mean(axis=0)
    for name, place in names_of(points, 0.05 * float(np.ptp(points, axis=0).max())):
        above = 9.0 if place[1] > centre[1] else -9.0
        axes.annotate(
            name, (place[0], place[1]), (0.0, above), textcoords="offset points",
            ha="center", va="center", path_effects=canvas.halo(), zorder=6,
        )  # fmt: skip
