r"""How the end force of a sagging cable changes as its end moves, at fixed unstrained length.

With t the unit tangent of the cable and n its unit normal in the vertical plane, a small change
of the end force moves the end by the flexibility

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
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from designer.arrays import FloatArray
from designer.physics import catenary

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(10)
SHORT_ARC = 0.5
"""Difference of asinh(V/F_x) below which ten nodes or more integrate to rounding."""


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
