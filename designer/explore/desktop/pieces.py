"""What stands on the stage: each piece is one actor with one mesh, for as long as the window lives.

What changes is written into the arrays of the mesh on display: a mesh that is added again leaks,
and costs some thirty milliseconds.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from designer.arrays import FloatArray

if TYPE_CHECKING:
    from pyvista import PolyData

Faces = NDArray[np.int64]


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
        plotter.add_actor(self.actor, name=name, reset_camera=False, render=False)

    @property
    def is_visible(self) -> bool:
        """Whether it is drawn."""
        return bool(self.actor.visibility)

    def show(self, wanted: bool) -> None:
        """Draw it or not."""
        self.actor.visibility = wanted

    def colour(self, colour: str) -> None:
        """Draw all of it in one colour."""
        self.actor.prop.color = colour

    def _put(self, points_m: FloatArray, cells: Any, kind: str) -> None:
        """Write points, and cells only where their number has changed."""
        mesh, points = self.mesh, np.ascontiguousarray(points_m, dtype=np.float64)
        if mesh.n_points == len(points) and len(points) > 0 and cells is None:
            mesh.points[:] = points
            mesh.GetPoints().Modified()
            mesh.Modified()
            return
        import pyvista

        if len(points) == 0:
            mesh.copy_from(pyvista.PolyData())
            return
        mesh.copy_from(pyvista.PolyData(points, **{kind: cells} if cells is not None else {}))


class Lines(Piece):
    """Polylines of one colour, as wide as so many pixels of the usual density."""

    def __init__(
        self, plotter: Any, name: str, width: float, before: float = 2.0, opacity: float = 1.0
    ) -> None:
        super().__init__(plotter, name, before)
        self.actor.prop.line_width = width * plotter.devicePixelRatioF()
        self.actor.prop.opacity = opacity
        self._sizes: tuple[int, ...] = ()

    def put(self, lines_m: Iterable[FloatArray]) -> None:
        """Show polylines, each (n, 3) [m]."""
        lines = [np.asarray(line, dtype=np.float64) for line in lines_m if len(line) > 1]
        sizes = tuple(len(line) for line in lines)
        points = np.concatenate(lines) if lines else np.empty((0, 3))
        if sizes == self._sizes:
            self._put(points, None, "lines")
            return
        self._sizes = sizes
        ends = np.cumsum(sizes)
        cells = np.concatenate(
            [[n, *range(end - n, end)] for n, end in zip(sizes, ends, strict=True)] or [[]]
        )
        self._put(points, cells.astype(np.int64), "lines")


class Dots(Piece):
    """Balls of a constant size on the screen."""

    def __init__(self, plotter: Any, name: str, size_px: float, before: float = 4.0) -> None:
        super().__init__(plotter, name, before)
        self.actor.prop.point_size = size_px * plotter.devicePixelRatioF()
        self.actor.prop.render_points_as_spheres = True

    def put(self, points_m: FloatArray) -> None:
        """Show points (n, 3) [m]."""
        points = np.asarray(points_m, dtype=np.float64).reshape(-1, 3)
        same = len(points) == self.mesh.n_points
        cells = np.column_stack([np.ones(len(points)), np.arange(len(points))]).astype(np.int64)
        self._put(points, None if same else cells.ravel(), "verts")

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
        sides = np.full((len(faces), 1), faces.shape[1] if len(faces) else 3)
        cells = np.hstack([sides, faces]).ravel() if len(faces) else None
        self._put(points_m if len(faces) else np.empty((0, 3)), cells, "faces")
