"""What a study asks of every equilibrium, evaluated where given cables are nearest to failing it.

Strength, which `designer.selection.cases` searches, and criteria beside it: each a quantity of an
equilibrium and what it is held against. All criteria of a load case are evaluated together: in
every direction of its loads over some of the samples, then between them in the direction that is
worst for each. Where lengths are kept, as after the loss of a cable, those count that are asked of
the state in which the platform comes to rest.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Literal

import numpy as np

from designer.arrays import BoolArray, FloatArray, IntArray
from designer.model.cable import Cable, Cables
from designer.model.load_case import LoadCase, Loaded
from designer.model.robot import Poses, Robot
from designer.model.verdict import Requirement, State, Verdict
from designer.model.workspace import Workspace
from designer.progress import Advance, steps
from designer.selection.cases import CaseResult, governing_directions, worst_load_direction
from designer.statics.cable_loss import Fate
from designer.statics.inverse import Statics, sag_ratio, solve_sagging
from designer.statics.modes import NEAR, TAKES_PART, frequencies_Hz
from designer.statics.stiffness import (
    largest_displacement_m_per_N,
    least_eigenvalue_N_per_m,
    upright_stiffness,
)
from designer.study import Selection
from designer.workspace.clearance import names_of, smallest_clearance, where_pairs_are_near
from designer.workspace.demand import (
    is_counted,
    is_left_out,
    rope_demand,
    settled,
    where_each_pulls_most,
)
from designer.workspace.effort import CRITERIA, EACH_DIRECTION
from designer.workspace.refine import LIGHT, Effort, Worst, refine

ROUNDING = 1e-9
"""Relative: how exactly the solver keeps a limit that it chooses the internal forces by."""
_MOST_LOADS = 14
"""Of those of a load case, in which straight cables are searched: as many as inertia forces."""
_OF_MANY = replace(LIGHT, inside=4096, starts=12)
"""For many extremes at once, which share what is explored: internal forces jump, so that they have
maxima beside each other."""
_MAX_ITERATIONS = 4
"""Of worsening the loads and searching the pose again; two are enough as a rule."""
WHERE = "searched over the poses of the case"


@dataclass(frozen=True, slots=True, eq=False)
class Criterion:
    """A quantity of an equilibrium, and the limit that a study holds it against."""

    # As those of the `Requirement`:
    id: str
    title: str
    formula: str
    source: str
    unit: str
    quantity: Callable[[Loaded, Statics], FloatArray]
    """Returns it (n, n_cables) or (n, 1) of equilibria (n,) in one direction of loads."""
    limits: tuple[float, ...]  #: one, or the lower and upper end of a band
    kind: Literal["at_most", "at_least", "above", "outside"]
    """What the quantity has to be of the limit, or ``outside`` the band."""
    has_ratio: bool = True  #: whether demand over capacity means anything
    at_rest_after_loss: bool = False
    """Whether it is asked of the state after the loss of a cable as well."""
    detail: Callable[[Loaded, Statics], str] | None = None
    """Returns what to know of it there, such as between what a distance is, of equilibria (1,)."""
    capacity: Callable[[Statics], FloatArray] | None = None
    """Returns what the quantity is a share of, of each cable (n_cables,) [unit]; None where it is
    in that unit itself."""
    starts: Callable[[Sequence[Loaded], Workspace, FloatArray], FloatArray] | None = None
    """Returns where to search from beside samples (n, n_coordinates), of all directions of the
    loads, the workspace and those samples."""
    why_open: Callable[[Statics], str] = lambda _: ""
    """Returns why it is not known to fail where it does not hold there; empty where it fails."""

    def severity(self, quantity: FloatArray) -> FloatArray:
        """Return what grows as the quantity comes nearer to failing, NaN where that is NaN."""
        if self.kind == "at_most":
            return quantity
        if self.kind != "outside":
            return -quantity
        low, high = self.limits
        return np.asarray(np.minimum(high / quantity, quantity / low))

    def figures(self, quantity: float) -> tuple[float, float, float, bool]:
        """Return demand, capacity, utilisation and whether it holds."""
        limit = self.limits[0]
        if self.kind == "outside":
            low, high = self.limits
            depth = min(high / quantity, quantity / low)
            is_above = quantity / low >= high / quantity
            ends = (high, quantity) if is_above else (quantity, low)
            return *ends, depth, depth < 1.0
        if self.kind == "at_most":
            return quantity, limit, quantity / limit, quantity <= limit * (1.0 + ROUNDING)
        if self.kind == "above":
            return limit, quantity, math.nan, quantity > limit
        holds = quantity >= limit - ROUNDING * abs(limit)
        if not self.has_ratio:
            return limit, quantity, math.nan, holds
        used = limit / quantity if quantity > 0.0 else math.inf if limit > 0.0 else math.nan
        return limit, quantity, min(used, 1.0) if holds else used, holds


def criteria_of(robot: Robot, workspace: Workspace, selection: Selection | None) -> list[Criterion]:
    """Return what a study asks of the equilibria of every load case beside strength."""
    return [
        *_of_cables(robot.tension_min_N, robot.sag_max),
        *_of_winches(robot),
        *_of_workspace(workspace),
        *(() if selection is None else _of_limits(selection)),
    ]


def _of_cables(least_N: float, sag_max: float) -> Iterator[Criterion]:
    """Yield what is asked of the cables whatever the region, and of the platform they hold."""
    yield Criterion(
        id="least_tension",
        title="Slack",
        formula="least tension anywhere in a cable ≥ the least that the study requires",
        source=f"robot.tension_min; {WHERE}",
        unit="N",
        quantity=lambda _, statics: statics.least_tension_N,
        limits=(least_N,),
        kind="at_least" if least_N > 0.0 else "above",
    )
    yield Criterion(
        id="stability",
        title="Stability",
        formula="lowest eigenvalue of the platform's stiffness, cables of fixed length, turns as "
        "displacements of the farthest attachment > 0",
        source=f"the potential energy has a minimum; {WHERE}",
        unit="N/m",
        quantity=lambda _, statics: least_eigenvalue_N_per_m(
            statics.robot, upright_stiffness(statics)
        )[:, None],
        limits=(0.0,),
        kind="above",
    )
    yield Criterion(
        id="sag",
        title="Sag",
        formula="largest distance of a cable from its chord ≤ this share of the chord",
        source=f"workspace.sag; {WHERE}",
        unit="",
        quantity=lambda _, statics: sag_ratio(statics),
        limits=(sag_max,),
        kind="at_most",
    )


def _of_winches(robot: Robot) -> Iterator[Criterion]:
    """Yield what is asked of the winches in every equilibrium, along a path as they turn there."""
    winches, moves = robot.winches, robot.platform.motion is not None
    share = winches.reeving_efficiency
    paid_out = ", times that as it is paid out," if moves else ","
    losses = "" if share == 1.0 else f", over the {share:.4g} that its sheaves keep of it{paid_out}"
    if winches.tension_max_N is not None:
        yield Criterion(
            id="winch_tension",
            title="Winch",
            formula=f"largest tension of a cable at its exit point{losses} ≤ that of its winch",
            source=f"robot.winches.tension_max; {WHERE}",
            unit="N",
            quantity=_share_of_winch,
            limits=(1.0,),
            kind="at_most",
            at_rest_after_loss=True,  # brakes have to hold it as well
            capacity=_winch_capacity_N,
            starts=starts_of_each,
            why_open=_why_other_tensions_may_do,
        )
    if winches.motor_torque_Nm is not None:
        yield Criterion(
            id="winch_torque",
            title="Motor",
            formula="M = T (D + (2k - 1) d) / (2 i η) ≤ torque of the motor; rope in layer k, T at "
            f"the drum{'; η times that as it is paid out, not over it' if moves else ''}",
            source=f"robot.winches.motor.torque; {WHERE}",
            unit="N*m",
            quantity=_motor_torque_Nm,
            limits=(winches.motor_torque_Nm,),
            kind="at_most",
        )


def starts_of_each(
    directions: Sequence[Loaded], workspace: Workspace, places: FloatArray
) -> FloatArray:
    """Return where to search for what each cable meets; see `where_each_pulls_most`."""
    among = directions[:: -(-len(directions) // _MOST_LOADS)]
    return where_each_pulls_most([loaded.robot for loaded in among], workspace.space, places)


def _winch_capacity_N(statics: Statics) -> FloatArray:
    """Return the largest tension of each winch (n_cables,), NaN where it has no limit [N]."""
    largest_N = statics.robot.winches.largest_tensions_N(statics.robot.n_cables)
    return np.where(np.isinf(largest_N), np.nan, largest_N)


def _share_of_winch(loaded: Loaded, statics: Statics) -> FloatArray:
    """Return tension over the largest of the winch (n, n_cables), NaN where it has no limit."""
    paid_out = is_paid_out(loaded, statics)
    drum_tension_N = statics.robot.winches.drum_tension_N(statics.exit_tension_N, paid_out)
    return np.asarray(drum_tension_N / _winch_capacity_N(statics))


def is_paid_out(loaded: Loaded, statics: Statics) -> BoolArray | bool:
    """Tell which cables (n, n_cables) are paid out at poses (n,) of a path.

    At rest none: there a winch is about to haul in.
    """
    motion = statics.robot.platform.motion
    if motion is None:
        return False
    instant = motion.instants_at(statics.poses.position_m)
    before = np.clip(instant - 1, 0, len(motion.time_s) - 3)
    around = np.unique(before[:, None] + np.arange(3))
    length_m = np.full((len(motion.time_s), statics.robot.n_cables), np.nan)
    poses = Poses.at(motion.places[around])
    length_m[around] = solve_sagging(statics.robot, poses, loaded.cable).length_m
    return np.asarray((motion.speeds_m_per_s(length_m)[instant] > 0.0) & (instant[:, None] >= 0))


def _why_other_tensions_may_do(statics: Statics) -> str:
    """Return why winches that differ may do with other internal forces; empty where not."""
    differ = isinstance(statics.robot.winches.tension_max_N, np.ndarray)
    if not (differ and statics.robot.is_redundant):
        return ""
    return "tensions are chosen for the ropes; others may suit winches that differ"


def _motor_torque_Nm(loaded: Loaded, statics: Statics) -> FloatArray:
    """Return the torque of each motor (n, n_cables), its rope in the outermost layer."""
    rope_m, paid_out = rope_diameter_m(loaded.cable), is_paid_out(loaded, statics)
    return statics.robot.winches.torque_Nm(statics.exit_tension_N, rope_m, paid_out)


def rope_diameter_m(cable: Cable | Cables) -> FloatArray | float:
    """Return the diameter of all cables, or of each (n_cables,) [m]."""
    if isinstance(cable, Cables):
        return np.array([of_cable.diameter_m for of_cable in cable.each])
    return cable.diameter_m


def _of_workspace(workspace: Workspace) -> Iterator[Criterion]:
    """Yield what is asked of where the cables run."""
    if workspace.floor_m is not None:
        yield Criterion(
            id="floor",
            title="Floor",
            formula="lowest point of a cable ≥ height of the floor",
            source=f"workspace.floor; {WHERE}",
            unit="m",
            quantity=lambda _, statics: statics.lowest_m,
            limits=(workspace.floor_m,),
            kind="at_least",
            has_ratio=False,  # heights make none
            at_rest_after_loss=True,
        )
    if workspace.clearance_m is not None:
        yield Criterion(
            id="clearance",
            title="Clearance",
            formula="smallest distance, axis to axis ≥ the clearance that the study requires",
            source=f"workspace.clearance; {WHERE}",
            unit="m",
            quantity=lambda _, statics: smallest_clearance(statics).distance_m[:, None],
            limits=(workspace.clearance_m,),
            kind="at_least",
            at_rest_after_loss=True,
            detail=lambda _, statics: " and ".join(
                names_of(tuple(smallest_clearance(statics).pair[0]))
            ),
            starts=lambda directions, workspace, places: where_pairs_are_near(
                directions[0].robot, workspace, directions[0].cable, places
            ),
        )


def _of_limits(selection: Selection) -> Iterator[Criterion]:
    """Yield the limits of a selection that are asked of every equilibrium."""
    limits = selection.limits
    if limits.platform_frequency_Hz is not None:
        ends_Hz = limits.platform_frequency_Hz
        span = "at least {:g} Hz" if len(ends_Hz) == 1 else "outside {:g} to {:g} Hz"
        yield Criterion(
            id="platform_frequency",
            title="Platform frequency",
            formula="natural frequencies of platform and cables together at which the platform has "
            f"{TAKES_PART:.0%} of the kinetic energy or more, {span.format(*ends_Hz)}",
            source=f"selection.limits.platform_frequency; {WHERE}",
            unit="Hz",
            quantity=partial(_frequency_Hz, ends_Hz, True),
            limits=ends_Hz,
            kind="at_least" if len(ends_Hz) == 1 else "outside",
        )
    if limits.stiffness_N_per_m is not None:
        yield Criterion(
            id="stiffness",
            title="Stiffness",
            formula="smallest force over displacement of the platform in any direction, cables of "
            "fixed length ≥ the least that the study requires",
            source=f"selection.limits.stiffness; {WHERE}",
            unit="N/m",
            quantity=_stiffness_N_per_m,
            limits=(limits.stiffness_N_per_m,),
            kind="at_least",
        )
    if limits.excitation_Hz is not None:
        low, high = limits.excitation_Hz
        yield Criterion(
            id="excitation",
            title="Excitation",
            formula=f"natural frequencies outside {low:g} to {high:g} Hz, of cables and platform "
            "together, overtones too; of cables alone where the platform's inertia is not given",
            source=f"selection.limits.excitation; {WHERE}",
            unit="Hz",
            quantity=partial(_frequency_Hz, (low, high), False),
            limits=(low, high),
            kind="outside",
        )


def _frequency_Hz(
    limits: tuple[float, ...], of_platform: bool, loaded: Loaded, statics: Statics
) -> FloatArray:
    """Return the lowest natural frequency, or that deepest in a band (n, 1)."""
    body, density = loaded.moving_body, loaded.moving_density_kg_per_m
    middle, nearness = (0.0, NEAR) if len(limits) == 1 else (math.sqrt(math.prod(limits)), math.inf)
    figures = frequencies_Hz(statics, body, density, middle, of_platform=of_platform, near=nearness)
    return figures[:, None]


def _stiffness_N_per_m(_: Loaded, statics: Statics) -> FloatArray:
    """Return the smallest force over displacement (n, 1), zero where the balance is not stable."""
    softness = largest_displacement_m_per_N(statics)
    return np.asarray(np.nan_to_num(1.0 / softness, nan=0.0))[:, None]


# Evaluation


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
    where they are worst, the place is searched ``again`` with this effort, in alternation.
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
    samples = CRITERIA.of(robot, keeps_lengths=keeps)
    space = workspace.space
    places = np.concatenate(
        [space.landmarks(), workspace.thinned(max(samples // count, EACH_DIRECTION))]
    )
    if not keeps:  # there, as many more equilibria would take far too long
        searches = dict.fromkeys(criterion.starts for criterion in of_case if criterion.starts)
        likely = [starts(loads.directions, workspace, places) for starts in searches]
        places = np.concatenate([places, *likely])
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
            worst_loaded, place = _worsened(criterion, loaded, workspace, extreme, again)
            requirement = at_place(criterion, worst_loaded, workspace, place)
            if requirement is not None:
                yield Evaluation(criterion, loads, worst_loaded, requirement)


def _worsened(
    criterion: Criterion,
    loaded: Loaded,
    workspace: Workspace,
    extreme: Worst,
    again: Effort,
) -> tuple[Loaded, FloatArray]:
    """Worsen wind and inertia force and search the pose again, in alternation."""
    if not loaded.is_direction_searched:
        return loaded, extreme.place
    for _ in range(_MAX_ITERATIONS):
        place = extreme.place

        def severity_of(loaded: Loaded, place: FloatArray = place) -> float:
            return float(_severity(loaded, workspace, [criterion], place[None])[0, 0])

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
    numbers = np.arange(1, loaded.robot.n_cables + 1)
    cables = numbers[numbers != loaded.lost_cable]
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

    starts = workspace.thinned(CRITERIA.slow)
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
    terms, verification = selection.under(result.case), result.verification
    factor = terms.safety_factor
    is_known = verification.is_refined or not verification.holds
    share = result.loaded.robot.winches.reeving_efficiency
    bending = "bending" if share == 1.0 else f"bending times the {share:.4g} that sheaves keep"
    return Requirement(
        id="breaking_load",
        title="Breaking load",
        formula=f"T ≤ η F / S; η the smaller of end fitting and {bending}, S = {factor:g}",
        source=f"Noble Denton 0027/ND, 7.6 to 7.8; {terms.factor_source}",
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
        fate = Fate.NOT_HELD if result.loss is None else Fate(int(result.loss.fate[0]))
        loaded = result.loaded
        if fate is not Fate.NOT_HELD:
            state, remark = State.OPEN, fate.words
        else:
            statics = solve_sagging(loaded.robot, result.pose, loaded.cable)
            verdict = Verdict(int(statics.verdict[0]))
            state, remark = verdict.state, verdict.clause
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
