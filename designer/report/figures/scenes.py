"""Scenes in space: the robot in one pose, the workspace cut open, the layers that sizes serve.

The workspace is coloured by what its poses need, as in Riehl et al., ICRA 2010, Fig. 8.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from designer.analysis.maps import (
    Layers,
    WorkspaceMaps,
    body_lines_m,
    cable_curves_m,
    chords_m,
    largest_sag,
    layers_of,
)
from designer.arrays import FloatArray
from designer.model.verdict import Verdict
from designer.report import format as fmt
from designer.report.figures import canvas, overlay, palette
from designer.report.figures.canvas import Style
from designer.report.figures.colours import DIAMETER, MapQuantity, Steps, steps_for
from designer.report.figures.parts import base_outline_m, floor_corners, grid_faces
from designer.report.figures.stage import BORDER_OPACITY, PRINT, Image, Pen, SceneCanvas
from designer.report.figures.view import (
    Frame,
    View,
    clear_azimuth_rad,
    facing_azimuth_rad,
    fitting,
)
from designer.selection.result import SizeCoverage
from designer.statics.inverse import Statics

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_ROBOT_ELEVATION_RAD = float(np.radians(25.0))
_ARROW, _SMALL_LOAD = 0.22, 0.02
"""Length of the largest load's arrow over half the picture; a load too small to be drawn."""


@dataclass(frozen=True, slots=True)
class _Look:
    """Where scene and colour bar stand in the picture, and the size of letters over the usual."""

    frame: Frame
    bar: tuple[float, float, float, float]
    letters: float = 1.0


_PAGE = _Look((0.085, 0.85, 0.11, 0.93), (0.895, 0.2, 0.016, 0.6))
_COVER = _Look((0.03, 0.78, 0.06, 0.90), (0.83, 0.12, 0.028, 0.7), 1.9)


def robot_scene(
    statics: Statics, most_used: int | None = None, loads: Sequence[tuple[str, FloatArray]] = ()
) -> Image:
    """Return a picture of the robot in one pose (no axes), with its cables sagging.

    In a pose that cannot be held the cables are drawn straight. The cable ``most_used``, from 0,
    is marked, and ``loads`` (3,) on the platform are drawn as arrows [N].
    """
    stage, bounds, curves = robot_stage(statics, most_used)
    with canvas.drawing():
        figure, axes = _taken(stage, bounds)
        arrows = _draw_loads(axes, stage.view, statics.poses.position_m, loads)
        _label_robot(axes, stage.view, statics, curves, arrows)
        return overlay.finished(figure)


def robot_stage(
    statics: Statics, most_used: int | None = None, pen: Pen = PRINT
) -> tuple[SceneCanvas, FloatArray, FloatArray]:
    """Return the robot in one pose on a stage, the box around it (2, 3), the cables' curves [m]."""
    robot, body = statics.robot, statics.poses.position_m[None]
    curves = cable_curves_m(statics) if statics.is_solved else chords_m(statics)
    points = np.concatenate([curves.reshape(-1, 3), robot.exit_points_m])
    bounds = np.array([points.min(axis=0), points.max(axis=0)])
    base, tops = base_outline_m(robot), np.concatenate([robot.exit_points_m, body])
    if robot.is_planar:
        azimuth = facing_azimuth_rad(robot.upright[0, :2])
    else:
        lines = np.concatenate([chords_m(statics), np.stack([base[:-1], base[1:]], axis=1)])
        azimuth = clear_azimuth_rad(lines, _ROBOT_ELEVATION_RAD)
    everything = np.concatenate([floor_corners(bounds), points])
    view = fitting(everything, azimuth, _ROBOT_ELEVATION_RAD, (0.075, 0.95, 0.13, 0.90))
    stage = SceneCanvas(view, pen)
    stage.lines(chords_m(statics), palette.MASSLESS, 1.5)  # for comparison
    if statics.is_solved:
        stage.lines(curves, palette.SAG, 7.0, 2.0)
    if most_used is not None:
        stage.lines(curves[most_used][None], palette.WARNING, 10.0, 3.0)
    stage.lines([base], palette.FAINT, 2.5)
    stage.posts(tops, bounds[0, 2], 1.5)
    size = float(np.ptp(tops, axis=0).max())
    stage.balls(robot.exit_points_m, 0.006 * size, palette.INK)
    if robot.is_point_mass:
        stage.balls(body, 0.011 * size, palette.INK)
    stage.hull(statics.poses.attachment_points_m(robot), palette.MASSLESS)
    return stage, bounds, curves


