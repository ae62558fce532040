"""Runs the compiled solvers over a batch of poses, on all processors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from designer.arrays import BoolArray, FloatArray, VerdictArray, require_shape
from designer.kernel import answer
from designer.kernel.calling import CableFigures, Situation, plain, share_out
from designer.kernel.cone import refuse_range
from designer.kernel.least_pull import least_pulls
from designer.kernel.redundant import solve_massless_range, solve_redundant_range
from designer.kernel.square import refuse_points_range, solve_range
from designer.kernel.table import LANES
from designer.model.robot import Robot

_SHARE = 128 * LANES
"""Poses that one thread takes at a time."""
_SLOW_SHARE = 32
"""The same where a pose takes a hundred times as long."""


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """What the kernel found, pose by pose; NaN wherever the verdict is not solved.

    Parameters
    ----------
    verdict : array (n_poses,)
        One `Verdict` a pose.
    weight_N_per_m : array (n_poses,)
        The common w of the weights per length, as given or, when sizing, the least that the
        strength allows [N/m].
    length_m, force_x_N, force_z_N : array (n_poses, n_cables)
        Unstrained lengths [m], and forces on the cables at the platform [N].
    closure_residual_m, equilibrium_residual_N : array (n_poses,)
        Worst closure error [m]; what is left of the platform's balance, moments divided by the
        reach of its attachments [N].
    load_factor : array (n_poses,)
        Largest tension over strength; NaN only where no state was found.
    massless_tension_N : array (n_poses,)
        Largest tension of straight, weightless cables [N]; NaN outside their hull.
    wrench : array (n_poses, degrees of freedom)
        Of a pose that one wrench proves to be impossible, that wrench, of unit length, moments over
        the reach of the attachments; else NaN.
    leaving_rad : array (n_poses, n_cables)
        Of an open pose whose cables run over pulleys, the angles below the horizontal at which they
        leave where an equilibrium may be near [rad]; else NaN.
    is_best : array (n_poses,)
        Whether it is proved that no thinner taut cable holds the pose.
    """

    verdict: VerdictArray
    weight_N_per_m: FloatArray
    length_m: FloatArray
    force_x_N: FloatArray
    force_z_N: FloatArray
    closure_residual_m: FloatArray
    equilibrium_residual_N: FloatArray
    load_factor: FloatArray
    massless_tension_N: FloatArray
    wrench: FloatArray
    leaving_rad: FloatArray
    is_best: BoolArray


def solve_batch(
    robot: Robot,
    situation: Situation,
    kappa_per_m: FloatArray,
    relative_weights: FloatArray,
    strength_m: FloatArray,
    inverse_weight_m_per_N: float | FloatArray | None,
    *,
    sag_max: float,
    pulleys_m: FloatArray | None = None,
    near: FloatArray | None = None,
    proves_best: bool = False,
    decides: bool = False,
) -> Solution:
    """Solve the statics of poses (n_poses,), or size the cables if no weight is given.

    Parameters
    ----------
    robot, situation
        With at least as many cables as degrees of freedom, and its poses.
    kappa_per_m, relative_weights, strength_m : array (n_cables,) or (n_poses, n_cables)
        Weight over axial stiffness [1/m], weight relative to w, allowable tension over weight [m].
    inverse_weight_m_per_N : float, array (n_poses,) or None
        1 / w, zero for the infinite section; None sizes each pose for the lightest cable that the
        strength allows.
    sag_max : float
        Largest sag over chord. A robot that leaves no choice may exceed it, but what is proved of
        its poses without an answer is that no cables within it hold them.
    pulleys_m : array (n_cables, 3), optional
        Exit points above the edges of the pulleys, in the frame of the situation [m].
    near : array (n_poses, n_cables + 1), optional
        Pulls of an equilibrium that is near, and its 1 / w [1, m/N]; NaN where none is known.
    proves_best : bool
        Whether to prove of a robot with cables to spare that no thinner taut cable holds a pose.
    decides : bool
        Whether poses of a robot that leaves no choice are ones that Newton has left open.

    Raises
    ------
    ValueError
        If the robot has fewer cables than degrees of freedom, or the arrays differ in length.
    """
    n, count = robot.n_cables, len(situation.positions)
    if n < robot.degrees_of_freedom:
        raise ValueError(f"{n} cables cannot hold {robot.degrees_of_freedom} degrees of freedom")
    for name, values in (
        ("kappa_per_m", kappa_per_m),
        ("relative_weights", relative_weights),
        ("strength_m", strength_m),
    ):
        require_shape(name, values, *([count] if values.ndim == 2 else []), n)
    inverse_weight = np.array(-1.0 if inverse_weight_m_per_N is None else inverse_weight_m_per_N)
    least_N = robot.tension_min_N if robot.is_redundant else 0.0
    rows = map(np.atleast_2d, (kappa_per_m, relative_weights, strength_m))
    kappa, weights, strength = map(plain, np.broadcast_arrays(*rows))
    figures = CableFigures(kappa, weights, strength, least_N, least_pulls(sag_max))
    if pulleys_m is not None:
        pulleys, vertical = plain(pulleys_m), plain(robot.leaning[:, 2])
        figures = figures._replace(
            pulleys=pulleys, pulley_radius=robot.pulley_radius_m, vertical=vertical
        )
    out = answer.Answers(
        np.empty((count, n, 3)),
        np.empty((count, 5)),
        np.empty(count, dtype=np.int8),
        np.full((count, robot.degrees_of_freedom), np.nan),
        np.full((count, n), np.nan),
        np.zeros(count, dtype=np.bool_),
    )
    asked = situation, figures, plain(inverse_weight.reshape(-1)), out
    if robot.is_redundant or decides:
        *given, out = asked
        known = plain(np.empty((0, n + 1)) if near is None else near)
        share_out(solve_redundant_range, count, _SLOW_SHARE, *given, known, proves_best, out)
    else:
        share_out(solve_range, count, _SHARE, *asked)
        if robot.has_one_branch and inverse_weight_m_per_N is None:
            share_out(refuse_points_range, count, _SHARE, situation, figures, out)
    if np.any(relative_weights != 1.0):  # the kernel's forces are those of cables of weight w
        out.cables[..., [answer.FORCE_X, answer.FORCE_Z]] *= relative_weights[..., None]
    return Solution(
        verdict=out.verdict,
        weight_N_per_m=out.poses[:, answer.WEIGHT],
        length_m=out.cables[..., answer.LENGTH],
        force_x_N=out.cables[..., answer.FORCE_X],
        force_z_N=out.cables[..., answer.FORCE_Z],
        closure_residual_m=out.poses[:, answer.CLOSURE_ERROR],
        equilibrium_residual_N=out.poses[:, answer.BALANCE_ERROR],
        load_factor=out.poses[:, answer.LOAD_FACTOR],
        massless_tension_N=out.poses[:, answer.MASSLESS_TENSION],
        wrench=out.wrench,
        leaving_rad=out.leaving,
        is_best=out.is_best,
    )


def solve_massless_batch(
    robot: Robot, situation: Situation
) -> tuple[FloatArray, FloatArray, VerdictArray]:
    """Return tensions of straight cables with the smallest largest one, in poses (n_poses,).

    Of a robot with more cables than degrees of freedom.

    Returns
    -------
    tension_N : array (n_poses, n_cables)
        NaN where no tensions hold the pose.
    wrench : array (n_poses, degrees of freedom)
        The dual of the load, of any length: where no tensions hold the pose it separates the load
        from all that they can do.
    verdict : array (n_poses,)
        One `Verdict` a pose.
    """
    count = len(situation.positions)
    tension = np.empty((count, robot.n_cables))
    wrench = np.empty((count, robot.degrees_of_freedom))
    verdict = np.empty(count, dtype=np.int8)
    figures = _straight(robot.n_cables, robot.tension_min_N)
    share_out(solve_massless_range, count, _SHARE, situation, figures, tension, wrench, verdict)
    return tension, wrench, verdict


def refuse_batch(
    situation: Situation, least_tension_N: float
) -> tuple[VerdictArray, FloatArray, FloatArray]:
    """Return what is proved of poses (n_poses,) that no cables were found for; see `cone`.

    Cables shall nowhere have less than the ``least_tension_N``.

    Returns
    -------
    verdict : array (n_poses,)
        Outside the hull or rank deficient if that is proved; not found if straight cables are
        proved not to hold the pose; else not converged.
    wrench : array (n_poses, degrees of freedom)
        Of a pose outside the hull, what separates the load from all that cables can do: of unit
        length, moments over the reach of the attachments.
    separation : array (n_poses,)
        Its product with the load of unit length.
    """
    count = len(situation.positions)
    wrench = np.empty((count, len(situation.rows)))
    separation = np.empty(count)
    verdict = np.empty(count, dtype=np.int8)
    figures = _straight(len(situation.attachments), least_tension_N)
    share_out(refuse_range, count, _SHARE, situation, figures, wrench, separation, verdict)
    return verdict, wrench, separation


def _straight(n_cables: int, least_tension_N: float) -> CableFigures:
    """Return straight cables, of which strength and weight say nothing."""
    ones = plain(np.ones((1, n_cables)))
    return CableFigures(ones, ones, ones, least_tension_N)
