r"""Irvine's elastic catenary: a cable under its own weight.

The frame of a cable has its origin at the exit point A, x toward the attachment point B and z
upward. ``force_x_N`` and ``force_z_N`` are the components of the force that acts on the cable at
B, as in Riehl et al., ICRA 2010: ``force_z_N`` is negative where the platform pulls down.

Along the unstrained length s, counted from A, with weight per length w, stiffness EA, unstrained
length l and V(s) = F_z + w (s - l) (eqs. (3) and (4) of the paper, after Irvine 1981):

.. math::

    x(s) = \frac{F_x s}{EA} + \frac{F_x}{w}\left[\sinh^{-1}\frac{V(s)}{F_x}
           - \sinh^{-1}\frac{V(0)}{F_x}\right]

    z(s) = \frac{F_z s}{EA} + \frac{w}{EA}\left(\frac{s^2}{2} - l s\right)
           + \frac{1}{w}\left[T(s) - T(0)\right], \quad T(s) = \sqrt{F_x^2 + V(s)^2}

Both brackets are differences of nearly equal numbers in a taut cable; they are evaluated through
their conjugates, so that the result keeps its digits.

Solving for the length or for the forces uses the equivalent form of
`designer.kernel.unit_cable`, whose one unknown is θ, half the change of the arc's slope angle
(in the hyperbolic sense): the closure then rises with θ without end, so the root is unique.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from designer.arrays import FloatArray

LARGEST_THETA = 350.0  # sinh² stays finite


def position_m(
    s_m: ArrayLike,
    length_m: ArrayLike,
    force_x_N: ArrayLike,
    force_z_N: ArrayLike,
    axial_stiffness_N: ArrayLike,
    weight_N_per_m: ArrayLike,
) -> tuple[FloatArray, FloatArray]:
    """Return x and z of the cable at unstrained length ``s_m`` from the exit point (...) [m].

    Riehl et al., ICRA 2010, eqs. (3) and (4); all arguments broadcast.
    """
    s, length, F_x, F_z, EA, w = floats(
        s_m, length_m, force_x_N, force_z_N, axial_stiffness_N, weight_N_per_m
    )
    V_0 = F_z - w * length
    V_s = F_z + w * (s - length)
    T_0, T_s = np.hypot(F_x, V_0), np.hypot(F_x, V_s)
    with np.errstate(invalid="ignore", divide="ignore"):
        rise = np.where(s == 0.0, 0.0, s * (V_s + V_0) / (T_s + T_0))
        angle, _ = arc_angle(F_x, V_0, V_s, T_0, T_s, w * s)
        arc = np.where(F_x == 0.0, 0.0, F_x / w * angle)
    x = F_x * s / EA + arc
    z = F_z * s / EA + w / EA * (0.5 * s * s - length * s) + rise
    return x, z


def arc_angle(
    F_x: FloatArray,
    V_0: FloatArray,
    V_s: FloatArray,
    T_0: FloatArray,
    T_s: FloatArray,
    change: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Return asinh(V_s/F_x) - asinh(V_0/F_x) and its sinh, with V_s - V_0 as ``change`` (...).

    T are the tensions. The conjugate form, which the sinh is, cancels only where the signs of the
    two slopes differ; there the plain difference does not.
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        sinh = change * (V_s + V_0) / (V_s * T_0 + V_0 * T_s)
        plain = np.arcsinh(V_s / F_x) - np.arcsinh(V_0 / F_x)
        return np.where(V_s * V_0 > 0.0, np.arcsinh(sinh), plain), sinh


def end_position_m(
    length_m: ArrayLike,
    force_x_N: ArrayLike,
    force_z_N: ArrayLike,
    axial_stiffness_N: ArrayLike,
    weight_N_per_m: ArrayLike,
) -> tuple[FloatArray, FloatArray]:
    """Return x and z of the attachment point in the cable's frame (...) [m].

    Riehl et al., ICRA 2010, eqs. (7) and (8).
    """
    return position_m(length_m, length_m, force_x_N, force_z_N, axial_stiffness_N, weight_N_per_m)


def end_tensions_N(
    length_m: ArrayLike, force_x_N: ArrayLike, force_z_N: ArrayLike, weight_N_per_m: ArrayLike
) -> tuple[FloatArray, FloatArray]:
    """Return the tension at the exit point, eq. (10), and at the platform (...) [N]."""
    length, F_x, F_z, w = floats(length_m, force_x_N, force_z_N, weight_N_per_m)
    return np.hypot(F_x, F_z - w * length), np.hypot(F_x, F_z)


def lowest_z_m(
    length_m: ArrayLike,
    force_x_N: ArrayLike,
    force_z_N: ArrayLike,
    axial_stiffness_N: ArrayLike,
    weight_N_per_m: ArrayLike,
) -> FloatArray:
    """Return z of the lowest point in the cable's frame, never above zero (...) [m].

    V(s) is zero there; without such a point between the ends it is the lower of the two.
    """
    length, F_x, F_z, EA, w = floats(
        length_m, force_x_N, force_z_N, axial_stiffness_N, weight_N_per_m
    )
    at = np.clip(length - F_z / w, 0.0, length)
    return np.minimum(position_m(at, length, F_x, F_z, EA, w)[1], 0.0)


def sag_m(
    length_m: ArrayLike,
    force_x_N: ArrayLike,
    force_z_N: ArrayLike,
    axial_stiffness_N: ArrayLike,
    weight_N_per_m: ArrayLike,
    horizontal_distance_m: ArrayLike,
    drop_m: ArrayLike,
) -> FloatArray:
    """Return how far the cable strays from its chord (...) [m].

    It is farthest where it is parallel to the chord, at the unstrained length s with
    V(s) / F_x = -D / X. A steep cable that is slack strays beyond the end of its chord instead:
    then it is how far its lowest point is below its lower end.
    """
    cable = floats(length_m, force_x_N, force_z_N, axial_stiffness_N, weight_N_per_m)
    X, D = floats(horizontal_distance_m, drop_m)
    length, F_x, F_z, _EA, w = cable
    with np.errstate(invalid="ignore", divide="ignore"):
        s = length - (F_z + F_x * D / X) / w
        s = np.where(X > 0.0, np.clip(s, 0.0, length), 0.0)
        x, z = position_m(s, *cable)
        across = np.abs(x * D + z * X) / np.hypot(X, D)
    return np.asarray(np.maximum(across, np.minimum(-D, 0.0) - lowest_z_m(*cable)))


def least_tension_N(
    length_m: ArrayLike, force_x_N: ArrayLike, force_z_N: ArrayLike, weight_N_per_m: ArrayLike
) -> FloatArray:
    """Return the least tension anywhere in the cable (...) [N].

    The horizontal force where the lowest point lies between the ends, else the tension at the lower
    end; V(s) of the module's equations is zero at the lowest point.
    """
    length, F_x, F_z, w = floats(length_m, force_x_N, force_z_N, weight_N_per_m)
    V_0 = F_z - w * length
    nearest = np.where(F_z * V_0 > 0.0, np.minimum(np.abs(F_z), np.abs(V_0)), 0.0)
    return np.asarray(np.hypot(F_x, nearest))


def length_and_force_z(
    force_density_N_per_m: ArrayLike,
    horizontal_distance_m: ArrayLike,
    drop_m: ArrayLike,
    axial_stiffness_N: ArrayLike,
    weight_N_per_m: ArrayLike,
) -> tuple[FloatArray, FloatArray]:
    """Return unstrained length [m] and vertical force F_z [N] from the horizontal force.

    Parameters
    ----------
    force_density_N_per_m : array (...)
        Horizontal force over horizontal distance, F_x / X [N/m]. The ratio instead of the force,
        because a vertical cable has no horizontal force, yet any tension.
    horizontal_distance_m, drop_m : array (...)
        Horizontal distance and drop from exit point to attachment point [m].
    axial_stiffness_N, weight_N_per_m : array (...)
        EA [N] and weight per unstrained length [N/m].

    Returns
    -------
    length_m, force_z_N : array (...)
        NaN where no finite length exists (force density not above zero).
    """
    density, X, D, EA, w = floats(
        force_density_N_per_m, horizontal_distance_m, drop_m, axial_stiffness_N, weight_N_per_m
    )
    kappa = w / EA
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        p = np.where(density > 0.0, density / w, np.nan)
        length = _length_from_pull(p, X, D, kappa)
        y = _mean_tension(length, 0.5 * (1.0 / p - kappa * length))
    return length, _force_z(length, y, D, kappa, w)


def _length_from_pull(p: FloatArray, X: FloatArray, D: FloatArray, kappa: FloatArray) -> FloatArray:
    """Return the root l of the closure for a given pull p; it lies below 1/(κ p), where θ = 0."""
    p, X, D, kappa = np.broadcast_arrays(p, X, D, kappa)
    low, high = np.zeros(p.shape), 1.0 / (kappa * p)
    theta = np.minimum(0.5 / p, LARGEST_THETA)
    straight = np.hypot(D, X * np.sinh(theta) / theta)
    length = straight / (1.0 + kappa * p * straight)
    for _ in range(200):
        theta = np.minimum(0.5 * (1.0 / p - kappa * length), LARGEST_THETA)
        f, slope = closure(theta, length, X, D, kappa)
        # The same closure, but now its slope in l, with θ going along.
        fall = -0.5 * kappa * slope + _closure_slope_in_length(theta, length, X, D, kappa)
        low, high = np.where(f > 0.0, length, low), np.where(f > 0.0, high, length)
        newton = length - f / fall
        inside = (newton >= low) & (newton <= high)
        new = np.where(inside, newton, 0.5 * (low + np.minimum(high, 4.0 * length)))
        converged = ~(np.abs(new - length) > 2e-15 * length)
        length = new
        if np.all(converged):
            break
    return length


def forces_from_length(
    length_m: ArrayLike,
    horizontal_distance_m: ArrayLike,
    drop_m: ArrayLike,
    axial_stiffness_N: ArrayLike,
    weight_N_per_m: ArrayLike,
) -> tuple[FloatArray, FloatArray]:
    """Return the forces F_x and F_z at the attachment point from the unstrained length (...) [N].

    Safeguarded Newton on θ, from cables stretched taut to cables that hang far below both ends. A
    vertical cable longer than its drop folds at its lowest point and has no horizontal force.

    Returns
    -------
    force_x_N, force_z_N : array (...)
        NaN where no solution exists: an inextensible cable shorter than the distance.
    """
    length, X, D, EA, w = np.broadcast_arrays(
        *floats(length_m, horizontal_distance_m, drop_m, axial_stiffness_N, weight_N_per_m)
    )
    kappa = w / EA
    with np.errstate(over="ignore"):  # far from the root the closure grows like exp(2 θ)
        theta = _theta_from_length(length, X, D, kappa)
    return forces_from_theta(theta, length, X, D, kappa, w)


def forces_from_theta(
    theta: FloatArray, length: FloatArray, X: FloatArray, D: FloatArray, kappa: FloatArray,
    w: FloatArray,
) -> tuple[FloatArray, FloatArray]:  # fmt: skip
    """Return the forces F_x and F_z at the attachment point from the root θ of the closure [N]."""
    p = 1.0 / (2.0 * theta + kappa * length)
    y = _mean_tension(length, theta)
    return np.asarray(w * p * X), _force_z(length, y, D, kappa, w)


def _theta_from_length(
    length: FloatArray, X: FloatArray, D: FloatArray, kappa: FloatArray
) -> FloatArray:
    """Return the root θ of the closure, infinity for a folded vertical cable, NaN for none."""
    low = np.full(length.shape, np.log(1e-9))
    low = np.minimum(low, np.log(np.maximum(kappa * length, 1e-30)) - 20.0)
    high = np.full(length.shape, np.log(LARGEST_THETA))
    u = np.clip(0.5 * np.log(np.maximum(6.0 * (length / np.hypot(X, D) - 1.0), 1e-8)), low, high)
    reachable = closure(np.exp(low), length, X, D, kappa)[0] < 0.0
    folded = closure(np.exp(high), length, X, D, kappa)[0] < 0.0
    for _ in range(200):
        f, slope = closure(np.exp(u), length, X, D, kappa)
        low, high = np.where(f < 0.0, u, low), np.where(f < 0.0, high, u)
        with np.errstate(divide="ignore", invalid="ignore"):
            # Newton on the logarithm of the closure, which is nearly straight at both ends.
            newton = u - np.log1p(f) * (1.0 + f) / (slope * np.exp(u))
        inside = (newton >= low) & (newton <= high)
        new = np.where(inside, newton, 0.5 * (low + high))
        converged = np.abs(new - u) <= 4e-15 * np.maximum(np.abs(u), 1.0)
        u = new
        if np.all(converged | ~reachable | folded):
            break
    theta = np.where(folded & (X == 0.0), np.inf, np.exp(u))
    return np.where(reachable & ~(folded & (X > 0.0)), theta, np.nan)


def closure(
    theta: FloatArray, length: FloatArray, X: FloatArray, D: FloatArray, kappa: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return D² q² + X² g² S - l² over l², free of cancellation at l ≈ chord, and its θ slope."""
    strain = kappa * length
    width = 2.0 * theta + strain
    coth = 1.0 / np.tanh(theta)
    stretch = 0.5 * strain * coth
    q = 1.0 / (1.0 + stretch)
    g, rest = 2.0 * theta / width, strain / width
    # ((sinh θ / θ)² - 1) / θ², by a series where the difference would cancel.
    t = theta * theta
    series = 1 / 3 + t * (2 / 45 + t * (1 / 315 + t * (2 / 14175 + t * 2 / 467775)))
    safe = np.maximum(theta, 0.1)
    near = 1.0 * (theta < 0.1)  # a blend, as `where` of numbers takes seconds to compile
    R = near * series + (1.0 - near) * ((np.sinh(safe) / safe) ** 2 - 1.0) / safe**2
    chord = np.hypot(X, D)
    excess = (
        (chord - length) * (chord + length)
        - (D * q) ** 2 * stretch * (2.0 + stretch)
        + X * X * (g * g * theta * theta * R - rest * (2.0 - rest))
    )
    slope = (D * q) ** 2 * q * strain / np.sinh(theta) ** 2 + 2.0 * (X * g) ** 2 * (
        1.0 + theta**2 * R
    ) * (coth - 2.0 / width)
    return excess / length**2, slope / length**2


