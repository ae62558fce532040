"""The workspace cut open, coloured by what its poses need, as Riehl et al., ICRA 2010, Fig. 8."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from designer.analysis import grids
from designer.analysis.field import body_lines_m, cable_curves_m
from designer.analysis.maps import WorkspaceMaps
from designer.arrays import FloatArray
from designer.model.region import Prism, Rectangle
from designer.report.figures import canvas, labels, overlay, palette
from designer.report.figures.canvas import Style
from designer.report.figures.colours import Steps, steps_for
from designer.report.figures.map_quantity import DIAMETER, MapQuantity
from designer.report.figures.stage import Stage
from designer.report.figures.view import Frame, View, facing_azimuth_rad, fitting

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_SPECK = 0.2
_ELEVATION_RAD = float(np.radians(28.0))
_FRAME, _COVER_FRAME = (0.085, 0.85, 0.11, 0.93), (0.03, 0.78, 0.06, 0.90)
_BAR, _COVER_BAR = (0.895, 0.2, 0.016, 0.6), (0.83, 0.12, 0.028, 0.7)
_COVER_LETTERS = 1.9


def workspace_scene(
    maps: WorkspaceMaps, quantity: MapQuantity = DIAMETER, *, is_cover: bool = False
) -> bytes:
    """Return a picture of the workspace with exit points and the cables at its worst pose, as PNG.

    Parameters
    ----------
    maps : WorkspaceMaps
        What to draw; a list of points is drawn as balls.
    quantity : MapQuantity
        What the colours mean.
    is_cover : bool
        Whether it is for the first page: small in print, so with large letters and no axes.
    """
    from matplotlib.patches import Patch

    steps = scale_of(maps, quantity)
    view = view_of(maps, _COVER_FRAME if is_cover else _FRAME)
    stage = Stage(view)
    add_workspace(stage, maps, quantity, steps)
    stage.lines(overlay.floor_lines(view, bounds_m(maps)), palette.FAINT, 1.0)
    image = stage.picture()
    with canvas.drawing():
        figure, axes = overlay.over(image, _COVER_LETTERS if is_cover else 1.0)
        if not is_cover:
            overlay.box_axes(axes, view, bounds_m(maps))
        entries: list[Any] = [
            Patch(facecolor=colour, label=text) for colour, text in overlay.meanings(maps.shown)
        ]
        canvas.legend(figure, entries, "lower left", ncols=2)
        if steps is not None:
            bar = figure.add_axes(_COVER_BAR if is_cover else _BAR)
            steps.bar(figure, quantity.label, cax=bar)
        _write_names(axes, view, maps, quantity)
        return overlay.png(figure)


def cover_scene(maps: WorkspaceMaps) -> bytes:
    """Return the picture as it is printed on the first page, as PNG."""
    return workspace_scene(maps, is_cover=True)


def scale_of(maps: WorkspaceMaps, quantity: MapQuantity) -> Steps | None:
    """Return the colour scale over all that the scene shows."""
    return steps_for(np.concatenate([quantity.of(field).ravel() for field in maps.shown]), 18)


def view_of(maps: WorkspaceMaps, frame: Frame = _FRAME) -> View:
    """Return the view into the opening of the region, or of a list of points."""
    low, high = bounds_m(maps)
    floor = [[x, y, low[2]] for x in (low[0], high[0]) for y in (low[1], high[1])]
    top = maps.section.position_m[-1] if maps.has_area else maps.section.position_m
    exits = maps.study.robot.exit_points_m
    shown = exits[np.all((exits >= low) & (exits <= high), axis=1)]
    everything = np.concatenate([floor, top, shown])
    return fitting(everything, _azimuth_rad(maps), _ELEVATION_RAD, frame)


def _azimuth_rad(maps: WorkspaceMaps) -> float:
    """Into the opening, but not along an axis, which would then be seen from its end."""
    if isinstance(maps.region, Rectangle):
        return facing_azimuth_rad(maps.region.along)
    if not isinstance(maps.region, Prism):
        return float(np.radians(-60.0))
    azimuth = grids.opening_azimuth_rad(maps.region, maps.focus.position_m)
    off_axis = (azimuth + 0.25 * np.pi) % (0.5 * np.pi) - 0.25 * np.pi
    wanted = np.copysign(max(abs(off_axis), np.radians(15.0)), off_axis)
    return float(azimuth + wanted - off_axis)


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


def size_m(maps: WorkspaceMaps) -> float:
    """Return the longest edge of the box around everything [m]."""
    return float(np.ptp(bounds_m(maps), axis=0).max())


def add_workspace(
    stage: Stage, maps: WorkspaceMaps, quantity: MapQuantity, steps: Steps | None
) -> None:
    """Put region, exit points and cables on the stage."""
    robot, size, floor = maps.study.robot, size_m(maps), bounds_m(maps)[0, 2]
    if maps.has_area:
        for field in maps.shell.values():
            stage.field(field, quantity, steps)
        stage.lines(edges_m(maps), palette.INK, stage.pen.edge, 1.5)
    else:
        position, section = maps.section.position_m, maps.section
        values = quantity.of(section)
        if steps is not None:
            some = np.isfinite(values)
            colours = steps.colormap(steps.norm(values[some]), bytes=True)[:, :3]
            stage.balls(position[some], 0.008 * size, colours)
        stage.balls(position[section.is_infeasible], 0.007 * size, palette.WARNING)
        stage.balls(position[section.is_left_out], 0.007 * size, palette.LEFT_OUT)
        stage.posts(position, floor, 1.0)
    stage.balls(robot.exit_points_m, 0.006 * size, palette.INK)
    stage.posts(robot.exit_points_m, floor, stage.pen.post)
    statics = maps.focus.statics
    if statics is not None:
        stage.cables(cable_curves_m(statics))
        if not robot.is_point_mass:
            stage.hull(statics.poses.attachment_points_m(robot), palette.INK)


def edges_m(maps: WorkspaceMaps) -> list[FloatArray]:
    """Return the edges of the opened region, each (n, 3) [m]."""
    if isinstance(maps.region, Rectangle):
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


def _write_names(axes: Axes, view: View, maps: WorkspaceMaps, quantity: MapQuantity) -> None:
    """Write what the exit points are called, and what the worst pose needs."""
    focus = maps.focus
    lines: list[FloatArray] = []
    if focus.statics is not None:
        lines = [*cable_curves_m(focus.statics)]
        faint: Style = {
            "color": palette.INK,
            "linewidth": 0.6,
            "linestyle": (0, (2, 2)),
            "alpha": 0.6,
        }
        for line in lines:  # over everything, so that what lies behind a surface can be guessed
            axes.plot(*view.pixels(line).T, linestyle=(0, (2, 2)), **faint)
        lines += body_lines_m(focus.statics)
    clear = labels.obstacles(view, lines)
    labels.write_exits(axes, view, maps.study.robot.exit_points_m, clear)
    axes.plot(*view.pixels(focus.position_m), **canvas.RING, markersize=5.5)
    text = quantity.text_of(focus)
    labels.write_clear(axes, view, focus.position_m, text, clear, fontweight="bold")
