"""Statics of a cable robot by quadrature of the cable equation in 3-D, all rows at once.

Along the unstrained arc length s, counted from the platform, the tension vector is
T(s) = T(0) - m g s, since each piece of cable of mass m s hangs in the gravity g; and the cable
follows dr/ds = (1 + strain(|T|)) T/|T|. Gauss-Legendre quadrature gives r(length), so a row is the
root of: every cable ends where it leaves its support, and the pulls T(0) carry the platform. The
unknowns are the vectors T(0) and the lengths. No closed form, no plane, no preferred vertical.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cache

import numpy as np

from twins.bending import bending_shift_m

NODES = (32, 128, 512)
GRAVITY = 9.81
MAX_STEPS = 80


@dataclass(frozen=True)
class Machine:
    """A robot as built; arrays broadcast over (rows, cables) or, for the platform, over (rows,).

    Parameters
    ----------
    exit_m : array (rows or 1, cables, 3)
        Exit points [m].
    attachment_m : array (cables, 3)
        Attachment points, body frame [m].
    mass_kg, centre_m : float or array (rows,); array (3,)
        Platform mass [kg] and its centre, body frame [m].
    linear_mass, stiffness_N : array
        Mass per unstrained length [kg/m] and EA [N].
    has_moments : bool
        False for a point mass.
    gravity : array (3,)
        Gravity [m/s²].
    force_N, moment_Nm : array (rows or 1, 3)
        Force on the platform beside its weight, at the body's origin, and moment [N, N·m].
    toe_strain, toe_tension_N : float
        Strain is T/EA + toe_strain (1 - exp(-T/toe_tension_N)).
    pulley_radius_m : array
        Radius of the swivelling pulleys [m].
    pulley_axis : array (cables, 3) or None
        Axes about which they swivel; None where those are vertical.
    mast_m_per_N : array
        Exit point's movement per horizontal cable force on it, along that force [m/N].
    bending_N_m2 : array
        Flexural rigidity of the cable, clamped along its chord at both ends [N m²].
    set_cables, set_N : tuple of int; array (rows or 1, len(set_cables))
        Cables, counted from 0, whose winches hold a tension at the exit instead of a length [N]:
        as many as there are cables beyond the degrees of freedom.
    """

    exit_m: np.ndarray
    attachment_m: np.ndarray
    mass_kg: np.ndarray | float
    linear_mass: np.ndarray | float
    stiffness_N: np.ndarray | float
    has_moments: bool = False
    centre_m: np.ndarray = field(default_factory=lambda: np.zeros(3))
    gravity: np.ndarray = field(default_factory=lambda: np.array([0.0, 0.0, -GRAVITY]))
    force_N: np.ndarray = field(default_factory=lambda: np.zeros((1, 3)))
    moment_Nm: np.ndarray = field(default_factory=lambda: np.zeros((1, 3)))
    toe_strain: float = 0.0
    toe_tension_N: float = 1.0
    pulley_radius_m: np.ndarray | float = 0.0
    pulley_axis: np.ndarray | None = None
    mast_m_per_N: np.ndarray | float = 0.0
    bending_N_m2: np.ndarray | float = 0.0
    set_cables: tuple[int, ...] = ()
    set_N: np.ndarray = field(default_factory=lambda: np.zeros((1, 0)))


@dataclass(frozen=True)
class Equilibrium:
    """Lengths from the exit points, pulleys included, and tension vectors toward the exits."""

    length_m: np.ndarray
    exit_tension_N: np.ndarray
    platform_pull_N: np.ndarray
    exit_pull_N: np.ndarray


def solve(machine: Machine, position_m: np.ndarray, rotation: np.ndarray) -> Equilibrium:
    """Return the equilibrium of poses (rows, 3), (rows, 3, 3); raise where Newton fails."""
    for nodes in NODES:
        pull, length, wrap = _newton(machine, position_m, rotation, nodes)
        reach = _cable(machine, pull, length, nodes)[1]
        error = np.linalg.norm(reach - _cable(machine, pull, length, 2 * nodes)[1], axis=-1)
        if (error < 1e-11 * length).all():
            break
    else:
        raise RuntimeError(f"cable too slack for the quadrature, off by {error.max():.1e} m")
    end = pull - _weight(machine, length)
    tension = np.linalg.norm(end, axis=-1)
    wrap = wrap / (1 + _strain(machine, tension)[0])
    return Equilibrium(length + wrap, tension, pull, end)


def _newton(
    machine: Machine, position_m: np.ndarray, rotation: np.ndarray, nodes: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray | float]:
    """Pulls on the platform, free lengths, and what lies on the pulleys under tension."""
    arm = np.einsum("rij,nj->rni", rotation, machine.attachment_m)
    point = position_m[:, None, :] + arm
    load = _load(machine, rotation)
    pull, length = _straight_start(machine, point, arm, load)
    for _ in range(MAX_STEPS):
        end, reach, slope, along = _cable(machine, pull, length, nodes)
        support, wrap = _support(machine, point, pull, end, length)
        held = load + _wrench(machine, pull, arm)
        steps = _newton_step(machine, point + reach - support, held, slope, along, arm, end)
        size = np.linalg.norm(pull, axis=-1)
        change = np.maximum(np.linalg.norm(steps[0], axis=-1) / size, abs(steps[1]) / length)
        # A step may change no pull and no length by more than half.
        part = np.minimum(1.0, 0.5 / np.maximum(change.max(1), 1e-300))
        pull = pull + part[:, None, None] * steps[0]
        length = length + part[:, None] * steps[1]
        if (change < 1e-12 * size.max(1, keepdims=True) / size).all():
            return pull, length, wrap
    lost = np.flatnonzero(change.max(1) > 1e-9)
    if lost.size:
        raise RuntimeError(f"no equilibrium in rows {lost}")
    return pull, length, wrap  # bending by finite differences leaves some rounding


def _weight(machine: Machine, length: np.ndarray) -> np.ndarray:
    """Weight of lengths (rows, cables, ...) as vectors."""
    mass = np.asarray(machine.linear_mass)
    mass = mass.reshape(mass.shape + (1,) * (length.ndim - 2)) if mass.ndim else mass
    return (mass * length)[..., None] * machine.gravity


def _strain(machine: Machine, tension: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Strain and its slope in tension; tension (rows, cables, ...)."""
    stiffness = np.asarray(machine.stiffness_N, dtype=float)
    if stiffness.ndim:
        stiffness = stiffness.reshape(stiffness.shape + (1,) * (tension.ndim - 2))
    fading = machine.toe_strain * np.exp(-tension / machine.toe_tension_N)
    strain = tension / stiffness + machine.toe_strain - fading
    return strain, 1 / stiffness + fading / machine.toe_tension_N