def _closure_slope_in_length(
    theta: FloatArray, length: FloatArray, X: FloatArray, D: FloatArray, kappa: FloatArray
) -> FloatArray:
    """Return the slope of D² q² + X² g² S - l² in l at fixed θ, over l², where g = 1 - κ l p.

    At fixed θ the pull is 1/(2θ + κ l), as in `closure`.
    """
    width = 2.0 * theta + kappa * length
    coth = 1.0 / np.tanh(theta)
    q = 1.0 / (1.0 + 0.5 * kappa * length * coth)
    arc = (2.0 * X * np.sinh(theta) / width) ** 2
    slope = -((D * q) ** 2) * q * kappa * coth - 2.0 * arc * kappa / width - 2.0 * length
    return slope / length**2


def _mean_tension(length: FloatArray, theta: FloatArray) -> FloatArray:
    """Return the mean of the end tensions over the weight per length, (l/2) coth θ [m]."""
    with np.errstate(divide="ignore"):
        return np.asarray(0.5 * length / np.tanh(theta))


def _force_z(
    length: FloatArray, y: FloatArray, D: FloatArray, kappa: FloatArray, w: FloatArray
) -> FloatArray:
    return np.asarray(w * (0.5 * length - y * D / ((1.0 + kappa * y) * length)))


def floats(*values: ArrayLike) -> tuple[FloatArray, ...]:
    """Return values as arrays of floats."""
    return tuple(np.asarray(value, dtype=np.float64) for value in values)
