r"""A sagging cable that oscillates: a chain of catenaries with their mass at their ends.

Each of n elements of equal unstrained length is in balance as it hangs, so that its stiffness is
the tangent of its own catenary (`designer.physics.tangent`), and that of the chain at rest is the
tangent of the cable, whatever n. Its mass m = μl/n stands as the mean of the lumped matrix, with
which the frequencies of a string come out too low, and the consistent one, with which they come out
as much too high: 5/12 at each end and 1/12 between, exact but for terms of fourth order in 1/n.

At the square :math:`λ = (2 π f)^2` of a frequency the nodes are eliminated from the exit point on:
with E what the chain so far resists with at its end,

.. math::

    P = E + K_e - \tfrac{5}{12} λ m, \qquad
    E' = K_e - \tfrac{5}{12} λ m - B P^{-1} B, \qquad B = K_e + \tfrac{1}{12} λ m

and the negative eigenvalues of all P are as many as the modes of the cable, held at both ends,
below that frequency (Wittrick and Williams, Q. J. Mech. Appl. Math. 24 (1971), page 263).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from designer.arrays import FloatArray, IntArray
from designer.physics import catenary, tangent

_VERTICAL = 1e-12
"""Horizontal distance over length: what rounding leaves of nothing."""
_STIFFEST = 1e-10
"""Least determinant of a flexibility over its diagonal's product, where cables do not stretch."""


@dataclass(frozen=True, slots=True, eq=False)
class Chain:
    """Cables (...) as chains of n elements.

    ``stiffness_N_per_m`` (n, 4, ...) has of each element, from the exit point on, the entries xx,
    xz and zz in the plane of the cable and that across it; ``mass_kg`` (...) is that of each.
    """

    stiffness_N_per_m: FloatArray
    mass_kg: FloatArray

    def resistance_N_per_m(self, square_per_s2: FloatArray) -> tuple[FloatArray, IntArray]:
        """Return how cables resist at the platform, at squares (2πf)² (...), and modes below.

        The former (4, ...) as `stiffness_N_per_m`, of ends that oscillate so; the latter (...) of
        cables that are held at both ends. Squares may have more axes than cables.
        """
        inertia = square_per_s2 * self.mass_kg
        at_end, between = 5.0 / 12.0 * inertia, inertia / 12.0
        a, b, c, across = self.stiffness_N_per_m[0]
        a, c, across = a - at_end, c - at_end, across - at_end
        below = np.zeros(a.shape, dtype=np.int64)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            for k_a, k_b, k_c, k_across in self.stiffness_N_per_m[1:]:
                e_a, e_c, e_across = k_a - at_end, k_c - at_end, k_across - at_end
                p, q, r, s = a + e_a, b + k_b, c + e_c, across + e_across
                determinant = p * r - q * q
                is_saddle = determinant < 0.0
                below += is_saddle
                below += s < 0.0
                below += 2 * ((p < 0.0) & ~is_saddle)
                x, y, z, w = k_a + between, k_b, k_c + between, k_across + between
                u, v = (r * x - q * y) / determinant, (p * y - q * x) / determinant
                a, b = e_a - (x * u + y * v), k_b - (y * u + z * v)
                c = e_c - (y * (r * y - q * z) + z * (p * z - q * y)) / determinant
                across = e_across - w * w / s
        return np.stack(np.broadcast_arrays(a, b, c, across)), below


def chain_of(
    length_m: FloatArray,
    force_x_N: FloatArray,
    force_z_N: FloatArray,
    axial_stiffness_N: FloatArray,
    weight_N_per_m: FloatArray,
    linear_density_kg_per_m: FloatArray | float,
    count: int,
) -> Chain:
    """Return cables (...) as chains of so many elements.

    Arguments as those of `designer.physics.tangent.flexibility_m_per_N`, and the mass per
    unstrained length, which wind leaves as it is [kg/m].
    """
    length, F_x, F_z, EA, w = np.broadcast_arrays(
        length_m, force_x_N, force_z_N, axial_stiffness_N, weight_N_per_m
    )
    share = (np.arange(count + 1.0) / count).reshape(-1, *(1,) * length.ndim)
    piece, V = length / count, F_z - w * length * (1.0 - share[1:])
    C = tangent.flexibility_m_per_N(piece, F_x, V, EA, w)
    a, b, c = C[..., 0, 0], C[..., 0, 1], C[..., 1, 1]
    with np.errstate(invalid="ignore", divide="ignore"):
        determinant = np.maximum(a * c - b * b, _STIFFEST * a * c)
        folds = np.isinf(a)  # straight up and down, where it does not resist along x
        plane = [
            np.where(folds, free, v / determinant) for free, v in ((0, c), (0, -b), (1 / c, a))
        ]
        x, _ = catenary.position_m(share * length, length, F_x, F_z, EA, w)
        swing = np.where(_VERTICAL * length >= x[-1], plane[0], F_x / np.diff(x, axis=0))
    mass = np.asarray(linear_density_kg_per_m * piece)
    return Chain(np.stack([*plane, swing], axis=1), mass)
