"""How far cables hang through, and how much they stretch."""

from __future__ import annotations

import numpy as np

from designer.arrays import FloatArray
from designer.physics import catenary
from designer.statics.inverse import Statics

_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(16)


def exit_angle_rad(statics: Statics) -> FloatArray:
    """Return how far below the horizontal each cable leaves its exit point (..., n_cables) [rad].

    With V_0 = F_z - w l, the vertical pull at the exit point, tan α = -V_0 / F_x.
    """
    length, force_x, force_z, _, weight = statics.catenaries
    return np.asarray(np.arctan2(weight * length - force_z, force_x))


def sag_m(statics: Statics) -> FloatArray:
    """Return how far each cable strays from its chord (..., n_cables) [m]; see `physics.catenary`.

    Below the lower end is along the load on the cables, of weight and wind.
    """
    chord = statics.geometry()
    return catenary.sag_m(*statics.catenaries, chord.horizontal_distance_m, chord.drop_m)


def sag_ratio(statics: Statics) -> FloatArray:
    """Return the sag of each cable over its chord (..., n_cables), which `Robot.sag_max` limits."""
    return sag_m(statics) / statics.geometry().chord_m


def stretch_m(statics: Statics) -> FloatArray:
    """Return how much longer each cable is under its load (..., n_cables) [m].

    The integral of T / EA over the unstrained length between pulley and platform, with
    T = √(F_x² + V(s)²), by Gauss's rule with 16 points.
    """
    length, force_x, force_z, stiffness, weight = (v[..., None] for v in statics.catenaries)
    s = 0.5 * (1.0 + _POINTS) * length
    tension = np.hypot(force_x, force_z + weight * (s - length))
    return np.asarray((tension * _WEIGHTS).sum(axis=-1) * (0.5 * length / stiffness)[..., 0])
