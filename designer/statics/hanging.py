"""How far cables hang: their length over their chord, and the lowest point of their true shape."""

from __future__ import annotations

from designer.arrays import FloatArray
from designer.physics import catenary
from designer.statics.inverse import Statics


def length_over_chord(statics: Statics) -> FloatArray:
    """Return the unstrained length of each cable off its pulley over its chord (..., n_cables)."""
    return statics.free_length_m / statics.geometry().chord_m


def lowest_m(statics: Statics) -> FloatArray:
    """Return the height of the lowest point of each cable (..., n_cables), upright frame [m]."""
    below = catenary.lowest_z_m(
        statics.free_length_m,
        statics.force_x_N,
        statics.force_z_N,
        statics.axial_stiffness_N,
        statics.weight_N_per_m,
    )
    return statics.run.exit_points_m[..., 2] + below
