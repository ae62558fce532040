r"""Balances of measured poses, whatever the number of cables.

*Taut cables* pull as straight ones that come nearest to balance, with the smallest tensions where
there is a choice; lengths follow with sag and elasticity. Good for taut cables, and as a start.

*Fewer cables than degrees of freedom.* Such a platform hangs in balance in some poses only: the
others it passes as it sways, or they are in balance but for errors of the measurement. In any pose
each cable is an elastic catenary between its two ends, with one number free, its pull. As many
equations as cables ask that the platform be in balance in the directions in which pulls act on it;
what is left is its acceleration:

.. math::

    \min_p \; |F(p)|^2 + |M(p)|^2 / ρ^2

with F and M, about the centre of mass, what is left of force and moment, and the radius of gyration
ρ. This is Gauss's principle of least constraint (J. reine angew. Math. 4, 1829, p. 232): a free
body accelerates by F/m and M/(m ρ²), and pulls leave the least of it. The platform's inertia is not
known; for ρ the attachments' root mean square distance from the centre of mass is taken, which does
not matter where the pose is in balance. There nothing is left, and this is the exact equilibrium.

*More cables than degrees of freedom* hold a pose with many sets of tensions. Which of them a built
machine has, its winches decide; it shows in the tensions, and in the lengths through elasticity and
sag. Each pose gives up one reading for each cable to spare; the others test the model, whatever
rule the winches follow.
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
from designer.statics.geometry import (
    cable_geometry,
    centre_of_mass_arm_m,
    one_cable,
    upright_situation,
)
from designer.statics.inverse import Statics, statics_with
from designer.statics.pulleys import (
    SETTLED_RAD,
    PulleyRun,
    leaving,
    over_pulleys,
    straight_run,
)
from designer.statics.stiffness import per_reach

_MIN_SHARE, _MIN_SHARE_REDUNDANT = 1e-3, 0.05
"""Least tension over the platform's weight, where readings tell nothing."""
_MIN_PULL = 1.0 / 16.0
_REGULAR = 1e-4
_SPREAD = 1.0
_STILL = 1e-7
# What no winch would do: leave so much of the load, or a cable so long for its chord.
_LARGEST_LEFT, _LONGEST = 0.9, 8.0


