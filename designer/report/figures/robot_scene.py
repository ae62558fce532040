"""The robot in one pose, its cables in their true shape."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from designer.analysis.analyse import PoseAnalysis
from designer.analysis.field import (
    Sag,
    body_lines_m,
    cable_curves_m,
    chords_m,
    largest_sag,
)
from designer.arrays import FloatArray
from designer.model.robot import Robot
from designer.model.verdict import Verdict
from designer.report import format as fmt
from designer.report.figures import canvas, labels, overlay, palette, stage
from designer.report.figures.view import View, clear_azimuth_rad, facing_azimuth_rad, fitting
from designer.statics.inverse import Statics

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from pyvista import Plotter

_ELEVATION_RAD = float(np.radians(25.0))
_FRAME = (0.075, 0.95, 0.13, 0.90)
_LABEL_AT = (0.35, 0.45, 0.28, 0.55, 0.2, 0.65)


def robot_scene(pose: PoseAnalysis) -> bytes:
    """Return a picture of the robot in the configured pose, with its cables sagging, as PNG.

    Parameters
    ----------
    pose : PoseAnalysis
        Solved or not; in a pose that cannot be held the cables are drawn straight.
    """
    statics = pose.sizing.statics
    curves = cable_curves_m(statics) if statics.is_solved else chords_m(statics)
    bounds = _bounds_m(statics, curves)
    view = _view(statics, curves, bounds)
    plotter = stage.empty_stage()
    stage.add_lines(plotter, overlay.floor_lines(view, bounds), palette.FAINT, 1.0)
    add_robot(plotter, statics, view)
    image = stage.picture(plotter, view)
    with canvas.drawing():
        figure, axes = overlay.over(image)
        overlay.box_axes(axes, view, bounds)
        _label(axes, view, statics, curves)
        return overlay.png(figure)


def add_robot(plotter: Plotter, statics: Statics, view: View) -> None:
    """Put base, platform and cables on the stage; straight lines for comparison."""
    robot = statics.robot
    curves = cable_curves_m(statics) if statics.is_solved else chords_m(statics)
    size = _size_m(statics)
    floor = _bounds_m(statics, curves)[0, 2]
    stage.add_lines(plotter, list(chords_m(statics)), palette.MASSLESS, 1.5)
    if statics.is_solved:
        stage.add_lines(plotter, [view.nearer(c, 2.0) for c in curves], palette.SAG, 7.0)
    stage.add_lines(plotter, [_base_outline_m(robot)], palette.FAINT, 2.5)
    tops = np.concatenate([robot.exit_points_m, statics.poses.position_m[None]])
    feet = tops * [1.0, 1.0, 0.0] + [0.0, 0.0, floor]
    stage.add_lines(plotter, list(np.stack([tops, feet], axis=1)), palette.FAINT, 1.5)
    stage.add_spheres(plotter, robot.exit_points_m, palette.INK, 0.006 * size)
    if robot.is_point_mass:
        stage.add_spheres(plotter, statics.poses.position_m[None], palette.INK, 0.011 * size)
    else:
        stage.add_hull(plotter, statics.poses.attachment_points_m(robot), palette.MASSLESS)


def _bounds_m(statics: Statics, curves: FloatArray) -> FloatArray:
    """Box around exit points, cables and platform (2, 3) [m]."""
    points = np.concatenate([curves.reshape(-1, 3), statics.robot.exit_points_m])
    return np.array([points.min(axis=0), points.max(axis=0)])


def _view(statics: Statics, curves: FloatArray, bounds: FloatArray) -> View:
    low, high = bounds
    floor = [[x, y, low[2]] for x in (low[0], high[0]) for y in (low[1], high[1])]
    base = _base_outline_m(statics.robot)
    lines = np.concatenate([chords_m(statics), np.stack([base[:-1], base[1:]], axis=1)])
    if statics.robot.is_planar:
        azimuth = facing_azimuth_rad(statics.robot.upright[0, :2])
    else:
        azimuth = clear_azimuth_rad(lines, _ELEVATION_RAD)
    everything = np.concatenate([floor, curves.reshape(-1, 3), statics.robot.exit_points_m])
    return fitting(everything, azimuth, _ELEVATION_RAD, _FRAME)


def _size_m(statics: Statics) -> float:
    ends = np.concatenate([statics.robot.exit_points_m, statics.poses.position_m[None]])
    return float(np.ptp(ends, axis=0).max())


def _base_outline_m(robot: Robot) -> FloatArray:
    """Exit points on the hull in plan, in order, the first one again at the end (n, 3) [m].

    In the plane of a planar robot; where the points lie on a line, all of them in their order.
    """
    from scipy.spatial import ConvexHull, QhullError

    points = robot.exit_points_m
    flat = (points @ robot.upright.T)[:, [0, 2]] if robot.is_planar else points[:, :2]
    try:
        corners = ConvexHull(flat).vertices
    except QhullError:
        return points
    return np.asarray(points[[*corners, corners[0]]])


def _label(axes: Axes, view: View, statics: Statics, curves: FloatArray) -> None:
    clear = labels.obstacles(view, [*curves, *body_lines_m(statics)])
    labels.write_exits(axes, view, statics.robot.exit_points_m, clear)
    x, y, z = (canvas.number(float(v)) for v in statics.poses.position_m)
    text = f"{canvas.number(statics.robot.platform.mass_kg)} kg at ({x}, {y}, {z}) m"
    body = statics.poses.position_m
    labels.write_clear(axes, view, body, text, clear, fontweight="bold")
    if not statics.is_solved:
        sentence = Verdict(int(statics.verdict)).sentence
        axes.text(
            60, 40, f"No equilibrium in this pose.\n{sentence}", va="top", color=palette.WARNING
        )
        return
    _label_sag(axes, view, largest_sag(statics), clear)
    for curve, tension_N in zip(curves, statics.exit_tension_N, strict=True):
        _label_tension(axes, view, curve, float(tension_N), clear)


def _label_tension(
    axes: Axes, view: View, curve: FloatArray, tension_N: float, clear: FloatArray
) -> None:
    """Write the tension of a cable at the exit point beside it, where there is room."""
    anchors = curve[[int(share * len(curve)) for share in _LABEL_AT]]
    text = fmt.newtons(tension_N)
    style = {"color": palette.SAG, "fontsize": palette.FONT_POINTS - 0.5}
    labels.write_clear(axes, view, anchors, text, clear, (3.0, 6.0), **style)


def _label_sag(axes: Axes, view: View, sag: Sag, clear: FloatArray) -> None:
    """Draw the largest sag as a dimension: from the straight line down to the cable."""
    ends = view.pixels(np.stack([sag.on_chord_m, sag.on_cable_m]))
    if np.hypot(*(ends[1] - ends[0])) > 12.0:
        style = {"arrowstyle": "|-|,widthA=0.25,widthB=0.25", "linewidth": 0.9}
        axes.annotate(
            "",
            ends[1],
            ends[0],
            arrowprops={**style, "color": palette.INK, "shrinkA": 0.0, "shrinkB": 0.0},
        )
    length = f"{canvas.significant(sag.depth_m, 3)} m"
    if sag.depth_m < 1.0:
        length = f"{canvas.significant(1e3 * sag.depth_m, 3)} mm"
    labels.write_clear(axes, view, sag.on_cable_m, f"sag {length}", clear, (6.0, 18.0, 30.0))
