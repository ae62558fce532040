r"""The thinnest cable of a redundant robot by sequential convex programs: the readable reference.

One pose at a time, each programme by Clarabel. Each cable of unit weight has one free pull
:math:`p_i`, horizontal force over weight and horizontal distance; its length, its upward pull
:math:`v_i`, its top tension :math:`T_i` and the least tension in it :math:`\tau_i` follow. With c
the inverse of the weight per length,

.. math::  \max c \quad \text{s.t.} \quad \sum_i W_i(p_i) = c\,w, \quad T_i(p_i) \le \sigma/(g\rho),
           \quad \tau_i(p_i) \ge c\,t_{min}, \quad p_i \ge p_i^{sag}.

Each turn linearises the cables at the last pulls, adds the convex part of the Lagrangian's
curvature, which is diagonal, keeps the pulls within a trust region, puts a price on what is
violated there, and ends with a step back into balance; the start is the massless solution. The
full non-linear residuals and those of the optimality conditions come with the answer. The compiled
solver of `designer.kernel.redundant` is tested against it. Lipp and Boyd, Optimization and
Engineering 17, 2016, for the method.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from designer.arrays import FloatArray
from designer.model.cable import Material
from designer.model.robot import Poses, Robot
from designer.physics import catenary
from designer.resources import missing_library
from designer.statics.geometry import CableGeometry, cable_geometry, load_wrench_N, structure_matrix
from designer.statics.inverse import distribute_evenly

_START_PULL = 0.7
_TRUST = 0.5
_ALONG = 1e-4
_PRICE = 100.0  # of a violation; above the sum of all multipliers
_ROUNDING = 1e-13
_STILL = 1e-8
_AT_BOUND = 1e-7
_SLACKEST, _HALVINGS = 1.0 / 64.0, 60
"""Least pull of all, as of the compiled solver, and steps between it and the taut end."""


@dataclass(frozen=True, slots=True, eq=False)
class ScpSizing:
    """The optimum and how well it meets its conditions.

    Parameters
    ----------
    diameter_m : float
        Nominal diameter [m]; NaN if the turns did not settle.
    force_x_N, length_m : array (n_cables,)
        Horizontal forces [N] and unstrained lengths [m].
    feasibility_residual : float
        Worst violation of any constraint by the full non-linear equations, over the strength.
    optimality_residual : float
        Worst violation of stationarity in scaled variables, with multipliers only of what is at
        its bound: the non-negative ones that suit it best.
    turns : int
        Convex programmes that were solved.
    has_converged : bool
        Whether both residuals are below 1e-6.
    """

    diameter_m: float
    force_x_N: FloatArray
    length_m: FloatArray
    feasibility_residual: float
    optimality_residual: float
    turns: int
    has_converged: bool


@dataclass(frozen=True, slots=True, eq=False)
class _State:
    """Cables of unit weight at scaled pulls y = p L / strength, with slopes in y.

    Parameters
    ----------
    wrench, wrench_y, wrench_yy : array (dof, n_cables)
        Over the strength length.
    tension, tension_y, lowest, lowest_y : array (n_cables,)
        Largest and least tension anywhere in the cable, over the strength length.
    length_m : array (n_cables,)
        Unstrained lengths [m].
    """

    wrench: FloatArray
    wrench_y: FloatArray
    wrench_yy: FloatArray
    tension: FloatArray
    tension_y: FloatArray
    lowest: FloatArray
    lowest_y: FloatArray
    length_m: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class _Turn:
    """Solution of one convex programme: pulls, c and the multipliers of the balance."""

    y: FloatArray
    c: float
    balance: FloatArray


def size_by_scp(robot: Robot, pose: Poses, material: Material, *, max_turns: int = 60) -> ScpSizing:
    """Return the thinnest cable for which some internal forces hold the pose.

    Parameters
    ----------
    robot : Robot
        With more cables than degrees of freedom, and no pulleys.
    pose : Poses
        A single pose that straight cables can hold.
    material : Material
        The family of cables.
    max_turns : int
        Gives up after so many.

    Raises
    ------
    ValueError
        If straight cables cannot hold the pose, if the robot has pulleys, or if a library that
        solves the programmes is not installed.
    """
    missing = missing_library("clarabel")
    if missing:
        raise ValueError(missing)
    if robot.pulley_radius_m != 0.0:
        raise ValueError("the reference has no pulleys")
    problem = _Problem.of(robot, pose, material)
    y, c = problem.start()
    state, trust, turns = problem.state(y), _TRUST, 0
    multiplier = np.zeros(len(problem.load))
    while turns < max_turns and trust > 1e-10:
        turns += 1
        step = _solve(problem, state, y, multiplier, trust)
        if step is None:
            trust *= 0.25
            continue
        if float(np.abs(step.y / y - 1.0).max()) + abs(step.c - c) < _STILL:
            break
        step = problem.corrected(step)
        moved = problem.state(step.y)
        better = problem.merit(moved, step.c)
        if better > problem.merit(state, c) + _ROUNDING:
            trust *= 0.25
            continue
        y, c, state, multiplier = step.y, step.c, moved, step.balance
        trust = min(2.0 * trust, _TRUST)
    return problem.answer(state, y, c, turns)


@dataclass(frozen=True, slots=True, eq=False)
class _Problem:
    """One pose, forces over the strength of the cable; moments over the reach."""

    material: Material
    distance_m: FloatArray
    drop_m: FloatArray
    chord_m: FloatArray
    forces: FloatArray
    load: FloatArray
    load_N: float
    least: FloatArray
    straight: FloatArray
    floor: FloatArray

    @classmethod
    def of(cls, robot: Robot, pose: Poses, material: Material) -> _Problem:
        geometry = cable_geometry(robot, pose)
        massless_N = distribute_evenly(robot, pose)
        if np.isnan(massless_N).any():
            raise ValueError("straight cables cannot hold this pose")
        reach = float(np.abs(robot.attachments_m).sum(axis=1).max()) or 1.0
        rows = np.where(robot.balance_rows < 3, 1.0, reach)
        wrench = load_wrench_N(robot, pose) / rows
        size = float(np.abs(wrench).max())
        return cls(
            material,
            geometry.horizontal_distance_m,
            geometry.drop_m,
            geometry.chord_m,
            structure_matrix(robot, geometry) / rows[:, None],
            wrench / size,
            size,
            np.full(robot.n_cables, robot.tension_min_N / size),
            massless_N / size,
            _pulls_of_sag(robot.sag_max, geometry, material),
        )

    def start(self) -> tuple[FloatArray, float]:
        """The massless design, with no cable all but slack."""
        c = 1.0 / float(self.straight.max())
        slack = _START_PULL * self.chord_m / self.material.strength_length_m
        return np.maximum.reduce([self.straight * c, slack, self.floor]), c

    def state(self, y: FloatArray) -> _State:
        """Return the cables at scaled pulls, their slopes by central differences."""
        middle, ahead, behind = (self._cables(y * f) for f in (1.0, 1.0 + _ALONG, 1.0 - _ALONG))
        step = _ALONG * y
        slopes = [(a - b) / (2.0 * step) for a, b in zip(ahead, behind, strict=True)]
        bend = (ahead[0] - 2.0 * middle[0] + behind[0]) / step**2
        return _State(
            middle[0], slopes[0], bend, middle[1], slopes[1], middle[2], slopes[2], middle[3]
        )

    def _cables(self, y: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        strength = self.material.strength_length_m
        pull = y * strength / self.chord_m
        kappa = self.material.elastic_compliance_per_m
        length, force_z = catenary.length_and_force_z(
            pull, self.distance_m, self.drop_m, 1.0 / kappa, 1.0
        )
        force_x = pull * self.distance_m
        ends = catenary.end_tensions_N(length, force_x, force_z, 1.0)
        wrench = self.forces[:, 0::2] * force_x + self.forces[:, 1::2] * force_z
        lowest = catenary.least_tension_N(length, force_x, force_z, 1.0)
        return wrench / strength, np.maximum(*ends) / strength, lowest / strength, length

    def merit(self, state: _State, c: float) -> float:
        """Return what each turn has to lower: -c, and the worst violation at its price."""
        return -c + _PRICE * self.violation(state, c)

    def corrected(self, turn: _Turn) -> _Turn:
        """Bring the balance back by the least relative change, of cables with room for it.

        Without this a full step of second-order violation is refused however good it is.
        """
        state = self.state(turn.y)
        rest = state.wrench.sum(axis=1) - turn.c * self.load
        slopes = np.column_stack([state.wrench_y, -self.load])
        freedom = np.append(turn.y * np.maximum(1.0 - state.tension, 0.0), turn.c)
        step = np.linalg.lstsq(slopes * freedom, rest, rcond=None)[0] * freedom
        y = np.maximum.reduce([turn.y - step[:-1], 0.5 * turn.y, self.floor])
        return replace(turn, y=y, c=turn.c - step[-1])

    def violation(self, state: _State, c: float) -> float:
        """Return the worst violation of the full equations."""
        rest = state.wrench.sum(axis=1) - c * self.load
        return max(
            float(np.abs(rest).max()),
            float(np.maximum(state.tension - 1.0, 0.0).max()),
            float(np.maximum(c * self.least - state.lowest, 0.0).max()),
        )

    def gap(self, state: _State, y: FloatArray, c: float) -> float:
        """Return the worst residual of stationarity, with the multipliers that suit it best.

        Those of the balance are free, those of what is at its bound non-negative; least squares.
        """
        from scipy.optimize import nnls

        n, dof = len(y), len(self.load)
        full = np.nonzero(state.tension > 1.0 - _AT_BOUND)[0]
        least = np.nonzero((self.least > 0.0) & (state.lowest < c * self.least + _AT_BOUND))[0]
        at_full = np.eye(n)[:, full] * state.tension_y[full]
        at_least = -np.eye(n)[:, least] * state.lowest_y[least]
        sags = np.nonzero(y < self.floor * (1.0 + _AT_BOUND))[0]
        in_y = np.hstack([state.wrench_y.T, at_full, at_least, -np.eye(n)[:, sags]])
        in_c = [-self.load, np.zeros(len(full)), self.least[least], np.zeros(len(sags))]
        slopes = np.vstack([in_y, np.concatenate(in_c)])
        unit = np.eye(n + 1)[n]
        signed = np.hstack([slopes, -slopes[:, :dof]])
        return float(np.abs(signed @ nnls(signed, unit)[0] - unit).max())

    def answer(self, state: _State, y: FloatArray, c: float, turns: int) -> ScpSizing:
        """Return the result in SI units."""
        infeasible = self.violation(state, c)
        gap = self.gap(state, y, c)
        converged = infeasible < 1e-6 and gap < 1e-6 and c > 0.0
        allowable_N = self.load_N / c
        area = allowable_N / self.material.allowable_stress_Pa
        return ScpSizing(
            diameter_m=float(np.sqrt(4.0 * area / np.pi)) if converged else float("nan"),
            force_x_N=y * allowable_N * self.distance_m / self.chord_m,
            length_m=state.length_m,
            feasibility_residual=infeasible,
            optimality_residual=gap,
            turns=turns,
            has_converged=converged,
        )


def _pulls_of_sag(sag_max: float, geometry: CableGeometry, material: Material) -> FloatArray:
    """Return the scaled pulls (n,) at which cables sag as far as they may."""
    X, D, chord = geometry.horizontal_distance_m, geometry.drop_m, geometry.chord_m
    EA = 1.0 / material.elastic_compliance_per_m
    low, high = np.full_like(chord, _SLACKEST), np.full_like(chord, 1.0 + 1.0 / sag_max)
    for _ in range(_HALVINGS):
        p = np.sqrt(low * high)
        length, force_z = catenary.length_and_force_z(p, X, D, EA, 1.0)
        is_slack = catenary.sag_m(length, p * X, force_z, EA, 1.0, X, D) > sag_max * chord
        low, high = np.where(is_slack, p, low), np.where(is_slack, high, p)
    return np.asarray(high * chord / material.strength_length_m)


def _solve(
    problem: _Problem, state: _State, y: FloatArray, multiplier: FloatArray, trust: float
) -> _Turn | None:
    """Solve the convex programme of a turn in the step of the pulls, c and the violation.

    Every row but those of the step may be missed by the violation, at its price.
    """
    import clarabel
    from scipy.sparse import csc_matrix, diags

    dof, n = state.wrench_y.shape
    one, none = np.ones((n, 1)), np.zeros((n, 1))
    balance = np.column_stack([state.wrench_y, -problem.load])
    rest = state.wrench.sum(axis=1)
    room = np.clip(y - problem.floor, 0.0, trust * y)
    rows = [
        (np.hstack([balance, -np.ones((dof, 1))]), -rest),
        (np.hstack([-balance, -np.ones((dof, 1))]), rest),
        (np.hstack([np.diag(state.tension_y), none, -one]), 1.0 - state.tension),
        (np.hstack([-np.diag(state.lowest_y), problem.least[:, None], -one]), state.lowest),
        (np.hstack([np.eye(n), none, none]), trust * y),
        (np.hstack([-np.eye(n), none, none]), room),
        (-np.eye(n + 2)[-1:], np.zeros(1)),
    ]
    A, b = (np.concatenate(part) for part in zip(*rows, strict=True))
    bend = np.maximum(multiplier @ state.wrench_yy, 0.0)
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = 1e-12
    solution = clarabel.DefaultSolver(
        csc_matrix(diags([*bend, 0.0, 0.0])),
        np.concatenate([np.zeros(n), [-1.0, _PRICE]]),
        csc_matrix(A),
        b,
        [clarabel.NonnegativeConeT(len(b))],
        settings,
    ).solve()
    # Of less than full accuracy too; the residuals of the answer tell.
    if str(solution.status) not in ("Solved", "AlmostSolved"):
        return None
    x, dual = np.array(solution.x), np.array(solution.z)
    return _Turn(y + x[:n], float(x[n]), dual[:dof] - dual[dof : 2 * dof])
