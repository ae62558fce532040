"""Forward prediction: pose and tensions by the measured lengths alone.

This is what a user of the machine sees of a model: winches give lengths, forward statics makes a
pose of them. Nothing is fitted to it; the poses of the rows are used as starts, and compared.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from designer.arrays import BoolArray, FloatArray
from designer.diagnosis.blocks import block_of
from designer.diagnosis.errors_of import Interval, bootstrap
from designer.diagnosis.physical import added_force_N
from designer.diagnosis.problem import Problem
from designer.diagnosis.robust import without_outliers
from designer.effects.effect import Setting
from designer.model.robot import Poses
from designer.statics.forward import solve_forward


@dataclass(frozen=True, slots=True)
class Foretold:
    """Root mean square errors of forward statics over rows that no fit has seen.

    Parameters
    ----------
    n_rows, n_solved : int
        Held-out rows with all lengths, and those of them in which a balance was found.
    position_m : Interval
        Distance of the platform from where it was [m].
    turn_rad : Interval or None
        Angle of the platform against where it was [rad]; None for one that cannot turn.
    tension_N : Interval or None
        Of the tensions at the winches [N]; None where none were measured.
    """

    n_rows: int
    n_solved: int
    position_m: Interval
    turn_rad: Interval | None
    tension_N: Interval | None


def with_sound_lengths(problem: Problem, settings: Sequence[Setting]) -> BoolArray:
    """Return the rows (n_rows,) with all lengths, none of which stands off from the model."""
    n = problem.measured.length_m.shape[1]
    residual = without_outliers(problem.residual(settings))
    return np.asarray(np.isfinite(residual[:, :n]).all(axis=1))


def foretell(problem: Problem, settings: Sequence[Setting], chosen: BoolArray) -> Foretold | None:
    """Return how well lengths alone foretell pose and tensions; None without any row or pose.

    Parameters
    ----------
    problem, settings
        Data, and the effects in the model.
    chosen : array (n_rows,) of bool
        Rows to compare; each has all lengths.
    """
    measured = problem.measured
    rows = np.flatnonzero(chosen)
    if not rows.size or not measured.has_poses:
        return None
    true = problem.predict.true_readings(settings, problem.noise)
    built = problem.predict.built(settings)
    force = added_force_N(built, measured)
    rotation = measured.poses.rotation
    poses = Poses(
        measured.poses.position_m[rows], rotation if rotation.ndim == 2 else rotation[rows]
    )
    forward_statics = solve_forward(
        built.robot, built.cable, true.length_m[rows], poses, None if force is None else force[rows]
    )
    block = block_of(len(chosen))[rows]
    away = np.linalg.norm(forward_statics.poses.position_m - poses.position_m, axis=-1)
    tension = true.tension_N[rows] - forward_statics.statics.exit_tension_N
    return Foretold(
        n_rows=rows.size,
        n_solved=int(forward_statics.statics.is_solved.sum()),
        position_m=bootstrap(away[:, None], block),
        turn_rad=None
        if built.robot.is_point_mass
        else bootstrap(_turn_rad(forward_statics.poses, poses)[:, None], block),
        tension_N=None if np.isnan(tension).all() else bootstrap(tension, block),
    )


def _turn_rad(poses: Poses, targets: Poses) -> FloatArray:
    """Return the angle between two sets of poses (n_rows,); NaN where there is none."""
    between = np.swapaxes(targets.rotation, -1, -2) @ poses.rotation
    cosine = 0.5 * (np.trace(between, axis1=-2, axis2=-1) - 1.0)
    axis = np.stack([between[..., i, j] - between[..., j, i] for i, j in ((2, 1), (0, 2), (1, 0))])
    return np.asarray(np.arctan2(0.5 * np.linalg.norm(axis, axis=0), cosine))
