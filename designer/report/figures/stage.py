"""Off-screen scenes: what is put on the stage, and the picture that is taken of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from designer.analysis.field import Field
from designer.arrays import BoolArray, FloatArray
from designer.errors import MissingLibraryError
from designer.report.figures import palette
from designer.report.figures.colours import Steps
from designer.report.figures.opengl import why_no_scenes
from designer.report.figures.quantity import Quantity
from designer.report.figures.view import HEIGHT_PX, WIDTH_PX, View

if TYPE_CHECKING:
    from pyvista import Plotter, PolyData

Image = NDArray[np.uint8]


@dataclass(frozen=True, slots=True)
class Pen:
    """Widths of lines [px], and how far lines are lifted off surfaces toward the camera [px].

    A viewer in which the scene can be turned lifts them by itself.
    """

    contour: float = 1.2
    edge: float = 1.6
    post: float = 1.5
    cable: float = 6.0
    rim: float = 11.0
    lift: float = 1.0


PRINT = Pen()
SCREEN = Pen(contour=0.7, edge=1.0, post=1.0, cable=2.5, rim=0.0, lift=0.0)


def empty_stage() -> Plotter:
    """Return a white stage without lamps: a colour is what the colour bar says it is.

    Raises
    ------
    MissingLibraryError
        If this machine cannot draw; the message names the packages to install.
    """
    missing = why_no_scenes()
    if missing:
        raise MissingLibraryError(missing)
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


def add_cables(plotter: Plotter, curves_m: list[FloatArray], view: View, pen: Pen) -> None:
    """Add cables with a pale rim, so that they stand out from any colour behind them."""
    if pen.rim > 0.0:
        rims = [view.nearer(curve, pen.lift) for curve in curves_m]
        add_lines(plotter, rims, "white", pen.rim)
    cables = [view.nearer(curve, 2.0 * pen.lift) for curve in curves_m]
    add_lines(plotter, cables, palette.INK, pen.cable)


def add_field(plotter: Plotter, field: Field, quantity: Quantity, steps: Steps | None) -> None:
    """Add a surface (n, m) coloured by a quantity; grey and orange where there is no value."""
    counted = counted_surface(field, quantity)
    if steps is not None and counted.n_cells > 0:
        plotter.add_mesh(banded(counted, steps), scalars="colour", rgb=True, lighting=False)
    for mesh, colour in (
        (left_out_surface(field, quantity), palette.LEFT_OUT),
        (quads(field.position_m, _any_corner(field.is_infeasible)), palette.WARNING),
    ):
        if mesh.n_cells > 0:
            plotter.add_mesh(mesh, color=colour, lighting=False)


def counted_surface(field: Field, quantity: Quantity) -> PolyData:
    """Return the part of a surface (n, m) that counts, with its values at the points."""
    surface = _surface(field, quantity)
    if not field.is_left_out.any():
        return surface
    return surface.clip_scalar(scalars="uplift", invert=True, value=0.0)


def banded(surface: PolyData, steps: Steps) -> PolyData:
    """Return a surface cut along the steps of the scale, each cell in the colour of its step.

    Cut, and not coloured through a table, because viewers disagree on where a table's steps end.
    """
    count, edges = steps.colormap.N, steps.edges
    margin = 1e-6 * (edges[1] - edges[0])
    inside = surface.copy()
    inside["values"] = np.clip(surface["values"], edges[0] + margin, edges[-1] - margin)
    cut = inside.contour_banded(
        count + 1,
        rng=[edges[0], edges[-1]],
        scalars="values",
        scalar_mode="index",
        generate_contour_edges=False,
    )
    step = np.asarray(cut.cell_data[cut.cell_data.keys()[-1]]).astype(int).clip(0, count - 1)
    table = np.array([steps.colormap(index)[:3] for index in range(count)])
    bare = cut.copy()
    bare.clear_data()
    bare.cell_data["colour"] = np.round(255.0 * table[step]).astype(np.uint8)
    return bare


def left_out_surface(field: Field, quantity: Quantity) -> PolyData:
    """Return the part of a surface (n, m) that the study leaves out."""
    valued = valued_cells(field, quantity)
    failed = _any_corner(field.is_infeasible)
    left_out = _any_corner(field.is_left_out) & ~failed
    blank = quads(field.position_m, left_out & ~valued)
    if not (left_out & valued).any():
        return blank
    return blank.merge(
        _surface(field, quantity).clip_scalar(scalars="uplift", invert=False, value=0.0)
    )


def contour_lines(field: Field, quantity: Quantity, steps: Steps) -> list[FloatArray]:
    """Return the lines of equal value at the labelled steps, each (n, 3) [m]."""
    surface = counted_surface(field, quantity)
    if surface.n_cells == 0:
        return []
    lines = surface.contour(isosurfaces=list(steps.ticks), scalars="values")
    if lines.n_cells == 0:
        return []
    return [np.asarray(cell.points, dtype=np.float64) for cell in lines.strip().cell]


def valued_cells(field: Field, quantity: Quantity) -> BoolArray:
    """Tell which cells of a grid (n, m) have values at all corners, (n - 1, m - 1)."""
    return np.asarray(_corners(np.isfinite(quantity.everywhere(field))).all(axis=0))


def _surface(field: Field, quantity: Quantity) -> PolyData:
    surface = quads(field.position_m, valued_cells(field, quantity))
    surface["values"] = np.nan_to_num(quantity.everywhere(field).ravel(order="F"))
    surface["uplift"] = np.nan_to_num(field.uplift.ravel(order="F"))
    return surface


def add_spheres(plotter: Plotter, centres_m: FloatArray, colour: str, radius_m: float) -> None:
    """Add balls of one colour at positions (n, 3) [m]."""
    import pyvista

    for centre in centres_m:
        ball = pyvista.Sphere(radius=radius_m, center=tuple(centre))
        plotter.add_mesh(ball, color=colour, lighting=False)


def add_hull(plotter: Plotter, points_m: FloatArray, colour: str) -> None:
    """Add the hull of points (n, 3) [m]; flat where they lie in one plane."""
    import pyvista

    faces = hull_faces(points_m)
    if len(faces) == 0:
        return
    cells = np.insert(faces, 0, 3, axis=1).ravel()
    hull = pyvista.PolyData(points_m.astype(np.float64), faces=cells)
    plotter.add_mesh(hull, color=colour, lighting=False)
    edges = hull.extract_feature_edges(feature_angle=20.0)
    if edges.n_cells > 0:
        plotter.add_mesh(edges, color=palette.INK, line_width=2.0, lighting=False)


def hull_faces(points_m: FloatArray) -> NDArray[np.int64]:
    """Return the triangles of the hull of points, by their indices (n_faces, 3).

    For points in one plane the triangles of their outline, for points on a line none.
    """
    from scipy.spatial import ConvexHull

    centred = points_m - points_m.mean(axis=0)
    _, extent, axes = np.linalg.svd(centred)
    rank = int(np.sum(extent > 1e-6 * max(float(extent[0]), 1e-12)))
    if rank < 2 or len(points_m) < 3:
        return np.empty((0, 3), dtype=np.int64)
    if rank == 3:
        return np.asarray(ConvexHull(points_m).simplices, dtype=np.int64)
    outline = ConvexHull(centred @ axes[:2].T).vertices
    fan = [[outline[0], outline[k], outline[k + 1]] for k in range(1, len(outline) - 1)]
    return np.array(fan, dtype=np.int64)


def add_balls(
    plotter: Plotter, centres_m: FloatArray, values: FloatArray, steps: Steps, radius_m: float
) -> None:
    """Add balls at positions (n, 3) [m] in the colour of their value (n,); none where it is NaN."""
    import pyvista

    shown = np.isfinite(values)
    if not shown.any():
        return
    cloud = pyvista.PolyData(centres_m[shown].astype(np.float64))
    colours = steps.colormap(steps.norm(values[shown]))[:, :3]
    cloud["colour"] = np.round(255.0 * colours).astype(np.uint8)
    ball = pyvista.Sphere(radius=radius_m, theta_resolution=16, phi_resolution=16)
    balls = cloud.glyph(geom=ball, scale=False, orient=False)
    plotter.add_mesh(balls, scalars="colour", rgb=True, lighting=False)


def _any_corner(at_corners: BoolArray) -> BoolArray:
    return np.asarray(_corners(at_corners).any(axis=0))


def _corners(at_corners: BoolArray) -> BoolArray:
    """Values at the four corners of each cell of a grid (n, m): (4, n - 1, m - 1)."""
    return np.stack(
        [at_corners[:-1, :-1], at_corners[1:, :-1], at_corners[:-1, 1:], at_corners[1:, 1:]]
    )


def quads(position_m: FloatArray, cells: BoolArray) -> PolyData:
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
