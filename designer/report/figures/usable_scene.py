"""Where sizes of one grade serve, in space: one layer of the region for each size."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from designer.arrays import FloatArray
from designer.model.region import Prism
from designer.model.robot import Poses
from designer.report.figures import canvas, labels, overlay, palette, stage
from designer.report.figures.maps import WorkspaceMaps
from designer.report.figures.stage import PRINT
from designer.report.figures.view import View
from designer.report.figures.workspace_scene import bounds_m, edges_m, size_m, view_of
from designer.selection.usable import Usable, UsableSize
from designer.statics.inverse import solve_sagging

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from pyvista import Plotter, StructuredGrid

_MOST = 5
_LAYERS = 25
_MOST_SOLVED = 2_000_000
"""Poses of all sizes and orientations; rings and layers are fewer where there would be more."""
_BEYOND = 1e3


@dataclass(frozen=True, slots=True, eq=False)
class Layers:
    """Which sizes are shown, and what each of them meets on a grid through the opened region.

    Parameters
    ----------
    sizes : tuple of UsableSize
        Thinnest first.
    position_m : array (rings, spokes, layers, 3)
        Grid [m].
    utilisation : array (n_sizes, rings, spokes, layers)
        Largest over allowable tension; very large where a pose cannot be held or does not count.
    """

    sizes: tuple[UsableSize, ...]
    position_m: FloatArray
    utilisation: FloatArray


def usable_scene(maps: WorkspaceMaps, usable: Usable) -> bytes | None:
    """Return a picture of the opened region, each part in the colour of its thinnest size, as PNG.

    None for a list of points, and where no size serves a part only.
    """
    layers = layers_of(maps, usable)
    if layers is None:
        return None
    view = view_of(maps)
    plotter = stage.empty_stage()
    _add_layers(plotter, layers, view)
    edges = [view.nearer(line, 1.5 * PRINT.lift) for line in edges_m(maps)]
    stage.add_lines(plotter, edges, palette.INK, PRINT.edge)
    stage.add_lines(plotter, overlay.floor_lines(view, bounds_m(maps)), palette.FAINT, 1.0)
    exits = maps.study.robot.exit_points_m
    stage.add_spheres(plotter, exits, palette.INK, 0.006 * size_m(maps))
    image = stage.picture(plotter, view)
    with canvas.drawing():
        figure, axes = overlay.over(image)
        overlay.box_axes(axes, view, bounds_m(maps))
        _legend(figure, layers, usable)
        labels.write_exits(axes, view, exits, np.empty((0, 2)))
        return overlay.png(figure)


def layers_of(maps: WorkspaceMaps, usable: Usable) -> Layers | None:
    """Solve the grid with the sizes that are shown; None where there is nothing to show."""
    shown = chosen_sizes(usable)
    workspace = maps.study.workspace
    if not isinstance(maps.region, Prism) or not shown or workspace is None:
        return None
    plan = maps.shell["top"].position_m
    solved = plan[..., 0].size * _LAYERS * len(shown) * len(workspace.orientations.turns_rad)
    share = min(1.0, np.sqrt(_MOST_SOLVED / solved))
    rings = np.linspace(0, len(plan) - 1, max(2, round(share * len(plan)))).round().astype(int)
    heights = np.linspace(*maps.region.z_m, max(2, round(share * _LAYERS)))
    position = np.repeat(plan[rings, :, None], len(heights), axis=2)
    position[..., 2] = heights
    return Layers(shown, position, np.stack([_utilisation(maps, s, position) for s in shown]))


def chosen_sizes(usable: Usable) -> tuple[UsableSize, ...]:
    """Return a few sizes that serve a part, spread over their shares, and one that serves all.

    Thinnest first. Empty where no size serves a part only.
    """
    part = [one for one in usable.sizes if 0.0 < one.fraction < 1.0]
    whole = [one for one in usable.sizes if one.fraction == 1.0][:1]
    if not part:
        return ()
    shares = [one.fraction for one in part]
    wanted = np.linspace(min(shares), max(shares), min(_MOST - len(whole), len(part)))
    nearest = [min(part, key=lambda one: abs(one.fraction - share)) for share in wanted]
    return tuple(one for one in usable.sizes if one in nearest or one in whole)


def _utilisation(maps: WorkspaceMaps, one: UsableSize, position_m: FloatArray) -> FloatArray:
    workspace = maps.study.workspace
    assert workspace is not None
    most = np.zeros(position_m.shape[:-1])
    for turn_rad in workspace.orientations.turns_rad:
        statics = solve_sagging(maps.study.robot, Poses.at(position_m, turn_rad), one.cable)
        serves = statics.is_solved
        if workspace.hangs_below == "exclude":
            serves = serves & ~statics.hangs_below
        used = statics.largest_tension_N / one.cable.allowable_tension_N
        most = np.maximum(most, np.where(serves, np.minimum(used, _BEYOND), _BEYOND))
    return most


def _add_layers(plotter: Plotter, layers: Layers, view: View) -> None:
    """Add what each size serves beyond the size before it, and what none serves."""
    import pyvista

    grid = pyvista.StructuredGrid(*np.moveaxis(layers.position_m, -1, 0))
    for number, used in enumerate(layers.utilisation):
        # In the logarithm the boundary lies between two points where it does in the utilisation.
        grid[f"size {number}"] = np.log(used).ravel(order="F")
    rest: StructuredGrid = grid
    for number, colour in enumerate(colours(layers)):
        body = rest.clip_scalar(scalars=f"size {number}", value=0.0, invert=True)
        rest = rest.clip_scalar(scalars=f"size {number}", value=0.0, invert=False)
        if body.n_cells > 0:
            plotter.add_mesh(body, color=colour, lighting=False)
    if rest.n_cells > 0:
        plotter.add_mesh(rest, color=palette.WARNING_PALE, lighting=False)


def colours(layers: Layers) -> list[tuple[float, ...]]:
    """Return a colour for each size, dark for the thinnest."""
    import matplotlib

    table = matplotlib.colormaps[palette.COLORMAP]
    return [tuple(table(share)[:3]) for share in np.linspace(0.1, 0.95, len(layers.sizes))]


def _legend(figure: Figure, layers: Layers, usable: Usable) -> None:
    from matplotlib.patches import Patch

    entries = [
        Patch(facecolor=colour, label=f"{one.size.id}, {_share(one.fraction)}")
        for one, colour in zip(layers.sizes, colours(layers), strict=True)
    ]
    if all(one.fraction < 1.0 for one in layers.sizes):
        entries.append(Patch(facecolor=palette.WARNING_PALE, label="none of these"))
    figure.legend(
        handles=entries[::-1],
        loc="center right",
        frameon=False,
        handlelength=1.0,
        title="served from\nthis size on" if usable.is_nested else "thinnest size\nthat serves",
        title_fontsize=palette.FONT_POINTS - 0.5,
        fontsize=palette.FONT_POINTS - 1.0,
    )


def _share(fraction: float) -> str:
    return "all" if fraction == 1.0 else f"{canvas.significant(100.0 * fraction, 2)} %"
