"""All actors of the scene, each made once and filled from what was answered; and its camera.

The camera is the parallel view of the report's pictures, to be turned by hand.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from designer.arrays import FloatArray
from designer.explore.desktop import theme
from designer.explore.desktop.actors import Body, Dots, Faces, Hit, Lines, MapSurface
from designer.explore.desktop.painting import Painting
from designer.model.robot import Poses
from designer.report.figures.overlay import ticks_between
from designer.report.figures.scenes import base_outline_m
from designer.report.figures.stage import hull_faces
from designer.report.figures.view import View, fitting

if TYPE_CHECKING:
    from designer.explore.here import Here
    from designer.explore.map import MapAnswer
    from designer.study import Study

_STEEPEST_RAD = np.radians(89.0)
"""At the vertical itself the picture would have no upward direction."""
_LARGEST_ZOOM = 1e4
"""Half the height of the picture at most [m]: no robot is found again beyond that."""


@dataclass(slots=True)
class Camera:
    """A view onto a widget of some size [px]; x to the right and y downward from its corner."""

    view: View
    width_px: float
    height_px: float
    reach_m: float = 1.0  # Size of all that is on the stage, none of which lies behind the camera

    def fit(
        self, points_m: FloatArray, azimuth_rad: float, elevation_rad: float, right_px: float
    ) -> None:
        """See all points (n, 3) from this side, clear of a strip at the right."""
        frame = (0.05, 0.97 - right_px / self.width_px, 0.08, 0.92)
        aspect = self.width_px / self.height_px
        self.view = fitting(points_m, azimuth_rad, elevation_rad, frame, aspect)
        self.reach_m = float(np.linalg.norm(np.ptp(points_m, axis=0)))

    @property
    def pixels_per_m(self) -> float:
        """Pixels per metre across the line of sight."""
        return 0.5 * self.height_px / self.view.half_height_m

    def pixels(self, points_m: FloatArray) -> FloatArray:
        """Return where points (..., 3) land (..., 2) [px]."""
        offset = (np.asarray(points_m) - self.view.centre_m) * self.pixels_per_m
        right = 0.5 * self.width_px + offset @ self.view.right
        return np.stack([right, 0.5 * self.height_px - offset @ self.view.up], axis=-1)

    def point(self, x_px: float, y_px: float) -> FloatArray:
        """Return the point (3,) behind a pixel, at the depth of the centre [m]."""
        right = (x_px - 0.5 * self.width_px) / self.pixels_per_m
        up = (0.5 * self.height_px - y_px) / self.pixels_per_m
        return np.asarray(self.view.centre_m + right * self.view.right + up * self.view.up)

    def on_plane(
        self, x_px: float, y_px: float, through_m: FloatArray, normal: FloatArray
    ) -> FloatArray | None:
        """Return the point (3,) of a plane behind a pixel; None where it is seen from its edge."""
        along = self.view.toward_camera
        steepness = float(along @ normal)
        if abs(steepness) < 0.02:
            return None
        start = self.point(x_px, y_px)
        return np.asarray(start + along * float((through_m - start) @ normal) / steepness)

    def turn(self, right_px: float, down_px: float) -> None:
        """Turn about the vertical and lift, as a drag over so many pixels asks for."""
        azimuth = self.view.azimuth_rad - right_px * 0.008
        elevation = self.view.elevation_rad + down_px * 0.008
        clipped = float(np.clip(elevation, -_STEEPEST_RAD, _STEEPEST_RAD))
        self.view = replace(self.view, azimuth_rad=azimuth, elevation_rad=clipped)

    def shift(self, right_px: float, down_px: float) -> None:
        """Move the picture along with a drag."""
        offset = -right_px * self.view.right + down_px * self.view.up
        centre = self.view.centre_m + offset / self.pixels_per_m
        self.view = replace(self.view, centre_m=centre)

    def zoom(self, factor: float, x_px: float, y_px: float) -> None:
        """Bring the picture nearer; what is behind this pixel stays there."""
        anchor_m = self.point(x_px, y_px)
        half = float(np.clip(self.view.half_height_m / factor, 1e-3, _LARGEST_ZOOM))
        self.view = replace(self.view, half_height_m=half)
        centre = self.view.centre_m + anchor_m - self.point(x_px, y_px)
        self.view = replace(self.view, centre_m=centre)

    def aim(self, plotter: Any) -> None:
        """Point the camera of a plotter."""
        camera, view = plotter.camera, self.view
        far = 20.0 * view.half_height_m + 2.0 * self.reach_m
        camera.position = tuple(view.centre_m + far * view.toward_camera)
        camera.focal_point = tuple(view.centre_m)
        camera.up = (0.0, 0.0, 1.0)
        camera.parallel_projection = True
        camera.parallel_scale = view.half_height_m
        plotter.renderer.ResetCameraClippingRange()


_NEAR_PX = 10.0
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
        self.names: tuple[str, ...] = ()
        self.is_planar = False
        self.plane_normal = np.array([0.0, 1.0, 0.0])
        self.bounds_m = np.array([[-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]])
        self._faces = np.empty((0, 3), dtype=np.int64)
        self._points_m = np.empty((0, 3))

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
        floor = self.bounds_m[0, 2] - _BELOW * float(np.ptp(self.bounds_m, axis=0).max())
        self.floor.put(_floor_m(self.bounds_m, floor))
        self.region.put(edges)
        self.base.put([base_outline_m(robot)])
        self.posts.put(np.stack([points, points * [1, 1, 0] + [0, 0, floor]], axis=1))
        self.exits.put(points)
        self._faces = hull_faces(robot.attachments_m)

    def put_place(
        self, study: Study, place: FloatArray, answer: Here | None, factor: float
    ) -> None:
        """Show platform and cables; without an answer yet, the cables straight."""
        pose = Poses.at(place)
        ends = pose.attachment_points_m(study.robot)
        chords = np.stack([study.robot.exit_points_m, ends], axis=1)
        self.chords.put(chords)
        curves = None if answer is None else answer.curves_exaggerated_m(factor)
        self.cables.put(chords if curves is None else curves)
        if study.robot.is_point_mass or len(self._faces) == 0:
            self.body.put(np.empty((0, 3)), self._faces)
            self.edges.put([] if study.robot.is_point_mass else [ends])
        else:
            self.body.put(ends, self._faces)
            self.edges.put(_rims(ends, self._faces))
        self.mass.put(pose.position_m[None])

    def put_map(self, answer: MapAnswer | None, painting: Painting | None) -> None:
        """Colour the map; None takes it away."""
        grids = {} if answer is None else answer.grids
        self.names = tuple(grids)
        shell = [name for name in grids if name not in ("slice", "points")]
        level = [name for name in grids if name == "slice"]
        for surface, names in ((self.shell, shell), (self.slice, level)):
            surface.put_grids({name: grids[name] for name in names})
            if answer is not None and painting is not None:
                surface.paint(painting, painting.of(answer, names))
        self.rim.put([grids[name][-1] for name in level])
        self._points_m = grids["points"].reshape(-1, 3) if "points" in grids else np.empty((0, 3))
        self.dots.put(self._points_m)
        if len(self._points_m) and answer is not None and painting is not None:
            self.dots.paint(painting.colours(painting.of(answer, ["points"])))

    def put_rows(self, position_m: FloatArray, sizes: FloatArray, brightest: float) -> None:
        """Show measured rows (n,), coloured by how much is left of them, up to ``brightest``."""
        import matplotlib

        self.rows.put(position_m)
        if len(position_m):
            share = np.clip(np.nan_to_num(sizes) / brightest, 0.0, 1.0)
            table = matplotlib.colormaps["magma"]
            self.rows.paint(np.round(255.0 * table(share)[:, :3]).astype(np.uint8))

    def hit(
        self, start_m: FloatArray, end_m: FloatArray, pixel: FloatArray, camera: Camera
    ) -> Hit | None:
        """Return what of the map a line of sight meets first."""
        if len(self._points_m):
            away = np.linalg.norm(camera.pixels(self._points_m) - pixel, axis=1)
            number = int(np.argmin(away))
            is_near = away[number] <= _NEAR_PX
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


def _floor_m(bounds_m: FloatArray, floor_m: float) -> list[FloatArray]:
    """A grid of round numbers on the floor, and its rim."""
    low, high = bounds_m
    lines = []
    for axis, across in ((0, 1), (1, 0)):
        for at in [low[axis], *ticks_between(low[axis], high[axis]), high[axis]]:
            line = np.full((2, 3), floor_m)
            line[:, axis] = at
            line[:, across] = low[across], high[across]
            lines.append(line)
    return lines


def _rims(points_m: FloatArray, faces: Faces) -> list[FloatArray]:
    """Edges between faces (n, 3) that do not lie in one plane, each (2, 3) [m]."""
    import pyvista

    hull = pyvista.PolyData.from_regular_faces(points_m, faces)
    edges = hull.extract_feature_edges(feature_angle=20.0)
    ends = edges.lines.reshape(-1, 3)[:, 1:] if edges.n_cells else np.empty((0, 2), dtype=int)
    return [np.asarray(edges.points[pair], dtype=np.float64) for pair in ends]
