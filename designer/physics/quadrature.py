r"""The cable equation integrated numerically: shares nothing with `designer.physics.catenary`.

With the frame and the names of that module, V(s) = F_z + w (s - l) and T = √(F_x² + V²),

.. math::  \frac{dx}{ds} = \frac{F_x}{T}\Big(1 + \frac{T}{EA}\Big), \qquad
           \frac{dz}{ds} = \frac{V}{T}\Big(1 + \frac{T}{EA}\Big),

the equilibrium of an element (Irvine 1981), by adaptive Gauss-Kronrod quadrature (QUADPACK).
"""

from __future__ import annotations

from math import hypot

import numpy as np

_ACCURACY = 1e-12


def end_position_m(
    length_m: float, force_x_N: float, force_z_N: float, stiffness_N: float, weight_N_per_m: float
) -> tuple[float, float]:
    """Return x and z of the platform end of one cable [m].

    Parameters
    ----------
    length_m : float
        Unstrained length between exit point and platform [m].
    force_x_N, force_z_N : float
        Force on the cable at the platform [N].
    stiffness_N, weight_N_per_m : float
        EA [N] and weight per unstrained length [N/m].
    """
    from scipy.integrate import quad

    # A slack cable bends over a length of F_x / w about its lowest point, on one side or both.
    bend_m, lowest_m = force_x_N / weight_N_per_m, length_m - force_z_N / weight_N_per_m
    steps_m = bend_m * 10.0 ** np.arange(12)
    ends_m = np.concatenate([lowest_m - steps_m, [lowest_m], lowest_m + steps_m])
    pieces_m = ends_m[(ends_m > 0.0) & (ends_m < length_m)]

    def slopes(s_m: float) -> tuple[float, float]:
        upward_N = force_z_N + weight_N_per_m * (s_m - length_m)
        tension_N = hypot(force_x_N, upward_N)
        stretch = 1.0 + tension_N / stiffness_N
        return force_x_N / tension_N * stretch, upward_N / tension_N * stretch

    x, z = (
        quad(
            lambda s, k=k: slopes(s)[k],
            0.0,
            length_m,
            points=pieces_m if len(pieces_m) else None,
            epsabs=_ACCURACY * length_m,
            epsrel=_ACCURACY,
            limit=500,
        )[0]
        for k in range(2)
    )
    return x, z
