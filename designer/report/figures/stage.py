"""Off-screen scenes: what is put on the stage, and the picture that is taken of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from designer.arrays import BoolArray, FloatArray
from designer.report.figures import palette
from designer.report.figures.colours import Steps
from designer.report.figures.field import Field
from designer.report.figures.opengl import prefer_offscreen
from designer.report.figures.quantity import Quantity
from designer.report.figures.view import HEIGHT_PX, WIDTH_PX, View

if TYPE_CHECKING:
    from pyvista import Plotter, PolyData

Image = NDArray[np.uint8]


def empty_stage() -> Plotter:
    """Return a white stage without lamps: a colour is what the colour bar says it is."""
    prefer_offscreen()
    import pyvista

    plotter = pyvista.Plotter(
        off_screen=True, window_size=[WIDTH_PX, HEIGHT_PX], lighting="none", theme=_theme()
    )
    plotter.set_background("white")
    return plotter


def picture(plotter: Plotter, view: View) -> Image:
    """Take the picture (height, width, 3), and clear the stage."""
    aim(plotter, view)
    plotter.enable_anti_aliasing("ssaa")
    image = plotter.screenshot(return_img=True)
    plotter.close()
    return np.asarray(image, dtype=np.uint8)


def aim(plotter: Plotter, view: View) -> None:
    """Point the camera."""
    far = 20.0 * view.half_height_m
    camera = plotter.camera
    camera.position = tuple(view.centre_m + far * view.toward_camera)
    camera.focal_point = tuple(view.centre_m)
    camera.up = (0.0, 0.0, 1.0)
    camera.parallel_projection = True
    camera.parallel_scale = view.half_height_m
    plotter.renderer.ResetCameraClippingRange()


def add_lines(
    plotter: Plotter, lines_m: list[FloatArray], colour: str, width: float, opacity: float = 1.0
) -> None:
    """Add polylines, each (n, 3) [m]."""
    if lines_m:
        plotter.add_mesh(
            polylines(lines_m), color=colour, line_width=width, opacity=opacity, lighting=False
        )


def polylines(lines_m: list[FloatArray]) -> PolyData:
    """Return a mesh of polylines, each (n, 3) [m]."""
    import pyvista

    points = np.concatenate(lines_m)
    cells: list[int] = []
    start = 0
    for line in lines_m:
        cells += [len(line), *range(start, start + len(line))]
        start += len(line)
    return pyvista.PolyData(points.astype(np.float64), lines=np.array(cells))


def add_field(plotter: Plotter, field: Field, quantity: Quantity, steps: Steps | None) -> None:
    """Add a surface (n, m) coloured by a quantity; grey and orange where there is no value."""
    values = quantity.of(field)
    corners = _per_cell(field.is_infeasible)
    failed = corners.any(axis=0)
    left = _per_cell(field.is_left_out).any(axis=0) & ~failed
    shown = ~failed & ~left
    if steps is not None and shown.any():
        surface = _quads(field.position_m, shown)
        surface["values"] = np.nan_to_num(values.ravel(order="F"), nan=steps.levels[0])
        colours = steps.colormap
        plotter.add_mesh(
            surface, scalars="values", cmap=colours, n_colors=colours.N, clim=_limits(steps),
            lighting=False, show_scalar_bar=False, copy_mesh=False,
        )
    for cells, colour in ((left, palette.LEFT_OUT), (failed, palette.WARNING)):
        if cells.any():
            plotter.add_mesh(_quads(field.position_m, cells), color=colour, lighting=False)


def add_spheres(
    plotter: Plotter, centres_m: FloatArray, colour: str, radius_m: float
) -> None:
    """Add balls of one colour at positions (n, 3) [m]."""
    import pyvista

    for centre in centres_m:
        ball = pyvista.Sphere(radius=radius_m, center=tuple(centre))
        plotter.add_mesh(ball, color=colour, lighting=False)


def add_balls(
    plotter: Plotter, centres_m: FloatArray, values: FloatArray, steps: Steps | None, radius_m: float
) -> None:
    """Add balls at positions (n, 3) [m] coloured by their values (n,); none where it is NaN."""
    import pyvista

    shown = np.isfinite(values)
    if steps is None or not shown.any():
        return
    cloud = pyvista.PolyData(centres_m[shown].astype(np.float64))
    cloud["values"] = values[shown]
    balls = cloud.glyph(geom=pyvista.Sphere(radius=radius_m), scale=False, orient=False)
    colours = steps.colormap
    plotter.add_mesh(
        balls, scalars="values", cmap=colours, n_colors=colours.N, clim=_limits(steps),
        lighting=False, show_scalar_bar=False,
    )


def contour_lines(field: Field, quantity: Quantity, steps: Steps) -> list[FloatArray]:
    """Return the lines of equal value at the labelled steps, each (n, 3) [m]."""
    values = quantity.of(field)
    shown = ~_per_cell(np.isnan(values)).any(axis=0)
    if not shown.any():
        return []
    surface = _quads(field.position_m, shown)
    surface["values"] = np.nan_to_num(values.ravel(order="F"), nan=0.0)
    lines = surface.contour(isosurfaces=list(steps.ticks), scalars="values").strip()
    return [np.asarray(cell.points, dtype=np.float64) for cell in lines.cell] if lines.n_cells else []


def _limits(steps: Steps) -> tuple[float, float]:
    """Ends of the scale; a step above it has the width of its neighbours."""
    low, high = float(steps.levels[0]), float(steps.levels[-1])
    return low, high + (steps.levels[1] - low if steps.extend == "max" else 0.0)


def _per_cell(at_corners: BoolArray) -> BoolArray:
    """Values at the four corners of each cell of a grid (n, m): (4, n - 1, m - 1)."""
    return np.stack(
        [at_corners[:-1, :-1], at_corners[1:, :-1], at_corners[:-1, 1:], at_corners[1:, 1:]]
    )


def _quads(position_m: FloatArray, cells: BoolArray) -> PolyData:
    """Return the chosen cells of a grid (n, m, 3) as a mesh with all its points."""
    import pyvista

    rows, columns = position_m.shape[:2]
    number = np.arange(rows * columns).reshape((rows, columns), order="F")
    corners = [number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]]
    faces = np.stack([corner[cells] for corner in corners], axis=1)
    faces = np.insert(faces, 0, 4, axis=1)
    points = position_m.reshape((-1, 3), order="F")
    return pyvista.PolyData(points.astype(np.float64), faces=faces.ravel())


def _theme() -> object:
    from pyvista.plotting.themes import DocumentTheme

    return DocumentTheme()
