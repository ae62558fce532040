"""A robot under wind, ice and inertia by quadrature of the cable equation in 3-D, and SciPy.

The loads come from the numbers of a case, by formulas written again here; nothing is shared with
the package. Along the unstrained length s, counted from the platform, a cable of load q per length
has the tension T(s) = T(0) - q s and follows dr/ds = (1 + |T|/EA) T/|T|, in whatever plane that is.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import minimize, root
from scipy.spatial.transform import Rotation

G = 9.81
AIR = 1.25
NODE, SHARE = np.polynomial.legendre.leggauss(240)
NODE, SHARE = (1 + NODE) / 2, SHARE / 2


@dataclass(frozen=True)
class Twin:
    """A robot as its data sheet has it; ``attach_m`` is None for a point mass."""

    exit_m: np.ndarray
    mass_kg: float
    stiffness_N: float
    linear_mass: float
    diameter_m: float
    attach_m: np.ndarray | None = None
    centre_m: np.ndarray = field(default_factory=lambda: np.zeros(3))
    wrench_N: np.ndarray = field(default_factory=lambda: np.zeros(6))
    drag_area_m2: float = 0.0
    drag_centre_m: np.ndarray | None = None
    cable_drag: float = 0.0
    pulley_radius_m: float = 0.0

    @property
    def arms(self) -> np.ndarray:
        return np.zeros_like(self.exit_m) if self.attach_m is None else self.attach_m


@dataclass(frozen=True)
class Acting:
    """What acts: load per length of the cables; force and moment on the platform."""

    q: np.ndarray
    at_centre_N: np.ndarray
    at_origin: np.ndarray
    drag_N: np.ndarray


def acting(
    twin: Twin,
    *,
    wind: np.ndarray | None = None,
    ice_m: float = 0.0,
    factor: float = 1.0,
    inertia_N: np.ndarray | None = None,
) -> Acting:
    """Return the loads of a case; ``wind`` is a velocity [m/s]."""
    radius = twin.diameter_m / 2
    ice = 900.0 * np.pi * ((radius + ice_m) ** 2 - radius**2)
    q = np.array([0, 0, -G * (twin.linear_mass + ice)])
    origin, drag = factor * twin.wrench_N, np.zeros(3)
    if wind is not None:
        push = 0.5 * AIR * np.linalg.norm(wind) * wind
        q = q + push * twin.cable_drag * 2 * (radius + ice_m)
        drag = push * twin.drag_area_m2
    centre = np.array([0, 0, -G * factor * twin.mass_kg])
    return Acting(q, centre if inertia_N is None else centre + inertia_N, origin, drag)


def reach_m(pull: np.ndarray, length: np.ndarray, q: np.ndarray, stiffness: float) -> np.ndarray:
    """Return where cables end, from the platform (n, 3), by Gauss-Legendre quadrature."""
    vector = pull[:, None, :] - q * (length[:, None] * NODE)[..., None]
    size = np.linalg.norm(vector, axis=-1, keepdims=True)
    along = (1 / size + 1 / stiffness) * vector
    return np.einsum("nkj,k,n->nj", along, SHARE, length)


def integrated_end_m(pull: np.ndarray, length: float, q: np.ndarray, stiffness: float):
    """Return where one cable ends, from the platform (3,), by an ODE solver."""

    def slope(s: float, _: np.ndarray) -> np.ndarray:
        vector = pull - q * s
        return (1 / np.linalg.norm(vector) + 1 / stiffness) * vector

    found = solve_ivp(slope, (0, length), np.zeros(3), rtol=1e-12, atol=1e-12, method="DOP853")
    return found.y[:, -1]


def left_over(
    twin: Twin,
    load: Acting,
    position: np.ndarray,
    turn: np.ndarray,
    pull: np.ndarray,
    length: np.ndarray,
    cables: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Return what closure (n, 3) and balance (3 or 6,) leave."""
    arm = twin.arms[cables] @ turn.T
    reach = reach_m(pull, length, load.q, twin.stiffness_N)
    gap = position + arm + reach - twin.exit_m[cables]
    force = pull.sum(0) + load.at_centre_N + load.at_origin[:3] + load.drag_N
    if twin.attach_m is None:
        return gap, force
    drag_m = twin.centre_m if twin.drag_centre_m is None else twin.drag_centre_m
    moment = np.cross(arm, pull).sum(0) + np.cross(turn @ twin.centre_m, load.at_centre_N)
    moment = moment + np.cross(turn @ drag_m, load.drag_N)
    return gap, np.concatenate([force, moment + load.at_origin[3:]])


