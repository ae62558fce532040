"""What stands in the scene: the robot and the map as actors, and the colours of the map.

Each piece is one actor with one mesh, for as long as the window lives. What changes is written into
the arrays of the mesh on display: a mesh that is added again leaks, and costs some thirty
milliseconds. The map is a surface of four pieces, coloured by a quantity, hatched where no rope
serves, grey where poses are left out.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from designer.arrays import BoolArray, FloatArray, IntArray
from designer.explore.desktop.widgets import Theme, current_theme
from designer.explore.quantities import category_labels
from designer.explore.question import cables_words
from designer.model.robot import Poses
from designer.model.verdict import Verdict
from designer.report.figures.colours import Steps, steps_for
from designer.report.figures.palette import DIFFERENCES
from designer.report.figures.parts import (
    Faces,
    base_outline_m,
    floor_m,
    grid_faces,
    hull_edges,
    hull_faces,
    posts_m,
)
from designer.report.figures.view import View

if TYPE_CHECKING:
    from pyvista import PolyData
    from vtkmodules.vtkCommonDataModel import vtkStaticCellLocator

    from designer.explore.answers import MapAnswer, PoseAnswer
    from designer.explore.quantities import Quantity
    from designer.study import Study

CATEGORY_COLOURS = (
    "#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#D55E00", "#F0E442", "#7F7F7F",
)  # fmt: skip
"""Told apart by every kind of colour vision; M. Okabe and K. Ito, Color Universal Design, 2008."""
_LUMINANCE = np.array([0.2126, 0.7152, 0.0722])  #: Of red, green and blue; ITU-R BT.709


@dataclass(frozen=True, slots=True)
class Key:
    """A colour and what it means; hatched where there is a second colour."""

    colour: str
    meaning: str
    stripes: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class Values:
    """Of points (n,): the quantity in the unit of the legend, and which points are set apart."""

    scaled: FloatArray
    is_unserved: BoolArray
    is_left_out: BoolArray

    def at(self, points: IntArray) -> Values:
        return Values(self.scaled[points], self.is_unserved[points], self.is_left_out[points])


@dataclass(frozen=True, slots=True, eq=False)
class Painting:
    """A quantity or its difference to A, and its scale: steps, or colours of categories.

    Grey where it ``is_old``: of an older state of the study.
    """

    quantity: Quantity
    steps: Steps | None
    is_difference: bool = False
    is_old: bool = False

    @classmethod
    def over(cls, answer: MapAnswer, quantity: Quantity, fixed: Steps | None = None) -> Painting:
        """Return what paints an answer; with the steps of another one, where they are held."""
        if answer.before is not None:
            return cls._of_difference(answer, quantity)
        plain = cls(quantity, None)
        if quantity.is_category:
            return plain
        values = plain.of(answer)
        counts = ~(values.is_unserved | values.is_left_out)
        return cls(quantity, fixed if fixed is not None else steps_for(values.scaled[counts]))

    @classmethod
    def _of_difference(cls, answer: MapAnswer, quantity: Quantity) -> Painting:
        plain = cls(quantity, None, is_difference=True)
        values = plain.of(answer).scaled
        steps = steps_for(np.abs(values))
        if steps is None or not np.nanmax(np.abs(values)) > 0.0:
            return cls(quantity, Steps(np.array([-1.0, 0.0, 1.0]), "neither", DIFFERENCES), True)
        largest = steps.levels[-1]
        width = steps.levels[1] - steps.levels[0]
        count = max(round(largest / width), 1)
        levels = np.linspace(-count * width, count * width, 2 * count + 1)
        return cls(quantity, Steps(levels, "neither", DIFFERENCES), is_difference=True)

    @property
    def is_category(self) -> bool:
        """Whether the values are whole numbers that stand for something."""
        return self.quantity.is_category and not self.is_difference

    @property
    def title(self) -> str:
        unit = self.quantity.unit
        title = f"{self.quantity.title} [{unit}]" if unit else self.quantity.title
        return f"{title}, now less A" if self.is_difference else title

    def note(self, answer: MapAnswer) -> str:
        """Return which cables the values are of, and whether of an older state."""
        cables = cables_words(None if self.quantity.key == "diameter" else answer.rope)
        if answer.before is not None and answer.rope != answer.before.rope:
            cables = f"{cables}; A: {cables_words(answer.before.rope)}"
        return f"{cables}; of an older state" if self.is_old else cables

    @property
    def span(self) -> tuple[float, float]:
        """Of the values that have a colour of their own."""
        if self.is_category:
            return -0.5, len(CATEGORY_COLOURS) - 0.5
        if self.steps is None:
            return 0.0, 1.0
        return float(self.steps.edges[0]), float(self.steps.edges[-1])

    @property
    def table(self) -> Any:
        import matplotlib
        import pyvista
        from matplotlib.colors import ListedColormap

        if self.is_category:
            colours: Any = ListedColormap(list(CATEGORY_COLOURS))
        elif self.steps is None:
            colours = matplotlib.colormaps["viridis"].resampled(2)
        else:
            colours = self.steps.colormap
        if self.is_old:
            shares = colours(np.arange(colours.N))[:, :3] @ _LUMINANCE
            colours = ListedColormap(np.repeat(shares[:, None], 3, axis=1))
        return pyvista.LookupTable(colours, n_values=colours.N)

    def of(self, answer: MapAnswer) -> Values:
        values = answer.values
        change = answer.difference(self.quantity.key) if self.is_difference else None
        scaled = values[self.quantity.key] if change is None else change
        if self.is_category:
            scaled = np.where(np.isfinite(scaled), np.mod(scaled, len(CATEGORY_COLOURS)), np.nan)
        else:
            scaled = scaled * self.quantity.scale
        left_out = values["left_out"] > 0.5
        unserved = (values["verdict"] != Verdict.SOLVED) & ~left_out
        if "unserved" in values:
            unserved |= values["unserved"] > 0.5
        return Values(scaled, unserved, left_out)

    def colours(self, values: Values) -> NDArray[np.uint8]:
        """Return red, green and blue (n, 3) of single points."""
        low, high = self.span
        count = self.table.n_values
        step = np.clip((np.nan_to_num(values.scaled) - low) / (high - low) * count, 0, count - 1)
        colours = np.asarray(self.table.values)[step.astype(int), :3].copy()
        colours[~np.isfinite(values.scaled)] = rgb(current_theme().muted)
        colours[values.is_left_out] = rgb(current_theme().left_out)
        colours[values.is_unserved] = rgb(current_theme().hatch[1])
        return colours

    def keys(self, answer: MapAnswer) -> list[Key]:
        """Return what beside the scale has to be explained, where it occurs."""
        values = self.of(answer)
        keys: list[Key] = []
        if self.is_category:
            labels = category_labels(self.quantity.key, len(CATEGORY_COLOURS))
            present = np.unique(values.scaled[np.isfinite(values.scaled)]).astype(int)
            for code, meaning in labels.items():
                if code % len(CATEGORY_COLOURS) in present:
                    keys.append(Key(CATEGORY_COLOURS[code % len(CATEGORY_COLOURS)], meaning))
        if values.is_unserved.any():
            hatch = current_theme().hatch
            keys.append(Key(hatch[0], "no rope serves", hatch[1]))
        if values.is_left_out.any():
            keys.append(Key(current_theme().left_out, "excluded: a cable hangs below"))
        return keys


def rgb(colour: str) -> NDArray[np.uint8]:
    """Return red, green and blue (3,) of a colour such as ``#0072B2``."""
    from matplotlib.colors import to_rgb

    return np.round(255.0 * np.array(to_rgb(colour))).astype(np.uint8)


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
        return bool(self.actor.visibility)

    def show(self, is_shown: bool) -> None:
        self.actor.visibility = is_shown

    def colour(self, colour: str) -> None:
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
        points = points_m.reshape(-1, 3)
        self._put(points, "verts", np.arange(len(points))[:, None])

    def paint(self, colours: NDArray[np.uint8]) -> None:
        self.mesh.point_data["colour"] = colours
        self.mesh.point_data.active_scalars_name = "colour"
        self.mapper.scalar_map_mode = "point"
        self.mapper.color_mode = "direct"
        self.mapper.scalar_visibility = True