@cache
def _rule(nodes: int) -> tuple[np.ndarray, np.ndarray]:
    """Gauss-Legendre nodes and weights on the unit interval."""
    node, weight = np.polynomial.legendre.leggauss(nodes)
    return (1 + node) / 2, weight / 2


def _cable(
    machine: Machine, pull: np.ndarray, length: np.ndarray, nodes: int
) -> tuple[np.ndarray, ...]:
    """Tension at the exit, reach r(length), its slope in the pull, and dr/ds at the exit."""
    node, share = _rule(nodes)
    arc = length[..., None] * node
    vector = pull[:, :, None, :] - _weight(machine, arc)
    tension = np.sqrt((vector**2).sum(-1))
    unit = vector / tension[..., None]
    strain, softness = _strain(machine, tension)
    weight = length[..., None] * share
    reach = ((weight * (1 + strain))[..., None] * unit).sum(2)
    across = (1 + strain) / tension
    slope = (unit * (weight * (softness - across))[..., None]).swapaxes(-1, -2) @ unit
    slope += (weight * across).sum(-1)[..., None, None] * np.eye(3)
    end = pull - _weight(machine, length)
    size = np.sqrt((end**2).sum(-1))
    along = ((1 + _strain(machine, size)[0]) / size)[..., None] * end
    return end, reach, slope, along


def _support(
    machine: Machine, point: np.ndarray, pull: np.ndarray, end: np.ndarray, length: np.ndarray
) -> tuple[np.ndarray, np.ndarray | float]:
    """Where the cable has to end for the present tensions, and what lies on the pulley."""
    exit_m, wrap = machine.exit_m, 0.0
    down = machine.gravity / np.linalg.norm(machine.gravity)
    level = -(end - (end @ down)[..., None] * down)  # the horizontal force on the support
    if np.any(machine.mast_m_per_N):
        exit_m = exit_m + np.asarray(machine.mast_m_per_N)[..., None] * level
    if np.any(machine.pulley_radius_m):
        radius = np.asarray(machine.pulley_radius_m)[..., None]
        axis = -down if machine.pulley_axis is None else machine.pulley_axis
        along = (end * axis).sum(-1)
        size = np.linalg.norm(end - along[..., None] * axis, axis=-1)
        toward = point - exit_m
        toward = toward - (toward * axis).sum(-1, keepdims=True) * axis
        toward /= np.linalg.norm(toward, axis=-1, keepdims=True)
        fall = np.arctan2(along, size)  # from the axis's plane downward, toward the platform
        spoke = np.sin(fall)[..., None] * toward + np.cos(fall)[..., None] * axis
        exit_m = exit_m + radius * (toward + spoke)
        wrap = radius[..., 0] * (np.pi / 2 + fall)
    if np.any(machine.bending_N_m2):
        shift = bending_shift_m(
            machine.bending_N_m2, machine.stiffness_N, exit_m - point, pull,
            _weight(machine, length), down, length,
        )  # fmt: skip
        exit_m = exit_m - shift
    return exit_m, wrap


