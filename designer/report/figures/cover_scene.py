"""The workspace in space for the first page: small in print, so large letters and no axes."""

from __future__ import annotations

from designer.report.figures import canvas, overlay, palette, stage
from designer.report.figures.maps import WorkspaceMaps
from designer.report.figures.quantity import DIAMETER
from designer.report.figures.workspace_scene import (
    add_workspace,
    bounds_m,
    scale_of,
    view_of,
    write_names,
)

_FRAME = (0.03, 0.78, 0.06, 0.90)
_LETTERS = 1.9
_BAR = (0.83, 0.12, 0.028, 0.7)


def cover_scene(maps: WorkspaceMaps) -> bytes:
    """Return the picture of `workspace_scene` as it is printed on the first page, as PNG."""
    steps = scale_of(maps, DIAMETER)
    view = view_of(maps, _FRAME)
    plotter = stage.empty_stage()
    add_workspace(plotter, maps, DIAMETER, steps, view)
    stage.add_lines(plotter, overlay.floor_lines(view, bounds_m(maps)), palette.FAINT, 1.0)
    image = stage.picture(plotter, view)
    with canvas.drawing():
        figure, axes = overlay.over(image, _LETTERS)
        overlay.legend(figure, [*maps.shell.values()] or [maps.section])
        if steps is not None:
            overlay.colour_bar(figure, steps, DIAMETER, _BAR)
        write_names(axes, view, maps, DIAMETER)
        return overlay.png(figure)
