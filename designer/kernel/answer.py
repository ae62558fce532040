"""What a pose ends as: a verdict from its true residuals, and forces in newtons."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from designer.arrays import BoolArray, FloatArray, VerdictArray
from designer.kernel.compiling import element
from designer.kernel.table import X2, L, P, V
from designer.model.verdict import Verdict

# Numba knows plain integers, not members of an enumeration.
SOLVED = int(Verdict.SOLVED)
NOT_FOUND = int(Verdict.NOT_FOUND)
NOT_CONVERGED = int(Verdict.NOT_CONVERGED)
OUTSIDE_HULL = int(Verdict.OUTSIDE_HULL)
RANK_DEFICIENT = int(Verdict.RANK_DEFICIENT)
NO_FINITE_CABLE = int(Verdict.NO_FINITE_CABLE)

TOLERANCE = 1e-10
"""Largest residual of closure (over length) plus balance (over the largest force)."""
AT_LIMIT = 1.0 + 1e-9
"""Tension over the allowable one up to which it counts as allowed: rounding of an optimum there."""

# Last axis of the answers of a cable, and of a pose.
LENGTH, FORCE_X, FORCE_Z = range(3)
WEIGHT, CLOSURE_ERROR, BALANCE_ERROR, LOAD_FACTOR, MASSLESS_TENSION = range(5)


class Answers(NamedTuple):
    """Answers to all poses, to be filled.

    Parameters
    ----------
    cables, poses : array (n_poses, n_cables, 3), (n_poses, 5)
        Last axes as above.
    verdict : array (n_poses,)
        One `Verdict` a pose.
    wrench : array (n_poses, degrees of freedom)
        Of a pose that one wrench proves to be impossible, that wrench, of unit length, moments over
        the reach of the attachments; else NaN.
    leaving : array (n_poses, n_cables)
        Of an open pose whose cables run over pulleys, the angles below the horizontal at which they
        leave where an equilibrium may be near [rad]; else NaN.
    is_best : array (n_poses,)
        Whether it is proved that no thinner taut cable holds the pose, to five parts in a million.
    """

    cables: FloatArray
    poses: FloatArray
    verdict: VerdictArray
    wrench: FloatArray
    leaving: FloatArray
    is_best: BoolArray


@element
def judge(residual: float, c: float, overload: float, sizing: bool) -> int:
    """Return whether a pose is solved; why not is for others to prove.

    When sizing, the state is the balance at the stress limit. It is a finite cable only if c is
    above zero (zero is the infinite section) and no slack cable breaks the limit. An infinite
    overload marks a cable too slack to be evaluated.
    """
    finite = (c > 0.0 and overload <= AT_LIMIT) if sizing else overload < np.inf
    return SOLVED if residual <= TOLERANCE and finite else NOT_CONVERGED


@element
def write_pose(
    out: Answers, at: int, verdict: int, c: float, closure: float, balance: float
) -> float:
    """Write verdict, weight and residuals of a pose; return its weight, NaN unless solved."""
    blank = 1.0 if verdict == SOLVED else np.nan
    w = blank / c
    out.verdict[at] = verdict
    out.poses[at, WEIGHT] = w
    out.poses[at, CLOSURE_ERROR] = closure * blank
    out.poses[at, BALANCE_ERROR] = balance * w
    return w


@element
def write_cable(out: Answers, at: int, i: int, table: FloatArray, j: int, w: float) -> None:
    """Write length and forces of a cable of this weight from a column of its table."""
    out.cables[at, i, LENGTH] = np.nan if np.isnan(w) else table[L, j]
    out.cables[at, i, FORCE_X] = table[P, j] * np.sqrt(table[X2, j]) * w
    out.cables[at, i, FORCE_Z] = -table[V, j] * w
