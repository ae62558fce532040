"""The robot in one pose, its cables in their true shape."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from designer.analysis.analyse import PoseAnalysis
from designer.analysis.field import body_lines_m, cable_curves_m, chords_m, largest_sag
from designer.arrays import FloatArray
from designer.model.robot import Robot
from designer.model.verdict import Verdict
from designer.report import format as fmt
from designer.report.figures import canvas, labels, overlay, palette
from designer.report.figures.canvas import Style
from designer.report.figures.stage import Stage
from designer.report.figures.view import View, clear_azimuth_rad, facing_azimuth_rad, fitting
from designer.statics.inverse import Statics

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_ELEVATION_RAD = float(np.radians(25.0))
_FRAME = (0.075, 0.95, 0.13, 0.90)
_LABEL_AT = (0.35, 0.45, 0.28, 0.55, 0.2, 0.65)


def robot_scene(pose: PoseAnalysis) -> bytes:
    """Return a picture of the robot in the configured pose, with its cables sagging, as PNG.

    In a pose that cannot be held the cables are drawn straight.
    """
    statics = pose.sizing.statics
    curves = cable_curves_m(statics) if statics.is_solved else chords_m(statics)
    points = np.concatenate([curves.reshape(-1, 3), statics.robot.exit_points_m])
    bounds = np.array([points.min(axis=0), points.max(axis=0)])
    view = _view(statics, points, bounds)
    stage = Stage(view)
    stage.lines(overlay.floor_lines(view, bounds), palette.FAINT, 1.0)
    _add_robot(stage, statics, curves, bounds[0, 2])
    image = stage.picture()
    with canvas.drawing():
        figure, axes = overlay.over(image)
        overlay.box_axes(axes, view, bounds)
        _label(axes, view, statics, curves)
        return overlay.png(figure)


def _view(statics: Statics, points: FloatArray, bounds: FloatArray) -> View:
    low, high = bounds
    floor = [[x, y, low[2]] for x in (low[0], high[0]) for y in (low[1], high[1])]
    if statics.robot.is_planar:
        azimuth = facing_azimuth_rad(statics.robot.upright[0, :2])
    else:
        base = _base_outline_m(statics.robot)
        lines = np.concatenate([chords_m(statics), np.stack([base[:-1], base[1:]], axis=1)])
        azimuth = clear_azimuth_rad(lines, _ELEVATION_RAD)
    return fitting(np.concatenate([floor, points]), azimuth, _ELEVATION_RAD, _FRAME)


def _add_robot(stage: Stage, statics: Statics, curves: FloatArray, floor_m: float) -> None:
    """Put base, platform and cables on the stage; straight lines for comparison."""
    robot, body = statics.robot, statics.poses.position_m[None]
    tops = np.concatenate([robot.exit_points_m, body])
    size = float(np.ptp(tops, axis=0).max())
    stage.lines(chords_m(statics), palette.MASSLESS, 1.5)
    if statics.is_solved:
        stage.lines(curves, palette.SAG, 7.0, 2.0)
    stage.lines([_base_outline_m(robot)], palette.FAINT, 2.5)
    stage.posts(tops, floor_m, 1.5)
    stage.balls(robot.exit_points_m, 0.006 * size, palette.INK)
    if robot.is_point_mass:
        stage.balls(body, 0.011 * size, palette.INK)
    else:
        stage.hull(statics.poses.attachment_points_m(robot), palette.MASSLESS)


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
    """Write masses, tensions at the exit points and the largest sag beside what they belong to."""
    clear = labels.obstacles(view, [*curves, *body_lines_m(statics)])
    labels.write_exits(axes, view, statics.robot.exit_points_m, clear)
    body = statics.poses.position_m
    x, y, z = (fmt.trimmed(float(v), 6) for v in body)
    text = f"{fmt.trimmed(statics.robot.platform.mass_kg, 6)} kg at ({x}, {y}, {z}) m"
    labels.write_clear(axes, view, body, text, clear, fontweight="bold")
    if not statics.is_solved:
        text = f"No equilibrium in this pose.\n{Verdict(int(statics.verdict)).sentence}"
        axes.text(60, 40, text, va="top", color=palette.WARNING)
        return
    sag = largest_sag(statics)
    top, low = view.pixels(np.stack([sag.on_chord_m, sag.on_cable_m]))
    if np.hypot(*(low - top)) > 12.0:  # as a dimension, from the straight line down to the cable
        arrow = {"arrowstyle": "|-|,widthA=0.25,widthB=0.25", "linewidth": 0.9}
        ends: Style = {"color": palette.INK, "shrinkA": 0.0, "shrinkB": 0.0}
        axes.annotate("", low, top, arrowprops=arrow | ends)
    short = sag.depth_m < 1.0
    length = fmt.millimetres(sag.depth_m) if short else f"{fmt.number(sag.depth_m, 3)} m"
    labels.write_clear(axes, view, sag.on_cable_m, f"sag {length}", clear, (6.0, 18.0, 30.0))
    style = {"color": palette.SAG, "fontsize": palette.FONT_POINTS - 0.5}
    for curve, tension_N in zip(curves, statics.exit_tension_N, strict=True):
        anchors = curve[[int(share * len(curve)) for share in _LABEL_AT]]
        text = fmt.newtons(float(tension_N))
        labels.write_clear(axes, view, anchors, text, clear, (3.0, 6.0), **style)
