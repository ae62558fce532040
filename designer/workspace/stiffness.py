"""How far a force moves the platform, over the whole workspace."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from designer.arrays import FloatArray
from designer.cable import Cable, Cables
from designer.robot import Poses, Robot
from designer.statics.inverse import solve_sagging
from designer.statics.stiffness import largest_displacement_m_per_N
from designer.study import Workspace
from designer.workspace.demand import is_left_out
from designer.workspace.samples import places

MOST_SAMPLES = 4000
"""Poses that are looked at."""


@dataclass(frozen=True, slots=True, eq=False)
class StiffnessSurvey:
    """Displacement under a unit force over the samples of a workspace, cables of fixed length.

    Parameters
    ----------
    samples : int
        Poses that were looked at, solved and not left out.
    unstable : int
        Those of them in which the platform would not stay.
    softest_m_per_N, stiffest_m_per_N : float
        Largest and smallest displacement under a unit force in its worst direction [m/N].
    softest_position_m, stiffest_position_m : array (3,)
        Where [m].
    """

    samples: int
    unstable: int
    softest_m_per_N: float
    stiffest_m_per_N: float
    softest_position_m: FloatArray
    stiffest_position_m: FloatArray


def survey_stiffness(
    robot: Robot, workspace: Workspace, cable: Cable | Cables
) -> StiffnessSurvey | None:
    """Return the softest and the stiffest of the samples; None if no pose is held stably.

    Parameters
    ----------
    robot, workspace, cable
        What to look at; at most `MOST_SAMPLES` of the workspace's samples are.
    """
    positions = next(places(workspace))
    positions = positions[:: -(-len(positions) // MOST_SAMPLES)]
    statics = solve_sagging(robot, Poses.at(positions), cable)
    counts = statics.is_solved & ~is_left_out(statics, workspace.hangs_below)
    displacement = np.where(counts, largest_displacement_m_per_N(statics), np.nan)
    stable = np.isfinite(displacement)
    if not stable.any():
        return None
    softest, stiffest = int(np.nanargmax(displacement)), int(np.nanargmin(displacement))
    return StiffnessSurvey(
        samples=int(counts.sum()),
        unstable=int((counts & ~stable).sum()),
        softest_m_per_N=float(displacement[softest]),
        stiffest_m_per_N=float(displacement[stiffest]),
        softest_position_m=positions[softest],
        stiffest_position_m=positions[stiffest],
    )