def _load(machine: Machine, rotation: np.ndarray) -> np.ndarray:
    """Weight and other forces on the platform (rows, 3 or 6), moments about the body's origin."""
    weight = np.asarray(machine.mass_kg)[..., None] * machine.gravity
    force = np.broadcast_to(weight + machine.force_N, (len(rotation), 3))
    if not machine.has_moments:
        return force
    # The extra force (wind) acts at the body's origin, the weight at the centre of mass.
    moment = np.cross(rotation @ machine.centre_m, weight) + machine.moment_Nm
    return np.concatenate([force, moment], axis=-1)


def _wrench(machine: Machine, pull: np.ndarray, arm: np.ndarray) -> np.ndarray:
    """Sum of the pulls and their moments (rows, 3 or 6)."""
    force = pull.sum(1)
    if not machine.has_moments:
        return force
    return np.concatenate([force, np.cross(arm, pull).sum(1)], axis=-1)


def _balance_matrix(machine: Machine, arm: np.ndarray) -> np.ndarray:
    """Slope of the wrench in the pulls (rows, 3 or 6, cables, 3)."""
    rows, cables, _ = arm.shape
    force = np.broadcast_to(np.eye(3)[:, None, :], (rows, 3, cables, 3))
    if not machine.has_moments:
        return force
    moment = np.cross(arm[:, :, None, :], np.eye(3))  # (rows, cables, pull component, moment)
    return np.concatenate([force, moment.transpose(0, 3, 1, 2)], axis=1)


def _newton_step(
    machine: Machine,
    gap: np.ndarray,
    held: np.ndarray,
    slope: np.ndarray,
    along: np.ndarray,
    arm: np.ndarray,
    end: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Solve closure, balance and set tensions linearised, the support held still.

    The pulls are eliminated cable by cable: step = -slope⁻¹ (gap + along × dlength).
    """
    compliance = np.linalg.inv(slope)
    balance = _balance_matrix(machine, arm)
    free = -(compliance @ gap[..., None])[..., 0]
    per_length = -(compliance @ along[..., None])[..., 0]
    matrix = np.einsum("rdni,rni->rdn", balance, per_length)
    right = -held - np.einsum("rdni,rni->rd", balance, free)
    if machine.set_cables:
        holds, wanted = _set_tensions(machine, end, free, per_length)
        matrix = np.concatenate([matrix, holds], axis=1)
        right = np.concatenate([right, wanted], axis=1)
    step_length = np.linalg.solve(matrix, right[..., None])[..., 0]
    return free + per_length * step_length[..., None], step_length


def _set_tensions(
    machine: Machine, end: np.ndarray, free: np.ndarray, per_length: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Slope of the set tensions in the lengths, and what they lack."""
    rows, cables, _ = end.shape
    chosen = list(machine.set_cables)
    size = np.linalg.norm(end, axis=-1, keepdims=True)
    linear_mass = np.broadcast_to(machine.linear_mass, (rows, cables))[..., None]
    slope = ((end / size) * (per_length - linear_mass * machine.gravity)).sum(-1)
    reached = size[..., 0] + ((end / size) * free).sum(-1)
    holds = np.eye(cables)[chosen] * slope[:, None, :]
    return holds, machine.set_N - reached[:, chosen]


def least_tensions_N(machine: Machine, position_m: np.ndarray, rotation: np.ndarray) -> np.ndarray:
    """Return the smallest tensions of straight cables that carry the load (rows, cables) [N]."""
    arm = np.einsum("rij,nj->rni", rotation, machine.attachment_m)
    chord = machine.exit_m - (position_m[:, None, :] + arm)
    unit = chord / np.linalg.norm(chord, axis=-1, keepdims=True)
    matrix = np.einsum("rdni,rni->rdn", _balance_matrix(machine, arm), unit)
    return (np.linalg.pinv(matrix) @ -_load(machine, rotation)[..., None])[..., 0]


def _straight_start(
    machine: Machine, point: np.ndarray, arm: np.ndarray, load: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Straight cables that carry the load and half of their own weight."""
    chord = machine.exit_m - point
    length = np.linalg.norm(chord, axis=-1)
    half = 0.5 * _weight(machine, length)
    matrix = np.einsum("rdni,rni->rdn", _balance_matrix(machine, arm), chord / length[..., None])
    right = -(load + _wrench(machine, half, arm))
    if machine.set_cables:
        holds = np.eye(length.shape[1])[list(machine.set_cables)]
        matrix = np.concatenate([matrix, np.broadcast_to(holds, (len(arm), *holds.shape))], axis=1)
        wanted = np.broadcast_to(machine.set_N, (len(arm), len(holds)))
        right = np.concatenate([right, wanted], axis=1)
    tension = np.linalg.solve(matrix, right[..., None])[..., 0]
    tension = np.maximum(tension, 0.02 * np.abs(tension).max(1, keepdims=True))
    return (tension / length)[..., None] * chord + half, length