def _draw_loads(
    axes: Axes, view: View, at_m: FloatArray, loads: Sequence[tuple[str, FloatArray]]
) -> list[FloatArray]:
    """Draw forces as arrows from a point, the largest of one length; return the lines [m]."""
    largest = max((float(np.linalg.norm(force)) for _, force in loads), default=0.0)
    lines = []
    for name, force in loads:
        size = float(np.linalg.norm(force))
        if size < _SMALL_LOAD * largest or largest == 0.0:
            continue
        way = force / largest * _ARROW * view.half_height_m
        tip = at_m + way
        start, end = view.pixels(np.stack([at_m, tip]))
        arrow: Style = {"arrowstyle": "-|>", "color": palette.INK, "linewidth": 1.3}
        axes.annotate("", end, start, arrowprops=arrow | {"shrinkA": 0.0, "shrinkB": 0.0})
        axes.annotate(
            f"{name} {fmt.newtons(size)}", end, (4, -4), textcoords="offset points", va="top",
            fontsize=palette.FONT_POINTS - 0.5, path_effects=canvas.halo(),
        )  # fmt: skip
        lines.append(np.linspace(at_m, tip, 12))
    return lines


def _taken(stage: SceneCanvas, bounds: FloatArray, letters: float = 1.0) -> tuple[Figure, Axes]:
    """The picture of a stage with its floor; with axes unless letters are large."""
    stage.lines(overlay.floor_lines(stage.view, bounds), palette.FAINT, 1.0)
    figure, axes = overlay.over(stage.picture(), letters)
    if letters == 1.0:
        overlay.box_axes(axes, stage.view, bounds)
    return figure, axes


def _label_robot(
    axes: Axes, view: View, statics: Statics, curves: FloatArray, lines: Sequence[FloatArray]
) -> None:
    """Write mass, largest sag and tensions at the exit points beside what they belong to."""
    clear = overlay.obstacles(view, [*curves, *body_lines_m(statics), *lines])
    overlay.write_exits(axes, view, statics.robot.exit_points_m, clear)
    body = statics.poses.position_m
    x, y, z = (fmt.trimmed(round(float(v), 2), 5) for v in body)
    text = f"{fmt.trimmed(statics.robot.platform.mass_kg, 5)} kg at ({x}, {y}, {z}) m"
    overlay.write_clear(axes, view, body, text, clear, fontweight="bold")
    if not statics.is_solved:
        text = f"No equilibrium in this pose.\n{Verdict(int(statics.verdict)).sentence}"
        axes.text(60, 40, text, va="top", color=palette.WARNING)
        return
    sag = largest_sag(statics)
    top, low = view.pixels(np.stack([sag.on_chord_m, sag.on_cable_m]))
    if np.hypot(*(low - top)) > 12.0:  # as a dimension, from the straight line to the cable
        arrow: Style = {"arrowstyle": "|-|,widthA=0.25,widthB=0.25", "linewidth": 0.9}
        ends: Style = {"color": palette.INK, "shrinkA": 0.0, "shrinkB": 0.0}
        axes.annotate("", low, top, arrowprops=arrow | ends)
    short = sag.depth_m < 1.0
    length = fmt.millimetres(sag.depth_m) if short else f"{canvas.significant(sag.depth_m, 3)} m"
    overlay.write_clear(axes, view, sag.on_cable_m, f"sag {length}", clear, (6.0, 18.0, 30.0))
    style: Style = {"color": palette.SAG, "fontsize": palette.FONT_POINTS - 0.5}
    for curve, tension_N in zip(curves, statics.exit_tension_N, strict=True):
        along = (0.35, 0.45, 0.28, 0.55, 0.2, 0.65)  # where it may stand, the best first
        anchors = curve[[int(share * len(curve)) for share in along]]
        text = fmt.newtons(float(tension_N))
        overlay.write_clear(axes, view, anchors, text, clear, (3.0, 6.0), **style)


