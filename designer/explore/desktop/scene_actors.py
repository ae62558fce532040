"""All actors of the scene, each made once and filled from what was answered."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from designer.arrays import FloatArray
from designer.explore.desktop import theme
from designer.explore.desktop.actors import Body, Dots, Hit, Lines, MapSurface
from designer.explore.desktop.painting import Painting
from designer.model.robot import Poses
from designer.report.figures.parts import (
    base_outline_m,
    floor_m,
    hull_edges,
    hull_faces,
    posts_m,
)
from designer.report.figures.view import View

if TYPE_CHECKING:
    from designer.explore.here import Here
    from designer.explore.map import MapAnswer
    from designer.study import Study

NEAR_PX = 10.0
"""As far as a hand with a mouse misses a dot."""

_BELOW = 5e-3
"""How far the floor lies below everything, over the size of the scene."""


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
        """The surface of the region, and the slice."""
        return self.shell, self.slice

    def follow_theme(self) -> None:
        """Take the colours of the theme."""
        colours = theme.current()
        for surface in self.map_surfaces:
            surface.put_on(colours)
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
        """Show the robot's base and the region."""
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
        self, study: Study, place: FloatArray, answer: Here | None, factor: float
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
        """Return what of the map a line of sight meets first."""
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
