r"""How platform and cables oscillate together about an equilibrium, with winches braked.

Each cable is a chain of catenaries (`designer.physics.tangent`) that is eliminated up to its end,
so that at the square :math:`λ = (2 π f)^2` of a frequency the platform resists with

.. math::

    D(λ) = K + \sum_i \left[D_i(λ) - D_i(0)\right] - λ M, \qquad
    M = \begin{pmatrix} m I & -m [c] \\ m [c] & J + m [c]^\mathsf{T}[c] \end{pmatrix}

with K that of `designer.statics.stiffness`, m, c and J the platform's mass, the lever of its centre
of mass and its inertia about that. Modes are where D is singular, or where a cable swings alone.
Below λ lie as many as D has negative eigenvalues and as the cables have modes between fixed ends
(Wittrick and Williams, Q. J. Mech. Appl. Math. 24 (1971), page 263), so that bisection misses none.
With φ the null vector of D the kinetic energy is :math:`-φ^\mathsf{T} D'(λ) φ`, of the platform
:math:`φ^\mathsf{T} M φ`. Over a pulley a cable swings from where it leaves that. No damping.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from designer.arrays import BoolArray, FloatArray, IntArray
from designer.model.robot import Platform, Robot
from designer.physics.tangent import Chain, chain_of
from designer.statics.geometry import centre_of_mass_arm_m, cross_matrix, upright_poses
from designer.statics.inverse import Statics
from designer.statics.stiffness import per_reach, scaled, upright_stiffness

TAKES_PART = 0.05
"""Share of the kinetic energy from which on a mode is one of the platform."""
NEAR = 1.5
"""For searches, see `frequencies_Hz`: coupling takes less than a third off a frequency."""
_FEWEST, _MOST, _A_HALF_WAVE = 16, 512, 8
"""Elements of a cable, and for each half wave: that leaves at most 5e-4 of a frequency."""
_AT_ONCE, _AT_A_TIME, _MOST_TRIED = 2**12, 32, 256
"""Cables of all poses together, modes of one pose together, and those tried for the platform's."""
_RANGE, _HALVINGS, _STEP = 1e6, 26, 1e-5
"""Over the frequency of the slowest cable, halvings of its logarithm, and relative slope step."""


@dataclass(frozen=True, slots=True, eq=False)
class Mode:
    """One way in which platform and cables oscillate."""

    frequency_Hz: float  #: its natural frequency; 0 where the platform would not stay [Hz]
    #: (3,) or (6,) displacement of the origin of the body frame, and turn, along the axes of the
    #: base frame [m, rad]; the attachment that moves farthest moves by 1 m
    shape: FloatArray
    cable_share: float  #: share of the cables in the kinetic energy


def knows_inertia(robot: Robot, body: Platform) -> bool:
    """Tell whether the inertia of all that moves is known: a point mass needs none."""
    return robot.is_point_mass or body.inertia_kg_m2 is not None


def platform_mass_matrix(statics: Statics, body: Platform) -> FloatArray:
    """Return the mass matrix of the platform itself, (..., dof, dof) [kg, kg·m, kg·m²].

    Upright frame, about the origin of the body frame.
    """
    robot = statics.robot
    rotation = upright_poses(robot, statics.poses).rotations
    inertia = np.zeros((3, 3)) if body.inertia_kg_m2 is None else body.inertia_kg_m2
    C = cross_matrix(centre_of_mass_arm_m(robot, statics.poses))
    C = np.broadcast_to(C, rotation.shape)
    J = rotation @ inertia @ np.swapaxes(rotation, -1, -2) - body.mass_kg * C @ C
    m = np.broadcast_to(body.mass_kg * np.eye(3), rotation.shape)
    six = np.block([[m, -body.mass_kg * C], [body.mass_kg * C, J]])
    rows = robot.balance_rows
    return np.asarray(six[..., rows[:, None], rows])


def cable_frequencies_Hz(
    statics: Statics, linear_density_kg_per_m: FloatArray | float
) -> FloatArray:
    """Return the lowest frequency of each cable between fixed ends (..., n_cables) [Hz]."""
    chain = chain_of(*statics.catenaries, linear_density_kg_per_m, _FEWEST)
    start = (np.pi / _transits_s(statics, linear_density_kg_per_m)) ** 2
    lowest = np.ones(start.shape, dtype=np.int64)
    return _Hz(_squares(lambda at: chain.resistance_N_per_m(at)[1], lowest, start)[1])