class Body(Piece):
    """Triangles or quadrangles of one colour."""

    def put(self, points_m: FloatArray, faces: Faces) -> None:
        self._put(points_m if len(faces) else np.empty((0, 3)), "faces", faces)


@dataclass(frozen=True, slots=True, eq=False)
class Hit:
    """A place on the map (3,) [m], and the grid point next to it: of which grid, and which one."""

    position_m: FloatArray
    grid: str
    number: int


_STRIPES = 50.0  #: Over the size of all that is shown
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
        for piece in self.pieces:
            piece.show(is_shown)

    @property
    def is_visible(self) -> bool:
        return self.coloured.is_visible

    def follow_theme(self, theme: Theme) -> None:
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
        import pyvista

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
        faces = self._faces
        if len(faces) == 0:
            return
        hatched = values.is_unserved[faces].any(axis=1)
        left_out = values.is_left_out[faces].any(axis=1) & ~hatched
        valued = ~np.isnan(values.scaled)[faces].any(axis=1) & ~left_out
        kinds = (valued, hatched & ~valued, left_out, hatched)
        for piece, chosen in zip(self.pieces, kinds, strict=True):
            piece.mesh.cell_data.clear()
            piece.mesh.verts = np.empty(0, dtype=np.int64)
            corners = faces[chosen]
            sides = np.full((len(corners), 1), 4, dtype=np.int64)
            piece.mesh.faces = np.hstack([sides, corners]).ravel()
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


