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
_TO_SERIES = (np.polynomial.legendre.legvander(_NODES, 15) * _WEIGHTS[:, None]).T * (
    np.arange(16.0)[:, None] + 0.5
)
_UP_TO_NODE = (
    0.5
    * np.polynomial.legendre.legval(_NODES, np.polynomial.legendre.legint(_TO_SERIES, lbnd=-1.0)).T
)
"""From values at the nodes to integrals (node, value), on an interval of unit length."""
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
    cable = np.broadcast_arrays(length_m, force_x_N, force_z_N, axial_stiffness_N, weight_N_per_m)
    a, b, c, x = (
        values.reshape(16, *cable[0].shape)
        for values in _along(*(value.ravel() for value in cable))
    )
    half = 0.5 * _WEIGHTS
    skew = np.tensordot(half, a * b + b * c, 1)
    rows = [
        [np.tensordot(half, a * a + b * b, 1), skew],
        [skew, np.tensordot(half, b * b + c * c, 1)],
    ]
    end = tangent.inverse(_regular(tangent.flexibility_m_per_N(*cable)))
    mass = np.asarray(linear_density_kg_per_m * cable[0])
    plane = end @ np.moveaxis(np.array(rows), (0, 1), (-2, -1)) @ end * mass[..., None, None]
    X, _ = catenary.end_position_m(*cable)
    with np.errstate(invalid="ignore", divide="ignore"):
        swing = mass * np.tensordot(half, x * x, 1) / X**2
    return plane, np.where(_VERTICAL * cable[0] >= X, plane[..., 0, 0], swing)


def _along(
    length: FloatArray, F_x: FloatArray, F_z: FloatArray, EA: FloatArray, w: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Return C_xx, C_xz, C_zz [m/N] and x [m] at the nodes of cables (16, n).

    On short arcs all are integrals of smooth functions from the exit point on, which the values at
    the nodes give at once; on longer ones each is a closed form.
    """
    share = 0.5 * (1.0 + _NODES)[:, None]
    stretch = share * length / EA
    V = F_z - w * length * (1.0 - share)
    T, V_0 = np.sqrt(F_x * F_x + V * V), F_z - w * length
    angle, _ = catenary.arc_angle(F_x, V_0, F_z, np.hypot(F_x, V_0), np.hypot(F_x, F_z), w * length)
    with np.errstate(invalid="ignore", divide="ignore"):
        along, up = F_x / T, V / T
        a = stretch + length * (_UP_TO_NODE @ (up * up / T))
        b = -length * (_UP_TO_NODE @ (along * up / T))
        c = stretch + length * (_UP_TO_NODE @ (along * along / T))
        x = F_x * stretch + length * (_UP_TO_NODE @ along)
    far = np.flatnonzero(~(angle < tangent.SHORT_ARC))
    if len(far):
        reach, F_x, EA, w = share * length[far], F_x[far], EA[far], w[far]
        C = _regular(tangent.flexibility_m_per_N(reach, F_x, V[:, far], EA, w))
        a[:, far], b[:, far], c[:, far] = C[..., 0, 0], C[..., 0, 1], C[..., 1, 1]
        x[:, far], _ = catenary.position_m(reach, length[far], F_x, F_z[far], EA, w)
    return a, b, c, x


def _regular(flexibility: FloatArray) -> FloatArray:
    """Return flexibilities without infinite entries, and unit matrices where they are unknown."""
    unknown = np.isnan(flexibility).any(axis=(-2, -1), keepdims=True)
    return np.nan_to_num(np.where(unknown, np.eye(2), flexibility), posinf=_FOLDED_M_PER_N)