def frequencies_Hz(
    statics: Statics,
    body: Platform,
    linear_density_kg_per_m: FloatArray | float,
    middle_Hz: float = 0.0,
    *,
    of_platform: bool = True,
    near: float = math.inf,
) -> FloatArray:
    """Return the natural frequency next to a middle, by their ratio (...) [Hz].

    Parameters
    ----------
    body : Platform
        What is accelerated: mass and inertia without the dynamic factor of a load case.
    linear_density_kg_per_m : float or array (..., 1 or n_cables)
        Of the cables, with ice and without the load of the wind [kg/m].
    middle_Hz : float
        Such as that of a band; zero for the lowest [Hz].
    of_platform : bool
        Whether modes count in which the platform has `TAKES_PART` of the kinetic energy, or all.
    near : float
        Where the lowest of a platform whose cables follow it as if at rest is more than so many
        times that of another of these poses, that is returned: enough for a search.

    Returns
    -------
    array (...)
        NaN where not solved. Of the platform zero where it would not stay, NaN where its inertia is
        not known; all are then those of the cables between fixed ends. Of all the middle itself
        where a cable has 64 half waves or more, which is less than 1 % off.
    """
    density = np.broadcast_to(
        linear_density_kg_per_m, (*statics.verdict.shape, statics.robot.n_cables)
    )
    half_waves = 2.0 * _transits_s(statics, density).max(axis=-1)
    is_finite = np.isfinite(upright_stiffness(statics)).all(axis=(-2, -1))
    has_inertia = knows_inertia(statics.robot, body) or not of_platform
    is_known = statics.is_solved & is_finite & has_inertia
    figures = np.where(is_known, middle_Hz, np.nan)

    def fill(among: BoolArray, highest_Hz: FloatArray, figure: Callable[..., FloatArray]) -> None:
        """Compute some, those together whose cables need as many elements."""
        count = np.clip(np.ceil(_A_HALF_WAVE * half_waves * highest_Hz), _FEWEST, _MOST).ravel()
        rows = np.flatnonzero(among)
        rows, size = rows[np.argsort(count[rows])], max(_AT_ONCE // statics.robot.n_cables, 1)
        for part in (rows[start : start + size] for start in range(0, len(rows), size)):
            of_part = density.reshape(-1, density.shape[-1])[part], int(count[part[-1]])
            figures.reshape(-1)[part] = figure(statics.part(part), body, *of_part)

    if not of_platform:
        is_sparse = is_known & (half_waves * middle_Hz * _A_HALF_WAVE < _MOST)
        fill(is_sparse, middle_Hz + 2.0 / half_waves, partial(_of_all_Hz, middle_Hz))
        return figures
    fill(is_known, 0.0 * half_waves, lambda *given: _Hz(_System.of(*given).following()[:, 0]))
    is_near = is_known & ~(figures > near * np.fmin.reduce(figures, axis=None, initial=np.inf))
    fill(is_near, 1.3 * np.maximum(figures, middle_Hz), partial(_of_platform_Hz, middle_Hz))
    return figures


def platform_modes(
    statics: Statics, body: Platform, linear_density_kg_per_m: FloatArray | float
) -> tuple[Mode, ...]:
    """Return the lowest modes of one equilibrium () in which the platform takes part.

    By frequency, as many as it has degrees of freedom; fewer where they are not among the lowest
    256 of platform and cables. Parameters as for `frequencies_Hz`.
    """
    density, dof = linear_density_kg_per_m, statics.robot.degrees_of_freedom
    again, modes = statics.part(np.zeros(_AT_A_TIME, dtype=np.int64)), list[Mode]()
    highest_Hz = _Hz(_System.of(again, body, density, _FEWEST).following()[0, -1])
    half_waves = 2.0 * highest_Hz * float(_transits_s(statics, density).max())
    count = min(max(math.ceil(_A_HALF_WAVE * half_waves), _FEWEST), _MOST)
    system = _System.of(again, body, density, count)
    for start in range(1, _MOST_TRIED, _AT_A_TIME):
        squares, vectors, shares = system.modes(np.arange(start, start + _AT_A_TIME))
        for k in np.flatnonzero(shares >= TAKES_PART).tolist():
            modes.append(Mode(float(_Hz(squares[k])), _shape(statics, vectors[k]), 1.0 - shares[k]))
        if len(modes) >= dof:
            break
    return tuple(modes[:dof])


def _shape(statics: Statics, vector: FloatArray) -> FloatArray:
    """Return a shape as `Mode` has it, of a vector (dof,) in which turns are displacements."""
    robot, full = statics.robot, np.zeros(6)
    full[robot.balance_rows] = per_reach(robot) * vector
    displacement = (full.reshape(2, 3) @ robot.upright).ravel()
    levers = robot.attachments_m @ statics.poses.rotation.T
    moved = displacement[:3] + np.cross(displacement[3:], levers)
    leading = displacement[np.abs(displacement).argmax()]
    shape = displacement / (np.linalg.norm(moved, axis=-1).max() * np.sign(leading))
    return np.asarray(shape[: 3 if robot.is_point_mass else 6])


def _of_all_Hz(
    middle_Hz: float, statics: Statics, body: Platform, density: FloatArray, count: int
) -> FloatArray:
    system = _System.of(statics, body, density, count)
    number = system.below(np.full(len(system.start), (2.0 * np.pi * middle_Hz) ** 2))
    low_Hz, high_Hz = (_Hz(system.modes(np.maximum(number + k, 1))[0]) for k in (0, 1))
    return np.where(low_Hz * high_Hz > middle_Hz**2, low_Hz, high_Hz)


def _of_platform_Hz(
    middle_Hz: float, statics: Statics, body: Platform, density: FloatArray, count: int
) -> FloatArray:
    """Return it of the platform, or as it follows where energies are spread over too many modes."""
    system = _System.of(statics, body, density, count)
    following = np.maximum(system.following()[:, 0], 0.0)
    # The mode of a cable far below those of the platform moves it little: the share of that is at
    # most r² / 3 (1 - r)² times the ratio of the masses, with r the ratio of the squares.
    cables_kg = (density * statics.free_length_m).sum(axis=-1)
    x = np.sqrt(3.0 * TAKES_PART * body.mass_kg / cables_kg)
    number = system.below(following * x / (1.0 + x))
    figures_Hz, nearest_Hz = _Hz(following), np.zeros(len(following))
    rows = np.flatnonzero(following > 0.0)
    for _ in range(_MOST_TRIED):
        if len(rows) == 0:
            break
        number[rows] += 1
        remaining = _System.of(statics.part(rows), body, density[rows], count)
        squares, _, shares = remaining.modes(number[rows])
        now_Hz, takes_part = _Hz(squares), shares >= TAKES_PART
        is_nearer = takes_part & (nearest_Hz[rows] * now_Hz <= middle_Hz**2)
        nearest_Hz[rows[is_nearer]] = figures_Hz[rows[is_nearer]] = now_Hz[is_nearer]
        rows = rows[~(takes_part & (now_Hz >= middle_Hz))]
    return figures_Hz


@dataclass(frozen=True, slots=True, eq=False)
class _System:
    """Platform and cables about equilibria (n,), with turns as displacements at `reach_m`.

    ``stiffness`` and ``mass`` (n, dof, dof) are K and M, the latter without bounds where inertia is
    not known, so that the platform is held; ``axes`` (n, n_cables, 3, dof) tells how the ends of
    cables move along x and z of their planes, and across; ``at_rest`` (4, n, n_cables) is D_i(0) as
    `Chain` has it; ``start`` (n,) is about (2πf)² of the slowest cable.
    """

    stiffness: FloatArray
    mass: FloatArray
    axes: FloatArray
    at_rest: FloatArray
    chain: Chain
    start: FloatArray

    @classmethod
    def of(
        cls, statics: Statics, body: Platform, density: FloatArray | float, count: int
    ) -> _System:
        """Return the system with cables of so many elements."""
        robot, chord = statics.robot, statics.geometry()
        chain = chain_of(*statics.catenaries, density, count)
        plan = np.where(chord.outward.any(axis=-1, keepdims=True), chord.outward, [1.0, 0.0])
        along = np.zeros((*plan.shape[:-1], 3, 3))
        along[..., 0, :2], along[..., 1, 2], along[..., 2, 1] = plan, 1.0, plan[..., 0]
        along[..., 2, 0] = -plan[..., 1]
        axes = np.concatenate([along, np.cross(chord.lever_m[..., None, :], along)], axis=-1)
        stiffness = scaled(robot, upright_stiffness(statics))
        mass = platform_mass_matrix(statics, body)
        if not knows_inertia(robot, body):
            mass = 1e9 * count * chain.mass_kg.sum() * np.eye(mass.shape[-1]) + 0.0 * mass
        return cls(
            stiffness=0.5 * (stiffness + np.swapaxes(stiffness, -1, -2)),
            mass=scaled(robot, mass),
            axes=axes[..., robot.balance_rows] * per_reach(robot),
            at_rest=chain.resistance_N_per_m(np.zeros(plan.shape[:-1]))[0],
            chain=chain,
            start=(np.pi / _transits_s(statics, density).max(axis=-1)) ** 2,
        )

    def resists(self, square: FloatArray) -> tuple[FloatArray, IntArray]:
        """Return D (..., n, dof, dof) at squares (..., n), and modes of held cables below."""
        ends, below = self.chain.resistance_N_per_m(square[..., None])
        moving = zip(ends, self.at_rest, strict=True)
        xx, xz, zz, across = ((end - rest)[..., None] for end, rest in moving)
        along, up, aside = np.moveaxis(self.axes, 2, 0)
        pulls = np.stack([xx * along + xz * up, xz * along + zz * up, across * aside], axis=-2)
        n, dof = len(self.axes), self.axes.shape[-1]
        to_ends = np.swapaxes(self.axes.reshape(n, -1, dof), 1, 2)
        D = to_ends @ pulls.reshape(*square.shape, -1, dof) + self.stiffness
        D -= square[..., None, None] * self.mass
        return np.where(np.isfinite(D), D, 0.0), below.sum(axis=-1)

    def below(self, square: FloatArray) -> IntArray:
        """Return how many modes lie below squares (..., n)."""
        D, below = self.resists(square)
        for k in range(D.shape[-1]):  # by Gauss, as many pivots are negative as eigenvalues
            pivot, column = D[..., k, k], D[..., k + 1 :, k]
            below += pivot < 0.0
            with np.errstate(divide="ignore", invalid="ignore"):
                factors = column / pivot[..., None]
            D[..., k + 1 :, k + 1 :] -= factors[..., :, None] * column[..., None, :]
        return below

    def following(self) -> FloatArray:
        """Return the squares (n, dof) if cables follow as if at rest, ascending."""
        step = 1e-3 * self.start
        D, (moved, _) = self.stiffness, self.resists(step)
        root = np.linalg.inv(np.linalg.cholesky((D - moved) / step[:, None, None]))
        return np.asarray(np.linalg.eigvalsh(root @ D @ np.swapaxes(root, 1, 2)))

    def modes(self, number: IntArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return squares (n,), vectors (n, dof) and shares of the platform of modes from 1 (n,)."""
        low, square = _squares(self.below, number, self.start)
        step = _STEP * np.maximum(low, self.start * 1e-6)
        (D, below), (before, _) = self.resists(low), self.resists(low - step)
        values, columns = np.linalg.eigh(D)
        # The eigenvalues of D fall below zero in their order.
        index = np.clip(number - 1 - below, 0, values.shape[-1] - 1)
        value = np.take_along_axis(values, index[:, None], axis=1)[:, 0]
        vectors = np.take_along_axis(columns, index[:, None, None], axis=2)[..., 0]
        energy = np.einsum("ni,nij,nj->n", vectors, before - D, vectors) / step
        with np.errstate(divide="ignore", invalid="ignore"):
            shares = np.einsum("ni,nij,nj->n", vectors, self.mass, vectors) / energy
            # Else a cable swings alone, and D is nowhere near a root of this eigenvalue.
            moves = (low == 0.0) | ((energy > 0.0) & (np.abs(value / energy) <= _STEP * low))
            square = np.where(moves & (low > 0.0), low + value / energy, square)
        return square, vectors, np.where(moves, shares, 0.0)


def _squares(
    below: Callable[[FloatArray], IntArray], number: IntArray, start: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return (2πf)² of modes by their numbers from 1 (...), a little below and a little above.

    By sections, on how many modes lie below squares (m, ...), up to a million times the frequency
    of a start (...) and down to as little of it; zero where a mode would not stay, NaN where there
    is none.
    """
    parts = 1 + min(max(_AT_ONCE // (start.size + 1), 1), 15)
    share = (np.arange(parts + 1) / parts).reshape(-1, *(1,) * start.ndim)
    low, high = _RANGE**-2 * start, _RANGE**2 * start
    is_zero, is_none = below(np.zeros_like(start)) >= number, below(high) < number
    for _ in range(math.ceil(_HALVINGS / math.log2(parts))):
        edges = low * (high / low) ** share
        passed = (below(edges[1:-1]) < number).sum(axis=0)[None]
        low, high = (np.take_along_axis(edges, passed + k, axis=0)[0] for k in (0, 1))
    return np.where(is_zero, 0.0, low), np.where(is_none, np.nan, np.where(is_zero, 0.0, high))


def _Hz(squares: FloatArray) -> FloatArray:
    """Return f of (2πf)²; 0 where that is negative."""
    return np.asarray(np.sqrt(np.maximum(squares, 0.0)) / (2.0 * np.pi))


def _transits_s(statics: Statics, density: FloatArray | float) -> FloatArray:
    """Return about how long a wave, two half waves a period, takes along each cable (...) [s]."""
    exit_N, platform_N = statics.end_tensions_N
    return np.asarray(statics.free_length_m * np.sqrt(2.0 * density / (exit_N + platform_N)))
