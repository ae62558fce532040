r"""How the end force of a sagging cable changes as its end moves, at rest and as it oscillates.

At fixed unstrained length, with t the unit tangent of the cable and n its unit normal in the
vertical plane, a small change of the end force moves the end by the flexibility

.. math::

    \frac{\partial(x, z)}{\partial(F_x, F_z)} =
        \frac{l}{EA} I + \int_0^l \frac{n\, n^\mathsf{T}}{T(s)}\, ds

the derivative of Irvine's catenary, Riehl et al., ICRA 2010, eqs. (7) and (8): the cable stretches
and its arc turns. The integral has a closed form; the tangent stiffness is the inverse.

Over a swivelling pulley (`designer.physics.pulley`) the free length l changes as the cable rolls
off, so l becomes a third unknown beside the two forces:

.. math::

    x(l, F) + R (1 + \sin α) = X, \quad z(l, F) + R \cos α = -D, \quad
    l + \frac{R (π/2 + α)}{1 + T_0 / EA} = l_\mathrm{total}

with α the slope and T_0 the tension at the upper end.

A cable that oscillates is a chain of catenaries with their mass at their ends. Each of n elements
of equal unstrained length is in balance as it hangs, so that its stiffness is the tangent of its
own catenary, and that of the chain at rest is the tangent of the cable, whatever n. Its mass m =
μl/n stands as the mean of the lumped matrix, with which the frequencies of a string come out too
low, and the consistent one, with which they come out as much too high: 5/12 at each end and 1/12
between, exact but for terms of fourth order in 1/n.

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
from numpy.typing import ArrayLike

from designer.arrays import FloatArray, IntArray
from designer.physics import catenary

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(10)
SHORT_ARC = 0.5
"""Difference of asinh(V/F_x) below which ten nodes or more integrate to rounding."""
_VERTICAL = 1e-12
"""Horizontal distance over length: what rounding leaves of nothing."""
_STIFFEST = 1e-10
"""Least determinant of a flexibility over its diagonal's product, where cables do not stretch."""


def flexibility_m_per_N(
    length_m: ArrayLike,
    force_x_N: ArrayLike,
    force_z_N: ArrayLike,
    axial_stiffness_N: ArrayLike,
    weight_N_per_m: ArrayLike,
) -> FloatArray:
    """Return ∂(x, z)/∂(F_x, F_z) at the attachment point (..., 2, 2) [m/N].

    Parameters
    ----------
    length_m : array (...)
        Unstrained length [m].
    force_x_N, force_z_N : array (...)
        Force on the cable at the attachment point, as in `designer.physics.catenary` [N].
    axial_stiffness_N, weight_N_per_m : array (...)
        EA [N] and weight per unstrained length [N/m].

    Returns
    -------
    array (..., 2, 2)
        Symmetric. Infinite in x for a vertical cable that folds at its lowest point.
    """
    length, F_x, F_z, EA, w = np.broadcast_arrays(
        *catenary.floats(length_m, force_x_N, force_z_N, axial_stiffness_N, weight_N_per_m)
    )
    V_0 = F_z - w * length
    T_0, T_l = np.hypot(F_x, V_0), np.hypot(F_x, F_z)
    angle, sinh = catenary.arc_angle(F_x, V_0, F_z, T_0, T_l, w * length)
    with np.errstate(invalid="ignore", divide="ignore"):
        # V/T at the attachment point less the same at the exit point, free of cancellation.
        turn = np.where(F_z * V_0 > 0.0, F_x**2 * sinh / (T_0 * T_l), F_z / T_l - V_0 / T_0)
    # The integral of n_x²/T over the cable. On short arcs its closed form is the difference of two
    # nearly equal numbers, but the integrand is smooth, so that ten nodes reach rounding; on longer
    # ones the closed form loses few digits.
    total = np.zeros(length.shape)
    for node, weight in zip(0.5 * (1.0 + _NODES), 0.5 * _WEIGHTS, strict=True):
        V = V_0 + node * w * length
        square = F_x * F_x + V * V
        with np.errstate(invalid="ignore", divide="ignore"):
            total += weight * V * V / (square * np.sqrt(square))
    across = np.where(angle < SHORT_ARC, length * total, (angle - turn) / w)
    stretch = length / EA
    skew = -F_x * length * (F_z + V_0) / ((T_l + T_0) * T_l * T_0)
    rows = [[stretch + across, skew], [skew, stretch + turn / w]]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def stiffness_N_per_m(
    length_m: FloatArray,
    force_x_N: FloatArray,
    force_z_N: FloatArray,
    axial_stiffness_N: FloatArray,
    weight_N_per_m: FloatArray,
) -> FloatArray:
    """Return ∂(F_x, F_z)/∂(x, z) of a cable from a fixed exit point (..., 2, 2) [N/m].

    The inverse of `flexibility_m_per_N`, with the same parameters.
    """
    C = flexibility_m_per_N(length_m, force_x_N, force_z_N, axial_stiffness_N, weight_N_per_m)
    stiffness = inverse(C)
    soft = np.isinf(C[..., 0, 0])
    if soft.any():  # an infinite entry gives a zero
        stiffness[soft] = 0.0
        stiffness[soft, 1, 1] = 1.0 / C[soft, 1, 1]
    return stiffness


