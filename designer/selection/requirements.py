"""What a study asks for in every load case, evaluated where given cables are nearest to failing it.

Each criterion is a quantity of an equilibrium and what it is held against. All criteria of a load
case are evaluated together: in every direction of its loads over some of the samples, then between
them in the direction that is worst for each. Where lengths are kept, as after the loss of a cable,
those count that are asked of the state in which the platform comes to rest.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from designer.arrays import BoolArray, FloatArray, IntArray
from designer.model.cable import Cable
from designer.model.load_case import LoadCase, Loaded
from designer.model.robot import Poses, Robot
from designer.model.verdict import Requirement, State, Verdict
from designer.model.workspace import Workspace
from designer.progress import Advance, steps
from designer.selection.cases import CaseResult, governing_directions, worst_load_direction
from designer.selection.criteria import ROUNDING, WHERE, Criterion
from designer.statics.cable_loss import Fate
from designer.statics.inverse import Statics, solve_sagging
from designer.statics.sizes import is_quick
from designer.study import Selection
from designer.workspace.demand import is_counted, is_left_out, rope_demand, settled
from designer.workspace.refine import LIGHT, Effort, Worst, refine

QUICK_SAMPLES, SLOW_SAMPLES, FEWEST_SAMPLES = 2000, 500, 16
"""Poses evaluated in all directions of a load case together, of robots that are quick or slow to
solve, and in each direction at least."""
SETTLED_SAMPLES = 64
"""The same where lengths are kept: to follow a platform takes a thousand times as long."""
_OF_MANY = replace(LIGHT, inside=2048, starts=12)
"""For many extremes at once, which share what is explored: internal forces jump, so that they have
maxima beside each other."""
_MOST_ROUNDS = 4
"""Of turning the loads and searching the pose again; two are enough as a rule."""


@dataclass(frozen=True, slots=True, eq=False)
class CaseLoads:
    """A load case with given cables in all directions of its loads, and where it is asked."""

    workspace: Workspace
    directions: tuple[Loaded, ...]

    @property
    def case(self) -> LoadCase:
        """The case."""
        return self.directions[0].case

    @property
    def keeps_lengths(self) -> bool:
        """Whether winches are braked, see `Loaded.keeps_lengths`."""
        return any(loaded.keeps_lengths for loaded in self.directions)


@dataclass(frozen=True, slots=True, eq=False)
class Evaluation:
    """A criterion in a load case, and in which direction of its loads it is nearest to failing."""

    criterion: Criterion
    loads: CaseLoads
    loaded: Loaded
    requirement: Requirement

    def on(self, robot: Robot, cable: Cable) -> Requirement | None:
        """Return the same at that place with another cable; None where the place does not count."""
        assert self.requirement.place is not None
        loaded = self.loaded.on(robot, cable)
        return at_place(self.criterion, loaded, self.loads.workspace, self.requirement.place)


def loads_of(cases: Sequence[CaseResult]) -> list[CaseLoads]:
    """Return the load cases of what a cable meets, each in all directions that were tried."""
    of_cases = {result.case: result for result in cases}.values()
    return [
        CaseLoads(
            result.workspace,
            tuple(direction.loaded for direction in cases if direction.case is result.case),
        )
        for result in of_cases
    ]


def evaluate(
    loads: Sequence[CaseLoads],
    criteria: Sequence[Criterion],
    progress: Advance = lambda _: None,
    *,
    again: Effort = LIGHT,
) -> tuple[Evaluation, ...]:
    """Return each criterion in each load case, where it comes nearest to failing.

    ``progress`` is called with 1 after each load case. After wind and inertia force were turned to
    where they are worst, the place is searched ``again`` with this effort, by turns.
    """
    evaluations: list[Evaluation] = []
    for case_loads in loads:
        evaluations += _evaluate_case(case_loads, criteria, again)
        progress(1)
    return tuple(evaluations)


def at_place(
    criterion: Criterion, loaded: Loaded, workspace: Workspace, place: FloatArray
) -> Requirement | None:
    """Return a criterion at one place (n_coordinates,); None where the place does not count."""
    statics, _, counts = equilibria(loaded, workspace, place[None])
    with np.errstate(invalid="ignore", divide="ignore"):
        quantity = criterion.quantity(loaded, statics)
    if not counts.any() or np.isnan(quantity).all():
        return None
    return _requirement(criterion, loaded, place, quantity[0], statics)


def _evaluate_case(
    loads: CaseLoads, criteria: Sequence[Criterion], again: Effort
) -> Iterator[Evaluation]:
    keeps = loads.keeps_lengths
    lost = any(loaded.lost_cable for loaded in loads.directions)
    of_case = [criterion for criterion in criteria if criterion.at_rest_after_loss or not lost]
    if not of_case:
        return
    workspace, count = loads.workspace, len(loads.directions)
    robot = loads.directions[0].robot
    samples = SETTLED_SAMPLES if keeps else QUICK_SAMPLES if is_quick(robot) else SLOW_SAMPLES
    space = workspace.space
    places = np.concatenate(
        [space.landmarks(), workspace.thinned(max(samples // count, FEWEST_SAMPLES))]
    )
    if not keeps:  # there, as many more equilibria would take far too long
        beside = dict.fromkeys(criterion.starts for criterion in of_case if criterion.starts)
        known = [starts(loads.directions, workspace, places) for starts in beside]
        places = np.concatenate([places, *known])
    severities = np.stack(
        [_severity(loaded, workspace, of_case, places).max(axis=0) for loaded in loads.directions]
    )
    worst = severities.argmax(axis=0)
    for number in np.unique(worst):
        loaded = loads.directions[number]
        columns = [of_case[k] for k in np.flatnonzero(worst == number)]
        demand = partial(_severity, loaded, workspace, columns)
        extremes = refine(space, demand, places, LIGHT if keeps else _OF_MANY)
        for criterion, extreme in steps("extremes", zip(columns, extremes, strict=True)):
            if np.isneginf(extreme.demand):  # no pose of the case counts
                continue
            turned, place = _turned(criterion, loaded, workspace, extreme, again)
            requirement = at_place(criterion, turned, workspace, place)
            if requirement is not None:
                yield Evaluation(criterion, loads, turned, requirement)


def _turned(
    criterion: Criterion,
    loaded: Loaded,
    workspace: Workspace,
    extreme: Worst,
    again: Effort,
) -> tuple[Loaded, FloatArray]:
    """Turn wind and inertia force to where they are worst, and search the pose again, by turns."""
    if not loaded.is_direction_searched:
        return loaded, extreme.place
    for _ in range(_MOST_ROUNDS):
        place = extreme.place

        def severity_of(other: Loaded, place: FloatArray = place) -> float:
            return float(_severity(other, workspace, [criterion], place[None])[0, 0])

        loaded, severity = worst_load_direction(loaded, extreme.demand, severity_of)
        # A search for the pose takes long there; between single points there is nowhere to climb.
        if loaded.keeps_lengths or (workspace.space.is_discrete and not again.rounds):
            break
        demand = partial(_severity, loaded, workspace, [criterion])
        (moved,) = refine(workspace.space, demand, place[None], again)
        if moved.demand <= severity + ROUNDING * abs(severity):
            break
        extreme = moved
    return loaded, extreme.place


def _severity(
    loaded: Loaded,
    workspace: Workspace,
    criteria: Sequence[Criterion],
    places: FloatArray,
) -> FloatArray:
    """Return the demand (n, n_criteria) of places; minus infinite where a place does not count."""
    statics, rows, counts = equilibria(loaded, workspace, places)
    with np.errstate(invalid="ignore", divide="ignore"):
        severities = [
            np.fmax.reduce(criterion.severity(criterion.quantity(loaded, statics)), axis=1)
            for criterion in criteria
        ]
    severity = np.full((len(places), len(criteria)), -np.inf)
    severity[rows[counts]] = np.nan_to_num(np.column_stack(severities)[counts], nan=-np.inf)
    return severity


def equilibria(
    loaded: Loaded, workspace: Workspace, places: FloatArray
) -> tuple[Statics, IntArray, BoolArray]:
    """Return the equilibria at places, at rest on kept lengths; of which they are; which count."""
    poses = Poses.at(places)
    if not loaded.keeps_lengths:
        statics = solve_sagging(loaded.robot, poses, loaded.cable)
        counts = is_counted(statics, workspace.hangs_below)
        return statics, np.arange(len(places)), counts
    loss = settled(loaded, poses)
    rows = np.flatnonzero(loss.before.is_solved)
    rests = (loss.fate[rows] == Fate.HOLDS) | (loss.fate[rows] == Fate.RESTS_ELSEWHERE)
    return loss.statics, rows, rests & ~is_left_out(loss.before, workspace.hangs_below)[rows]


def _requirement(
    criterion: Criterion, loaded: Loaded, place: FloatArray, quantity: FloatArray, statics: Statics
) -> Requirement:
    """Return a criterion at a place, of its quantity (n_cables,) or (1,) and equilibria (1,)."""
    column = int(np.nanargmax(criterion.severity(quantity)))
    demand, capacity, used, holds = criterion.figures(float(quantity[column]))
    if criterion.capacity is not None:
        unit = float(criterion.capacity(statics)[column])
        demand, capacity = demand * unit, capacity * unit
    remark = "" if criterion.detail is None else criterion.detail(loaded, statics)
    why_open = "" if holds else criterion.why_open(statics)
    every = np.arange(1, loaded.robot.n_cables + 1)
    cables = every[every != loaded.lost_cable]
    return Requirement(
        id=criterion.id,
        title=criterion.title,
        formula=criterion.formula,
        source=criterion.source,
        state=State.HOLDS if holds else State.OPEN if why_open else State.FAILS,
        load_case=loaded.case.name,
        demand=demand,
        capacity=capacity,
        unit=criterion.unit,
        utilisation=used,
        cable=int(cables[column]) if len(quantity) == len(cables) > 1 else None,
        place=place,
        loaded=loaded,
        remark=remark or why_open,
    )


def extreme_lengths_m(loads: CaseLoads) -> tuple[FloatArray, FloatArray]:
    """Return the longest and the shortest unstrained length of each cable (n_cables,) [m].

    In the first direction of a load case; NaN where no pose counts.
    """
    loaded, workspace = loads.directions[0], loads.workspace

    def demand(places: FloatArray, **how: bool) -> FloatArray:
        return rope_demand(loaded.robot, loaded.cable, workspace.hangs_below, places, **how)[:, 1:]

    starts = workspace.thinned(SLOW_SAMPLES)
    extremes = refine(workspace.space, demand, starts, _OF_MANY)
    lengths = np.array([extreme.demand for extreme in extremes]).reshape(2, -1)
    lengths[np.isinf(lengths)] = np.nan
    return lengths[0], -lengths[1]


def strength_of(cases: Sequence[CaseResult], selection: Selection) -> Iterator[Requirement]:
    """Yield whether every pose is in equilibrium, and the breaking load, in each load case."""
    for result in governing_directions(cases):
        yield equilibrium_of(result)
        if math.isfinite(result.utilisation):
            yield _breaking_load(result, selection)


def _breaking_load(result: CaseResult, selection: Selection) -> Requirement:
    asked, verification = selection.under(result.case), result.verification
    factor = asked.safety_factor
    is_known = verification.is_refined or not verification.holds
    kept = result.loaded.robot.winches.reeving_efficiency
    bending = "bending" if kept == 1.0 else f"bending times the {kept:.4g} that sheaves keep"
    return Requirement(
        id="breaking_load",
        title="Breaking load",
        formula=f"T ≤ η F / S; η the smaller of end fitting and {bending}, S = {factor:g}",
        source=f"Noble Denton 0027/ND, 7.6 to 7.8; {asked.factor_source}",
        state=State.OPEN if not is_known else State.HOLDS if verification.holds else State.FAILS,
        load_case=result.case.name,
        demand=verification.max_tension_N,
        capacity=result.loaded.cable.allowable_tension_N,
        unit="N",
        utilisation=verification.utilisation,
        cable=result.most_used,
        place=verification.worst_place,
        loaded=result.loaded,
    )


def equilibrium_of(result: CaseResult) -> Requirement:
    """Return whether every pose of a load case that counts is in equilibrium with a cable."""
    place = result.verification.worst_place
    is_somewhere = bool(np.isfinite(place).all())
    state, remark = State.HOLDS, ""
    if not is_somewhere:
        state, remark = State.FAILS, "every pose is left out"
    elif not math.isfinite(result.utilisation):
        state, remark = _why_not_held(result)
    return Requirement(
        id="equilibrium",
        title="Equilibrium",
        formula="the cables hold the platform in every pose that counts",
        source=f"forces and moments on the platform; {WHERE}",
        state=state,
        load_case=result.case.name,
        place=place if is_somewhere else None,
        loaded=result.loaded,
        remark=remark,
    )


def _why_not_held(result: CaseResult) -> tuple[State, str]:
    loss = result.loss
    if loss is not None and Fate(int(loss.fate[0])) is not Fate.NOT_HELD:
        return State.OPEN, Fate(int(loss.fate[0])).words
    loaded = result.loaded
    verdict = Verdict(int(solve_sagging(loaded.robot, result.pose, loaded.cable).verdict[0]))
    return verdict.state, verdict.clause