def solve_taut(
    robot: Robot, poses: Poses, cable: Cable | Cables, force_N: FloatArray | None = None
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return unstrained lengths [m], upper tensions [N] and horizontal distances [m].

    Lengths and tensions are NaN where a cable would hang so slack that it is many times as long as
    its chord; no tension falls below a thousandth of the platform's weight.

    Parameters
    ----------
    robot, poses, cable
        The robot, its poses (n_poses,) and its cables.
    force_N : array (n_poses, 3), optional
        Force on the platform beside its weight, base frame [N].

    Returns
    -------
    three arrays (n_poses, n_cables)
    """
    from designer.kernel import taut as kernel

    run = straight_run(robot, poses)
    out = np.empty((len(poses.position_m), robot.n_cables, 3))
    kernel.solve_taut_poses(
        upright_situation(robot, poses, run.exit_points_m, force_N),
        one_cable(robot, cable, _MIN_SHARE * robot.weight_N),
        _REGULAR,
        out,
    )
    upper = out[..., kernel.EXIT_TENSION]
    wrap_m = run.unstrained(upper / cable.axial_stiffness_N).wrap_m
    return out[..., kernel.LENGTH] + wrap_m, upper, out[..., kernel.DISTANCE]


def solve_underactuated(
    robot: Robot, poses: Poses, cable: Cable | Cables, force_N: FloatArray | None = None
) -> Statics:
    """Return lengths and tensions of poses (n_poses,) with the least of balance left.

    Parameters
    ----------
    robot, poses, cable
        A robot with fewer cables than degrees of freedom, its poses (n_poses,), and its cables.
    force_N : array (n_poses, 3), optional
        Force on the platform beside its weight, base frame [N].

    Returns
    -------
    Statics
        ``not converged`` where no least is found; ``not found`` where nine tenths of the load are
        left, or a cable would hang eight times as long as its chord. No tension along a chord falls
        below a thousandth of the platform's weight. `imbalance` tells what is left.
    """
    from designer.kernel.underactuated import (
        LONGEST,
        STEP_LEFT,
        WRENCH_LEFT,
        solve_underactuated_poses,
    )

    n_poses = len(poses.position_m)
    out, diagnostics = np.empty((n_poses, robot.n_cables, 3)), np.empty((n_poses, 3))
    about_origin = upright_situation(robot, poses, robot.exit_points_m, force_N)
    arm = centre_of_mass_arm_m(robot, poses)
    pull_N, moment = about_origin.load[:, :3], about_origin.load[:, 3:]
    # What acts at the centre of mass has no moment about it.
    moment = moment - np.cross(arm, pull_N - robot.centre_pull_N)
    about_centre = about_origin._replace(
        attachments=plain(robot.attachments_m - robot.platform.centre_of_mass_m),
        load=plain(np.hstack([np.broadcast_to(pull_N, moment.shape), moment])),
        positions=plain(about_origin.positions + arm),
        load_point=plain(np.zeros(3)),
    )

    def solve(run: PulleyRun) -> tuple[FloatArray, FloatArray, FloatArray]:
        solve_underactuated_poses(
            about_centre._replace(
                exit_points=plain(run.exit_points_m.reshape(-1, robot.n_cables, 3))
            ),
            one_cable(robot, cable, _MIN_SHARE * robot.weight_N),
            plain(_scale(robot)),
            out,
            diagnostics,
        )
        solution = np.moveaxis(out, -1, 0)
        return solution, *leaving(cable.axial_stiffness_N, cable.weight_N_per_m, *solution)

    forces, run, gap_rad = over_pulleys(robot, poses, solve)
    load = np.linalg.norm(pull_N, axis=1)
    is_held = (diagnostics[:, WRENCH_LEFT] <= _LARGEST_LEFT * load) & (
        diagnostics[:, LONGEST] <= _LONGEST
    )
    verdict = np.where(is_held, Verdict.SOLVED, Verdict.NOT_FOUND).astype(np.int8)
    verdict[~((diagnostics[:, STEP_LEFT] <= _STILL) & (gap_rad <= SETTLED_RAD))] = (
        Verdict.NOT_CONVERGED
    )
    return statics_with(robot, poses, cable, run, verdict, forces, force_N)


def imbalance(statics: Statics) -> FloatArray:
    """Return what is left of force and moment over the platform's weight (...).

    The square root of the module's sum: the platform's acceleration over that of gravity. NaN where
    the pose is not solved.
    """
    robot = statics.robot
    wrench = np.zeros((*statics.verdict.shape, 6))
    wrench[..., robot.balance_rows] = statics.equilibrium_residual_N()
    force, moment = wrench[..., :3], wrench[..., 3:]
    moment = moment - np.cross(centre_of_mass_arm_m(robot, statics.poses), force)
    wrench[..., 3:] = moment
    norm = np.linalg.norm(wrench[..., robot.balance_rows] * _scale(robot), axis=-1)
    return np.asarray(norm / robot.weight_N)


def _scale(robot: Robot) -> FloatArray:
    """Return what makes forces of moments (dof,): 1/ρ."""
    apart = robot.attachments_m - robot.platform.centre_of_mass_m
    gyration = float(np.sqrt((apart**2).sum(axis=1).mean()))
    return np.where(robot.balance_rows < 3, 1.0, 1.0 / (gyration or 1.0))


@dataclass(frozen=True, eq=False)
class InternalBalance:
    """The balances of poses, of which their readings tell one."""

    robot: Robot  #: with more cables than degrees of freedom
    poses: Poses  #: (n_poses,)
    cable: Cable | Cables
    #: (n_poses, 3) force on the platform beside its weight, base frame [N]
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
                np.fmax(at_N / unit_N, _MIN_PULL)
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
            solution = np.moveaxis(out, -1, 0)
            return solution, *leaving(cable.axial_stiffness_N, cable.weight_N_per_m, *solution)

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
        return np.fmax(taut_N, max(_MIN_SHARE_REDUNDANT * robot.weight_N, robot.tension_min_N))

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
        pull_of_near = near.force_x_N / (near.weight_N_per_m * across_m)
    return np.where(np.isfinite(pull_of_near) & (pull_of_near > 0.0), pull_of_near, pull)
