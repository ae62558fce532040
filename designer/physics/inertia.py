r"""How much of a sagging cable's mass moves with its end: its consistent mass.

The end moves slowly beside the cable's own oscillations, which therefore hangs as a catenary of
fixed length at every instant. With C(s) the flexibility of the part up to the unstrained length s
(`designer.physics.tangent`), a point at s then moves by :math:`N(s) = C(s)\,C(l)^{-1}` times the
motion of the end in the vertical plane, and by :math:`x(s)/X` times that across it:

.. math::

    M = μ \int_0^l N^\mathsf{T} N \, ds, \qquad M_\perp = μ \int_0^l (x(s) / X)^2 \, ds

This is Guyan's reduction of the cable to its end (AIAA Journal 3 (1965), page 380), the exact term
in ω² of its dynamic stiffness, so that frequencies come out too high by terms of (ω / ω_1)², with
ω_1 the lowest of the cable held at both ends. For a taut one the stiffness across is
:math:`(T / l)\, x \cot x`, of which :math:`1 - x^2/3` is kept and :math:`x^4/45` comes next, with
:math:`x = π f / f_1`; where a share ε of the moving mass is the cables', the frequency f is too
high by ε π²/30 (f / f_1)² of itself.
"""

from __future__ import annotations

import numpy as np

from designer.arrays import FloatArray
from designer.physics import catenary, tangent

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)
_FOLDED_M_PER_N = 1e150
"""In place of an infinite flexibility."""
_VERTICAL = 1e-12
"""Horizontal distance over length: what rounding leaves of nothing."""
NEXT_TERM = np.pi**2 / 30.0


def consistent_mass_kg(
    length_m: FloatArray,
    force_x_N: FloatArray,
    force_z_N: FloatArray,
    axial_stiffness_N: FloatArray,
    weight_N_per_m: FloatArray,
    linear_density_kg_per_m: FloatArray | float,
) -> tuple[FloatArray, FloatArray]:
    """Return what moves with a cable's end, in its plane (..., 2, 2) and across it (...) [kg].

    Parameters
    ----------
    length_m, force_x_N, force_z_N, axial_stiffness_N, weight_N_per_m : array (...)
        As for `designer.physics.tangent.flexibility_m_per_N`.
    linear_density_kg_per_m : float or array (...)
        Mass per unstrained length, which wind leaves as it is [kg/m].

    Returns
    -------
    plane : array (..., 2, 2)
        Of motions along x and z of the cable's frame.
    across : array (...)
        Of those across its plane: of a vertical cable as along x.
    """
    length, F_x, F_z, EA, w = np.broadcast_arrays(
        length_m, force_x_N, force_z_N, axial_stiffness_N, weight_N_per_m
    )
    share = (0.5 * (1.0 + _NODES)).reshape(-1, *[1] * length.ndim)
    s = share * length
    V = F_z - w * (length - s)
    end = np.linalg.inv(_regular(tangent.flexibility_m_per_N(length, F_x, F_z, EA, w)))
    shape = _regular(tangent.flexibility_m_per_N(s, F_x, V, EA, w)) @ end
    mass = linear_density_kg_per_m * length
    weights = 0.5 * _WEIGHTS
    plane = np.einsum("k,k...ji,k...jl->...il", weights, shape, shape) * mass[..., None, None]
    x, _ = catenary.position_m(s, length, F_x, F_z, EA, w)
    X, _ = catenary.end_position_m(length, F_x, F_z, EA, w)
    with np.errstate(invalid="ignore", divide="ignore"):
        swing = mass * np.einsum("k,k...->...", weights, (x / X) ** 2)
    return plane, np.where(_VERTICAL * length >= X, plane[..., 0, 0], swing)


def _regular(flexibility: FloatArray) -> FloatArray:
    """Return flexibilities without infinite entries, and unit matrices where they are unknown."""
    unknown = np.isnan(flexibility).any(axis=(-2, -1), keepdims=True)
    return np.nan_to_num(np.where(unknown, np.eye(2), flexibility), posinf=_FOLDED_M_PER_N)
