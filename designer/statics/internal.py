"""The internal forces that a pose's own readings tell, where cables outnumber degrees of freedom.

A redundant robot holds a pose with many sets of tensions. Which of them a built machine has, its
winches decide; it shows in the tensions, and in the lengths through elasticity and sag. Each pose
gives up one reading for each cable to spare; the others test the model, whatever rule the winches
follow.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from designer.arrays import FloatArray, require_shape
from designer.kernel.calling import CableFigures, Situation, plain
from designer.model.cable import Cable, Cables
from designer.model.robot import Poses, Robot
from designer.model.verdict import Verdict
from designer.statics.geometry import cable_geometry, one_cable, upright_situation
from designer.statics.inverse import Statics, statics_with
from designer.statics.pulleys import (
    SETTLED_RAD,
    PulleyRun,
    leaving,
    over_pulleys,
    straight_run,
)
from designer.statics.stiffness import per_reach
from designer.statics.taut import solve_taut

_LEAST_PULL = 1.0 / 16.0
_LEAST_SHARE = 0.05
_SPREAD = 1.0


@dataclass(frozen=True, eq=False)
class InternalBalance:
    """The balances of poses, of which their readings tell one.

    Parameters
    ----------
    robot, poses, cable
        A robot with more cables than degrees of freedom, its poses (n_poses,), and its cables.
    force_N : array (n_poses, 3), optional
        Force on the platform beside its weight, base frame [N].
    """

    robot: Robot
    poses: Poses
    cable: Cable | Cables
    force_N: FloatArray | None = None

    def nearest(
        self,
        length_m: FloatArray,
        tension_N: FloatArray,
        noise: tuple[float, float],
        near: Statics | None = None,
    ) -> Statics:
        """Return the balance that comes nearest to what was read.

        Nearest is meant as in `designer.kernel.internal`: robust least squares in units of noise.
        What the readings leave open is settled by a weak hold near the smallest tensions that hold
        the pose, none below 5 % of the platform's weight nor `Robot.tension_min_N`, as if these
        were known to within a factor of e.

        Parameters
        ----------
        length_m, tension_N : array (n_poses, n_cables)
            Unstrained lengths from the exit points, around pulleys where there are any [m], and
            tensions at the exit points [N]; NaN where nothing was read.
        noise : (float, float)
            Standard deviation of a length [m] and of a tension [N].
        near : Statics, optional
            A balance of these rows with nearly the same machine and readings, to start from.

        Returns
        -------
        Statics
            ``not converged`` where the balance does not close to 1e-9 of the largest tension.
        """
        from designer.kernel.internal import solve_internal_poses

        robot, poses, cable = self.robot, self.poses, self.cable
        require_shape("length_m", length_m, len(poses.position_m), robot.n_cables)
        require_shape("tension_N", tension_N, len(poses.position_m), robot.n_cables)
        out, rest = np.empty((*self._least_N.shape, 3)), np.empty(len(self._least_N))

        def solve(run: PulleyRun) -> tuple[FloatArray, FloatArray, FloatArray]:
            situation, unit_N = self._over(run) if robot.pulley_radius_m else self._from_exit_points
            pull, read_pull = (
                np.fmax(at_N / unit_N, _LEAST_PULL)
                for at_N in (self._least_N, np.fmax(tension_N, self._least_N))
            )
            solve_internal_poses(
                situation,
                self._figures,
                plain(np.stack([length_m - run.wrap_m, tension_N], axis=-1)),
                plain(noise),
                # From small pulls, which tensions hardly pull at in a logarithm, none finds the way
                # up.
                plain(read_pull if near is None else _pull_near(near, read_pull)),
                plain(pull),
                _SPREAD,
                self._scale,
                out,
                rest,
            )
            found = np.moveaxis(out, -1, 0)
            return found, *leaving(cable.axial_stiffness_N, cable.weight_N_per_m, *found)

        forces, run, gap_rad = over_pulleys(robot, poses, solve)
        closes = (rest <= 1e-9) & (gap_rad <= SETTLED_RAD)
        if near is not None and np.any(near.is_solved & ~closes):
            return self.nearest(length_m, tension_N, noise)
        verdict = np.where(closes, Verdict.SOLVED, Verdict.NOT_CONVERGED).astype(np.int8)
        return statics_with(robot, poses, cable, run, verdict, forces, self.force_N)

    @cached_property
    def _least_N(self) -> FloatArray:
        robot = self.robot
        _, taut_N, _ = solve_taut(robot, self.poses, self.cable, self.force_N)
        return np.fmax(taut_N, max(_LEAST_SHARE * robot.weight_N, robot.tension_min_N))

    @cached_property
    def _figures(self) -> CableFigures:
        return one_cable(self.robot, self.cable)

    @cached_property
    def _scale(self) -> FloatArray:
        return plain(per_reach(self.robot))

    def _over(self, run: PulleyRun) -> tuple[Situation, FloatArray]:
        """Return what the kernel is told, and the tension of unit pull (n_poses, n_cables) [N]."""
        chord_m = cable_geometry(self.robot, self.poses, run.exit_points_m).chord_m
        situation = upright_situation(self.robot, self.poses, run.exit_points_m, self.force_N)
        return situation, self.cable.weight_N_per_m * chord_m

    @cached_property
    def _from_exit_points(self) -> tuple[Situation, FloatArray]:
        return self._over(straight_run(self.robot, self.poses))


def _pull_near(near: Statics, pull: FloatArray) -> FloatArray:
    """Return the pulls of a balance (n_poses, n_cables); those given where it has none."""
    across_m = near.geometry().horizontal_distance_m
    with np.errstate(divide="ignore", invalid="ignore"):
        own = near.force_x_N / (near.weight_N_per_m * across_m)
    return np.where(np.isfinite(own) & (own > 0.0), own, pull)
