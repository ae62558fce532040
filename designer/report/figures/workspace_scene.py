"""The workspace cut open, coloured by what its poses need, as Riehl et al., ICRA 2010, Fig. 8."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from designer.analysis.field import body_lines_m, cable_curves_m
from designer.arrays import FloatArray
from designer.model.region import Prism
from designer.report.figures import canvas, grids, labels, overlay, palette, stage
from designer.report.figures.colours import Steps, steps_for
from designer.report.figures.maps import WorkspaceMaps
from designer.report.figures.quantity import DIAMETER, Quantity
from designer.report.figures.stage import PRINT, Pen
from designer.report.figures.view import Frame, View, facing_azimuth_rad, fitting

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from pyvista import Plotter

_SPECK = 0.2
_ELEVATION_RAD = np.radians(28.0)
_FRAME = (0.085, 0.85, 0.11, 0.93)


def workspace_scene(maps: WorkspaceMaps, quantity: Quantity = DIAMETER) -> bytes:
    """Return a picture of the workspace with exit points and the cables at its worst pose, as PNG.

    Parameters
    ----------
    maps : WorkspaceMaps
        What to draw; a list of points is drawn as balls.
    quantity : Quantity
        What the colours mean.
    """
    steps = scale_of(maps, quantity)
    view = view_of(maps)
    plotter = stage.empty_stage()
    add_workspace(plotter, maps, quantity, steps, view)
    stage.add_lines(plotter, overlay.floor_lines(view, bounds_m(maps)), palette.FAINT, 1.0)
    image = stage.picture(plotter, view)
    with canvas.drawing():
        figure, axes = overlay.over(image)
        overlay.box_axes(axes, view, bounds_m(maps))
        overlay.legend(figure, [*maps.shell.values()] or [maps.section])
        if steps is not None:
            overlay.colour_bar(figure, steps, quantity)
        write_names(axes, view, maps, quantity)
        return overlay.png(figure)


def scale_of(maps: WorkspaceMaps, quantity: Quantity) -> Steps | None:
    """Return the colour scale over all that the scene shows."""
    fields = maps.shell.values() if maps.has_area else (maps.section,)
    return steps_for(np.concatenate([quantity.of(field).ravel() for field in fields]), 18)


def view_of(maps: WorkspaceMaps, frame: Frame = _FRAME) -> View:
    """Return the view into the opening of the region, or of a list of points."""
    low, high = bounds_m(maps)
    floor = [[x, y, low[2]] for x in (low[0], high[0]) for y in (low[1], high[1])]
    top = maps.section.position_m[-1] if maps.has_area else maps.section.position_m
    exits = maps.study.robot.exit_points_m
    shown = exits[np.all((exits >= low) & (exits <= high), axis=1)]
    everything = np.concatenate([floor, top, shown])
    return fitting(everything, _azimuth_rad(maps), float(_ELEVATION_RAD), frame)


def bounds_m(maps: WorkspaceMaps) -> FloatArray:
    """Return the box that is shown (2, 3) [m]: region and exit points.

    A region that would be a speck among the exit points is shown alone.
    """
    region, exits = maps.region.bounds_m, maps.study.robot.exit_points_m
    everything = np.concatenate([region, exits])
    whole = np.array([everything.min(axis=0), everything.max(axis=0)])
    size = float(np.ptp(region, axis=0).max())
    is_speck = maps.has_area and size < _SPECK * float(np.ptp(whole, axis=0).max())
    return region if is_speck else whole


def add_workspace(
    plotter: Plotter,
    maps: WorkspaceMaps,
    quantity: Quantity,
    steps: Steps | None,
    view: View,
    pen: Pen = PRINT,
) -> None:
    """Put region, exit points and cables on the stage."""
    if maps.has_area:
        _add_region(plotter, maps, quantity, steps, view, pen)
    else:
        _add_points(plotter, maps, quantity, steps)
    _add_exit_points(plotter, maps, pen)
    if maps.focus.statics is not None:
        stage.add_cables(plotter, list(cable_curves_m(maps.focus.statics)), view, pen)
        if not maps.study.robot.is_point_mass:
            corners = maps.focus.statics.poses.attachment_points_m(maps.study.robot)
            stage.add_hull(plotter, corners, palette.INK)


def _azimuth_rad(maps: WorkspaceMaps) -> float:
    """Into the opening, but not along an axis, which would then be seen from its end."""
    if maps.region.is_upright:
        return facing_azimuth_rad(maps.region.along)
    if not isinstance(maps.region, Prism):
        return float(np.radians(-60.0))
    azimuth = grids.opening_azimuth_rad(maps.region, maps.focus.position_m)
    off_axis = (azimuth + 0.25 * np.pi) % (0.5 * np.pi) - 0.25 * np.pi
    wanted = np.copysign(max(abs(off_axis), np.radians(15.0)), off_axis)
    return float(azimuth + wanted - off_axis)


def _add_region(
    plotter: Plotter,
    maps: WorkspaceMaps,
    quantity: Quantity,
    steps: Steps | None,
    view: View,
    pen: Pen,
) -> None:
    for field in maps.shell.values():
        stage.add_field(plotter, field, quantity, steps)
        if steps is not None:
            lines = stage.contour_lines(field, quantity, steps)
            lines = [view.nearer(line, pen.lift) for line in lines]
            stage.add_lines(plotter, lines, "white", pen.contour)
    edges = [view.nearer(line, 1.5 * pen.lift) for line in edges_m(maps)]
    stage.add_lines(plotter, edges, palette.INK, pen.edge)


def edges_m(maps: WorkspaceMaps) -> list[FloatArray]:
    """Return the edges of the opened region, each (n, 3) [m]."""
    if maps.region.is_upright:
        return [maps.section.position_m[-1]]
    assert isinstance(maps.region, Prism)
    wall = maps.shell["wall"].position_m
    cuts = [maps.shell[name].position_m for name in ("cut", "other_cut")]
    lines = [wall[0], wall[-1], cuts[0][:, 0]]
    for cut in cuts:
        lines += [cut[0], cut[-1], cut[:, -1]]
    for corner in maps.region.polygon_m:
        at = np.flatnonzero(np.linalg.norm(wall[0, :, :2] - corner, axis=1) < 1e-9)
        lines += [wall[:, index] for index in at[:1]]
    return [np.asarray(line, dtype=np.float64) for line in lines]


def _add_points(
    plotter: Plotter, maps: WorkspaceMaps, quantity: Quantity, steps: Steps | None
) -> None:
    field = maps.section
    values = quantity.of(field)
    if steps is not None:
        stage.add_balls(plotter, field.position_m, values, steps, 0.008 * size_m(maps))
    for failed, colour in (
        (field.is_infeasible, palette.WARNING),
        (field.is_left_out, palette.LEFT_OUT),
    ):
        stage.add_spheres(plotter, field.position_m[failed], colour, 0.007 * size_m(maps))
    feet = field.position_m * [1.0, 1.0, 0.0] + [0.0, 0.0, bounds_m(maps)[0, 2]]
    stage.add_lines(plotter, list(np.stack([field.position_m, feet], axis=1)), palette.FAINT, 1.0)


def _add_exit_points(plotter: Plotter, maps: WorkspaceMaps, pen: Pen) -> None:
    robot, floor = maps.study.robot, bounds_m(maps)[0, 2]
    stage.add_spheres(plotter, robot.exit_points_m, palette.INK, 0.006 * size_m(maps))
    feet = robot.exit_points_m * [1.0, 1.0, 0.0] + [0.0, 0.0, floor]
    posts = list(np.stack([robot.exit_points_m, feet], axis=1))
    stage.add_lines(plotter, posts, palette.FAINT, pen.post)


def size_m(maps: WorkspaceMaps) -> float:
    """Return the longest edge of the box around everything [m]."""
    return float(np.ptp(bounds_m(maps), axis=0).max())


def write_names(axes: Axes, view: View, maps: WorkspaceMaps, quantity: Quantity) -> None:
    """Write what the exit points are called, and what the worst pose needs."""
    focus = maps.focus
    lines: list[FloatArray] = []
    if focus.statics is not None:
        lines = [*cable_curves_m(focus.statics)]
        overlay.hidden_lines(axes, view, lines)
        lines += body_lines_m(focus.statics)
    clear = labels.obstacles(view, lines)
    labels.write_exits(axes, view, maps.study.robot.exit_points_m, clear)
    overlay.mark(axes, view, focus.position_m)
    labels.write_clear(axes, view, focus.position_m, focus.text(quantity), clear, fontweight="bold")
