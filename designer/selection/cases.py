"""What candidates meet in the load cases of a study, over the samples and between them.

Each case has directions of wind and inertia, lost cables and wrenches
(`designer.model.load_case.Loaded`); each of these is solved over all samples, for all candidates
that hold so far: over some of them at first, and over all where a candidate is searched. A lost
cable, or warmth on braked winches, sets the platform moving, which takes long to follow: that is
done for fewer samples. Between the samples it is searched in the direction in which a case asks for
most, and in those near it.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Callable, Hashable, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from designer import checked
from designer.arrays import FloatArray, IntArray
from designer.model.cable import Cable
from designer.model.load_case import LoadCase, Loaded
from designer.model.robot import Poses, Robot
from designer.model.workspace import HangsBelow, Workspace
from designer.progress import Advance, steps
from designer.selection.samples import over_kept_lengths, over_samples, sampled_at_tension
from designer.selection.stiffening import StiffnessSearch
from designer.selection.verify import Sampled, Verification, refined_each
from designer.statics.cable_loss import CableLoss
from designer.statics.inverse import Statics, solve_sagging
from designer.statics.sizes import is_quick
from designer.workspace.demand import settled, tension_demand
from designer.workspace.refine import LIGHT, Worst, refine

_MOST_SAMPLES = 256
"""Poses in which lengths are kept, for the chosen one."""
FEW_AT_FIRST = 128
"""Samples that candidates are tried at first where all of them take long."""
FEW_OF_QUICK = 2048
"""The same on robots that are quick to solve, and for the worst pose of a continuous family."""
_CLOSE = 0.95
"""Of the utilisation that governs: from where on other cases and directions are searched, too."""
_MOST_ROUNDS = 6
"""Of turning the loads and searching the pose again, so that it ends."""
_SAME = 1e-9
"""Relative gain in utilisation that is rounding."""
_NEAR = 0.01
"""Relative: how close searches that end at the same place come on their way."""


@dataclass(frozen=True, eq=False, repr=False)
class CaseResult(checked.Shown):
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
    """

    workspace: Workspace
    loaded: Loaded
    sampled: Sampled
    verification: Verification
    is_full: bool = False

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

    def tension_N(self, loaded: Loaded, hangs_below: HangsBelow = "include") -> float:
        """Return the largest tension at that pose with another robot or cable [N].

        Minus infinity where the pose is left out for a cable that hangs below the platform.
        """
        return float(tension_demand(loaded, hangs_below, self.verification.worst_place[None])[0])

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
        numbers = np.arange(1, self.loaded.robot.n_cables + 1)
        return np.asarray(numbers[numbers != self.loaded.lost_cable])

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
        """Return the same, with few samples at first; all of them for candidates that are searched.

        On robots that are slow to solve only where there is more than the static case.
        """
        if is_quick(self.robot):
            return replace(self, few=FEW_OF_QUICK)
        return replace(self, few=FEW_AT_FIRST) if len(self.each) > 1 else self

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
    ) -> list[tuple[CaseResult, ...]]:
        """Solve every sample with every candidate in every direction of every case.

        Parameters
        ----------
        cables : sequence of sequences of Cable
            For each case the candidates, with what they may be used to in it.
        progress : callable
            Called with the number of samples done.

        Returns
        -------
        list of tuple of CaseResult
            For each candidate, each direction of each case; up to the first that settles that it
            does not hold.
        """
        results: list[list[CaseResult]] = [[] for _ in cables[0]]
        for case, of_case in zip(self.each, cables, strict=True):
            directions = zip(*(case.on(self.robot, cable) for cable in of_case), strict=True)
            for loaded in directions:
                alive = [
                    k
                    for k, so_far in enumerate(results)
                    if all(result.verification.holds for result in so_far)
                ]
                in_direction = self._try(case, [loaded[k] for k in alive], progress)
                for k, result in zip(alive, in_direction, strict=True):
                    results[k].append(result)
        return [tuple(of_candidate) for of_candidate in results]

    def _try(
        self, case: LoadCase, loaded: Sequence[Loaded], progress: Advance
    ) -> Iterator[CaseResult]:
        workspace = whole_workspace = self.workspace.of_case(case)
        keeps = any(candidate.keeps_lengths for candidate in loaded)
        if self.few is not None and not keeps:
            workspace = workspace.with_fewer_samples(self.few)
        shares = bool(loaded) and not case.changes_robot and not keeps
        solved = sampled_at_tension(loaded, workspace, progress)
        if not shares:
            progress(self.sample_count)
        is_whole = workspace is whole_workspace
        for candidate, met in solved:
            sampled = replace(met, is_complete=is_whole and met.is_complete)
            verification = sampled.verification(candidate.cable)
            yield CaseResult(whole_workspace, candidate, sampled, verification)


