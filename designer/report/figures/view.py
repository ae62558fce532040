"""A parallel view of a scene: where the camera stands, and where each point lands on the picture.

Parallel, so that lengths along an axis can be read off anywhere in the picture.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from designer.arrays import FloatArray

WIDTH_PX, HEIGHT_PX = 1600, 1000
Frame = tuple[float, float, float, float]
"""Left, right, lower and upper bound of a part of the picture, as shares of it."""


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
    """

    azimuth_rad: float
    elevation_rad: float
    centre_m: FloatArray
    half_height_m: float

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
        return 0.5 * HEIGHT_PX / self.half_height_m

    def pixels(self, points_m: FloatArray) -> FloatArray:
        """Return where points (..., 3) land, from the upper left corner (..., 2) [px]."""
        offset = (np.asarray(points_m) - self.centre_m) * self.pixels_per_m
        return np.stack(
            [0.5 * WIDTH_PX + offset @ self.right, 0.5 * HEIGHT_PX - offset @ self.up], axis=-1
        )

    def shows(self, point_m: FloatArray) -> bool:
        """Tell whether a point (3,) lies in the picture."""
        x, y = self.pixels(point_m)
        return bool(0.0 <= x <= WIDTH_PX and 0.0 <= y <= HEIGHT_PX)

    def nearer(self, points_m: FloatArray, pixels: float) -> FloatArray:
        """Return points (..., 3) moved toward the camera, so that they lie before a surface."""
        return np.asarray(points_m + self.toward_camera * pixels / self.pixels_per_m)


def fitting(
    points_m: FloatArray,
    azimuth_rad: float,
    elevation_rad: float,
    frame: Frame,
    aspect: float = WIDTH_PX / HEIGHT_PX,
) -> View:
    """Return the view in which all points (n, 3) land within a frame, as large as can be.

    ``azimuth_rad`` and ``elevation_rad`` tell where the camera stands, ``aspect`` the width of the
    picture over its height.
    """
    left, right, low, high = frame
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
    return View(azimuth_rad, elevation_rad, centre, half_height)


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
