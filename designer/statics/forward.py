"""From lengths to pose and tensions: the forward statics of a robot with given cables.

The cables have fixed unstrained lengths; each is an elastic catenary, taut or slack. The platform
rests where its balance closes. Newton's method on the pose, with the exact stiffness
(`designer.statics.stiffness`), kept on course by two safeguards: negative eigenvalues are taken
as positive, so that a step leads away from an unstable balance and toward a stable one; and a
step is kept only where the force along it, averaged over its two ends, still pushes forward (the
trapezoid rule for the energy that it sets free), else a shorter one is tried.

Any number of cables will do: with fewer than degrees of freedom gravity holds the rest.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.spatial.transform import Rotation

from designer.arrays import BoolArray, FloatArray, VerdictArray
from designer.model.cable import Cable, Cables
from designer.model.robot import Poses, Robot
from designer.model.verdict import Verdict
from designer.statics.fixed_length import cables_of_length
from designer.statics.inverse import Statics
from designer.statics.stiffness import is_stable, per_reach, reach_m, scaled, upright_stiffness

_MOST_STEPS = 300

_TOLERANCE = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class ForwardStatics:
    """Where the platform comes to rest on cables of given lengths.

    Parameters
    ----------
    statics : Statics
        The balance that was found (...): pose, forces, tensions, residuals. ``solved`` means that
        the platform's balance closes to 1e-9 of the largest tension; NaN otherwise.
    is_stable : array (...) of bool
        Whether the stiffness there is positive definite; only then does the platform stay.
    """

    statics: Statics
    is_stable: BoolArray

    @property
    def verdict(self) -> VerdictArray:
        """One `Verdict` a problem (...): solved, or not converged."""
        return self.statics.verdict

    @property
    def poses(self) -> Poses:
        """The poses found (...)."""
        return self.statics.poses


def solve_forward(
    robot: Robot,
    cable: Cable | Cables,
    length_m: FloatArray,
    start: Poses,
    force_N: FloatArray | None = None,
    *,
    to_any: BoolArray | None = None,
) -> ForwardStatics:
    """Return the balance that is reached from given starts on cables of given lengths.

    Parameters
    ----------
    robot, cable
        The robot, with any number of cables, and its cables: one `Cable` for all, or `Cables`.
    length_m : array (..., n_cables)
        Unstrained lengths from the exit points, around pulleys where there are any [m].
    start : Poses
        Where the search begins (...), base frame; its axes broadcast with those of the lengths.
    force_N : array (..., 3), optional
        Force on the platform beside its weight, base frame [N].
    to_any : array (...) of bool, optional
        Which problems go to any balance that is near, by Newton's own steps, stable or not; the
        others are led away from unstable ones, as all are if left out.
    """
    shape = np.broadcast_shapes(np.shape(length_m)[:-1], start.shape)
    lengths = np.broadcast_to(length_m, (*shape, robot.n_cables)).reshape(-1, robot.n_cables)
    position = np.broadcast_to(start.position_m, (*shape, 3)).reshape(-1, 3)
    rotation = np.broadcast_to(start.rotation, (*shape, 3, 3)).reshape(-1, 3, 3)
    force = None if force_N is None else np.broadcast_to(force_N, (*shape, 3)).reshape(-1, 3)
    signed = np.broadcast_to(np.bool_(False) if to_any is None else to_any, shape).reshape(-1)
    search = _EnergyDescent(robot, cable, lengths, Poses(position, rotation), force, signed)
    search.run()
    return _result(search, shape, force_N)


class _EnergyDescent:
    """Newton's method on many problems at once, each with a trust radius of its own."""

    def __init__(
        self,
        robot: Robot,
        cable: Cable | Cables,
        length_m: FloatArray,
        start: Poses,
        force_N: FloatArray | None,
        signed: BoolArray,
    ) -> None:
        self.signed = signed
        self.robot, self.cable, self.length_m, self.force_N = robot, cable, length_m, force_N
        self.position = start.position_m.copy()
        self.rotation = start.rotation.copy()
        self.size = float(np.linalg.norm(np.ptp(robot.exit_points_m, axis=0))) + reach_m(robot)
        self.radius = np.full(len(length_m), 0.1 * self.size)
        self.left = np.full(len(length_m), 3)  # steps that are tried at rest for the last digits

    def statics(self, chosen: BoolArray, poses: Poses) -> Statics:
        """Return the cables of some problems in trial poses."""
        ones = np.ones((int(chosen.sum()), 1))
        return cables_of_length(
            self.robot,
            poses,
            self.length_m[chosen],
            self.cable.axial_stiffness_N * ones,
            self.cable.weight_N_per_m * ones,
            None if self.force_N is None else self.force_N[chosen],
        )

    def run(self) -> None:
        """Step until every problem has come to rest or to its end."""
        everything = np.ones(len(self.length_m), dtype=np.bool_)
        statics = self.statics(everything, Poses(self.position, self.rotation))
        self.push, self.stiffness = _push(statics), self._stiffness(statics)
        active = np.asarray(np.isfinite(self.push).all(axis=-1))
        for _ in range(_MOST_STEPS):
            if not active.any():
                break
            self._step(active)
            active = np.asarray(active & (self.left > 0) & (self.radius > 1e-14 * self.size))

    def _step(self, active: BoolArray) -> None:
        poses = Poses(self.position[active], self.rotation[active])
        signed = self.signed[active]
        step, rounding = _newton_step(self.stiffness[active], self.push[active], self.size, signed)
        length = np.linalg.norm(step, axis=-1)
        radius = self.radius[active]
        step = step * np.minimum(1.0, radius / np.maximum(length, 1e-300))[:, None]
        trial = moved_poses(self.robot, poses, step)
        statics = self.statics(active, trial)
        push, stiffness = _push(statics), self._stiffness(statics)
        before, after = self.push[active], push
        rests = np.linalg.norm(before, axis=-1) <= rounding
        mean_work = np.einsum("pi,pi->p", before + after, step)
        closer = np.linalg.norm(after, axis=-1) < np.linalg.norm(before, axis=-1)
        # At rest a step is kept if it comes closer.
        is_kept = np.where(rests | signed, closer, mean_work > 0.0)
        step_m = np.minimum(length, radius)
        wider = np.maximum(radius, np.minimum(2.0 * step_m, self.size))
        self.radius[active] = np.where(rests, radius, np.where(is_kept, wider, 0.25 * step_m))
        self.left[active] -= rests
        moved = np.flatnonzero(active)[is_kept]
        self.position[moved] = trial.position_m[is_kept]
        self.rotation[moved] = trial.rotation[is_kept]
        self.push[moved], self.stiffness[moved] = push[is_kept], stiffness[is_kept]

    def _stiffness(self, statics: Statics) -> FloatArray:
        return scaled(self.robot, upright_stiffness(statics))


