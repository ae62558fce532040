"""Off-screen scenes: what is put on the stage, and the picture that is taken of it."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray

from designer.analysis.maps import RegionField
from designer.arrays import BoolArray, FloatArray
from designer.errors import MissingLibraryError
from designer.report.figures import palette
from designer.report.figures.colours import MapQuantity, Steps
from designer.report.figures.opengl import why_no_scenes
from designer.report.figures.parts import grid_faces, hull_edges, hull_faces, posts_m
from designer.report.figures.view import HEIGHT_PX, WIDTH_PX, View

if TYPE_CHECKING:
    from pyvista import DataSet, PolyData

Image = NDArray[np.uint8]
BORDER_OPACITY = 0.5


@dataclass(frozen=True, slots=True)
class Pen:
    """Widths of lines [samples], and how far they are lifted off surfaces toward the camera [px].

    A viewer in which the scene can be turned lifts them by itself. ``samples`` is of how many a
    pixel of the picture is the mean, along each side.
    """

    contour: float = 1.2
    edge: float = 1.6
    post: float = 1.5
    cable: float = 6.0
    rim: float = 11.0
    lift: float = 1.0
    samples: int = 2


PRINT = Pen()
SCREEN = Pen(contour=0.7, edge=1.0, post=1.0, cable=2.5, rim=0.0, lift=0.0, samples=1)


@cache
def _window() -> tuple[Any, Any]:
    """The one window of all stages and what it shows: to open one takes longer than to draw."""
    import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  (gives the classes below their bodies)
    from vtkmodules.vtkRenderingCore import vtkRenderer, vtkRenderWindow

    window, scene = vtkRenderWindow(), vtkRenderer()
    window.SetOffScreenRendering(True)
    window.SetMultiSamples(1)
    scene.SetBackground(1.0, 1.0, 1.0)
    scene.AutomaticLightCreationOff()
    window.AddRenderer(scene)
    return window, scene


class SceneCanvas:
    """A white stage without lamps, before a camera: a colour is what the colour bar says it is.

    Only one is set at a time: the next one clears it.

    Raises
    ------
    MissingLibraryError
        If this machine cannot draw; the message names the packages to install.
    """

    def __init__(self, view: View, pen: Pen = PRINT) -> None:
        missing = why_no_scenes()
        if missing:
            raise MissingLibraryError(missing)
        self.view, self.pen = view, pen
        self.window, self.scene = _window()
        self.window.SetSize(pen.samples * WIDTH_PX, pen.samples * HEIGHT_PX)
        self.clear()

    def clear(self) -> None:
        """Take everything off the stage."""
        self.scene.RemoveAllViewProps()

    def picture(self) -> Image:
        """Take the picture (height, width, 3), and clear the stage."""
        from PIL import Image as Pillow
        from vtkmodules.util.numpy_support import vtk_to_numpy
        from vtkmodules.vtkCommonCore import vtkUnsignedCharArray

        self.view.aim(self.scene)
        self.window.Render()
        size, pixels = self.window.GetSize(), vtkUnsignedCharArray()
        self.window.GetRGBACharPixelData(0, 0, size[0] - 1, size[1] - 1, 1, pixels, 0)
        self.clear()
        # With a fourth byte, so that Pillow takes the array as it is, without a copy.
        image = Pillow.frombuffer("RGBX", size, vtk_to_numpy(pixels), "raw", "RGBX", 0, 1)
        rows = np.asarray(image.reduce(self.pen.samples))
        return rows[::-1, :, :3]  # VTK counts rows from below

    def add(
        self, mesh: DataSet, colour: Any = None, width: float = 1.0, opacity: float = 1.0
    ) -> None:
        """Add a mesh, unless it is empty, in one colour or in those that its scalars are."""
        from matplotlib.colors import to_rgb
        from vtkmodules.vtkRenderingCore import vtkActor, vtkDataSetMapper

        if mesh.n_cells == 0:
            return
        mapper, actor = vtkDataSetMapper(), vtkActor()
        mapper.SetInputData(mesh)
        mapper.SetColorModeToDirectScalars()
        mapper.SetScalarVisibility(colour is None)
        actor.SetMapper(mapper)
        look = actor.GetProperty()
        look.LightingOff()
        look.SetLineWidth(width)
        look.SetOpacity(opacity)
        look.SetColor(*to_rgb("white" if colour is None else colour))
        self.scene.AddActor(actor)

    def lines(
        self, lines_m: Iterable[FloatArray], colour: str, width: float, lift: float = 0.0
    ) -> None:
        """Add polylines, each (n, 3) [m], moved toward the camera by ``lift`` lifts of the pen."""
        import pyvista

        lifted = [self.view.nearer(line, lift * self.pen.lift) for line in lines_m]
        if not lifted:
            return
        ends = np.cumsum([len(line) for line in lifted])
        cells = np.split(np.arange(ends[-1]), ends[:-1])
        mesh = pyvista.PolyData(
            np.concatenate(lifted), lines=pyvista.CellArray.from_irregular_cells(cells)
        )
        self.add(mesh, colour, width)

    def posts(self, tops_m: FloatArray, floor_m: float, width: float) -> None:
        """Add thin uprights from points (n, 3) down to the floor [m]."""
        self.lines(posts_m(tops_m, floor_m), palette.FAINT, width)

    def cables(self, curves_m: Iterable[FloatArray]) -> None:
        """Add cables with a pale rim, so that they stand out from any colour behind them."""
        if self.pen.rim > 0.0:
            self.lines(curves_m, "white", self.pen.rim, 1.0)
        self.lines(curves_m, palette.INK, self.pen.cable, 2.0)

    def balls(
        self, centres_m: FloatArray, radius_m: float, colour: str | NDArray[np.uint8]
    ) -> None:
        """Add balls at positions (n, 3) [m], of one colour or each of its own (n, 3)."""
        import pyvista

        if len(centres_m) == 0:
            return
        cloud = pyvista.PolyData(centres_m.astype(np.float64))
        is_single = isinstance(colour, str)
        if not is_single:
            cloud["colour"] = colour
        ball = pyvista.Sphere(radius=radius_m, theta_resolution=16, phi_resolution=16)
        balls = cloud.glyph(geom=ball, scale=False, orient=False)
        if not is_single:
            balls.set_active_scalars("colour")
        self.add(balls, colour if is_single else None)

    def hull(self, points_m: FloatArray, colour: str) -> None:
        """Add the hull of points (n, 3) [m] with its edges; flat where they lie in one plane."""
        import pyvista

        faces = hull_faces(points_m)
        if len(faces) == 0:
            return
        hull = pyvista.PolyData.from_regular_faces(points_m.astype(np.float64), faces)
        self.add(hull, colour)
        self.lines(points_m[hull_edges(points_m, faces)], palette.INK, 2.0)

    def border(self, triangles_m: FloatArray) -> None:
        """Add triangles (n, 3, 3) [m] that let through what lies behind them."""
        import pyvista

        if len(triangles_m):
            corners = np.arange(3 * len(triangles_m)).reshape(-1, 3)
            mesh = pyvista.PolyData.from_regular_faces(triangles_m.reshape(-1, 3), corners)
            self.add(mesh.clean(), palette.IMPOSSIBLE, opacity=BORDER_OPACITY)

    def field(self, field: RegionField, quantity: MapQuantity, steps: Steps | None) -> None:
        """Add a surface (n, m) coloured by a quantity, with lines of equal value.

        Grey and orange where there is no value.
        """
        counted = counted_surface(field, quantity)
        if steps is not None and counted.n_cells > 0:
            self.add(banded(counted, steps))
            self.lines(contour_lines(counted, steps), "white", self.pen.contour, 1.0)
        self.add(left_out_surface(field, quantity), palette.LEFT_OUT)
        self.add(failed_surface(field), palette.WARNING)


def counted_surface(field: RegionField, quantity: MapQuantity) -> PolyData:
    """Return the part of a surface (n, m) that counts, with its values at the points."""
    surface = _surface(field, quantity)
    if not field.is_left_out.any():
        return surface
    return surface.clip_scalar(scalars="uplift", invert=True, value=0.0)


def left_out_surface(field: RegionField, quantity: MapQuantity) -> PolyData:
    """Return the part of a surface (n, m) that the study leaves out."""
    valued = _valued_cells(field, quantity)
    left_out = _any_corner(field.is_left_out) & ~_any_corner(field.is_infeasible)
    blank = quads(field.position_m, left_out & ~valued)
    if not (left_out & valued).any():
        return blank
    beyond = _surface(field, quantity).clip_scalar(scalars="uplift", invert=False, value=0.0)
    return blank.merge(beyond)


def failed_surface(field: RegionField) -> PolyData:
    """Return the part of a surface (n, m) that nothing was found to hold."""
    return quads(field.position_m, _any_corner(field.is_infeasible))


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
    bare = cut.copy()
    bare.clear_data()
    bare.cell_data["colour"] = steps.colours_of(step)
    return bare


def contour_lines(surface: PolyData, steps: Steps) -> list[FloatArray]:
    """Return the lines of equal value at the labelled steps, each (n, 3) [m]."""
    lines = surface.contour(isosurfaces=list(steps.ticks), scalars="values")
    if lines.n_cells == 0:
        return []
    return [np.asarray(cell.points, dtype=np.float64) for cell in lines.strip().cell]


def _surface(field: RegionField, quantity: MapQuantity) -> PolyData:
    surface = quads(field.position_m, _valued_cells(field, quantity))
    surface["values"] = np.nan_to_num(quantity.everywhere(field).ravel())
    surface["uplift"] = np.nan_to_num(field.uplift.ravel())
    return surface


def _valued_cells(field: RegionField, quantity: MapQuantity) -> BoolArray:
    """Tell which cells of a grid (n, m) have values at all corners, (n - 1, m - 1)."""
    return ~_any_corner(~np.isfinite(quantity.everywhere(field)))


def _any_corner(at_points: BoolArray) -> BoolArray:
    """Tell which cells of a grid (n, m) have it at one corner at least, (n - 1, m - 1)."""
    return np.array(sliding_window_view(at_points, (2, 2)).any(axis=(2, 3)))


def quads(position_m: FloatArray, cells: BoolArray) -> PolyData:
    """Return the chosen cells (n - 1, m - 1) of a grid (n, m, 3) as a mesh with all its points."""
    import pyvista

    faces = grid_faces(*position_m.shape[:2])[cells.ravel()]
    return pyvista.PolyData.from_regular_faces(position_m.reshape(-1, 3).astype(np.float64), faces)