def resettled(result: CaseResult) -> CaseResult:
    """Return a case, after another worst pose, with the stiffness at the tension there.

    What was not searched between the samples has that at the tension over them.
    """
    if not result.verification.is_refined:
        return result

    def search(results: Sequence[CaseResult]) -> Sequence[CaseResult]:
        is_refined = all(result.verification.is_refined for result in results)
        return results if is_refined else _search_once(results, is_light=False)

    return _at_their_tension([result], search)[0]


def as_stiff_as(cable: Cable, result: CaseResult) -> Cable:
    """Return a cable with the stiffness that it has in a load case."""
    if cable.stiffening is None:
        return cable
    return replace(cable, axial_stiffness_N=result.loaded.cable.axial_stiffness_N)


_SearchAll = Callable[[Sequence[CaseResult]], Sequence[CaseResult]]


def _at_their_tension(results: Sequence[CaseResult], search: _SearchAll) -> list[CaseResult]:
    """Search until each cable has the stiffness that it has at the largest tension found.

    With another stiffness all samples are solved again, and the search starts from the worst pose
    found before as well.
    """
    searched, stiffnesses = list(search(results)), [StiffnessSearch() for _ in results]
    pending = list(range(len(searched)))
    while True:
        again = {}
        for k in pending:
            result = searched[k]
            worst = result.verification
            loaded = stiffnesses[k].next_of(result.loaded, worst.max_tension_N)
            if loaded is not None:
                (sampled,) = over_samples([loaded], result.workspace)
                places = np.concatenate([worst.worst_place[None], sampled.worst_places])
                verification = sampled.verification(loaded.cable)
                sampled = replace(sampled, worst_places=places)
                again[k] = CaseResult(result.workspace, loaded, sampled, verification)
        if not again:
            return searched
        for k, result in zip(again, search(list(again.values())), strict=True):
            searched[k] = result
        pending = list(again)


def governing(results: Sequence[CaseResult]) -> CaseResult:
    """Return the case, and direction, that asks for most; the first of equal ones."""
    return max(results, key=lambda result: result.utilisation)


def worst_of_each(results: Sequence[CaseResult]) -> tuple[CaseResult, ...]:
    """Return of each case the direction that asks for most, in the order of the study."""
    cases = dict.fromkeys(result.case for result in results)
    return tuple(governing([r for r in results if r.case is case]) for case in cases)


def together(results: Sequence[CaseResult]) -> Verification:
    """Return what governs, with the longest and shortest lengths of all cases."""
    longest = np.maximum.reduce([result.verification.longest_m for result in results])
    shortest = np.fmin.reduce([result.verification.shortest_m for result in results])
    return replace(governing(results).verification, longest_m=longest, shortest_m=shortest)


def searched(
    candidates: Sequence[Sequence[CaseResult]],
) -> list[tuple[CaseResult, ...]]:
    """Search several candidates between the samples: what governs in full, cases near it lightly.

    All of them in one batch.
    """
    completed = _completed([r for results in candidates for r in _close(worst_of_each(results))])
    whole = [_with(results, completed) for results in candidates]
    close = [(worst_of_each(results), governing(results)) for results in whole]
    replaced = _search([(r, r is not worst) for each, worst in close for r in _close(each)])
    return [_with(results, replaced) for results in whole]


def _completed(results: Sequence[CaseResult]) -> dict[CaseResult, CaseResult]:
    """Solve all samples where only some were; what each result that holds becomes."""
    completed: dict[CaseResult, CaseResult] = {}
    few = [r for r in results if r.verification.holds and not r.sampled.is_complete]
    for of_load in _of_same_load(few):
        workspace = of_load[0].workspace
        solved = sampled_at_tension([result.loaded for result in of_load], workspace)
        for result, (loaded, sampled) in zip(of_load, solved, strict=True):
            verification = sampled.verification(loaded.cable)
            completed[result] = CaseResult(workspace, loaded, sampled, verification)
    return completed


def _close(results: Sequence[CaseResult]) -> list[CaseResult]:
    """Those that ask for most, or nearly."""
    least = _CLOSE * governing(results).utilisation
    return [result for result in results if result.utilisation > least]


def searched_all(results: Sequence[CaseResult]) -> tuple[CaseResult, ...]:
    """Search between the samples in every case: its worst direction in full, those near it lightly.

    Wind from all directions and inertia forces are then turned and the pose searched again by
    turns until neither gains. What is found is the largest that these searches met, from the worst
    of the first directions on; that there is none larger is not proved.
    """
    results = _with(results, _completed(results))
    replaced: dict[CaseResult, CaseResult] = {}
    for worst in steps("load cases", worst_of_each(results)):
        close = _close([result for result in results if result.case is worst.case])
        replaced |= _search([(result, result is not worst) for result in close])
    passed: list[CaseResult] = []
    directions = steps("directions", _with(results, replaced))
    turned = tuple(_turned(result, passed) for result in directions)
    worst_turned = [result for result in worst_of_each(turned) if _is_turned(result)]
    return _with(turned, {result: _with_lengths(result) for result in worst_turned})


