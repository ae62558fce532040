"""The poses that govern while the inputs vary, and what a rope meets there in each draw.

The worst pose may move from draw to draw. So all that are among the worst at the ends of the inputs
are kept, of every load case and direction; the region is then searched again for some of the draws,
and what is worse joins them.

A platform so many times as heavy on a rope is the same platform on a rope so many times as light,
as soft and as weak: a draw without moved exit points is another rope on the same robot, and all of
them are solved in one compiled pass.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from designer.analysis.uncertainty.draws import Draws
from designer.analysis.uncertainty.rows import utilisation_of_rows
from designer.arrays import FloatArray
from designer.model.cable import Cable
from designer.model.load_case import LoadCase, Loaded
from designer.model.robot import Poses
from designer.model.workspace import Workspace
from designer.progress import Advance
from designer.selection.cases import CaseResult
from designer.statics.sizes import add_slowly, is_quick, meet
from designer.workspace.demand import tension_demand
from designer.workspace.refine import LIGHT, Effort, refine

_CHUNK = 256
_NEAR = 0.99
"""Of the largest utilisation of a draw: from where on a pose may govern it."""
_STARTS, _STARTS_SETTLING = 24, 2
_MOST_ROUNDS = 3
_ELSEWHERE = 256
"""Samples that tell whether anything is served where all poses that were kept are left out."""
_WORSE = 1e-6
"""Relative: below what a search tells apart."""
_CHECKED, _CHECKED_SLOWLY = 6, 2
_GLANCE = Effort(
    per_edge=8, per_face=16, inside=64, starts=2, finalists=1, revisited=0, trials=6,
    from_landmarks=False, tolerance=1e-3,
)  # fmt: skip
"""How hard a robot is searched that is slow to solve."""


@dataclass(frozen=True, slots=True, eq=False)
class GoverningCandidates:
    """A load case in one direction, and poses (n_places, n_coordinates) in which it may govern."""

    loaded: Loaded
    workspace: Workspace
    places: FloatArray

    @property
    def is_one_pass(self) -> bool:
        """Whether all draws without moved exit points are solved in one compiled pass.

        Wind does not grow with the payload, nor does a force that an effect has put on the robot,
        and what is attached to cables does not vary with the rope: one weight stands for all.
        """
        loaded = self.loaded
        if not loaded.robot.has_equal_cables:
            return False
        still = loaded.wind is None and not loaded.bare[0].platform.centre_force_N.any()
        return still and not loaded.keeps_lengths and is_quick(loaded.robot)

    def elsewhere(self) -> GoverningCandidates:
        """Return the same at poses from all over the region."""
        space = self.workspace.space
        places = np.concatenate([space.landmarks(), self.workspace.thinned(_ELSEWHERE)])
        return replace(self, places=places)

    def utilisation(self, draws: Draws) -> FloatArray:
        """Return largest over allowable tension (n_draws, n_places).

        Infinite where a pose is not held, -inf where the study leaves it out.
        """
        if self.is_one_pass and not draws.moves:
            return self._as_ropes(draws)
        has_rows = self.is_one_pass and self.loaded.robot.has_one_branch
        if not has_rows or self.workspace.hangs_below == "exclude":
            return np.stack([self._solved(draws.on(self.loaded, k)) for k in range(len(draws))])
        used = utilisation_of_rows(self.loaded, self.places, draws, self._ropes(draws))
        for k in np.flatnonzero(np.isnan(used).any(axis=1)).tolist():
            used[k] = self._solved(draws.on(self.loaded, k))
        return used

    def _solved(self, loaded: Loaded) -> FloatArray:
        tension = tension_demand(loaded, self.workspace.hangs_below, self.places)
        return np.asarray(tension / loaded.cable.allowable_tension_N)

    def _ropes(self, draws: Draws) -> FloatArray:
        """Return mass per length, EA and allowable tension of each draw (n, 3).

        Ice stays, and what is attached along the rope.
        """
        loaded, bare = self.loaded, self.loaded.bare[1]
        added = (draws.linear_mass - 1.0) * bare.rope_density_kg_per_m
        return np.column_stack(
            [
                loaded.cable.linear_density_kg_per_m + added,
                draws.modulus * bare.axial_stiffness_N,
                draws.breaking_load * bare.allowable_tension_N,
            ]
        )

    def _as_ropes(self, draws: Draws) -> FloatArray:
        robot, figures = self.loaded.robot, self._ropes(draws) / draws.payload[:, None]
        order = np.argsort(figures[:, 0], kind="stable")
        ropes = [Cable(math.nan, *row) for row in figures[order].tolist()]
        poses, cells = Poses.at(self.places), np.arange(len(self.places))
        exclude = self.workspace.hangs_below == "exclude"
        meets = meet(robot, poses, ropes, cells, len(cells), leaves_out_hanging=exclude)
        rows, at = np.nonzero(meets.failed)
        if len(rows):
            add_slowly(meets, robot, poses, ropes, rows, at, cells, exclude)
        used = np.empty_like(meets.utilisation)
        used[order] = np.where(meets.failed, np.inf, meets.utilisation)
        return used


def largest(
    poses: Sequence[GoverningCandidates], draws: Draws, progress: Advance = lambda _: None
) -> FloatArray:
    """Return the largest utilisation of each draw (n,); infinite where a pose is not held.

    Also where all poses are left out, those beside the given ones too: then nothing is served.
    ``progress`` is called with the number of draws done.
    """
    utilisation = np.empty(len(draws))
    for start in range(0, len(draws), _CHUNK):
        rows = slice(start, start + _CHUNK)
        part = draws.part(rows)
        highest = np.maximum.reduce([pose.utilisation(part).max(axis=1) for pose in poses])
        # Where hanging cables leave a pose out, the worst is at the border of that, which moves.
        gone = np.flatnonzero(np.isneginf(highest)).tolist()
        if gone:
            elsewhere = [pose.elsewhere().utilisation(part.part(gone)) for pose in poses]
            highest[gone] = np.maximum.reduce([values.max(axis=1) for values in elsewhere])
        utilisation[rows] = highest
        progress(len(part))
    return np.where(np.isneginf(utilisation), np.inf, utilisation)


def may_govern(
    cases: Sequence[CaseResult], rope_in: Callable[[LoadCase], Cable], probes: Draws
) -> list[GoverningCandidates]:
    """Return the poses, of each load case and direction, that are among the worst in a probe.

    ``cases`` are what was found with the chosen rope, ``rope_in`` gives the rope to ask about.
    """
    every = [pose for case in cases for pose in _all_of(case, rope_in(case.case))]
    used = [pose.utilisation(probes) for pose in every]
    highest = np.maximum.reduce([values.max(axis=1) for values in used])[:, None]
    near_highest = [(values >= _NEAR * highest).any(axis=0) for values in used]
    return [
        replace(pose, places=pose.places[is_near])
        for pose, is_near in zip(every, near_highest, strict=True)
        if is_near.any()
    ]


def _all_of(case: CaseResult, rope: Cable) -> Iterator[GoverningCandidates]:
    """Yield a case in the direction that asked for most, at many poses; in the others at one."""
    robot, space = case.loaded.bare[0], case.workspace.space
    worst = case.verification.worst_place[None]
    settles = case.loaded.keeps_lengths
    starts = _STARTS_SETTLING if settles else _STARTS
    rest = [] if settles else [space.landmarks()]
    places = np.unique(np.concatenate([worst, case.sampled.worst_places[:starts], *rest]), axis=0)
    yield GoverningCandidates(case.loaded.on(robot, rope), case.workspace, places)
    for loaded in case.case.on(robot, rope):
        if loaded.words != case.loaded.words:
            yield GoverningCandidates(loaded, case.workspace, worst)


@dataclass(frozen=True, slots=True)
class Checked:
    """What a search over the region found beyond the poses that are kept.

    Parameters
    ----------
    draws : int
        How many were searched, in each round; 0 where none was.
    rounds : int
        How often; the poses found join the others after each.
    missed : float
        By how much the last round found more than the others, as utilisation.
    """

    draws: int = 0
    rounds: int = 0
    missed: float = 0.0


def searched(
    poses: list[GoverningCandidates], draws: Draws, used: FloatArray
) -> tuple[list[GoverningCandidates], FloatArray, Checked]:
    """Search the region in some draws: the least, the largest, the nearest to 100 %, some others.

    What is worse than the known poses joins them, for all draws. Load cases on kept lengths,
    which take long to follow, are left out of the search.
    """
    survey = Checked()
    for turn in range(1, _MOST_ROUNDS + 1):
        is_slow = not all(is_quick(pose.loaded.robot) for pose in poses)
        rows = _telling(used, _CHECKED_SLOWLY if is_slow else _CHECKED)
        new = [_worse(poses, draws.part([row]), float(used[row]), is_slow) for row in rows]
        exceeding = [(pose, more) for pose, more in filter(None, new)]
        missed = max((more for _, more in exceeding), default=0.0)
        survey = Checked(len(rows), turn, missed)
        if not exceeding:
            break
        poses = [*poses, *(pose for pose, _ in exceeding)]
        used = np.maximum(used, largest([pose for pose, _ in exceeding], draws))
    return poses, used, survey


def _telling(used: FloatArray, count: int) -> list[int]:
    """Return the draws that a search shall look at, the most telling first."""
    finite = np.flatnonzero(np.isfinite(used))
    if not len(finite):
        return []
    order = finite[np.argsort(used[finite], kind="stable")]
    nearest = finite[np.abs(used[finite] - 1.0).argmin()]
    rows = [nearest, order[-1], order[0], *order[[len(order) // 4, len(order) // 2]], finite[0]]
    return [int(row) for row in dict.fromkeys(rows)][:count]


def _worse(
    poses: Sequence[GoverningCandidates], draw: Draws, used: float, is_slow: bool
) -> tuple[GoverningCandidates, float] | None:
    """Return a pose that a draw uses more than the known ones, and by how much."""
    governing = max(poses, key=lambda pose: float(pose.utilisation(draw).max()))
    if governing.loaded.keeps_lengths:
        return None

    def demand(places: FloatArray) -> FloatArray:
        return np.asarray(replace(governing, places=places).utilisation(draw)[0])

    effort = _GLANCE if is_slow else LIGHT
    (worst,) = refine(governing.workspace.space, demand, governing.places, effort)
    if not worst.demand > used * (1.0 + _WORSE):
        return None
    return replace(governing, places=worst.place[None]), worst.demand - used
