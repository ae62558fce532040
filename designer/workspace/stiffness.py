"""How far a force moves the platform, over the whole workspace."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import partial

import numpy as np

from designer.arrays import FloatArray
from designer.model.cable import Cable, Cables
from designer.model.robot import Poses, Robot
from designer.model.space import named_position
from designer.model.workspace import Workspace
from designer.statics.inverse import solve_sagging
from designer.statics.modes import NEAR, frequencies_Hz, knows_inertia
from designer.statics.stiffness import largest_displacement_m_per_N
from designer.workspace.demand import is_counted
from designer.workspace.effort import CANDIDATE_STIFFNESS, STIFFNESS
from designer.workspace.refine import LIGHT, ONE_CLIMB, refine


@dataclass(frozen=True, slots=True, eq=False)
class StiffnessSurvey:
    """Displacement under a unit force over a workspace, cables of fixed length."""

    #: poses that were looked at before the search between them, solved and not left out
    samples: int
    unstable: int  #: those of them in which the platform would not stay
    #: largest displacement under a unit force in its worst direction [m/N]; inf where the platform
    #: would not stay somewhere
    softest_m_per_N: float = field(metadata={"json": "largest_displacement_m_per_N"})
    stiffest_m_per_N: float = field(metadata={"json": None})  #: smallest of the samples [m/N]
    #: (n_coordinates,) where [m, rad], as the next
    softest_place: FloatArray = field(metadata={"json": named_position})
    stiffest_place: FloatArray = field(metadata={"json": None})
    #: least natural frequency at which the platform takes part, see `designer.statics.modes`; None
    #: where its inertia is not known [Hz]
    lowest_frequency_Hz: float | None = None
    #: (n_coordinates,) where [m, rad]
    lowest_frequency_place: FloatArray | None = field(
        default=None,
        metadata={"json": lambda at: {"lowest_frequency_pose": None if at is None else at[:3]}},
    )


def survey_stiffness(
    robot: Robot, workspace: Workspace, cable: Cable | Cables
) -> StiffnessSurvey | None:
    """Return the softest and the stiffest pose; None if no pose is held stably.

    The search starts from `STIFFNESS` of the workspace's samples.
    """
    displacement = partial(displacement_demand, robot, workspace, cable)
    thinned = workspace.thinned(STIFFNESS)
    demand = displacement(thinned)
    if not np.isfinite(demand).any():
        return None
    (softest,) = refine(workspace.space, displacement, thinned)
    stiffest = int(np.where(np.isfinite(demand), demand, np.inf).argmin())
    slowest = []
    if knows_inertia(robot, robot.platform):  # each by itself, since a frequency takes longer
        # With cables that follow as if at rest, which is quick; then from the 64 lowest of these.
        following = partial(_slowness, robot, workspace, cable, 0.0)
        (rough,) = refine(workspace.space, following, thinned)
        lowest = thinned[np.argsort(-following(thinned))[:64]]
        starts = np.concatenate([rough.place[None], lowest])
        slowness = partial(_slowness, robot, workspace, cable, NEAR)
        slowest = refine(workspace.space, slowness, starts, ONE_CLIMB)
    return StiffnessSurvey(
        samples=int((~np.isneginf(demand)).sum()),
        unstable=int(np.isposinf(demand).sum()),
        softest_m_per_N=softest.demand,
        stiffest_m_per_N=float(demand[stiffest]),
        softest_place=softest.place,
        stiffest_place=thinned[stiffest],
        lowest_frequency_Hz=-slowest[0].demand if slowest else None,
        lowest_frequency_place=slowest[0].place if slowest else None,
    )


def smallest_stiffness_N_per_m(
    robot: Robot, workspace: Workspace, cable: Cable, *, searched: bool
) -> float:
    """Return the smallest translational stiffness over the workspace [N/m].

    The smallest force over displacement in any direction, the platform free to turn, at fixed
    unstrained lengths, with sag; zero where the equilibrium is not stable, NaN where no pose
    counts. Searched between the samples as well, or taken from `CANDIDATE_STIFFNESS` of them. See
    `designer.statics.stiffness`.
    """
    thinned = workspace.thinned(CANDIDATE_STIFFNESS)
    displacement = partial(displacement_demand, robot, workspace, cable)
    if searched:
        (worst,) = refine(workspace.space, displacement, thinned, LIGHT)
        softest = worst.demand
    else:
        softest = float(displacement(thinned).max(initial=-np.inf))
    return float("nan") if np.isneginf(softest) else 1.0 / softest


def displacement_demand(
    robot: Robot, workspace: Workspace, cable: Cable | Cables, places: FloatArray
) -> FloatArray:
    """Displacement under a unit force (n,) [m/N].

    Inf where the platform would not stay, -inf where the pose does not count.
    """
    statics = solve_sagging(robot, Poses.at(places), cable)
    counts = is_counted(statics, workspace.hangs_below)
    displacement = np.nan_to_num(largest_displacement_m_per_N(statics), nan=np.inf)
    return np.where(counts, displacement, -np.inf)


def _slowness(
    robot: Robot,
    workspace: Workspace,
    cable: Cable | Cables,
    near: float,
    places: FloatArray,
) -> FloatArray:
    """Return the lowest of `frequencies_Hz`, negated; -inf where a pose does not count."""
    statics = solve_sagging(robot, Poses.at(places), cable)
    counts = is_counted(statics, workspace.hangs_below)
    density = cable.linear_density_kg_per_m
    lowest_Hz = frequencies_Hz(statics, robot.platform, density, near=near)
    return np.where(counts, -lowest_Hz, -np.inf)