def workspace_scene(
    maps: WorkspaceMaps, quantity: MapQuantity = DIAMETER, look: _Look = _PAGE
) -> Image:
    """Return a picture of the workspace with exit points and the cables at its worst pose.

    A list of points is drawn as balls.
    """
    steps = scale_of(maps, quantity)
    stage = SceneCanvas(view_of(maps, look.frame))
    add_workspace(stage, maps, quantity, steps)
    border_m = maps.impossible_m if look is _PAGE else maps.impossible_m[:0]
    stage.border(border_m)
    with canvas.drawing():
        figure, axes = _taken(stage, bounds_m(maps), look.letters)
        looks: list[tuple[str, Style]] = [
            (text, {"facecolor": colour}) for colour, text in overlay.meanings(maps.shown)
        ]
        looks += [
            (text, {"facecolor": colour, "alpha": BORDER_OPACITY})
            for colour, text in overlay.proved(border_m)
        ]
        canvas.legend(figure, looks, "lower left", ncols=2)
        if steps is not None:
            steps.bar(figure.add_axes(look.bar), quantity.label)
        _write_names(axes, stage.view, maps, quantity)
        return overlay.finished(figure)


def cover_scene(maps: WorkspaceMaps, quantity: MapQuantity = DIAMETER) -> Image:
    """Return the same for the first page: small in print, so with large letters and no axes."""
    return workspace_scene(maps, quantity, _COVER)


def usable_scene(maps: WorkspaceMaps, usable: SizeCoverage) -> Image | None:
    """Return a picture of the opened region, each part in the colour of its thinnest size.

    None for a list of points, and where no size serves a part only.
    """
    import pyvista

    layers = layers_of(maps, usable)
    if layers is None:
        return None
    exits, stage = maps.study.robot.exit_points_m, SceneCanvas(view_of(maps))
    starts = np.cumsum([0, *(grid[..., 0].size for grid in layers.grids_m[:-1])])
    grids = zip(layers.grids_m, starts, strict=True)
    faces = [grid_faces(*grid.shape[:2]) + start for grid, start in grids]
    rest: Any = pyvista.PolyData.from_regular_faces(layers.position_m, np.concatenate(faces))
    for number, used in enumerate(layers.utilisation):
        # In the logarithm the boundary lies between two points where it does in the utilisation.
        rest[f"size {number}"] = np.log(used)
    for number, colour in enumerate(colours(layers)):  # what it serves beyond the size before it
        if rest.n_points == 0:  # the sizes before it serve all that is drawn
            break
        scalar: Style = {"scalars": f"size {number}", "value": 0.0}
        stage.add(rest.clip_scalar(**scalar, invert=True), colour)
        rest = rest.clip_scalar(**scalar, invert=False)
    stage.add(rest, palette.WARNING_PALE)
    stage.lines(edges_m(maps), palette.INK, stage.pen.edge, 1.5)
    stage.balls(exits, 0.006 * size_m(maps), palette.INK)
    with canvas.drawing():
        figure, axes = _taken(stage, bounds_m(maps))
        _layers_legend(figure, layers, usable)
        overlay.write_exits(axes, stage.view, exits, np.empty((0, 2)))
        return overlay.finished(figure)


def colours(layers: Layers) -> list[tuple[float, ...]]:
    """Return a colour for each size, dark for the thinnest."""
    import matplotlib

    table = matplotlib.colormaps[palette.COLORMAP]
    return [tuple(table(share)[:3]) for share in np.linspace(0.1, 0.95, len(layers.sizes))]


def _layers_legend(figure: Figure, layers: Layers, usable: SizeCoverage) -> None:
    looks: list[tuple[str, Style]] = []
    for one, colour in zip(layers.sizes, colours(layers), strict=True):
        share = "all" if one.fraction == 1.0 else f"{canvas.significant(100.0 * one.fraction, 2)} %"
        looks.append((f"{one.size.id}, {share}", {"facecolor": colour}))
    if all(one.fraction < 1.0 for one in layers.sizes):
        looks.append(("none of these", {"facecolor": palette.WARNING_PALE}))
    title = "served from\nthis size on" if usable.is_nested else "thinnest size\nthat serves"
    size = palette.FONT_POINTS - 0.5
    letters: Style = {"title": title, "title_fontsize": size, "fontsize": size - 0.5}
    canvas.legend(figure, looks[::-1], "center right", handlelength=1.0, **letters)


def scale_of(maps: WorkspaceMaps, quantity: MapQuantity) -> Steps | None:
    """Return the colour scale over all that the scene shows."""
    return steps_for(np.concatenate([quantity.of(field).ravel() for field in maps.shown]), 18)


