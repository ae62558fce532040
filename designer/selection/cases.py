r"""What candidates meet in the load cases of a study: over the samples, between them, as proved.

Each case has directions of wind and inertia, lost cables and wrenches
(`designer.model.load_case.Loaded`); each is solved over all samples, for all candidates that hold
so far: over some of them at first, and over all where a candidate is searched. Kept lengths (a lost
cable, warmth on braked winches) set the platform moving, which takes long to follow: that is done
for fewer samples. Between the samples it is searched in the direction in which a case asks for
most, and in those near it.

EA of a fibre rope depends on its tension, and a cable is solved with one EA. That is the one at the
largest tension that any of the cables meets, in any pose, in one direction of a load case:

.. math::

    EA = EA(T_{max}(EA)),

a fixed point, found by the secant method. The safety factor is not in it. On kept lengths the
largest tension is that afterwards, and the cables have that EA before as well. Where a pose is not
held, there is no such tension, and the EA that was tried stays. Ropes with one EA for all loads are
left as they are.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Callable, Generator, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from designer import checked
from designer.arrays import FloatArray, IntArray
from designer.model.cable import Cable
from designer.model.load_case import STATIC, LoadCase, Loaded
from designer.model.robot import Poses, Robot
from designer.model.workspace import HangsBelow, Workspace
from designer.progress import Advance, steps
from designer.proof.prove import Budget, Proof, prove
from designer.selection.verify import Sampled, Verification, refined_each, verify_sizes
from designer.statics.cable_loss import CableLoss
from designer.statics.inverse import Statics, solve_sagging
from designer.statics.sizes import has_fast_solver
from designer.workspace.demand import is_left_out, rope_demand, settled, tension_demand
from designer.workspace.effort import CHOSEN_SETTLING, COARSE
from designer.workspace.refine import LIGHT, refine
from designer.workspace.section import in_lockstep

_CLOSE = 0.95
"""Of the utilisation that governs: from where on other cases and directions are searched, too."""
_MAX_ITERATIONS, _MAX_SECANTS = 6, 20
"""Of worsening the loads and searching the pose again; of EA. Both end where tensions jump."""
_ROUNDING, _EA_RTOL = 1e-9, 1e-6
"""Relative gain in utilisation that is rounding; change of EA at which it is taken to stay."""
_SAME_SEARCH = 0.01
"""Relative: how close searches that end at the same place come on their way."""


@dataclass(frozen=True, eq=False, repr=False)
class CaseResult(checked.Shown):
    """What a cable meets in one load case, or in one direction of it."""

    workspace: Workspace  #: with the region of the case
    loaded: Loaded  #: robot and cable in the direction, or without the cable, that is used most
    sampled: Sampled  #: what it meets there over the samples
    verification: Verification  #: the same, also between the samples where `is_refined`
    is_full: bool = False  #: whether that search was the full one

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

    def with_worst(self, place: FloatArray, tension_N: float) -> CaseResult:
        """Return the same with the largest tension at another place."""
        utilisation = tension_N / self.loaded.cable.allowable_tension_N
        verification = replace(
            self.verification, worst_place=place, max_tension_N=tension_N, utilisation=utilisation
        )
        return replace(self, verification=verification)

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


def governing(results: Sequence[CaseResult]) -> CaseResult:
    """Return the case, and direction, that asks for most; the first of equal ones."""
    return max(results, key=lambda result: result.utilisation)


def governing_directions(results: Sequence[CaseResult]) -> tuple[CaseResult, ...]:
    """Return of each case the direction that asks for most, in the order of the study."""
    cases = dict.fromkeys(result.case for result in results)
    return tuple(governing([r for r in results if r.case is case]) for case in cases)


def envelope(results: Sequence[CaseResult]) -> Verification:
    """Return what governs, with the longest and shortest lengths of all cases."""
    longest = np.maximum.reduce([result.verification.longest_m for result in results])
    shortest = np.fmin.reduce([result.verification.shortest_m for result in results])
    return replace(governing(results).verification, longest_m=longest, shortest_m=shortest)


# Stiffness at the largest tension


def _secants(cable: Cable) -> Generator[Cable, float, Cable]:
    """Yield the cable with one EA after the other; is sent the largest tension with each [N].

    Returns the last one. It ends after `_MAX_SECANTS` as well: the tension jumps where a platform
    falls elsewhere.
    """
    law, previous = cable.stiffening, None
    for _ in range(_MAX_SECANTS):
        max_tension_N = yield cable
        if law is None or not math.isfinite(max_tension_N):
            return cable
        stiffness_N = cable.axial_stiffness_N
        off_N = step_N = law.at(max_tension_N) - stiffness_N
        if abs(off_N) <= _EA_RTOL * stiffness_N:
            return cable
        if previous is not None:
            slope = (off_N - previous[1]) / (stiffness_N - previous[0])
            if slope < 0.0:  # else both steps lead away from it
                step_N = -off_N / slope
        previous = stiffness_N, off_N
        lowest_N, highest_N = min(law.axial_stiffness_N), max(law.axial_stiffness_N)
        next_N = min(max(stiffness_N + step_N, lowest_N), highest_N)
        if next_N == stiffness_N:
            return cable
        cable = replace(cable, axial_stiffness_N=next_N)
    yield cable
    return cable


def converge_stiffness(cable: Cable, max_tension_N: Callable[[Cable], float]) -> Cable:
    """Return a cable as stiff as at the largest tension [N] that a function finds it to meet."""
    if cable.stiffening is None:
        return cable
    (settled_cable,) = in_lockstep(
        [_secants(cable)], lambda cables: {k: max_tension_N(trial) for k, trial in cables.items()}
    )
    return settled_cable


def with_stiffness_of(cable: Cable, result: CaseResult) -> Cable:
    """Return a cable with the stiffness that it has in a load case."""
    if cable.stiffening is None:
        return cable
    return replace(cable, axial_stiffness_N=result.loaded.cable.axial_stiffness_N)


def _converge_stiffnesses(
    results: Sequence[CaseResult],
    solve_again: Callable[[Sequence[CaseResult], Sequence[Loaded]], Sequence[CaseResult]],
) -> list[CaseResult]:
    """Solve results again, with other stiffnesses, until each is that at its largest tension."""
    solved = list(results)

    def max_tensions_N(cables: Mapping[int, Cable]) -> Mapping[int, float]:
        changed = {k: cable for k, cable in cables.items() if cable is not results[k].loaded.cable}
        trials = []
        for k, cable in changed.items():
            robot, bare = solved[k].loaded.bare
            stiffer = replace(bare, axial_stiffness_N=cable.axial_stiffness_N)
            trials.append(solved[k].loaded.on(robot, stiffer))
        new = solve_again([solved[k] for k in changed], trials) if changed else ()
        for k, result in zip(changed, new, strict=True):
            solved[k] = result
        return {k: solved[k].verification.max_tension_N for k in cables}

    in_lockstep([_secants(result.loaded.cable) for result in results], max_tensions_N)
    return solved


# Over the samples


@dataclass(frozen=True, slots=True, eq=False)
class Cases:
    """The load cases of a study, ready to be tried on cables."""

    robot: Robot
    workspace: Workspace
    load_cases: tuple[LoadCase, ...]
    sample_limit: int | None = None  #: how many samples are solved at first; None for all of them

    def with_coarse_sampling(self) -> Cases:
        """Return the same, with few samples at first; all of them for candidates that are searched.

        On robots that are slow to solve only where there is more than the static case.
        """
        is_coarse = has_fast_solver(self.robot) or len(self.load_cases) > 1
        return replace(self, sample_limit=COARSE.of(self.robot)) if is_coarse else self

    @property
    def sample_count(self) -> int:
        """How many samples are solved in each direction, for a progress bar (an estimate)."""
        count = self.workspace.sample_count
        return count if self.sample_limit is None else min(self.sample_limit, count)

    def passes(self, cables: Sequence[Sequence[Cable]]) -> int:
        """Return how often all samples are solved at most, for a progress bar."""
        if not cables or not cables[0]:
            return 1
        pairs = zip(self.load_cases, cables, strict=True)
        return sum(len(list(case.on(self.robot, of_case[0]))) for case, of_case in pairs)

    def sampled(
        self, cables: Sequence[Sequence[Cable]], progress: Advance
    ) -> list[tuple[CaseResult, ...]]:
        """Solve every sample with every candidate in every direction of every case.

        ``cables`` are, for each case, the candidates with what they may be used to in it;
        ``progress`` is called with the number of samples done. Returns, for each candidate, each
        direction of each case; up to the first that settles that it does not hold.
        """
        results: list[list[CaseResult]] = [[] for _ in cables[0]]
        for case, of_case in zip(self.load_cases, cables, strict=True):
            case_workspace = self.workspace.of_case(case)
            for loaded in zip(*(case.on(self.robot, cable) for cable in of_case), strict=True):
                alive = [
                    k
                    for k, so_far in enumerate(results)
                    if all(result.verification.holds for result in so_far)
                ]
                loads, workspace = [loaded[k] for k in alive], case_workspace
                keeps = any(candidate.keeps_lengths for candidate in loads)
                if self.sample_limit is not None and not keeps:
                    workspace = case_workspace.with_fewer_samples(self.sample_limit)
                solved = _at_converged_stiffness(loads, workspace, progress)
                if not loads or case.changes_robot or keeps:  # not counted on the way
                    progress(self.sample_count)
                for k, result in zip(alive, solved, strict=True):
                    is_complete = workspace is case_workspace and result.sampled.is_complete
                    sampled = replace(result.sampled, is_complete=is_complete)
                    results[k].append(replace(result, workspace=case_workspace, sampled=sampled))
        return [tuple(of_candidate) for of_candidate in results]


def _at_converged_stiffness(
    loaded: Sequence[Loaded], workspace: Workspace, progress: Advance = lambda _: None
) -> list[CaseResult]:
    """Solve the samples with each of the cables, as stiff as at the tension that it meets there."""

    def solved(loaded: Sequence[Loaded], progress: Advance = lambda _: None) -> list[CaseResult]:
        all_sampled = over_samples(loaded, workspace, progress)
        return [
            CaseResult(workspace, candidate, sampled, sampled.verification(candidate.cable))
            for candidate, sampled in zip(loaded, all_sampled, strict=True)
        ]

    return _converge_stiffnesses(solved(loaded, progress), lambda _, trials: solved(trials))


def over_samples(
    loaded: Sequence[Loaded], workspace: Workspace, progress: Advance = lambda _: None
) -> list[Sampled]:
    """Solve the samples with each of the cables, all in one direction of one case."""
    if not loaded:
        return []
    if any(candidate.keeps_lengths for candidate in loaded):
        return [_over_kept_lengths(candidate, workspace, COARSE.settling) for candidate in loaded]
    # Which poses are left out the compiled sweep cannot tell: its down is the load.
    if workspace.hangs_below == "exclude" and loaded[0].robot.cable_load_direction is not None:
        return [_by_true_vertical(candidate, workspace) for candidate in loaded]
    if loaded[0].case.changes_robot:
        return [
            verify_sizes(candidate.robot, workspace, [candidate.cable])[0] for candidate in loaded
        ]
    cables = [candidate.cable for candidate in loaded]
    return verify_sizes(loaded[0].robot, workspace, cables, progress=progress)


def _over_kept_lengths(loaded: Loaded, workspace: Workspace, samples: int) -> Sampled:
    """Return what a cable meets on kept lengths, over some samples."""
    places = np.concatenate([workspace.space.landmarks(), workspace.thinned(samples)])
    loss = settled(loaded, Poses.at(places))
    counts = ~is_left_out(loss.before, workspace.hangs_below)
    tension = np.where(counts, loss.largest_tension_N, -np.inf)
    longest = np.nan_to_num(loss.before.length_m[counts]).max(axis=0, initial=0.0)
    return _sampled(loaded.cable, places, tension, longest)


def _by_true_vertical(loaded: Loaded, workspace: Workspace) -> Sampled:
    """Return what a cable meets over the samples, which poses count told by the true vertical."""
    every = (workspace.space.landmarks(), *workspace.places())
    batches = [batch for batch in every if len(batch)]  # a list of points has no landmarks
    demand = partial(rope_demand, loaded.robot, loaded.cable, workspace.hangs_below)
    tension, lengths, _ = np.split(
        np.concatenate([demand(batch) for batch in batches]), [1, 1 + loaded.robot.n_cables], axis=1
    )
    longest = np.maximum(lengths, 0.0).max(axis=0)
    return _sampled(loaded.cable, np.concatenate(batches), tension[:, 0], longest)


def _sampled(
    cable: Cable, places: FloatArray, tension_N: FloatArray, longest_m: FloatArray
) -> Sampled:
    """Put together what a cable meets; the tension is minus infinite where a pose is left out."""
    used = tension_N / cable.allowable_tension_N
    counts = ~np.isneginf(used)
    order = np.argsort(-used, kind="stable")[: counts.sum()]
    return Sampled(
        worst_places=places[order[:8]],
        utilisation=float(used.max()) if counts.any() else np.inf,
        longest_m=longest_m,
        samples=len(places),
        counted=int(np.isfinite(used).sum()),
        overloaded=int((used > 1.0).sum()),
        not_held=int(np.isposinf(used).sum()),
        is_complete=True,
    )


# Between the samples


def refine_governing(candidates: Sequence[Sequence[CaseResult]]) -> list[tuple[CaseResult, ...]]:
    """Search several candidates in one batch: what governs in full, cases near it lightly."""
    worst_directions = [governing_directions(results) for results in candidates]
    completed = _completed([r for worst in worst_directions for r in _near_governing(worst)])
    complete = [_replaced(results, completed) for results in candidates]
    refined = _refined(
        [
            (result, result is not governing(results))
            for results in complete
            for result in _near_governing(governing_directions(results))
        ]
    )
    return [_replaced(results, refined) for results in complete]


def refine_all(results: Sequence[CaseResult]) -> tuple[CaseResult, ...]:
    """Search between the samples in every case: its worst direction in full, those near it lightly.

    Wind from all directions and inertia forces are then worsened and the pose searched again in
    alternation until neither gains. What is found is the largest that these searches met, from the
    worst of the first directions on; that there is none larger is not proved.
    """
    results = _replaced(results, _completed(results))
    refined: dict[CaseResult, CaseResult] = {}
    for worst in steps("load cases", governing_directions(results)):
        near_governing = _near_governing(
            [result for result in results if result.case is worst.case]
        )
        refined |= _refined([(result, result is not worst) for result in near_governing])
    passed: list[CaseResult] = []  # states that such searches have come through

    def worsen(results: Sequence[CaseResult]) -> list[CaseResult]:
        return [_worsened(result, passed) for result in results]

    directions = steps("directions", _replaced(results, refined))
    worsened = tuple(
        _converged(worsen([r]), worsen)[0] if _can_worsen(r) else r for r in directions
    )
    governs = [result for result in governing_directions(worsened) if _can_worsen(result)]
    return _replaced(worsened, {result: _with_lengths(result) for result in governs})


def resettled(result: CaseResult) -> CaseResult:
    """Return a case, after another worst pose, with the stiffness at the tension there.

    What was not searched between the samples has that at the tension over them.
    """
    if not result.verification.is_refined:
        return result
    return _converged([result], partial(_search, is_light=False))[0]


def _converged(
    results: Sequence[CaseResult], search: Callable[[Sequence[CaseResult]], list[CaseResult]]
) -> list[CaseResult]:
    """Search results again until the stiffness of each is that at its largest tension.

    With another stiffness all samples are solved again, and the search starts from the worst pose
    found before as well.
    """

    def search_again(old: Sequence[CaseResult], trials: Sequence[Loaded]) -> list[CaseResult]:
        restarted = []
        for result, loaded in zip(old, trials, strict=True):
            (sampled,) = over_samples([loaded], result.workspace)
            verification = sampled.verification(loaded.cable)
            places = np.concatenate([result.verification.worst_place[None], sampled.worst_places])
            sampled = replace(sampled, worst_places=places)
            restarted.append(CaseResult(result.workspace, loaded, sampled, verification))
        return search(restarted)

    return _converge_stiffnesses(results, search_again)


def _completed(results: Sequence[CaseResult]) -> dict[CaseResult, CaseResult]:
    """Solve all samples where only some were; what each result that holds becomes."""
    completed: dict[CaseResult, CaseResult] = {}
    incomplete = [r for r in results if r.verification.holds and not r.sampled.is_complete]
    for batch in _by_load(incomplete):
        solved = _at_converged_stiffness([result.loaded for result in batch], batch[0].workspace)
        completed |= zip(batch, solved, strict=True)
    return completed


def _near_governing(results: Sequence[CaseResult]) -> list[CaseResult]:
    """Those that ask for most, or nearly."""
    least = _CLOSE * governing(results).utilisation
    return [result for result in results if result.utilisation > least]


def _replaced(
    results: Sequence[CaseResult], new: Mapping[CaseResult, CaseResult]
) -> tuple[CaseResult, ...]:
    return tuple(new.get(result, result) for result in results)


def _refined(results: Sequence[tuple[CaseResult, bool]]) -> dict[CaseResult, CaseResult]:
    """Search some results, each lightly or not; what each becomes."""
    refined: dict[CaseResult, CaseResult] = {}
    for is_light in (False, True):
        of_effort = [result for result, light in results if light is is_light]
        search = partial(_search, is_light=is_light)
        refined |= zip(of_effort, _converged(search(of_effort), search), strict=True)
    return refined


def _search(results: Sequence[CaseResult], *, is_light: bool) -> list[CaseResult]:
    """Search results, those on the same robot under the same load in one batch."""
    fresh = [r for r in results if np.isfinite(r.utilisation) and not r.is_full]
    settling = [] if is_light else [r for r in fresh if r.loaded.keeps_lengths]
    refined = {result: _search_settled(result) for result in settling}
    for batch in _by_load([r for r in fresh if not r.loaded.keeps_lengths]):
        robot, workspace = batch[0].loaded.robot, batch[0].workspace
        cables, sampled = [r.loaded.cable for r in batch], [r.sampled for r in batch]
        effort = LIGHT if is_light else None
        verifications = refined_each(robot, workspace, cables, sampled, effort)
        for result, verification in zip(batch, verifications, strict=True):
            refined[result] = replace(result, verification=verification, is_full=not is_light)
    return list(_replaced(results, refined))


def _by_load(results: Sequence[CaseResult]) -> Iterable[list[CaseResult]]:
    """Return the results of cables that meet the same load on the same robot, together."""
    batches: defaultdict[Hashable, list[CaseResult]] = defaultdict(list)
    for result in results:
        loaded = result.loaded
        directions = (loaded.wind, loaded.inertia, loaded.wrench_N)
        load = (loaded.case, *(None if d is None else d.tobytes() for d in directions))
        batches[loaded if loaded.case.changes_robot else load].append(result)
    return batches.values()


def _search_settled(result: CaseResult) -> CaseResult:
    """Search for the worst pose of a platform that settles on the lengths that it has."""
    loaded, workspace = result.loaded, result.workspace
    sampled = _over_kept_lengths(loaded, workspace, CHOSEN_SETTLING)
    demand = partial(tension_demand, loaded, workspace.hangs_below)
    starts = np.concatenate([result.sampled.worst_places, sampled.worst_places])
    (worst,) = refine(workspace.space, demand, starts, LIGHT)
    # Lengths are those before it settles.
    (lengths,) = refined_each(loaded.robot, workspace, [loaded.cable], [sampled], LIGHT)
    settled_result = replace(result, verification=lengths, is_full=True)
    return settled_result.with_worst(worst.place, worst.demand)


def _with_lengths(result: CaseResult) -> CaseResult:
    """Return a result with the lengths that its direction asks for as well, searched lightly."""
    loaded, verification = result.loaded, result.verification
    if loaded.keeps_lengths or not math.isfinite(result.utilisation):
        return result
    start = replace(result.sampled, worst_places=verification.worst_place[None])
    (lengths,) = refined_each(loaded.robot, result.workspace, [loaded.cable], [start], LIGHT)
    longest = np.maximum(verification.longest_m, lengths.longest_m)
    shortest = np.fmin(verification.shortest_m, lengths.shortest_m)
    return replace(
        result, verification=replace(verification, longest_m=longest, shortest_m=shortest)
    )


# Loads in their worst direction


def _can_worsen(result: CaseResult) -> bool:
    return result.loaded.is_direction_searched and result.verification.is_refined


def _worsened(result: CaseResult, passed: list[CaseResult]) -> CaseResult:
    """Worsen the loads and search the pose again, in alternation.

    ``passed`` are states that such searches have come through; one that meets another's ends there.
    """
    if not result.verification.is_refined:  # with another stiffness than before
        (result,) = _search([result], is_light=True)
    others, hangs_below = tuple(passed), result.workspace.hangs_below
    for _ in range(_MAX_ITERATIONS):
        place = result.verification.worst_place

        def utilisation(loaded: Loaded, result: CaseResult = result) -> float:
            return result.tension_N(loaded, hangs_below) / loaded.cable.allowable_tension_N

        loaded, highest = worst_load_direction(result.loaded, result.utilisation, utilisation)
        tension_N = highest * loaded.cable.allowable_tension_N
        steeper = replace(result, loaded=loaded).with_worst(place, tension_N)
        # On kept lengths a search for the pose takes long.
        if loaded.keeps_lengths or any(_is_same_search(steeper, other) for other in others):
            return governing([result, steeper])
        passed.append(steeper)
        demand = partial(tension_demand, loaded, hangs_below)
        (worst,) = refine(steeper.workspace.space, demand, place[None], LIGHT)
        moved = steeper.with_worst(worst.place, worst.demand)
        result = governing([result, steeper, moved])
        has_moved = moved.utilisation > steeper.utilisation * (1.0 + _ROUNDING)
        if not (has_moved and np.isfinite(result.utilisation)):
            break
    return result


def _is_same_search(result: CaseResult, other: CaseResult) -> bool:
    """Tell whether a case is so near to another state of it that both lead to the same end."""
    if result.case is not other.case:
        return False
    apart = np.abs(result.verification.worst_place - other.verification.worst_place)
    size = np.ptp(result.workspace.space.bounds, axis=0)
    ours, theirs = (
        [d for d in (r.loaded.wind, r.loaded.inertia, r.loaded.wrench_N) if d is not None]
        for r in (result, other)
    )
    return (
        math.isclose(result.utilisation, other.utilisation, rel_tol=_SAME_SEARCH)
        and bool((apart <= _SAME_SEARCH * size).all())
        and all(
            np.linalg.norm(our - their) <= _SAME_SEARCH * np.linalg.norm(their)
            for our, their in zip(ours, theirs, strict=True)
        )
    )


def worst_load_direction(
    loaded: Loaded, severity: float, severity_of: Callable[[Loaded], float]
) -> tuple[Loaded, float]:
    """Turn wind and inertia force, by smaller steps where nothing gets more severe.

    Tried are all ways aside, and where all severities were highest if they were linear in the
    direction; it ends early where that, after the first step, leads nowhere. Returns the direction
    that it ends in, and the severity there; ``severity`` is where it starts.
    """
    step = 0.5
    while step > 1e-6:
        trials = [(severity_of(trial), trial) for trial in loaded.perturbed(step)]
        summit = _summit(loaded, severity, trials)
        if summit is not None:
            trials.append((severity_of(summit), summit))
        highest, worst = max(trials, key=lambda trial: trial[0])
        gains = highest > severity
        is_level = abs(highest - severity) <= _ROUNDING * abs(severity)
        loaded, severity = (worst, highest) if gains else (loaded, severity)
        if worst is summit and is_level and step < 0.5:
            break
        step *= 0.02 if worst is summit else 2.0 if gains else 0.125
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
        changes = [(value - severity, getattr(trial, name), along) for value, trial in trials]
        moved = [(rise, other - along) for rise, other, along in changes if other is not along]
        if moved:
            rise, aside = map(np.array, zip(*moved, strict=True))
            slope = np.linalg.lstsq(aside, rise, rcond=None)[0]
            if slope.any():
                directions[name] = slope / np.linalg.norm(slope)
    if not directions:
        return None
    wind, inertia = (directions.get(k, getattr(loaded, k)) for k in ("wind", "inertia"))
    return loaded.case.under(*loaded.bare, wind, inertia, loaded.lost_cable, loaded.wrench_N)


# Proof


def prove_governing(
    cases: Sequence[CaseResult], budget: Budget, progress: Advance
) -> tuple[Proof, tuple[CaseResult, ...]]:
    """Prove that a cable holds in all poses, in the case and direction that ask for most.

    A pose that is worse than the one found before takes its place, after a search from there.
    Returns what is proved, and the cases with that pose.
    """
    worst = governing(cases)
    loaded, workspace = worst.loaded, worst.workspace
    words = (loaded.case.name, loaded.words)
    name = "" if loaded.case is STATIC else ", ".join(filter(None, words))
    reason = _why_not_proved(worst)
    if reason:
        proof = Proof("off", found=worst.utilisation, reason=reason, load_case=name)
        return proof, tuple(cases)
    percent = 0

    def advance_to(share: float) -> None:
        nonlocal percent
        progress(int(100.0 * share) - percent)
        percent = int(100.0 * share)

    space, cable = workspace.space, loaded.cable
    proof = prove(loaded.robot, cable, space, worst.utilisation, budget, progress=advance_to)
    proof = replace(proof, load_case=name)
    if proof.worst is None:
        return proof, tuple(cases)
    place, utilisation = proof.worst[: space.n_coordinates], proof.found
    if np.isfinite(utilisation):
        demand = partial(rope_demand, loaded.robot, cable, workspace.hangs_below)
        refined = refine(space, demand, place[None], LIGHT)[0]
        if refined.demand > utilisation * cable.allowable_tension_N:
            place, utilisation = refined.place, refined.demand / cable.allowable_tension_N
    worse = worst.with_worst(place, utilisation * cable.allowable_tension_N)
    proof = replace(proof, found=utilisation, bound=max(proof.bound, utilisation))
    return proof, tuple(worse if case is worst else case for case in cases)


def _why_not_proved(result: CaseResult) -> str:
    """Return why nothing can be proved of a case; empty where something can."""
    if result.loaded.lost_cable is not None:
        return "what becomes of a platform that loses a cable is not enclosed"
    if result.loaded.keeps_lengths:
        return "what becomes of a platform on lengths that grow is not enclosed"
    if result.workspace.hangs_below == "exclude":
        return "poses are left out, and which ones depends on the rope"
    if not np.isfinite(result.utilisation):
        return "the rope does not hold"
    return ""
