"""A parallel view of a scene: where the camera stands, and where each point lands on the picture.

Parallel, so that lengths along an axis can be read off anywhere in the picture.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np

from designer.arrays import FloatArray

WIDTH_PX, HEIGHT_PX = 1600, 1000
Frame = tuple[float, float, float, float]
"""Left, right, lower and upper bound of a part of the picture, as shares of it."""
_STEEPEST_RAD = np.radians(89.0)
"""At the vertical itself the picture would have no upward direction."""
_LARGEST_ZOOM = 1e4
"""Half the height of the picture at most [m]: no robot is found again beyond that."""
_RAD_PER_PX = 0.008
"""How far a drag turns the view."""


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """A camera that looks at the scene from far away.

    Parameters
    ----------
    azimuth_rad, elevation_rad : float
        Where the camera stands, seen from the scene: around the vertical from the x axis, and
        above the horizon [rad].
    centre_m : array (3,)
        What lands in the middle of the picture [m].
    half_height_m : float
        From the middle of the picture to its upper rim [m].
    width_px, height_px : float
        Of the picture; x goes to the right and y downward from its upper left corner.
    reach_m : float
        Size of all that is seen, none of which shall lie behind the camera [m].
    """

    azimuth_rad: float
    elevation_rad: float
    centre_m: FloatArray
    half_height_m: float
    width_px: float = WIDTH_PX
    height_px: float = HEIGHT_PX
    reach_m: float = 0.0

    @property
    def toward_camera(self) -> FloatArray:
        """Unit vector from the scene to the camera."""
        level = np.cos(self.elevation_rad) * np.array(
            [np.cos(self.azimuth_rad), np.sin(self.azimuth_rad)]
        )
        return np.append(level, np.sin(self.elevation_rad))

    @property
    def right(self) -> FloatArray:
        """Unit vector to the right in the picture."""
        return np.array([-np.sin(self.azimuth_rad), np.cos(self.azimuth_rad), 0.0])

    @property
    def up(self) -> FloatArray:
        """Unit vector upward in the picture."""
        return np.cross(self.toward_camera, self.right)

    @property
    def pixels_per_m(self) -> float:
        """Pixels per metre across the line of sight."""
        return 0.5 * self.height_px / self.half_height_m

    @property
    def to_camera_m(self) -> FloatArray:
        """From the middle of the picture to the camera (3,) [m]."""
        return (20.0 * self.half_height_m + 2.0 * self.reach_m) * self.toward_camera

    def pixels(self, points_m: FloatArray) -> FloatArray:
        """Return where points (..., 3) land (..., 2) [px]."""
        offset = (np.asarray(points_m) - self.centre_m) * self.pixels_per_m
        right = 0.5 * self.width_px + offset @ self.right
        return np.stack([right, 0.5 * self.height_px - offset @ self.up], axis=-1)

    def point(self, x_px: float, y_px: float) -> FloatArray:
        """Return the point (3,) behind a pixel, at the depth of the centre [m]."""
        right = (x_px - 0.5 * self.width_px) / self.pixels_per_m
        up = (0.5 * self.height_px - y_px) / self.pixels_per_m
        return np.asarray(self.centre_m + right * self.right + up * self.up)

    def on_plane(
        self, x_px: float, y_px: float, through_m: FloatArray, normal: FloatArray
    ) -> FloatArray | None:
        """Return the point (3,) of a plane behind a pixel; None where it is seen from its edge."""
        steepness = float(self.toward_camera @ normal)
        if abs(steepness) < 0.02:
            return None
        start = self.point(x_px, y_px)
        along_m = float((through_m - start) @ normal) / steepness
        return np.asarray(start + self.toward_camera * along_m)

    def turned(self, right_px: float, down_px: float) -> Self:
        """Return the view turned about the vertical and lifted, as a drag asks for."""
        elevation = self.elevation_rad + down_px * _RAD_PER_PX
        return replace(
            self,
            azimuth_rad=self.azimuth_rad - right_px * _RAD_PER_PX,
            elevation_rad=float(np.clip(elevation, -_STEEPEST_RAD, _STEEPEST_RAD)),
        )

    def shifted(self, right_px: float, down_px: float) -> Self:
        """Return the view in which the picture has moved along with a drag."""
        offset = -right_px * self.right + down_px * self.up
        return replace(self, centre_m=self.centre_m + offset / self.pixels_per_m)

    def zoomed(self, factor: float, x_px: float, y_px: float) -> Self:
        """Return the view from nearer; what is behind this pixel stays there."""
        half = float(np.clip(self.half_height_m / factor, 1e-3, _LARGEST_ZOOM))
        nearer = replace(self, half_height_m=half)
        offset = self.point(x_px, y_px) - nearer.point(x_px, y_px)
        return replace(nearer, centre_m=self.centre_m + offset)

    def aim(self, renderer: Any) -> None:
        """Point the camera of a renderer of VTK."""
        camera = renderer.GetActiveCamera()
        camera.SetPosition(*(self.centre_m + self.to_camera_m))
        camera.SetFocalPoint(*self.centre_m)
        camera.SetViewUp(0.0, 0.0, 1.0)
        camera.ParallelProjectionOn()
        camera.SetParallelScale(self.half_height_m)
        renderer.ResetCameraClippingRange()

    def shows(self, point_m: FloatArray) -> bool:
        """Tell whether a point (3,) lies in the picture."""
        x, y = self.pixels(point_m)
        return bool(0.0 <= x <= self.width_px and 0.0 <= y <= self.height_px)

    def nearer(self, points_m: FloatArray, pixels: float) -> FloatArray:
        """Return points (..., 3) moved toward the camera, so that they lie before a surface."""
        return np.asarray(points_m + self.toward_camera * pixels / self.pixels_per_m)


def fitting(
    points_m: FloatArray,
    azimuth_rad: float,
    elevation_rad: float,
    frame: Frame,
    size_px: tuple[float, float] = (WIDTH_PX, HEIGHT_PX),
) -> View:
    """Return the view in which all points (n, 3) land within a frame, as large as can be.

    ``azimuth_rad`` and ``elevation_rad`` tell where the camera stands, ``size_px`` is width and
    height of the picture.
    """
    left, right, low, high = frame
    aspect = size_px[0] / size_px[1]
    plain = View(azimuth_rad, elevation_rad, np.zeros(3), 1.0)
    across, upward = points_m @ plain.right, points_m @ plain.up
    half_height = max(
        0.5 * np.ptp(across) / (aspect * (right - left)), 0.5 * np.ptp(upward) / (high - low), 1e-6
    )
    middle = [0.5 * (across.min() + across.max()), 0.5 * (upward.min() + upward.max())]
    # the middle of the points shall land in the middle of the frame, not of the picture
    middle[0] -= half_height * aspect * (left + right - 1.0)
    middle[1] -= half_height * (low + high - 1.0)
    depth = float(np.mean(points_m @ plain.toward_camera))
    centre = plain.right * middle[0] + plain.up * middle[1] + plain.toward_camera * depth
    reach = float(np.linalg.norm(np.ptp(points_m, axis=0)))
    return View(azimuth_rad, elevation_rad, centre, half_height, *size_px, reach)


def clear_azimuth_rad(lines_m: FloatArray, elevation_rad: float) -> float:
    """Return the azimuth from which straight lines (n, 2, 3) [m] lie best apart in the picture.

    They may be cables and the outline of the base; the camera stands ``elevation_rad`` high.
    """
    share = np.array([0.3, 0.5, 0.7])[:, None]
    points = np.concatenate([a + share * (b - a) for a, b in lines_m])
    line = np.repeat(np.arange(len(lines_m)), len(share))
    first, second = np.triu_indices(len(points), 1)
    others = line[first] != line[second]
    first, second = first[others], second[others]
    azimuths = np.radians(np.arange(-90.0, 270.0, 7.5))
    azimuths = azimuths[np.abs(np.sin(2.0 * azimuths)) > 0.49]  # not along the x or the y axis

    def apart(azimuth: float) -> float:
        pixels = View(azimuth, elevation_rad, np.zeros(3), 1.0).pixels(points)
        gaps = np.sort(np.linalg.norm(pixels[first] - pixels[second], axis=1))
        return float(gaps[: len(lines_m)].sum())

    return float(max(azimuths, key=lambda azimuth: round(apart(float(azimuth)), 6)))


def facing_azimuth_rad(along: FloatArray) -> float:
    """Return the azimuth from which an upright plane is seen a little from the side [rad].

    ``along`` (2,) is the horizontal direction in the plane that shall point to the right.
    """
    return float(np.arctan2(-along[0], along[1]) + np.radians(25.0))