def moved_poses(robot: Robot, poses: Poses, step_m: FloatArray) -> Poses:
    """Return poses (n,) moved by steps (n, dof) [m], those of a turn times the robot's reach."""
    twist = np.zeros((len(step_m), 6))
    twist[:, robot.balance_rows] = step_m
    upright = robot.upright
    position = poses.position_m + twist[:, :3] @ upright
    if robot.is_point_mass:
        return Poses(position, poses.rotation)
    turn = Rotation.from_rotvec(twist[:, 3:] @ upright / reach_m(robot)).as_matrix()
    return Poses(position, turn @ poses.rotation)


def _push(statics: Statics) -> FloatArray:
    """Return what is left on the platform, upright frame, moments over the reach (..., dof) [N]."""
    return np.asarray(-statics.equilibrium_residual_N() * per_reach(statics.robot))


def _newton_step(
    stiffness: FloatArray, push: FloatArray, size: float, signed: BoolArray
) -> tuple[FloatArray, FloatArray]:
    """Return the step along falling energy, and the push that rounding alone can make [N].

    Where ``signed``, the step is that to where nothing is left, be it along rising energy.
    """
    finite = np.asarray(np.isfinite(stiffness).all(axis=(-2, -1)))
    safe = np.where(finite[:, None, None], stiffness, np.eye(stiffness.shape[-1]))
    eigenvalues, axes = np.linalg.eigh(0.5 * (safe + np.swapaxes(safe, -1, -2)))
    strength = np.abs(eigenvalues)
    stiffest = strength.max(axis=-1)
    # What is softer would take a step of any length.
    strength = np.maximum(strength, 1e-10 * stiffest[:, None])
    strength = np.where(signed[:, None] & (eigenvalues < 0.0), -strength, strength)
    along = np.einsum("pij,pi->pj", axes, push) / strength
    return np.einsum("pij,pj->pi", axes, along), 8.0 * np.finfo(np.float64).eps * stiffest * size


def _result(
    search: _EnergyDescent, shape: tuple[int, ...], force_N: FloatArray | None
) -> ForwardStatics:
    robot = search.robot
    everything = np.ones(len(search.length_m), dtype=np.bool_)
    statics = search.statics(everything, Poses(search.position, search.rotation))
    with np.errstate(invalid="ignore"):
        imbalance = np.abs(_push(statics)).max(axis=-1)
        close = imbalance <= _TOLERANCE * np.maximum(statics.largest_tension_N, robot.weight_N)
    solved = close & statics.is_solved
    stable = solved & is_stable(robot, upright_stiffness(statics))

    def whole(values: FloatArray) -> FloatArray:
        masked = np.where(solved.reshape(-1, *[1] * (values.ndim - 1)), values, np.nan)
        return np.asarray(masked.reshape(*shape, *values.shape[1:]))

    run = statics.run
    if run.has_wrap:
        run = replace(run, exit_points_m=whole(run.exit_points_m), wrap_m=whole(run.wrap_m))
    rotation = np.eye(3) if robot.is_point_mass else whole(search.rotation)
    names = "weight_N_per_m", "axial_stiffness_N", "length_m", "force_x_N", "force_z_N"
    numbers: dict[str, Any] = {name: whole(getattr(statics, name)) for name in names}
    verdict = np.where(solved, Verdict.SOLVED, Verdict.NOT_CONVERGED).astype(np.int8)
    found = replace(
        statics,
        poses=Poses(whole(search.position), rotation),
        verdict=verdict.reshape(shape),
        run=run,
        force_N=force_N,
        **numbers,
    )
    return ForwardStatics(found, stable.reshape(shape))
