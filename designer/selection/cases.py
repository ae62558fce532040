"""What candidates meet in the load cases of a study, over the samples and between them.

Each case has directions of wind and inertia and lost cables (`designer.model.load_case.Loaded`);
each of these is solved over all samples, for all candidates that hold so far; of robots that are
slow to solve over some of them at first, and over all where a candidate is searched. A lost cable,
or warmth on braked winches, sets the platform moving, which takes long to follow: that is done for
fewer samples. Between the
samples it is searched in the direction in which a case asks for most, and in those near it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from designer.arrays import IntArray
from designer.model.cable import Cable
from designer.model.load_case import LoadCase, Loaded
from designer.model.robot import Poses, Robot
from designer.progress import Advance
from designer.selection.samples import over_kept_lengths, over_samples, sampled_at_tension
from designer.selection.stiffening import StiffnessSearch
from designer.selection.verify import Sampled, Verification, refined
from designer.statics.cable_loss import CableLoss
from designer.statics.inverse import Statics, solve_sagging
from designer.statics.sizes import is_quick
from designer.study import HangsBelow, Workspace
from designer.workspace.demand import rope_demand, settled, settled_demand
from designer.workspace.refine import LIGHT, refine_over_branches

_MOST_SAMPLES = 256
"""Poses in which lengths are kept, for the chosen one."""
FEW_AT_FIRST = 300
"""Samples that candidates are tried at first where all of them take long."""
_NEAR = 0.95
"""Of the utilisation that governs: from where on other cases and directions are searched, too."""
_MOST_ROUNDS = 6
_SAME = 1e-9


@dataclass(frozen=True, eq=False)
class CaseFound:
    """What a cable meets in one load case, or in one direction of it.

    Parameters
    ----------
    workspace : Workspace
        With the region of the case.
    loaded : Loaded
        Robot and cable in the direction, or without the cable, in which it is used most.
    sampled : Sampled
        What it meets there over the samples.
    verification : Verification
        The same, also between the samples where ``is_refined``.
    is_full : bool
        Whether that search was the full one.
    is_whole : bool
        Whether all samples were solved, or, where lengths are kept, all that ever are.
    """

    workspace: Workspace
    loaded: Loaded
    sampled: Sampled
    verification: Verification
    is_full: bool = False
    is_whole: bool = True

    def whole(self) -> CaseFound:
        """Return what is met over all samples."""
        if self.is_whole or not self.verification.holds:
            return self
        ((one, sampled),) = sampled_at_tension([self.loaded], self.workspace)
        return CaseFound(self.workspace, one, sampled, sampled.verification(one.cable))

    @property
    def case(self) -> LoadCase:
        """The case."""
        return self.loaded.case

    @property
    def utilisation(self) -> float:
        """Largest over allowable tension."""
        return self.verification.utilisation

    @property
    def pose(self) -> Poses:
        """Where (1,)."""
        return Poses.at(self.verification.worst_place[None])

    def tension_N(self, other: Loaded, hangs_below: HangsBelow = "include") -> float:
        """Return the largest tension at that pose with another robot or cable [N].

        Minus infinity where the pose is left out for a cable that hangs below the platform.
        """
        place = self.verification.worst_place[None]
        if other.keeps_lengths:
            return float(settled_demand(other, hangs_below)(place)[0])
        return float(rope_demand(other.robot, other.cable, hangs_below)(place)[0, 0])

    @cached_property
    def loss(self) -> CableLoss | None:
        """What becomes of that pose; None where no lengths are kept."""
        return settled(self.loaded, self.pose) if self.loaded.keeps_lengths else None

    @cached_property
    def statics(self) -> Statics | None:
        """The equilibrium there (1,), at rest on kept lengths; None where there is none."""
        if not np.isfinite(self.utilisation):
            return None
        loss = self.loss
        if loss is not None:
            return loss.statics
        return solve_sagging(self.loaded.robot, self.pose, self.loaded.cable)

    @property
    def cables(self) -> IntArray:
        """Numbers of the cables that are left, from 1."""
        every = np.arange(1, self.loaded.robot.n_cables + 1)
        return np.asarray(every[every != self.loaded.lost_cable])

    @cached_property
    def most_used(self) -> int | None:
        """The cable that is used most there, from 1; None where nothing holds the pose."""
        statics = self.statics
        if statics is None or not statics.is_solved[0]:
            return None
        return int(self.cables[statics.cable_tension_N[0].argmax()])


@dataclass(frozen=True, slots=True, eq=False)
class Cases:
    """The load cases of a study, ready to be tried on cables.

    ``few`` is how many samples are solved at first, where not all of them; see `hurried`.
    """

    robot: Robot
    workspace: Workspace
    each: tuple[LoadCase, ...]
    few: int | None = None

    def hurried(self) -> Cases:
        """Return the same, with few samples at first where all would take hours.

        That is on robots that are slow to solve, where there is more than the static case: all
        samples are left for candidates that are searched, see `CaseFound.whole`.
        """
        is_long = len(self.each) > 1 and not is_quick(self.robot)
        return replace(self, few=FEW_AT_FIRST) if is_long else self

    @property
    def sample_count(self) -> int:
        """How many samples are solved in each direction, for a progress bar (an estimate)."""
        count = self.workspace.sample_count
        return count if self.few is None else min(self.few, count)

    def passes(self, cables: Sequence[Sequence[Cable]]) -> int:
        """Return how often all samples are solved at most, for a progress bar."""
        if not cables or not cables[0]:
            return 1
        return sum(
            len(list(c.on(self.robot, a[0]))) for c, a in zip(self.each, cables, strict=True)
        )

    def sampled(
        self, cables: Sequence[Sequence[Cable]], progress: Advance
    ) -> list[tuple[CaseFound, ...]]:
        """Solve every sample with every candidate in every direction of every case.

        Parameters
        ----------
        cables : sequence of sequences of Cable
            For each case the candidates, with what they may be used to in it.
        progress : callable
            Called with the number of samples done.

        Returns
        -------
        list of tuple of CaseFound
            For each candidate, each direction of each case; up to the first that settles that it
            does not hold.
        """
        found: list[list[CaseFound]] = [[] for _ in cables[0]]
        for case, those in zip(self.each, cables, strict=True):
            turns = zip(*(case.on(self.robot, cable) for cable in those), strict=True)
            for loaded in turns:
                holds = [all(one.verification.holds for one in before) for before in found]
                alive = [k for k in range(len(found)) if holds[k]]
                tried = self._try(case, [loaded[k] for k in alive], progress)
                for k, one in zip(alive, tried, strict=True):
                    found[k].append(one)
        return [tuple(each) for each in found]

    def _try(
        self, case: LoadCase, loaded: Sequence[Loaded], progress: Advance
    ) -> Iterator[CaseFound]:
        workspace = whole = self.workspace.of_case(case)
        keeps = any(one.keeps_lengths for one in loaded)
        if self.few is not None and not keeps:
            workspace = replace(workspace, samples=min(self.few, workspace.samples))
        shares = bool(loaded) and not case.changes_robot and not keeps
        each = sampled_at_tension(loaded, workspace, progress)
        if not shares:
            progress(self.sample_count)
        is_whole = workspace.samples == whole.samples
        for one, sampled in each:
            known = sampled.verification(one.cable)
            yield CaseFound(whole, one, sampled, known, is_whole=is_whole)


def resettled(found: CaseFound) -> CaseFound:
    """Return a case, after another worst pose, with the stiffness at the tension there."""

    def search(one: CaseFound) -> CaseFound:
        return one if one.verification.is_refined else _search_once(one, is_light=False)

    return _at_its_tension(found, search)


def as_stiff_as(cable: Cable, found: CaseFound) -> Cable:
    """Return a cable with the stiffness that it has in a load case."""
    if cable.stiffening is None:
        return cable
    return replace(cable, axial_stiffness_N=found.loaded.cable.axial_stiffness_N)


def _at_its_tension(found: CaseFound, search: Callable[[CaseFound], CaseFound]) -> CaseFound:
    """Search until the cable has the stiffness that it has at the largest tension found.

    With another stiffness all samples are solved again, and the search starts from the worst pose
    found before as well.
    """
    stiffness, found = StiffnessSearch(), search(found)
    while True:
        met = found.verification
        other = stiffness.next_of(found.loaded, met.max_tension_N)
        if other is None:
            return found
        (again,) = over_samples([other], found.workspace)
        places = np.concatenate([met.worst_place[None], again.worst_places])
        known = again.verification(other.cable)
        again = replace(again, worst_places=places)
        found = search(CaseFound(found.workspace, other, again, known))


def governing(found: Sequence[CaseFound]) -> CaseFound:
    """Return the case, and direction, that asks for most; the first of equal ones."""
    return max(found, key=lambda one: one.utilisation)


def worst_of_each(found: Sequence[CaseFound]) -> tuple[CaseFound, ...]:
    """Return of each case the direction that asks for most, in the order of the study."""
    cases = {id(one.case): one.case for one in found}
    return tuple(governing([o for o in found if o.case is case]) for case in cases.values())


def together(found: Sequence[CaseFound]) -> Verification:
    """Return what governs, with the longest and shortest lengths of all cases."""
    most = governing(found).verification
    longest = np.maximum.reduce([one.verification.longest_m for one in found])
    shortest = np.fmin.reduce([one.verification.shortest_m for one in found])
    return replace(most, longest_m=longest, shortest_m=shortest)


def searched(found: Sequence[CaseFound]) -> tuple[CaseFound, ...]:
    """Search between the samples: what governs in full, other cases near it lightly."""
    found = _with(found, {id(o): o.whole() for o in _near(worst_of_each(found))})
    most = governing(found)
    near = _near(worst_of_each(found))
    return _with(found, {id(o): _search(o, is_light=o is not most) for o in near})


def _near(found: Sequence[CaseFound]) -> list[CaseFound]:
    """Those that ask for most, or nearly."""
    most = governing(found)
    return [one for one in found if one.utilisation > _NEAR * most.utilisation]


def searched_all(found: Sequence[CaseFound]) -> tuple[CaseFound, ...]:
    """Search between the samples in every case: its worst direction in full, those near it lightly.

    Wind from all directions and inertia forces are then turned and the pose searched again by
    turns until neither gains. What is found is the largest that these searches met, from the worst
    of the first directions on; that there is none larger is not proved.
    """
    found = tuple(one.whole() for one in found)
    done: dict[int, CaseFound] = {}
    for most in worst_of_each(found):
        near = _near([o for o in found if o.case is most.case])
        done |= {id(o): _search(o, is_light=o is not most) for o in near}
    return tuple(_turned(one) for one in _with(found, done))


def _with(found: Sequence[CaseFound], done: dict[int, CaseFound]) -> tuple[CaseFound, ...]:
    return tuple(done.get(id(one), one) for one in found)


def _search(found: CaseFound, *, is_light: bool) -> CaseFound:
    return _at_its_tension(found, partial(_search_once, is_light=is_light))


def _search_once(found: CaseFound, *, is_light: bool) -> CaseFound:
    one, workspace = found.loaded, found.workspace
    if not np.isfinite(found.utilisation) or found.is_full:
        return found
    if not one.keeps_lengths:
        effort = LIGHT if is_light else None
        met = refined(one.robot, workspace, one.cable, found.sampled, effort)
        return replace(found, verification=met, is_full=not is_light)
    if is_light:
        return found
    more = over_kept_lengths(one, workspace, _MOST_SAMPLES)
    demand_with = partial(settled_demand, one, workspace.hangs_below)
    starts = np.concatenate([found.sampled.worst_places, more.worst_places])
    (worst,) = refine_over_branches(workspace.space, demand_with, starts, LIGHT)
    used = worst.demand / one.cable.allowable_tension_N
    # Lengths are those before it settles.
    lengths = refined(one.robot, workspace, one.cable, more, LIGHT)
    met = replace(lengths, worst_place=worst.place, max_tension_N=worst.demand, utilisation=used)
    return replace(found, verification=met, is_full=True)


def _turned(found: CaseFound) -> CaseFound:
    """Turn wind and inertia force to where they are worst, with the pose that goes with them."""
    if not found.loaded.is_turned or not found.verification.is_refined:
        return found
    return _at_its_tension(found, _turned_once)


def _turned_once(found: CaseFound) -> CaseFound:
    if not found.verification.is_refined:  # with another stiffness than before
        found = _search_once(found, is_light=True)
    for _ in range(_MOST_ROUNDS):
        before = found.utilisation
        turned = _steepest(found)
        if found.loaded.keeps_lengths:  # a search for the pose takes long
            found = governing([found, turned])
            break
        met = refined(
            turned.loaded.robot, turned.workspace, turned.loaded.cable,
            replace(turned.sampled, worst_places=turned.verification.worst_place[None]), LIGHT,
        )  # fmt: skip
        if met.utilisation > turned.utilisation:
            turned = replace(turned, verification=met)
        found = turned if turned.utilisation > before else found
        if not np.isfinite(found.utilisation) or found.utilisation <= before * (1.0 + _SAME):
            break
    return found


def _steepest(found: CaseFound) -> CaseFound:
    """Turn wind and inertia force at one pose while it gets worse."""

    def utilisation(loaded: Loaded) -> float:
        tension_N = found.tension_N(loaded, found.workspace.hangs_below)
        return tension_N / loaded.cable.allowable_tension_N

    loaded, used = steepest(found.loaded, found.utilisation, utilisation)
    tension_N = used * loaded.cable.allowable_tension_N
    met = replace(found.verification, max_tension_N=tension_N, utilisation=used)
    return replace(found, loaded=loaded, verification=met)


def steepest(
    loaded: Loaded, severity: float, severity_of: Callable[[Loaded], float]
) -> tuple[Loaded, float]:
    """Turn wind and inertia force by ever smaller steps while something gets more severe.

    Returns the direction that ends in, and the severity there; ``severity`` is where it starts.
    """
    step = 0.5
    while step > 1e-6:
        trials = [(severity_of(turned), turned) for turned in loaded.turned(step)]
        highest, turned = max(trials, key=lambda trial: trial[0])
        gains = highest > severity
        loaded, severity = (turned, highest) if gains else (loaded, severity)
        step *= 2.0 if gains else 0.25
    return loaded, severity
