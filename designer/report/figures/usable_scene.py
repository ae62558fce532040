"""Where sizes of one grade serve, in space: one layer of the region for each size."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from designer.analysis.layers import Layers, layers_of
from designer.analysis.maps import WorkspaceMaps
from designer.report import format as fmt
from designer.report.figures import canvas, labels, overlay, palette
from designer.report.figures.stage import Stage
from designer.report.figures.workspace_scene import bounds_m, edges_m, size_m, view_of
from designer.selection.usable import Usable

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def usable_scene(maps: WorkspaceMaps, usable: Usable) -> bytes | None:
    """Return a picture of the opened region, each part in the colour of its thinnest size, as PNG.

    None for a list of points, and where no size serves a part only.
    """
    layers = layers_of(maps, usable)
    if layers is None:
        return None
    view, exits = view_of(maps), maps.study.robot.exit_points_m
    stage = Stage(view)
    _add_layers(stage, layers)
    stage.lines(edges_m(maps), palette.INK, stage.pen.edge, 1.5)
    stage.lines(overlay.floor_lines(view, bounds_m(maps)), palette.FAINT, 1.0)
    stage.balls(exits, 0.006 * size_m(maps), palette.INK)
    image = stage.picture()
    with canvas.drawing():
        figure, axes = overlay.over(image)
        overlay.box_axes(axes, view, bounds_m(maps))
        _legend(figure, layers, usable)
        labels.write_exits(axes, view, exits, np.empty((0, 2)))
        return overlay.png(figure)


def _add_layers(stage: Stage, layers: Layers) -> None:
    """Add what each size serves beyond the size before it, and what none serves."""
    import pyvista

    rest: Any = pyvista.StructuredGrid(*np.moveaxis(layers.position_m, -1, 0))
    for number, used in enumerate(layers.utilisation):
        # In the logarithm the boundary lies between two points where it does in the utilisation.
        rest[f"size {number}"] = np.log(used).ravel(order="F")
    for number, colour in enumerate(colours(layers)):
        where = {"scalars": f"size {number}", "value": 0.0}
        stage.add(rest.clip_scalar(**where, invert=True), colour)
        rest = rest.clip_scalar(**where, invert=False)
    stage.add(rest, palette.WARNING_PALE)


def colours(layers: Layers) -> list[tuple[float, ...]]:
    """Return a colour for each size, dark for the thinnest."""
    import matplotlib

    table = matplotlib.colormaps[palette.COLORMAP]
    return [tuple(table(share)[:3]) for share in np.linspace(0.1, 0.95, len(layers.sizes))]


def _legend(figure: Figure, layers: Layers, usable: Usable) -> None:
    from matplotlib.patches import Patch

    entries: list[Any] = []
    for one, colour in zip(layers.sizes, colours(layers), strict=True):
        share = "all" if one.fraction == 1.0 else f"{fmt.number(100.0 * one.fraction, 2)} %"
        entries.append(Patch(facecolor=colour, label=f"{one.size.id}, {share}"))
    if all(one.fraction < 1.0 for one in layers.sizes):
        entries.append(Patch(facecolor=palette.WARNING_PALE, label="none of these"))
    title = "served from\nthis size on" if usable.is_nested else "thinnest size\nthat serves"
    size = palette.FONT_POINTS - 0.5
    letters = {"title": title, "title_fontsize": size, "fontsize": size - 0.5}
    canvas.legend(figure, entries[::-1], "center right", handlelength=1.0, **letters)
