"""The camera of the scene: the parallel view of the report's pictures, to be turned by hand."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from designer.arrays import FloatArray
from designer.report.figures.view import View, fitting

_STEEPEST_RAD = np.radians(89.0)
_LARGEST_ZOOM = 1e4


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
        kept = self.point(x_px, y_px)
        half = float(np.clip(self.view.half_height_m / factor, 1e-3, _LARGEST_ZOOM))
        self.view = replace(self.view, half_height_m=half)
        centre = self.view.centre_m + kept - self.point(x_px, y_px)
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
