"""How cables run over their pulleys: where they leave them, straight or sagging."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from designer.arrays import FloatArray
from designer.model.robot import Poses, Robot
from designer.physics import pulley
from designer.statics.geometry import (
    CableGeometry,
    cable_geometry,
    level_geometry,
    upright_exit_points_m,
)

MOST_ITERATIONS = 40
"""For tangent points to rest: a handful does, but for slack cables over a large pulley."""
STILL_RAD, SETTLED_RAD = 1e-13, 1e-9
"""Last change of the angle at which a cable leaves its pulley: at rounding, and good enough."""
PATIENCE = 8
"""Turns after which each cable goes by its own secant, and a pose starts from its last answer."""
_LEAST_SHARE = 1.0 / 32.0
"""Of the way to the next tangent point, however it swings."""
Answer = TypeVar("Answer")


@dataclass(frozen=True, slots=True, eq=False)
class PulleyRun:
    """How the cables run over their pulleys."""

    #: (n_cables, 3) where the cables leave the pulleys, upright frame [m]; the exit points without
    #: pulleys
    exit_points_m: FloatArray
    wrap_m: FloatArray  #: (..., n_cables) length that lies on the pulleys [m]

    @property
    def has_wrap(self) -> bool:
        """Whether there are pulleys at all."""
        return bool(self.wrap_m.any())

    def unstrained(self, strain: FloatArray | float) -> PulleyRun:
        """Return the run with the wrapped length taken back to no tension."""
        if not self.has_wrap:
            return self
        return replace(self, wrap_m=self.wrap_m / (1.0 + strain))


def straight_run(robot: Robot, poses: Poses) -> PulleyRun:
    """Return how straight cables run over the pulleys in poses (...)."""
    if robot.pulley_radius_m == 0.0:
        return PulleyRun(upright_exit_points_m(robot), np.zeros(1))
    geometry = level_geometry(robot, poses)
    return run_at(robot, geometry, _straight_slope_rad(robot, geometry))


def _straight_slope_rad(robot: Robot, geometry: CableGeometry) -> FloatArray:
    return pulley.straight_slope_rad(
        geometry.horizontal_distance_m, geometry.drop_m, robot.pulley_radius_m
    )


def run_at(robot: Robot, level: CableGeometry, slope_rad: FloatArray) -> PulleyRun:
    """Return the run over pulleys, which stand upright however the load on the cables points."""
    radius, exits = robot.pulley_radius_m, robot.exit_points_m @ robot.level.T
    points = pulley.tangent_point_m(exits, level.outward, slope_rad, radius)
    if robot.cable_load_direction is not None:
        points = points @ robot.leaning.T
    return PulleyRun(points, pulley.wrap_length_m(slope_rad, radius))


def _slope_over_pulley_rad(
    robot: Robot, poses: Poses, level: CableGeometry, run: PulleyRun, slope_rad: FloatArray
) -> FloatArray:
    """Return the angle at which cables leave in their pulleys' planes (...), from true horizontal.

    ``slope_rad`` (...) is that in the plane of load and chord, from across the load.
    """
    outward = cable_geometry(robot, poses, run.exit_points_m).outward
    down = -np.sin(slope_rad)[..., None]
    along = np.concatenate([np.cos(slope_rad)[..., None] * outward, down], axis=-1) @ robot.leaning
    return np.asarray(np.arctan2(-along[..., 2], (along[..., :2] * level.outward).sum(axis=-1)))


def leaving(
    axial_stiffness_N: float | FloatArray,
    weight_N_per_m: float | FloatArray,
    length_m: FloatArray,
    force_x_N: FloatArray,
    force_z_N: FloatArray,
) -> tuple[FloatArray, FloatArray]:
    """Return angle below the horizontal [rad] and strain of cables at their pulleys (...)."""
    downward = weight_N_per_m * length_m - force_z_N
    strain = np.hypot(force_x_N, downward) / axial_stiffness_N
    return np.arctan2(downward, force_x_N), strain


def over_pulleys(
    robot: Robot,
    poses: Poses,
    solve: Callable[[PulleyRun], tuple[Answer, FloatArray, FloatArray | float]],
    turns: int = MOST_ITERATIONS,
) -> tuple[Answer, PulleyRun, FloatArray]:
    """Solve until the tangent points on the pulleys rest; once, where there are none.

    The tangent point follows the slope of the sagging cable at its upper end, which moves by about
    radius over length of what the tangent point moved: a handful of turns reach rounding. Slack
    cables over a large pulley may swing between two ways to hang: each then goes by its secant.

    Parameters
    ----------
    robot, poses
        The robot and its poses (...).
    solve : callable
        Takes the run of the cables, and returns an answer with the angle at which each cable
        leaves, in its own plane and upright frame below the horizontal [rad], and its strain there.

    Returns
    -------
    answer, run
        Of the last turn.
    gap_rad : array (...)
        By how much the angle at which a cable leaves its pulley still changed.
    """
    if robot.pulley_radius_m == 0.0:
        run = PulleyRun(upright_exit_points_m(robot), np.zeros(1))
        return solve(run)[0], run, np.zeros(poses.shape)
    level = level_geometry(robot, poses)
    slope = straight = _straight_slope_rad(robot, level)
    slope_before = step_before = np.zeros_like(slope)
    strain: FloatArray | float = 0.0
    share, gap = np.ones(straight.shape), np.full(poses.shape, np.inf)
    for iteration in range(turns):
        run = run_at(robot, level, slope).unstrained(strain)
        answer, slope_over_pulley_rad, strain = solve(run)
        slope_over_pulley_rad = _slope_over_pulley_rad(
            robot, poses, level, run, slope_over_pulley_rad
        )
        step = np.where(np.isfinite(slope_over_pulley_rad), slope_over_pulley_rad, straight) - slope
        gap = np.fmax.reduce(np.abs(step), axis=-1, initial=0.0)
        if np.all(gap <= STILL_RAD):
            break
        if iteration >= PATIENCE:
            change = np.where(gap[..., None] > SETTLED_RAD, step_before - step, 0.0)
            secant = np.divide(slope - slope_before, change, out=share, where=change != 0.0)
            share = np.clip(secant, _LEAST_SHARE, 1.0)
        slope_before, step_before = slope, step
        slope = slope + share * step
    return answer, run, gap