def _outward(points_m: FloatArray, faces: Faces) -> Faces:
    """Corners of faces of a convex body in the order that shows their fronts outside."""
    corners = points_m[faces]
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    middle = 0.5 * (points_m.min(axis=0) + points_m.max(axis=0))
    inward = np.einsum("fk,fk->f", normal, corners.mean(axis=1) - middle) < 0.0
    return np.where(inward[:, None], faces[:, ::-1], faces)


NEAR_PX = 10.0  #: As far as a hand with a mouse misses a dot

_BELOW = 5e-3  #: How far the floor lies below everything, over the size of the scene


class SceneActors:
    """Robot, floor, map, cables and marks of one plotter."""

    def __init__(self, plotter: Any) -> None:
        self.shell = MapSurface(plotter, "surface", inside=True)
        self.slice = MapSurface(plotter, "slice")
        self.dots = Dots(plotter, "points", 9.0)
        self.floor = Lines(plotter, "floor", 1.0, before=0.0, opacity=0.5)
        self.region = Lines(plotter, "region", 1.2)
        self.rim = Lines(plotter, "slice rim", 1.4, before=2.0)
        self.base = Lines(plotter, "base", 2.0)
        self.posts = Lines(plotter, "posts", 1.2, before=0.0)
        self.chords = Lines(plotter, "chords", 1.0, opacity=0.6)
        self.cables = Lines(plotter, "cables", 2.5, before=3.0)
        self.exits = Dots(plotter, "exit points", 8.0)
        self.body = Body(plotter, "platform", before=3.0)
        self.edges = Lines(plotter, "platform edges", 1.6, before=4.0)
        self.mass = Dots(plotter, "load", 12.0, before=5.0)
        self.rows = Dots(plotter, "measured rows", 7.0, before=6.0)
        self.is_planar = False
        self.plane_normal = np.array([0.0, 1.0, 0.0])
        self.bounds_m = np.array([[-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]])
        self._faces = np.empty((0, 3), dtype=np.int64)
        self._edges = np.empty((0, 2), dtype=np.int64)
        self._points_m = np.empty((0, 3))
        self.attachments_m = np.empty((0, 3))

    @property
    def level_normal(self) -> FloatArray:
        """Of what is dragged in: the level, or the plane of a planar robot."""
        return self.plane_normal if self.is_planar else np.array([0.0, 0.0, 1.0])

    @property
    def map_surfaces(self) -> tuple[MapSurface, MapSurface]:
        return self.shell, self.slice

    def follow_theme(self) -> None:
        colours = current_theme()
        for surface in self.map_surfaces:
            surface.follow_theme(colours)
        pieces_by_colour: Mapping[str, list[Any]] = {
            colours.border: [self.floor],
            colours.muted: [self.region, self.base, self.posts, self.chords],
            colours.cable: [self.cables, self.exits, self.mass, self.edges, self.rim],
            colours.accent: [self.body],
        }
        for colour, pieces in pieces_by_colour.items():
            for piece in pieces:
                piece.colour(colour)

    def put_study(self, study: Study) -> None:
        robot, points = study.robot, study.robot.exit_points_m
        edges = np.empty((0, 2, 3))
        self.is_planar = robot.is_planar
        if robot.is_planar:
            self.plane_normal = np.asarray(robot.upright[1])
        everything = [points]
        if study.workspace is not None:
            region = study.workspace.region
            edges = region.border().edges_m
            everything.append(region.bounds_m)
        elif study.pose is not None:
            everything.append(study.pose.position_m[None])
        around = np.concatenate(everything)
        self.bounds_m = np.array([around.min(axis=0), around.max(axis=0)])
        # A little below, so that its lines do not shine through the lowest face of the region.
        below = _BELOW * float(np.ptp(self.bounds_m, axis=0).max())
        self.floor.put(floor_m(self.bounds_m, below))
        self.region.put(edges)
        self.base.put([base_outline_m(robot)])
        self.posts.put(posts_m(points, self.bounds_m[0, 2] - below))
        self.exits.put(points)
        self._faces = hull_faces(robot.attachments_m)
        self._edges = hull_edges(robot.attachments_m, self._faces)

    def put_place(
        self, study: Study, place: FloatArray, answer: PoseAnswer | None, factor: float
    ) -> None:
        """Show platform and cables; without an answer yet, the cables straight.

        Where the answer is of a place beside this, each cable follows its attachment point.
        """
        pose = Poses.at(place)
        ends = pose.attachment_points_m(study.robot)
        chords = np.stack([study.robot.exit_points_m, ends], axis=1)
        self.chords.put(chords)
        curves = None if answer is None else answer.curves_exaggerated_m(factor)
        if curves is not None:
            share = np.linspace(0.0, 1.0, curves.shape[1])[:, None]
            curves = curves + share * (ends - curves[:, -1])[:, None]
        self.cables.put(chords if curves is None else curves)
        self.attachments_m = ends
        if study.robot.is_point_mass or len(self._faces) == 0:
            self.body.put(np.empty((0, 3)), self._faces)
            self.edges.put([] if study.robot.is_point_mass else [ends])
        else:
            self.body.put(ends, self._faces)
            self.edges.put(ends[self._edges])
        self.mass.put(pose.position_m[None])

    def put_map(self, answer: MapAnswer | None, painting: Painting | None) -> None:
        """Colour the map; None takes it away."""
        grids = {} if answer is None else answer.grids
        shell = [name for name in grids if name not in ("slice", "points")]
        level = [name for name in grids if name == "slice"]
        for surface, names in ((self.shell, shell), (self.slice, level)):
            surface.put_grids({name: grids[name] for name in names})
            if answer is not None and painting is not None:
                surface.paint(painting, painting.of(answer).at(answer.points_of(names)))
        self.rim.put([grids[name][-1] for name in level])
        self._points_m = grids["points"].reshape(-1, 3) if "points" in grids else np.empty((0, 3))
        self.dots.put(self._points_m)
        if len(self._points_m) and answer is not None and painting is not None:
            self.dots.paint(painting.colours(painting.of(answer)))

    def put_rows(self, position_m: FloatArray, sizes: FloatArray, brightest: float) -> None:
        """Show measured rows (n,), coloured by how much is left of them, up to ``brightest``."""
        import matplotlib

        self.rows.put(position_m)
        if len(position_m):
            share = np.clip(np.nan_to_num(sizes) / brightest, 0.0, 1.0)
            table = matplotlib.colormaps["magma"]
            self.rows.paint(np.round(255.0 * table(share)[:, :3]).astype(np.uint8))

    def hit(
        self, start_m: FloatArray, end_m: FloatArray, pixel: FloatArray, view: View
    ) -> Hit | None:
        if len(self._points_m):
            away = np.linalg.norm(view.pixels(self._points_m) - pixel, axis=1)
            number = int(np.argmin(away))
            is_near = away[number] <= NEAR_PX
            return Hit(self._points_m[number], "points", number) if is_near else None
        hits = [
            hit
            for surface in self.map_surfaces
            if (hit := surface.first_hit(start_m, end_m)) is not None
        ]
        if not hits:
            return None
        return min(hits, key=lambda hit: float(np.linalg.norm(hit.position_m - start_m)))

    def everything_m(self) -> FloatArray:
        """Return the corners of the box that the camera shall see (8, 3) [m]."""
        low, high = self.bounds_m
        return np.array(np.meshgrid(*zip(low, high, strict=True))).reshape(3, -1).T