def inverse(symmetric: FloatArray) -> FloatArray:
    """Return the inverse of symmetric matrices (..., 2, 2)."""
    a, b, c = symmetric[..., 0, 0], symmetric[..., 0, 1], symmetric[..., 1, 1]
    with np.errstate(invalid="ignore", divide="ignore"):
        determinant = a * c - b * b
        result = np.empty(symmetric.shape)
        result[..., 0, 0], result[..., 1, 1] = c / determinant, a / determinant
        result[..., 0, 1] = result[..., 1, 0] = -b / determinant
    return result


def stiffness_over_pulley_N_per_m(
    length_m: FloatArray,
    force_x_N: FloatArray,
    force_z_N: FloatArray,
    axial_stiffness_N: FloatArray,
    weight_N_per_m: FloatArray,
    radius_m: ArrayLike,
) -> FloatArray:
    """Return ∂(F_x, F_z)/∂(x, z) of a cable over a pulley, at fixed total length (..., 2, 2) [N/m].

    Parameters
    ----------
    length_m : array (...)
        Unstrained length between pulley and attachment point [m].
    force_x_N, force_z_N, axial_stiffness_N, weight_N_per_m : array (...)
        As for `flexibility_m_per_N`.
    radius_m : float or array (...)
        Pulley radius [m].
    """
    length, F_x, F_z, EA, w, R = np.broadcast_arrays(
        length_m, force_x_N, force_z_N, axial_stiffness_N, weight_N_per_m, np.asarray(radius_m)
    )
    V_0 = F_z - w * length
    T_0 = np.hypot(F_x, V_0)
    slope = np.arctan2(-V_0, F_x)
    strain = T_0 / EA
    end = flexibility_m_per_N(length, F_x, F_z, EA, w)
    # Slopes of V_0, T_0 and α in the unknowns F_x, F_z and l.
    V_by = np.stack([np.zeros_like(w), np.ones_like(w), -w], axis=-1)
    F_by = np.broadcast_to([1.0, 0.0, 0.0], V_by.shape)
    T_by = (F_x[..., None] * F_by + V_0[..., None] * V_by) / T_0[..., None]
    slope_by = (V_0[..., None] * F_by - F_x[..., None] * V_by) / (T_0**2)[..., None]
    along = np.stack([F_x, V_0], axis=-1) / T_0[..., None]
    position_by = np.concatenate([end, ((1.0 + strain)[..., None] * along)[..., None]], axis=-1)
    position_by = position_by + (R[..., None] * along)[..., None] * slope_by[..., None, :]
    wrap = R * (0.5 * np.pi + slope) / (1.0 + strain)
    total_by = (
        np.array([0.0, 0.0, 1.0])
        + (R / (1.0 + strain))[..., None] * slope_by
        - (wrap / (EA + T_0))[..., None] * T_by
    )
    jacobian = np.concatenate([position_by, total_by[..., None, :]], axis=-2)
    bad = ~np.isfinite(jacobian).all(axis=(-2, -1))[..., None, None]
    return np.where(bad, np.nan, np.linalg.inv(np.where(bad, np.eye(3), jacobian)))[..., :2, :2]


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

    Arguments as those of `flexibility_m_per_N`, and the mass per
    unstrained length, which wind leaves as it is [kg/m].
    """
    length, F_x, F_z, EA, w = np.broadcast_arrays(
        length_m, force_x_N, force_z_N, axial_stiffness_N, weight_N_per_m
    )
    share = (np.arange(count + 1.0) / count).reshape(-1, *(1,) * length.ndim)
    piece, V = length / count, F_z - w * length * (1.0 - share[1:])
    C = flexibility_m_per_N(piece, F_x, V, EA, w)
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
