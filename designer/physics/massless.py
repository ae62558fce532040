"""The massless, inextensible cable: a straight line (Riehl et al., ICRA 2010, section II.A)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from designer.arrays import FloatArray


def length_m(horizontal_distance_m: ArrayLike, drop_m: ArrayLike) -> FloatArray:
    """Return the length of a straight cable (...) [m].

    Parameters
    ----------
    horizontal_distance_m, drop_m : array (...)
        Horizontal distance and drop from exit point to attachment point [m].
    """
    return np.asarray(np.hypot(horizontal_distance_m, drop_m))


def tension_N(
    horizontal_force_N: ArrayLike, horizontal_distance_m: ArrayLike, drop_m: ArrayLike
) -> FloatArray:
    """Return the tension of a straight cable from its horizontal force (...) [N].

    A vertical cable has none, so its tension is NaN unless the force is zero as well: there the
    statics work with the force density H / X instead.
    """
    slope_length = length_m(horizontal_distance_m, drop_m)
    with np.errstate(invalid="ignore", divide="ignore"):
        density = np.asarray(horizontal_force_N) / np.asarray(horizontal_distance_m)
    return np.asarray(density * slope_length)