def view_of(maps: WorkspaceMaps, frame: Frame = _PAGE.frame) -> View:
    """Return the view into the opening of the region, or of a list of points.

    Not along an axis, which would then be seen from its end.
    """
    low, high = bounds = bounds_m(maps)
    top = maps.section.position_m[-1] if maps.has_area else maps.section.position_m
    exits = maps.study.robot.exit_points_m
    visible = exits[np.all((exits >= low) & (exits <= high), axis=1)]
    azimuth = float(np.radians(-60.0))
    into = maps.region.opening_azimuth_rad(maps.focus.position_m)
    if maps.region.is_upright:
        azimuth = facing_azimuth_rad(maps.region.along)
    elif into is not None:
        off_axis = (into + 0.25 * np.pi) % (0.5 * np.pi) - 0.25 * np.pi
        angle = np.copysign(max(abs(off_axis), np.radians(15.0)), off_axis)
        azimuth = float(into + angle - off_axis)
    everything = np.concatenate([floor_corners(bounds), top, visible])
    return fitting(everything, azimuth, float(np.radians(28.0)), frame)


def bounds_m(maps: WorkspaceMaps) -> FloatArray:
    """Return the box that is shown (2, 3) [m]: region and exit points.

    A region that would be a speck among the exit points is shown alone.
    """
    region, exits = maps.region.bounds_m, maps.study.robot.exit_points_m
    everything = np.concatenate([region, exits])
    box = np.array([everything.min(axis=0), everything.max(axis=0)])
    size = float(np.ptp(region, axis=0).max())
    is_speck = maps.has_area and size < 0.2 * float(np.ptp(box, axis=0).max())
    return region if is_speck else box


def size_m(maps: WorkspaceMaps) -> float:
    """Return the longest edge of the box around everything [m]."""
    return float(np.ptp(bounds_m(maps), axis=0).max())


def add_workspace(
    stage: SceneCanvas, maps: WorkspaceMaps, quantity: MapQuantity, steps: Steps | None
) -> None:
    """Put region, exit points and cables on the stage."""
    robot, size, floor = maps.study.robot, size_m(maps), bounds_m(maps)[0, 2]
    for field in maps.shell.values():
        stage.field(field, quantity, steps)
    if maps.has_area:
        stage.lines(edges_m(maps), palette.INK, stage.pen.edge, 1.5)
    else:
        section, position = maps.section, maps.section.position_m
        values = quantity.of(section)
        finite = np.isfinite(values)
        if steps is not None:
            stage.balls(
                position[finite], 0.008 * size, steps.colours_of(steps.norm(values[finite]))
            )
        stage.balls(position[section.is_infeasible], 0.007 * size, palette.WARNING)
        stage.balls(position[section.is_left_out], 0.007 * size, palette.LEFT_OUT)
        stage.posts(position, floor, 1.0)
    stage.balls(robot.exit_points_m, 0.006 * size, palette.INK)
    stage.posts(robot.exit_points_m, floor, stage.pen.post)
    statics = maps.focus.statics
    if statics is not None:
        stage.cables(cable_curves_m(statics))
        stage.hull(statics.poses.attachment_points_m(robot), palette.INK)


def edges_m(maps: WorkspaceMaps) -> list[FloatArray]:
    """Return the edges of the opened region, each (n, 3) [m]."""
    if "wall" not in maps.shell:
        return [maps.section.position_m[-1]]
    wall = maps.shell["wall"].position_m
    cuts = [maps.shell[name].position_m for name in ("cut", "other_cut") if name in maps.shell]
    lines = [wall[0], wall[-1], *(cut[:, 0] for cut in cuts[:1])]
    for cut in cuts:
        lines += [cut[0], cut[-1], cut[:, -1]]
    for corner in maps.region.outline_m([0, 1]):
        at = np.flatnonzero(np.linalg.norm(wall[0, :, :2] - corner, axis=1) < 1e-9)
        lines += [wall[:, index] for index in at[:1]]
    return lines


def _write_names(axes: Axes, view: View, maps: WorkspaceMaps, quantity: MapQuantity) -> None:
    """Write what the exit points are called, and what the worst pose needs."""
    focus = maps.focus
    lines: list[FloatArray] = []
    if focus.statics is not None:
        lines = [*cable_curves_m(focus.statics)]
        faint: Style = {"color": palette.INK, "linewidth": 0.6, "alpha": 0.6}
        for line in lines:  # over everything, so that what lies behind a surface can be guessed
            axes.plot(*view.pixels(line).T, linestyle=(0, (2, 2)), **faint)
        lines += body_lines_m(focus.statics)
    clear = overlay.obstacles(view, lines)
    overlay.write_exits(axes, view, maps.study.robot.exit_points_m, clear)
    axes.plot(*view.pixels(focus.position_m), **canvas.RING, markersize=5.5)
    text = quantity.text_of(focus)
    overlay.write_clear(axes, view, focus.position_m, text, clear, fontweight="bold")
