"""Irvine's elastic catenary for a cable of unit weight, with its derivatives, for one lane.

All forces are divided by the weight per length w. With the horizontal distance X and the drop D
from the exit point to the attachment point, the unstrained length l, κ = w/EA, and the pull
p = H / (w X) (horizontal force per weight per horizontal distance):

    θ  = (1/p - κ l) / 2        S = (sinh θ / θ)²        C = θ coth θ = √(1/S + θ²)
    g  = 1 - κ l p              y = p l C / g            q = 1 / (1 + κ y)
    closure:        D² q² + X² g² S - l² = 0
    upward pull:    v = y D q / l - l/2
    top tension:    t = y + |D| q / 2

y is the mean of the two end tensions. The form follows from Riehl et al., ICRA 2010, eqs. (7)-(8)
by the sum and difference of the two hyperbolic arcs; unlike those it neither cancels for a taut
cable (θ → 0) nor fails for a vertical one (X = 0).
"""

from __future__ import annotations

import math

from designer.kernel.compiling import element

PULL_FLOOR = 1.0 / 64.0
"""Smallest pull that is evaluated as it is. Below it the cable is longer than 10¹¹ times its
horizontal distance, its tension falls with growing pull, and no material can bear it."""

_DOUBLINGS = 6
_SCALE = 4.0**-_DOUBLINGS
# Taylor coefficients of ((sinh x / x)² - 1) / x² in powers of x², relative error 1e-17 at x = 1/2.
_S1, _S2, _S3, _S4, _S5, _S6, _S7, _S8, _S9 = (
    2.0 ** (2 * k + 1) / math.factorial(2 * k + 2) for k in range(1, 10)
)


@element
def sag_series(theta_squared: float) -> float:
    """Return R = ((sinh θ / θ)² - 1) / θ² without a library call, so that lanes vectorise.

    Taylor series at θ/64, then six times the double-angle formula S(2x) = S (1 + x² S), which in R
    reads R(2x) = (R + S²) / 4. Good to 1e-14 for θ ≤ 32.
    """
    x = theta_squared * _SCALE
    r = _S1 + x * (
        _S2 + x * (_S3 + x * (_S4 + x * (_S5 + x * (_S6 + x * (_S7 + x * (_S8 + x * _S9))))))
    )
    for _ in range(_DOUBLINGS):
        s = 1.0 + x * r
        r = 0.25 * (r + s * s)
        x = 4.0 * x
    return r


@element
def unit_cable(
    p: float, length: float, X2: float, D: float, kappa: float
) -> tuple[float, float, float, float, float, float, float, float, float]:
    """Return closure, upward pull and top tension, each with its slopes in p and in length.

    Parameters
    ----------
    p : float
        Pull H / (w X); clipped from below at `PULL_FLOOR`.
    length : float
        Unstrained length [m].
    X2, D : float
        Squared horizontal distance [m²] and drop from exit point to attachment point [m].
    kappa : float
        Weight per length over axial stiffness [1/m].

    Returns
    -------
    F, F_p, F_l : closure [m²] and its slopes
    v, v_p, v_l : upward pull on the platform over weight per length [m] and its slopes
    t, t_p, t_l : tension at the upper end over weight per length [m] and its slopes
    """
    p = max(p, PULL_FLOOR)
    i = 1.0 / p
    theta = 0.5 * (i - kappa * length)
    theta2 = theta * theta
    R = sag_series(theta2)
    S = 1.0 + theta2 * R
    C = math.sqrt(1.0 / S + theta2)
    # C = 1 + θ² E, and with it the slopes of S and C without cancellation at θ = 0.
    E = (1.0 - R / S) / (C + 1.0)
    S_theta = 2.0 * theta * S * E
    C_theta = theta * (1.0 - C * E)
    g = 1.0 - kappa * length * p
    y = p * length * C / g
    q = 1.0 / (1.0 + kappa * y)
    il = 1.0 / length

    y_p = y * (i - 0.5 * i * i * C_theta / C + kappa * length / g)
    y_l = y * (il - 0.5 * kappa * C_theta / C + kappa * p / g)
    q_y = -kappa * q * q
    F = D * D * q * q + X2 * g * g * S - length * length
    F_p = 2.0 * D * D * q * q_y * y_p - X2 * g * (
        0.5 * g * S_theta * i * i + 2.0 * kappa * length * S
    )
    F_l = (
        2.0 * D * D * q * q_y * y_l
        - X2 * g * kappa * (0.5 * g * S_theta + 2.0 * p * S)
        - 2.0 * length
    )
    v = y * D * q * il - 0.5 * length
    v_p = D * q * q * il * y_p
    v_l = D * q * q * il * y_l - y * D * q * il * il - 0.5
    t = y + 0.5 * abs(D) * q
    t_y = 1.0 + 0.5 * abs(D) * q_y
    return F, F_p, F_l, v, v_p, v_l, t, t_y * y_p, t_y * y_l
