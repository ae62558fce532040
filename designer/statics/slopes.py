r"""How the largest utilisation in a pose answers to small changes of cables, load and geometry.

Each cable has a tangent stiffness K and a pull F on it that follow from its end, its length l, its
EA and the load w on its length. The state is one in which the balance :math:`\sum W_i F_i = P`
holds and, with more cables than degrees of freedom, the largest utilisation is as small as it can
be above the least tension asked for and with no more sag than allowed. With multipliers μ of the
balance, σ of the cables that are used most (their sum is 1), ρ of those at their least tension τ
and ς of those at their largest sag s,

.. math::

    h_i = σ_i \frac{∂T_i/∂F_i}{A_i} - ρ_i \frac{∂τ_i}{∂F_i} + W_i^\mathsf{T} μ, \qquad
    h_i · \frac{∂F_i}{∂l_i} + \frac{σ_i}{A_i} \frac{∂T_i}{∂l_i} - ρ_i \frac{∂τ_i}{∂l_i}
    + ς_i \frac{ds_i}{dl_i} = 0

which is linear in the multipliers. The slope of the utilisation in anything else is then that of
the same sum with the lengths held: :math:`-K_i h_i` in an exit point, :math:`-μ` in the load. With
as many cables as degrees of freedom this is the adjoint of the implicit function theorem; with more
it is the envelope theorem, and μ, σ and ρ are the multipliers of the optimum.

That F turns with everything else gives its slope in the load across the cable's plane:
:math:`δF = δω × F - K (δω × e)`, e being the chord and δω the turn of the load; a pulley stays
upright (`designer.statics.stiffness`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from designer.arrays import BoolArray, FloatArray
from designer.model.robot import Robot
from designer.physics import catenary
from designer.statics.geometry import cross_matrix, plane_vector
from designer.statics.inverse import Statics, sag_ratio
from designer.statics.stiffness import per_reach, pull_slopes

_TIED, _ACTIVE, _AT_SAG = 1e-7, 1e-5, 1e-4
"""Relative: tensions of the most used cables that are one, and what is at a limit of an optimum;
the limit of the sag is kept with a margin where cables stretch."""
_RANK, _LEFT, _NEGATIVE = 1e-9, 1e-4, -1e-6
"""Smallest singular value over the largest; what may be left of the conditions; no multiplier."""
_STEP = 1e-6
"""Relative, of central differences: the rest is about its square."""
_UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, slots=True, eq=False)
class SagSlopes:
    """Slopes of the sag over the chord of each cable (n,), its forces following."""

    by_length: FloatArray  #: (n,) in the unstrained length [1/m]
    by_stiffness: FloatArray  #: (n,) in the logarithm of EA
    by_load: FloatArray  #: (n, 3) in the load per length [m/N]
    by_chord: FloatArray  #: (n, 3) in the vector from exit point to attachment [1/m]


def sag_slopes(
    length_m: FloatArray, chord_m: FloatArray, EA_N: FloatArray, load_N_per_m: FloatArray
) -> SagSlopes:
    """Return the slopes for lengths and EA (n,), chords and loads per length (n, 3)."""
    state = np.column_stack([length_m, np.log(EA_N), load_N_per_m, chord_m])
    load, chord = (np.linalg.norm(v, axis=1) for v in (load_N_per_m, chord_m))
    sizes = np.column_stack([length_m, np.ones_like(load), *[load] * 3, *[chord] * 3])
    slopes = np.empty_like(state)
    for k in range(state.shape[1]):
        step = np.zeros_like(state)
        step[:, k] = _STEP * sizes[:, k]
        slopes[:, k] = (_sag_ratio(state + step) - _sag_ratio(state - step)) / (2.0 * step[:, k])
    return SagSlopes(slopes[:, 0], slopes[:, 1], slopes[:, 2:5], slopes[:, 5:])


def _sag_ratio(state: FloatArray) -> FloatArray:
    length, EA, load, vector = state[:, 0], np.exp(state[:, 1]), state[:, 2:5], state[:, 5:]
    weight, chord = np.linalg.norm(load, axis=1), np.linalg.norm(vector, axis=1)
    D = np.einsum("nk,nk->n", vector, load) / weight
    X = np.linalg.norm(vector - (D / weight)[:, None] * load, axis=1)
    force_x, force_z = catenary.forces_from_length(length, X, D, EA, weight)
    return np.asarray(catenary.sag_m(length, force_x, force_z, EA, weight, X, D) / chord)


@dataclass(frozen=True, slots=True, eq=False)
class Slopes:
    """Slopes of the utilisation at one pose, the pose itself held."""

    cable: int  #: whose utilisation it is, from 1; of an optimum one of those that are used alike
    utilisation: float  #: its largest tension over its allowable tension
    load: FloatArray  #: in the load wrench, upright frame [1/N, 1/(N·m)]
    stiffness: FloatArray  #: (n_cables,) in the logarithm of each cable's EA
    #: (n_cables, 3) in the load per unstrained length of each cable, base frame [m/N]
    cable_load_m_per_N: FloatArray
    exit_points_per_m: FloatArray  #: (n_cables, 3) in the exit points, base frame [1/m]

    @property
    def position_per_m(self) -> FloatArray:
        """Slope in the position of the platform (3,), base frame [1/m]."""
        return np.asarray(-self.exit_points_per_m.sum(axis=0))


@dataclass(frozen=True, slots=True, eq=False)
class _Tension:
    """A tension of each cable (n,) [N], with its slopes in pull, length and load per length."""

    value: FloatArray
    by_pull: FloatArray  # (n, 3)
    by_length: FloatArray  # (n,) [N/m]
    by_load: FloatArray  # (n, 3) [m]


@dataclass(frozen=True, slots=True, eq=False)
class _CableSlopes:
    """The cables of a pose in the upright frame: pull, chord, load, stiffness, and slopes of F."""

    pull: FloatArray  # (n, 3) [N]
    weight: FloatArray  # (n,), load per unstrained length, along -z [N/m]
    length: FloatArray  # (n,), free of its pulley [m]
    K: FloatArray  # (n, 3, 3), at fixed free length [N/m]
    by_turn: FloatArray  # (n, 3, 3), in a turn of the load [N]
    by_length: FloatArray  # (n, 3) [N/m]
    by_stiffness: FloatArray  # (n, 3), in the logarithm of EA [N]
    by_weight: FloatArray  # (n, 3), in the logarithm of w [N]
    wrench: FloatArray  # (n, dof, 3), from a pull to its wrench
    sag: SagSlopes


@dataclass(frozen=True, slots=True, eq=False)
class _Multipliers:
    """Of the balance (dof,) [1/N, 1/(N·m)], most used cables, least tensions and largest sags."""

    balance: FloatArray
    top: FloatArray  # (n,) over the allowable tension [1/N]
    low: FloatArray  # (n,) [1/N]
    sag: FloatArray  # (n,)


def utilisation_slopes(
    statics: Statics, allowable_N: FloatArray | float, cable: int | None = None
) -> tuple[Slopes, ...]:
    """Return the slopes at a solved pose (1,), one set for each cable that ties for the most.

    With ``cable``, from 1, those of its utilisation alone. Empty where the multipliers of an
    optimum are not unique, or do not fulfil its conditions, and for a cable of it that others are
    used more than: then there is no slope. ``allowable_N`` is one for all cables or (n_cables,)
    [N].
    """
    robot = statics.robot
    allowable = np.broadcast_to(np.asarray(allowable_N, dtype=np.float64), (robot.n_cables,))
    cables = _cables(statics)
    top, low = _top_tension(cables), _least_tension(cables)
    used, least = top.value / allowable, robot.tension_min_N
    governing = used >= used.max() * (1.0 - (_ACTIVE if robot.is_redundant else _TIED))
    sags = np.zeros(robot.n_cables, dtype=np.bool_)
    if robot.is_redundant and robot.sag_max is not None:
        sags = np.asarray(sag_ratio(statics)[0] >= robot.sag_max * (1.0 - _AT_SAG))
    slack = (low.value <= least * (1.0 + _ACTIVE)) & (robot.is_redundant and least > 0.0)
    if cable is not None and robot.is_redundant and not governing[cable - 1]:
        return ()
    if robot.pulley_radius_m != 0.0 and sags.any():  # that follow the tangent points
        return ()
    numbers = np.flatnonzero(governing) if cable is None else [cable - 1]
    one_by_one = [np.arange(robot.n_cables) == k for k in numbers]
    results = []
    for tops in [governing] if robot.is_redundant else one_by_one:
        solved = _multipliers(robot, cables, (top, low), (tops, slack, sags), allowable)
        if solved is None:
            return ()
        results.append(_slopes(robot, cables, top, low, solved, used))
    return tuple(results)


def _multipliers(
    robot: Robot,
    cables: _CableSlopes,
    tensions: tuple[_Tension, _Tension],
    active: tuple[BoolArray, BoolArray, BoolArray],
    allowable_N: FloatArray,
) -> _Multipliers | None:
    """Solve the conditions of the lengths; None where they leave a choice, or cannot be met."""
    n, dof, scale_N = robot.n_cables, robot.degrees_of_freedom, float(allowable_N.max())
    tops = int(active[0].sum())
    columns = [np.einsum("ndk,nk->nd", cables.wrench, cables.by_length) * per_reach(robot)]
    sizes = scale_N / allowable_N, -np.ones(n)
    for tension, is_active, size in zip(tensions, active[:2], sizes, strict=True):
        growth = np.einsum("nk,nk->n", tension.by_pull, cables.by_length) + tension.by_length
        columns.append(np.diag(size * growth)[:, is_active])
    columns.append(np.diag(scale_N * cables.sag.by_length)[:, active[2]])
    if not np.isfinite(columns[0]).all():  # a cable that hangs folded
        return None
    rows = np.hstack(columns) / np.linalg.norm(cables.by_length, axis=1, keepdims=True)
    shares = np.zeros(rows.shape[1])
    shares[dof : dof + tops] = 1.0
    matrix, right = np.vstack([rows, shares]), np.append(np.zeros(n), 1.0)
    solved, _, rank, _ = np.linalg.lstsq(matrix, right, rcond=_RANK)
    residual = float(np.abs(matrix @ solved - right).max())
    if rank < len(shares) or not residual <= _LEFT or (solved[dof:] < _NEGATIVE).any():
        return None
    by_kind = np.zeros((3, n))
    by_kind[np.nonzero(active)] = solved[dof:]
    top, low, sag = by_kind
    balance = solved[:dof] * per_reach(robot)
    return _Multipliers(balance / scale_N, top / allowable_N, low / scale_N, sag)


def _slopes(
    robot: Robot,
    cables: _CableSlopes,
    top: _Tension,
    low: _Tension,
    at: _Multipliers,
    used: FloatArray,
) -> Slopes:
    """Put the multipliers into the slopes of everything else."""
    top_share, low_share = at.top[:, None], at.low[:, None]
    h = top_share * top.by_pull - low_share * low.by_pull
    h = h + np.einsum("ndk,d->nk", cables.wrench, at.balance)
    by_load = top_share * top.by_load - low_share * low.by_load
    by_load[:, 2] -= np.einsum("nk,nk->n", h, cables.by_weight) / cables.weight
    for axis in range(2):  # across the load, which turns
        rotation = np.cross([0.0, 0.0, -1.0], np.eye(3)[axis])
        moved = cables.by_turn @ rotation / cables.weight[:, None]
        by_load[:, axis] += np.einsum("nk,nk->n", h, moved)
    sag_share, sag = at.sag[:, None], cables.sag
    by_load += sag_share * sag.by_load
    by_exit_point = -np.einsum("nij,ni->nj", cables.K, h) - sag_share * sag.by_chord
    cable = int(np.where(at.top > 0.0, used, 0.0).argmax())
    return Slopes(
        cable=cable + 1,
        utilisation=float(used[cable]),
        load=-at.balance,
        stiffness=np.einsum("nk,nk->n", h, cables.by_stiffness) + at.sag * sag.by_stiffness,
        cable_load_m_per_N=by_load @ robot.upright,
        exit_points_per_m=by_exit_point @ robot.upright,
    )


def _cables(statics: Statics) -> _CableSlopes:
    """Return the cables of a pose (1,) with the slopes of their pulls."""
    robot, geometry = statics.robot, statics.geometry()
    length, F_x, F_z, EA, w = (
        np.broadcast_to(v, (1, robot.n_cables))[0] for v in statics.catenaries
    )
    lever = cross_matrix(geometry.lever_m[0])
    wrench = np.concatenate([np.broadcast_to(np.eye(3), lever.shape), lever], axis=1)
    slopes = pull_slopes(statics)
    across, down = geometry.horizontal_distance_m[0], -geometry.drop_m[0]
    vector = plane_vector(across, down, geometry.outward[0])
    return _CableSlopes(
        pull=plane_vector(F_x, F_z, geometry.outward[0]),
        weight=w,
        length=length,
        K=slopes.by_end[0],
        by_turn=slopes.by_turn[0],
        by_length=slopes.by_length[0],
        by_stiffness=slopes.by_stiffness[0],
        by_weight=slopes.by_weight[0],
        wrench=wrench[:, robot.balance_rows],
        sag=sag_slopes(length, vector, EA, -w[:, None] * _UP),
    )


def _top_tension(cables: _CableSlopes) -> _Tension:
    """Return the larger of the tensions at both ends of each cable."""
    exit_pull = cables.pull - (cables.weight * cables.length)[:, None] * _UP
    at_exit, at_platform = (np.linalg.norm(f, axis=1) for f in (exit_pull, cables.pull))
    is_exit = at_exit >= at_platform
    pull = np.where(is_exit[:, None], exit_pull, cables.pull)
    value = np.maximum(at_exit, at_platform)
    return _at_end(cables, pull / value[:, None], value, is_exit)


def _least_tension(cables: _CableSlopes) -> _Tension:
    """Return the least tension: at the lower end, or where the cable hangs below both of them."""
    exit_pull = cables.pull - (cables.weight * cables.length)[:, None] * _UP
    is_exit = exit_pull[:, 2] >= 0.0
    hangs = (cables.pull[:, 2] > 0.0) & (exit_pull[:, 2] < 0.0)
    pull = np.where(is_exit[:, None], exit_pull, cables.pull)
    pull[hangs, 2] = 0.0
    value = np.linalg.norm(pull, axis=1)
    tension = _at_end(cables, pull / value[:, None], value, is_exit & ~hangs)
    # The lowest point moves as the load turns: T² = F² - (F · w / |w|)².
    leaning = cables.pull[:, 2] / cables.weight
    tension.by_load[hangs] = (leaning[:, None] * tension.by_pull)[hangs]
    return tension


def _at_end(
    cables: _CableSlopes, by_pull: FloatArray, value: FloatArray, is_exit: BoolArray
) -> _Tension:
    """Return a tension whose pull at the exit point has the load of the whole length in it."""
    length = np.where(is_exit, cables.length, 0.0)
    by_length = -np.where(is_exit, cables.weight, 0.0) * by_pull[:, 2]
    return _Tension(value, by_pull, by_length, length[:, None] * by_pull)
