"""Rows at the edge of what the cables hold, where readings change much faster than the pose.

A taut cable's length changes by no more than the pose does. Near the edge a cable hangs slack, and
its length tells the pose of the model a thousand times better than any camera tells the true one: a
fit that took the poses for exact would be settled by that row alone. Deviations are therefore told
as if, in such rows, the poses had the noise of a length.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from designer.arrays import FloatArray
from designer.diagnosis.problem import Problem
from designer.effects.effect import Setting, frame_size_m
from designer.statics.forward import moved_poses

_STEEP = 5.0
"""Change of a length over that of the pose from which on a row is at the edge: a taut cable's is at
most 1, and over pulleys and with sag hardly more."""
_STEP = 1e-7
"""Over the frame's size: far above the solver's residual, and short against the way to the edge."""


def steepness(problem: Problem, settings: Sequence[Setting]) -> FloatArray:
    """Return by how much more than noise each reading is in doubt (n_rows, n_readings).

    That is √(1 + |∂r/∂pose|²) with the pose in units of a length's noise; 1 in rows that are not at
    the edge, and of robots whose internal forces or poses are taken from the readings themselves.
    """
    predict, measured = problem.predict, problem.measured
    robot, n_cables = predict.machine.robot, measured.length_m.shape[1]
    slopes = np.zeros((*measured.readings.shape, robot.degrees_of_freedom))
    if predict.row_unknowns:
        return np.ones(problem.measured.is_read.shape)
    predicted = problem.predicted(settings).stacked
    step_m = _STEP * frame_size_m(predict.machine)
    for k in range(robot.degrees_of_freedom):
        steps = np.zeros((measured.n_rows, robot.degrees_of_freedom))
        for side in (step_m, -step_m):  # the larger: the model may hold a row on one side only
            steps[:, k] = side
            there = replace(measured, poses=moved_poses(robot, measured.poses, steps))
            change = predict.at(there)(settings, problem.noise).stacked - predicted
            slope = np.nan_to_num(change / side)
            slopes[..., k] = np.where(np.abs(slope) > np.abs(slopes[..., k]), slope, slopes[..., k])
    steepest = np.max(np.abs(slopes[:, :n_cables]), axis=(1, 2))
    in_noise = np.linalg.norm(slopes, axis=-1) * problem.noise.length_m / problem.sigma
    return np.where(steepest[:, None] > _STEEP, np.sqrt(1.0 + in_noise**2), 1.0)