def tensions_N(pull: np.ndarray, length: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Return the larger end tension of each cable; no tension between the ends is larger."""
    return np.maximum(
        np.linalg.norm(pull, axis=1), np.linalg.norm(pull - q * length[:, None], axis=1)
    )


def _start(twin: Twin, position: np.ndarray, turn: np.ndarray, load: Acting):
    cables = np.arange(len(twin.exit_m))
    arm = twin.arms @ turn.T
    chord = twin.exit_m - position - arm
    length = np.linalg.norm(chord, axis=1)
    unit = chord / length[:, None]
    rows = unit if twin.attach_m is None else np.hstack([unit, np.cross(arm, unit)])
    held = -left_over(twin, load, position, turn, 0 * unit + 1e-9 * unit, length, cables)[1]
    size = np.linalg.pinv(rows.T) @ held
    return np.maximum(size, 0.05 * abs(size).max())[:, None] * unit, length


def held(
    twin: Twin, load: Acting, position: np.ndarray, turn: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return pulls and lengths of as many cables as degrees of freedom."""
    cables = np.arange(len(twin.exit_m))
    pull, length = _start(twin, position, turn, load)
    size = np.linalg.norm(load.at_centre_N)

    def residual(x: np.ndarray) -> np.ndarray:
        some, long = size * x[: 3 * len(cables)].reshape(-1, 3), x[3 * len(cables) :]
        gap, balance = left_over(twin, load, position, turn, some, long * length, cables)
        return np.concatenate([gap.ravel() / length.mean(), balance / size])

    found = root(residual, np.concatenate([pull.ravel() / size, np.ones(len(cables))]), tol=1e-14)
    assert abs(found.fun).max() < 1e-11, found.message
    return size * found.x[: 3 * len(cables)].reshape(-1, 3), found.x[3 * len(cables) :] * length


def held_over_pulleys(
    twin: Twin, load: Acting, position: np.ndarray, turn: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return pulls, free lengths and points where cables leave, of as many as degrees of freedom.

    A pulley's axis is horizontal, its plane has the attachment point in it, and the cable is where
    it leaves square to the spoke, in that plane.
    """
    n, size, radius = len(twin.exit_m), np.linalg.norm(load.at_centre_N), twin.pulley_radius_m
    pull, length = _start(twin, position, turn, load)
    toward = position + twin.arms @ turn.T - twin.exit_m
    toward[:, 2] = 0.0
    toward /= np.linalg.norm(toward, axis=1)[:, None]
    up = np.array([0.0, 0.0, 1.0])

    def unpack(x: np.ndarray) -> tuple[np.ndarray, ...]:
        some, long, angle = size * x[: 3 * n].reshape(n, 3), x[3 * n : 4 * n] * length, x[4 * n :]
        spoke = np.sin(angle)[:, None] * toward + np.cos(angle)[:, None] * up
        return some, long, spoke, twin.exit_m + radius * (toward + spoke)

    def residual(x: np.ndarray) -> np.ndarray:
        some, long, spoke, points = unpack(x)
        gap, balance = left_over(
            replace(twin, exit_m=points), load, position, turn, some, long, np.arange(n)
        )
        top = some - load.q * long[:, None]
        square = np.sum(top * spoke, axis=1) / np.linalg.norm(top, axis=1)
        return np.concatenate([gap.ravel() / length.mean(), square, balance / size])

    slope = np.arcsin(pull[:, 2] / np.linalg.norm(pull, axis=1))
    found = root(residual, np.concatenate([pull.ravel() / size, np.ones(n), slope]), tol=1e-14)
    assert abs(found.fun).max() < 1e-11, found.message
    some, long, _, points = unpack(found.x)
    return some, long, points


def least_largest(
    twin: Twin,
    load: Acting,
    position: np.ndarray,
    turn: np.ndarray,
    pull: np.ndarray,
    length: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Return pulls and lengths of more cables, with the smallest largest tension, near a start."""
    n, size = len(twin.exit_m), np.linalg.norm(load.at_centre_N)
    cables, scale = np.arange(n), length.copy()

    def unpack(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return size * x[: 3 * n].reshape(-1, 3), x[3 * n : 4 * n] * scale

    def equal(x: np.ndarray) -> np.ndarray:
        gap, balance = left_over(twin, load, position, turn, *unpack(x), cables)
        return np.concatenate([gap.ravel() / scale.mean(), balance / size])

    def less(x: np.ndarray) -> np.ndarray:
        some, long = unpack(x)
        top = np.linalg.norm(some - load.q * long[:, None], axis=1)
        return np.concatenate([x[-1] - np.linalg.norm(some, axis=1) / size, x[-1] - top / size])

    top = tensions_N(pull, length, load.q).max() / size
    start = np.concatenate([pull.ravel() / size, length / scale, [1.05 * top]])
    found = minimize(
        lambda x: x[-1], start, jac=lambda x: np.eye(len(x))[-1], method="SLSQP",
        constraints=[{"type": "eq", "fun": equal}, {"type": "ineq", "fun": less}],
        options={"maxiter": 500, "ftol": 1e-13},
    )  # fmt: skip
    assert abs(equal(found.x)).max() < 1e-8, found.message
    return unpack(found.x)


def rest(
    twin: Twin,
    load: Acting,
    position: np.ndarray,
    turn: np.ndarray,
    length: np.ndarray,
    cables: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return position, rotation and pulls where the platform rests on lengths, near a start."""
    n, size, far = len(cables), np.linalg.norm(load.at_centre_N), length.mean()
    chord = twin.exit_m[cables] - position - twin.arms[cables] @ turn.T
    pull = 0.5 * size * chord / np.linalg.norm(chord, axis=1)[:, None]
    dof = 3 if twin.attach_m is None else 6

    def at(x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        turned = turn if dof == 3 else Rotation.from_rotvec(x[3:6]).as_matrix() @ turn
        return position + far * x[:3], turned, size * x[dof:].reshape(n, 3)

    def residual(x: np.ndarray) -> np.ndarray:
        where, turned, some = at(x)
        gap, balance = left_over(twin, load, where, turned, some, length, cables)
        return np.concatenate([gap.ravel() / far, balance / size])

    start = np.concatenate([np.zeros(dof), pull.ravel() / size])
    found = root(residual, start, tol=1e-14, method="lm", options={"maxiter": 20000})
    assert abs(found.fun).max() < 1e-9, (found.message, abs(found.fun).max())
    return at(found.x)