def _with(
    results: Sequence[CaseResult], replaced: dict[CaseResult, CaseResult]
) -> tuple[CaseResult, ...]:
    return tuple(replaced.get(result, result) for result in results)


def _search(results: Sequence[tuple[CaseResult, bool]]) -> dict[CaseResult, CaseResult]:
    """Search some results, each lightly or not; what each becomes."""
    replaced: dict[CaseResult, CaseResult] = {}
    for is_light in (False, True):
        of_effort = [result for result, light in results if light is is_light]
        search = partial(_search_once, is_light=is_light)
        replaced |= zip(of_effort, _at_their_tension(of_effort, search), strict=True)
    return replaced


def _search_once(results: Sequence[CaseResult], *, is_light: bool) -> list[CaseResult]:
    """Search results, those on the same robot under the same load in one batch."""
    fresh = [r for r in results if np.isfinite(r.utilisation) and not r.is_full]
    settling = [] if is_light else [r for r in fresh if r.loaded.keeps_lengths]
    searched = {result: _search_settled(result) for result in settling}
    for of_load in _of_same_load([r for r in fresh if not r.loaded.keeps_lengths]):
        robot, workspace = of_load[0].loaded.robot, of_load[0].workspace
        cables, sampled = [r.loaded.cable for r in of_load], [r.sampled for r in of_load]
        effort = LIGHT if is_light else None
        verifications = refined_each(robot, workspace, cables, sampled, effort)
        for result, verification in zip(of_load, verifications, strict=True):
            searched[result] = replace(result, verification=verification, is_full=not is_light)
    return list(_with(results, searched))


def _of_same_load(results: Sequence[CaseResult]) -> Iterable[list[CaseResult]]:
    """Return the results of cables that meet the same load on the same robot, together."""
    batches = defaultdict(list)
    for result in results:
        batches[_load_of(result.loaded)].append(result)
    return batches.values()


def _load_of(loaded: Loaded) -> Hashable:
    """Return what is the same for cables that meet the same load on the same robot."""
    if loaded.case.changes_robot:
        return loaded
    each = (loaded.wind, loaded.inertia, loaded.wrench_N)
    directions = (None if d is None else d.tobytes() for d in each)
    return loaded.case, *directions


def _search_settled(result: CaseResult) -> CaseResult:
    """Search for the worst pose of a platform that settles on the lengths that it has."""
    loaded, workspace = result.loaded, result.workspace
    sampled = over_kept_lengths(loaded, workspace, _MOST_SAMPLES)
    demand = partial(tension_demand, loaded, workspace.hangs_below)
    starts = np.concatenate([result.sampled.worst_places, sampled.worst_places])
    (worst,) = refine(workspace.space, demand, starts, LIGHT)
    # Lengths are those before it settles.
    (lengths,) = refined_each(loaded.robot, workspace, [loaded.cable], [sampled], LIGHT)
    return _with_worst(replace(result, verification=lengths, is_full=True), worst)


def _turned(result: CaseResult, passed: list[CaseResult]) -> CaseResult:
    """Turn wind and inertia force to where they are worst, with the pose that goes with them.

    ``passed`` are states that such searches have come through; one that meets another's ends there.
    """
    if not _is_turned(result):
        return result
    search = partial(_turned_once, passed=passed)
    return _at_their_tension([result], lambda results: list(map(search, results)))[0]


def _is_turned(result: CaseResult) -> bool:
    return result.loaded.is_direction_searched and result.verification.is_refined


def _turned_once(result: CaseResult, passed: list[CaseResult]) -> CaseResult:
    if not result.verification.is_refined:  # with another stiffness than before
        (result,) = _search_once([result], is_light=True)
    others = tuple(passed)
    for _ in range(_MOST_ROUNDS):
        steeper = _steepest(result)
        if result.loaded.keeps_lengths:  # a search for the pose takes long
            return governing([result, steeper])
        if any(_is_beside(steeper, other) for other in others):
            return governing([result, steeper])
        passed.append(steeper)
        demand = partial(tension_demand, steeper.loaded, steeper.workspace.hangs_below)
        start = steeper.verification.worst_place[None]
        (worst,) = refine(steeper.workspace.space, demand, start, LIGHT)
        moved = _with_worst(steeper, worst)
        result = governing([result, steeper, moved])
        has_moved = moved.utilisation > steeper.utilisation * (1.0 + _SAME)
        if not (has_moved and np.isfinite(result.utilisation)):
            break
    return result


