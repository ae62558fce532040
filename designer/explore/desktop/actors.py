"""What stands in the scene: each piece is one actor with one mesh, for as long as the window lives.

What changes is written into the arrays of the mesh on display: a mesh that is added again leaks,
and costs some thirty milliseconds. The map is a surface of four pieces, coloured by a quantity,
hatched where no rope serves, grey where poses are left out.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from designer.arrays import FloatArray
from designer.explore.desktop.painting import Painting, Values, rgb
from designer.explore.desktop.theme import Theme
from designer.report.figures.parts import Faces, grid_faces

if TYPE_CHECKING:
    from pyvista import PolyData
    from vtkmodules.vtkCommonDataModel import vtkStaticCellLocator


class Piece:
    """One actor on the stage, under its name; without lamps, so a colour is what the legend says.

    ``before`` lifts it towards the camera, by so many steps of depth.
    """

    def __init__(self, plotter: Any, name: str, before: float = 0.0) -> None:
        import pyvista

        self.mesh: PolyData = pyvista.PolyData()
        self.mapper: Any = pyvista.DataSetMapper(self.mesh)
        self.mapper.SetResolveCoincidentTopologyToPolygonOffset()
        self.mapper.scalar_visibility = False
        for lift in (
            self.mapper.SetRelativeCoincidentTopologyPolygonOffsetParameters,
            self.mapper.SetRelativeCoincidentTopologyLineOffsetParameters,
        ):
            lift(-before, -4.0 * before)
        self.mapper.SetRelativeCoincidentTopologyPointOffsetParameter(-4.0 * before)
        self.actor: Any = pyvista.Actor(mapper=self.mapper, name=name)
        self.actor.prop.lighting = False
        self._cells = np.empty(0, dtype=np.int64)
        plotter.add_actor(self.actor, name=name, reset_camera=False, render=False)

    @property
    def is_visible(self) -> bool:
        """Whether it is drawn."""
        return bool(self.actor.visibility)

    def show(self, is_shown: bool) -> None:
        """Draw it or not."""
        self.actor.visibility = is_shown

    def colour(self, colour: str) -> None:
        """Draw all of it in one colour."""
        self.actor.prop.color = colour

    def _put(self, points_m: FloatArray, kind: str, cells: Iterable[NDArray[np.int64]]) -> None:
        """Write points, and cells, each the numbers of its points, only where they are others."""
        import pyvista

        mesh, points = self.mesh, np.ascontiguousarray(points_m, dtype=np.float64)
        counted = np.concatenate([np.empty(0, dtype=np.int64), *([len(c), *c] for c in cells)])
        if 0 < len(points) == mesh.n_points and np.array_equal(counted, self._cells):
            mesh.points[:] = points
            mesh.GetPoints().Modified()
            mesh.Modified()
        else:
            shown: dict[str, Any] = {kind: counted} if len(points) else {}
            mesh.copy_from(pyvista.PolyData(points if len(points) else None, **shown))
            self._cells = counted


class Lines(Piece):
    """Polylines of one colour, as wide as so many pixels of the usual density."""

    def __init__(
        self, plotter: Any, name: str, width: float, before: float = 2.0, opacity: float = 1.0
    ) -> None:
        super().__init__(plotter, name, before)
        self.actor.prop.line_width = width * plotter.devicePixelRatioF()
        self.actor.prop.opacity = opacity

    def put(self, lines_m: Iterable[FloatArray]) -> None:
        """Show polylines, each (n, 3) [m]."""
        lines = [np.asarray(line, dtype=np.float64) for line in lines_m if len(line) > 1]
        points = np.concatenate([np.empty((0, 3)), *lines])
        cells = np.split(np.arange(len(points)), np.cumsum([len(line) for line in lines])[:-1])
        self._put(points, "lines", cells)


class Dots(Piece):
    """Balls of a constant size on the screen."""

    def __init__(self, plotter: Any, name: str, size_px: float, before: float = 4.0) -> None:
        super().__init__(plotter, name, before)
        self.actor.prop.point_size = size_px * plotter.devicePixelRatioF()
        self.actor.prop.render_points_as_spheres = True

    def put(self, points_m: FloatArray) -> None:
        """Show points (n, 3) [m]."""
        points = points_m.reshape(-1, 3)
        self._put(points, "verts", np.arange(len(points))[:, None])

    def paint(self, colours: NDArray[np.uint8]) -> None:
        """Give each point a colour of its own (n, 3)."""
        self.mesh.point_data["colour"] = colours
        self.mesh.point_data.active_scalars_name = "colour"
        self.mapper.scalar_map_mode = "point"
        self.mapper.color_mode = "direct"
        self.mapper.scalar_visibility = True


class Body(Piece):
    """Triangles or quadrangles of one colour."""

    def put(self, points_m: FloatArray, faces: Faces) -> None:
        """Show faces (n_faces, 3 or 4) over points (n, 3) [m]."""
        self._put(points_m if len(faces) else np.empty((0, 3)), "faces", faces)


@dataclass(frozen=True, slots=True, eq=False)
class Hit:
    """A place on the map (3,) [m], and the grid point next to it: of which grid, and which one."""

    position_m: FloatArray
    grid: str
    number: int


_STRIPES = 50.0
"""Over the size of all that is shown."""
_ACROSS = np.array([0.9, 0.35, 1.0])
"""Stripes are planes across this direction, so that no face of a box lies along one."""


class MapSurface:
    """Grids of positions as one surface, in four actors by what is known of its faces.

    With ``inside`` only those faces are drawn that are seen from within, so that one looks into a
    closed body from every side.
    """

    def __init__(self, plotter: Any, name: str, *, inside: bool = False) -> None:
        self.coloured = Piece(plotter, name)
        self.blank = Piece(plotter, f"{name}, not held")
        self.left_out = Piece(plotter, f"{name}, left out")
        self.hatched = Piece(plotter, f"{name}, hatched", before=0.5)
        self.pieces = (self.coloured, self.blank, self.left_out, self.hatched)
        self.coloured.mapper.interpolate_before_map = True
        self._seen_inside = inside
        self._is_closed = False
        self._grids: tuple[tuple[str, int], ...] = ()
        self._points_m = np.empty((0, 3))
        self._faces: Faces = np.empty((0, 4), dtype=np.int64)
        self._locator: vtkStaticCellLocator | None = None

    def show(self, is_shown: bool) -> None:
        """Draw it or not."""
        for piece in self.pieces:
            piece.show(is_shown)

    @property
    def is_visible(self) -> bool:
        """Whether it is drawn."""
        return self.coloured.is_visible

    def put_on(self, theme: Theme) -> None:
        """Take the colours of a theme."""
        import pyvista

        self.left_out.colour(theme.left_out)
        self.blank.colour(theme.hatch[0])
        stripes = np.zeros((1, 64, 4), dtype=np.uint8)
        stripes[:, :, :3] = rgb(theme.hatch[1])
        stripes[:, 46:, 3] = 255
        texture = pyvista.Texture(stripes)
        self.hatched.colour("white")
        texture.repeat = True
        self.hatched.actor.texture = texture

    def put_grids(self, grids_m: Mapping[str, FloatArray]) -> None:
        """Take the positions of grids, each (n, m, 3) [m]."""
        points = np.concatenate([np.empty((0, 3)), *(g.reshape(-1, 3) for g in grids_m.values())])
        sizes = tuple((name, grid[..., 0].size) for name, grid in grids_m.items())
        if sizes == self._grids and (points == self._points_m).all():
            return
        self._grids, self._points_m, self._locator = sizes, points, None
        starts = np.cumsum([0, *(size for _, size in sizes)])
        faces = [
            start + grid_faces(*grid.shape[:2])
            for start, grid in zip(starts[:-1], grids_m.values(), strict=True)
        ]
        self._faces = np.concatenate([np.empty((0, 4), dtype=np.int64), *faces])
        self._is_closed = self._seen_inside and len(grids_m) > 1
        if self._is_closed:
            self._faces = _outward(points, self._faces)
        self._put_points()

    def _put_points(self) -> None:
        import pyvista

        for piece in self.pieces:
            piece.actor.prop.culling = "front" if self._is_closed else "none"
            piece.mesh.copy_from(pyvista.PolyData())
            if len(self._points_m):
                piece.mesh.points = self._points_m
        if len(self._points_m):
            period = max(float(np.linalg.norm(np.ptp(self._points_m, axis=0))) / _STRIPES, 1e-9)
            across = self._points_m @ _ACROSS / period
            stripes = np.column_stack([across, np.zeros(len(across))])
            self.hatched.mesh.active_texture_coordinates = stripes

    def paint(self, painting: Painting, values: Values) -> None:
        """Colour the points (n_points,)."""
        faces = self._faces
        if len(faces) == 0:
            return
        hatched = values.is_unserved[faces].any(axis=1)
        left_out = values.is_left_out[faces].any(axis=1) & ~hatched
        valued = ~np.isnan(values.scaled)[faces].any(axis=1) & ~left_out
        kinds = (valued, hatched & ~valued, left_out, hatched)
        for piece, chosen in zip(self.pieces, kinds, strict=True):
            _put_faces(piece.mesh, faces[chosen])
        mesh, mapper = self.coloured.mesh, self.coloured.mapper
        low, high = painting.span
        mapper.lookup_table, mapper.scalar_range = painting.table, (low, high)
        mapper.scalar_visibility = True
        if painting.is_category:
            mesh.cell_data["category"] = values.scaled[faces[valued][:, 0]]
            mapper.scalar_map_mode = "cell"
        else:
            margin = 1e-6 * (high - low)
            inside = np.clip(np.nan_to_num(values.scaled), low + margin, high - margin)
            _write(mesh, "value", inside)
            mapper.scalar_map_mode = "point"
        mesh.Modified()

    def first_hit(self, start_m: FloatArray, end_m: FloatArray) -> Hit | None:
        """Return where a line first meets what is drawn of it."""
        from vtkmodules.vtkCommonCore import vtkIdList, vtkPoints

        if not self.is_visible or len(self._faces) == 0:
            return None
        crossings, cells = vtkPoints(), vtkIdList()
        ends = start_m.tolist(), end_m.tolist()
        self._cells().IntersectWithLine(*ends, 1e-9, crossings, cells)
        for number in range(crossings.GetNumberOfPoints()):
            face = self._faces[cells.GetId(number)]
            corners = self._points_m[face]
            normal = np.cross(corners[2] - corners[0], corners[3] - corners[1])
            if not self._is_closed or normal @ (end_m - start_m) > 0.0:
                place = np.array(crossings.GetPoint(number))
                away = np.linalg.norm(corners - place, axis=1)
                return self._hit(place, int(face[np.argmin(away)]))
        return None

    def _hit(self, place: FloatArray, point: int) -> Hit:
        for name, size in self._grids:
            if point < size:
                return Hit(place, name, point)
            point -= size
        raise AssertionError("a point of no grid")

    def _cells(self) -> vtkStaticCellLocator:
        import pyvista
        from vtkmodules.vtkCommonDataModel import vtkStaticCellLocator

        if self._locator is None:
            self._locator = vtkStaticCellLocator()
            mesh = pyvista.PolyData.from_regular_faces(self._points_m, self._faces)
            self._locator.SetDataSet(mesh)
            self._locator.BuildLocator()
        return self._locator


def _write(mesh: Any, name: str, values: FloatArray) -> None:
    if name in mesh.point_data and len(mesh.point_data[name]) == len(values):
        mesh.point_data[name][:] = values
        mesh.GetPointData().GetArray(name).Modified()
    else:
        mesh.point_data[name] = values
    mesh.point_data.active_scalars_name = name


def _put_faces(mesh: Any, faces: Faces) -> None:
    mesh.cell_data.clear()
    mesh.verts = np.empty(0, dtype=np.int64)
    sides = np.full((len(faces), 1), 4, dtype=np.int64)
    mesh.faces = np.hstack([sides, faces]).ravel()


def _outward(points_m: FloatArray, faces: Faces) -> Faces:
    """Corners of faces of a convex body in the order that shows their fronts outside."""
    corners = points_m[faces]
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    middle = 0.5 * (points_m.min(axis=0) + points_m.max(axis=0))
    inward = np.einsum("fk,fk->f", normal, corners.mean(axis=1) - middle) < 0.0
    return np.where(inward[:, None], faces[:, ::-1], faces)
