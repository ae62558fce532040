r"""A swivelling pulley at the exit point.

The cable enters vertically at the exit point A, runs over a pulley of radius R whose centre lies R
from A horizontally toward the platform, and leaves it tangentially. Where it leaves at an angle α
below the horizontal, the tangent point lies at

.. math::  A + R\,\big((1 + \sin\alpha)\,e + \cos\alpha\, z\big)

with e the horizontal unit vector toward the attachment point, and the cable has covered an arc
R (π/2 + α). After Pott, Cable-Driven Parallel Robots (2018), section 4.4, with the cable's own
slope for α.

The pulley's axis is horizontal and it swivels about the vertical through A, in wind as well: where
the load on the cable is not vertical, the cable bows out of the pulley's plane. The pulley still
faces the attachment point, and α is the slope of the cable's direction t where it leaves, projected
onto the plane of e and z:

.. math::  \tan α = -t_z / (t · e)

A pulley that swivels freely would follow the bow instead, by an angle of about half the side load
of the cable over its tension.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from designer.arrays import FloatArray


def tangent_point_m(
    exit_point_m: FloatArray, outward: FloatArray, slope_rad: FloatArray, radius_m: ArrayLike
) -> FloatArray:
    """Return where the cable leaves the pulley (..., 3) [m].

    Parameters
    ----------
    exit_point_m : array (..., 3)
        A, world frame [m].
    outward : array (..., 2)
        Horizontal unit vector toward the platform.
    slope_rad : array (...)
        Angle of the cable below the horizontal where it leaves, in the pulley's plane [rad].
    radius_m : float or array (...)
        Pulley radius [m].
    """
    radius = np.asarray(radius_m, dtype=np.float64)
    along = (radius * (1.0 + np.sin(slope_rad)))[..., None] * outward
    up = radius * np.cos(slope_rad)
    return np.asarray(exit_point_m + np.concatenate([along, up[..., None]], axis=-1))


def wrap_length_m(slope_rad: FloatArray, radius_m: ArrayLike) -> FloatArray:
    """Return the arc from A to the tangent point (...) [m]."""
    return np.asarray(np.asarray(radius_m) * (0.5 * np.pi + slope_rad))


def straight_slope_rad(
    horizontal_distance_m: FloatArray, drop_m: FloatArray, radius_m: ArrayLike
) -> FloatArray:
    """Return the angle below the horizontal of a straight cable that leaves tangentially (...).

    Parameters
    ----------
    horizontal_distance_m, drop_m : array (...)
        From A to the attachment point [m].
    radius_m : float or array (...)
        Pulley radius [m]; an attachment point inside the pulley gives NaN.
    """
    radius = np.asarray(radius_m, dtype=np.float64)
    beyond = horizontal_distance_m - radius
    distance = np.hypot(beyond, drop_m)
    with np.errstate(invalid="ignore"):
        return np.asarray(np.arctan2(drop_m, beyond) + np.arcsin(radius / distance))


def straight_length_m(
    horizontal_distance_m: FloatArray, drop_m: FloatArray, radius_m: ArrayLike
) -> FloatArray:
    """Return a straight cable's length from A on, the arc included (...) [m].

    Parameters are those of `straight_slope_rad`.
    """
    radius = np.asarray(radius_m, dtype=np.float64)
    slope = straight_slope_rad(horizontal_distance_m, drop_m, radius)
    with np.errstate(invalid="ignore"):
        free = np.sqrt((horizontal_distance_m - radius) ** 2 + drop_m**2 - radius**2)
    return np.asarray(free + wrap_length_m(slope, radius))


def lower_slope_rad(
    horizontal_distance_m: FloatArray, drop_m: FloatArray, radius_m: ArrayLike
) -> FloatArray:
    """Return α of the other tangent point from the attachment point (...): all else is between.

    Parameters are those of `straight_slope_rad`.
    """
    radius = np.asarray(radius_m, dtype=np.float64)
    beyond = horizontal_distance_m - radius
    with np.errstate(invalid="ignore"):
        width = np.arcsin(radius / np.hypot(beyond, drop_m))
    return np.asarray(np.arctan2(drop_m, beyond) + np.pi - width)
