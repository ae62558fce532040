r"""From pose to lengths and tensions, where cables are fewer than degrees of freedom.

Such a platform hangs in balance in some poses only: the others it passes as it sways, or they are
in balance but for errors of the measurement. In any pose each cable is an elastic catenary between
its two ends, with one number free, its pull. As many equations as cables ask that the platform be
in balance in the directions in which pulls act on it; what is left is its acceleration:

.. math::

    \min_p \; |F(p)|^2 + |M(p)|^2 / ρ^2

with F and M, about the centre of mass, what is left of force and moment, and the radius of gyration
ρ. This is Gauss's principle of least constraint (J. reine angew. Math. 4, 1829, p. 232): a free
body accelerates by F/m and M/(m ρ²), and pulls leave the least of it. The platform's inertia is not
known; for ρ the attachments' root mean square distance from the centre of mass is taken, which does
not matter where the pose is in balance. There nothing is left, and this is the exact equilibrium.
"""

from __future__ import annotations

import numpy as np

from designer.arrays import FloatArray
from designer.kernel.calling import plain
from designer.model.cable import Cable, Cables
from designer.model.robot import Poses, Robot
from designer.model.verdict import Verdict
from designer.statics.geometry import centre_of_mass_arm_m, one_cable, upright_situation
from designer.statics.inverse import Statics, statics_with
from designer.statics.pulleys import SETTLED_RAD, PulleyRun, leaving, over_pulleys

_SMALLEST_SHARE = 1e-3
_STILL = 1e-7
# What no winch would do: leave so much of the load, or a cable so long for its chord.
_LONGEST = 8.0


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
            one_cable(robot, cable, _SMALLEST_SHARE * robot.weight_N),
            plain(_scale(robot)),
            out,
            diagnostics,
        )
        found = np.moveaxis(out, -1, 0)
        return found, *leaving(cable.axial_stiffness_N, cable.weight_N_per_m, *found)

    forces, run, gap_rad = over_pulleys(robot, poses, solve)
    load = np.linalg.norm(pull_N, axis=1)
    is_held = (diagnostics[:, WRENCH_LEFT] <= 0.9 * load) & (diagnostics[:, LONGEST] <= _LONGEST)
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
