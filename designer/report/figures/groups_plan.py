"""The robot from above, with the product that each group of cables gets."""

from __future__ import annotations

from itertools import cycle, product
from typing import TYPE_CHECKING

import numpy as np

from designer.arrays import FloatArray
from designer.model.region import Region
from designer.model.robot import Poses, Robot
from designer.report.figures import canvas, palette
from designer.report.figures.canvas import Style
from designer.report.figures.sections import set_limits
from designer.selection.assignment import Assignment

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def groups_plan(robot: Robot, region: Region, assignment: Assignment) -> str:
    """Return the plan as SVG: cables as thick as their products are to each other.

    The platform stands where the most used group is used most. A planar robot is seen from the
    side.
    """
    verification = assignment.verification
    ends = Poses.at(verification.worst_place[verification.most_used]).attachment_points_m(robot)
    exits, plane = robot.exit_points_m, [0, 1]
    if robot.is_planar:
        plane = [int(np.argmax(np.ptp(exits[:, :2], axis=0))), 2]
    thickest = max(one.size.diameter_m for one in assignment.ropes)
    # Okabe and Ito again; vermilion stays a warning.
    palette_of_groups = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#222222")
    looks = cycle(product(("-", "--", ":"), palette_of_groups))
    used = verification.utilisation
    with canvas.drawing():
        figure = canvas.sheet(104.0)
        axes = figure.subplots()
        canvas.region(axes, region, plane, "where the platform goes")
        for group, rope, share in zip(assignment.groups, assignment.ropes, used, strict=True):
            style, colour = next(looks)
            label = f"{group.name}: {rope.size.id}\n{rope.grade.id}\n{100 * share:.1f} % used"
            width = max(4.2 * rope.size.diameter_m / thickest, 1.2)
            for cable in group.cables:
                line = np.stack([exits[cable - 1], ends[cable - 1]])[:, plane]
                look: Style = {"color": colour, "linestyle": style, "linewidth": width}
                axes.plot(*line.T, solid_capstyle="round", label=label, **look)
                label = ""
        _platform(axes, ends[:, plane])
        set_limits(axes, np.concatenate([exits, region.bounds_m])[:, plane], exits[:, plane])
        axes.set(xlabel=f"{'xyz'[plane[0]]} [m]", ylabel=f"{'xyz'[plane[1]]} [m]")
        legend = figure.legend(loc="outside right upper", handlelength=2.6)
        canvas.beside(figure, legend, "right")
        return canvas.svg(figure, "groups", "The robot from above with the cables of each group")


def _platform(axes: Axes, ends_m: FloatArray) -> None:
    points = np.unique(ends_m.round(9), axis=0)
    if len(points) > 2:
        centre = points.mean(axis=0)
        around = np.argsort(np.arctan2(*(points - centre).T[::-1]))
        axes.fill(*points[around].T, facecolor="white", edgecolor=palette.INK, zorder=4)
    style: Style = {"markersize": 4.5, "color": palette.INK, "zorder": 5}
    label = "platform\nat the most used cable's worst pose"
    axes.plot(*ends_m.mean(axis=0), **canvas.DOTS, **style, label=label)