def _is_beside(result: CaseResult, other: CaseResult) -> bool:
    """Tell whether a case is so near to another state of it that both lead to the same end."""
    far = np.abs(result.verification.worst_place - other.verification.worst_place)
    size = np.ptp(result.workspace.space.bounds, axis=0)
    ours, theirs = (
        [
            along
            for along in (r.loaded.wind, r.loaded.inertia, r.loaded.wrench_N)
            if along is not None
        ]
        for r in (result, other)
    )
    return (
        result.case is other.case
        and math.isclose(result.utilisation, other.utilisation, rel_tol=_NEAR)
        and bool((far <= _NEAR * size).all())
        and all(
            np.linalg.norm(our - their) <= _NEAR * np.linalg.norm(their)
            for our, their in zip(ours, theirs, strict=True)
        )
    )


def _with_worst(result: CaseResult, worst: Worst) -> CaseResult:
    """Return a result with the largest tension at another place."""
    verification = replace(
        result.verification,
        worst_place=worst.place,
        max_tension_N=worst.demand,
        utilisation=worst.demand / result.loaded.cable.allowable_tension_N,
    )
    return replace(result, verification=verification)


def _with_lengths(result: CaseResult) -> CaseResult:
    """Return a result with the lengths that its direction asks for as well, searched lightly."""
    loaded, met = result.loaded, result.verification
    if loaded.keeps_lengths or not math.isfinite(result.utilisation):
        return result
    start = replace(result.sampled, worst_places=met.worst_place[None])
    (lengths,) = refined_each(loaded.robot, result.workspace, [loaded.cable], [start], LIGHT)
    longest = np.maximum(met.longest_m, lengths.longest_m)
    shortest = np.fmin(met.shortest_m, lengths.shortest_m)
    return replace(result, verification=replace(met, longest_m=longest, shortest_m=shortest))


def _steepest(result: CaseResult) -> CaseResult:
    """Turn wind and inertia force at one pose while it gets worse."""

    def utilisation_of(loaded: Loaded) -> float:
        tension_N = result.tension_N(loaded, result.workspace.hangs_below)
        return tension_N / loaded.cable.allowable_tension_N

    loaded, utilisation = steepest(result.loaded, result.utilisation, utilisation_of)
    tension_N = utilisation * loaded.cable.allowable_tension_N
    worst = Worst(result.verification.worst_place, tension_N)
    return _with_worst(replace(result, loaded=loaded), worst)


def steepest(
    loaded: Loaded, severity: float, severity_of: Callable[[Loaded], float]
) -> tuple[Loaded, float]:
    """Turn wind and inertia force, by smaller steps where nothing gets more severe.

    Tried are all ways aside, and where all severities were highest if they were linear in the
    direction; it ends early where that, after the first step, leads nowhere. Returns the direction
    that it ends in, and the severity there; ``severity`` is where it starts.
    """
    step = 0.5
    while step > 1e-6:
        trials = [(severity_of(turned), turned) for turned in loaded.perturbed(step)]
        summit = _summit(loaded, severity, trials)
        if summit is not None:
            trials.append((severity_of(summit), summit))
        highest, turned = max(trials, key=lambda trial: trial[0])
        gains = highest > severity
        is_level = abs(highest - severity) <= _SAME * abs(severity)
        loaded, severity = (turned, highest) if gains else (loaded, severity)
        if turned is summit and is_level and step < 0.5:
            break
        step *= 0.02 if turned is summit else 2.0 if gains else 0.125
    return loaded, severity


def _summit(
    loaded: Loaded, severity: float, trials: Sequence[tuple[float, Loaded]]
) -> Loaded | None:
    """Return the directions that are worst if severity is linear in each, as tension nearly is.

    None where only a wrench is changed, or a trial is not finite.
    """
    if not np.isfinite([severity, *(value for value, _ in trials)]).all():
        return None
    directions: dict[str, FloatArray] = {}
    for name in ("wind", "inertia"):
        along = getattr(loaded, name)
        beside = [(value, getattr(trial, name)) for value, trial in trials]
        moved = [(value - severity, other - along) for value, other in beside if other is not along]
        if moved:
            rise, aside = map(np.array, zip(*moved, strict=True))
            slope = np.linalg.lstsq(aside, rise, rcond=None)[0]
            if slope.any():
                directions[name] = slope / np.linalg.norm(slope)
    if not directions:
        return None
    wind, inertia = (directions.get(k, getattr(loaded, k)) for k in ("wind", "inertia"))
    return loaded.case.under(*loaded.bare, wind, inertia, loaded.lost_cable, loaded.wrench_N)
