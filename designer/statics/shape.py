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
    """Return how far each cable strays from the line between its ends (..., n_cables) [m].

    It is farthest where it is parallel to that line, at the unstrained length s with
    V(s) / F_x = -D / X, where V(s) = F_z + w (s - l). A vertical cable does not stray.
    """
    length, force_x, force_z, stiffness, weight = statics.catenaries
    chord = statics.geometry()
    X, D = chord.horizontal_distance_m, chord.drop_m
    with np.errstate(invalid="ignore", divide="ignore"):
        s = length - (force_z + force_x * D / X) / weight
        s = np.where(X > 0.0, np.clip(s, 0.0, length), 0.0)
        x, z = catenary.position_m(s, length, force_x, force_z, stiffness, weight)
        return np.asarray(np.abs(x * D + z * X) / chord.chord_m)


def stretch_m(statics: Statics) -> FloatArray:
    """Return how much longer each cable is under its load (..., n_cables) [m].

    The integral of T / EA over the unstrained length between pulley and platform, with
    T = √(F_x² + V(s)²), by Gauss's rule with 16 points.
    """
    length, force_x, force_z, stiffness, weight = (v[..., None] for v in statics.catenaries)
    s = 0.5 * (1.0 + _POINTS) * length
    tension = np.hypot(force_x, force_z + weight * (s - length))
    return np.asarray((tension * _WEIGHTS).sum(axis=-1) * (0.5 * length / stiffness)[..., 0])
